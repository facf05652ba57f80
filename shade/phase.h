/* Phase functions: how scattered light spreads over the angle θ between the light's way and the scattered ray's
 * (cosθ = 1 straight on). All have mean 1 over the sphere: (1/4π)·∫F dω = 1, as the report's scattering equations want;
 * divide by 4π for a density per steradian. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_PHASE_H
#define AMBIANCE_SHADE_PHASE_H

#include <ambiance/math.h>

/* ¾(1 + cos²θ): molecules. Lord Rayleigh, 1871. */
AMB_INLINE f32x phase_rayleigh(f32x cosine) { return 0.75f * (1.0f + cosine * cosine); }

/* (1+g²-2g·cosθ)^(-3/2), as (1-|g|)² + 2|g|(1∓cosθ), which does not cancel in the peak. */
AMB_INLINE f32x phase_lobe_(f32x cosine, float g)
{
    float size = g < 0.0f ? -g : g;
    f32x along = g < 0.0f ? -cosine : cosine;
    f32x a = (1.0f - size) * (1.0f - size) + 2.0f * size * (1.0f - along);
    return 1.0f / (a * f_sqrt(a));
}

/* (1-g²)/(1+g²-2g·cosθ)^(3/2), g in (-1, 1): -1 back, 0 even, 1 forward. L. G. Henyey, J. L. Greenstein, ApJ 93, 1941.
 */
AMB_INLINE f32x phase_henyey_greenstein(f32x cosine, float g) { return (1.0f - g * g) * phase_lobe_(cosine, g); }

/* 3(1-g²)/(2(2+g²))·(1+cos²θ)/(1+g²-2g·cosθ)^(3/2): aerosols; Rayleigh at g = 0. W. M. Cornette, J. G. Shanks,
 * Applied Optics 31, 1992; used by S. O'Neil, GPU Gems 2 ch. 16 (the report drops the 3/2). */
AMB_INLINE f32x phase_mie(f32x cosine, float g)
{
    float factor = 3.0f * (1.0f - g * g) / (2.0f * (2.0f + g * g));
    return factor * (1.0f + cosine * cosine) * phase_lobe_(cosine, g);
}

#endif
