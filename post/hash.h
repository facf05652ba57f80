/* Noise for grain and displacement: a hash of integers, so that a pixel's noise depends on nothing but its place, its
 * channel and the frame's index. */
#ifndef AMB_POST_HASH_H
#define AMB_POST_HASH_H

#include <ambiance/wide.h>

/* The finalizer of A. Appleby's MurmurHash3: each bit of the argument changes each bit of the result half the time. */
AMB_INLINE u32x u_mix(u32x h)
{
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

/* The same of one number: keys for a frame and channel. */
AMB_INLINE uint32_t hash_key(long frame_index, uint32_t channel)
{
    uint64_t f = (uint64_t)frame_index;
    uint32_t h = (uint32_t)f * 0x9e3779b9u ^ (uint32_t)(f >> 32) * 0x7feb352du ^ (channel + 1) * 0x846ca68bu;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

/* 32 random bits of a lattice point. */
AMB_INLINE u32x hash_point(i32x x, i32x y, uint32_t key)
{
    return u_mix(i_as_u(x) + u_mix(i_as_u(y) + key) * 0x9e3779b9u);
}

/* Uniform in [0, 1): the upper 24 bits. */
AMB_INLINE f32x hash_unit(u32x h) { return i_to_f(u_as_i(h >> 8)) * 5.9604644775390625e-8f; }

#endif
