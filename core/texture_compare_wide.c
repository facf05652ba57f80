/* Comparison sampling of shadow maps: compare first, filter the results. */
#include "core/compare_lanes.h"
#include "core/texture_coordinates.h"

typedef struct {
    const amb_texture *texture;
    amb_filter filter;
    amb_compare mode;
    f32x reference;
} comparison;

AMB_INLINE comparison comparison_of(const amb_texture *t, const amb_sampler *s, f32x reference)
{
    amb_compare mode = s->compare == AMB_COMPARE_DEFAULT ? AMB_LESS_EQUAL : s->compare;
    return (comparison){t, s->filter, mode, reference};
}

AMB_INLINE f32x compare_texel(const comparison *c, texture_storage store, const colorx *texel)
{
    f32x red = store == STORE_UNORM8 ? texel->c[0] * (1.0f / 255.0f) : texel->c[0];
    return f_sel(compare_lanes(c->mode, c->reference, red), f_set(1.0f), f_set(0.0f));
}

/* The results of one texel (NEAREST) or of the 2×2 from it on, row by row. */
AMB_INLINE void compare_texels_of(const comparison *c, texture_storage store, i32x texel, i32x pitch, f32x result[4])
{
    colorx a, b;
    if (c->filter == AMB_NEAREST) {
        fetch_texel(c->texture, store, texel, &a);
        result[0] = compare_texel(c, store, &a);
        return;
    }
    for (int row = 0; row < 2; row++) {
        fetch_pair(c->texture, store, row ? texel + pitch : texel, &a, &b);
        result[2 * row] = compare_texel(c, store, &a);
        result[2 * row + 1] = compare_texel(c, store, &b);
    }
}

static __attribute__((noinline)) void compare_texels(const comparison *c, i32x texel, i32x pitch, f32x result[4])
{
    switch (c->texture->storage) {
    case STORE_UNORM8:
        compare_texels_of(c, STORE_UNORM8, texel, pitch, result);
        break;
    case STORE_HALF4:
        compare_texels_of(c, STORE_HALF4, texel, pitch, result);
        break;
    case STORE_FLOAT4:
        compare_texels_of(c, STORE_FLOAT4, texel, pitch, result);
        break;
    case STORE_FLOAT1:
        compare_texels_of(c, STORE_FLOAT1, texel, pitch, result);
        break;
    }
}

AMB_INLINE f32x bilinear(const f32x r[4], f32x fx, f32x fy)
{
    return f_lerp(f_lerp(r[0], r[1], fx), f_lerp(r[2], r[3], fx), fy);
}

/* ---- 2D --------------------------------------------------------------------------------------------------------- */

static f32x compare_level_2d(const comparison *c, const amb_wrap wrap[3], v2x uv, i32x layer, i32x level)
{
    levelx l = level_at(c->texture, level);
    wrapped u = wrap_coordinate(uv.x, wrap[0]), v = wrap_coordinate(uv.y, wrap[1]);
    f32x result[4];
    l.base += layer * l.slice;
    if (c->filter == AMB_NEAREST) {
        compare_texels(c, place_texel(&l, &u, &v), l.pitch, result);
        return result[0];
    }
    quad_place at = place_quad(&l, &u, &v);
    compare_texels(c, at.texel, at.pitch, result);
    return bilinear(result, at.fx, at.fy);
}

f32x amb_compare_2d_array_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer,
                              f32x reference, f32x lod)
{
    comparison c = comparison_of(texture, sampler, reference);
    lod_levels levels = levels_of_lod(texture, sampler, lod);
    uv = v2x_of(finite_or_zero(uv.x), finite_or_zero(uv.y));
    layer = clamp_layer(texture, layer);
    f32x near = compare_level_2d(&c, sampler->wrap, uv, layer, levels.near);
    if (!levels.two)
        return near;
    f32x far = compare_level_2d(&c, sampler->wrap, uv, layer, next_level(texture, levels.near));
    return between_levels(near, far, blend_of(&levels));
}

f32x amb_compare_2d_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, f32x reference, f32x lod)
{
    return amb_compare_2d_array_lod(texture, sampler, uv, i_set(0), reference, lod);
}

/* ---- cube ------------------------------------------------------------------------------------------------------- */

/* Where three faces meet there is no fourth texel: the border's corner gives the average result of the three others,
 * not the result of their average. */
AMB_INLINE void mend_corners(maskx left, maskx right, maskx top, maskx bottom, f32x r[4])
{
    const maskx corner[4] = {left & top, right & top, left & bottom, right & bottom};
    f32x sum = (r[0] + r[1]) + (r[2] + r[3]);
    for (int i = 0; i < 4; i++)
        r[i] = f_sel(corner[i], (sum - r[i]) * (1.0f / 3.0f), r[i]);
}

static f32x compare_level_cube(const comparison *c, const cube_point *p, i32x level)
{
    levelx l = level_at(c->texture, level);
    const wrapped u = {p->u, false}, v = {p->v, false};
    f32x result[4];
    l.base += p->face * l.slice;
    if (c->filter == AMB_NEAREST) {
        compare_texels(c, place_texel(&l, &u, &v), l.pitch, result);
        return result[0];
    }
    quad_place at = place_quad(&l, &u, &v);
    i32x x, y, last = small_to_i(l.width);
    place_between(&u, l.width, &x), place_between(&v, l.width, &y);
    compare_texels(c, at.texel, at.pitch, result);
    mend_corners(x == 0, x == last, y == 0, y == last, result);
    return bilinear(result, at.fx, at.fy);
}

f32x amb_compare_cube_lod(const amb_texture *texture, const amb_sampler *sampler, v3x direction, f32x reference,
                          f32x lod)
{
    comparison c = comparison_of(texture, sampler, reference);
    lod_levels levels = levels_of_lod(texture, sampler, lod);
    cube_point p = point_on_cube(direction);
    f32x near = compare_level_cube(&c, &p, levels.near);
    if (!levels.two)
        return near;
    f32x far = compare_level_cube(&c, &p, next_level(texture, levels.near));
    return between_levels(near, far, blend_of(&levels));
}
