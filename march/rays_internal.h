/* Inside of amb_rays: the scene handed to Embree, and what its callbacks read.
 *
 * Embree's own primitives give other bits on other instruction sets, so Embree only walks its tree; every hit is
 * computed here with one fixed order of IEEE operations. Which hits exist must not depend on the tree either:
 *  1. a hit counts only when its t lies in the slab interval of its cluster's box grown by `pad`, by our arithmetic;
 *  2. Embree gets boxes grown by 2·pad. Its traversal of user geometry is the fast one (approximate reciprocals, fused
 *     operations), but its errors and those of (1) are a few units in the last place of the distances and coordinates
 *     met, and pad exceeds them, because origins stay within a few scene radii (AMB_RAYS_NEAR);
 *  3. farther origins are first moved along their ray, in double, to the scene. */
#ifndef MARCH_RAYS_INTERNAL_H
#define MARCH_RAYS_INTERNAL_H

#include <ambiance/rays.h>
#include <embree3/rtcore.h>

#define AMB_CLUSTER 8            /* triangles a cluster: one Embree primitive, tested lanes-wide */
#define AMB_MAX_PACKET 16        /* lanes of the widest query */
#define AMB_RAYS_NEAR 4.0f       /* scene radii */
#define AMB_RAYS_LARGEST 0x1p56f /* largest coordinate or radius accepted: Embree takes origins up to 1.8e18 */

/* Triangles that lie close together, structure of arrays; unused places hold NaN and can never be hit. */
typedef struct amb_cluster {
    float vertex[3][3][AMB_CLUSTER]; /* [corner][axis][triangle] */
    uint32_t primitive[AMB_CLUSTER];
    uint32_t geometry, count;
    v3 lo, hi; /* bounds grown by pad */
} amb_cluster;

typedef struct amb_ball {
    v3 center;
    float radius;
    uint32_t geometry, primitive;
    v3 lo, hi; /* bounds grown by pad */
} amb_ball;

struct amb_rays {
    RTCDevice device;
    RTCScene scene;
    v3 center; /* of the bounds of everything */
    float radius, pad;
    amb_cluster *cluster;
    uint32_t cluster_count, cluster_limit;
    amb_ball *ball;
    uint32_t ball_count;
    struct {
        enum RTCError code;
        char text[160];
    } failure; /* Embree's first error while building */
};

/* What a query computes once per ray; Embree hands the pointer through to the callbacks. Indexed by the ray's id. */
typedef struct amb_query {
    struct RTCIntersectContext embree; /* first: callbacks cast back */
    uint32_t lanes;
    _Alignas(64) float inverse[3][AMB_MAX_PACKET]; /* 1/direction, finite */
    float shear[3][AMB_MAX_PACKET];                /* Woop's Sx Sy Sz */
    int32_t axis[AMB_MAX_PACKET];                  /* Woop's kz */
} amb_query;

/* Hits name their triangle as cluster·AMB_CLUSTER + place and their sphere as ~index, kept in the unused Ng_x. */

typedef struct amb_reference { /* a triangle while clusters are made */
    v3 lo, hi;
    uint32_t primitive;
} amb_reference;

/* Reorders `reference` and calls emit(user, first, n), 1 ≤ n ≤ AMB_CLUSTER, for compact runs that cover it. Top-down
 * binned surface area heuristic (Wald 2007) in units of whole clusters; depends on the input only. */
void amb_cluster_build(amb_reference *reference, uint32_t count,
                       void (*emit)(void *user, const amb_reference *first, uint32_t n), void *user);

/* amb_rays_create with Embree's own configuration string appended (tests force its instruction sets). */
amb_status amb_rays_create_on(const char *embree, const amb_context *context, const amb_rays_geometry *geometry,
                              uint32_t geometry_count, amb_rays **out, amb_error *error);

/* Embree callbacks, one set an instruction set; any packet width N. userdata: the amb_rays. */
typedef struct amb_ray_callbacks {
    RTCIntersectFunctionN closest_triangle, closest_ball;
    RTCOccludedFunctionN any_triangle, any_ball;
} amb_ray_callbacks;
extern const amb_ray_callbacks amb_ray_callbacks_x4;
#if defined(__x86_64__)
extern const amb_ray_callbacks amb_ray_callbacks_x8, amb_ray_callbacks_x16;
#endif

#endif
