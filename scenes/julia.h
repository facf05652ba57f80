/* The quaternion Julia set of z² + c, cut by the three-dimensional space of quaternions without a k part: its distance,
 * gradient and orbit trap, lanes-wide.
 *
 * Under z → z² + c the imaginary part of z never leaves the plane spanned by the imaginary parts of c and of the
 * starting point, and squaring does not care how that plane lies. So three numbers carry the orbit: the real part x,
 * the part y along c's imaginary axis, and the part w across it: x ← x² - y² - w² + Re c     y ← 2xy + |Im c|     w ←
 * 2xw and |z'| follows z' ← 2 z z' (the seed's "+ 1" belongs to the Mandelbrot set).
 *
 * Distance: the seed's d = |z| log|z| / |z'| is G / |grad G| of the potential G = log|z| / 2ⁿ, an estimate that may be
 * too long. For a connected complex Julia set the distance is at least ½ · ½(1 - e^(-2G)) / |grad G| (from Koebe's ¼
 * theorem; J. C. Hart, D. J. Sandin, L. H. Kauffman, "Ray tracing deterministic 3-D fractals", SIGGRAPH 1989, take it
 * over to quaternions), hence the factor ½, the usual one, which is all that is left near the set where G → 0. Instead
 * of the exponential we take G / (1 + G + G²/3), which never exceeds it. That no step overshoots a connected quaternion
 * set is shown by test_julia.c, which looks for points of the set inside the ball of the distance, in fine steps.
 */
#ifndef AMB_SCENES_JULIA_H
#define AMB_SCENES_JULIA_H

#include <ambiance/camera.h>
#include <ambiance/math.h>
#include <ambiance/vec.h>

#define JULIA_SECONDS 80.0f
/* Rays start where a cone around their tile first nears the set, and the tile's cone where its coarse tile's did. Sizes
 * in pixels, the same on every instruction set; a fragment block lies in one tile. */
#define JULIA_TILE 4
#define JULIA_COARSE_TILE (4 * JULIA_TILE)

#define JULIA_ESCAPE 64.0f /* |z|² of escape: from here on log|z| / 2ⁿ is the potential to about 1 % */

typedef struct julia_set {
    v4 c;        /* real, i, j, k */
    v3 axis;     /* unit, along (c.y, c.z, c.w); i, j, k */
    float along; /* |Im c| */
    int iterations;
    float radius; /* the set lies in the ball of this radius: (1 + √(1 + 4|c|)) / 2 */
} julia_set;

AMB_INLINE julia_set julia_make(v4 c, int iterations)
{
    v3 imaginary = {c.y, c.z, c.w};
    float along = v3_length(imaginary);
    v3 axis = along > 0.0f ? v3_scale(imaginary, 1.0f / along) : (v3){1.0f, 0.0f, 0.0f};
    /* |z²+c| > |z| for |z|² - |c| > |z|: such points escape. */
    float radius = 0.5f + 0.5f * __builtin_sqrtf(1.0f + 4.0f * v4_length(c));
    return (julia_set){c, axis, along, iterations, radius * 1.0001f};
}

/* c along a smooth closed path through connected sets worth seeing, once around in `period` seconds; any finite time.
 */
v4 amb_julia_path(double time, double period);
/* The scene's camera, once around in JULIA_SECONDS; any time. */
amb_camera amb_julia_camera(double time, int width, int height);

/* log √a for a ≥ JULIA_ESCAPE, at most 0.3 % too small and never too large: the exponent and, for the mantissa 1 + f,
 * f + k·f(1 - f) ≤ log2(1 + f), with k the slope's difference at f = 1. */
AMB_INLINE f32x julia_log(f32x a)
{
    f32x exponent = i_to_f((f_bits(a) >> 23) - 127);
    f32x f = f_from_bits((f_bits(a) & 0x7fffff) | 0x3f800000) - 1.0f;
    return (exponent + (f + 0.2786f * f * (1.0f - f))) * (0.5f * AMB_LN2);
}

/* A point of an orbit. Each step is written for the shortest chain of dependent operations, which is what bounds the
 * speed: c joins before the sum that x waits for. */
typedef struct julia_point {
    f32x x, y, xx, ww; /* xx = x², ww = w² */
    f32x rest;         /* y² + w² - Re c: what x² must lose */
    f32x square;       /* |z|² */
} julia_point;

AMB_INLINE julia_point julia_point_at(f32x x, f32x y, f32x ww, float c)
{
    f32x xx = x * x, yy = y * y;
    return (julia_point){x, y, xx, ww, yy + (ww - c), (xx + yy) + ww};
}

/* z ← z² + c. */
AMB_INLINE julia_point julia_step(julia_point z, const julia_set *set)
{
    return julia_point_at(z.xx - z.rest, z.x * (z.y + z.y) + set->along, z.xx * (4.0f * z.ww), set->c.x);
}

/* An orbit on its way out. */
typedef struct julia_orbit {
    julia_point z;
    f32x last, slope, scale; /* |z|², |z'|², 2⁻ⁿ; kept from the escape on */
} julia_orbit;

AMB_INLINE julia_orbit julia_orbit_from(v3x p, const julia_set *set)
{
    f32x y = p.y * set->axis.x + p.z * set->axis.y, one = f_set(1.0f);
    julia_point z = julia_point_at(p.x, y, f_max((p.y * p.y + p.z * p.z) - y * y, f_set(0.0f)), set->c.x);
    return (julia_orbit){z, z.square, one, one};
}

