#include "scenes/planet.h"

#include "shade/color.h"

#include <ambiance/math.h>

#include <stdlib.h>

enum { SPHERE_RINGS = 96, SPHERE_SEGMENTS = 192 };

const char *const planet_show_names[] = {"beauty", "albedo", "normals", "light", "attenuation", "scattering", NULL};

/* ---- maps ------------------------------------------------------------------------------------------------------- */

typedef struct map_rows {
    const amb_texture *from, *alpha;
    amb_image *height, *normals, *out;
    float south; /* factor on normals' y, ±½ */
} map_rows;

static const amb_sampler nearest = {.filter = AMB_NEAREST, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
static const amb_sampler smooth = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};

static v2x texel_centre(const amb_image *image, int x, int y)
{
    return (v2x){((float)x + 0.5f) / (float)image->width, ((float)y + 0.5f) / (float)image->height};
}

/* Level 0 as heights: a look-up at every texel's centre. */
static void height_row(void *user, int y, int thread)
{
    (void)thread;
    const map_rows *job = user;
    amb_texel texel = amb_texture_describe(job->from).texel;
    bool one_channel = texel == AMB_TEXEL_R8 || texel == AMB_TEXEL_R16F || texel == AMB_TEXEL_R32F;
    float *row = amb_image_row(job->height, 0, y);
    for (int x = 0; x < job->height->width; x++) {
        v4x c = amb_sample_2d_lod(job->from, &nearest, texel_centre(job->height, x, y), 0.0f);
        row[x] = one_channel ? c.x : color_luminance(v4x_xyz(c)) * c.w;
    }
}

static void coded_normal_row(void *user, int y, int thread)
{
    (void)thread;
    const map_rows *job = user;
    for (int x = 0; x < job->out->width; x++) {
        for (int c = 0; c < 3; c++)
            amb_image_row(job->out, c, y)[x] =
                amb_image_row(job->normals, c, y)[x] * (c == 1 ? job->south : 0.5f) + 0.5f;
        amb_image_row(job->out, 3, y)[x] = amb_image_row(job->height, 0, y)[x];
    }
}

amb_status planet_normal_texture(const amb_context *context, const amb_texture *height,
                                 const amb_normal_map_options *options, bool green_up, amb_texture **out,
                                 amb_error *error)
{
    map_rows job = {.from = height, .south = green_up ? -0.5f : 0.5f};
    amb_texture_info info = amb_texture_describe(height);
    *out = NULL;
    amb_status status = amb_image_create(info.width, info.height, 1, &job.height, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, height_row, &job);
        status = amb_normal_map_make(context, job.height, options, &job.normals, error);
    }
    if (status == AMB_OK)
        status = amb_image_create(info.width, info.height, 4, &job.out, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, coded_normal_row, &job);
        status = amb_texture_from_image(job.out, AMB_TEXEL_RGBA16F, true, out, error);
    }
    amb_image_close(&job.height);
    amb_image_close(&job.normals);
    amb_image_close(&job.out);
    return status;
}

static void colour_row(void *user, int y, int thread)
{
    (void)thread;
    const map_rows *job = user;
    for (int x = 0; x < job->out->width; x++) {
        v2x uv = texel_centre(job->out, x, y);
        v4x c = amb_sample_2d_lod(job->from, &nearest, uv, 0.0f);
        float value[4] = {c.x, c.y, c.z, amb_sample_2d_lod(job->alpha, &smooth, uv, 0.0f).x};
        for (int k = 0; k < 4; k++)
            amb_image_row(job->out, k, y)[x] = value[k];
    }
}

amb_status planet_colour_texture(const amb_context *context, const amb_texture *colour, const amb_texture *alpha,
                                 amb_texture **out, amb_error *error)
{
    map_rows job = {.from = colour, .alpha = alpha};
    amb_texture_info info = amb_texture_describe(colour);
    *out = NULL;
    amb_status status = amb_image_create(info.width, info.height, 4, &job.out, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, colour_row, &job);
        status = amb_texture_from_image(job.out, AMB_TEXEL_SRGB8_A8, true, out, error);
    }
    amb_image_close(&job.out);
    return status;
}

/* ---- state ------------------------------------------------------------------------------------------------------ */

static const amb_texture **map_at(void *state, size_t offset)
{
    return (const amb_texture **)(void *)((char *)state + offset);
}
static amb_texture **made_at(void *state, size_t offset) { return (amb_texture **)(void *)((char *)state + offset); }

