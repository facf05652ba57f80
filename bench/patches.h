/* Shared by the patches workload's files. */
#ifndef AMB_BENCH_PATCHES_H
#define AMB_BENCH_PATCHES_H

#include <ambiance/raster.h>

enum { PATCHES_SIDE = 512, PATCHES_OCTAVES = 4 };

/* The same numbers go to the peer. */
typedef struct patches_uniforms {
    m4 world_to_clip;
    v3 eye, to_sun;
    float size;   /* of the ground, which begins at the eye's side */
    float height; /* of the largest hills */
    float reach;  /* an edge at distance d is cut into reach / d segments */
} patches_uniforms;

typedef struct patches_shaders {
    int lanes, varying_floats, patch_floats;
    amb_hull_shader hull;
    amb_domain_shader domain;
    amb_fragment_shader fragment;
} patches_shaders;

/* bench/patches_gl.c: the peer's program, in use and with its uniforms. */
amb_status patches_gl_program(const patches_uniforms *u, unsigned *program, amb_error *error);

#endif
