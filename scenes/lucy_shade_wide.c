/* Shading of scene lucy: irradiance, Fresnel reflection of the cube map and of the statue itself, a soft key light. */
#include "scenes/lucy_shade.h"

#include "shade/specular.h"

#include <ambiance/math.h>
#include <ambiance/random.h>

static const lucy_material floor_material = {
    {0.050f, 0.048f, 0.046f}, {0.045f, 0.045f, 0.045f}, {0.05f, 0.05f, 0.05f}, 0.0f, 2.0f};

typedef struct lucy_surface {
    v3x position, normal, open, albedo;
    f32x visibility;
    const lucy_material *material;
    float id;
} lucy_surface;

static const amb_sampler smooth_cube = {.filter = AMB_TRILINEAR};
static const amb_sampler smooth_map = {.filter = AMB_BILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}};

/* About the y axis, +z towards +x by the angle whose cosine and sine are given. */
static v3x turned(v3x a, v2 by) { return (v3x){by.x * a.x + by.y * a.z, a.y, by.x * a.z - by.y * a.x}; }
static v3x turned_back(v3x a, v2 by) { return turned(a, (v2){by.x, -by.y}); }

static v3x environment_at(const lucy_uniforms *u, v3x direction, float level)
{
    return v4x_xyz(
        amb_sample_cube_lod(u->environment, &smooth_cube, turned_back(direction, u->light_turn), f_set(level)));
}

static v3x irradiance_at(const lucy_uniforms *u, v3x direction)
{
    return v4x_xyz(
        amb_sample_cube_lod(u->irradiance, &smooth_cube, turned_back(direction, u->light_turn), f_set(0.0f)));
}

/* A painted backdrop with a pool of light behind the statue, at eye height; the same below the horizon as above. */
static v3x backdrop_along(const lucy_uniforms *u, v3x direction)
{
    f32x band = f_exp(direction.y * direction.y * -5.0f);
    f32x ahead = f_max(v3x_dot(direction, v3x_splat(u->forward)), f_set(0.0f));
    f32x pool = ahead * ahead;
    pool = pool * pool * pool;
    return v3x_scale(v3x_splat(u->backdrop), 0.12f + 0.88f * band * pool * pool);
}

static v3x background_along(const lucy_uniforms *u, v3x direction)
{
    return u->use_backdrop ? backdrop_along(u, direction) : environment_at(u, direction, u->blur);
}

/* f0 + (1 - f0)(1 - v·n)ᵏ; a blurred reflection rises less towards the silhouette. */
static f32x rise_of(const lucy_uniforms *u, const lucy_material *m, f32x v_dot_n)
{
    float most = 1.0f - amb_s_min(0.12f * amb_s_max(m->blur, 0.0f), 0.6f);
    return most * f_pow(1.0f - f_saturate(v_dot_n), f_set(u->fresnel_power));
}
static v3x reflectance(const lucy_uniforms *u, const lucy_material *m, f32x rise)
{
    v3x f0 = v3x_splat(m->f0), one = v3x_splat((v3){1.0f, 1.0f, 1.0f});
    return v3x_scale(v3x_add(f0, v3x_scale(v3x_sub(one, f0), rise)), f_set(u->reflectivity));
}

/* Dust or patina lies where the surface is hidden. */
static v3x albedo_at(const lucy_material *m, f32x visibility)
{
    f32x hidden = 1.0f - f_smoothstep(f_set(0.15f), f_set(0.75f), visibility);
    return v3x_lerp(v3x_splat(m->albedo), v3x_splat(m->hollow), hidden * m->hollow_share);
}

