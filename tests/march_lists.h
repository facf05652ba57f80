#ifndef TESTS_MARCH_LISTS_H
#define TESTS_MARCH_LISTS_H

#include <ambiance/vec.h>

typedef enum marched_shape { MARCH_SPHERE, MARCH_TORUS, MARCH_BOX, MARCH_SHAPES } marched_shape;
typedef struct marched_ray {
    v3 origin, direction;
    float t0, t1;
    int dead;
} marched_ray;
typedef struct marched_hit {
    int hit;
    float t, distance;
    int steps;
    float cone;
} marched_hit;

#define MARCH_FOOTPRINT 1e-3f
#define MARCH_TOLERANCE 0.1f
#define MARCH_LEAST 1e-5f
#define MARCH_STEPS 2000
#define MARCH_CONE 0.02f

void march_list_x1(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit);
void march_list_x4(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit);
#if defined(__x86_64__)
void march_list_x8(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit);
void march_list_x16(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit);
#endif

#endif
