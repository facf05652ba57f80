/* Transcendental functions, the only ones allowed on the pixel path.
 *
 * f_exp … are inlined lane functions; amb_exp … are the same functions of one float, compiled once (core/math.c), for
 * uniform values in *_wide.c files. Both are built from + - * / sqrt and integer operations only: no libm, no fused
 * multiply-add, no tables that depend on the machine. Every width, compiler and processor gives the same bits
 * (of a NaN only that it is one).
 *
 * Errors are in ULP (units in the last place of the float result), proven against double precision in
 * tests/test_math.c over every exponent and the ranges named. Denormal arguments and results are handled at full
 * precision (results that are denormal may be one denormal step worse). ±0, ±Inf and NaN follow IEEE 754 / C Annex F.
 *
 * All of them: any thread, no state, no errors; a lane never depends on another. */
#ifndef AMBIANCE_MATH_H
#define AMBIANCE_MATH_H

#include <ambiance/wide.h>

#define AMB_PI 3.14159265358979f
#define AMB_TWO_PI 6.28318530717959f
#define AMB_HALF_PI 1.57079632679490f
#define AMB_INV_PI 0.318309886183791f
#define AMB_SQRT2 1.41421356237310f
#define AMB_LN2 0.693147180559945f

/* One value. Same bits as a lane of f_exp … */
float amb_exp(float a);
float amb_exp2(float a);
float amb_log(float a);
float amb_log2(float a);
float amb_pow(float base, float exponent);
float amb_sin(float a);
float amb_cos(float a);
float amb_tan(float a);
float amb_asin(float a);
float amb_acos(float a);
float amb_atan(float a);
float amb_atan2(float y, float x);
float amb_cbrt(float a);

/* Payne–Hanek: a finite |a| reduced to r + r_low in [-π/4, π/4]; returns the quadrant, 0..3. The cold path of f_sin. */
int32_t amb_reduce_quadrant(float a, float *r, float *r_low);

/* ---- exponentials ----------------------------------------------------------------------------------------------- */

#define AMB_ROUND_MAGIC 12582912.0f /* 1.5·2²³: adding it rounds |a| < 2²² to an integer, left in the low bits */

/* a·2ᵇʸ modulo 2³²: shifts of negative numbers are only defined unsigned. */
AMB_INLINE i32x amb_shift_(i32x a, int by) { return u_as_i(i_as_u(a) << by); }

/* p·2ⁿ for p in [0.5, 2] and |n| ≤ 254: two exact steps and one rounding, so denormal results are right. */
AMB_INLINE f32x amb_scale_(f32x p, i32x n)
{
    i32x half = n >> 1;
    return p * f_from_bits(amb_shift_(half + 127, 23)) * f_from_bits(amb_shift_(n - half + 127, 23));
}

/* eʳ for |r| ≤ 0.35: 1 + r + r²·q(r), q minimax with relative error 2⁻²⁸. */
AMB_INLINE f32x amb_exp_core_(f32x r)
{
    f32x q = (((0.00139517256f * r + 0.00836959854f) * r + 0.0416661873f) * r + 0.166665122f) * r + 0.5f;
    return 1.0f + (r + r * r * q);
}

/* eᵃ, ≤ 1.05 ULP. Above 88.7228 Inf, below -103.98 zero. */
AMB_INLINE f32x f_exp(f32x a)
{
    f32x c = f_max(f_set(-104.5f), f_min(f_set(89.5f), a)); /* in this order a NaN passes */
    f32x t = c * 1.44269502f + AMB_ROUND_MAGIC;
    f32x n = t - AMB_ROUND_MAGIC;
    f32x r = (c - n * 0.693145752f) - n * 1.42860677e-06f; /* the first product is exact */
    return amb_scale_(amb_exp_core_(r), f_bits(t) - 0x4b400000);
}

/* 2ᵃ, ≤ 1.05 ULP; exact for integers. From 128 Inf, below -150 zero. */
AMB_INLINE f32x f_exp2(f32x a)
{
    f32x c = f_max(f_set(-151.0f), f_min(f_set(129.0f), a));
    f32x t = c + AMB_ROUND_MAGIC;
    f32x r = c - (t - AMB_ROUND_MAGIC);
    return amb_scale_(amb_exp_core_(r * 0.693147182f), f_bits(t) - 0x4b400000);
}

/* ---- logarithms ------------------------------------------------------------------------------------------------- */