/* Share of the key light's disc that is open: rays spread over it evenly, turned by a hash of the pixel. */
static f32x key_open(const lucy_uniforms *u, v3x position, v3x normal, u32x pixel, int rays, maskx live)
{
    if (rays == 0 || !m_any(live))
        return f_set(1.0f);
    f32x open = f_set(0.0f), spin = f_unit(u_hash(pixel)) * AMB_TWO_PI, shift = f_unit(u_hash(pixel + 0x9e3779b9u));
    f32x s0 = f_sin(spin), c0 = f_cos(spin);
    amb_rayx ray = {.origin = turned_back(v3x_add(position, v3x_scale(normal, f_set(3e-3f))), u->turn),
                    .t_near = f_set(2e-3f),
                    .t_far = f_set(20.0f)};
    for (int i = 0; i < rays; i++) {
        float angle = 2.39996323f * (float)i;
        f32x radius = f_sqrt(((float)i + shift) * (1.0f / (float)rays));
        f32x a = radius * (c0 * amb_cos(angle) - s0 * amb_sin(angle));
        f32x b = radius * (s0 * amb_cos(angle) + c0 * amb_sin(angle));
        v3x direction = v3x_add(v3x_splat(u->to_key),
                                v3x_add(v3x_scale(v3x_splat(u->key_side), a), v3x_scale(v3x_splat(u->key_up), b)));
        ray.direction = turned_back(direction, u->turn);
        maskx blocked = amb_rays_occluded(u->state->rays, &ray, live);
        open += f_sel(blocked, f_set(0.0f), f_set(1.0f / (float)rays));
    }
    return open;
}

/* Lambert and Cook-Torrance of the key light. */
static v3x key_light(const lucy_uniforms *u, const lucy_surface *s, v3x view, u32x pixel, maskx live)
{
    v3x to_key = v3x_splat(u->to_key);
    f32x facing = v3x_dot(s->normal, to_key);
    maskx lit = live & (facing > 0.0f);
    if (!m_any(lit) || u->key_rgb.x + u->key_rgb.y + u->key_rgb.z <= 0.0f)
        return v3x_splat((v3){0.0f, 0.0f, 0.0f});
    f32x open = key_open(u, s->position, s->normal, pixel, u->key_rays, lit);
    f32x light = f_sel(lit, f_max(facing, f_set(0.0f)) * open, f_set(0.0f));
    float slope = amb_s_min(amb_s_max(0.10f + 0.07f * s->material->blur, 0.06f), 0.5f);
    v3x half = v3x_normalize(v3x_add(view, to_key));
    f32x lobe = specular_cook_torrance(s->normal, to_key, view, slope) * AMB_PI;
    v3x f = reflectance(u, s->material, rise_of(u, s->material, v3x_dot(view, half)));
    if (s->material == &floor_material) /* its glare would be a bright patch that draws the eye */
        lobe = f_set(0.0f);
    v3x sum = v3x_add(s->albedo, v3x_scale(f, lobe));
    return v3x_mul(v3x_scale(sum, light), v3x_splat(u->key_rgb));
}

/* Light that leaves the statue where a mirrored ray meets it, back along the ray: one bounce. */
static v3x radiance_at_hit(const lucy_uniforms *u, const amb_hitx *hit, v3x position, v3x direction, u32x pixel)
{
    const amb_mesh *mesh = u->state->mesh;
    const v4 *point = (const v4 *)(const void *)u->state->point;
    const int32_t *index = (const int32_t *)(const void *)mesh->index;
    i32x first = i_max(hit->primitive, i_set(0)) * 3;
    i32x a = i_gather(index, first), b = i_gather(index, first + 1), c = i_gather(index, first + 2);
    f32x v = hit->u, w = hit->v, s = 1.0f - v - w;
    v3x normal = v3x_add(v3x_add(v3x_scale(v3x_gather(mesh->normal, a), s), v3x_scale(v3x_gather(mesh->normal, b), v)),
                         v3x_scale(v3x_gather(mesh->normal, c), w));
    v4x around = v4x_add(v4x_add(v4x_scale(v4x_gather(point, a), s), v4x_scale(v4x_gather(point, b), v)),
                         v4x_scale(v4x_gather(point, c), w));
    normal = v3x_normalize(turned(normal, u->turn));
    f32x visibility = 1.0f + (around.w - 1.0f) * u->occlusion;
    lucy_surface surface = {.position = v3x_add(position, v3x_scale(direction, hit->t)),
                            .normal = normal,
                            .open = turned(v4x_xyz(around), u->turn),
                            .albedo = albedo_at(&u->material, visibility),
                            .visibility = visibility,
                            .material = &u->material};
    v3x ambient = v3x_mul(v3x_scale(irradiance_at(u, surface.open), visibility), surface.albedo);
    ambient = v3x_add(ambient, key_light(u, &surface, v3x_neg(direction), pixel, hit->hit));
    f32x facing = -v3x_dot(direction, normal);
    v3x mirrored = environment_at(u, v3x_reflect(direction, normal), u->material.blur + 1.0f);
    v3x f = reflectance(u, &u->material, rise_of(u, &u->material, facing));
    return v3x_add(ambient, v3x_scale(v3x_mul(mirrored, f), visibility));
}

