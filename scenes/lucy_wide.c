/* Scene lucy: a statue in an HDR environment. Light from the environment's irradiance, dimmed where baked ambient
 * occlusion says so and turned towards the open; reflections from the cube map by Fresnel's law, or, where the mirrored
 * ray meets the statue again, from what it meets there. A large key light besides, with traced soft shadows. */
#include "scenes/lucy.h"
#include "scenes/supersample.h"

#include "shade/specular.h"

#include <ambiance/math.h>
#include <ambiance/random.h>
#include <ambiance/raster.h>

/* ---- parameters ---------------------------------------------------------------------------------------------------
 */

typedef struct lucy_params {
    int material, environment;
    v3 tint;
    float reflectivity, fresnel_power, gloss, occlusion;
    int interreflection, floor;
    v3 key_color;
    float key, key_azimuth, key_elevation, key_size;
    int key_rays;
    int background;
    v3 backdrop;
    float turn, light_turn, blur;
    int samples;
} lucy_params;

typedef enum lucy_environment { STUDIO, OUTDOOR } lucy_environment;
typedef struct lucy_material {
    v3 albedo, f0;      /* diffuse albedo; reflectance facing the surface */
    v3 hollow;          /* albedo that gathers where the surface is hidden: dust, patina */
    float hollow_share; /* 0…1, there */
    float blur;         /* cube map level of its reflections */
} lucy_material;

static const char *const material_names[] = {"marble", "bronze", "porcelain", "gold", "obsidian", NULL};
static const lucy_material materials[] = {
    {{0.72f, 0.68f, 0.62f}, {0.05f, 0.05f, 0.05f}, {0.42f, 0.31f, 0.22f}, 0.6f, 1.4f},
    {{0.045f, 0.026f, 0.016f}, {0.58f, 0.345f, 0.185f}, {0.085f, 0.21f, 0.17f}, 0.95f, 2.8f},
    {{0.86f, 0.86f, 0.88f}, {0.06f, 0.06f, 0.06f}, {0.70f, 0.70f, 0.75f}, 0.3f, 0.5f},
    {{0.03f, 0.02f, 0.01f}, {1.0f, 0.77f, 0.34f}, {0.10f, 0.05f, 0.02f}, 0.7f, 2.0f},
    {{0.010f, 0.010f, 0.012f}, {0.05f, 0.05f, 0.055f}, {0.01f, 0.01f, 0.01f}, 0.0f, 0.6f},
};
static const lucy_material floor_material = {
    {0.050f, 0.048f, 0.046f}, {0.045f, 0.045f, 0.045f}, {0.05f, 0.05f, 0.05f}, 0.0f, 2.0f};
static const char *const environment_names[] = {"studio", "outdoor", NULL};
typedef enum lucy_background { BACKDROP, ENVIRONMENT } lucy_background;
static const char *const background_names[] = {"backdrop", "environment", NULL};

#define FIELD(name) offsetof(lucy_params, name)
static const amb_param lucy_param_table[] = {
    {"material", AMB_PARAM_CHOICE, "", 0, 0, {0}, material_names, FIELD(material), "what the statue is made of"},
    {"environment", AMB_PARAM_CHOICE, "", 0, 0, {STUDIO}, environment_names, FIELD(environment), "where it stands"},
    {"tint", AMB_PARAM_COLOR, "", 0, 4, {1, 1, 1}, NULL, FIELD(tint), "factor on the material's diffuse albedo"},
    {"reflectivity", AMB_PARAM_FLOAT, "", 0, 1, {1}, NULL, FIELD(reflectivity), "factor on the reflection"},
    {"fresnel_power",
     AMB_PARAM_FLOAT,
     "",
     0.5f,
     10,
     {5},
     NULL,
     FIELD(fresnel_power),
     "exponent k of f0 + (1 - f0)(1 - v.n)^k"},
    {"gloss", AMB_PARAM_FLOAT, "levels", -4, 6, {0}, NULL, FIELD(gloss), "added to the reflection's cube map level"},
    {"occlusion", AMB_PARAM_FLOAT, "", 0, 1, {1}, NULL, FIELD(occlusion), "strength of the baked ambient occlusion"},
    {"interreflection",
     AMB_PARAM_BOOL,
     "",
     0,
     0,
     {1},
     NULL,
     FIELD(interreflection),
     "trace reflected rays, so that the statue and the floor show the statue"},
    {"floor", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, FIELD(floor), "a polished floor around the plinth"},
    {"key", AMB_PARAM_FLOAT, "", 0, 100, {0.9f}, NULL, FIELD(key), "strength of the key light; 0: none"},
    {"key_color", AMB_PARAM_COLOR, "", 0, 4, {1.0f, 0.90f, 0.76f}, NULL, FIELD(key_color), "colour of the key light"},
    {"key_azimuth",
     AMB_PARAM_FLOAT,
     "degrees",
     -360,
     360,
     {62},
     NULL,
     FIELD(key_azimuth),
     "where it stands: 0 in front (+z), 90 at +x"},
    {"key_elevation", AMB_PARAM_FLOAT, "degrees", -90, 90, {40}, NULL, FIELD(key_elevation), "its height"},
    {"key_size", AMB_PARAM_FLOAT, "degrees", 0, 45, {7}, NULL, FIELD(key_size), "its radius: the softness of shadows"},
    {"key_rays", AMB_PARAM_INT, "", 0, 64, {4}, NULL, FIELD(key_rays), "shadow rays a sample; 0: no shadows"},
    {"background", AMB_PARAM_CHOICE, "", 0, 0, {BACKDROP}, background_names, FIELD(background), "behind the statue"},
    {"backdrop", AMB_PARAM_COLOR, "", 0, 4, {0.10f, 0.108f, 0.125f}, NULL, FIELD(backdrop), "colour of the backdrop"},
    {"turn", AMB_PARAM_FLOAT, "degrees", -360, 360, {0}, NULL, FIELD(turn), "turn of the statue about the vertical"},
    {"light_turn", AMB_PARAM_FLOAT, "degrees", -360, 360, {-70}, NULL, FIELD(light_turn), "turn of the environment"},
    {"blur", AMB_PARAM_FLOAT, "levels", 0, 8, {3.5f}, NULL, FIELD(blur), "cube map level of the background"},
    {"samples", AMB_PARAM_INT, "", 1, 4, {2}, NULL, FIELD(samples), "samples along a pixel's side"},
};
#undef FIELD

