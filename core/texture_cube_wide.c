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
    filter_trilinear(r->texture, store, &at, &far_at, blend_of(levels), out);
}

AMB_INLINE v4x sample_request_cube(const request_cube *r, texture_storage store)
{
    lod_levels levels = pick_levels(r->texture, r->sampler, r->detail);
    colorx sum;
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

/* One tap, the usual case: its numbers stay in registers. */
AMB_INLINE v4x sample_tap_cube(const amb_texture *texture, const amb_sampler *sampler, texture_storage store, f32x x,
                               f32x y, f32x z, f32x detail, bool squared)
{
    const request_cube r = {.texture = texture, .sampler = sampler};
    lod_levels levels = pick_levels(texture, sampler, (detailx){detail, squared});
    colorx c;
    sample_levels_cube(&r, store, v3x_of(x, y, z), &levels, &c);
    return finish_color(store, &c);
}

#define CUBE_OF_STORAGE_(name, store)                                                                                  \
    static __attribute__((noinline)) v4x sample_cube_##name(const request_cube *r)                                     \
    {                                                                                                                  \
        return sample_request_cube(r, store);                                                                          \
    }                                                                                                                  \
    static __attribute__((noinline))                                                                                   \
    v4x tap_cube_##name(const amb_texture *t, const amb_sampler *s, f32x x, f32x y, f32x z, f32x detail, bool squared) \
    {                                                                                                                  \
        return sample_tap_cube(t, s, store, x, y, z, detail, squared);                                                 \
    }
CUBE_OF_STORAGE_(unorm8, STORE_UNORM8)
CUBE_OF_STORAGE_(half4, STORE_HALF4)
CUBE_OF_STORAGE_(float1, STORE_FLOAT1)
CUBE_OF_STORAGE_(float4, STORE_FLOAT4)
#undef CUBE_OF_STORAGE_

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

AMB_INLINE v4x tap_cube(const amb_texture *t, const amb_sampler *s, v3x direction, detailx d)
{
    const f32x x = direction.x, y = direction.y, z = direction.z;
    switch (t->storage) {
    case STORE_UNORM8:
        return tap_cube_unorm8(t, s, x, y, z, d.value, d.squared);
    case STORE_HALF4:
        return tap_cube_half4(t, s, x, y, z, d.value, d.squared);
    case STORE_FLOAT1:
        return tap_cube_float1(t, s, x, y, z, d.value, d.squared);
    case STORE_FLOAT4:
        break;
    }
    return tap_cube_float4(t, s, x, y, z, d.value, d.squared);
}

v4x amb_sample_cube_lod_at(const amb_texture *texture, const amb_sampler *sampler, f32x x, f32x y, f32x z, f32x lod)
{
    return tap_cube(texture, sampler, v3x_of(x, y, z), (detailx){lod, false});
}

AMB_INLINE v4x sample_with_gradients(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx,
                                     v3x ddy)
{
    facex f = pick_face(direction);
    v3x on_face = to_face(&f, direction);
    f32x half_width = f_set(0.5f * texture->width[0]);
    footprintx p = footprint(face_footprint(on_face, to_face(&f, ddx), half_width),
                             face_footprint(on_face, to_face(&f, ddy), half_width), sampler->max_anisotropy);
    detailx detail = detail_of_square(texture, sampler, p.square);
    if (sampler->max_anisotropy <= 1)
        return tap_cube(texture, sampler, direction, detail);
    request_cube r = {.texture = texture,
                      .sampler = sampler,
                      .direction = direction,
                      .axis = v3x_sel(p.along_x, ddx, ddy),
                      .detail = detail,
                      .taps = p.taps,
                      .most_taps = sampler->max_anisotropy};
    return sample_cube(&r);
}

v4x amb_sample_cube_grad(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx, v3x ddy)
{
    return sample_with_gradients(texture, sampler, direction, ddx, ddy);
}

#if AMB_LANES > 1
v4x amb_sample_cube_at(const amb_texture *texture, const amb_sampler *sampler, f32x x, f32x y, f32x z)
{
    return sample_with_gradients(texture, sampler, v3x_of(x, y, z), v3x_of(f_ddx(x), f_ddx(y), f_ddx(z)),
                                 v3x_of(f_ddy(x), f_ddy(y), f_ddy(z)));
}
#endif
