/* Tangent-space surface detail: normal maps ("DOT3"), heights, parallax. A surface's frame is its unit tangent t (along
 * +u), bitangent b (along +v) and normal n. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_NORMAL_MAP_H
#define AMBIANCE_SHADE_NORMAL_MAP_H

#include <ambiance/vec.h>

/* A texel in [0, 1]³ to the unit tangent-space normal 2c - 1. strength scales the slope: 0 flat, 1 as painted. */
AMB_INLINE v3x normal_map_decode(v3x texel, float strength)
{
    f32x x = texel.x * 2.0f - 1.0f, y = texel.y * 2.0f - 1.0f, z = texel.z * 2.0f - 1.0f;
    return v3x_normalize((v3x){x * strength, y * strength, z});
}

/* The inverse, of a unit normal: (m + 1)/2. */
AMB_INLINE v3x normal_map_encode(v3x m) { return (v3x){m.x * 0.5f + 0.5f, m.y * 0.5f + 0.5f, m.z * 0.5f + 0.5f}; }

/* n × t times the handedness (+1, or -1 where the texture is mirrored). */
AMB_INLINE v3x normal_map_bitangent(v3x t, v3x n, f32x handedness) { return v3x_scale(v3x_cross(n, t), handedness); }

/* Tangent space → the space of t, b and n, normalised: they may come from interpolation, not quite unit or orthogonal.
 */
AMB_INLINE v3x normal_map_apply(v3x m, v3x t, v3x b, v3x n)
{
    return v3x_normalize(v3x_add(v3x_add(v3x_scale(t, m.x), v3x_scale(b, m.y)), v3x_scale(n, m.z)));
}

/* A direction into tangent space; the inverse of apply where t, b and n are orthonormal. */
AMB_INLINE v3x normal_map_to_tangent(v3x direction, v3x t, v3x b, v3x n)
{
    return (v3x){v3x_dot(direction, t), v3x_dot(direction, b), v3x_dot(direction, n)};
}

/* Tangent-space normal of a height field from its slopes ∂h/∂u and ∂h/∂v (height and u, v in the same unit).
 * J. F. Blinn, SIGGRAPH 1978. */
AMB_INLINE v3x normal_of_slopes(f32x slope_u, f32x slope_v)
{
    return v3x_normalize((v3x){-slope_u, -slope_v, f_set(1.0f)});
}

/* Texture coordinates moved toward the eye by the height there: uv + (height·scale + bias)·eye_xy, to_eye a unit vector
 * in tangent space, height in [0, 1]. Offset limiting (no division by eye_z) keeps grazing views calm. T. Kaneko et
 * al., ICAT 2001; T. Welsh, "Parallax Mapping with Offset Limiting", 2004. */
AMB_INLINE v2x parallax_offset(v2x uv, v3x to_eye, f32x height, float scale, float bias)
{
    f32x reach = height * scale + bias;
    return (v2x){uv.x + to_eye.x * reach, uv.y + to_eye.y * reach};
}

#endif
