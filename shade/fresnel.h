/* How much a surface reflects, from the cosine between view direction and normal (or half vector). Cosines are clamped
 * to [0, 1]; results are in [0, 1]. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_FRESNEL_H
#define AMBIANCE_SHADE_FRESNEL_H

#include <ambiance/math.h>

/* F0 + (1 - F0)(1 - cosθ)⁵, F0 the reflectance at normal incidence in [0, 1].
 * C. Schlick, Computer Graphics Forum 13(3), 1994; the same as the report's (1-v·h)⁵ + F0(1-(1-v·h)⁵). */
AMB_INLINE f32x fresnel_schlick(f32x cosine, f32x f0)
{
    f32x u = 1.0f - f_saturate(cosine), u2 = u * u;
    return f0 + (1.0f - f0) * (u2 * u2 * u);
}

/* 1 - (v·n)ᵏ, k > 0: the report's term for Julia sets, statues and car paint: 0 facing the eye, 1 at the silhouette. */
AMB_INLINE f32x fresnel_power(f32x v_dot_n, float k) { return 1.0f - f_pow(f_saturate(v_dot_n), f_set(k)); }

/* Exact for an unpolarised wave from vacuum onto a dielectric of refractive index ior ≥ 1 (A. Fresnel). */
AMB_INLINE f32x fresnel_dielectric(f32x cosine, float ior)
{
    f32x c = f_saturate(cosine), least = f_set(FLT_MIN);        /* 0/0 at ior 1, grazing: 0 */
    f32x t = f_sqrt((ior * ior - 1.0f) + c * c) * (1.0f / ior); /* cosine inside, Snell's law */
    f32x s = (c - ior * t) / f_max(c + ior * t, least), p = (t - ior * c) / f_max(t + ior * c, least);
    return 0.5f * (s * s + p * p);
}

#endif
