/* Display transfer functions of lanes, for values already in 0…1. */
#ifndef AMB_POST_ENCODE_H
#define AMB_POST_ENCODE_H

#include "post/lanes.h"

typedef struct encode_power {
    float octave[16]; /* 2^(power·(i - 15)) */
    float poly[7];    /* scale·m^power for m in [1, 2), in u = m - 1.5, highest first; |error| < 2.6e-7 */
} encode_power;

/* scale·a^power for a in [2⁻¹⁵, 1]: the octave from a table, the rest a polynomial (Chebyshev fit). */
AMB_INLINE f32x encode_power_of(const encode_power *e, f32x a)
{
    i32x bits = f_bits(a);
    f32x u = f_from_bits((bits & 0x7fffff) | 0x3f800000) - 1.5f;
    f32x p = e->poly[0] * u + e->poly[1];
    for (int i = 2; i < 7; i++)
        p = p * u + e->poly[i];
    return p * f_table16(e->octave, (bits >> 23) - 112);
}

/* IEC 61966-2-1: 12.92·a below 0.0031308, 1.055·a^(1/2.4) - 0.055 above. Within 4e-7; 0 and 1 exact. */
AMB_INLINE f32x f_encode_srgb(f32x a)
{
    static const encode_power power = {
        {0.0131390067f, 0.0175384693f, 0.0234110486f, 0.03125f, 0.0417137444f, 0.0556811690f, 0.0743254423f,
         0.0992125645f, 0.132432893f, 0.176776692f, 0.235968575f, 0.314980268f, 0.420448214f, 0.561231017f,
         0.749153554f, 1.0f},
        {-0.00283955969f, 0.00552338921f, -0.0101758447f, 0.0236573983f, -0.0674723908f, 0.346996069f, 1.24917650f}};
    f32x curve = encode_power_of(&power, f_max(a, f_set(1.0f / 32768.0f))) - 0.055f;
    return f_min(f_sel(a < 0.0031308f, a * 12.92f, curve), f_set(1.0f));
}

/* ITU-R BT.709: 4.5·a below 0.018, 1.099·a^0.45 - 0.099 above. Within 4e-7; 0 and 1 exact. */
AMB_INLINE f32x f_encode_rec709(f32x a)
{
    static const encode_power power = {
        {0.00929068029f, 0.0126914438f, 0.0173370223f, 0.0236830711f, 0.0323520303f, 0.0441941738f, 0.0603710189f,
         0.0824692488f, 0.112656310f, 0.153893054f, 0.210224107f, 0.287174582f, 0.392292053f, 0.535886705f,
         0.732042849f, 1.0f},
        {-0.00289723952f, 0.00567593565f, -0.0105737559f, 0.0249038022f, -0.0725454390f, 0.395697147f, 1.31898165f}};
    f32x curve = encode_power_of(&power, f_max(a, f_set(1.0f / 32768.0f))) - 0.099f;
    return f_min(f_sel(a < 0.018f, a * 4.5f, curve), f_set(1.0f));
}

#endif
