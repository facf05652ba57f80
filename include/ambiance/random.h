/* Randomness without state: every random number is a hash of what it is for, so a frame needs no generator, no order
 * and no seed but its own coordinates. Integer operations only; any thread; same bits at every width. */
#ifndef AMBIANCE_RANDOM_H
#define AMBIANCE_RANDOM_H

#include <ambiance/vec.h>

/* A bijection of 32 bits in which every output bit depends on every input bit: C. Wellons' lowbias32
 * ("Prospecting for hash functions", 2018). Nest it for more coordinates: u_hash(x + u_hash(y)). */
AMB_INLINE u32x u_hash(u32x a)
{
    a = (a ^ a >> 16) * 0x7feb352du;
    a = (a ^ a >> 15) * 0x846ca68bu;
    return a ^ a >> 16;
}
/* The same of one value. */
AMB_INLINE uint32_t amb_hash(uint32_t a)
{
    a = (a ^ a >> 16) * 0x7feb352du;
    a = (a ^ a >> 15) * 0x846ca68bu;
    return a ^ a >> 16;
}

/* The top 24 bits as a multiple of 2⁻²⁴ in [0, 1). */
AMB_INLINE f32x f_unit(u32x bits) { return i_to_f(u_as_i(bits >> 8)) * (1.0f / 16777216.0f); }
AMB_INLINE float amb_unit(uint32_t bits) { return (float)(bits >> 8) * (1.0f / 16777216.0f); }

/* Four 32-bit hashes of four coordinates: pcg4d of M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering",
 * JCGT 9(3), 2020. */
typedef struct u4x {
    u32x x, y, z, w;
} u4x;
AMB_INLINE u4x u4x_hash(u4x v)
{
    v.x = v.x * 1664525u + 1013904223u;
    v.y = v.y * 1664525u + 1013904223u;
    v.z = v.z * 1664525u + 1013904223u;
    v.w = v.w * 1664525u + 1013904223u;
    for (int round = 0; round < 2; round++) {
        v.x += v.y * v.w;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        v.w += v.y * v.z;
        if (round == 0) {
            v.x ^= v.x >> 16;
            v.y ^= v.y >> 16;
            v.z ^= v.z >> 16;
            v.w ^= v.w >> 16;
        }
    }
    return v;
}

/* Four independent uniform numbers in [0, 1) of a pixel (any coordinates, negative ones too), a sample and a frame.
 * Give each use of randomness in a shader its own sample number. */
AMB_INLINE v4x v4x_random(i32x pixel_x, i32x pixel_y, u32x sample, uint32_t frame)
{
    u4x h = u4x_hash((u4x){i_as_u(pixel_x), i_as_u(pixel_y), sample, u_set(frame)});
    return (v4x){f_unit(h.x), f_unit(h.y), f_unit(h.z), f_unit(h.w)};
}
/* One of them. */
AMB_INLINE f32x f_random(i32x pixel_x, i32x pixel_y, u32x sample, uint32_t frame)
{
    return v4x_random(pixel_x, pixel_y, sample, frame).x;
}

#endif
