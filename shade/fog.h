/* Optical depth through air whose density falls exponentially with height. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_FOG_H
#define AMBIANCE_SHADE_FOG_H

#include <ambiance/math.h>

/* (1 - e⁻ᵘ)/u, 1 at u = 0; by its series where the difference would cancel. */
AMB_INLINE f32x fog_mean_(f32x u)
{
    f32x series =
        1.0f + u * (-1.0f / 2.0f +
                    u * (1.0f / 6.0f +
                         u * (-1.0f / 24.0f + u * (1.0f / 120.0f + u * (-1.0f / 720.0f + u * (1.0f / 5040.0f))))));
    return f_sel(f_abs(u) < 0.25f, series, (1.0f - f_exp(-u)) / u);
}

/* ∫₀ᵀ a·e^(-b·(oy + ky·t)) dt = a·e^(-b·oy)(1 - e^(-b·ky·T))/(b·ky): optical depth over `distance` T ≥ 0 from height oy
 * in a direction of vertical component ky, stable as ky → 0. density a at height 0 and falloff b ≥ 0, both per unit
 * length. What is left of the light is e^-depth. Ambiance report, Elevated. */
AMB_INLINE f32x fog_depth(f32x origin_y, f32x direction_y, f32x distance, float density, float falloff)
{
    return density * f_exp(-falloff * origin_y) * distance * fog_mean_(falloff * direction_y * distance);
}

#endif
