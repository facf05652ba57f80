/* Noise shapes that the built-in planets share. Lanes functions of unit directions; pure. */
#ifndef AMB_SCENES_PLANET_NOISE_H
#define AMB_SCENES_PLANET_NOISE_H

#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <ambiance/vec.h>

/* Gradient-noise fBm, gain ½, about -1…1. */
AMB_INLINE f32x planet_fbm(v3x p, uint32_t seed, int octaves)
{
    return fbm3(noise_gradient3, p, (amb_lattice){.seed = seed}, (amb_fbm){octaves, 2.0f, 0.5f}).value * 1.6f;
}

/* Moves a direction along the sphere by a divergence-free flow (the gradient of a noise turned by 90°; R. Bridson et
 * al., "Curl-Noise for Procedural Fluid Flow", SIGGRAPH 2007): features wind up without tearing. */
AMB_INLINE v3x planet_swirl(v3x direction, float frequency, float strength, uint32_t seed)
{
    noise3x n = noise_gradient3(v3x_scale(direction, f_set(frequency)), (amb_lattice){.seed = seed});
    v3x flow = v3x_cross(n.slope, direction);
    return v3x_normalize(v3x_add(direction, v3x_scale(flow, f_set(strength))));
}

/* e^(-((x - centre)/width)²). */
AMB_INLINE f32x planet_bump(f32x x, float centre, float width)
{
    f32x t = (x - centre) * (1.0f / width);
    return f_exp(-(t * t));
}

AMB_INLINE v3x planet_mix(v3x a, v3 b, f32x t) { return v3x_lerp(a, v3x_splat(b), t); }

#endif