/* |a| = m·2ᵉ: returns m in [√½, √2), and *e. |a| finite and not zero. */
AMB_INLINE f32x amb_log_split_(f32x a, f32x *e)
{
    maskx denormal = f_abs(a) < FLT_MIN;
    i32x bits = f_bits(f_sel(denormal, a * 8388608.0f, a)) & 0x7fffffff;
    i32x n = (bits - 0x3f3504f3) >> 23; /* 0x3f3504f3 is √½ */
    *e = i_to_f(n) - f_sel(denormal, f_set(23.0f), f_set(0.0f));
    return f_from_bits(bits - amb_shift_(n, 23));
}

/* log(1+f) - f + f²/2 for f in [√½-1, √2-1]. */
AMB_INLINE f32x amb_log_tail_(f32x f)
{
    f32x p = ((((0.069154188f * f - 0.117897928f) * f + 0.11872939f) * f - 0.123843476f) * f + 0.142186642f) * f;
    p = (((p - 0.16669251f) * f + 0.200022265f) * f - 0.249999866f) * f + 0.333333105f;
    return f * f * f * p;
}

/* Results at the edges of a logarithm's domain. */
AMB_INLINE f32x amb_log_edges_(f32x a, f32x r)
{
    r = f_sel(a == 0.0f, f_set(-__builtin_inff()), r);
    r = f_sel(a == __builtin_inff(), a, r);
    return f_sel((a < 0.0f) | f_is_nan(a), f_set(__builtin_nanf("")), r);
}

/* ln a, ≤ 1 ULP. Zero gives -Inf, negative NaN. */
AMB_INLINE f32x f_log(f32x a)
{
    f32x e;
    f32x f = amb_log_split_(a, &e) - 1.0f; /* exact */
    f32x half = 0.5f * f * f;
    f32x r = e * 1.42860677e-06f + amb_log_tail_(f);
    return amb_log_edges_(a, (f - (half - r)) + e * 0.693145752f);
}

/* log₂ a, ≤ 1 ULP; exact for powers of two. Zero gives -Inf, negative NaN. */
AMB_INLINE f32x f_log2(f32x a)
{
    f32x e;
    f32x f = amb_log_split_(a, &e) - 1.0f; /* exact */
    f32x half = 0.5f * f * f;
    f32x high = f_from_bits(f_bits(f - half) & ~0xfff); /* 12 bits, so that its product below is exact */
    f32x low = ((f - high) - half) + amb_log_tail_(f);
    f32x p = high * 1.44238281f;
    f32x sum = e + p;
    f32x rest = (p - (sum - e)) + ((low + high) * 0.000312228396f + low * 1.44238281f);
    return amb_log_edges_(a, sum + rest);
}

/* ---- power ------------------------------------------------------------------------------------------------------ */

AMB_INLINE f32x amb_high_(f32x a) { return f_from_bits(f_bits(a) & ~0xfff); } /* leading 12 bits */

/* log₂|a| as *high + *low, relative error 2⁻³¹. With c the nearest of three centres, log₂ m = log₂ c + 2/ln2·(s + s³/3
 * + …) for s = (m - c)/(m + c), |s| ≤ 0.06, held in two floats (products split after T. J. Dekker, Numer. Math. 18,
 * 1971). */
AMB_INLINE void amb_log2_pair_(f32x a, f32x *high, f32x *low)
{
    f32x e;
    f32x m = amb_log_split_(a, &e);
    maskx below = m<0.890625f, above = m> 1.12109375f;
    f32x c = f_sel(below, f_set(0.796875f), f_sel(above, f_set(1.2578125f), f_set(1.0f)));
    f32x log_c = f_sel(below, f_set(-0.327575684f), f_sel(above, f_set(0.330932617f), f_set(0.0f)));
    f32x log_c_low = f_sel(below, f_set(1.02556521e-06f), f_sel(above, f_set(-1.57390732e-05f), f_set(0.0f)));
    f32x f = m - c, d = m + c; /* the first is exact */
    f32x d_low = m - (d - c);
    f32x inv = 1.0f / d;
    f32x s = f * inv;
    f32x sh = amb_high_(s), sl = s - sh, dh = amb_high_(d), dl = d - dh;
    f32x s_low = (((f - sh * dh) - sh * dl) - sl * dh - (sl * dl + s * d_low)) * inv;
    f32x s2 = s * s;
    f32x tail = s2 * s * ((0.414424747f * s2 + 0.577073336f) * s2 + 0.961796701f);
    f32x p = sh * 2.88476562f; /* exact: 12 bits each */
    f32x p_low =
        sl * 2.88476562f + (tail + (s * 0.000624456792f + (s_low * (2.88539008f + 2.88539008f * s2) + log_c_low)));
    f32x base = e + log_c; /* exact */
    f32x sum = base + p;
    f32x rest = (p - (sum - base)) + p_low;
    *high = sum + rest;
    *low = rest - (*high - sum);
}

