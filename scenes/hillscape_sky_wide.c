/* Scene hillscape: the sky with its clouds, painted once a frame for mirrors and seen behind everything; the sphere. */
#include "scenes/hillscape_shade.h"

/* ---- clouds -------------------------------------------------------------------------------------------------------
 */

/* A layer of cumulus at 1100 m: cover 0…1 and light, from a noise of where the ray meets it, which drifts with the
 * wind; lit from how much less of it there is a little way towards the sun. */
typedef struct cloud {
    f32x cover;
    v3x light;
} cloud;

static f32x cloud_density(v2x p, float cover, int octaves)
{
    f32x n = fbm2(noise_gradient2, p, (amb_lattice){.seed = 61}, (amb_fbm){octaves, 2.0f, 0.5f}).value;
    f32x large = noise_gradient2(v2x_scale(p, f_set(0.31f)), (amb_lattice){.seed = 67}).value;
    return f_saturate((n * 0.9f + large * 0.8f + (cover - 0.62f) * 1.5f) * 2.1f);
}

static cloud cloud_at(const hill_frame *f, v3x direction)
{
    const float height = 1100.0f, scale = 1.0f / 900.0f;
    float wind = hill_folded(f->time * 6.0, 1.0e6);
    f32x t = height / f_max(direction.y + 0.035f, f_set(0.03f));
    v2x p = {(direction.x * t + wind) * scale, direction.z * t * scale};
    v3 sun = f->sky.to_sun;
    float reach = 0.16f / amb_s_max(sun.y + 0.25f, 0.25f);
    f32x here = cloud_density(p, f->p.clouds, 6);
    f32x there = cloud_density((v2x){p.x + sun.x * reach, p.y + sun.z * reach}, f->p.clouds, 4);
    f32x lit = f_exp(-1.6f * there) * (0.75f + 0.25f * f_exp(-3.0f * here));
    f32x sunward = f_saturate(v3x_dot(direction, v3x_splat(sun))), silver = sunward * sunward;
    silver = silver * silver;
    silver = silver * silver * f_exp(-4.0f * here) * 1.2f;
    cloud c;
    c.cover = f_smoothstep(f_set(0.02f), f_set(0.65f), here) * f_smoothstep(f_set(0.01f), f_set(0.11f), direction.y);
    v3x sunlight = v3x_splat(f->light[LIGHT_SUN].rgb), sky = v3x_splat(f->sky_light[0]);
    c.light = v3x_add(v3x_scale(sunlight, 0.46f * lit + silver * 0.35f), v3x_scale(sky, 0.85f - 0.30f * here));
    return c;
}

/* Sky and clouds, the sun's disc aside. */
static v3x sky_light(const hill_pass *pass, v3x direction, f32x *cover)
{
    const hill_frame *f = pass->frame;
    *cover = f_set(0.0f);
    v3x sky = v3x_scale(sky_rgb(&f->sky, direction), f_set(f->gain));
    if (f->p.clouds > 0.0f) {
        cloud c = cloud_at(f, direction);
        hill_air air = hill_air_along(pass, direction, f_set(2500.0f));
        *cover = c.cover;
        sky = v3x_lerp(sky, hill_hazed(&air, c.light), c.cover * 0.94f);
    }
    return sky;
}

static void panorama_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    f32x y = 1.0f - in->y * (HILL_PANORAMA_RANGE / (float)pass->height);
    f32x sine, cosine, ring = f_sqrt(f_max(1.0f - y * y, f_set(0.0f)));
    f_sincos((in->x * (0.25f / (float)pass->height) - 0.5f) * (2.0f * AMB_PI), &sine, &cosine);
    f32x cover;
    v3x light = sky_light(pass, (v3x){sine * ring, y, -(cosine * ring)}, &cover);
    out->color[0] = v4x_of3(light, f_set(1.0f));
}

amb_status hill_draw_panorama(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    amb_draw draw = hill_draw_of(pass, "panorama");
    draw.fragment = panorama_fragment;
    return amb_pass_draw(out, &draw, error);
}

