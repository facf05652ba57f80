/* Specular highlights. Directions are unit vectors that point away from the surface: n normal, l to the light, v to the
 * eye. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_SPECULAR_H
#define AMBIANCE_SHADE_SPECULAR_H

#include <ambiance/math.h>
#include <ambiance/vec.h>

/* cosineᵉ, cosine ≥ 0, exponent > 0. Whole exponents are multiplied out: within 2⁻²⁴·exponent of the value. */
AMB_INLINE f32x specular_power(f32x cosine, float exponent)
{
    if (exponent <= 1024.0f && (float)(int)exponent == exponent)
        return f_powi(cosine, (int)exponent);
    return f_pow(cosine, f_set(exponent));
}

/* max(0, r·v)ᵉ, r the mirror of l about n; 0 where the light is below the surface. exponent > 0.
 * B. T. Phong, CACM 18(6), 1975. */
AMB_INLINE f32x specular_phong(v3x n, v3x l, v3x v, float exponent)
{
    f32x n_dot_l = v3x_dot(n, l);
    v3x mirror = v3x_sub(v3x_scale(n, 2.0f * n_dot_l), l);
    f32x cosine = f_max(v3x_dot(mirror, v), f_set(0.0f));
    return f_sel(n_dot_l > 0.0f, specular_power(cosine, exponent), f_set(0.0f));
}

/* max(0, n·h)ᵉ, h halfway between l and v; 0 where the light is below the surface. exponent > 0.
 * J. F. Blinn, SIGGRAPH 1977. */
AMB_INLINE f32x specular_blinn_phong(v3x n, v3x l, v3x v, float exponent)
{
    v3x halfway = v3x_normalize(v3x_add(l, v));
    f32x cosine = f_max(v3x_dot(n, halfway), f_set(0.0f));
    return f_sel(v3x_dot(n, l) > 0.0f, specular_power(cosine, exponent), f_set(0.0f));
}

/* Beckmann's distribution of microfacet slopes, per steradian: e^(-tan²θ/m²)/(π m² cos⁴θ), θ between normal and half
 * vector, m in (0, 1] the RMS slope, a value a lane. Its projection ∫ D·cosθ dω over the hemisphere is 1. */
AMB_INLINE f32x specular_beckmann_m(f32x n_dot_h, f32x m)
{
    f32x c2 = f_max(n_dot_h * n_dot_h, f_set(1.0e-6f)), m2 = m * m;
    f32x d = f_exp((c2 - 1.0f) / (c2 * m2)) / (c2 * c2 * (AMB_PI * m2));
    return f_sel(n_dot_h > 0.0f, d, f_set(0.0f));
}
/* The same with one m for all lanes. */
AMB_INLINE f32x specular_beckmann(f32x n_dot_h, float m) { return specular_beckmann_m(n_dot_h, f_set(m)); }

/* BRDF D·G/(4 n·l n·v) without its Fresnel factor, per steradian: multiply by F (fresnel_schlick of v·h), by n·l and by
 * the light. 0 where light or eye is below the surface. m as above. R. L. Cook and K. E. Torrance, TOG 1(1), 1982, with
 * the 4 of later derivations (the paper has π). */
AMB_INLINE f32x specular_cook_torrance_m(v3x n, v3x l, v3x v, f32x m)
{
    v3x h = v3x_normalize(v3x_add(l, v));
    f32x nl = v3x_dot(n, l), nv = v3x_dot(n, v), nh = v3x_dot(n, h), vh = f_max(v3x_dot(v, h), f_set(1.0e-6f));
    f32x shadowing = f_min(f_min(2.0f * nh * nv / vh, 2.0f * nh * nl / vh), f_set(1.0f));
    f32x brdf = specular_beckmann_m(nh, m) * shadowing / (4.0f * nl * nv);
    return f_sel((nl > 0.0f) & (nv > 0.0f), brdf, f_set(0.0f));
}
AMB_INLINE f32x specular_cook_torrance(v3x n, v3x l, v3x v, float m)
{
    return specular_cook_torrance_m(n, l, v, f_set(m));
}

#endif
