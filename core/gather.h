/* Neighbouring words into lanes, from another place for every lane: one load a lane of 8 or 16 bytes and a
 * transposition, instead of one gather a word. */
#ifndef AMBIANCE_CORE_GATHER_H
#define AMBIANCE_CORE_GATHER_H

#include <ambiance/wide.h>

#if AMB_X86
/* Words at p[0..1] of lanes a and b, side by side. */
AMB_INLINE __m128i load_two_pairs(const uint32_t *a, const uint32_t *b)
{
    __m128d low = _mm_load_sd((const double *)(const void *)a);
    return _mm_castpd_si128(_mm_loadh_pd(low, (const double *)(const void *)b));
}
AMB_INLINE __m128i load_quad(const uint32_t *p) { return _mm_loadu_si128((const __m128i *)(const void *)p); }
/* Spills the lanes: reading an index back is one load, taking it out of a vector register is two shuffles. The empty
 * statement keeps compilers from seeing through the memory. */
#define LANE_OFFSETS_(at, index)                        \
    int32_t at[AMB_LANES] __attribute__((aligned(64))); \
    memcpy(at, &(index), sizeof at);                    \
    __asm__("" : "+m"(at))
#endif
#if AMB_X86 && AMB_LANES == 16
#define LANES_FROM_BLOCKS_(b0, b1, b2, b3) \
    _mm512_inserti32x4(_mm512_inserti32x4(_mm512_inserti32x4(_mm512_castsi128_si512(b0), b1, 1), b2, 2), b3, 3)
#define LANES_SHUFFLE_(a, b, control) ((u32x)_mm512_shuffle_ps(_mm512_castsi512_ps(a), _mm512_castsi512_ps(b), control))
#define LANES_(operation) _mm512_##operation
#define LANES_INT_ __m512i
#elif AMB_X86 && AMB_LANES == 8
#define LANES_FROM_BLOCKS_(b0, b1, b2, b3) _mm256_inserti128_si256(_mm256_castsi128_si256(b0), b1, 1)
#define LANES_SHUFFLE_(a, b, control) ((u32x)_mm256_shuffle_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), control))
#define LANES_(operation) _mm256_##operation
#define LANES_INT_ __m256i
#elif AMB_X86
#define LANES_FROM_BLOCKS_(b0, b1, b2, b3) b0
#define LANES_SHUFFLE_(a, b, control) ((u32x)_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), control))
#define LANES_(operation) _mm_##operation
#define LANES_INT_ __m128i
#endif

#if AMB_X86
/* Register i of four holds the words of lane 4j + i in its block j; word[k] gets the k-th ones, in the lanes' order. */
AMB_INLINE void transpose_blocks(LANES_INT_ r0, LANES_INT_ r1, LANES_INT_ r2, LANES_INT_ r3, u32x word[4])
{
    LANES_INT_ a = LANES_(unpacklo_epi32)(r0, r1), b = LANES_(unpacklo_epi32)(r2, r3);
    LANES_INT_ c = LANES_(unpackhi_epi32)(r0, r1), d = LANES_(unpackhi_epi32)(r2, r3);
    word[0] = (u32x)LANES_(unpacklo_epi64)(a, b);
    word[1] = (u32x)LANES_(unpackhi_epi64)(a, b);
    word[2] = (u32x)LANES_(unpacklo_epi64)(c, d);
    word[3] = (u32x)LANES_(unpackhi_epi64)(c, d);
}
#endif

/* word[k] = data[index + k], k = 0, 1 */
AMB_INLINE void fetch_2(const uint32_t *data, i32x index, u32x word[2])
{
#if AMB_X86
    LANE_OFFSETS_(at, index);
#define PAIRS_(j) load_two_pairs(data + at[(4 * (j)) % AMB_LANES], data + at[(4 * (j) + 1) % AMB_LANES])
#define PAIRS_2_(j) load_two_pairs(data + at[(4 * (j) + 2) % AMB_LANES], data + at[(4 * (j) + 3) % AMB_LANES])
    LANES_INT_ low = LANES_FROM_BLOCKS_(PAIRS_(0), PAIRS_(1), PAIRS_(2), PAIRS_(3));
    LANES_INT_ high = LANES_FROM_BLOCKS_(PAIRS_2_(0), PAIRS_2_(1), PAIRS_2_(2), PAIRS_2_(3));
    word[0] = LANES_SHUFFLE_(low, high, 0x88);
    word[1] = LANES_SHUFFLE_(low, high, 0xdd);
#undef PAIRS_
#undef PAIRS_2_
#else
    word[0] = u_gather(data, index);
    word[1] = u_gather(data, index + 1);
#endif
}

/* word[k] = data[index + k], k = 0…3 */
AMB_INLINE void fetch_4(const uint32_t *data, i32x index, u32x word[4])
{
#if AMB_X86
    LANE_OFFSETS_(at, index);
#define QUAD_(i, j) load_quad(data + at[(4 * (j) + (i)) % AMB_LANES])
    LANES_INT_ r0 = LANES_FROM_BLOCKS_(QUAD_(0, 0), QUAD_(0, 1), QUAD_(0, 2), QUAD_(0, 3));
    LANES_INT_ r1 = LANES_FROM_BLOCKS_(QUAD_(1, 0), QUAD_(1, 1), QUAD_(1, 2), QUAD_(1, 3));
    LANES_INT_ r2 = LANES_FROM_BLOCKS_(QUAD_(2, 0), QUAD_(2, 1), QUAD_(2, 2), QUAD_(2, 3));
    LANES_INT_ r3 = LANES_FROM_BLOCKS_(QUAD_(3, 0), QUAD_(3, 1), QUAD_(3, 2), QUAD_(3, 3));
#undef QUAD_
    transpose_blocks(r0, r1, r2, r3, word);
#else
    for (int k = 0; k < 4; k++)
        word[k] = u_gather(data, index + k);
#endif
}

#endif