/* Height, in texels, of a luminance difference of 1 such that every map gets the same relief, whatever its size and
 * contrast: slopes along u over 1/1024 of the circumference, between 45° south and north, have a given root mean
 * square. */
static float relief_strength(const amb_texture *map, float slope)
{
    enum { COLUMNS = 1024, ROWS = 64 };
    static const amb_sampler sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    float width = (float)amb_texture_describe(map).width, lod = f_max(f_log2(width / COLUMNS), 0.0f);
    double sum = 0.0;
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) {
            float u = ((float)x + 0.5f) / (float)COLUMNS, v = 0.25f + ((float)y + 0.5f) / (2.0f * ROWS);
            v4x a = amb_sample_2d_lod(map, &sampler, (v2x){u, v}, lod);
            v4x b = amb_sample_2d_lod(map, &sampler, (v2x){u + 1.0f / COLUMNS, v}, lod);
            float rise = color_luminance(v3x_sub(v4x_xyz(b), v4x_xyz(a)));
            sum += (double)rise * (double)rise;
        }
    float rise = __builtin_sqrtf((float)(sum / (COLUMNS * ROWS)));
    return slope * (width / COLUMNS) / f_max(rise, 1e-4f);
}

static amb_status make_map(const amb_context *context, void *state, const planet_made_row *row, amb_error *error)
{
    const amb_texture *from = *map_at(state, row->from);
    if (row->alpha)
        return planet_colour_texture(context, from, *map_at(state, row->alpha), made_at(state, row->offset), error);
    amb_normal_map_options relief = row->relief;
    if (row->slope > 0.0f)
        relief.strength = relief_strength(from, row->slope);
    return planet_normal_texture(context, from, &relief, false, made_at(state, row->offset), error);
}

/* A sky that is not ours has its own stars. */
static amb_status load_stars(amb_assets *assets, planet_state *state, amb_error *error)
{
    amb_asset_info info;
    int i = 0;
    do
        amb_assets_describe(assets, i++, &info);
    while (strcmp(info.name, "stars") != 0);
    amb_status status = amb_assets_texture(assets, "stars", &state->stars, error);
    if (status == AMB_OK && info.source == AMB_ASSET_BUILTIN)
        status = amb_assets_mesh(assets, "stars/points", &state->points, error);
    return status;
}

amb_status planet_load(const planet_body *body, const amb_context *context, amb_assets *assets, void **state,
                       amb_error *error)
{
    planet_state *s = calloc(1, body->state_bytes);
    *state = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene %s", body->name);
    s->body = body;
    amb_status status = amb_mesh_sphere(SPHERE_RINGS, SPHERE_SEGMENTS, &s->sphere, error);
    if (status == AMB_OK)
        status = load_stars(assets, s, error);
    for (int i = 0; i < PLANET_MAX_MAPS && body->map[i].asset && status == AMB_OK; i++)
        status = amb_assets_texture(assets, body->map[i].asset, map_at(s, body->map[i].offset), error);
    for (int i = 0; i < PLANET_MAX_MADE && body->made[i].offset && status == AMB_OK; i++)
        status = make_map(context, s, &body->made[i], error);
    if (status == AMB_OK)
        *state = s;
    else
        planet_unload(s);
    return status;
}

void planet_unload(void *state)
{
    planet_state *s = state;
    if (!s)
        return;
    for (int i = 0; i < PLANET_MAX_MADE && s->body->made[i].offset; i++)
        amb_texture_close(made_at(s, s->body->made[i].offset));
    amb_mesh_close(&s->sphere);
    free(s);
}

static const amb_camera_key ball_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
const planet_flight planet_flight_ball = {ball_keys, sizeof ball_keys / sizeof *ball_keys, 40.0f};

