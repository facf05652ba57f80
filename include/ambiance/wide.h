/* Wide types: one value a lane, written with plain C operators.
 *
 * AMB_LANES (1, 4, 8 or 16; default 1) fixes the number of lanes of a translation unit. At one lane every type below
 * is plain scalar C, which is what a person steps through in a debugger and what tests hold the lanes to, bit by bit.
 *
 *   f32x  float lanes     i32x  int32 lanes     u32x  uint32 lanes     maskx  truth lanes
 *
 * A true mask lane has all bits set (vectors) or bit 0 set (one lane); only bit 0 is ever looked at, so & | ^ and ~
 * mean and, or, xor and not at any width. Comparisons of lanes give masks: `maskx lit = cosine > 0.0f;`.
 * Lanes mix with scalar literals of the same type: `x * 2.0f`, `i & 3`.
 *
 * Determinism: every function here is exactly rounded or exact, so all widths, compilers and processors agree on
 * every bit. Nothing here reads or writes global state; all of it may be called from any thread. */
#ifndef AMBIANCE_WIDE_H
#define AMBIANCE_WIDE_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifndef AMB_LANES
#define AMB_LANES 1
#endif
#if AMB_LANES != 1 && AMB_LANES != 4 && AMB_LANES != 8 && AMB_LANES != 16
#error "AMB_LANES must be 1, 4, 8 or 16"
#endif

#if defined(__x86_64__) && AMB_LANES > 1
#include <immintrin.h>
#define AMB_X86 1
#else
#define AMB_X86 0
#endif
#if AMB_X86 && AMB_LANES == 16 && !(defined(__AVX512F__) && defined(__AVX512DQ__))
#error "16 lanes need -march=x86-64-v4 or better"
#endif
#if AMB_X86 && AMB_LANES == 8 && !defined(__AVX2__)
#error "8 lanes need -march=x86-64-v3 or better"
#endif
#if AMB_X86 && AMB_LANES == 4 && !defined(__SSE4_1__)
#error "4 lanes need -march=x86-64-v2 or better"
#endif

/* WIDE(name) is `name` with the suffix of this translation unit's lanes: the symbol of one variant. */
#define AMB_PASTE_(a, b) a##b
#define AMB_PASTE(a, b) AMB_PASTE_(a, b)
#define WIDE(name) AMB_PASTE(name, AMB_PASTE(_x, AMB_LANES))

#define AMB_INLINE static inline __attribute__((always_inline, unused))

#if AMB_LANES == 1
typedef float f32x;
typedef int32_t i32x;
typedef uint32_t u32x;
typedef int32_t maskx;
#else
typedef float f32x __attribute__((vector_size(4 * AMB_LANES)));
typedef int32_t i32x __attribute__((vector_size(4 * AMB_LANES)));
typedef uint32_t u32x __attribute__((vector_size(4 * AMB_LANES)));
typedef i32x maskx;
#endif

/* Fragment blocks: lanes cover AMB_BLOCK_W × AMB_BLOCK_H pixels, quad by quad:
 * lane = 4·quad + 2·(y & 1) + (x & 1); quads run left to right, then down. */
#define AMB_BLOCK_W (AMB_LANES == 1 ? 1 : AMB_LANES == 4 ? 2 : 4)
#define AMB_BLOCK_H (AMB_LANES == 1 ? 1 : AMB_LANES == 16 ? 4 : 2)

/* ---- broadcast, lanes, memory ---------------------------------------------------------------------------------- */

