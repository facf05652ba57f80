/* Ray queries: Embree's BVH with our own intersectors, so that every instruction set finds the same hits with the same
 * bits; equal distances go to the lower (geometry, primitive). Committed scenes are immutable: query from any thread.
 */
#ifndef AMBIANCE_RAYS_H
#define AMBIANCE_RAYS_H

#include <ambiance/context.h>
#include <ambiance/mesh.h>
#include <ambiance/vec.h>

typedef struct amb_rays amb_rays;

typedef struct amb_rays_sphere {
    v3 center;
    float radius;
} amb_rays_sphere;

/* One geometry: exactly one of mesh and spheres is given. Geometry numbers are positions in the list. */
typedef struct amb_rays_geometry {
    const amb_mesh *mesh;           /* copied */
    const amb_rays_sphere *spheres; /* copied */
    uint32_t sphere_count;
} amb_rays_geometry;

/* Coordinates and radii up to 2⁵⁶. Errors: ARGUMENT, FORMAT (index out of range, position not finite), LIMIT, MEMORY.
 * Triangles without area and spheres without a positive finite radius or a finite centre are never hit. */
amb_status amb_rays_create(const amb_context *context, const amb_rays_geometry *geometry, uint32_t geometry_count,
                           amb_rays **out, amb_error *error);
void amb_rays_close(amb_rays **rays); /* frees and nulls */

typedef struct amb_rayx {
    v3x origin, direction; /* world; direction of any non-zero length: t counts in its length */
    f32x t_near, t_far;    /* hits with t_near < t ≤ t_far count; t_near below 0 counts as 0; t_far may be infinite */
} amb_rayx;

typedef struct amb_hitx {
    maskx hit;
    f32x t;                   /* t_far where nothing was hit */
    f32x u, v;                /* barycentrics of the triangle's 2nd and 3rd vertex; spheres: 0 */
    i32x geometry, primitive; /* -1 where nothing was hit */
    f32x t_exit;              /* spheres: where the ray leaves; triangles: t; t_far where nothing was hit */
    v3x normal;               /* unit geometric normal; of a triangle by its winding; not flipped to the ray */
} amb_hitx;

/* Lanes forms, one packet a call. Dead lanes cost nothing and come back as no hit. Rays whose origin or direction is
 * not finite, whose direction's largest component is below 2⁻¹²⁶ or whose limits are NaN miss. Triangles are two-sided
 * and watertight: no ray slips between triangles that share vertices. A sphere is hit where the ray enters it, from
 * inside where it leaves. Limits are compared near the scene: a ray from 4 scene radii away or more is first moved
 * along itself, which rounds t by up to 2⁻²² of its length. */
#define amb_rays_closest WIDE(amb_rays_closest)
void amb_rays_closest(const amb_rays *rays, const amb_rayx *ray, maskx live, amb_hitx *out);
/* Any hit at all? */
#define amb_rays_occluded WIDE(amb_rays_occluded)
maskx amb_rays_occluded(const amb_rays *rays, const amb_rayx *ray, maskx live);

#endif
