/* Sphere tracing, lanes-wide: J. C. Hart, "Sphere tracing: a geometric method for the antialiased ray tracing of
 * implicit surfaces", The Visual Computer 12, 1996.
 *
 * A distance function gives, for one point a lane, a value that is never more than the distance to the surface
 * (world units, negative or zero inside). It is a parameter of always-inlined functions: passed by name it is inlined
 * into the loop. Each lane stops by itself; the loop ends when none is left, so dead and early lanes cost only the
 * slowest lane's steps and never change a neighbour's bits. Pure functions; any thread. */
#ifndef AMBIANCE_MARCH_H
#define AMBIANCE_MARCH_H

#include <ambiance/vec.h>

typedef f32x (*amb_distance)(v3x point, const void *user);

typedef struct amb_march_limits {
    float footprint; /* radius of a pixel's cone per unit of t: a surface within footprint · t · tolerance is hit */
    float tolerance; /* in footprints, > 0: 0.5 resolves half a pixel */
    float least;     /* world units, > 0: within this it is hit in any case (near t = 0, where the cone is thin) */
    int steps;       /* most evaluations a lane; > 0 */
} amb_march_limits;

typedef struct amb_marched {
    maskx hit;
    f32x t;        /* hits: where; others: where it stopped, past t1 unless out of steps */
    f32x distance; /* the last value of the distance function */
    i32x steps;    /* evaluations spent */
} amb_marched;

/* Marches origin + t · direction (unit length) from t0 to t1. Lanes with t0 > t1, NaN limits or not live do not start;
 * lanes that run out of steps have not hit.
 *
 * Steps are longer than the distance: B. Keinert et al., "Enhanced sphere tracing", STAG 2014. When the empty balls at
 * both ends of a step turn out not to touch, the ray goes back to the end of the first ball, so nothing is skipped that
 * plain steps would find. */
#define AMB_MARCH_STRIDE 1.5f
AMB_INLINE amb_marched amb_march(amb_distance distance, const void *user, v3x origin, v3x direction, f32x t0, f32x t1,
                                 const amb_march_limits *limits, maskx live)
{
    amb_marched r = {m_set(false), t0, f_set(FLT_MAX), i_set(0)};
    float cone = limits->footprint * limits->tolerance;
    f32x ball = f_set(0.0f), step = f_set(0.0f); /* radius and length of the step before */
    maskx going = live & (t0 <= t1);
    for (int i = 0; i < limits->steps && m_any(going); i++) {
        f32x d = distance(v3x_add(origin, v3x_scale(direction, r.t)), user);
        r.steps = r.steps - i_sel(going, i_set(-1), i_set(0));
        maskx gap = step > ball + f_abs(d);
        maskx near = going & ~gap & (d <= f_max(r.t * cone, f_set(limits->least)));
        r.distance = f_sel(going & ~gap, d, r.distance);
        r.hit |= near;
        going &= ~near;
        f32x next = d * AMB_MARCH_STRIDE;
        next = f_min(next, f_max(d, t1 - r.t)); /* a long step past t1 would go unchecked */
        f32x back = ball - step;                /* to the end of the ball before */
        step = f_sel(gap, ball, next);
        r.t = f_sel(going, r.t + f_sel(gap, back, next), r.t);
        ball = f_sel(gap, ball, d);
        going &= r.t <= t1; /* also ends lanes whose distance is NaN */
    }
    return r;
}

/* A cone, for many rays at once: how far all rays within `radius` · t of origin + t · direction may go before any can
 * touch the surface. Starting those rays there changes where they sample but not what they hit. Never less than t0. */
AMB_INLINE f32x amb_march_cone(amb_distance distance, const void *user, v3x origin, v3x direction, f32x t0, f32x t1,
                               f32x radius, float least, int steps, maskx live)
{
    f32x t = t0, safe = t0, shrink = 1.0f / (1.0f + radius);
    maskx going = live & (t0 <= t1);
    for (int i = 0; i < steps && m_any(going); i++) {
        f32x d = distance(v3x_add(origin, v3x_scale(direction, t)), user);
        f32x clear = d - t * radius; /* the ball of radius d holds the cone's section, and the next `clear` of it */
        safe = f_sel(going & (clear > 0.0f), t + clear * shrink, safe);
        going &= clear > least;
        t = f_sel(going, t + clear * shrink, t);
        going &= t <= t1;
    }
    return safe;
}

#endif
