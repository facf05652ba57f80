/* Vectors and matrices. v2 v3 v4 m4 are uniform (one value); v2x v3x v4x hold one vector a lane.
 * Components are floats without units; each user states its own. World space is right-handed, y up; a camera looks
 * along its -z; clip space is D3D's: x and y in [-w, w], z in [0, w]. Pure functions; any thread. */
#ifndef AMBIANCE_VEC_H
#define AMBIANCE_VEC_H

#include <ambiance/wide.h>

typedef struct {
    float x, y;
} v2;
typedef struct {
    float x, y, z;
} v3;
typedef struct {
    float x, y, z, w;
} v4;
typedef struct {
    f32x x, y;
} v2x;
typedef struct {
    f32x x, y, z;
} v3x;
typedef struct {
    f32x x, y, z, w;
} v4x;
typedef struct {
    v4 row[4];
} m4; /* row-major; vectors are columns: m·v */

AMB_INLINE float amb_s_min(float a, float b) { return a < b ? a : b; }
AMB_INLINE float amb_s_max(float a, float b) { return a > b ? a : b; }
AMB_INLINE float amb_s_set(float a) { return a; }

/* Uniform: v3_add, v3_dot, … */
#define VEC_F float
#define VEC_T(n) AMB_PASTE(v, n)
#define VEC(n, op) AMB_PASTE(AMB_PASTE(v, n), AMB_PASTE(_, op))
#define VEC_SQRT __builtin_sqrtf
#define VEC_MIN amb_s_min
#define VEC_MAX amb_s_max
#define VEC_SET amb_s_set
#include <ambiance/vec_ops.inc>
#undef VEC_F
#undef VEC_T
#undef VEC
#undef VEC_SQRT
#undef VEC_MIN
#undef VEC_MAX
#undef VEC_SET

/* Lanes: v3x_add, v3x_dot, … */
#define VEC_F f32x
#define VEC_T(n) AMB_PASTE(AMB_PASTE(v, n), x)
#define VEC(n, op) AMB_PASTE(AMB_PASTE(v, n), AMB_PASTE(x_, op))
#define VEC_SQRT f_sqrt
#define VEC_MIN f_min
#define VEC_MAX f_max
#define VEC_SET f_set
#include <ambiance/vec_ops.inc>
#undef VEC_F
#undef VEC_T
#undef VEC
#undef VEC_SQRT
#undef VEC_MIN
#undef VEC_MAX
#undef VEC_SET

/* ---- between uniform and lanes ---------------------------------------------------------------------------------- */

AMB_INLINE v2x v2x_splat(v2 a) { return (v2x){f_set(a.x), f_set(a.y)}; }
AMB_INLINE v3x v3x_splat(v3 a) { return (v3x){f_set(a.x), f_set(a.y), f_set(a.z)}; }
AMB_INLINE v4x v4x_splat(v4 a) { return (v4x){f_set(a.x), f_set(a.y), f_set(a.z), f_set(a.w)}; }
AMB_INLINE v3 v3x_lane(v3x a, int i) { return (v3){f_lane(a.x, i), f_lane(a.y, i), f_lane(a.z, i)}; }
AMB_INLINE v4 v4x_lane(v4x a, int i) { return (v4){f_lane(a.x, i), f_lane(a.y, i), f_lane(a.z, i), f_lane(a.w, i)}; }
AMB_INLINE v2x v2x_sel(maskx m, v2x a, v2x b) { return (v2x){f_sel(m, a.x, b.x), f_sel(m, a.y, b.y)}; }
AMB_INLINE v3x v3x_sel(maskx m, v3x a, v3x b)
{
    return (v3x){f_sel(m, a.x, b.x), f_sel(m, a.y, b.y), f_sel(m, a.z, b.z)};
}
AMB_INLINE v4x v4x_sel(maskx m, v4x a, v4x b)
{
    return (v4x){f_sel(m, a.x, b.x), f_sel(m, a.y, b.y), f_sel(m, a.z, b.z), f_sel(m, a.w, b.w)};
}
/* base[index] lane by lane. */
AMB_INLINE v2x v2x_gather(const v2 *base, i32x index)
{
    const float *p = &base->x;
    return (v2x){f_gather(p, index * 2), f_gather(p + 1, index * 2)};
}
AMB_INLINE v3x v3x_gather(const v3 *base, i32x index)
{
    const float *p = &base->x;
    return (v3x){f_gather(p, index * 3), f_gather(p + 1, index * 3), f_gather(p + 2, index * 3)};
}
AMB_INLINE v4x v4x_gather(const v4 *base, i32x index)
{
    const float *p = &base->x;
    return (v4x){f_gather(p, index * 4), f_gather(p + 1, index * 4), f_gather(p + 2, index * 4),
                 f_gather(p + 3, index * 4)};
}

/* ---- matrices --------------------------------------------------------------------------------------------------- */

AMB_INLINE v4 m4_mul_v4(m4 m, v4 a)
{
    return (v4){v4_dot(m.row[0], a), v4_dot(m.row[1], a), v4_dot(m.row[2], a), v4_dot(m.row[3], a)};
}
AMB_INLINE v3 m4_point(m4 m, v3 a) { return v4_xyz(m4_mul_v4(m, v4_of3(a, 1.0f))); }     /* affine m */
AMB_INLINE v3 m4_direction(m4 m, v3 a) { return v4_xyz(m4_mul_v4(m, v4_of3(a, 0.0f))); } /* no translation */
AMB_INLINE v4x m4_mul_v4x(m4 m, v4x a)
{
    return (v4x){v4x_dot(v4x_splat(m.row[0]), a), v4x_dot(v4x_splat(m.row[1]), a), v4x_dot(v4x_splat(m.row[2]), a),
                 v4x_dot(v4x_splat(m.row[3]), a)};
}
/* m·(a, 1) as clip or homogeneous coordinates. */
AMB_INLINE v4x m4_project_x(m4 m, v3x a) { return m4_mul_v4x(m, v4x_of3(a, f_set(1.0f))); }
AMB_INLINE v3x m4_point_x(m4 m, v3x a) { return v4x_xyz(m4_project_x(m, a)); }
AMB_INLINE v3x m4_direction_x(m4 m, v3x a) { return v4x_xyz(m4_mul_v4x(m, v4x_of3(a, f_set(0.0f)))); }

m4 m4_identity(void);
m4 m4_mul(m4 a, m4 b); /* apply b, then a */
m4 m4_transpose(m4 a);
m4 m4_inverse(m4 a); /* of a singular matrix: the zero matrix */
m4 m4_translate(v3 offset);
m4 m4_scale(v3 factor);
m4 m4_rotate(v3 unit_axis, float radians); /* counter-clockwise seen against the axis */
/* World → view: eye at the origin looking along -z. `up` need not be orthogonal, only not parallel to the view. */
m4 m4_look_at(v3 eye, v3 target, v3 up);
/* View → clip. vertical_fov in radians, aspect = width/height, 0 < near < far; depth 0 at near, 1 at far. */
m4 m4_perspective(float vertical_fov, float aspect, float near, float far);
m4 m4_orthographic(float left, float right, float bottom, float top, float near, float far);

#endif
