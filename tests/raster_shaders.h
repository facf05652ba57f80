/* Shaders of the rasterizer's tests, one set per instruction set. */
#ifndef TESTS_RASTER_SHADERS_H
#define TESTS_RASTER_SHADERS_H

#include <ambiance/raster.h>

typedef struct raster_test_vertex {
    v4 clip;
    v4 value; /* handed to the fragment stage */
} raster_test_vertex;

typedef struct raster_test_uniforms {
    const raster_test_vertex *vertex;
    v4 offset;          /* of clip per instance */
    float discard;      /* fragments with value.x below it are discarded (0: none) */
    float depth;        /* written by the depth-writing shader: depth · this */
    const float *table; /* of the table shader: four floats a pixel */
    int table_width;
    const amb_texture *texture; /* of the textured shaders, and of fetch */
    amb_sampler sampler;
    v2 ddx, ddy; /* gradients that the shader gives */
    v4 step;     /* the copying geometry shader moves copy c by c · step in clip space */
    int corners; /* of the primitives it gets */
    int copies;  /* at most; RASTER_TEST_COPIES of primitive n */
    int factors; /* of patches: RASTER_TEST_FACTOR; odd: NaN among them */
    int targets; /* that the coded shaders write, at least two */
    int hostile; /* 0…8: how many of 8 of their values are of RASTER_TEST_HOSTILE instead */
    int holes;   /* the coded shaders discard fragments where (x + 2y + primitive) mod 4 is below this */
} raster_test_uniforms;

typedef struct raster_test_shaders {
    int lanes;
    amb_vertex_shader vertex;
    amb_geometry_shader copy;          /* each primitive several times or not at all, each a strip */
    amb_hull_shader hull;              /* patch_floats: 1, zero */
    amb_domain_shader quad, triangle;  /* the corners' places, bilinear or by weights; value: 0 */
    amb_fragment_shader value;         /* target 0: value; target 1: d value.x/dx, d/dy, x, y; target 2: ids, depth */
    amb_fragment_shader one;           /* target 0: 1, value.x */
    amb_fragment_shader write_depth;   /* target 0: value; depth · uniforms.depth */
    amb_fragment_shader coded;         /* targets: RASTER_TEST_CODE of primitive and channel */
    amb_fragment_shader coded_depth;   /* and depth: RASTER_TEST_CODE of the primitive and 9 */
    amb_fragment_shader screen;        /* target 0: x, y, depth, 1 */
    amb_vertex_shader fetch;           /* value: the texture at value.x, value.y, level value.z */
    amb_fragment_shader textured;      /* target 0: the texture at value.x, value.y; target 1: with ddx, ddy */
    amb_fragment_shader textured_cube; /* target 0: the texture in direction value.x, y, z */
    amb_fragment_shader table;         /* every target: the table's value of the pixel */
} raster_test_shaders;

/* A small exact number of a primitive and a channel: -¼…1, without rounding. */
#define RASTER_TEST_CODE(primitive, salt) ((float)(((primitive)*37 + (salt)*11 + 5) & 31) * 0.0390625f - 0.25f)

#define RASTER_TEST_COPIES(primitive) (((primitive)*5 + 1) & 3)
/* Which of RASTER_TEST_FACTORS edge or inside `side` of a patch gets; the last is 2 unless `factors` is odd. */
#define RASTER_TEST_FACTOR(patch, side, factors) (((patch)*3 + (side)*5 + (factors)) & 7)
#define RASTER_TEST_FACTORS                              \
    {                                                    \
        1.0f, 2.5f, 3.0f, 1.25f, 3.75f, 0.75f, 1.0f, NAN \
    }
#define RASTER_TEST_HOSTILE                                               \
    {                                                                     \
        NAN, INFINITY, -INFINITY, 1e30f, -1e-40f, 1e-42f, 70000.0f, -0.0f \
    }

const raster_test_shaders *raster_test_shaders_of(amb_isa isa);

#endif