static const amb_camera_key rings_keys[] = {
    {0.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},    {10.0f, {2.0f, 0.7f, 4.9f}, {0, 0, 0}, {0, 1, 0}},
    {20.0f, {4.2f, -0.5f, 2.2f}, {0.2f, 0, 0}, {0, 1, 0}}, {30.0f, {0.9f, -1.2f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
};
const planet_flight planet_flight_rings = {rings_keys, sizeof rings_keys / sizeof *rings_keys, 40.0f};

/* ---- view and frame --------------------------------------------------------------------------------------------- */

float planet_loop_time(double time, float period)
{
    if (!(period > 0.0f))
        return 0.0f;
    double loops = time / (double)period;
    double whole = loops >= -9e15 && loops <= 9e15 ? (double)(long long)loops : loops;
    double part = loops - whole;
    return (float)((part < 0.0 ? part + 1.0 : part) * (double)period);
}

static v3 turned_axis(float tilt, float turn, v3 axis)
{
    m4 rotation = m4_mul(m4_rotate((v3){0, 0, -1}, tilt), m4_rotate((v3){0, 1, 0}, turn));
    return m4_direction(rotation, axis);
}

planet_view planet_view_of(const planet_state *state, const planet_params *params, double time,
                           const amb_canvas *canvas, const amb_camera *camera)
{
    const float degree = AMB_PI / 180.0f;
    float turn = params->turn * degree;
    if (params->day > 0.0f)
        turn += planet_loop_time(time, params->day) / params->day * AMB_TWO_PI;
    v3 ray = v3_add(v3_scale(camera->ray_dx, 0.5f * (float)canvas->width),
                    v3_scale(camera->ray_dy, 0.5f * (float)canvas->height));
    float middle = v3_length(v3_add(camera->ray_origin, ray));
    float azimuth = params->sun_azimuth * degree, elevation = params->sun_elevation * degree;
    planet_view view = {
        .world_to_clip = camera->world_to_clip,
        .eye = camera->position,
        .ray_origin = camera->ray_origin,
        .ray_dx = camera->ray_dx,
        .ray_dy = camera->ray_dy,
        .scale = {1, 1, 1},
        .shell = 1.0f,
        .to_sun = {f_cos(elevation) * f_sin(azimuth), f_sin(elevation), f_cos(elevation) * f_cos(azimuth)},
        .sun_rgb = {params->exposure, params->exposure, params->exposure},
        .sun_size = 1.0f,
        .star_gain = params->stars,
        .show = params->show,
        .sphere = state->sphere,
        .stars = state->stars,
        .points = state->points,
        .size = {(float)canvas->width, (float)canvas->height},
        .sample_angle = v3_length(camera->ray_dy) / middle,
        .star_radius = 0.75f * (float)canvas->factor,
    };
    for (int i = 0; i < 3; i++)
        view.axis[i] =
            turned_axis(params->tilt * degree, turn, (v3){(float)(i == 0), (float)(i == 1), (float)(i == 2)});
    view.attachments = canvas->count;
    memcpy(view.slot, canvas->slot, sizeof view.slot);
    return view;
}

planet_view planet_view_at(const planet_state *state, const planet_params *params, const amb_scene_job *job,
                           const amb_canvas *canvas, const planet_flight *flight)
{
    float at = planet_loop_time(job->time, flight->keys[flight->key_count - 1].time);
    amb_camera camera = amb_camera_at(flight->keys, flight->key_count, at, flight->vertical_fov * (AMB_PI / 180.0f),
                                      0.01f, 100.0f, canvas->width, canvas->height);
    return planet_view_of(state, params, job->time, canvas, &camera);
}

amb_status planet_sky_draw(amb_pass *pass, const planet_sky *sky, const planet_view *view, amb_error *error)
{
    amb_draw background = sky->background, points = sky->points;
    background.uniforms = points.uniforms = view;
    background.uniforms_size = points.uniforms_size = sizeof *view;
    amb_status status = amb_pass_draw(pass, &background, error);
    if (status != AMB_OK || !view->points || !(view->star_gain > 0.0f))
        return status;
    points.count = view->points->vertex_count;
    points.point_size = 2.0f * __builtin_ceilf(2.2f * view->star_radius) + 1.0f;
    return amb_pass_draw(pass, &points, error);
}

amb_status planet_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    const planet_state *s = state;
    const planet_body *body = s->body;
    const planet_params *params = job->params;
    amb_canvas canvas;
    amb_status status = canvas_begin(job, body->aovs, body->aov_count, params->samples, &canvas, error);
    if (status != AMB_OK)
        return status;
    planet_view view = planet_view_at(s, params, job, &canvas, body->flight);
    if (params->show == PLANET_SHOW_BEAUTY)
        status = planet_sky_draw(canvas.pass, body->sky, &view, error);
    if (status == AMB_OK)
        status = body->draw(state, job->params, &view, job->time, canvas.pass, error);
    return canvas_finish(job, body->aovs, &canvas, status, error);
}
