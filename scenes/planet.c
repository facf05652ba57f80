#include "scenes/planet.h"

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

/* Level 0 as a planar image: a look-up at every texel's centre. */
static amb_status texture_image(const amb_texture *texture, amb_image **out, amb_error *error)
{
    static const amb_sampler nearest = {.filter = AMB_NEAREST};
    amb_texture_info info = amb_texture_describe(texture);
    amb_status status = amb_image_create(info.width, info.height, 3, out, error);
    if (status != AMB_OK)
        return status;
    for (int y = 0; y < info.height; y++)
        for (int x = 0; x < info.width; x++) {
            v2x uv = {((float)x + 0.5f) / (float)info.width, ((float)y + 0.5f) / (float)info.height};
            v4x texel = amb_sample_2d_lod(texture, &nearest, uv, 0.0f);
            bool one_channel =
                info.texel == AMB_TEXEL_R8 || info.texel == AMB_TEXEL_R16F || info.texel == AMB_TEXEL_R32F;
            amb_image_row(*out, 0, y)[x] = texel.x;
            amb_image_row(*out, 1, y)[x] = one_channel ? texel.x : texel.y;
            amb_image_row(*out, 2, y)[x] = one_channel ? texel.x : texel.z;
        }
    return AMB_OK;
}

amb_status planet_normal_texture(const amb_context *context, const amb_texture *height,
                                 const amb_normal_map_options *options, amb_texture **out, amb_error *error)
{
    amb_image *image = NULL, *normals = NULL;
    *out = NULL;
    amb_status status = texture_image(height, &image, error);
    if (status == AMB_OK)
        status = amb_normal_map_make(context, image, options, &normals, error);
    if (status == AMB_OK) {
        size_t count = normals->stride * (size_t)normals->height * 3;
        for (size_t i = 0; i < count; i++)
            normals->data[i] = normals->data[i] * 0.5f + 0.5f;
        status = amb_texture_from_image(normals, AMB_TEXEL_RGBA8, true, out, error);
    }
    amb_image_close(&image);
    amb_image_close(&normals);
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

planet_view planet_view_at(const planet_state *state, const planet_params *params, const amb_scene_job *job,
                           const amb_canvas *canvas, const planet_flight *flight)
{
    const float degree = AMB_PI / 180.0f;
    float at = planet_loop_time(job->time, flight->keys[flight->key_count - 1].time);
    amb_camera camera = amb_camera_at(flight->keys, flight->key_count, at, flight->vertical_fov * degree, 0.01f, 100.0f,
                                      canvas->width, canvas->height);
    float turn = params->turn * degree;
    if (params->day > 0.0f)
        turn += planet_loop_time(job->time, params->day) / params->day * AMB_TWO_PI;
    float azimuth = params->sun_azimuth * degree, elevation = params->sun_elevation * degree;
    planet_view view = {
        .world_to_clip = camera.world_to_clip,
        .eye = camera.position,
        .ray_origin = camera.ray_origin,
        .ray_dx = camera.ray_dx,
        .ray_dy = camera.ray_dy,
        .scale = {1, 1, 1},
        .shell = 1.0f,
        .to_sun = {f_cos(elevation) * f_sin(azimuth), f_sin(elevation), f_cos(elevation) * f_cos(azimuth)},
        .sun_rgb = {params->exposure, params->exposure, params->exposure},
        .sun_size = 1.0f,
        .star_gain = params->stars,
        .time = (float)job->time,
        .sphere = state->sphere,
        .stars = state->stars,
    };
    for (int i = 0; i < 3; i++)
        view.axis[i] =
            turned_axis(params->tilt * degree, turn, (v3){(float)(i == 0), (float)(i == 1), (float)(i == 2)});
    memcpy(view.slot, canvas->slot, sizeof view.slot);
    return view;
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
