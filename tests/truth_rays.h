/* What a ray hits, found the slow way: every triangle is tried. Shares no code with march/. */
#ifndef TESTS_TRUTH_RAYS_H
#define TESTS_TRUTH_RAYS_H

#include "tests/rays_lists.h"

#include <ambiance/mesh.h>

typedef struct truth {
    int clear, hit, primitive;
    double t, u, v;
    double normal[3]; /* unit */
} truth;

/* Möller & Trumbore in double over all triangles. `clear` unless rounding in float could change the answer. */
truth true_hit(const amb_mesh *m, const listed_ray *r);

/* Woop, Benthin & Wald's test in plain float, nearest over all triangles, ties to the lower one: the bits. */
listed_hit scan(const amb_mesh *m, const listed_ray *r);

typedef struct ball_truth {
    int clear, ball; /* -1: none */
    double t, t_exit;
} ball_truth;

/* The quadratic formula in double over all balls; `clear` as above. */
ball_truth true_ball_hit(const amb_rays_sphere *ball, int count, const listed_ray *r);

#endif
