/* The plain workloads' shaders; plain.c holds their GLSL twins. */
#include "bench/plain.h"

#define plain_shaders_get WIDE(plain_shaders_get)
const plain_shaders *plain_shaders_get(void);

typedef struct plain_varyings {
    v3x normal;
} plain_varyings;

static v4x place(const plain_uniforms *u, i32x vertex)
{
    v3x world = v3x_add(v3x_scale(v3x_gather(u->mesh->position, vertex), f_set(u->scale)), v3x_splat(u->offset));
    return m4_project_x(u->world_to_clip, world);
}

static void vertex_depth(const amb_vs_in *in, amb_vs_out *out) { out->clip = place(in->uniforms, in->vertex); }

static void vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const plain_uniforms *u = in->uniforms;
    plain_varyings *v = out->varyings;
    v->normal = v3x_gather(u->mesh->normal, in->vertex);
    out->clip = place(u, in->vertex);
}

static void fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const plain_uniforms *u = in->uniforms;
    const plain_varyings *v = in->varyings;
    f32x facing = f_max(v3x_dot(v->normal, v3x_splat(u->to_sun)), f_set(0.0f));
    out->color[0] = v4x_of3(v3x_scale(v3x_splat(u->color), 0.2f + 0.8f * facing), f_set(1.0f));
}

const plain_shaders *plain_shaders_get(void)
{
    static const plain_shaders shaders = {AMB_LANES, sizeof(plain_varyings) / sizeof(f32x), vertex, vertex_depth,
                                          fragment};
    return &shaders;
}
