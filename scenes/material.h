/* Materials: what a surface is made of, in maps, so that a scene names one instead of every texture and number. Several
 * are blended by weights on one surface, as ground is.
 *
 * Maps tile. The albedo is an asset; its luminance is the relief, from which the second map is made when the material
 * is loaded: slopes along u and v, height, and small-scale occlusion. */
#ifndef AMB_SCENES_MATERIAL_H
#define AMB_SCENES_MATERIAL_H

#include <ambiance/assets.h>
#include <ambiance/context.h>
#include <ambiance/math.h>
#include <ambiance/texture.h>

typedef struct amb_material {
    const char *asset;         /* name of the albedo */
    float size;                /* world units a tile */
    float bump;                /* slope of the relief, 0: smooth */
    float roughness;           /* m of the microfacets, 0…1 */
    float f0;                  /* reflectance at normal incidence */
    v3 tint;                   /* factor on the albedo */
    const amb_texture *albedo; /* the resolver's */
    amb_texture *relief;       /* the material's own: RGBA8: (slope u, slope v)/2 + ½, height, openness */
} amb_material;

/* Fills albedo and relief. Errors: those of the asset; MEMORY. */
amb_status material_load(const amb_context *context, amb_assets *assets, amb_material *material, amb_error *error);
void material_unload(amb_material *material);

/* One or a blend of several. */
typedef struct material_point {
    v3x albedo;  /* linear */
    v3x bent;    /* what the relief adds to a unit normal, world space, before it is made unit again */
    f32x height; /* of the relief, 0…1 */
    f32x open;   /* 1; less in hollows of the relief */
    f32x roughness, f0;
} material_point;

static const amb_sampler material_sampler = {
    .filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_REPEAT, AMB_REPEAT}, .max_anisotropy = 2};

/* The material at plane coordinates (world units) whose axes are the unit vectors along_u and along_v in the world; dx
 * and dy are the coordinates' change to the next pixel. */
AMB_INLINE material_point material_at(const amb_material *m, v2x plane, v2x dx, v2x dy, v3 along_u, v3 along_v)
{
    f32x scale = f_set(1.0f / m->size);
    v2x uv = v2x_scale(plane, scale), uv_dx = v2x_scale(dx, scale), uv_dy = v2x_scale(dy, scale);
    v4x colour = amb_sample_2d_grad(m->albedo, &material_sampler, uv, uv_dx, uv_dy);
    v4x relief = amb_sample_2d_grad(m->relief, &material_sampler, uv, uv_dx, uv_dy);
    f32x u = (1.0f - 2.0f * relief.x) * m->bump, v = (1.0f - 2.0f * relief.y) * m->bump;
    return (material_point){
        .albedo = v3x_mul(v4x_xyz(colour), v3x_splat(m->tint)),
        .bent = v3x_add(v3x_scale(v3x_splat(along_u), u), v3x_scale(v3x_splat(along_v), v)),
        .height = relief.z,
        .open = relief.w,
        .roughness = f_set(m->roughness),
        .f0 = f_set(m->f0),
    };
}

/* Only what is seen from farther away: the albedo. Its relief counts as flat. */
AMB_INLINE material_point material_far(const amb_material *m, v2x plane, v2x dx, v2x dy)
{
    f32x scale = f_set(1.0f / m->size), zero = f_set(0.0f);
    v4x colour = amb_sample_2d_grad(m->albedo, &material_sampler, v2x_scale(plane, scale), v2x_scale(dx, scale),
                                    v2x_scale(dy, scale));
    return (material_point){.albedo = v3x_mul(v4x_xyz(colour), v3x_splat(m->tint)),
                            .bent = {zero, zero, zero},
                            .height = f_set(0.5f),
                            .open = f_set(0.9f),
                            .roughness = f_set(m->roughness),
                            .f0 = f_set(m->f0)};
}

AMB_INLINE material_point material_none(void)
{
    f32x zero = f_set(0.0f);
    v3x none = {zero, zero, zero};
    return (material_point){none, none, zero, zero, zero, zero};
}

/* sum += weight · p; weights of a point sum to 1. */
AMB_INLINE void material_add(material_point *sum, const material_point *p, f32x weight)
{
    sum->albedo = v3x_add(sum->albedo, v3x_scale(p->albedo, weight));
    sum->bent = v3x_add(sum->bent, v3x_scale(p->bent, weight));
    sum->height += p->height * weight;
    sum->open += p->open * weight;
    sum->roughness += p->roughness * weight;
    sum->f0 += p->f0 * weight;
}

#endif
