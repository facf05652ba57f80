/* The patches workload's shaders; patches_gl.c holds their GLSL twins, line for line. */
#include "bench/patches.h"

#define patches_shaders_get WIDE(patches_shaders_get)
const patches_shaders *patches_shaders_get(void);

typedef struct patch {
    f32x x, z, side;
} patch;

typedef struct varyings {
    v3x normal;
} varyings;

typedef struct hills {
    f32x height, slope_x, slope_z;
} hills;

/* Smooth bumps, four octaves of them. */
static hills hills_at(f32x x, f32x z)
{
    hills sum = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
    float frequency = 0.37f, amplitude = 1.0f;
    for (int i = 0; i < PATCHES_OCTAVES; i++) {
        f32x a = f_fract(x * frequency + 0.3f * (float)i), b = f_fract(z * frequency + 0.7f * (float)i);
        f32x p = a * (1.0f - a), q = b * (1.0f - b);
        sum.height += 256.0f * amplitude * (p * p) * (q * q);
        sum.slope_x += 512.0f * amplitude * frequency * p * (1.0f - 2.0f * a) * (q * q);
        sum.slope_z += 512.0f * amplitude * frequency * q * (1.0f - 2.0f * b) * (p * p);
        frequency *= 2.3f;
        amplitude *= 0.4f;
    }
    return sum;
}

static f32x segments(const patches_uniforms *u, f32x x, f32x z)
{
    v3x way = v3x_sub(v3x_of(x, f_set(0.0f), z), v3x_splat(u->eye));
    return u->reach / v3x_length(way);
}

static void hull(const amb_hs_in *in, amb_hs_out *out)
{
    const patches_uniforms *u = in->uniforms;
    patch *p = out->constants;
    i32x row = in->patch >> 9, column = in->patch & (PATCHES_SIDE - 1);
    float side = u->size / (float)PATCHES_SIDE;
    p->x = i_to_f(column) * side - 0.5f * u->size;
    p->z = i_to_f(row) * -side;
    p->side = f_set(side);
    out->edge[0] = segments(u, p->x, p->z - 0.5f * side);
    out->edge[1] = segments(u, p->x + 0.5f * side, p->z);
    out->edge[2] = segments(u, p->x + side, p->z - 0.5f * side);
    out->edge[3] = segments(u, p->x + 0.5f * side, p->z - side);
    out->inside[0] = 0.5f * (out->edge[1] + out->edge[3]);
    out->inside[1] = 0.5f * (out->edge[0] + out->edge[2]);
}

static void domain(const amb_ds_in *in, amb_vs_out *out)
{
    const patches_uniforms *u = in->uniforms;
    const patch *p = in->constants;
    varyings *v = out->varyings;
    f32x x = p->x + in->u * p->side, z = p->z - in->v * p->side;
    hills h = hills_at(x, z);
    v->normal = v3x_of(-h.slope_x * u->height, f_set(1.0f), -h.slope_z * u->height);
    out->clip = m4_project_x(u->world_to_clip, v3x_of(x, h.height * u->height, z));
}

static void fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const patches_uniforms *u = in->uniforms;
    const varyings *v = in->varyings;
    f32x facing = f_max(v3x_dot(v3x_normalize(v->normal), v3x_splat(u->to_sun)), f_set(0.0f));
    out->color[0] = v4x_of(0.1f + 0.9f * facing, 0.12f + 0.8f * facing, 0.15f + 0.6f * facing, f_set(1.0f));
}

const patches_shaders *patches_shaders_get(void)
{
    static const patches_shaders shaders = {
        AMB_LANES, sizeof(varyings) / sizeof(f32x), sizeof(patch) / sizeof(f32x), hull, domain, fragment};
    return &shaders;
}
