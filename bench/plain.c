#include "bench/plain.h"
#include "core/dispatch.h"

AMB_DECLARE_WIDE(const plain_shaders *, plain_shaders_get, (void));

const plain_shaders *plain_shaders_for(const amb_context *context)
{
    return AMB_DISPATCH(amb_context_isa(context), plain_shaders_get)();
}

amb_draw plain_draw(const amb_context *context, const plain_uniforms *uniforms, bool depth_only)
{
    const plain_shaders *s = plain_shaders_for(context);
    return (amb_draw){.label = "plain",
                      .lanes = s->lanes,
                      .vertex = depth_only ? s->vertex_depth : s->vertex,
                      .fragment = depth_only ? NULL : s->fragment,
                      .uniforms = uniforms,
                      .uniforms_size = sizeof *uniforms,
                      .varying_floats = depth_only ? 0 : s->varying_floats,
                      .indices = uniforms->mesh->index,
                      .count = uniforms->mesh->triangle_count * 3,
                      .vertex_count = uniforms->mesh->vertex_count,
                      .cull = AMB_CULL_BACK};
}

static const char *const plain_vertex =
    "layout(location=0) in vec3 position; layout(location=1) in vec3 normal;\n"
    "out vec3 up; uniform mat4 world_to_clip; uniform vec3 offset; uniform float scale;\n"
    "void main() {\n"
    "    vec4 clip = world_to_clip * vec4(position * scale + offset, 1.0);\n"
    "    up = normal;\n"
    "    gl_Position = vec4(clip.xy, 2.0 * clip.z - clip.w, clip.w);\n"
    "}\n";
static const char *const plain_fragment =
    "in vec3 up; uniform vec3 color, to_sun; out vec4 result;\n"
    "void main() { result = vec4(color * (0.2 + 0.8 * max(dot(up, to_sun), 0.0)), 1.0); }\n";

amb_status plain_peer_open(const plain_uniforms *u, plain_peer *out, amb_error *error)
{
    *out = (plain_peer){0};
    amb_status status = gl_program(plain_vertex, plain_fragment, &out->program, error);
    if (status)
        return status;
    gl_mesh_upload(u->mesh, &out->mesh);
    glUseProgram(out->program);
    gl_set_matrix(out->program, "world_to_clip", u->world_to_clip);
    gl_set3(out->program, "to_sun", u->to_sun);
    gl_set1(out->program, "scale", u->scale);
    out->offset = glGetUniformLocation(out->program, "offset");
    out->color = glGetUniformLocation(out->program, "color");
    return gl_check(error);
}

void plain_peer_close(plain_peer *peer)
{
    glDeleteProgram(peer->program);
    gl_mesh_close(&peer->mesh);
}

void plain_peer_bind(const plain_peer *peer)
{
    glUseProgram(peer->program);
    glBindVertexArray(peer->mesh.array);
}

void plain_peer_draw(const plain_peer *peer, v3 offset, v3 color)
{
    glUniform3f(peer->offset, offset.x, offset.y, offset.z);
    glUniform3f(peer->color, color.x, color.y, color.z);
    glDrawElements(GL_TRIANGLES, peer->mesh.index_count, GL_UNSIGNED_INT, NULL);
}
