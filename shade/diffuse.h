/* Diffuse lighting from the cosine between surface normal and light, n·l in [-1, 1]. Results are factors for the
 * light's radiance times the albedo (1 = facing the light); 1/π is taken into the light. Lanes functions; pure; any
 * thread. */
#ifndef AMBIANCE_SHADE_DIFFUSE_H
#define AMBIANCE_SHADE_DIFFUSE_H

#include <ambiance/math.h>
#include <ambiance/vec.h>

/* J. H. Lambert, Photometria, 1760: n·l, never below 0. */
AMB_INLINE f32x diffuse_lambert(f32x n_dot_l) { return f_max(n_dot_l, f_set(0.0f)); }

/* (n·l + w)/(1 + w), never below 0: light reaches acos(-w) around the object. wrap w in [0, 1]; 0 is Lambert.
 * Ambiance report, fig. 3, after S. Green, GPU Gems ch. 16. */
AMB_INLINE f32x diffuse_wrapped(f32x n_dot_l, float wrap)
{
    return f_max((n_dot_l + wrap) * (1.0f / (1.0f + wrap)), f_set(0.0f));
}

/* The wrapped diffuse raised to k > 0; k below 1 evens the lit side and sharpens the terminator. The report's planets
 * use k = 0.47 (fig. 4). */
AMB_INLINE f32x diffuse_wrapped_contrast(f32x n_dot_l, float wrap, float k)
{
    return f_pow(diffuse_wrapped(n_dot_l, wrap), f_set(k));
}

/* How far a surface is out of the wrapped zone: 0 where the wrapped light ends (n·l = -w), 1 from n·l = w on, by
 * smoothstep. Light there has passed under the surface and takes its tint. */
AMB_INLINE f32x diffuse_wrap_depth(f32x n_dot_l, float wrap)
{
    float w = wrap > 0.0f ? wrap : FLT_MIN;
    return f_smoothstep(f_set(-w), f_set(w), n_dot_l);
}

/* Wrapped diffuse whose light turns to `tint` (linear RGB factor) in the wrapped zone: the gas giants (report, fig.
 * 24). */
AMB_INLINE v3x diffuse_wrapped_tinted(f32x n_dot_l, float wrap, v3 tint)
{
    f32x lit = diffuse_wrapped(n_dot_l, wrap);
    v3x colour = v3x_lerp(v3x_splat(tint), v3x_splat((v3){1.0f, 1.0f, 1.0f}), diffuse_wrap_depth(n_dot_l, wrap));
    return v3x_scale(colour, lit);
}

/* max(0, n·-l), what city lights are multiplied by (report, fig. 12). */
AMB_INLINE f32x diffuse_night(f32x n_dot_l) { return f_max(-n_dot_l, f_set(0.0f)); }

/* (1 - n·v)ᵏ: a ring along the silhouette of a sphere; k > 0, larger is thinner. Faces that look away (n·v < 0) count
 * as the silhouette. Report, fig. 20: subtracted from the clouds' alpha, darkens the gas giants' edges. */
AMB_INLINE f32x view_aligned_ring(f32x n_dot_v, float k) { return f_pow(1.0f - f_saturate(n_dot_v), f_set(k)); }

#endif
