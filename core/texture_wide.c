/* Sampling of 2D and 3D textures. One function a storage kind, so that each is straight-line code. */
#include "core/texture_coordinates.h"

/* ---- 2D --------------------------------------------------------------------------------------------------------- */

/* Where and how to sample: one tap at uv, or `taps` along `axis`. */
typedef struct {
    const amb_texture *texture;
    const amb_sampler *sampler;
    v2x uv, axis;
    detailx detail;
    f32x taps;
    int most_taps;
    bool layered;
    i32x layer; /* of arrays */
} request_2d;

AMB_INLINE levelx level_2d(const request_2d *r, i32x level)
{
    levelx l = level_at(r->texture, level);
    if (r->layered)
        l.base += r->layer * l.slice;
    return l;
}

/* A lane between two levels blends them; the second is fetched only when some lane needs it. `other`: NULL, or a
 * texture laid out alike, whose colour at the same place becomes out[1]. */
AMB_INLINE void sample_levels_2d(const request_2d *r, const amb_texture *other, texture_storage store, v2x uv,
                                 const lod_levels *levels, colorx *out)
{
    const amb_wrap *wrap = r->sampler->wrap;
    uv.x = finite_or_zero(uv.x);
    uv.y = finite_or_zero(uv.y);
    wrapped u = wrap_coordinate(uv.x, wrap[0]), v = wrap_coordinate(uv.y, wrap[1]);
    levelx near = level_2d(r, levels->near);
    if (r->sampler->filter == AMB_NEAREST) {
        i32x texel = place_texel(&near, &u, &v);
        filter_nearest(r->texture, store, texel, out);
        if (other)
            filter_nearest(other, store, texel, out + 1);
        return;
    }
    quad_place at = place_quad(&near, &u, &v);
    if (!levels->two) {
        filter_bilinear(r->texture, store, &at, out);
        if (other)
            filter_bilinear(other, store, &at, out + 1);
        return;
    }
    levelx far = level_2d(r, next_level(r->texture, levels->near));
    quad_place far_at = place_quad(&far, &u, &v);
    f32x blend = blend_of(levels);
    filter_trilinear(r->texture, store, &at, &far_at, blend, out);
    if (other)
        filter_trilinear(other, store, &at, &far_at, blend, out + 1);
}

AMB_INLINE v4x sample_request_2d(const request_2d *r, texture_storage store)
{
    lod_levels levels = pick_levels(r->texture, r->sampler, r->detail);
    colorx sum;
    if (r->most_taps <= 1) {
        sample_levels_2d(r, NULL, store, r->uv, &levels, &sum);
        return finish_color(store, &sum);
    }
    memset(&sum, 0, sizeof sum);
    for (int i = 1; i <= r->most_taps; i++) {
        maskx wanted = r->taps >= (float)i;
        if (!m_any(wanted))
            break;
        f32x offset = (float)i / (r->taps + 1.0f) - 0.5f;
        colorx one;
        sample_levels_2d(r, NULL, store, v2x_add(r->uv, v2x_scale(r->axis, offset)), &levels, &one);
        for (int k = 0; k < storage_channels(store); k++)
            sum.c[k] = f_sel(wanted, sum.c[k] + one.c[k], sum.c[k]);
    }
    for (int k = 0; k < storage_channels(store); k++)
        sum.c[k] = sum.c[k] / r->taps;
    return finish_color(store, &sum);
}

static __attribute__((noinline)) v4x sample_2d_unorm8(const request_2d *r)
{
    return sample_request_2d(r, STORE_UNORM8);
}
static __attribute__((noinline)) v4x sample_2d_half4(const request_2d *r) { return sample_request_2d(r, STORE_HALF4); }
static __attribute__((noinline)) v4x sample_2d_float1(const request_2d *r)
{
    return sample_request_2d(r, STORE_FLOAT1);
}
static __attribute__((noinline)) v4x sample_2d_float4(const request_2d *r)
{
    return sample_request_2d(r, STORE_FLOAT4);
}

