#ifndef TESTS_RAYS_LISTS_H
#define TESTS_RAYS_LISTS_H

#include <ambiance/rays.h>

typedef struct listed_ray {
    v3 origin, direction;
    float t_near, t_far;
    int dead;
} listed_ray;
typedef struct listed_hit {
    int hit, occluded;
    float t, u, v, t_exit;
    v3 normal;
    int geometry, primitive;
} listed_hit;

void trace_list_x4(const amb_rays *rays, const listed_ray *ray, int count, listed_hit *hit);
#if defined(__x86_64__)
void trace_list_x8(const amb_rays *rays, const listed_ray *ray, int count, listed_hit *hit);
void trace_list_x16(const amb_rays *rays, const listed_ray *ray, int count, listed_hit *hit);
#endif

#endif
