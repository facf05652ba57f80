/* Noise shapes that the built-in planets share. Lanes functions of unit directions; pure. */
#ifndef AMB_SCENES_PLANET_NOISE_H
#define AMB_SCENES_PLANET_NOISE_H

#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <ambiance/random.h>
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

/* Craters: bowls to -1 with rims to +0.3, at most one in each cell of the integer lattice; some cut the surface only
 * with their edge. */
AMB_INLINE f32x planet_craters(v3x p, uint32_t seed)
{
    v3x base = {f_floor(p.x - 0.5f), f_floor(p.y - 0.5f), f_floor(p.z - 0.5f)};
    f32x height = f_set(0.0f);
    for (int i = 0; i < 8; i++) { /* no crater reaches 0.7 from its middle, so these cells have all that reach p */
        v3x cell = v3x_add(base, v3x_splat((v3){(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)}));
        u4x h = u4x_hash((u4x){i_as_u(f_to_i(cell.x)), i_as_u(f_to_i(cell.y)), i_as_u(f_to_i(cell.z)), u_set(seed)});
        v3x centre = {cell.x + 0.2f + 0.6f * f_unit(h.x), cell.y + 0.2f + 0.6f * f_unit(h.y),
                      cell.z + 0.2f + 0.6f * f_unit(h.z)};
        f32x size = f_unit(h.w), away = v3x_length(v3x_sub(p, centre)) / (0.10f + 0.28f * size * size);
        f32x rim = (away - 1.0f) * (away - 1.0f);
        height = height + f_min(away * away - 1.0f, f_set(0.0f)) +
                 0.3f * f_exp(rim * f_sel(away < 1.0f, f_set(-30.0f), f_set(-9.0f)));
    }
    return height;
}

AMB_INLINE v3x planet_mix(v3x a, v3 b, f32x t) { return v3x_lerp(a, v3x_splat(b), t); }

#endif