/* baseᵉˣᵖᵒⁿᵉⁿᵗ, ≤ 1.5 ULP over the full range. C Annex F at every edge: x⁰ = 1 and 1ʸ = 1 even for NaN; a negative base
 * needs an integer exponent (NaN otherwise). */
AMB_INLINE f32x f_pow(f32x base, f32x exponent)
{
    f32x lh, ll;
    amb_log2_pair_(base, &lh, &ll);
    /* |log₂| of anything but 1 is above 2⁻²⁴, so 2³⁴ under- or overflows as any larger exponent does. */
    f32x y = f_clamp(exponent, f_set(-17179869184.0f), f_set(17179869184.0f));
    f32x yh = amb_high_(y), yl = y - yh, lhh = amb_high_(lh), lhl = lh - lhh;
    f32x zh = yh * lhh;
    f32x zl = yh * lhl + (yl * lh + y * ll);
    f32x z = zh + zl;
    maskx far = f_abs(z) > 160.0f;
    zh = f_sel(far, f_clamp(z, f_set(-160.0f), f_set(160.0f)), zh);
    zl = f_sel(far, f_set(0.0f), zl);
    f32x t = zh + zl + AMB_ROUND_MAGIC;
    f32x r = (zh - (t - AMB_ROUND_MAGIC)) + zl;
    f32x power = amb_scale_(amb_exp_core_(r * 0.693147182f), f_bits(t) - 0x4b400000);

    f32x inf = f_set(__builtin_inff()), zero = f_set(0.0f);
    maskx down = exponent < 0.0f, is_zero = base == 0.0f;
    power = f_sel(is_zero | (f_abs(base) == __builtin_inff()), f_sel(is_zero ^ down, zero, inf), power);

    i32x yi = f_to_i(exponent); /* even from 2²⁴ on, as clamped values are */
    maskx odd = ((yi & 1) != 0) & (i_to_f(yi) == exponent);
    /* A power is not negative so far. (Selecting between it and its f_copysign loses the mask of the sign in clang 14
     * at -O1 for AVX-512.) */
    i32x sign = i_sel(odd, f_bits(base) & INT32_MIN, i_set(0));
    power = f_from_bits(f_bits(power) | sign);
    maskx invalid = ((base < 0.0f) & (base != -__builtin_inff()) & (f_floor(exponent) != exponent)) | f_is_nan(base) |
                    f_is_nan(exponent);
    power = f_sel(invalid, f_set(__builtin_nanf("")), power);
    return f_sel((exponent == 0.0f) | (base == 1.0f), f_set(1.0f), power);
}

/* baseⁿ for one n ≥ 0 in all lanes, by squaring: ≤ n - 1 ULP while no result is denormal. A dozen operations where
 * f_pow takes a hundred. */
AMB_INLINE f32x f_powi(f32x base, int n)
{
    f32x power = f_set(1.0f);
    for (; n > 0; n >>= 1) {
        if (n & 1)
            power = power * base;
        base = base * base;
    }
    return power;
}

/* ---- trigonometry (radians) ------------------------------------------------------------------------------------- */

/* a ≥ 0 as quadrant·π/2 + r + r_low. Cody–Waite with an 11+11+11+24 bit π/2 up to 12 000, where every product but the
 * last is exact; above, lane by lane, Payne–Hanek. Inf and NaN give NaN. */
AMB_INLINE i32x amb_quadrant_(f32x a, f32x *r, f32x *r_low)
{
    maskx large = a > 12000.0f;
    f32x c = f_sel(large, f_set(0.0f), a);
    f32x t = c * 0.636619747f + AMB_ROUND_MAGIC;
    f32x n = t - AMB_ROUND_MAGIC;
    i32x quadrant = f_bits(t) & 3;
    f32x b = (c - n * 1.5703125f) - n * 0.000483751297f;
    f32x w = n * 7.54953362e-08f;
    f32x high = b - w;
    f32x low = ((b - high) - w) - n * 2.56334407e-12f;
    *r = high + low;
    *r_low = (high - *r) + low;
    if (__builtin_expect(m_any(large), 0))
        for (int i = 0; i < AMB_LANES; i++)
            if (m_lane(large, i)) {
                float lane_r, lane_low;
                quadrant = i_with_lane(quadrant, i, amb_reduce_quadrant(f_lane(a, i), &lane_r, &lane_low));
                *r = f_with_lane(*r, i, lane_r);
                *r_low = f_with_lane(*r_low, i, lane_low);
            }
    return quadrant;
}

