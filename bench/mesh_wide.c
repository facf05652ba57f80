/* The mesh workload's shaders; mesh.c holds their GLSL twins, line for line. */
#include "bench/mesh.h"
#include "shade/fresnel.h"
#include "shade/normal_map.h"
#include "shade/specular.h"

#define mesh_shaders_get WIDE(mesh_shaders_get)
const mesh_shaders *mesh_shaders_get(void);

typedef struct mesh_varyings {
    v3x world, normal;
    v4x tangent;
    v2x uv;
} mesh_varyings;

static void vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const mesh_uniforms *u = in->uniforms;
    mesh_varyings *v = out->varyings;
    v->world = v3x_gather(u->mesh->position, in->vertex);
    v->normal = v3x_gather(u->mesh->normal, in->vertex);
    v->tangent = v4x_gather(u->mesh->tangent, in->vertex);
    v->uv = v2x_gather(u->mesh->uv, in->vertex);
    out->clip = m4_project_x(u->world_to_clip, v->world);
}

static void fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const mesh_uniforms *u = in->uniforms;
    const mesh_varyings *v = in->varyings;
    v4x map[2];
    amb_sample_2d_pair(u->color, u->normal, &u->surface, v->uv, map);

    v3x across = normal_map_bitangent(v4x_xyz(v->tangent), v->normal, v->tangent.w);
    v3x n = normal_map_apply(normal_map_decode(v4x_xyz(map[1]), 1.0f), v4x_xyz(v->tangent), across, v->normal);
    v3x to_eye = v3x_normalize(v3x_sub(v3x_splat(u->eye), v->world)), to_sun = v3x_splat(u->light.to_sun);

    f32x facing = f_max(v3x_dot(n, to_sun), f_set(0.0f));
    f32x highlight = specular_blinn_phong(n, to_sun, to_eye, u->light.specular_exponent);
    f32x reflectance = fresnel_schlick(v3x_dot(n, to_eye), f_set(u->light.f0));
    v4x sky = amb_sample_cube(u->environment, &u->sky, v3x_reflect(v3x_neg(to_eye), n));

    v3x lit = v3x_add(v3x_splat(u->light.ambient_rgb), v3x_scale(v3x_splat(u->light.sun_rgb), facing));
    v3x rgb = v3x_mul(v4x_xyz(map[0]), lit);
    rgb = v3x_add(rgb, v3x_scale(v3x_splat(u->light.sun_rgb), highlight));
    rgb = v3x_add(rgb, v3x_scale(v4x_xyz(sky), reflectance));
    out->color[0] = v4x_of3(rgb, f_set(1.0f));
}

const mesh_shaders *mesh_shaders_get(void)
{
    static const mesh_shaders shaders = {AMB_LANES, sizeof(mesh_varyings) / sizeof(f32x), vertex, fragment};
    return &shaders;
}
