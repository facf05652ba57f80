/* Shadow maps: depth seen from a light, compared and filtered (percentage-closer, W. Reeves, D. Salesin, R. Cook,
 * SIGGRAPH 1987), for directional lights (cascades), spot lights (one perspective map) and point lights (a cube).
 *
 * Maps hold depth 0…1 as the rasterizer writes it. A point is moved off its surface along the normal by some texels
 * before it is compared, so that no surface shades itself. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_SHADOW_H
#define AMBIANCE_SHADE_SHADOW_H

#include <ambiance/texture.h>

#define SHADOW_CASCADES 4

typedef struct amb_shadow {
    int cascades;                            /* maps in use, nearest first; 0: no shadow */
    const amb_texture *map[SHADOW_CASCADES]; /* 2D; R32F */
    m4 world_to_light[SHADOW_CASCADES];      /* to the map's clip space; affine for a directional light */
    float texel[SHADOW_CASCADES];            /* a texel's width in world units; of a spot or cube: at distance 1 */
    const amb_texture *cube;                 /* R32F cube of a point light, instead of the maps */
    v3 position;                             /* of a spot or point light */
    float near, far;                         /* of the cube's six views */
    bool perspective;                        /* a spot's map */
    int taps;                                /* comparisons along a side of the filter, a texel apart; ≥ 1 */
    float offset;                            /* texels along the normal */
    float bias;                              /* in depth: affine maps */
} amb_shadow;

static const amb_sampler shadow_sampler = {
    .filter = AMB_BILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}, .compare = AMB_LESS_EQUAL};

/* taps² bilinear comparisons about uv; step: a texel, in uv. */
AMB_INLINE f32x shadow_filter_(const amb_texture *map, v2x uv, f32x reference, float step, int taps)
{
    f32x sum = f_set(0.0f);
    float first = -0.5f * (float)(taps - 1) * step;
    for (int j = 0; j < taps; j++)
        for (int i = 0; i < taps; i++) {
            v2x at = {uv.x + (first + (float)i * step), uv.y + (first + (float)j * step)};
            sum += amb_compare_2d_lod(map, &shadow_sampler, at, reference, f_set(0.0f));
        }
    return sum * (1.0f / (float)(taps * taps));
}

/* Clip coordinates to the map's uv (v down) and depth. */
AMB_INLINE v3x shadow_uv_(v4x clip)
{
    f32x scale = 1.0f / clip.w;
    return (v3x){clip.x * scale * 0.5f + 0.5f, 0.5f - clip.y * scale * 0.5f, clip.z * scale};
}

/* A directional light's: the nearest cascade that holds the point with its filter; beyond the last, light. */
AMB_INLINE f32x shadow_cascaded(const amb_shadow *s, v3x world, v3x normal, maskx live)
{
    f32x lit = f_set(1.0f);
    maskx open = live;
    for (int i = 0; i < s->cascades && m_any(open); i++) {
        int size = amb_texture_describe(s->map[i]).width;
        float step = 1.0f / (float)size, margin = 0.5f * (float)(s->taps + 2) * step;
        v3x at = v3x_add(world, v3x_scale(normal, f_set(s->texel[i] * s->offset)));
        v3x p = shadow_uv_(m4_project_x(s->world_to_light[i], at));
        maskx here = open & (p.x > margin) & (p.x < 1.0f - margin) & (p.y > margin) & (p.y < 1.0f - margin);
        if (m_any(here)) {
            f32x reference = f_saturate(p.z - s->bias);
            lit = f_sel(here, shadow_filter_(s->map[i], (v2x){p.x, p.y}, reference, step, s->taps), lit);
        }
        open = open & ~here;
    }
    return lit;
}

/* A spot light's: outside its map there is no light anyway. */
AMB_INLINE f32x shadow_spot(const amb_shadow *s, v3x world, v3x normal, maskx live)
{
    v3x way = v3x_sub(v3x_splat(s->position), world);
    f32x distance = v3x_length(way);
    v4x clip =
        m4_project_x(s->world_to_light[0], v3x_add(world, v3x_scale(normal, distance * (s->texel[0] * s->offset))));
    maskx here = live & (clip.w > 0.0f);
    if (!m_any(here))
        return f_set(1.0f);
    v3x p = shadow_uv_(clip);
    here = here & (p.x >= 0.0f) & (p.x <= 1.0f) & (p.y >= 0.0f) & (p.y <= 1.0f);
    int size = amb_texture_describe(s->map[0]).width;
    f32x lit = shadow_filter_(s->map[0], (v2x){p.x, p.y}, f_saturate(p.z - s->bias), 1.0f / (float)size, s->taps);
    return f_sel(here, lit, f_set(1.0f));
}

/* A point light's: the cube's faces hold perspective depth along their own axes. */
AMB_INLINE f32x shadow_cube(const amb_shadow *s, v3x world, v3x normal, maskx live)
{
    if (!m_any(live))
        return f_set(1.0f);
    v3x from = v3x_sub(world, v3x_splat(s->position));
    f32x distance = v3x_length(from);
    v3x moved = v3x_add(from, v3x_scale(normal, distance * (s->texel[0] * s->offset)));
    /* Two directions across the ray, to spread the filter on. */
    maskx steep = f_abs(moved.y) > 0.9f * distance;
    v3x side = v3x_sel(steep, v3x_splat((v3){1, 0, 0}), v3x_splat((v3){0, 1, 0}));
    v3x a = v3x_scale(v3x_normalize(v3x_cross(side, moved)), distance * s->texel[0]);
    v3x b = v3x_scale(v3x_normalize(v3x_cross(moved, a)), distance * s->texel[0]);
    f32x sum = f_set(0.0f);
    float first = -0.5f * (float)(s->taps - 1), k = s->far / (s->far - s->near);
    for (int j = 0; j < s->taps; j++)
        for (int i = 0; i < s->taps; i++) {
            v3x d =
                v3x_add(moved, v3x_add(v3x_scale(a, f_set(first + (float)i)), v3x_scale(b, f_set(first + (float)j))));
            f32x axis = f_max(f_max(f_abs(d.x), f_abs(d.y)), f_max(f_abs(d.z), f_set(s->near)));
            f32x reference = f_saturate(k - k * s->near / axis - s->bias);
            sum += amb_compare_cube_lod(s->cube, &shadow_sampler, d, reference, f_set(0.0f));
        }
    return sum * (1.0f / (float)(s->taps * s->taps));
}

/* How much of the light gets past everything on its way, 0…1; lanes that are not live may hold anything. */
AMB_INLINE f32x shadow_at(const amb_shadow *s, v3x world, v3x normal, maskx live)
{
    if (s->cube)
        return shadow_cube(s, world, normal, live);
    if (!s->cascades)
        return f_set(1.0f);
    return s->perspective ? shadow_spot(s, world, normal, live) : shadow_cascaded(s, world, normal, live);
}

#endif
