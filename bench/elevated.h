/* Shared by the elevated workload's files. */
#ifndef AMB_BENCH_ELEVATED_H
#define AMB_BENCH_ELEVATED_H

#include "shade/sky.h"
#include "shade/terrain.h"

#include <ambiance/raster.h>

enum { ELEVATED_QUADS = 512, ELEVATED_GEOMETRY = 8, ELEVATED_SHADING = 12, ELEVATED_COARSE = 5, ELEVATED_SNOW = 4 };

/* The same numbers go to the peer. */
typedef struct elevated_bench {
    m4 world_to_clip;
    v3 eye, ray_origin, ray_dx, ray_dy;
    amb_terrain terrain;
    amb_sky sky;
    float size, scale; /* cells a side of the ground; factor on heights */
    float gain;
    float fog_density, fog_falloff;
    v3 snow_rgb, land_rgb;
    terrain_snow_edges snow;
    float occlusion_power, occlusion_floor;
} elevated_bench;

typedef struct elevated_bench_shaders {
    int lanes, varying_floats;
    amb_vertex_shader vertex;
    amb_fragment_shader ground, sky;
} elevated_bench_shaders;

/* bench/elevated_gl.c: GLSL of the vertex stage and of the two fragment stages, and their uniforms. */
extern const char *const elevated_gl_ground_vertex, *const elevated_gl_ground_fragment;
extern const char *const elevated_gl_sky_vertex, *const elevated_gl_sky_fragment;
void elevated_gl_uniforms(unsigned program, const elevated_bench *b);

#endif
