/* From coordinates to texels: wrapping, layers, cube faces. Texels are counted from the border: 0 is the texel before
 * the first. Shared by the samplers (texture*_wide.c). */
#ifndef AMBIANCE_CORE_TEXTURE_COORDINATES_H
#define AMBIANCE_CORE_TEXTURE_COORDINATES_H

#include "core/texture_filter.h"

/* ---- wrapping --------------------------------------------------------------------------------------------------- */

/* A coordinate as every level may use it. */
typedef struct {
    f32x u;       /* finite, wrapped where that can be done here */
    bool clamped; /* texels are clamped to the level's */
} wrapped;

AMB_INLINE wrapped wrap_coordinate(f32x u, amb_wrap wrap)
{
    if (wrap == AMB_REPEAT)
        return (wrapped){u - f_floor(u), false};
    if (wrap == AMB_MIRROR) {
        f32x pair = u * 0.5f;
        u = 1.0f - f_abs(1.0f - 2.0f * (pair - f_floor(pair)));
    }
    return (wrapped){u, true};
}

/* The first of the two texels that a coordinate lies between, and the fraction to the second. */
AMB_INLINE f32x place_between(const wrapped *w, f32x size, i32x *texel)
{
    f32x t = w->u * size + 0.5f; /* half a texel less for centres, one more for the border */
    if (w->clamped)
        t = f_clamp(t, f_set(1.0f), size);
    *texel = small_to_i(t);
    return t - i_to_f(*texel);
}

/* The texel that contains a coordinate. */
AMB_INLINE i32x place_nearest(const wrapped *w, f32x size)
{
    return small_to_i(f_clamp(w->u * size, f_set(0.0f), size - 1.0f)) + 1;
}

/* A whole level of 2D or of one face. */
AMB_INLINE quad_place place_quad(const levelx *l, const wrapped *u, const wrapped *v)
{
    i32x x, y;
    f32x fx = place_between(u, l->width, &x), fy = place_between(v, l->height, &y);
    return (quad_place){(l->base + x) + y * l->pitch, l->pitch, fx, fy};
}

AMB_INLINE i32x place_texel(const levelx *l, const wrapped *u, const wrapped *v)
{
    return (l->base + place_nearest(u, l->width)) + place_nearest(v, l->height) * l->pitch;
}

/* A layer that exists. */
AMB_INLINE i32x clamp_layer(const amb_texture *t, i32x layer)
{
    int last = t->info.kind == AMB_TEXTURE_2D_ARRAY ? t->info.depth - 1 : 0;
    return i_min(i_max(layer, i_set(0)), i_set(last));
}

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

/* Where a direction meets the cube. A zero direction looks at the middle of +x; components that are not finite count
 * as 0. */
typedef struct {
    facex frame;
    maskx somewhere;
    f32x major; /* above 0 somewhere */
    f32x s, t;  /* -1…1 across the face */
} cube_look;

AMB_INLINE cube_look look_at_cube(v3x direction)
{
    v3x d = v3x_of(finite_or_zero(direction.x), finite_or_zero(direction.y), finite_or_zero(direction.z));
    cube_look look = {.frame = pick_face(d)};
    v3x on_face = to_face(&look.frame, d);
    look.somewhere = on_face.z > 0.0f;
    look.major = on_face.z;
    look.s = f_sel(look.somewhere, on_face.x / on_face.z, f_set(0.0f));
    look.t = f_sel(look.somewhere, on_face.y / on_face.z, f_set(0.0f));
    return look;
}

typedef struct {
    i32x face;
    f32x u, v; /* 0…1 across the face */
} cube_point;

AMB_INLINE cube_point point_on_face(const cube_look *look)
{
    return (cube_point){look->frame.face, look->s * 0.5f + 0.5f, look->t * 0.5f + 0.5f};
}

AMB_INLINE cube_point point_on_cube(v3x direction)
{
    cube_look look = look_at_cube(direction);
    return point_on_face(&look);
}

#endif
