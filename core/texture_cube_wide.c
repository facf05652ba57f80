/* Sampling of cube maps. Faces carry a border from their neighbours, so filtering is seamless without extra work. */
#include "core/texture_coordinates.h"

/* ---- footprints ------------------------------------------------------------------------------------------------- */

/* Squared length in texels of level 0 of a change of direction: (ds - s·dm)/m on the face plane, half a face a unit. */
AMB_INLINE f32x face_footprint(v3x on_face, v3x change, f32x half_width)
{
    f32x scale = half_width / on_face.z, s = on_face.x / on_face.z, t = on_face.y / on_face.z;
    f32x ds = (change.x - s * change.z) * scale, dt = (change.y - t * change.z) * scale;
    return ds * ds + dt * dt;
}

/* ---- taps ------------------------------------------------------------------------------------------------------- */

typedef struct {
    const amb_texture *texture;
    const amb_sampler *sampler;
    v3x direction, axis;
    detailx detail;
    f32x taps;
    int most_taps;
} request_cube;

AMB_INLINE levelx level_of_face(const amb_texture *t, i32x level, i32x face)
{
    levelx l = level_at(t, level);
    l.base += face * l.slice;
    return l;
}

AMB_INLINE void sample_levels_cube(const request_cube *r, texture_storage store, v3x direction,
                                   const lod_levels *levels, colorx *out)
{
    cube_point p = point_on_cube(direction);
    const wrapped u = {p.u, false}, v = {p.v, false};
    levelx near = level_of_face(r->texture, levels->near, p.face);
    if (r->sampler->filter == AMB_NEAREST) {
        filter_nearest(r->texture, store, place_texel(&near, &u, &v), out);
        return;
    }
    quad_place at = place_quad(&near, &u, &v);
    if (!levels->two) {
        filter_bilinear(r->texture, store, &at, out);
        return;
    }
    levelx far = level_of_face(r->texture, next_level(r->texture, levels->near), p.face);
    quad_place far_at = place_quad(&far, &u, &v);
    filter_trilinear(r->texture, store, &at, &far_at, levels->blend, out);
}

AMB_INLINE v4x sample_request_cube(const request_cube *r, texture_storage store)
{
    lod_levels levels = levels_of_detail(r->texture, r->sampler, r->detail);
    colorx sum;
    if (r->most_taps <= 1) {
        sample_levels_cube(r, store, r->direction, &levels, &sum);
        return finish_color(store, &sum);
    }
    memset(&sum, 0, sizeof sum);
    for (int i = 1; i <= r->most_taps; i++) {
        maskx wanted = r->taps >= (float)i;
        if (!m_any(wanted))
            break;
        f32x offset = (float)i / (r->taps + 1.0f) - 0.5f;
        colorx one;
        sample_levels_cube(r, store, v3x_add(r->direction, v3x_scale(r->axis, offset)), &levels, &one);
        for (int k = 0; k < storage_channels(store); k++)
            sum.c[k] = f_sel(wanted, sum.c[k] + one.c[k], sum.c[k]);
    }
    for (int k = 0; k < storage_channels(store); k++)
        sum.c[k] = sum.c[k] / r->taps;
    return finish_color(store, &sum);
}

static __attribute__((noinline)) v4x sample_cube_unorm8(const request_cube *r)
{
    return sample_request_cube(r, STORE_UNORM8);
}
static __attribute__((noinline)) v4x sample_cube_half4(const request_cube *r)
{
    return sample_request_cube(r, STORE_HALF4);
}
static __attribute__((noinline)) v4x sample_cube_float1(const request_cube *r)
{
    return sample_request_cube(r, STORE_FLOAT1);
}
static __attribute__((noinline)) v4x sample_cube_float4(const request_cube *r)
{
    return sample_request_cube(r, STORE_FLOAT4);
}

AMB_INLINE v4x sample_cube(const request_cube *r)
{
    switch (r->texture->storage) {
    case STORE_UNORM8:
        return sample_cube_unorm8(r);
    case STORE_HALF4:
        return sample_cube_half4(r);
    case STORE_FLOAT1:
        return sample_cube_float1(r);
    case STORE_FLOAT4:
        break;
    }
    return sample_cube_float4(r);
}

v4x amb_sample_cube_lod(const amb_texture *texture, const amb_sampler *sampler, v3x direction, f32x lod)
{
    f32x zero = f_set(0.0f);
    request_cube r = {texture, sampler, direction, {zero, zero, zero}, {lod, false}, f_set(1.0f), 1};
    return sample_cube(&r);
}

v4x amb_sample_cube_grad(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx, v3x ddy)
{
    facex f = pick_face(direction);
    v3x on_face = to_face(&f, direction);
    f32x half_width = f_set(0.5f * texture->width[0]);
    footprintx p = footprint(face_footprint(on_face, to_face(&f, ddx), half_width),
                             face_footprint(on_face, to_face(&f, ddy), half_width), sampler->max_anisotropy);
    request_cube r = {.texture = texture,
                      .sampler = sampler,
                      .direction = direction,
                      .axis = v3x_sel(p.along_x, ddx, ddy),
                      .detail = detail_of_square(texture, sampler, p.square),
                      .taps = p.taps,
                      .most_taps = sampler->max_anisotropy};
    return sample_cube(&r);
}

#if AMB_LANES > 1
v4x amb_sample_cube(const amb_texture *texture, const amb_sampler *sampler, v3x direction)
{
    v3x ddx = v3x_of(f_ddx(direction.x), f_ddx(direction.y), f_ddx(direction.z));
    v3x ddy = v3x_of(f_ddy(direction.x), f_ddy(direction.y), f_ddy(direction.z));
    return amb_sample_cube_grad(texture, sampler, direction, ddx, ddy);
}
#endif
