/* Single scattering in a planet's air after S. O'Neil, "Accurate Atmospheric Scattering", GPU Gems 2 ch. 16 (and the
 * Ambiance report, its Earth chapter).
 *
 *   out-scattering  t(PaPb, λ) = 4πK(λ) ∫ e^(-h/H0) ds
 *   in-scattering   I(λ) = Is(λ) K(λ) F(θ, g) ∫ e^(-h/H0) e^(-t(P→sun) - t(P→eye)) ds
 *
 * O'Neil's look-up table, the optical depth from height h along zenith angle α to space, is replaced by
 * H0·e^(-h/H0)·e^(p(1 - cos α)) with a polynomial p; here p is fitted per planet, not given for one. The depth toward
 * the eye is summed along the way, so only the sun's uses the fit.
 *
 * Lengths are in any unit, the same throughout; the planet's centre is the origin. Lanes functions; pure; any thread.
 */
#ifndef AMBIANCE_SHADE_ATMOSPHERE_H
#define AMBIANCE_SHADE_ATMOSPHERE_H

#include "shade/phase.h"
#include <ambiance/math.h>
#include <ambiance/vec.h>

#define ATMOSPHERE_FIT 7      /* coefficients of p; atmosphere_depth has them one by one */
#define ATMOSPHERE_SAMPLES 64 /* most samples of a ray */

typedef struct amb_atmosphere {
    float radius, top;  /* of the ground and of the air's end; 0 < radius < top */
    float scale_height; /* H0: where density falls to 1/e */
    v3 rayleigh;        /* 4πK of molecules at the ground, a unit of length, for r, g, b; ∝ 1/λ⁴ */
    v3 mie;             /* 4πK of aerosols */
    float asymmetry;    /* g of the aerosols' phase function, in (-1, 1) */
    v3 sun_rgb;         /* radiance that a surface facing the sun would reflect if white */
    float sun_softness; /* tangent of the angle over which the sun sets behind the planet; 0.0093 for the Earth's sun */
    int samples;        /* 1…ATMOSPHERE_SAMPLES segments a view ray */
    float fit[ATMOSPHERE_FIT], fit_end; /* made by amb_atmosphere_fit: p(x), for x = 1 - cos α in [0, fit_end] */
} amb_atmosphere;

/* Fills fit and fit_end from radius, top and scale_height: polynomial interpolation at Chebyshev nodes of the logarithm
 * of the numerically integrated depth (64-bit sums of amb_exp). About 0.2 ms. */
void amb_atmosphere_fit(amb_atmosphere *air);

/* Where a ray from `origin` along the unit `direction` meets a sphere about the centre: false lanes miss. */
AMB_INLINE maskx atmosphere_sphere(v3x origin, v3x direction, float radius, f32x *enter, f32x *leave)
{
    f32x b = v3x_dot(origin, direction);
    v3x nearest = v3x_sub(origin, v3x_scale(direction, b));
    f32x d = f_set(radius * radius) - v3x_dot(nearest, nearest); /* from the perigee: no cancellation far away */
    f32x half = f_sqrt(f_max(d, f_set(0.0f)));
    *enter = -b - half;
    *leave = -b + half;
    return d > 0.0f;
}

/* eᵃ for a ≤ 40, within 8e-6 of itself: what sums of a few segments need, at half f_exp's work. Below -87 it stays at
 * the least normal number. The Taylor series of 2ˣ about 0 to x⁵, for x in ±½. */
AMB_INLINE f32x atmosphere_exp_(f32x a)
{
    f32x t = f_max(a, f_set(-87.0f)) * 1.44269504f, whole = (t + 12582912.0f) - 12582912.0f, x = t - whole;
    f32x x2 = x * x; /* by pairs: a short chain of operations */
    f32x p = (1.0f + 0.69314718f * x) + x2 * ((0.24022651f + 0.05550411f * x) + x2 * (0.00961813f + 0.00133336f * x));
    return p * f_from_bits((f_to_i(whole) + 127) << 23);
}

/* e^(-h/H0) at a distance r from the centre; 1 below the ground. */
AMB_INLINE f32x atmosphere_density(const amb_atmosphere *air, f32x r)
{
    return atmosphere_exp_(f_min((air->radius - r) * (1.0f / air->scale_height), f_set(0.0f)));
}

