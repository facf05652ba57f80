/* One-value twins of the lane functions, and the cold path of their argument reduction. */
#include <ambiance/math.h>

#if AMB_LANES != 1
#error "the scalar twins are the functions at one lane"
#endif

float amb_exp(float a) { return f_exp(a); }
float amb_exp2(float a) { return f_exp2(a); }
float amb_log(float a) { return f_log(a); }
float amb_log2(float a) { return f_log2(a); }
float amb_pow(float base, float exponent) { return f_pow(base, exponent); }
float amb_sin(float a) { return f_sin(a); }
float amb_cos(float a) { return f_cos(a); }
float amb_tan(float a) { return f_tan(a); }
float amb_asin(float a) { return f_asin(a); }
float amb_acos(float a) { return f_acos(a); }
float amb_atan(float a) { return f_atan(a); }
float amb_atan2(float y, float x) { return f_atan2(y, x); }
float amb_cbrt(float a) { return f_cbrt(a); }

/* 64 zero bits, then the first 256 bits of 2/π. */
static const uint64_t two_over_pi[5] = {0, 0xa2f9836e4e441529u, 0xfc2757d1f534ddc0u, 0xdb6295993cb48b61u,
                                        0x7215f82f2e7e2c15u};

/* a = m·2ᵉ; the bits of 2/π above weight 2^(1-e) only add multiples of 4 to a·2/π and are skipped, the next 96 give
 * a·2/π mod 4 to 62 fraction bits, of which at most about 30 cancel (M. Payne, R. Hanek, SIGNUM 1983). */
int32_t amb_reduce_quadrant(float a, float *r, float *r_low)
{
    int32_t bits = f_bits(f_abs(a));
    if (bits >= 0x7f800000) {
        *r = *r_low = __builtin_nanf("");
        return 0;
    }
    int exponent = (bits >> 23) - 150;
    uint64_t mantissa = (uint32_t)(bits & 0x7fffff) | 0x800000u;
    unsigned start = (unsigned)(exponent + 62), word = start >> 6, shift = start & 63;
    uint64_t first = two_over_pi[word], second = two_over_pi[word + 1], third = two_over_pi[word + 2];
    if (shift) {
        first = first << shift | second >> (64 - shift);
        second = second << shift | third >> (64 - shift);
    }
    uint64_t quarters = mantissa * first + (mantissa * (second >> 32) >> 32); /* 2.62 fixed point */
    int64_t fraction;
    uint64_t shifted = quarters << 2;
    memcpy(&fraction, &shifted, sizeof fraction); /* a quarter turn in [-½, ½), 64 fraction bits */
    double angle = (double)fraction * (1.5707963267948966 / 18446744073709551616.0);
    *r = (float)angle;
    *r_low = (float)(angle - (double)*r);
    return (int32_t)((quarters + (1ull << 61)) >> 62) & 3;
}