/* One tap without layers, the usual case, of one texture or of two laid out alike: its numbers stay in registers. */
AMB_INLINE void sample_tap_2d(const amb_texture *texture, const amb_texture *other, const amb_sampler *sampler,
                              texture_storage store, v2x uv, detailx detail, v4x *out)
{
    const request_2d r = {.texture = texture, .sampler = sampler};
    lod_levels levels = pick_levels(texture, sampler, detail);
    colorx c[2];
    sample_levels_2d(&r, other, store, uv, &levels, c);
    out[0] = finish_color(store, &c[0]);
    if (other)
        out[1] = finish_color(store, &c[1]);
}
#define TAPS_2D_(name, store)                                                                                        \
    static __attribute__((noinline))                                                                                 \
    v4x tap_2d_##name(const amb_texture *t, const amb_sampler *s, f32x u, f32x v, f32x detail, bool squared)         \
    {                                                                                                                \
        v4x color;                                                                                                   \
        sample_tap_2d(t, NULL, s, store, v2x_of(u, v), (detailx){detail, squared}, &color);                          \
        return color;                                                                                                \
    }                                                                                                                \
    static __attribute__((noinline, unused)) void tap_pair_##name(const amb_texture *t, const amb_texture *other,    \
                                                                  const amb_sampler *s, f32x u, f32x v, f32x detail, \
                                                                  bool squared, v4x *out)                            \
    {                                                                                                                \
        sample_tap_2d(t, other, s, store, v2x_of(u, v), (detailx){detail, squared}, out);                            \
    }
TAPS_2D_(unorm8, STORE_UNORM8)
TAPS_2D_(half4, STORE_HALF4)
TAPS_2D_(float1, STORE_FLOAT1)
TAPS_2D_(float4, STORE_FLOAT4)
#undef TAPS_2D_

AMB_INLINE v4x tap_2d(const amb_texture *t, const amb_sampler *s, v2x uv, detailx d)
{
    static v4x (*const tap[])(const amb_texture *, const amb_sampler *, f32x, f32x, f32x, bool) = {
        [STORE_UNORM8] = tap_2d_unorm8,
        [STORE_HALF4] = tap_2d_half4,
        [STORE_FLOAT1] = tap_2d_float1,
        [STORE_FLOAT4] = tap_2d_float4,
    };
    return tap[t->storage](t, s, uv.x, uv.y, d.value, d.squared);
}

AMB_INLINE v4x sample_2d(const request_2d *r)
{
    static v4x (*const sample[])(const request_2d *) = {
        [STORE_UNORM8] = sample_2d_unorm8,
        [STORE_HALF4] = sample_2d_half4,
        [STORE_FLOAT1] = sample_2d_float1,
        [STORE_FLOAT4] = sample_2d_float4,
    };
    return sample[r->texture->storage](r);
}

v4x amb_sample_2d_lod_at(const amb_texture *texture, const amb_sampler *sampler, f32x u, f32x v, f32x lod)
{
    return tap_2d(texture, sampler, v2x_of(u, v), (detailx){lod, false});
}

AMB_INLINE footprintx footprint_2d(const amb_texture *texture, v2x ddx, v2x ddy, int max_anisotropy)
{
    f32x width = f_set(texture->width[0]), height = f_set(texture->height[0]);
    v2x dx = v2x_of(ddx.x * width, ddx.y * height), dy = v2x_of(ddy.x * width, ddy.y * height);
    return footprint(v2x_dot(dx, dx), v2x_dot(dy, dy), max_anisotropy);
}

AMB_INLINE request_2d request_with_gradients(const amb_texture *texture, const amb_sampler *sampler, v2x uv, v2x ddx,
                                             v2x ddy)
{
    footprintx f = footprint_2d(texture, ddx, ddy, sampler->max_anisotropy);
    return (request_2d){.texture = texture,
                        .sampler = sampler,
                        .uv = uv,
                        .axis = v2x_sel(f.along_x, ddx, ddy),
                        .detail = detail_of_square(texture, sampler, f.square),
                        .taps = f.taps,
                        .most_taps = sampler->max_anisotropy};
}

v4x amb_sample_2d_grad(const amb_texture *texture, const amb_sampler *sampler, v2x uv, v2x ddx, v2x ddy)
{
    if (sampler->max_anisotropy <= 1)
        return tap_2d(texture, sampler, uv,
                      detail_of_square(texture, sampler, footprint_2d(texture, ddx, ddy, 1).square));
    request_2d r = request_with_gradients(texture, sampler, uv, ddx, ddy);
    return sample_2d(&r);
}

v4x amb_sample_2d_array_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer, f32x lod)
{
    request_2d r = {.texture = texture, .sampler = sampler, .uv = uv, .detail = {lod, false}, .most_taps = 1};
    r.layered = true, r.layer = clamp_layer(texture, layer);
    return sample_2d(&r);
}

v4x amb_sample_2d_array_grad(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer, v2x ddx,
                             v2x ddy)
{
    request_2d r = request_with_gradients(texture, sampler, uv, ddx, ddy);
    r.layered = true, r.layer = clamp_layer(texture, layer);
    return sample_2d(&r);
}

#if AMB_LANES > 1
AMB_INLINE detailx detail_of_quads(const amb_texture *texture, const amb_sampler *sampler, f32x u, f32x v)
{
    v2x ddx = v2x_of(f_ddx(u), f_ddx(v)), ddy = v2x_of(f_ddy(u), f_ddy(v));
    return detail_of_square(texture, sampler, footprint_2d(texture, ddx, ddy, 1).square);
}

