/* Sampling of 2D and 3D textures. One function a storage kind, so that each is straight-line code. */
#include "core/texture_coordinates.h"

/* ---- 2D --------------------------------------------------------------------------------------------------------- */

/* Where and how to sample: one tap at uv, or `taps` along `axis`. lod is not biased yet. */
typedef struct {
    const amb_texture *texture;
    const amb_sampler *sampler;
    v2x uv, axis;
    f32x lod, taps;
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

AMB_INLINE quad_place place_2d(const levelx *l, const wrapped *u, const wrapped *v)
{
    i32x x, y;
    f32x fx = texel_left_of(u, l->width, &x), fy = texel_left_of(v, l->height, &y);
    return (quad_place){l->base + y * l->pitch + x, l->pitch, fx, fy};
}

/* A lane between two levels blends them; the second is fetched only when some lane needs it. */
AMB_INLINE void sample_levels_2d(const request_2d *r, texture_storage store, v2x uv, const lod_levels *levels,
                                 colorx *out)
{
    const amb_wrap *wrap = r->sampler->wrap;
    uv.x = finite_or_zero(uv.x);
    uv.y = finite_or_zero(uv.y);
    levelx near = level_2d(r, levels->near);
    if (r->sampler->filter == AMB_NEAREST) {
        i32x x = wrap_nearest(uv.x, near.width, wrap[0]), y = wrap_nearest(uv.y, near.height, wrap[1]);
        fetch_texel(r->texture, store, near.base + y * near.pitch + x, out);
        return;
    }
    wrapped u = wrap_coordinate(uv.x, wrap[0]), v = wrap_coordinate(uv.y, wrap[1]);
    quad_place at = place_2d(&near, &u, &v);
    if (!m_any(levels->blend > 0.0f)) {
        fetch_bilinear(r->texture, store, &at, out);
        return;
    }
    levelx far = level_2d(r, levels->far);
    quad_place far_at = place_2d(&far, &u, &v);
    fetch_trilinear(r->texture, store, &at, &far_at, levels->blend, out);
}

AMB_INLINE v4x sample_request_2d(const request_2d *r, texture_storage store)
{
    lod_levels levels = pick_levels(r->texture, r->sampler, r->lod);
    colorx sum;
    if (r->most_taps <= 1) {
        sample_levels_2d(r, store, r->uv, &levels, &sum);
        return finish_color(store, &sum);
    }
    memset(&sum, 0, sizeof sum);
    for (int i = 1; i <= r->most_taps; i++) {
        maskx wanted = r->taps >= (float)i;
        if (!m_any(wanted))
            break;
        f32x offset = (float)i / (r->taps + 1.0f) - 0.5f;
        colorx one;
        sample_levels_2d(r, store, v2x_add(r->uv, v2x_scale(r->axis, offset)), &levels, &one);
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

/* One tap of a texture without layers, the usual case: its numbers stay in registers. */
AMB_INLINE v4x sample_tap_2d(const amb_texture *texture, const amb_sampler *sampler, texture_storage store, f32x u,
                             f32x v, f32x lod)
{
    const request_2d r = {.texture = texture, .sampler = sampler};
    lod_levels levels = pick_levels(texture, sampler, lod);
    colorx c;
    sample_levels_2d(&r, store, v2x_of(u, v), &levels, &c);
    return finish_color(store, &c);
}
static __attribute__((noinline)) v4x tap_2d_unorm8(const amb_texture *t, const amb_sampler *s, f32x u, f32x v, f32x lod)
{
    return sample_tap_2d(t, s, STORE_UNORM8, u, v, lod);
}
static __attribute__((noinline)) v4x tap_2d_half4(const amb_texture *t, const amb_sampler *s, f32x u, f32x v, f32x lod)
{
    return sample_tap_2d(t, s, STORE_HALF4, u, v, lod);
}
static __attribute__((noinline)) v4x tap_2d_float1(const amb_texture *t, const amb_sampler *s, f32x u, f32x v, f32x lod)
{
    return sample_tap_2d(t, s, STORE_FLOAT1, u, v, lod);
}
static __attribute__((noinline)) v4x tap_2d_float4(const amb_texture *t, const amb_sampler *s, f32x u, f32x v, f32x lod)
{
    return sample_tap_2d(t, s, STORE_FLOAT4, u, v, lod);
}

AMB_INLINE v4x tap_2d(const amb_texture *t, const amb_sampler *s, v2x uv, f32x lod)
{
    switch (t->storage) {
    case STORE_UNORM8:
        return tap_2d_unorm8(t, s, uv.x, uv.y, lod);
    case STORE_HALF4:
        return tap_2d_half4(t, s, uv.x, uv.y, lod);
    case STORE_FLOAT1:
        return tap_2d_float1(t, s, uv.x, uv.y, lod);
    case STORE_FLOAT4:
        break;
    }
    return tap_2d_float4(t, s, uv.x, uv.y, lod);
}

AMB_INLINE v4x sample_2d(const request_2d *r)
{
    switch (r->texture->storage) {
    case STORE_UNORM8:
        return sample_2d_unorm8(r);
    case STORE_HALF4:
        return sample_2d_half4(r);
    case STORE_FLOAT1:
        return sample_2d_float1(r);
    case STORE_FLOAT4:
        break;
    }
    return sample_2d_float4(r);
}

v4x amb_sample_2d_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, f32x lod)
{
    return tap_2d(texture, sampler, uv, lod);
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
                        .lod = f.lod,
                        .taps = f.taps,
                        .most_taps = sampler->max_anisotropy};
}

v4x amb_sample_2d_grad(const amb_texture *texture, const amb_sampler *sampler, v2x uv, v2x ddx, v2x ddy)
{
    if (sampler->max_anisotropy <= 1)
        return tap_2d(texture, sampler, uv, footprint_2d(texture, ddx, ddy, 1).lod);
    request_2d r = request_with_gradients(texture, sampler, uv, ddx, ddy);
    return sample_2d(&r);
}

v4x amb_sample_2d_array_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer, f32x lod)
{
    request_2d r = {.texture = texture, .sampler = sampler, .uv = uv, .lod = lod, .taps = f_set(1.0f), .most_taps = 1};
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
v4x amb_sample_2d(const amb_texture *texture, const amb_sampler *sampler, v2x uv)
{
    v2x ddx = v2x_of(f_ddx(uv.x), f_ddx(uv.y)), ddy = v2x_of(f_ddy(uv.x), f_ddy(uv.y));
    if (sampler->max_anisotropy <= 1)
        return tap_2d(texture, sampler, uv, footprint_2d(texture, ddx, ddy, 1).lod);
    return amb_sample_2d_grad(texture, sampler, uv, ddx, ddy);
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
    if (s->filter == AMB_NEAREST) {
        i32x x = wrap_nearest(uvw.x, l.width, s->wrap[0]), y = wrap_nearest(uvw.y, l.height, s->wrap[1]);
        i32x z = wrap_nearest(uvw.z, l.depth, s->wrap[2]);
        fetch_texel(t, store, l.base + z * l.slice + y * l.pitch + x, out);
        return;
    }
    i32x x, y, z;
    f32x fx = wrap_linear(uvw.x, l.width, s->wrap[0], &x), fy = wrap_linear(uvw.y, l.height, s->wrap[1], &y);
    f32x fz = wrap_linear(uvw.z, l.depth, s->wrap[2], &z);
    quad_place at = {l.base + z * l.slice + y * l.pitch + x, l.pitch, fx, fy};
    colorx near, far;
    fetch_bilinear(t, store, &at, &near);
    at.texel += l.slice;
    fetch_bilinear(t, store, &at, &far);
    lerp_colors(store, &near, &far, fz, out);
}

AMB_INLINE v4x sample_3d(const amb_texture *t, const amb_sampler *s, texture_storage store, v3x uvw, f32x lod)
{
    lod_levels levels = pick_levels(t, s, lod);
    uvw = v3x_of(finite_or_zero(uvw.x), finite_or_zero(uvw.y), finite_or_zero(uvw.z));
    colorx out, far;
    sample_level_3d(t, s, store, uvw, levels.near, &out);
    maskx between = levels.blend > 0.0f;
    if (m_any(between)) {
        sample_level_3d(t, s, store, uvw, levels.far, &far);
        for (int k = 0; k < storage_channels(store); k++)
            out.c[k] = f_sel(between, f_lerp(out.c[k], far.c[k], levels.blend), out.c[k]);
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
