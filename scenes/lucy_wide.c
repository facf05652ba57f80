/* Scene lucy: a statue in an HDR environment. Light from the environment's irradiance, dimmed where baked ambient
 * occlusion says so and turned towards the open; reflections from the cube map by Fresnel's law, or, where the mirrored
 * ray meets the statue again, from what it meets there. A large key light besides, with traced soft shadows. */
#include "scenes/canvas.h"
#include "scenes/lucy_shade.h"

#include <ambiance/math.h>

/* ---- parameters -------------------------------------------------------------------------------------------------- */

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
static const char *const material_names[] = {"marble", "bronze", "porcelain", "gold", "obsidian", NULL};
static const lucy_material materials[] = {
    {{0.72f, 0.68f, 0.62f}, {0.05f, 0.05f, 0.05f}, {0.42f, 0.31f, 0.22f}, 0.6f, 1.4f},
    {{0.045f, 0.026f, 0.016f}, {0.58f, 0.345f, 0.185f}, {0.085f, 0.21f, 0.17f}, 0.95f, 2.8f},
    {{0.86f, 0.86f, 0.88f}, {0.06f, 0.06f, 0.06f}, {0.70f, 0.70f, 0.75f}, 0.3f, 0.5f},
    {{0.03f, 0.02f, 0.01f}, {1.0f, 0.77f, 0.34f}, {0.10f, 0.05f, 0.02f}, 0.7f, 2.0f},
    {{0.010f, 0.010f, 0.012f}, {0.05f, 0.05f, 0.055f}, {0.01f, 0.01f, 0.01f}, 0.0f, 0.6f},
};
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

/* ---- outputs ----------------------------------------------------------------------------------------------------- */

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

/* ---- a frame ----------------------------------------------------------------------------------------------------- */

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

static amb_status draw_scene(amb_pass *pass, const lucy_uniforms *u, bool floor, uint32_t outputs_off, amb_error *error)
{
    const amb_mesh *mesh = u->state->mesh;
    amb_draw background = {.label = "background",
                           .lanes = AMB_LANES,
                           .fragment = lucy_background_fragment,
                           .uniforms = u,
                           .uniforms_size = sizeof *u,
                           .depth_compare = AMB_ALWAYS,
                           .depth_write_off = true,
                           .targets_off = outputs_off};
    amb_draw statue = {.label = "statue",
                       .lanes = AMB_LANES,
                       .vertex = lucy_statue_vertex,
                       .fragment = lucy_statue_fragment,
                       .uniforms = u,
                       .uniforms_size = sizeof *u,
                       .varying_floats = sizeof(lucy_statue_varyings) / sizeof(f32x),
                       .indices = mesh->index,
                       .count = mesh->triangle_count * 3,
                       .vertex_count = mesh->vertex_count,
                       .cull = AMB_CULL_BACK};
    amb_draw ground = {.label = "floor",
                       .lanes = AMB_LANES,
                       .vertex = lucy_floor_vertex,
                       .fragment = lucy_floor_fragment,
                       .uniforms = u,
                       .uniforms_size = sizeof *u,
                       .varying_floats = sizeof(lucy_floor_varyings) / sizeof(f32x),
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
    double loops = job->time > -1e15 && job->time < 1e15 ? job->time / 60.0 : 0.0;
    loops -= (double)(int64_t)loops;
    float time = (float)((loops < 0.0 ? loops + 1.0 : loops) * 60.0);
    amb_camera camera =
        amb_camera_at(camera_keys, sizeof camera_keys / sizeof *camera_keys, time, 36.0f * (AMB_PI / 180.0f), 0.1f,
                      40.0f, job->width * p->samples, job->height * p->samples);
    lucy_uniforms u = uniforms_of(state, p, &camera);
    amb_canvas canvas;
    amb_status status = canvas_begin(job, lucy_aovs, OUT_COUNT, p->samples, &canvas, error);
    if (status != AMB_OK)
        return status;
    memcpy(u.slot, canvas.slot, sizeof u.slot);
    status = draw_scene(canvas.pass, &u, p->floor != 0, ~1u, error);
    return canvas_finish(job, lucy_aovs, &canvas, status, error);
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