/* ---- outputs ------------------------------------------------------------------------------------------------------
 */

enum {
    OUT_POSITION,
    OUT_NORMAL,
    OUT_ALBEDO,
    OUT_ID,
    OUT_AMBIENT,
    OUT_REFLECTION,
    OUT_FRESNEL,
    OUT_KEY,
    OUT_DEPTH,
    OUT_COUNT
};
static const amb_aov lucy_aovs[OUT_COUNT] = {
    {"position", 3, "world position"},
    {"normal", 3, "world normal, unit"},
    {"albedo", 3, "diffuse albedo, linear"},
    {"id", 1, "1 the statue, 2 the floor, 0 background"},
    {"ambient", 3, "light from irradiance and albedo"},
    {"reflection", 3, "reflected radiance, before Fresnel's factor"},
    {"fresnel", 1, "reflectance"},
    {"key", 3, "light of the key light, diffuse and specular"},
    {"depth", 1, "0 near plane ... 1 far plane"},
};
static bool mixes(int out) { return out >= OUT_ALBEDO && out != OUT_ID && out != OUT_DEPTH; }

/* ---- shared shading -----------------------------------------------------------------------------------------------
 */

typedef struct lucy_uniforms {
    const lucy_state *state;
    const amb_texture *environment, *irradiance;
    m4 world_to_clip;
    v3 eye, view_origin, view_dx, view_dy; /* primary rays of window coordinates */
    v2 turn, light_turn;                   /* cosine and sine */
    lucy_material material;
    float reflectivity, fresnel_power, blur, occlusion, fade_near, fade_far;
    v3 key_rgb, to_key, key_side, key_up; /* diffuse radiance of white facing it; direction, and axes of its disc */
    int key_rays;
    v3 backdrop, forward; /* forward: the middle of the view */
    bool interreflection, use_backdrop;
    int slot[OUT_COUNT]; /* attachment of each output, or 0 */
} lucy_uniforms;

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

/* ---- statue -------------------------------------------------------------------------------------------------------
 */

typedef struct statue_varyings {
    v3x position, normal, open;
    f32x visibility;
} statue_varyings;

static void statue_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    statue_varyings *v = out->varyings;
    v4x point = v4x_gather((const v4 *)(const void *)u->state->point, in->vertex);
    v->position = turned(v3x_gather(u->state->mesh->position, in->vertex), u->turn);
    v->normal = turned(v3x_gather(u->state->mesh->normal, in->vertex), u->turn);
    v->open = turned(v4x_xyz(point), u->turn);
    v->visibility = 1.0f + (point.w - 1.0f) * u->occlusion;
    out->clip = m4_project_x(u->world_to_clip, v->position);
}

static void statue_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    const statue_varyings *v = in->varyings;
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

/* ---- floor and background -----------------------------------------------------------------------------------------
 */

typedef struct floor_varyings {
    f32x x, z;
} floor_varyings;

#define FLOOR_REACH 12.0f

