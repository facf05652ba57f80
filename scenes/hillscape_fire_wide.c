/* Scene hillscape: the camp fire under the point light: flames, sparks and smoke as billboards of the geometry stage.
 */
#include "scenes/hillscape_fire.h"
#include "scenes/hillscape_shade.h"

typedef struct fire_root {
    v3x middle;
    f32x size, age, kind, seed;
} fire_root;

typedef struct fire_varyings {
    v3x world;
    v2x place; /* -1 … 1 over the quad */
    f32x age, kind, seed;
} fire_varyings;

static void fire_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    fire_root *r = out->varyings;
    const float *p = &f->particle[0].offset.x;
    i32x at = in->vertex * (int32_t)(sizeof(fire_particle) / sizeof(float));
    v3 foot = f->light[LIGHT_POINT].position;
    foot.y -= f->p.point_position.y;
    r->middle = (v3x){f_gather(p, at) + foot.x, f_gather(p + 1, at) + foot.y, f_gather(p + 2, at) + foot.z};
    r->size = f_gather(p + 3, at);
    r->age = f_gather(p + 4, at);
    r->kind = f_gather(p + 5, at);
    r->seed = f_gather(p + 6, at);
    out->clip = m4_project_x(pass->world_to_clip, r->middle);
}

static void fire_geometry(const amb_gs_in *in, amb_gs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const fire_root r = *(const fire_root *)in->varyings[0];
    v3x ahead = v3x_normalize(v3x_sub(v3x_splat(pass->frame->camera.position), r.middle));
    v3x right = v3x_normalize(v3x_cross(v3x_splat((v3){0, 1, 0}), ahead)), up = v3x_cross(ahead, right);
    f32x tall = r.size * f_sel(r.kind == 0.0f, f_set(1.6f), f_set(1.0f));
    fire_varyings *v = out->varyings;
    for (int i = 0; i < 4; i++) {
        float x = i & 1 ? 1.0f : -1.0f, y = i & 2 ? 1.0f : -1.0f;
        v->world = v3x_add(r.middle, v3x_add(v3x_scale(right, r.size * x), v3x_scale(up, tall * y)));
        v->place = (v2x){f_set(x), f_set(y)};
        v->age = r.age;
        v->kind = r.kind;
        v->seed = r.seed;
        out->clip = m4_project_x(pass->world_to_clip, v->world);
        amb_emit(out, in->live);
    }
}

static void fire_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const fire_varyings *v = in->varyings;
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_REPEAT, AMB_REPEAT}};
    f32x inside = f_saturate(1.0f - v2x_dot(v->place, v->place));
    v2x uv = {v->place.x * 0.07f + v->seed, v->place.y * 0.07f + v->seed * 7.0f - v->age * 0.2f};
    f32x noise = amb_sample_2d_lod(f->state->noise, &sampler, uv, f_set(0.0f)).x;
    f32x born = f_smoothstep(f_set(0.0f), f_set(0.12f), v->age), gone = 1.0f - v->age;
    v3 glow = v3_scale(f->light[LIGHT_POINT].rgb, f->light_on[LIGHT_POINT] ? 1.0f : 0.0f);
    f32x flame = f_saturate(inside * 1.6f + (noise - 0.62f) * 1.6f) * inside * gone * born;
    v3x hot = {f_set(glow.x * 0.13f), glow.y * (0.11f - 0.07f * v->age), glow.z * (0.09f - 0.08f * v->age)};
    v3x spark = v3x_scale(v3x_splat(glow), inside * inside * gone * 0.7f);
    f32x thick = inside * inside * f_saturate(noise * 1.5f - 0.2f) * born * gone * gone * 0.20f;
    v3x lit = v3x_add(v3x_scale(v3x_splat(f->sky_light[0]), f_set(0.5f)),
                      v3x_scale(v3x_splat(f->light[LIGHT_SUN].rgb), f_set(f->light_on[LIGHT_SUN] ? 0.22f : 0.0f)));
    v3x smoke = v3x_scale(v3x_mul(lit, v3x_splat((v3){0.62f, 0.60f, 0.58f})), thick);
    maskx is_flame = v->kind<0.5f, is_smoke = v->kind> 1.5f;
    v3x light = v3x_sel(is_flame, v3x_scale(hot, flame), v3x_sel(is_smoke, smoke, spark));
    out->color[0] = v4x_of3(light, f_sel(is_smoke, thick, f_sel(is_flame, flame * 0.3f, f_set(0.0f))));
}

amb_status hill_draw_fire(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    const hill_frame *f = pass->frame;
    if (!f->p.particles)
        return AMB_OK;
    amb_draw draw = hill_draw_of(pass, "fire");
    draw.topology = AMB_POINTS;
    draw.vertex = fire_vertex;
    draw.geometry = (amb_geometry){.shader = fire_geometry,
                                   .output = AMB_TRIANGLES,
                                   .vertices = 4,
                                   .input_floats = sizeof(fire_root) / sizeof(f32x)};
    draw.fragment = fire_fragment;
    draw.varying_floats = sizeof(fire_varyings) / sizeof(f32x);
    draw.count = FIRE_PARTICLES;
    draw.depth_write_off = true;
    draw.wireframe = f->p.wireframe;
    draw.blend[0] = AMB_BLEND_EQUATION; /* flames add, smoke also covers */
    draw.equation[0] = (amb_blend_equation){AMB_FACTOR_ONE, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA,
                                            AMB_FACTOR_ONE, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA,
                                            AMB_BLEND_SUM,  AMB_BLEND_SUM};
    return amb_pass_draw(out, &draw, error);
}