v4x amb_sample_2d_at(const amb_texture *texture, const amb_sampler *sampler, f32x u, f32x v)
{
    if (sampler->max_anisotropy <= 1)
        return tap_2d(texture, sampler, v2x_of(u, v), detail_of_quads(texture, sampler, u, v));
    return amb_sample_2d_grad(texture, sampler, v2x_of(u, v), v2x_of(f_ddx(u), f_ddx(v)), v2x_of(f_ddy(u), f_ddy(v)));
}

/* Do all levels' texels lie alike? */
AMB_INLINE bool laid_out_alike(const amb_texture *a, const amb_texture *b)
{
    return a->storage == b->storage && a->info.kind == b->info.kind && a->info.width == b->info.width &&
           a->info.height == b->info.height && a->info.depth == b->info.depth && a->info.levels == b->info.levels;
}

void amb_sample_2d_pair_at(const amb_texture *first, const amb_texture *second, const amb_sampler *sampler, f32x u,
                           f32x v, v4x out[2])
{
    if (sampler->max_anisotropy > 1 || !laid_out_alike(first, second)) {
        out[0] = amb_sample_2d_at(first, sampler, u, v);
        out[1] = amb_sample_2d_at(second, sampler, u, v);
        return;
    }
    detailx d = detail_of_quads(first, sampler, u, v);
    static void (*const tap[])(const amb_texture *, const amb_texture *, const amb_sampler *, f32x, f32x, f32x, bool,
                               v4x *) = {
        [STORE_UNORM8] = tap_pair_unorm8,
        [STORE_HALF4] = tap_pair_half4,
        [STORE_FLOAT1] = tap_pair_float1,
        [STORE_FLOAT4] = tap_pair_float4,
    };
    tap[first->storage](first, second, sampler, u, v, d.value, d.squared, out);
}

v4x amb_sample_2d_array(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer)
{
    return amb_sample_2d_array_grad(texture, sampler, uv, layer, v2x_of(f_ddx(uv.x), f_ddx(uv.y)),
                                    v2x_of(f_ddy(uv.x), f_ddy(uv.y)));
}
#endif

/* ---- 3D --------------------------------------------------------------------------------------------------------- */

AMB_INLINE void sample_level_3d(const amb_texture *t, const amb_sampler *s, texture_storage store, v3x uvw, i32x level,
                                colorx *out)
{
    levelx l = level_at(t, level);
    wrapped u = wrap_coordinate(uvw.x, s->wrap[0]), v = wrap_coordinate(uvw.y, s->wrap[1]);
    wrapped w = wrap_coordinate(uvw.z, s->wrap[2]);
    if (s->filter == AMB_NEAREST) {
        filter_nearest(t, store, place_texel(&l, &u, &v) + place_nearest(&w, l.depth) * l.slice, out);
        return;
    }
    i32x z;
    f32x fz = place_between(&w, l.depth, &z);
    quad_place at = place_quad(&l, &u, &v);
    colorx near, far;
    at.texel += z * l.slice;
    filter_bilinear(t, store, &at, &near);
    at.texel += l.slice;
    filter_bilinear(t, store, &at, &far);
    lerp_colors(store, &near, &far, fz, out);
}

AMB_INLINE v4x sample_3d(const amb_texture *t, const amb_sampler *s, texture_storage store, v3x uvw, f32x lod)
{
    lod_levels levels = levels_of_lod(t, s, lod);
    uvw = v3x_of(finite_or_zero(uvw.x), finite_or_zero(uvw.y), finite_or_zero(uvw.z));
    colorx out, far;
    sample_level_3d(t, s, store, uvw, levels.near, &out);
    if (levels.two) {
        f32x blend = blend_of(&levels);
        sample_level_3d(t, s, store, uvw, next_level(t, levels.near), &far);
        for (int k = 0; k < storage_channels(store); k++)
            out.c[k] = between_levels(out.c[k], far.c[k], blend);
    }
    return finish_color(store, &out);
}

v4x amb_sample_3d_lod(const amb_texture *texture, const amb_sampler *sampler, v3x uvw, f32x lod)
{
    switch (texture->storage) {
    case STORE_UNORM8:
        return sample_3d(texture, sampler, STORE_UNORM8, uvw, lod);
    case STORE_HALF4:
        return sample_3d(texture, sampler, STORE_HALF4, uvw, lod);
    case STORE_FLOAT1:
        return sample_3d(texture, sampler, STORE_FLOAT1, uvw, lod);
    case STORE_FLOAT4:
        break;
    }
    return sample_3d(texture, sampler, STORE_FLOAT4, uvw, lod);
}