static void floor_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    floor_varyings *v = out->varyings;
    /* Corners 0 1 2 and 2 1 3 of a square, counter-clockwise seen from above. */
    i32x corner = i_sel(in->vertex == 3, i_set(2), i_sel(in->vertex == 4, i_set(1), i_min(in->vertex, i_set(3))));
    v->x = i_to_f(corner & 1) * (2.0f * FLOOR_REACH) - FLOOR_REACH;
    v->z = FLOOR_REACH - i_to_f(corner >> 1) * (2.0f * FLOOR_REACH);
    out->clip = m4_project_x(u->world_to_clip, (v3x){v->x, f_set(0.0f), v->z});
}

static void floor_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    const floor_varyings *v = in->varyings;
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

static void background_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lucy_uniforms *u = in->uniforms;
    v3x direction = v3x_splat(u->view_origin);
    direction = v3x_add(direction, v3x_scale(v3x_splat(u->view_dx), in->x));
    direction = v3x_add(direction, v3x_scale(v3x_splat(u->view_dy), in->y));
    out->color[0] = v4x_of3(background_along(u, v3x_normalize(direction)), f_set(1.0f));
}

/* ---- a frame ------------------------------------------------------------------------------------------------------
 */

static const amb_camera_key camera_keys[] = {
    {0.0f, {-1.143f, 1.20f, 3.519f}, {0.00f, 1.00f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {8.0f, {1.330f, 0.90f, 3.292f}, {0.00f, 1.00f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {16.0f, {3.060f, 1.30f, 1.236f}, {0.02f, 1.03f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {24.0f, {2.883f, 1.80f, -1.802f}, {0.00f, 1.02f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {32.0f, {0.000f, 1.35f, -3.600f}, {0.00f, 1.00f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {40.0f, {-2.855f, 0.80f, -1.331f}, {0.00f, 1.03f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {48.0f, {-1.685f, 1.62f, 1.414f}, {-0.03f, 1.40f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {54.0f, {-0.484f, 1.60f, 1.941f}, {-0.04f, 1.50f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    {60.0f, {-1.143f, 1.20f, 3.519f}, {0.00f, 1.00f, 0.0f}, {0.0f, 1.0f, 0.0f}},
};

static v2 cosine_sine(float degrees)
{
    float radians = degrees * (AMB_PI / 180.0f);
    return (v2){amb_cos(radians), amb_sin(radians)};
}

static lucy_uniforms uniforms_of(const lucy_state *state, const lucy_params *p, const amb_camera *camera)
{
    lucy_uniforms u = {.state = state,
                       .environment = state->environment[p->environment],
                       .irradiance = state->irradiance[p->environment],
                       .world_to_clip = camera->world_to_clip,
                       .eye = camera->position,
                       .view_origin = camera->ray_origin,
                       .view_dx = camera->ray_dx,
                       .view_dy = camera->ray_dy,
                       .turn = cosine_sine(p->turn),
                       .light_turn = cosine_sine(p->light_turn),
                       .material = materials[p->material],
                       .reflectivity = p->reflectivity,
                       .fresnel_power = p->fresnel_power,
                       .blur = p->blur,
                       .occlusion = p->occlusion,
                       .fade_near = 1.5f,
                       .fade_far = 6.0f,
                       .interreflection = p->interreflection};
    v2 azimuth = cosine_sine(p->key_azimuth), elevation = cosine_sine(p->key_elevation);
    u.to_key = (v3){elevation.x * azimuth.y, elevation.y, elevation.x * azimuth.x};
    float size = amb_tan(p->key_size * (AMB_PI / 180.0f));
    u.key_side = v3_scale((v3){azimuth.x, 0.0f, -azimuth.y}, size);
    u.key_up = v3_scale(v3_cross(u.to_key, (v3){azimuth.x, 0.0f, -azimuth.y}), size);
    u.key_rgb = v3_scale(p->key_color, p->key);
    u.key_rays = p->key_rays;
    u.backdrop = p->backdrop;
    u.use_backdrop = p->background == BACKDROP;
    u.forward = v3_normalize(v3_sub(camera->target, camera->position));
    u.material.albedo = v3_mul(u.material.albedo, p->tint);
    u.material.blur += p->gloss;
    return u;
}

/* Images of one frame before it is resolved: the colour, the wanted outputs, and depth. */
typedef struct lucy_images {
    amb_image *depth, *image[OUT_COUNT]; /* image[0]: colour; the others by attachment */
    int out[OUT_COUNT], count;           /* which output each attachment holds */
} lucy_images;

static amb_status create_images(const amb_scene_job *job, int factor, lucy_images *images, lucy_uniforms *u,
                                amb_error *error)
{
    int width = job->width * factor, height = job->height * factor;
    amb_status status = amb_image_create(width, height, 1, &images->depth, error);
    if (status == AMB_OK)
        status = amb_image_create(width, height, 4, &images->image[0], error);
    images->count = 1;
    for (int i = 0; i < OUT_DEPTH && status == AMB_OK; i++) {
        if (amb_frame_layer(job->frame, lucy_aovs[i].name) == NULL)
            continue;
        u->slot[i] = images->count;
        images->out[images->count] = i;
        status = amb_image_create(width, height, lucy_aovs[i].channels, &images->image[images->count++], error);
    }
    return status;
}

static void resolve_images(const amb_scene_job *job, int factor, const lucy_images *images)
{
    amb_supersample_resolve(job->context, images->image[0], amb_frame_layer(job->frame, "color"), factor, true);
    for (int i = 1; i < images->count; i++) {
        int out = images->out[i];
        amb_supersample_resolve(job->context, images->image[i], amb_frame_layer(job->frame, lucy_aovs[out].name),
                                factor, mixes(out));
    }
    amb_image *depth = amb_frame_layer(job->frame, "depth");
    if (depth != NULL)
        amb_supersample_resolve(job->context, images->depth, depth, factor, false);
}

static amb_status draw_scene(amb_pass *pass, const lucy_uniforms *u, bool floor, uint32_t outputs_off, amb_error *error)
{
    const amb_mesh *mesh = u->state->mesh;
    amb_draw background = {.label = "background",
                           .lanes = AMB_LANES,
                           .fragment = background_fragment,
                           .uniforms = u,
                           .uniforms_size = sizeof *u,
                           .depth_compare = AMB_ALWAYS,
                           .depth_write_off = true,
                           .targets_off = outputs_off};
    amb_draw statue = {.label = "statue",
                       .lanes = AMB_LANES,
                       .vertex = statue_vertex,
                       .fragment = statue_fragment,
                       .uniforms = u,
                       .uniforms_size = sizeof *u,
                       .varying_floats = sizeof(statue_varyings) / sizeof(f32x),
                       .indices = mesh->index,
                       .count = mesh->triangle_count * 3,
                       .vertex_count = mesh->vertex_count,
                       .cull = AMB_CULL_BACK};
    amb_draw ground = {.label = "floor",
                       .lanes = AMB_LANES,
                       .vertex = floor_vertex,
                       .fragment = floor_fragment,
                       .uniforms = u,
                       .uniforms_size = sizeof *u,
                       .varying_floats = sizeof(floor_varyings) / sizeof(f32x),
                       .count = 6,
                       .cull = AMB_CULL_BACK};
    amb_status status = amb_pass_draw(pass, &background, error);
    if (status == AMB_OK)
        status = amb_pass_draw(pass, &statue, error);
    if (status == AMB_OK && floor)
        status = amb_pass_draw(pass, &ground, error);
    return status;
}

static amb_status lucy_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    const lucy_params *p = job->params;
    double loops = job->time / 60.0;
    float time = (float)((loops - (double)(long long)loops + (loops < 0.0 ? 1.0 : 0.0)) * 60.0);
    amb_camera camera =
        amb_camera_at(camera_keys, sizeof camera_keys / sizeof *camera_keys, time, 36.0f * (AMB_PI / 180.0f), 0.1f,
                      40.0f, job->width * p->samples, job->height * p->samples);
    lucy_uniforms u = uniforms_of(state, p, &camera);
    lucy_images images = {.count = 0};
    amb_pass *pass = NULL;
    amb_status status = create_images(job, p->samples, &images, &u, error);
    if (status == AMB_OK) {
        amb_target target = {.depth = images.depth, .clear_depth = 1.0f};
        for (int i = 0; i < images.count; i++)
            target.color[i] = images.image[i];
        status = amb_pass_begin(job->context, &target, &pass, error);
    }
    if (status == AMB_OK)
        status = draw_scene(pass, &u, p->floor != 0, ~1u, error);
    if (status == AMB_OK)
        status = amb_pass_finish(&pass, NULL, error);
    if (status == AMB_OK)
        resolve_images(job, p->samples, &images);
    amb_pass_close(&pass);
    amb_image_close(&images.depth);
    for (int i = 0; i < images.count; i++)
        amb_image_close(&images.image[i]);
    return status;
}

const amb_scene WIDE(amb_scene_lucy) = {
    .name = "lucy",
    .about = "a winged statue, Fresnel reflection and irradiance of an HDR environment",
    .seconds = 60.0f,
    .params = {lucy_param_table, sizeof lucy_param_table / sizeof *lucy_param_table, sizeof(lucy_params)},
    .aovs = lucy_aovs,
    .aov_count = OUT_COUNT,
    .post = "bloom:threshold=1.2,intensity=0.15;display:curve=aces,dither=gradient",
    .load = lucy_load,
    .frame = lucy_frame,
    .unload = lucy_unload,
};
