/* The plainest shaders, ours and GLSL: a placed mesh with a Lambert sun. For workloads that are about triangles. */
#ifndef AMB_BENCH_PLAIN_H
#define AMB_BENCH_PLAIN_H

#include "bench/picture.h"

#include <ambiance/camera.h>

typedef struct plain_uniforms {
    m4 world_to_clip;
    v3 offset, color, to_sun; /* world; linear; unit */
    float scale;              /* world = position · scale + offset */
    const amb_mesh *mesh;     /* positions and normals */
} plain_uniforms;

typedef struct plain_shaders {
    int lanes, varying_floats;
    amb_vertex_shader vertex, vertex_depth; /* the second gives no varyings: for depth-only passes */
    amb_fragment_shader fragment;
} plain_shaders;
const plain_shaders *plain_shaders_for(const amb_context *context);

/* The draw of a mesh; back faces culled. uniforms must outlive its recording. depth_only: no fragment shader. */
amb_draw plain_draw(const amb_context *context, const plain_uniforms *uniforms, bool depth_only);

/* The twin. Colours and offsets change from draw to draw, the rest is set once. */
typedef struct plain_peer {
    GLuint program;
    GLint offset, color;
    gl_mesh mesh;
} plain_peer;
amb_status plain_peer_open(const plain_uniforms *uniforms, plain_peer *out, amb_error *error);
void plain_peer_close(plain_peer *peer);
void plain_peer_bind(const plain_peer *peer);
void plain_peer_draw(const plain_peer *peer, v3 offset, v3 color);

#endif
