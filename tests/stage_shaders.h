/* Shaders of the tests of the tessellation and geometry stages, one set per instruction set. */
#ifndef TESTS_STAGE_SHADERS_H
#define TESTS_STAGE_SHADERS_H

#include <ambiance/raster.h>

#define STAGE_TEST_STRIP_LENGTH 5 /* vertices of the longer strips of the cutting shader */

typedef struct stage_test_uniforms {
    const v4 *clip;      /* of the corners */
    int corners;         /* of a patch, 3 or 4 */
    const float *factor; /* edge 0…3, inside 0…1 of each patch */
    int emitted;         /* vertices that the amplifying shader emits for primitive n: emitted - n mod 7 */
    v4 size;             /* of billboards: half of it, in clip x and y */
} stage_test_uniforms;

/* Varyings of all of them: four floats. */
typedef struct stage_test_shaders {
    int lanes;
    amb_vertex_shader vertex; /* clip position; varying: vertex number, instance, 0, 1 */
    amb_hull_shader hull;     /* patch_floats: 16, its corners' clip positions */
    amb_domain_shader quad;   /* of four corners, bilinear; varying: u, v, patch, instance */
    amb_domain_shader triangle;
    amb_geometry_shader same;      /* triangles as they are */
    amb_geometry_shader cull;      /* drops every third triangle */
    amb_geometry_shader billboard; /* of points: strips of two triangles */
    amb_geometry_shader amplify;   /* of points: strips zigzagging to the right */
    amb_geometry_shader cuts;      /* of points: strips of 1, 2, 3, 4, 5, 1, … vertices, 16 vertices in all */
    amb_fragment_shader covered;   /* target 0: 1 or, of back faces, -1; 1 */
    amb_fragment_shader shade;     /* target 0: the varying's x, y, z, alpha ½ */
    amb_fragment_shader number;    /* target 0: varying x, y, the primitive's number, varying z */
} stage_test_shaders;

const stage_test_shaders *stage_test_shaders_of(amb_isa isa);

#endif