AMB_INLINE maskx julia_bounded(const julia_orbit *o) { return o->z.square <= JULIA_ESCAPE; }

/* Two steps. A lane that has escaped runs on to infinity and NaN, which never compare as bounded again. */
AMB_INLINE void julia_orbit_on(julia_orbit *o, const julia_set *set)
{
    maskx bounded = julia_bounded(o);
    f32x steeper = 16.0f * o->z.square;
    o->z = julia_step(o->z, set);
    steeper = steeper * o->z.square;
    o->z = julia_step(o->z, set);
    o->slope = f_sel(bounded, o->slope * steeper, o->slope);
    o->scale = f_sel(bounded, o->scale * 0.25f, o->scale);
    o->last = f_sel(bounded, o->z.square, o->last);
}

AMB_INLINE f32x julia_orbit_distance(const julia_orbit *o)
{
    /* The root beside the logarithm, not after it: a march waits for this chain at every step. */
    f32x root = f_sqrt(o->last / o->slope);
    f32x log_z = julia_log(o->last), g = log_z * o->scale, far = 1.0f + g * (1.0f + g * (1.0f / 3.0f));
    f32x d = root * ((0.5f * log_z) / far);
    return f_sel(o->last <= JULIA_ESCAPE, f_set(0.0f), d);
}

/* Lower bound of the distance; 0 for points that stay bounded. `user` is a julia_set. */
AMB_INLINE f32x julia_distance(v3x p, const void *user)
{
    const julia_set *set = user;
    julia_orbit o = julia_orbit_from(p, set);
    for (int i = 0; i < set->iterations && m_any(julia_bounded(&o)); i += 2)
        julia_orbit_on(&o, set);
    return julia_orbit_distance(&o);
}

/* Two points a lane, each as above. */
AMB_INLINE void julia_distance_pair(const v3x p[2], f32x distance[2], const void *user)
{
    const julia_set *set = user;
    julia_orbit o = julia_orbit_from(p[0], set), q = julia_orbit_from(p[1], set);
    for (int i = 0; i < set->iterations && m_any(julia_bounded(&o) | julia_bounded(&q)); i += 2) {
        julia_orbit_on(&o, set);
        julia_orbit_on(&q, set);
    }
    distance[0] = julia_orbit_distance(&o);
    distance[1] = julia_orbit_distance(&q);
}

typedef struct julia_surface {
    v3x normal; /* unit, gradient of the potential */
    f32x trap;  /* least |z|² of the orbit after the start: small in folds */
} julia_surface;

/* The analytic gradient of log|z| after the same iterations, by the orbit's Jacobian in (x, y, w). */
AMB_INLINE julia_surface julia_surface_at(v3x p, const julia_set *set)
{
    f32x x = p.x, y = p.y * set->axis.x + p.z * set->axis.y;
    v3x across = {p.y - y * set->axis.x, p.z - y * set->axis.y, y * -set->axis.z}; /* imaginary part off the axis */
    f32x w = v3x_length(across);
    v3x jx = {f_set(1.0f), f_set(0.0f), f_set(0.0f)}; /* d x / d (x, y, w) of the start */
    v3x jy = {f_set(0.0f), f_set(1.0f), f_set(0.0f)}, jw = {f_set(0.0f), f_set(0.0f), f_set(1.0f)};
    v3x gradient = {x, y, w};
    f32x trap = f_set(1.0f);
    maskx going = m_set(true);
    for (int i = 0; i <= set->iterations; i++) {
        f32x xx = x * x, yy = y * y, ww = w * w, square = xx + (yy + ww);
        v3x g = v3x_add(v3x_add(v3x_scale(jx, x), v3x_scale(jy, y)), v3x_scale(jw, w)); /* grad |z|²/2 */
        gradient = v3x_sel(going, g, gradient);
        if (i > 0)
            trap = f_sel(going, f_min(square, trap), trap);
        going &= square <= JULIA_ESCAPE;
        if (!m_any(going) || i == set->iterations)
            break;
        f32x x2 = x + x, y2 = y + y, w2 = w + w;
        v3x nx = v3x_sub(v3x_sub(v3x_scale(jx, x2), v3x_scale(jy, y2)), v3x_scale(jw, w2));
        jy = v3x_add(v3x_scale(jy, x2), v3x_scale(jx, y2));
        jw = v3x_add(v3x_scale(jw, x2), v3x_scale(jx, w2));
        jx = nx;
        y = x2 * y + set->along;
        w = x2 * w;
        x = (xx - (yy + ww)) + set->c.x;
    }
    /* Back from (x, y, w) to space: y along the axis, w along the unit vector across it. */
    f32x per_w = gradient.z / f_max(v3x_length(across), f_set(1e-20f));
    v3x n = {gradient.x, gradient.y * set->axis.x + per_w * across.x, gradient.y * set->axis.y + per_w * across.y};
    f32x largest = f_max(f_max(f_abs(n.x), f_abs(n.y)), f_abs(n.z));
    n = v3x_scale(n, 1.0f / f_max(largest, f_set(FLT_MIN)));
    return (julia_surface){v3x_normalize(n), trap};
}

#endif
