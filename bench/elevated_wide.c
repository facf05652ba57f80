/* The elevated workload's shaders; elevated_gl.c holds their GLSL twins, line for line. */
#include "bench/elevated.h"
#include "shade/diffuse.h"
#include "shade/fog.h"

#define elevated_bench_shaders_get WIDE(elevated_bench_shaders_get)
const elevated_bench_shaders *elevated_bench_shaders_get(void);

typedef struct varyings {
    v3x world;
} varyings;

static void vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const elevated_bench *b = in->uniforms;
    varyings *v = out->varyings;
    const int side = ELEVATED_QUADS + 1;
    i32x row = f_to_i((i_to_f(in->vertex) + 0.5f) * (1.0f / (float)side)); /* vertex / 513, exact for these */
    i32x column = in->vertex - row * side;
    f32x x = (i_to_f(column) * (1.0f / ELEVATED_QUADS) - 0.5f) * b->size;
    f32x z = (i_to_f(row) * (1.0f / ELEVATED_QUADS) - 1.0f) * b->size;
    f32x height = terrain_at(&b->terrain, (v2x){x, z}, f_set(ELEVATED_GEOMETRY)).height;
    v->world = (v3x){x, height * b->scale, z};
    out->clip = m4_project_x(b->world_to_clip, v->world);
}

static void ground(const amb_fs_in *in, amb_fs_out *out)
{
    const elevated_bench *b = in->uniforms;
    v3x world = ((const varyings *)in->varyings)->world;
    v2x p = {world.x, world.z};
    v3x to_sun = v3x_splat(b->sky.to_sun);

    v3x normal = terrain_normal(terrain_at(&b->terrain, p, f_set(ELEVATED_SHADING)).slope, b->scale);
    v3x coarse = terrain_normal(terrain_at(&b->terrain, p, f_set(ELEVATED_COARSE)).slope, b->scale);
    f32x shadow = f_smoothstep(f_set(-0.02f), f_set(0.18f), v3x_dot(coarse, to_sun));
    f32x occlusion = terrain_occlusion(normal.y, b->occlusion_power, b->occlusion_floor);
    f32x noise = terrain_fbm(&b->terrain, v2x_scale(p, f_set(6.0f)), f_set(ELEVATED_SNOW));
    f32x snow = terrain_snow(normal.y, noise, b->snow);

    f32x facing = diffuse_lambert(v3x_dot(normal, to_sun)) * shadow;
    v3x light =
        v3x_add(v3x_scale(v3x_splat(b->sky.sun_rgb), facing), v3x_scale(v3x_splat(b->sky.ambient_rgb), occlusion));
    v3x albedo = v3x_lerp(v3x_splat(b->land_rgb), v3x_splat(b->snow_rgb), snow);

    v3x way = v3x_sub(world, v3x_splat(b->eye));
    f32x distance = v3x_length(way);
    v3x direction = v3x_scale(way, 1.0f / distance);
    f32x left = f_exp(-fog_depth(f_set(b->eye.y), direction.y, distance, b->fog_density, b->fog_falloff));
    v3x rgb = v3x_lerp(sky_horizon_rgb(&b->sky, direction), v3x_mul(albedo, light), left);
    out->color[0] = v4x_of3(v3x_scale(rgb, f_set(b->gain)), f_set(1.0f));
}

static void sky(const amb_fs_in *in, amb_fs_out *out)
{
    const elevated_bench *b = in->uniforms;
    v3x ray = v3x_add(v3x_splat(b->ray_origin),
                      v3x_add(v3x_scale(v3x_splat(b->ray_dx), in->x), v3x_scale(v3x_splat(b->ray_dy), in->y)));
    out->color[0] = v4x_of3(v3x_scale(sky_rgb(&b->sky, v3x_normalize(ray)), f_set(b->gain)), f_set(1.0f));
}

const elevated_bench_shaders *elevated_bench_shaders_get(void)
{
    static const elevated_bench_shaders shaders = {AMB_LANES, sizeof(varyings) / sizeof(f32x), vertex, ground, sky};
    return &shaders;
}
