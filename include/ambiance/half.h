/* Small floats, exactly: 16-bit halves and the packed R11G11B10F, lanes to lanes (plain scalars at one lane).
 *
 * Encoders round to nearest, ties to even. Integer arithmetic throughout, or F16C, which gives the same bits. Pure
 * functions; any thread. Formats: IEEE 754-2008 binary16; OpenGL 4.6 §2.3.4 (unsigned 11 and 10 bit floats). */
#ifndef AMBIANCE_HALF_H
#define AMBIANCE_HALF_H

#include <ambiance/vec.h>

/* The value of the half in the low 16 bits (the rest must be 0). NaNs keep their payload and become quiet. */
AMB_INLINE f32x half_to_f(u32x half)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_cvtph_ps(_mm512_cvtepi32_epi16((__m512i)half));
#elif AMB_X86 && AMB_LANES == 8
    __m256i pairs = _mm256_packus_epi32((__m256i)half, (__m256i)half);
    return (f32x)_mm256_cvtph_ps(_mm256_castsi256_si128(_mm256_permute4x64_epi64(pairs, 0x08)));
#else
    i32x sign = u_as_i((half & 0x8000u) << 16), magnitude = u_as_i(half & 0x7fffu), zero = i_set(0);
    f32x finite = f_from_bits(magnitude << 13) * 0x1p112f; /* exact, subnormals too */
    i32x infinite = i_sel(magnitude > 0x7bff, i_set(0x7f800000), zero);
    i32x quiet = i_sel(magnitude > 0x7c00, i_set(0x00400000), zero);
    return f_from_bits(f_bits(finite) | infinite | quiet | sign);
#endif
}

/* The nearest half; beyond 65504 (from 65520 on) infinity. NaNs keep the top of their payload and become quiet. */
AMB_INLINE u32x f_to_half(f32x value)
{
#if AMB_X86 && AMB_LANES == 16
    return (u32x)_mm512_cvtepu16_epi32(_mm512_cvtps_ph((__m512)value, _MM_FROUND_TO_NEAREST_INT));
#elif AMB_X86 && AMB_LANES == 8
    return (u32x)_mm256_cvtepu16_epi32(_mm256_cvtps_ph((__m256)value, _MM_FROUND_TO_NEAREST_INT));
#else
    i32x bits = f_bits(value);
    i32x sign = (i32x)(i_as_u(bits) >> 16) & 0x8000, magnitude = bits & 0x7fffffff;
    i32x normal = (magnitude - (112 << 23) + 0x0fff + ((magnitude >> 13) & 1)) >> 13;
    /* Below 2⁻¹⁴ halves are multiples of 2⁻²⁴, the spacing of floats in [½, 1): the addition rounds. */
    i32x small = f_bits(f_from_bits(magnitude) + 0.5f) - 0x3f000000;
    i32x nan = ((magnitude >> 13) & 0x03ff) | 0x7e00;
    i32x half = i_sel(magnitude < 0x38800000, small, i_sel(magnitude < 0x47800000, normal, i_set(0x7c00)));
    return i_as_u(i_sel(magnitude > 0x7f800000, nan, half) | sign);
#endif
}

/* The three components of a packed word: red in bits 0-10, green in 11-21, blue in 22-31; 5 exponent bits each. */
AMB_INLINE v3x r11g11b10_decode(u32x packed)
{
    return (v3x){half_to_f((packed & 0x7ffu) << 4), half_to_f((packed >> 11 & 0x7ffu) << 4),
                 half_to_f((packed >> 22) << 5)};
}

/* A float as an unsigned small float of 5 exponent and `mantissa` bits. Negative values (and -inf) become 0, finite
 * values beyond the largest become the largest, +inf stays infinite, NaN stays NaN. */
AMB_INLINE u32x f_to_unsigned_small(f32x value, int mantissa)
{
    i32x bits = f_bits(value), magnitude = bits & 0x7fffffff;
    int drop = 23 - mantissa;
    i32x infinity = i_set(31 << mantissa);
    i32x normal = (magnitude - (112 << 23) + i_set((1 << (drop - 1)) - 1) + ((magnitude >> drop) & 1)) >> drop;
    normal = i_min(normal, infinity - 1);
    /* 2^(9 - mantissa) is where floats are spaced by the small format's smallest step, 2^(-14 - mantissa). */
    i32x unit = i_set((9 - mantissa + 127) << 23);
    i32x small = f_bits(f_from_bits(magnitude) + f_from_bits(unit)) - unit;
    i32x result = i_sel(magnitude < 0x38800000, small, normal);
    result = i_sel(magnitude >= 0x7f800000, infinity, result);
    result = i_sel(bits < 0, i_set(0), result);
    return i_as_u(i_sel(magnitude > 0x7f800000, infinity | i_set(1 << (mantissa - 1)), result));
}
AMB_INLINE u32x r11g11b10_encode(v3x rgb)
{
    return f_to_unsigned_small(rgb.x, 6) | f_to_unsigned_small(rgb.y, 6) << 11 | f_to_unsigned_small(rgb.z, 5) << 22;
}

#endif
