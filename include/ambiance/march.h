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

/* A march under way. Steps are longer than the distance: B. Keinert et al., "Enhanced sphere tracing", STAG 2014. When
 * the empty balls at both ends of a step turn out not to touch, the ray goes back to the end of the first ball, so
 * nothing is skipped that plain steps would find. */
#define AMB_MARCH_STRIDE 1.5f

typedef struct amb_marching {
    amb_marched result;
    f32x ball, step; /* radius and length of the step before */
    f32x t1;
    maskx going;
} amb_marching;

AMB_INLINE amb_marching amb_march_start(f32x t0, f32x t1, maskx live)
{
    f32x zero = f_set(0.0f);
    return (amb_marching){{m_set(false), t0, f_set(FLT_MAX), i_set(0)}, zero, zero, t1, live & (t0 <= t1)};
}

/* Takes in the distance d at result.t and moves the lanes still going. */
AMB_INLINE void amb_march_step(amb_marching *m, f32x d, const amb_march_limits *limits)
{
    amb_marched *r = &m->result;
    r->steps = r->steps + i_sel(m->going, i_set(1), i_set(0));
    maskx gap = m->step > m->ball + f_abs(d);
    maskx near = m->going & ~gap & (d <= f_max(r->t * (limits->footprint * limits->tolerance), f_set(limits->least)));
    r->distance = f_sel(m->going & ~gap, d, r->distance);
    r->hit |= near;
    m->going &= ~near;
    /* A long step past t1 would go unchecked. */
    f32x next = f_min(d * AMB_MARCH_STRIDE, f_max(d, m->t1 - r->t)), back = m->ball - m->step;
    r->t = f_sel(m->going, r->t + f_sel(gap, back, next), r->t);
    m->step = f_sel(gap, m->ball, next);
    m->ball = f_sel(gap, m->ball, d);
    m->going &= r->t <= m->t1; /* also ends lanes whose distance is NaN */
}

/* Marches origin + t · direction (unit length) from t0 to t1. Lanes with t0 > t1, NaN limits or not live do not start;
 * lanes that run out of steps have not hit. */
AMB_INLINE amb_marched amb_march(amb_distance distance, const void *user, v3x origin, v3x direction, f32x t0, f32x t1,
                                 const amb_march_limits *limits, maskx live)
{
    amb_marching m = amb_march_start(t0, t1, live);
    for (int i = 0; i < limits->steps && m_any(m.going); i++)
        amb_march_step(&m, distance(v3x_add(origin, v3x_scale(direction, m.result.t)), user), limits);
    return m.result;
}

/* Two packets of one origin at once, for distances that are one long chain of dependent operations: a processor works
 * on one while the other waits. Each comes out as amb_march would have it. */
typedef void (*amb_distance_pair)(const v3x point[2], f32x distance[2], const void *user);
AMB_INLINE void amb_march_pair(amb_distance_pair distance, const void *user, v3x origin, const v3x direction[2],
                               const f32x t0[2], const f32x t1[2], const amb_march_limits *limits, const maskx live[2],
                               amb_marched out[2])
{
    amb_marching m = amb_march_start(t0[0], t1[0], live[0]), n = amb_march_start(t0[1], t1[1], live[1]);
    for (int i = 0; i < limits->steps && m_any(m.going | n.going); i++) {
        const v3x p[2] = {v3x_add(origin, v3x_scale(direction[0], m.result.t)),
                          v3x_add(origin, v3x_scale(direction[1], n.result.t))};
        f32x d[2];
        distance(p, d, user);
        amb_march_step(&m, d[0], limits);
        amb_march_step(&n, d[1], limits);
    }
    out[0] = m.result;
    out[1] = n.result;
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
