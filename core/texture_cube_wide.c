/* Sampling of cube maps. Faces carry a border from their neighbours, so filtering is seamless without extra work. */
#include "core/texture_fetch.h"

/* ---- faces ------------------------------------------------------------------------------------------------------ */

/* A direction on its face: s right, t down in [-1, 1], major > 0 along the face's axis (OpenGL 4.6 table 8.19, which is
 * D3D's). Ties go to x, then y. */
typedef struct {
    i32x face;
    maskx x_major, y_major, negative;
} facex;

AMB_INLINE facex pick_face(v3x d)
{
    f32x x = f_abs(d.x), y = f_abs(d.y), z = f_abs(d.z);
    facex f;
    f.x_major = (x >= y) & (x >= z);
    f.y_major = ~f.x_major & (y >= z);
    f.negative = f_sel(f.x_major, d.x, f_sel(f.y_major, d.y, d.z)) < 0.0f;
    f.face = i_sel(f.x_major, i_set(0), i_sel(f.y_major, i_set(2), i_set(4))) + i_sel(f.negative, i_set(1), i_set(0));
    return f;
}

/* Any vector in the face's frame: x = s axis, y = t axis, z = major axis. Linear, so it serves derivatives too. */
AMB_INLINE v3x to_face(const facex *f, v3x d)
{
    f32x s_x = f_sel(f->negative, d.z, -d.z), s_z = f_sel(f->negative, -d.x, d.x);
    f32x t_y = f_sel(f->negative, -d.z, d.z);
    f32x major = f_sel(f->x_major, d.x, f_sel(f->y_major, d.y, d.z));
    return v3x_of(f_sel(f->x_major, s_x, f_sel(f->y_major, d.x, s_z)), f_sel(f->y_major, t_y, -d.y),
                  f_sel(f->negative, -major, major));
}

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
    f32x lod, taps;
    int most_taps;
} request_cube;

AMB_INLINE void sample_level_cube(const request_cube *r, texture_storage store, i32x face, f32x u, f32x v, i32x level,
                                  colorx *out)
{
    levelx l = level_at(r->texture, level);
    i32x base = l.base + face * l.slice;
    f32x x = u * l.width, y = v * l.width;
    if (r->sampler->filter == AMB_NEAREST) {
        f32x last = l.width - 1.0f;
        i32x column = small_to_i(f_min(x, last)) + 1, row = small_to_i(f_min(y, last)) + 1;
        fetch_texel(r->texture, store, base + row * l.pitch + column, out);
        return;
    }
    x = x + 0.5f; /* minus half a texel for centres, plus one for the border */
    y = y + 0.5f;
    f32x left = f_floor(x), above = f_floor(y);
    fetch_bilinear(r->texture, store, base + small_to_i(above) * l.pitch + small_to_i(left), l.pitch, x - left,
                   y - above, out);
}

AMB_INLINE void sample_levels_cube(const request_cube *r, texture_storage store, v3x direction,
                                   const lod_levels *levels, colorx *out)
{
    v3x d = v3x_of(finite_or_zero(direction.x), finite_or_zero(direction.y), finite_or_zero(direction.z));
    facex f = pick_face(d);
    v3x on_face = to_face(&f, d);
    maskx somewhere = on_face.z > 0.0f; /* a zero direction looks at the middle of +x */
    f32x u = f_sel(somewhere, on_face.x / on_face.z, f_set(0.0f)) * 0.5f + 0.5f;
    f32x v = f_sel(somewhere, on_face.y / on_face.z, f_set(0.0f)) * 0.5f + 0.5f;
    sample_level_cube(r, store, f.face, u, v, levels->near, out);
    maskx between = levels->blend > 0.0f;
    if (!m_any(between))
        return;
    colorx far;
    sample_level_cube(r, store, f.face, u, v, levels->far, &far);
    for (int k = 0; k < storage_channels(store); k++)
        out->c[k] = f_sel(between, f_lerp(out->c[k], far.c[k], levels->blend), out->c[k]);
}

AMB_INLINE v4x sample_request_cube(const request_cube *r, texture_storage store)
{
    lod_levels levels = pick_levels(r->texture, r->sampler, r->lod);
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
    request_cube r = {texture, sampler, direction, {zero, zero, zero}, lod, f_set(1.0f), 1};
    return sample_cube(&r);
}

v4x amb_sample_cube_grad(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx, v3x ddy)
{
    facex f = pick_face(direction);
    v3x on_face = to_face(&f, direction);
    f32x half_width = f_set(0.5f * texture->width[0]);
    footprintx p = footprint(face_footprint(on_face, to_face(&f, ddx), half_width),
                             face_footprint(on_face, to_face(&f, ddy), half_width), sampler->max_anisotropy);
    request_cube r = {
        texture, sampler, direction, v3x_sel(p.along_x, ddx, ddy), p.lod, p.taps, sampler->max_anisotropy};
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
