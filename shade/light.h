/* Directional, point and spot lights, and how a surface answers them: Lambert's diffuse with Blinn-Phong's or Cook and
 * Torrance's highlight. The unit of a light's colour is that of diffuse.h: radiance of a white surface that faces it
 * (1/π is taken into the light); a point or spot light's is that at distance 1. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_LIGHT_H
#define AMBIANCE_SHADE_LIGHT_H

#include "shade/diffuse.h"
#include "shade/fresnel.h"
#include "shade/specular.h"

typedef enum amb_light_kind { AMB_LIGHT_DIRECTIONAL, AMB_LIGHT_POINT, AMB_LIGHT_SPOT } amb_light_kind;

typedef struct amb_light {
    amb_light_kind kind;
    v3 rgb;
    v3 to_light;                /* unit; directional */
    v3 position;                /* point, spot */
    float reach;                /* its light ends there; > 0; point, spot */
    v3 axis;                    /* unit, the way a spot shines */
    float cos_inner, cos_outer; /* full light within, none outside; cos_outer < cos_inner; spot */
} amb_light;

/* 1/d² brought to 0 at `reach` by (1 - (d/reach)⁴)², and finite at the light itself: d² counts as at least `nearest`².
 * B. Karis, "Real Shading in Unreal Engine 4", SIGGRAPH 2013 course. squared: d². */
AMB_INLINE f32x light_attenuation(f32x squared, float reach, float nearest)
{
    f32x ratio = squared * (1.0f / (reach * reach));
    f32x window = f_max(1.0f - ratio * ratio, f_set(0.0f));
    return window * window / f_max(squared, f_set(nearest * nearest));
}

/* 1 inside the inner cone, 0 outside the outer, smoothstep of the cosine between. */
AMB_INLINE f32x light_spot_cone(f32x cosine, float cos_inner, float cos_outer)
{
    return f_smoothstep(f_set(cos_outer), f_set(cos_inner), cosine);
}

/* What arrives at a point, shadows aside. */
typedef struct amb_arriving {
    v3x to_light;  /* unit */
    f32x strength; /* factor on the light's rgb */
} amb_arriving;

AMB_INLINE amb_arriving light_at(const amb_light *light, v3x point)
{
    if (light->kind == AMB_LIGHT_DIRECTIONAL)
        return (amb_arriving){v3x_splat(light->to_light), f_set(1.0f)};
    v3x way = v3x_sub(v3x_splat(light->position), point);
    f32x squared = f_max(v3x_dot(way, way), f_set(1.0e-12f));
    amb_arriving a = {v3x_scale(way, 1.0f / f_sqrt(squared)), light_attenuation(squared, light->reach, 0.25f)};
    if (light->kind == AMB_LIGHT_SPOT) {
        f32x cosine = -v3x_dot(a.to_light, v3x_splat(light->axis));
        a.strength *= light_spot_cone(cosine, light->cos_inner, light->cos_outer);
    }
    return a;
}

/* A surface's answer to one light: factors on albedo and on 1, both already times n·l where that belongs to them. */
typedef struct amb_response {
    f32x diffuse, specular;
} amb_response;

/* The coursework's: Lambert, and Blinn's highlight of an exponent a lane, as bright as `strength` wants. */
AMB_INLINE amb_response light_blinn_phong(v3x n, v3x to_light, v3x to_eye, f32x exponent, f32x strength)
{
    f32x facing = v3x_dot(n, to_light);
    f32x cosine = f_max(v3x_dot(n, v3x_normalize(v3x_add(to_light, to_eye))), f_set(0.0f));
    f32x highlight = f_sel(facing > 0.0f, f_pow(cosine, exponent), f_set(0.0f));
    return (amb_response){diffuse_lambert(facing), strength * highlight};
}

/* Lambert under a Cook-Torrance layer of roughness m (the RMS slope, in (0, 1], a value a lane) and Schlick's Fresnel
 * term; what it reflects of the light as it comes in does not reach the base. Times π, as the light's unit has 1/π in
 * it. */
AMB_INLINE amb_response light_cook_torrance(v3x n, v3x to_light, v3x to_eye, f32x m, f32x f0)
{
    v3x h = v3x_normalize(v3x_add(to_light, to_eye));
    f32x lambert = diffuse_lambert(v3x_dot(n, to_light));
    f32x fresnel = fresnel_schlick(v3x_dot(to_eye, h), f0);
    f32x layer = specular_cook_torrance_m(n, to_light, to_eye, m);
    return (amb_response){lambert * (1.0f - fresnel_schlick(lambert, f0)), AMB_PI * fresnel * layer * lambert};
}

#endif