#if AMB_LANES == 1
AMB_INLINE f32x f_set(float a) { return a; }
AMB_INLINE i32x i_set(int32_t a) { return a; }
AMB_INLINE u32x u_set(uint32_t a) { return a; }
AMB_INLINE maskx m_set(bool a) { return a ? 1 : 0; }
AMB_INLINE float f_lane(f32x a, int lane)
{
    (void)lane;
    return a;
}
AMB_INLINE int32_t i_lane(i32x a, int lane)
{
    (void)lane;
    return a;
}
AMB_INLINE uint32_t u_lane(u32x a, int lane)
{
    (void)lane;
    return a;
}
AMB_INLINE f32x f_with_lane(f32x a, int lane, float value)
{
    (void)a;
    (void)lane;
    return value;
}
AMB_INLINE i32x i_with_lane(i32x a, int lane, int32_t value)
{
    (void)a;
    (void)lane;
    return value;
}
AMB_INLINE i32x i_lane_index(void) { return 0; }
#else
AMB_INLINE f32x f_set(float a) { return a - (f32x){0}; } /* a - (+0) keeps every bit, -0 and NaN too */
AMB_INLINE i32x i_set(int32_t a) { return a + (i32x){0}; }
AMB_INLINE u32x u_set(uint32_t a) { return a + (u32x){0}; }
AMB_INLINE maskx m_set(bool a) { return i_set(a ? -1 : 0); }
AMB_INLINE float f_lane(f32x a, int lane) { return a[lane]; }
AMB_INLINE int32_t i_lane(i32x a, int lane) { return a[lane]; }
AMB_INLINE uint32_t u_lane(u32x a, int lane) { return a[lane]; }
AMB_INLINE f32x f_with_lane(f32x a, int lane, float value)
{
    a[lane] = value;
    return a;
}
AMB_INLINE i32x i_with_lane(i32x a, int lane, int32_t value)
{
    a[lane] = value;
    return a;
}
AMB_INLINE i32x i_lane_index(void)
{
#if AMB_LANES == 4
    return (i32x){0, 1, 2, 3};
#elif AMB_LANES == 8
    return (i32x){0, 1, 2, 3, 4, 5, 6, 7};
#else
    return (i32x){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#endif
}
#endif

/* Bit casts. */
AMB_INLINE i32x f_bits(f32x a)
{
    i32x r;
    memcpy(&r, &a, sizeof r);
    return r;
}
AMB_INLINE f32x f_from_bits(i32x a)
{
    f32x r;
    memcpy(&r, &a, sizeof r);
    return r;
}
AMB_INLINE u32x i_as_u(i32x a) { return (u32x)a; }
AMB_INLINE i32x u_as_i(u32x a) { return (i32x)a; }

/* AMB_LANES consecutive values; no alignment needed. */
AMB_INLINE f32x f_load(const float *p)
{
    f32x r;
    memcpy(&r, p, sizeof r);
    return r;
}
AMB_INLINE void f_store(float *p, f32x a) { memcpy(p, &a, sizeof a); }
AMB_INLINE i32x i_load(const int32_t *p)
{
    i32x r;
    memcpy(&r, p, sizeof r);
    return r;
}
AMB_INLINE void i_store(int32_t *p, i32x a) { memcpy(p, &a, sizeof a); }

/* base[index] lane by lane; every lane's index must be valid (dead lanes too). */
AMB_INLINE f32x f_gather(const float *base, i32x index)
{
#if AMB_LANES == 1
    return base[index];
#elif AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_i32gather_ps((__m512i)index, base, 4);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_i32gather_ps(base, (__m256i)index, 4);
#else
    f32x r = {0};
    for (int i = 0; i < AMB_LANES; i++)
        r[i] = base[index[i]];
    return r;
#endif
}
AMB_INLINE i32x i_gather(const int32_t *base, i32x index)
{
#if AMB_LANES == 1
    return base[index];
#elif AMB_X86 && AMB_LANES == 16
    return (i32x)_mm512_i32gather_epi32((__m512i)index, base, 4);
#elif AMB_X86 && AMB_LANES == 8
    return (i32x)_mm256_i32gather_epi32(base, (__m256i)index, 4);
#else
    i32x r = {0};
    for (int i = 0; i < AMB_LANES; i++)
        r[i] = base[index[i]];
    return r;
#endif
}
AMB_INLINE u32x u_gather(const uint32_t *base, i32x index)
{
    return i_as_u(i_gather((const int32_t *)(const void *)base, index));
}

/* ---- masks ----------------------------------------------------------------------------------------------------- */

/* Bit i of the result is lane i's truth. */
AMB_INLINE uint32_t m_bits(maskx m)
{
#if AMB_LANES == 1
    return (uint32_t)m & 1u;
#elif AMB_X86 && AMB_LANES == 16
    return (uint32_t)_mm512_movepi32_mask((__m512i)m);
#elif AMB_X86 && AMB_LANES == 8
    return (uint32_t)_mm256_movemask_ps((__m256)m);
#elif AMB_X86
    return (uint32_t)_mm_movemask_ps((__m128)m);
#else
    uint32_t bits = 0;
    for (int i = 0; i < AMB_LANES; i++)
        bits |= ((uint32_t)m[i] & 1u) << i;
    return bits;
#endif
}
#define AMB_ALL_LANES ((uint32_t)((1ull << AMB_LANES) - 1u))
AMB_INLINE bool m_any(maskx m) { return m_bits(m) != 0; }
AMB_INLINE bool m_all(maskx m) { return m_bits(m) == AMB_ALL_LANES; }
AMB_INLINE bool m_lane(maskx m, int lane) { return (m_bits(m) >> lane & 1u) != 0; }
AMB_INLINE maskx m_from_bits(uint32_t bits)
{
#if AMB_LANES == 1
    return (maskx)(bits & 1u);
#elif AMB_X86 && AMB_LANES == 16
    return (maskx)_mm512_movm_epi32((__mmask16)bits);
#else
    return (i_set((int32_t)bits) & ((i32x)(u_set(1u) << (u32x)i_lane_index()))) != 0;
#endif
}

/* m ? a : b, lane by lane; both sides are evaluated. */
#if AMB_LANES == 1
AMB_INLINE f32x f_sel(maskx m, f32x a, f32x b) { return (m & 1) ? a : b; }
AMB_INLINE i32x i_sel(maskx m, i32x a, i32x b) { return (m & 1) ? a : b; }
AMB_INLINE u32x u_sel(maskx m, u32x a, u32x b) { return (m & 1) ? a : b; }
#else
AMB_INLINE i32x i_sel(maskx m, i32x a, i32x b) { return (m & a) | (~m & b); }
AMB_INLINE u32x u_sel(maskx m, u32x a, u32x b) { return (u32x)i_sel(m, (i32x)a, (i32x)b); }
AMB_INLINE f32x f_sel(maskx m, f32x a, f32x b)
{
#if AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
#elif AMB_X86 && AMB_LANES == 4
    return (f32x)_mm_blendv_ps((__m128)b, (__m128)a, (__m128)m);
#else
    return (f32x)i_sel(m, (i32x)a, (i32x)b);
#endif
}
#endif

/* ---- arithmetic beyond the operators ---------------------------------------------------------------------------- */

/* a < b ? a : b and a > b ? a : b: a NaN in `a` gives `b`; min(+0,-0) is the second. Put the trusted bound second. */
AMB_INLINE f32x f_min(f32x a, f32x b)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_min_ps((__m512)a, (__m512)b);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_min_ps((__m256)a, (__m256)b);
#elif AMB_X86 && AMB_LANES == 4
    return (f32x)_mm_min_ps((__m128)a, (__m128)b);
#else
    return f_sel(a < b, a, b);
#endif
}
AMB_INLINE f32x f_max(f32x a, f32x b)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_max_ps((__m512)a, (__m512)b);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_max_ps((__m256)a, (__m256)b);
#elif AMB_X86 && AMB_LANES == 4
    return (f32x)_mm_max_ps((__m128)a, (__m128)b);