/* ∫ e^(-h/H0) ds from a point of density `density` to space along a direction whose zenith cosine is given: the fit. */
AMB_INLINE f32x atmosphere_depth(const amb_atmosphere *air, f32x density, f32x zenith_cosine)
{
    f32x x = f_clamp(1.0f - zenith_cosine, f_set(0.0f), f_set(air->fit_end));
    const float *c = air->fit;
    f32x x2 = x * x; /* by pairs: a short chain of operations */
    f32x p = (c[0] + c[1] * x) + x2 * ((c[2] + c[3] * x) + x2 * ((c[4] + c[5] * x) + x2 * c[6]));
    return density * atmosphere_exp_(p) * air->scale_height;
}

/* 1 where the sun is seen from distance r at that zenith cosine, 0 behind the planet, smooth while it sets. */
AMB_INLINE f32x atmosphere_sunlight(const amb_atmosphere *air, f32x r, f32x zenith_cosine)
{
    if (!m_any(zenith_cosine <= 0.0f))
        return f_set(1.0f);
    f32x perigee = r * f_sqrt(f_max(1.0f - zenith_cosine * zenith_cosine, f_set(0.0f)));
    f32x way = f_max(-zenith_cosine * r, f_set(0.0f)); /* to the perigee */
    f32x soft = way * air->sun_softness + 1.0e-6f * air->radius;
    f32x seen = f_saturate((perigee - air->radius) / soft + 0.5f);
    return f_sel(zenith_cosine > 0.0f, f_set(1.0f), seen);
}

typedef struct atmosphere_light {
    v3x in_scatter; /* radiance added along the ray: the additive sphere and the sky dome */
    v3x transmit;   /* what is left of the light behind: the multiplicative sphere */
} atmosphere_light;

/* Air between t = near and t = far of a ray (unit direction), sunlight from the unit direction to_sun. Clip [near, far]
 * to the air (atmosphere_sphere with `top`) and to the ground first; far ≤ near gives no air. */
AMB_INLINE atmosphere_light atmosphere_along(const amb_atmosphere *air, v3x origin, v3x direction, f32x near, f32x far,
                                             v3 to_sun)
{
    v3x zero = v3x_splat((v3){0.0f, 0.0f, 0.0f});
    v3x scatter = v3x_splat(v3_add(air->rayleigh, air->mie));
    f32x step = f_max(far - near, f_set(0.0f)) * (1.0f / (float)air->samples);
    /* Along the ray, r² = perigee² + (way from it)², and the height over the plane across the sun's rays is linear. */
    f32x to_perigee = v3x_dot(origin, direction);
    v3x perigee = v3x_sub(origin, v3x_scale(direction, to_perigee));
    f32x perigee2 = v3x_dot(perigee, perigee), cosine = v3x_dot(direction, v3x_splat(to_sun));
    f32x sunward = v3x_dot(perigee, v3x_splat(to_sun)), from_perigee = to_perigee + near;
    f32x depth = f_set(0.0f); /* from the eye to the segment's start */
    v3x sum = zero;
    for (int i = 0; i < air->samples; i++) {
        f32x way = from_perigee + step * ((float)i + 0.5f);
        f32x r = f_sqrt(perigee2 + way * way);
        f32x density = atmosphere_density(air, r);
        f32x zenith_cosine = (sunward + way * cosine) / f_max(r, f_set(FLT_MIN));
        f32x passed = depth + 0.5f * (density * step) + atmosphere_depth(air, density, zenith_cosine);
        f32x light = density * step * atmosphere_sunlight(air, r, zenith_cosine);
        sum = v3x_add(sum,
                      (v3x){light * atmosphere_exp_(-scatter.x * passed), light * atmosphere_exp_(-scatter.y * passed),
                            light * atmosphere_exp_(-scatter.z * passed)});
        depth += density * step;
    }
    v3x per_phase = v3x_add(v3x_scale(v3x_splat(air->rayleigh), phase_rayleigh(cosine)),
                            v3x_scale(v3x_splat(air->mie), phase_mie(cosine, air->asymmetry)));
    v3x sun = v3x_splat(v3_scale(air->sun_rgb, 0.25f)); /* K = (4πK)/(4π), and radiance = π × white's: 1/4 in all */
    return (atmosphere_light){
        .in_scatter = v3x_mul(v3x_mul(sun, per_phase), sum),
        .transmit = {atmosphere_exp_(-scatter.x * depth), atmosphere_exp_(-scatter.y * depth),
                     atmosphere_exp_(-scatter.z * depth)},
    };
}

#endif
