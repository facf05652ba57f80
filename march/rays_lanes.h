/* What the intersectors and the queries share, lanes-wide. */
#ifndef MARCH_RAYS_LANES_H
#define MARCH_RAYS_LANES_H

#include "march/rays_internal.h"

/* Fields of RTCRayN / RTCHitN in units of N 4-byte values. */
enum { RAY_ORIGIN = 0, RAY_NEAR = 3, RAY_DIRECTION = 4, RAY_FAR = 8, RAY_ID = 10, RAY_FIELDS = 12 };
enum { HIT_NORMAL = 12, HIT_U = 15, HIT_V = 16, HIT_PRIMITIVE = 17, HIT_GEOMETRY = 18 };

AMB_INLINE u32x u_load(const void *p)
{
    u32x r;
    memcpy(&r, p, sizeof r);
    return r;
}

/* Where the ray's line enters and leaves a sphere: E. Haines et al., "Precision Improvements for Ray/Sphere
 * Intersection", Ray Tracing Gems, ch. 7, 2019. */
AMB_INLINE maskx sphere_test(v3x origin, v3x direction, v3x center, f32x radius, f32x *enter, f32x *exit)
{
    v3x f = v3x_sub(origin, center);
    f32x a = v3x_dot(direction, direction);
    f32x b = -v3x_dot(f, direction);
    v3x nearest = v3x_add(f, v3x_scale(direction, b / a)); /* from the centre to the line */
    f32x inside = radius * radius - v3x_dot(nearest, nearest);
    f32x root = f_sqrt(f_max(inside, f_set(0.0f)) * a);
    f32x q = b + f_copysign(root, b);
    f32x c = v3x_dot(f, f) - radius * radius;
    f32x t0 = f_sel(q == 0.0f, f_set(0.0f), c / q), t1 = q / a;
    *enter = f_min(t0, t1);
    *exit = f_max(t0, t1);
    return inside >= 0.0f;
}

#endif
