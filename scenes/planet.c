#include "scenes/planet.h"

#include "shade/color.h"

#include <ambiance/math.h>

#include <stdlib.h>

enum { SPHERE_RINGS = 192, SPHERE_SEGMENTS = 384 };

amb_status planet_load(amb_assets *assets, planet_state *state, amb_error *error)
{
    amb_status status = amb_mesh_sphere(SPHERE_RINGS, SPHERE_SEGMENTS, &state->sphere, error);
    if (status == AMB_OK)
        status = amb_assets_texture(assets, "stars", &state->stars, error);
    return status;
}

void planet_unload(planet_state *state) { amb_mesh_close(&state->sphere); }

typedef struct normal_rows {
    const amb_texture *texture;
    amb_image *height, *normals;
} normal_rows;

/* Level 0 of the texture as heights: a look-up at every texel's centre. */
static void height_row(void *user, int y, int thread)
{
    (void)thread;
    static const amb_sampler nearest = {.filter = AMB_NEAREST};
    const normal_rows *job = user;
    amb_texture_info info = amb_texture_describe(job->texture);
    bool one_channel = info.texel == AMB_TEXEL_R8 || info.texel == AMB_TEXEL_R16F || info.texel == AMB_TEXEL_R32F;
    float *row = amb_image_row(job->height, 0, y);
    for (int x = 0; x < info.width; x++) {
        v2x uv = {((float)x + 0.5f) / (float)info.width, ((float)y + 0.5f) / (float)info.height};
        v4x texel = amb_sample_2d_lod(job->texture, &nearest, uv, 0.0f);
        row[x] = one_channel ? texel.x : color_luminance(v4x_xyz(texel));
    }
}

static void code_row(void *user, int y, int thread)
{
    (void)thread;
    const normal_rows *job = user;
    for (int c = 0; c < 3; c++) {
        float *row = amb_image_row(job->normals, c, y);
        for (int x = 0; x < job->normals->width; x++)
            row[x] = row[x] * 0.5f + 0.5f;
    }
}

amb_status planet_normal_texture(const amb_context *context, const amb_texture *height,
                                 const amb_normal_map_options *options, amb_texture **out, amb_error *error)
{
    normal_rows job = {.texture = height};
    amb_texture_info info = amb_texture_describe(height);
    *out = NULL;
    amb_status status = amb_image_create(info.width, info.height, 1, &job.height, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, height_row, &job);
        status = amb_normal_map_make(context, job.height, options, &job.normals, error);
    }
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, code_row, &job);
        status = amb_texture_from_image(job.normals, AMB_TEXEL_RGBA16F, true, out, error);
    }
    amb_image_close(&job.height);
    amb_image_close(&job.normals);
    return status;
}

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
        .time = (float)time,
        .sphere = state->sphere,
        .stars = state->stars,
    };
    for (int i = 0; i < 3; i++)
        view.axis[i] =
            turned_axis(params->tilt * degree, turn, (v3){(float)(i == 0), (float)(i == 1), (float)(i == 2)});
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

amb_status planet_load_maps(amb_assets *assets, const planet_map_name *maps, size_t count, amb_error *error)
{
    amb_status status = AMB_OK;
    for (size_t i = 0; i < count && status == AMB_OK; i++)
        status = amb_assets_texture(assets, maps[i].name, maps[i].map, error);
    return status;
}

amb_status planet_frame(const planet_body *body, const amb_aov *aovs, size_t aov_count, const planet_flight *flight,
                        amb_draw background, const void *state, const amb_scene_job *job, amb_error *error)
{
    const planet_params *params = job->params;
    amb_canvas canvas;
    amb_status status = canvas_begin(job, aovs, aov_count, params->samples, &canvas, error);
    if (status != AMB_OK)
        return status;
    planet_view view = planet_view_at(state, params, job, &canvas, flight);
    background.uniforms = &view;
    background.uniforms_size = sizeof view;
    status = amb_pass_draw(canvas.pass, &background, error);
    if (status == AMB_OK)
        status = body->draw(state, job->params, &view, job->time, canvas.pass, error);
    return canvas_finish(job, aovs, &canvas, status, error);
}