/* sin and cos of r + r_low, |r| ≤ π/4 and a little. */
AMB_INLINE f32x amb_sin_core_(f32x r, f32x r_low, f32x r2)
{
    f32x p = (-0.000195108718f * r2 + 0.00833213143f) * r2 - 0.166666538f;
    return r + (r * r2 * p + r_low);
}
AMB_INLINE f32x amb_cos_core_(f32x r, f32x r_low, f32x r2)
{
    f32x p = (2.44312414e-05f * r2 - 0.0013887306f) * r2 + 0.0416666456f;
    f32x half = 0.5f * r2;
    f32x c = 1.0f - half;
    return c + (((1.0f - c) - half) + (r2 * r2 * p - r * r_low));
}

/* Both at once; each the same bits as f_sin and f_cos. */
AMB_INLINE void f_sincos(f32x a, f32x *sine, f32x *cosine)
{
    f32x r, r_low;
    i32x quadrant = amb_quadrant_(f_abs(a), &r, &r_low);
    f32x r2 = r * r;
    f32x s = amb_sin_core_(r, r_low, r2), c = amb_cos_core_(r, r_low, r2);
    maskx swap = (quadrant & 1) != 0;
    i32x sine_sign = amb_shift_(quadrant & 2, 30) ^ (f_bits(a) & INT32_MIN);
    i32x cosine_sign = amb_shift_((quadrant + 1) & 2, 30);
    *sine = f_from_bits(f_bits(f_sel(swap, c, s)) ^ sine_sign);
    *cosine = f_from_bits(f_bits(f_sel(swap, s, c)) ^ cosine_sign);
}
/* ≤ 1 ULP for every float; ±Inf gives NaN. */
AMB_INLINE f32x f_sin(f32x a)
{
    f32x s, c;
    f_sincos(a, &s, &c);
    return s;
}
/* ≤ 1 ULP for every float; ±Inf gives NaN. */
AMB_INLINE f32x f_cos(f32x a)
{
    f32x s, c;
    f_sincos(a, &s, &c);
    return c;
}
/* ≤ 2 ULP for every float; ±Inf gives NaN. */
AMB_INLINE f32x f_tan(f32x a)
{
    f32x r, r_low;
    i32x quadrant = amb_quadrant_(f_abs(a), &r, &r_low);
    f32x r2 = r * r;
    f32x p =
        ((((((0.00452579372f * r2 - 0.000215426538f) * r2 + 0.011078258f) * r2 + 0.0211877096f) * r2 + 0.054078456f) *
              r2 +
          0.133324966f) *
             r2 +
         0.333333552f);
    f32x t = r + (r * r2 * p + (r_low + r_low * r2));
    t = f_sel((quadrant & 1) != 0, -1.0f / t, t);
    return f_from_bits(f_bits(t) ^ (f_bits(a) & INT32_MIN));
}

/* ---- inverse trigonometry --------------------------------------------------------------------------------------- */

/* asin(x) - x for |x| ≤ ½. */
AMB_INLINE f32x amb_asin_tail_(f32x x, f32x x2)
{
    f32x p = (((0.0376300737f * x2 + 0.0143585112f) * x2 + 0.0318286791f) * x2 + 0.0445144698f) * x2 + 0.0750051737f;
    return x * x2 * (p * x2 + 0.166666597f);
}

/* ≤ 2 ULP; outside [-1, 1] NaN. */
AMB_INLINE f32x f_asin(f32x a)
{
    f32x m = f_abs(a);
    maskx big = m > 0.5f;
    f32x z = f_sel(big, 0.5f * (1.0f - m), m * m); /* the first is exact */
    f32x x = f_sel(big, f_sqrt(z), m);
    f32x tail = amb_asin_tail_(x, z);
    f32x r = f_sel(big, 1.57079637f - (2.0f * x + (2.0f * tail + 4.37113883e-08f)), x + tail);
    return f_copysign(r, a);
}

/* ≤ 2 ULP; outside [-1, 1] NaN. */
AMB_INLINE f32x f_acos(f32x a)
{
    f32x m = f_abs(a);
    maskx big = m > 0.5f;
    f32x z = f_sel(big, 0.5f * (1.0f - m), a * a);
    f32x x = f_sel(big, f_sqrt(z), a);
    f32x tail = amb_asin_tail_(x, z);
    f32x small = 1.57079637f - (x + (tail + 4.37113883e-08f));
    f32x near_one = 2.0f * (x + tail);
    f32x near_minus_one = 3.14159274f - (near_one + 8.74227766e-08f);
    return f_sel(big, f_sel(a < 0.0f, near_minus_one, near_one), small);
}