/* Radiance from `direction` at a point: the environment, and the statue in front of it. */
static v3x reflected_light(const lucy_uniforms *u, const lucy_surface *s, v3x direction, v3x cube, u32x pixel,
                           maskx live)
{
    if (!u->interreflection) {
        /* Without rays: hidden points see less of the environment (S. Lagarde and C. de Rousiers, 2014). */
        return v3x_scale(cube, f_saturate(s->visibility * s->visibility + s->visibility * 0.5f));
    }
    amb_rayx ray = {.origin = turned_back(v3x_add(s->position, v3x_scale(s->normal, f_set(3e-3f))), u->turn),
                    .direction = turned_back(direction, u->turn),
                    .t_near = f_set(2e-3f),
                    .t_far = f_set(20.0f)};
    amb_hitx hit;
    amb_rays_closest(u->state->rays, &ray, live, &hit);
    if (!m_any(hit.hit))
        return cube;
    return v3x_sel(hit.hit, radiance_at_hit(u, &hit, s->position, direction, pixel), cube);
}

static void put(const lucy_uniforms *u, amb_fs_out *out, int which, v3x value)
{
    if (u->slot[which] > 0)
        out->color[u->slot[which]] = (v4x){value.x, value.y, value.z, f_set(1.0f)};
}

/* Irradiance and Fresnel reflection of one surface; gives the radiance towards the eye and writes the outputs. */
static v3x shade(const lucy_uniforms *u, const amb_fs_in *in, const lucy_surface *s, amb_fs_out *out)
{
    v3x view = v3x_normalize(v3x_sub(v3x_splat(u->eye), s->position));
    f32x v_dot_n = f_max(v3x_dot(view, s->normal), f_set(0.0f));
    v3x direction = v3x_sub(v3x_scale(s->normal, v_dot_n + v_dot_n), view);
    amb_sampler sampler = smooth_cube;
    sampler.lod_min = amb_s_max(s->material->blur, 0.0f);
    v3x cube = v4x_xyz(amb_sample_cube(u->environment, &sampler, turned_back(direction, u->light_turn)));
    if (s->material == &floor_material && u->use_backdrop)
        cube = backdrop_along(u, direction);
    u32x pixel = i_as_u(f_to_i(in->x)) + u_hash(i_as_u(f_to_i(in->y)));
    v3x mirrored = reflected_light(u, s, direction, cube, pixel, in->live);
    v3x key = key_light(u, s, view, pixel, in->live);
    f32x rise = rise_of(u, s->material, v_dot_n);
    v3x f = reflectance(u, s->material, rise);
    v3x ambient = v3x_mul(v3x_scale(irradiance_at(u, s->open), s->visibility), s->albedo);
    ambient = v3x_mul(ambient, v3x_sub(v3x_splat((v3){1.0f, 1.0f, 1.0f}), f));
    put(u, out, OUT_POSITION, s->position);
    put(u, out, OUT_NORMAL, s->normal);
    put(u, out, OUT_ALBEDO, s->albedo);
    put(u, out, OUT_ID, v3x_splat((v3){s->id, s->id, s->id}));
    put(u, out, OUT_AMBIENT, ambient);
    put(u, out, OUT_REFLECTION, mirrored);
    f32x mean = (f.x + f.y + f.z) * (1.0f / 3.0f);
    put(u, out, OUT_FRESNEL, (v3x){mean, mean, mean});
    put(u, out, OUT_KEY, key);
    return v3x_add(v3x_add(ambient, key), v3x_mul(mirrored, f));
}

