/* Scene elevated: an endless flight over procedural mountains (Ambiance report, "Elevated"; after the 4k demo of that
 * name by Rgba and TBC, 2009). */
#include "scenes/elevated_shade.h"

#include <stdlib.h>

/* ---- parameters ---------------------------------------------------------------------------------------------------
 */

static const char *const normal_names[] = {"analytic", "central", NULL};
static const char *const shadow_names[] = {"march", "estimate", "off", NULL};

/* clang-format off */
#define ROW(NAME, TYPE, UNIT, LOW, HIGH, DOC, ...) \
    {#NAME, AMB_PARAM_##TYPE, UNIT, LOW, HIGH, {__VA_ARGS__}, NULL, offsetof(elevated_params, NAME), DOC}
#define CHOICE(NAME, CHOICES, DOC, ...) \
    {#NAME, AMB_PARAM_CHOICE, "", 0, 0, {__VA_ARGS__}, CHOICES, offsetof(elevated_params, NAME), DOC}
#define EDGE(NAME, FIELD, DOC, ...) \
    {#NAME, AMB_PARAM_FLOAT, "", -10, 10, {__VA_ARGS__}, NULL, offsetof(elevated_params, snow.FIELD), DOC}
static const amb_param elevated_table[] = {
    ROW(sun_azimuth, FLOAT, "degrees", -360, 360, "where the sun is: 0 along +z (behind), 90 along +x (right)", 100),
    ROW(sun_elevation, FLOAT, "degrees", -90, 90, "its height; dawn is below 8", 18),
    ROW(turbidity, FLOAT, "", 1.7f, 10, "haze of the sky: 2 mountain air, 4 a clear day, 8 thick", 2.3f),
    ROW(sun_size, FLOAT, "degrees", 0.05f, 10, "radius of the sun's disc", 0.5f),
    ROW(exposure, FLOAT, "per kcd/m2", 0, 10, "factor from the luminance to the picture's, where level snow has 12 kcd/m2", 0.055f),
    ROW(adaptation, FLOAT, "", 0, 1, "of the exposure: 0 fixed, 1 level snow is equally bright under any sun", 0.35f),
    ROW(balance, FLOAT, "", 0, 1, "white balance: 0 daylight (D65), 1 what level snow reflects is neutral", 0.35f),
    ROW(fog_density, FLOAT, "per cell", 0, 100, "a of the haze a e^(-b y)", 0.13f),
    ROW(fog_falloff, FLOAT, "per cell", 0, 100, "b", 3.0f),
    ROW(fog_color, COLOR, "", 0, 10, "how strongly it dims red, green, blue", 0.6f, 0.95f, 1.5f),
    ROW(height, FLOAT, "cells", 0.01f, 4, "factor on the height function", 0.42f),
    ROW(erosion, FLOAT, "", 0, 10, "factor on the squared slope that flattens finer octaves; 0: plain fBm", 1),
    ROW(turned, BOOL, "", 0, 0, "turn each octave by 36.87 degrees; off: f(2^i p) as the report writes it", 1),
    ROW(seed, INT, "", 0, 1000000, "another world", 7),
    ROW(geometry_octaves, INT, "", 1, TERRAIN_OCTAVES, "most octaves of the geometry", 9),
    ROW(octaves, INT, "", 1, TERRAIN_OCTAVES, "most octaves of the normal; a pixel's footprint allows", 13),
    ROW(triangle, FLOAT, "samples", 1, 100, "what a triangle's edge aims to span on the screen", 6),
    ROW(detail, FLOAT, "samples", 0.25f, 64, "least width of the finest octave's cells on the screen", 1.5f),
    CHOICE(normals, normal_names, "by quotient and chain rule, or by central differences", NORMALS_ANALYTIC),
    ROW(normal_step, FLOAT, "samples", 0.01f, 100, "step of the central differences", 0.5f),
    CHOICE(shadows, shadow_names, "rays marched over the height function; the report's estimate; none", SHADOWS_MARCH),
    ROW(shadow_octaves, INT, "", 1, TERRAIN_OCTAVES, "octaves that cast shadows, or that the estimate takes", 8),
    ROW(shadow_steps, INT, "", 1, 512, "most steps of a shadow ray", 96),
    ROW(shadow_reach, FLOAT, "cells", 0.01f, 100, "how far shadows fall", 6),
    ROW(shadow_size, FLOAT, "degrees", 0.01f, 20, "apparent radius of the sun: softness of the shadows", 0.5f),
    ROW(occlusion_power, FLOAT, "", 0.01f, 20, "k of the ambient occlusion n_y^k + a", 1.6f),
    ROW(occlusion_floor, FLOAT, "", 0, 2, "a", 0.18f),
    ROW(ambient, FLOAT, "", 0, 10, "factor on the sky's light", 0.55f),
    ROW(ambient_noise, FLOAT, "", 0, 2, "noise in it", 0.18f),
    ROW(back, FLOAT, "", 0, 10, "strength of the light from against the sun", 0.12f),
    ROW(back_color, COLOR, "", 0, 10, "its colour", 0.35f, 0.55f, 1.0f),
    EDGE(snow_a, a, "snow: smoothstep(A - B n_y, C - D n_y, (noise + height) E)", 1.55f),
    EDGE(snow_b, b, "B", 1.75f),
    EDGE(snow_c, c, "C", 1.85f),
    EDGE(snow_d, d, "D", 1.8f),
    EDGE(snow_e, e, "E", 0.55f),
    ROW(snow_height, FLOAT, "", -10, 10, "what height adds to the noise, for height 1 of the height function", 1.8f),
    ROW(snow_scale, FLOAT, "per cell", 0.1f, 1000, "coarsest frequency of that noise", 6),
    ROW(snow_color, COLOR, "", 0, 1, "albedo of snow", 0.86f, 0.90f, 0.95f),
    ROW(land_color, COLOR, "", 0, 1, "albedo of rock", 0.145f, 0.135f, 0.128f),
    ROW(strata_color, COLOR, "", 0, 1, "albedo of its other layers", 0.23f, 0.2f, 0.172f),
    ROW(valley_color, COLOR, "", 0, 1, "albedo of flat, low land", 0.115f, 0.125f, 0.06f),
    ROW(texture, FLOAT, "", 0, 2, "strength of the textures ground/rock and ground/snow", 0.8f),
    ROW(tiles, INT, "", 1, 256, "of texture along a cell", 12),
    ROW(roughness, FLOAT, "cells", 0, 1, "relief of bare rock from the snow's noise", 0.005f),
    ROW(crags, FLOAT, "cells", 0, 1, "relief of cliffs", 0.013f),
    ROW(speed, FLOAT, "cells/s", -10, 10, "of the flight", 0.1f),
    ROW(clearance, FLOAT, "cells", 0.02f, 4, "height over the smoothed ground", 0.09f),
    ROW(sight, FLOAT, "cells", 2, 120, "how far ground is drawn", 48),
    ROW(fov, FLOAT, "degrees", 5, 120, "vertical field of view", 42),
    ROW(wireframe, BOOL, "", 0, 0, "draw the triangles' edges", 0),
    ROW(samples, INT, "", 1, CANVAS_MAX_FACTOR, "samples along a pixel's side", 2),
};
/* clang-format on */

static const amb_aov elevated_aovs[OUT_COUNT] = {
    {"position", 3, "world position, cells, relative to the lattice point under the eye"},
    {"normal", 3, "world normal, unit, all octaves"},
    {"albedo", 3, "linear albedo"},
    {"id", 1, "1 ground, 0 sky"},
    {"depth", 1, "0 near plane ... 1 far plane"},
    {"ao", 1, "ambient occlusion n_y^k + a"},
    {"shadow", 1, "1 in the sun, 0 in shadow"},
    {"snow", 1, "share of snow"},
    {"fog", 1, "what the haze hides"},
    {"height", 1, "height, cells"},
    {"light", 3, "light on the ground before its albedo"},
};

/* ---- a frame ------------------------------------------------------------------------------------------------------
 */

static void elevated_unload(void *state) { free(state); }

static amb_status load_tile(amb_assets *assets, const char *name, elevated_texture *tile, amb_error *error)
{
    amb_status status = amb_assets_texture(assets, name, &tile->map, error);
    if (status)
        return status;
    static const amb_sampler sampler = {.filter = AMB_TRILINEAR};
    v3 mean = v4_xyz(v4x_lane(amb_sample_2d_lod(tile->map, &sampler, v2x_splat((v2){0.5f, 0.5f}), f_set(99.0f)), 0));
    tile->per_mean =
        (v3){1.0f / amb_s_max(mean.x, 0.01f), 1.0f / amb_s_max(mean.y, 0.01f), 1.0f / amb_s_max(mean.z, 0.01f)};
    return AMB_OK;
}

static amb_status elevated_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    elevated_state *state = calloc(1, sizeof *state);
    (void)context;
    *out = NULL;
    if (!state)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene elevated");
    amb_status status = load_tile(assets, "ground/rock", &state->rock, error);
    if (status == AMB_OK)
        status = load_tile(assets, "ground/snow", &state->snow, error);
    if (status != AMB_OK) {
        free(state);
        return status;
    }
    amb_noise_texture_make(&state->noise, 1);
    *out = state;
    return AMB_OK;
}

static v3 direction_of(float azimuth, float elevation)
{
    float a = azimuth * (AMB_PI / 180.0f), e = elevation * (AMB_PI / 180.0f);
    return (v3){amb_cos(e) * amb_sin(a), amb_sin(e), amb_cos(e) * amb_cos(a)};
}

/* Exposure and white balance: both follow the light on level snow. */
static v3 exposure_of(const elevated_params *p, const amb_sky *sky)
{
    v3 level = v3_add(sky->ambient_rgb, v3_scale(sky->sun_rgb, amb_s_max(sky->to_sun.y, 0.0f)));
    float grey = amb_s_max(v3_dot(level, (v3){0.2126f, 0.7152f, 0.0722f}), 1.0e-6f);
    float gain = p->exposure * amb_pow(12.0f / grey, p->adaptation);
    v3 share = {grey / amb_s_max(level.x, 1.0e-6f), grey / amb_s_max(level.y, 1.0e-6f),
                grey / amb_s_max(level.z, 1.0e-6f)};
    return (v3){gain * amb_pow(share.x, p->balance), gain * amb_pow(share.y, p->balance),
                gain * amb_pow(share.z, p->balance)};
}

static elevated_uniforms uniforms_of(const elevated_state *state, const elevated_params *p, const amb_canvas *canvas,
                                     const elevated_place *place, const amb_camera *camera)
{
    elevated_uniforms u = {.world_to_clip = camera->world_to_clip,
                           .eye = camera->position,
                           .ray_origin = camera->ray_origin,
                           .ray_dx = camera->ray_dx,
                           .ray_dy = camera->ray_dy,
                           .pixels = 0.5f * (float)canvas->height / amb_tan(0.5f * camera->vertical_fov),
                           .params = p,
                           .rock = state->rock,
                           .snow = state->snow,
                           .ceiling = 1.3f * p->height};
    u.rock.tiles = u.snow.tiles = (float)p->tiles;
    amb_terrain_place(&u.ground, &state->noise, (uint32_t)p->seed, p->erosion, p->turned != 0, place->x, place->z);
    amb_terrain_place(&u.speckle, &state->noise, (uint32_t)p->seed + 99u, 0.0f, p->turned != 0, place->x, place->z);
    u.sky = amb_sky_make(direction_of(p->sun_azimuth, p->sun_elevation), p->turbidity);
    u.gain = exposure_of(p, &u.sky);
    u.sun_rgb = v3_mul(u.sky.sun_rgb, u.gain);
    u.haze_rgb = v3_mul(u.sky.ambient_rgb, u.gain);
    u.ambient_rgb = v3_mul(u.sky.ambient_rgb, v3_scale(u.gain, p->ambient));
    u.back_rgb = v3_scale(p->back_color, p->back * v3_dot(u.ambient_rgb, (v3){0.2126f, 0.7152f, 0.0722f}));
    u.to_back = v3_normalize((v3){-u.sky.to_sun.x, 0.35f, -u.sky.to_sun.z});
    u.sun_cosine = amb_cos(p->sun_size * (AMB_PI / 180.0f));
    for (int i = 0; i < OUT_COUNT; i++)
        u.slot[i] = canvas->slot[i];
    return u;
}

static amb_status elevated_draw(const elevated_state *state, const amb_scene_job *job, const amb_canvas *canvas,
                                uint32_t **index, amb_error *error)
{
    const elevated_params *p = job->params;
    elevated_place place = elevated_place_at(&state->noise, p, job->time);
    amb_camera camera = amb_camera_look(place.eye, place.target, place.up, p->fov * (AMB_PI / 180.0f), 0.01f,
                                        1.5f * p->sight, canvas->width, canvas->height);
    elevated_uniforms u = uniforms_of(state, p, canvas, &place, &camera);
    uint32_t count = 0;
    amb_status status =
        elevated_patches(camera.position, camera.world_to_clip, p->sight, -u.ceiling, u.ceiling, index, &count, error);
    if (status)
        return status;
    amb_draw ground = {.label = "ground",
                       .lanes = AMB_LANES,
                       .fragment = elevated_ground_fragment,
                       .uniforms = &u,
                       .uniforms_size = sizeof u,
                       .varying_floats = sizeof(elevated_varyings) / sizeof(f32x),
                       .indices = *index,
                       .count = count,
                       .vertex_count = PATCH_INDICES,
                       .topology = AMB_PATCHES,
                       .tessellation = {.hull = elevated_ground_hull,
                                        .domain = elevated_ground_domain,
                                        .corners = 1,
                                        .shape = AMB_QUAD,
                                        .partitioning = AMB_INTEGER,
                                        .clockwise = true},
                       .wireframe = p->wireframe != 0,
                       .cull = AMB_CULL_BACK};
    amb_draw sky = {.label = "sky",
                    .lanes = AMB_LANES,
                    .fragment = elevated_sky_fragment,
                    .uniforms = &u,
                    .uniforms_size = sizeof u,
                    .depth_write_off = true};
    status = amb_pass_draw(canvas->pass, &ground, error);
    return status ? status : amb_pass_draw(canvas->pass, &sky, error);
}

static amb_status elevated_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    const elevated_params *p = job->params;
    amb_canvas canvas;
    uint32_t *index = NULL;
    amb_status status = canvas_begin(job, elevated_aovs, OUT_COUNT, p->samples, &canvas, error);
    if (status == AMB_OK)
        status = canvas_finish(job, elevated_aovs, &canvas, elevated_draw(state, job, &canvas, &index, error), error);
    free(index);
    return status;
}

const amb_scene WIDE(amb_scene_elevated) = {
    .name = "elevated",
    .about = "an endless flight over procedural mountains under Preetham's sky",
    .seconds = 120.0f,
    .params = {elevated_table, sizeof elevated_table / sizeof *elevated_table, sizeof(elevated_params)},
    .aovs = elevated_aovs,
    .aov_count = OUT_COUNT,
    .post = "bloom:threshold=1.2,intensity=0.15;display:curve=aces,dither=gradient",
    .load = elevated_load,
    .frame = elevated_frame,
    .unload = elevated_unload,
};
