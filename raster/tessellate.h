/* The fixed-function tessellator: from a patch's factors to points of its domain and the triangles between them, by the
 * rules of Direct3D 11 ("Direct3D 11.3 Functional Specification", section 11, Tessellator).
 *
 * All of it is integer arithmetic in 1/65536. Points of an edge depend on that edge's factor alone and lie symmetric to
 * its middle, bit by bit, so that neighbouring patches meet in the same points from both sides. */
#ifndef AMBIANCE_RASTER_TESSELLATE_H
#define AMBIANCE_RASTER_TESSELLATE_H

#include <ambiance/raster.h>

#define RASTER_FACTOR_ONE 65536
#define RASTER_PATTERN_POINTS 4225    /* at most: 65 × 65 */
#define RASTER_PATTERN_TRIANGLES 8192 /* at most: 2 · 64 · 64 */

/* Factors after clamping (and rounding up, where they are integers), in 1/65536; edge[0] 0: the patch is culled. What
 * the domain lacks is 0. */
typedef struct raster_factors {
    int32_t edge[4], inside[2];
} raster_factors;

raster_factors raster_clamp_factors(amb_patch_shape shape, amb_partitioning partitioning, const float edge[4],
                                    const float inside[2]);

typedef struct raster_pattern_size {
    int32_t points, triangles;
} raster_pattern_size;
/* Of factors that are not culled. */
raster_pattern_size raster_size_pattern(amb_patch_shape shape, amb_partitioning partitioning,
                                        const raster_factors *factors);

/* Points and triangles for one set of factors. Triangles depend on the numbers of segments only; where these agree with
 * what the pattern held before, only its points are made anew. */
typedef struct raster_pattern {
    uint64_t segments; /* all of them packed, with domain and partitioning; 0: empty */
    raster_factors factors;
    raster_pattern_size size;
    float *u, *v;     /* of the points, exact multiples of 1/65536 */
    uint16_t *corner; /* three a triangle, of positive area in the (u, v) plane */
    size_t u_capacity, v_capacity, corner_capacity;
} raster_pattern;

/* False when out of memory. */
bool raster_make_pattern(raster_pattern *pattern, amb_patch_shape shape, amb_partitioning partitioning,
                         const raster_factors *factors);
void raster_free_pattern(raster_pattern *pattern);

/* A cache of patterns: a worker's own. */
#define RASTER_PATTERN_SLOTS 32
typedef struct raster_pattern_cache {
    const raster_pattern *last;
    amb_patch_shape shape; /* and what it is of */
    amb_partitioning partitioning;
    raster_pattern slot[RASTER_PATTERN_SLOTS];
} raster_pattern_cache;
/* NULL when out of memory. The pattern lasts until the next call. */
const raster_pattern *raster_find_pattern(raster_pattern_cache *cache, amb_patch_shape shape,
                                          amb_partitioning partitioning, const raster_factors *factors);

#endif
