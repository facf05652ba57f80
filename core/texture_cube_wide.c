/* Sampling of cube maps. Faces carry a border from their neighbours, so filtering is seamless without extra work. */
#include "core/texture_coordinates.h"

/* ---- footprints ------------------------------------------------------------------------------------------------- */

/* Squared length in texels of level 0 of a change of direction: (ds - s·dm)/m on the face plane, half a face a unit. */
AMB_INLINE f32x face_footprint(const cube_look *look, v3x change, f32x scale)
{
    change = to_face(&look->frame, change);
    f32x ds = (change.x - look->s * change.z) * scale, dt = (change.y - look->t * change.z) * scale;
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

AMB_INLINE void sample_levels_cube(const amb_texture *texture, amb_filter filter, texture_storage store, cube_point p,
                                   const lod_levels *levels, colorx *out)
{
    const wrapped u = {p.u, false}, v = {p.v, false};
    levelx near = level_of_face(texture, levels->near, p.face);
    if (filter == AMB_NEAREST) {
        filter_nearest(texture, store, place_texel(&near, &u, &v), out);
        return;
    }
    quad_place at = place_quad(&near, &u, &v);
    if (!levels->two) {
        filter_bilinear(texture, store, &at, out);
        return;
    }
    levelx far = level_of_face(texture, next_level(texture, levels->near), p.face);
    quad_place far_at = place_quad(&far, &u, &v);
    filter_trilinear(texture, store, &at, &far_at, blend_of(levels), out);
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
        cube_point p = point_on_cube(v3x_add(r->direction, v3x_scale(r->axis, offset)));
        sample_levels_cube(r->texture, r->sampler->filter, store, p, &levels, &one);
        for (int k = 0; k < storage_channels(store); k++)
            sum.c[k] = f_sel(wanted, sum.c[k] + one.c[k], sum.c[k]);
    }
    for (int k = 0; k < storage_channels(store); k++)
        sum.c[k] = sum.c[k] / r->taps;
    return finish_color(store, &sum);
}

/* One tap, the usual case: its numbers stay in registers. */
AMB_INLINE v4x sample_tap_cube(const amb_texture *texture, const amb_sampler *sampler, texture_storage store,
                               cube_point p, detailx detail)
{
    lod_levels levels = pick_levels(texture, sampler, detail);
    colorx c;
    sample_levels_cube(texture, sampler->filter, store, p, &levels, &c);
    return finish_color(store, &c);
}

#define CUBE_OF_STORAGE_(name, store)                                                                           \
    static __attribute__((noinline)) v4x sample_cube_##name(const request_cube *r)                              \
    {                                                                                                           \
        return sample_request_cube(r, store);                                                                   \
    }                                                                                                           \
    static __attribute__((noinline)) v4x tap_cube_##name(const amb_texture *t, const amb_sampler *s, i32x face, \
                                                         f32x u, f32x v, f32x detail, bool squared)             \
    {                                                                                                           \
        return sample_tap_cube(t, s, store, (cube_point){face, u, v}, (detailx){detail, squared});              \
    }
CUBE_OF_STORAGE_(unorm8, STORE_UNORM8)
CUBE_OF_STORAGE_(half4, STORE_HALF4)
CUBE_OF_STORAGE_(float1, STORE_FLOAT1)
CUBE_OF_STORAGE_(float4, STORE_FLOAT4)
#undef CUBE_OF_STORAGE_

AMB_INLINE v4x sample_cube(const request_cube *r)
{
    static v4x (*const sample[])(const request_cube *) = {
        [STORE_UNORM8] = sample_cube_unorm8,
        [STORE_HALF4] = sample_cube_half4,
        [STORE_FLOAT1] = sample_cube_float1,
        [STORE_FLOAT4] = sample_cube_float4,
    };
    return sample[r->texture->storage](r);
}

AMB_INLINE v4x tap_cube(const amb_texture *t, const amb_sampler *s, cube_point p, detailx d)
{
    static v4x (*const tap[])(const amb_texture *, const amb_sampler *, i32x, f32x, f32x, f32x, bool) = {
        [STORE_UNORM8] = tap_cube_unorm8,
        [STORE_HALF4] = tap_cube_half4,
        [STORE_FLOAT1] = tap_cube_float1,
        [STORE_FLOAT4] = tap_cube_float4,
    };
    return tap[t->storage](t, s, p.face, p.u, p.v, d.value, d.squared);
}

v4x amb_sample_cube_lod_at(const amb_texture *texture, const amb_sampler *sampler, f32x x, f32x y, f32x z, f32x lod)
{
    return tap_cube(texture, sampler, point_on_cube(v3x_of(x, y, z)), (detailx){lod, false});
}

AMB_INLINE v4x sample_with_gradients(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx,
                                     v3x ddy)
{
    cube_look look = look_at_cube(direction);
    f32x scale = f_sel(look.somewhere, 0.5f * texture->width[0] / look.major, f_set(0.0f));
    footprintx p =
        footprint(face_footprint(&look, ddx, scale), face_footprint(&look, ddy, scale), sampler->max_anisotropy);
    detailx detail = detail_of_square(texture, sampler, p.square);
    if (sampler->max_anisotropy <= 1)
        return tap_cube(texture, sampler, point_on_face(&look), detail);
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