#else
    return f_sel(a > b, a, b);
#endif
}
AMB_INLINE i32x i_min(i32x a, i32x b) { return i_sel(a < b, a, b); }
AMB_INLINE i32x i_max(i32x a, i32x b) { return i_sel(a > b, a, b); }

/* Correctly rounded square root (IEEE); negative gives NaN. */
AMB_INLINE f32x f_sqrt(f32x a)
{
#if AMB_LANES == 1
    return __builtin_sqrtf(a);
#elif AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_sqrt_ps((__m512)a);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_sqrt_ps((__m256)a);
#elif AMB_X86
    return (f32x)_mm_sqrt_ps((__m128)a);
#else
    for (int i = 0; i < AMB_LANES; i++)
        a[i] = __builtin_sqrtf(a[i]);
    return a;
#endif
}

AMB_INLINE f32x f_abs(f32x a) { return f_from_bits(f_bits(a) & 0x7fffffff); }
AMB_INLINE f32x f_copysign(f32x magnitude, f32x sign)
{
    return f_from_bits((f_bits(magnitude) & 0x7fffffff) | (f_bits(sign) & INT32_MIN));
}
AMB_INLINE f32x f_clamp(f32x a, f32x lo, f32x hi) { return f_min(f_max(a, lo), hi); } /* NaN gives lo */
AMB_INLINE f32x f_saturate(f32x a) { return f_clamp(a, f_set(0.0f), f_set(1.0f)); }   /* NaN gives 0 */
AMB_INLINE f32x f_lerp(f32x a, f32x b, f32x t) { return a + (b - a) * t; }
AMB_INLINE maskx f_is_nan(f32x a) { return a != a; }
AMB_INLINE maskx f_is_finite(f32x a) { return f_abs(a) <= FLT_MAX; }

