/* The clear sky by day: A. J. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999.
 * Luminance and chromaticity by R. Perez's formula,
 *
 *   F(θ, γ) = (1 + A e^(B/cos θ)) (1 + C e^(Dγ) + E cos²γ),  value = zenith · F(θ, γ)/F(0, θs),
 *
 * θ the angle from the zenith, γ from the sun, θs between the two; coefficients and zenith values are the paper's
 * appendix A.2, linear (and cubic) in turbidity and θs. The paper ends at the horizon; here
 *  - a direction below it has the colour of the horizon above it, so haze that takes sky_horizon_rgb meets the sky;
 *  - the sun below it leaves the sky of a sun on it, which darkens 100-fold in 6° (civil twilight);
 *  - colours outside Rec. 709 are moved towards grey until no channel is negative.
 *
 * Unit: RGB is linear Rec. 709 with Y the luminance in kcd/m² (a clear zenith is 1 to 10). y is up. Lanes functions;
 * pure; any thread. */
#ifndef AMBIANCE_SHADE_SKY_H
#define AMBIANCE_SHADE_SKY_H

#include "shade/color.h"

typedef struct amb_sky {
    v3 to_sun;         /* unit; where the sun is */
    float turbidity;   /* 1.7 (pure mountain air) … 10 (thick haze) */
    float perez[3][5]; /* A B C D E of luminance, x and y */
    v3 zenith;         /* luminance in kcd/m², chromaticity x, y straight up */
    v3 scale;          /* zenith / F(0, θs) */
    v3 glow_sun;       /* to_sun, not below the horizon: what γ is measured from */
    /* Luminance of a white matte surface that faces the sun: its illuminance outside the air, 127.5 klx, over π, less
     * what the air scatters and absorbs (appendix A.1: Rayleigh, Ångström aerosol, ozone, at 610, 550 and 465 nm). */
    v3 sun_rgb;
    v3 ambient_rgb; /* luminance of a white matte surface that faces up, lit by the sky without the sun */
} amb_sky;

/* to_sun: a unit vector of any height. turbidity is clamped to [1.7, 10]. */
amb_sky amb_sky_make(v3 to_sun, float turbidity);

/* One of the three of Perez's formulas. thin = e^(B/cosθ) (0 at the horizon). */
AMB_INLINE f32x sky_perez_(const float coefficient[5], f32x thin, f32x gamma, f32x cosine_gamma)
{
    f32x glow = f_exp(coefficient[3] * gamma), back = cosine_gamma * cosine_gamma;
    return (1.0f + coefficient[0] * thin) * ((1.0f + coefficient[2] * glow) + coefficient[4] * back);
}

AMB_INLINE v3x sky_xyy_at_(const amb_sky *sky, v3x unit, f32x cosine_zenith, bool horizon)
{
    f32x one = f_set(1.0f), cosine = f_clamp(v3x_dot(unit, v3x_splat(sky->glow_sun)), -one, one);
    f32x gamma = f_acos(cosine), value[3];
    const float *scale = &sky->scale.x;
    for (int i = 0; i < 3; i++) {
        f32x thin = f_set(0.0f);
        if (!horizon)
            thin = f_exp(sky->perez[i][1] / f_max(cosine_zenith, f_set(1.0e-3f)));
        value[i] = sky_perez_(sky->perez[i], thin, gamma, cosine) * scale[i];
    }
    return (v3x){value[1], value[2], value[0]};
}

/* The direction, or the horizon above it. */
AMB_INLINE v3x sky_above_horizon_(v3x direction)
{
    v3x up = {direction.x, f_max(direction.y, f_set(0.0f)), direction.z};
    f32x length = v3x_length(up);
    return v3x_scale(up, 1.0f / f_max(length, f_set(FLT_MIN)));
}

/* CIE chromaticity x, y and luminance in kcd/m² along a unit direction. */
AMB_INLINE v3x sky_xyy(const amb_sky *sky, v3x direction)
{
    v3x unit = sky_above_horizon_(direction);
    return sky_xyy_at_(sky, unit, unit.y, false);
}

AMB_INLINE v3x sky_rgb_of_xyy_(v3x c) { return color_clip_negative(color_rgb_of_xyz(color_xyz_of_xyy(c.x, c.y, c.z))); }

/* The sky's light along a unit direction, without the sun's disc: no channel negative. */
AMB_INLINE v3x sky_rgb(const amb_sky *sky, v3x direction) { return sky_rgb_of_xyy_(sky_xyy(sky, direction)); }

/* The same at the horizon under (or over) the direction, half the work: what haze along it scatters to the eye. */
AMB_INLINE v3x sky_horizon_rgb(const amb_sky *sky, v3x direction)
{
    v3x level = sky_above_horizon_((v3x){direction.x, f_set(0.0f), direction.z});
    return sky_rgb_of_xyy_(sky_xyy_at_(sky, level, f_set(0.0f), true));
}

/* The sun's disc: sun_rgb's light spread over a disc of angular radius acos(cosine_radius), dark towards the limb
 * (0.4 + 0.6·cos of the angle on the sun; P. Moon 1940), 0 outside. cosine_radius in [0, 1); the real one, 0.267°, is
 * 0.9999891. Its mean times the solid angle over π is sun_rgb. */
AMB_INLINE v3x sky_sun_disc(const amb_sky *sky, v3x direction, float cosine_radius)
{
    f32x cosine = v3x_dot(direction, v3x_splat(sky->to_sun));
    float width = 1.0f - cosine_radius;                                /* solid angle / 2π */
    f32x edge = f_saturate((cosine - cosine_radius) * (1.0f / width)); /* cos² on the sun: 1 - (r/R)² */
    f32x limb = (0.4f + 0.6f * f_sqrt(edge)) * 1.25f;                  /* mean 1 */
    f32x disc = f_sel(cosine > cosine_radius, limb, f_set(0.0f)) * (0.5f / width);
    return v3x_scale(v3x_splat(sky->sun_rgb), disc);
}

#endif