/* ---- statue ------------------------------------------------------------------------------------------------------ */

void lucy_statue_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    lucy_statue_varyings *v = out->varyings;
    v4x point = v4x_gather((const v4 *)(const void *)u->state->point, in->vertex);
    v->position = turned(v3x_gather(u->state->mesh->position, in->vertex), u->turn);
    v->normal = turned(v3x_gather(u->state->mesh->normal, in->vertex), u->turn);
    v->open = turned(v4x_xyz(point), u->turn);
    v->visibility = 1.0f + (point.w - 1.0f) * u->occlusion;
    out->clip = m4_project_x(u->world_to_clip, v->position);
}

void lucy_statue_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    const lucy_statue_varyings *v = in->varyings;
    v3x normal = v3x_normalize(v->normal);
    lucy_surface surface = {.position = v->position,
                            .normal = normal,
                            .open = v3x_lerp(normal, v->open, f_set(u->occlusion)),
                            .albedo = albedo_at(&u->material, v->visibility),
                            .visibility = v->visibility,
                            .material = &u->material,
                            .id = 1.0f};
    out->color[0] = v4x_of3(shade(u, in, &surface, out), f_set(1.0f));
}

/* ---- floor and background ---------------------------------------------------------------------------------------- */

#define FLOOR_REACH 12.0f

void lucy_floor_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    lucy_floor_varyings *v = out->varyings;
    /* Corners 0 1 2 and 2 1 3 of a square, counter-clockwise seen from above. */
    i32x corner = i_sel(in->vertex == 3, i_set(2), i_sel(in->vertex == 4, i_set(1), i_min(in->vertex, i_set(3))));
    v->x = i_to_f(corner & 1) * (2.0f * FLOOR_REACH) - FLOOR_REACH;
    v->z = FLOOR_REACH - i_to_f(corner >> 1) * (2.0f * FLOOR_REACH);
    out->clip = m4_project_x(u->world_to_clip, (v3x){v->x, f_set(0.0f), v->z});
}

void lucy_floor_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    const lucy_floor_varyings *v = in->varyings;
    v3x position = {v->x, f_set(0.0f), v->z};
    v3x local = turned_back(position, u->turn);
    v2x uv = {local.x * (1.0f / LUCY_FLOOR_SIZE) + 0.5f, local.z * (1.0f / LUCY_FLOOR_SIZE) + 0.5f};
    f32x shade_map = amb_sample_2d_lod(u->state->floor, &smooth_map, uv, f_set(0.0f)).x;
    f32x radius = f_sqrt(v->x * v->x + v->z * v->z);
    f32x edge = f_smoothstep(f_set(0.35f * LUCY_FLOOR_SIZE), f_set(0.5f * LUCY_FLOOR_SIZE), radius);
    f32x visibility = f_lerp(shade_map, f_set(1.0f), edge);
    v3x up = v3x_splat((v3){0.0f, 1.0f, 0.0f});
    lucy_surface surface = {.position = position,
                            .normal = up,
                            .open = up,
                            .albedo = v3x_splat(floor_material.albedo),
                            .visibility = 1.0f + (visibility - 1.0f) * u->occlusion,
                            .material = &floor_material,
                            .id = 2.0f};
    v3x color = shade(u, in, &surface, out);
    /* It fades into the background, which has no floor of its own. */
    f32x gone = f_smoothstep(f_set(u->fade_near), f_set(u->fade_far), radius);
    v3x behind = background_along(u, v3x_normalize(v3x_sub(position, v3x_splat(u->eye))));
    out->color[0] = v4x_of3(v3x_lerp(color, behind, gone), f_set(1.0f));
}

void lucy_background_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    v3x direction = v3x_splat(u->view_origin);
    direction = v3x_add(direction, v3x_scale(v3x_splat(u->view_dx), in->x));
    direction = v3x_add(direction, v3x_scale(v3x_splat(u->view_dy), in->y));
    out->color[0] = v4x_of3(background_along(u, v3x_normalize(direction)), f_set(1.0f));
}