/* atan(x) for |x| ≤ tan(π/8). */
AMB_INLINE f32x amb_atan_tail_(f32x x)
{
    f32x x2 = x * x;
    f32x p = (((-0.0606052168f * x2 + 0.105873607f) * x2 - 0.142427415f) * x2 + 0.199984342f) * x2 - 0.333333135f;
    return x * x2 * p;
}

/* ≤ 2 ULP; ±Inf gives ±π/2. */
AMB_INLINE f32x f_atan(f32x a)
{
    f32x m = f_abs(a);
    maskx steep = m > 2.41421356f, middle = (m > 0.414213562f) & ~steep;
    f32x top = f_sel(steep, f_set(-1.0f), f_sel(middle, m - 1.0f, m));
    f32x bottom = f_sel(steep, m, f_sel(middle, m + 1.0f, f_set(1.0f)));
    f32x base = f_sel(steep, f_set(1.57079637f), f_sel(middle, f_set(0.785398185f), f_set(0.0f)));
    f32x base_low = f_sel(steep, f_set(-4.37113883e-08f), f_sel(middle, f_set(-2.18556941e-08f), f_set(0.0f)));
    f32x x = top / bottom;
    return f_copysign(base + (x + (amb_atan_tail_(x) + base_low)), a);
}

/* Angle of (x, y) in [-π, π], ≤ 2.5 ULP, signs and infinities as in C Annex F: atan2(±0, -0) = ±π, atan2(±0, +0) = ±0.
 */
AMB_INLINE f32x f_atan2(f32x y, f32x x)
{
    f32x inf = f_set(__builtin_inff());
    f32x ay = f_abs(y), ax = f_abs(x);
    maskx steep = ay > ax;
    f32x low = f_sel(steep, ax, ay), high = f_sel(steep, ay, ax);
    /* Powers of two that keep low + high finite and low / high out of the denormals where it matters. */
    f32x scale =
        f_sel(high > 1.0e30f, f_set(1.0f / 16777216.0f), f_sel(high < 1.0e-20f, f_set(16777216.0f), f_set(1.0f)));
    f32x l = low * scale, h = high * scale;
    maskx middle = l > 0.414213562f * h;
    f32x q = f_sel(middle, l - h, l) / f_sel(middle, l + h, h);
    q = f_sel(high == 0.0f, f_set(0.0f), q);
    q = f_sel(low == inf, f_set(0.0f), q); /* both infinite: π/4 exactly */
    middle = middle | (low == inf);
    /* Signed quarter turns: angle = base ± q' with base a multiple of π/4. */
    maskx left = (f_bits(x) < 0);
    f32x turns = f_sel(middle, f_set(1.0f), f_set(0.0f));
    f32x sign = f_set(1.0f);
    turns = f_sel(steep, 2.0f - turns, turns);
    sign = f_sel(steep, -sign, sign);
    turns = f_sel(left, 4.0f - turns, turns);
    sign = f_sel(left, -sign, sign);
    f32x tail = amb_atan_tail_(q) + 0.0f;
    f32x angle = turns * 0.785398185f + (sign * q + (sign * tail - turns * 2.18556941e-08f));
    angle = f_sel(f_is_nan(x) | f_is_nan(y), f_set(__builtin_nanf("")), angle);
    return f_copysign(angle, y);
}

/* ---- cube root -------------------------------------------------------------------------------------------------- */

/* ≤ 1 ULP, signed. A rough integer third of the exponent, one Halley step, then a last one from 8 bits, whose cube and
 * residual are exact. */
AMB_INLINE f32x f_cbrt(f32x a)
{
    f32x m = f_abs(a);
    maskx tiny = m<1.0e-30f, huge = m> 1.0e30f;
    f32x x = m * f_sel(tiny, f_set(16777216.0f), f_sel(huge, f_set(1.0f / 16777216.0f), f_set(1.0f)));
    f32x t = f_from_bits(f_to_i(i_to_f(f_bits(x)) * 0.333333333f) + 709921077);
    f32x t3 = t * t * t;
    t = t * ((t3 + 2.0f * x) / (2.0f * t3 + x));
    t = f_from_bits(u_as_i((i_as_u(f_bits(t)) + 0x8000u) & 0xffff0000u));
    t3 = t * t * t;
    t = t + t * ((x - t3) / (2.0f * t3 + x));
    t = t * f_sel(tiny, f_set(0.00390625f), f_sel(huge, f_set(256.0f), f_set(1.0f)));
    return f_sel((m > 0.0f) & (m < __builtin_inff()), f_copysign(t, a), a);
}

#endif