/* Exact int → nearest float. */
AMB_INLINE f32x i_to_f(i32x a)
{
#if AMB_LANES == 1
    return (float)a;
#else
    return __builtin_convertvector(a, f32x);
#endif
}
/* Truncation toward zero, clamped to [-2³¹, 2³¹-128]; NaN gives -2³¹. */
AMB_INLINE i32x f_to_i(f32x a)
{
    f32x c = f_clamp(a, f_set(-2147483648.0f), f_set(2147483520.0f));
#if AMB_LANES == 1
    return (int32_t)c;
#else
    return __builtin_convertvector(c, i32x);
#endif
}
AMB_INLINE f32x f_trunc(f32x a)
{
    /* At 2²³ and above (and for NaN) every float is its own integer part. */
    f32x t = f_copysign(i_to_f(f_to_i(a)), a);
    return f_sel(f_abs(a) < 8388608.0f, t, a);
}
AMB_INLINE f32x f_floor(f32x a)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_roundscale_ps((__m512)a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_floor_ps((__m256)a);
#elif AMB_X86 && AMB_LANES == 4
    return (f32x)_mm_floor_ps((__m128)a);
#else
    f32x t = f_trunc(a);
    return f_copysign(f_sel(t > a, t - 1.0f, t), a);
#endif
}
AMB_INLINE f32x f_ceil(f32x a) { return -f_floor(-a); }
/* Nearest integer, ties to even. */
AMB_INLINE f32x f_round(f32x a)
{
    f32x magic =
        f_copysign(f_set(8388608.0f), a); /* adding 2²³ leaves no fraction bits; rounding mode is nearest-even */
    f32x r = f_copysign((a + magic) - magic, a);
    return f_sel(f_abs(a) < 8388608.0f, r, a);
}
AMB_INLINE f32x f_fract(f32x a) { return a - f_floor(a); }
/* 0 below lo, 1 above hi, 3t²-2t³ between. */
AMB_INLINE f32x f_smoothstep(f32x lo, f32x hi, f32x a)
{
    f32x t = f_saturate((a - lo) / (hi - lo));
    return t * t * (3.0f - 2.0f * t);
}

/* ---- blocks and quads ------------------------------------------------------------------------------------------- */

/* Pixel offset of each lane inside its block. */
AMB_INLINE i32x i_block_x(void)
{
    i32x l = i_lane_index();
    return (l & 1) | ((l >> 1) & 2);
}
AMB_INLINE i32x i_block_y(void)
{
    i32x l = i_lane_index();
    return ((l >> 1) & 1) | ((l >> 2) & 2);
}

#if AMB_LANES > 1
#if AMB_LANES == 4
#define AMB_QUAD_(v, a, b, c, d) __builtin_shufflevector(v, v, a, b, c, d)
#elif AMB_LANES == 8
#define AMB_QUAD_(v, a, b, c, d) __builtin_shufflevector(v, v, a, b, c, d, a + 4, b + 4, c + 4, d + 4)
#else
#define AMB_QUAD_(v, a, b, c, d)                                                                                      \
    __builtin_shufflevector(v, v, a, b, c, d, a + 4, b + 4, c + 4, d + 4, a + 8, b + 8, c + 8, d + 8, a + 12, b + 12, \
                            c + 12, d + 12)
#endif
/* Screen-space derivatives per pixel, from the pixel's own row (x, to the right) and column (y, down) of its 2×2 quad.
 */
AMB_INLINE f32x f_ddx(f32x a) { return AMB_QUAD_(a, 1, 1, 3, 3) - AMB_QUAD_(a, 0, 0, 2, 2); }
AMB_INLINE f32x f_ddy(f32x a) { return AMB_QUAD_(a, 2, 3, 2, 3) - AMB_QUAD_(a, 0, 1, 0, 1); }
#endif

#endif