static void sky_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const amb_camera *c = &f->camera;
    v3x d = v3x_normalize(
        v3x_add(v3x_splat(c->ray_origin), v3x_add(v3x_scale(v3x_splat(c->ray_dx), in->x * pass->pixels),
                                                  v3x_scale(v3x_splat(c->ray_dy), in->y * pass->pixels))));
    hill_put1(pass, out, HILL_HAZE, f_set(1.0f));
    if (pass->color_off)
        return;
    hill_air air = hill_air_along(pass, d, f_set(9000.0f));
    if (pass->upside_down)
        d.y = -d.y;
    f32x cover;
    v3x light = sky_light(pass, d, &cover);
    v3x disc = v3x_scale(sky_sun_disc(&f->sky, d, 0.99996f), (1.0f - cover) * (f->gain * f->sun_seen));
    light = v3x_add(light, disc);
    f32x low = f_smoothstep(f_set(0.10f), f_set(0.0f), d.y);
    out->color[0] = v4x_of3(v3x_lerp(light, hill_hazed(&air, light), low), f_set(1.0f));
}

amb_status hill_draw_sky(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    amb_draw draw = hill_draw_of(pass, "sky");
    draw.fragment = sky_fragment;
    return amb_pass_draw(out, &draw, error);
}

/* ---- sphere -------------------------------------------------------------------------------------------------------
 */

typedef struct sphere_varyings {
    v3x world, normal;
} sphere_varyings;

static void sphere_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    sphere_varyings *v = out->varyings;
    v->normal = v3x_gather(f->state->sphere->position, in->vertex);
    v->world = v3x_add(v3x_splat(f->sphere_at), v3x_scale(v->normal, f_set(f->p.sphere_radius)));
    out->clip = m4_project_x(pass->world_to_clip, v->world);
}

/* Polished copper-coloured metal: mirrors the sky above and the ground below. */
static void sphere_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const sphere_varyings *v = in->varyings;
    hill_surface s = hill_surface_at(pass, v->world);
    s.normal = s.smooth = v3x_normalize(v->normal);
    s.albedo = v3x_splat((v3){0.10f, 0.035f, 0.02f});
    s.roughness = f_set(0.18f);
    s.f0 = f_set(0.6f);
    hill_light(pass, &s, in->live);
    v3x mirrored = v3x_sub(v3x_scale(s.normal, 2.0f * v3x_dot(s.normal, s.to_eye)), s.to_eye);
    v3x sky = hill_panorama_at(f, mirrored, f_set(2.0f));
    v3x ground = v3x_scale(v3x_splat(f->sky_light[1]), f_set(0.9f));
    v3x seen = v3x_lerp(ground, sky, f_smoothstep(f_set(-0.12f), f_set(0.06f), mirrored.y));
    f32x fresnel = fresnel_schlick(v3x_dot(s.normal, s.to_eye), f_set(0.62f));
    v3x reflection = v3x_mul(v3x_scale(seen, fresnel), v3x_splat((v3){1.0f, 0.72f, 0.55f}));
    v3x lit = v3x_add(v3x_add(v3x_mul(s.albedo, v3x_add(s.diffuse, s.ambient)),
                              v3x_mul(s.specular, v3x_splat((v3){1.0f, 0.72f, 0.55f}))),
                      reflection);
    hill_put3(pass, out, HILL_REFLECTION, reflection);
    hill_write(pass, out, &s, lit, ID_SPHERE);
}

amb_status hill_draw_sphere(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    const hill_frame *f = pass->frame;
    if (!f->p.sphere)
        return AMB_OK;
    const amb_mesh *mesh = f->state->sphere;
    amb_draw draw = hill_draw_of(pass, "sphere");
    draw.vertex = sphere_vertex;
    draw.fragment = pass->depth_only ? NULL : sphere_fragment;
    draw.varying_floats = sizeof(sphere_varyings) / sizeof(f32x);
    draw.indices = mesh->index;
    draw.count = 3 * mesh->triangle_count;
    draw.vertex_count = mesh->vertex_count;
    draw.cull = AMB_CULL_BACK;
    draw.front_clockwise = pass->upside_down;
    draw.wireframe = f->p.wireframe && !pass->depth_only;
    return amb_pass_draw(out, &draw, error);
}
