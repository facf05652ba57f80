/* Shared by the layers workload's files. */
#ifndef AMB_BENCH_LAYERS_H
#define AMB_BENCH_LAYERS_H

#include <ambiance/raster.h>
#include <ambiance/texture.h>

typedef struct layer_uniforms {
    v3 u, v; /* texture coordinates of window position (x, y, 1) */
    v4 tint;
    const amb_texture *texture;
    amb_sampler sampler;
} layer_uniforms;

typedef struct layer_shader {
    int lanes;
    amb_fragment_shader fragment;
} layer_shader;

#endif
