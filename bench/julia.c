/* The scene julia with its default parameters: ours through the scene itself, and its GLSL twin. */
#include "bench/julia.h"
#include "bench/shown.h"

#include <stdlib.h>
#include <string.h>

static const double moment = 3.0; /* seconds into the scene */

typedef struct julia_bench {
    shown shown;
    double flops;
    bool has_peer;
    julia_peer peer;
} julia_bench;

static void close_bench(void *state)
{
    julia_bench *b = state;
    if (!b)
        return;
    if (b->has_peer)
        julia_peer_close(&b->peer);
    shown_close(&b->shown);
    free(b);
}

static const void *parameter(const julia_twin *twin, const char *name)
{
    for (size_t i = 0; i < twin->table->count; i++)
        if (!strcmp(twin->table->table[i].name, name))
            return (const char *)twin->params + twin->table->table[i].offset;
    return NULL;
}
v3 julia_parameter3(const julia_twin *twin, const char *name)
{
    const v3 *value = parameter(twin, name);
    return value ? *value : (v3){0, 0, 0};
}
float julia_parameter(const julia_twin *twin, const char *name)
{
    const float *value = parameter(twin, name);
    return value ? *value : 0.0f;
}
int julia_parameter_int(const julia_twin *twin, const char *name)
{
    const int *value = parameter(twin, name);
    return value ? *value : 0;
}

static amb_status make_twin(julia_bench *b, const amb_scene *scene, bool peer, amb_error *error)
{
    julia_twin twin = {
        .table = &scene->params, .params = b->shown.params, .width = b->shown.width, .height = b->shown.height};
    twin.camera = amb_julia_camera(moment, b->shown.width, b->shown.height);
    twin.set = julia_make(amb_julia_path(moment, (double)scene->seconds), julia_parameter_int(&twin, "iterations"));
    amb_march_limits limits = {v3_length(twin.camera.ray_dy) * 0.5f, 2.0f * julia_parameter(&twin, "tolerance"), 1e-5f,
                               julia_parameter_int(&twin, "steps")};
    b->flops = julia_count_flops(&twin, limits, v3_normalize(julia_parameter3(&twin, "light_direction")));
    if (!peer)
        return AMB_OK;
    amb_status status = amb_assets_texture(b->shown.assets, "env/outdoor", &twin.environment, error);
    if (!status)
        status = amb_assets_texture(b->shown.assets, "env/outdoor/irradiance", &twin.irradiance, error);
    if (status)
        return status;
    b->has_peer = true;
    return julia_peer_open(&b->peer, &twin, error);
}

static amb_status open_bench(const bench_options *options, void **state, amb_error *error)
{
    julia_bench *b = calloc(1, sizeof *b);
    *state = b;
    if (!b)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the julia workload");
    amb_status status = shown_open("julia", moment, options, &b->shown, error);
    if (status)
        return status;
    return make_twin(b, amb_scene_by_name(amb_context_isa(b->shown.loader), "julia"), options->peer != NULL, error);
}

static amb_status run(void *state, const amb_context *context, amb_error *error)
{
    return shown_run(&((julia_bench *)state)->shown, context, NULL, error);
}

static amb_status run_peer(void *state, amb_error *error)
{
    const julia_bench *b = state;
    return julia_peer_run(&b->peer, error);
}

static amb_status difference(void *state, double *rmse, amb_error *error)
{
    const julia_bench *b = state;
    return shown_difference(&b->shown, &b->peer.target, rmse, error);
}

static bench_count count(const void *state, const amb_context *context)
{
    const julia_bench *b = state;
    (void)context;
    return (bench_count){.flops = b->flops, .items = 1e-6 * b->shown.width * b->shown.height, .unit = "Mpixels/s"};
}

const bench_workload bench_julia = {
    .name = "julia",
    .about = "the scene julia, 3 s, built-in environments: sphere tracing, soft shadow, two cube maps",
    .open = open_bench,
    .run = run,
    .run_peer = run_peer,
    .difference = difference,
    .count = count,
    .close = close_bench,
    .peer_goal = 3.0,
    .threads_goal = 1.9,
    .wide_goal = 1.7,
};
