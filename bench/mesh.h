/* Shared by the mesh workload's files. */
#ifndef AMB_BENCH_MESH_H
#define AMB_BENCH_MESH_H

#include <ambiance/camera.h>
#include <ambiance/mesh.h>
#include <ambiance/raster.h>
#include <ambiance/texture.h>

/* Linear radiance; directions unit, world space. The same numbers go to the peer. */
typedef struct mesh_light {
    v3 to_sun, sun_rgb, ambient_rgb;
    float specular_exponent, f0;
} mesh_light;

typedef struct mesh_uniforms {
    m4 world_to_clip;
    v3 eye;
    mesh_light light;
    const amb_mesh *mesh;
    const amb_texture *color, *normal, *environment;
    amb_sampler surface, sky;
} mesh_uniforms;

typedef struct mesh_shaders {
    int lanes, varying_floats;
    amb_vertex_shader vertex;
    amb_fragment_shader fragment;
} mesh_shaders;

#endif
