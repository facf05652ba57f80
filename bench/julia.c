/* The scene julia with its default parameters: ours through the scene itself, and its GLSL twin. */
#include "bench/julia.h"

#include <ambiance/assets.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_CONTEXTS = 8 };
static const double moment = 3.0; /* seconds into the scene */

typedef struct julia_bench {
    int width, height;
    void *params;
    amb_frame *frame;
    amb_context *loader;
    amb_assets *assets;
    struct {
        const amb_context *context;
        const amb_scene *scene;
        void *state;
    } loaded[MAX_CONTEXTS]; /* the scene is loaded once for each context it is run on */
    int loaded_count;
    double flops;
    bool has_peer;
    julia_peer peer;
} julia_bench;

static void close_bench(void *state)
{
    julia_bench *b = state;
    if (!b)
        return;
    for (int i = 0; i < b->loaded_count; i++)
        b->loaded[i].scene->unload(b->loaded[i].state);
    if (b->has_peer)
        julia_peer_close(&b->peer);
    amb_assets_close(&b->assets);
    amb_context_close(&b->loader);
    amb_frame_close(&b->frame);
    free(b->params);
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
    julia_twin twin = {.table = &scene->params, .params = b->params, .width = b->width, .height = b->height};
    twin.camera = amb_julia_camera(moment, b->width, b->height);
    twin.set = julia_make(amb_julia_path(moment, (double)scene->seconds), julia_parameter_int(&twin, "iterations"));
    amb_march_limits limits = {v3_length(twin.camera.ray_dy) * 0.5f, 2.0f * julia_parameter(&twin, "tolerance"), 1e-5f,
                               julia_parameter_int(&twin, "steps")};
    b->flops = julia_count_flops(&twin, limits, v3_normalize(julia_parameter3(&twin, "light_direction")));
    if (!peer)
        return AMB_OK;
    amb_status status = amb_assets_texture(b->assets, "env/outdoor", &twin.environment, error);
    if (!status)
        status = amb_assets_texture(b->assets, "env/outdoor/irradiance", &twin.irradiance, error);
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
    b->width = options->width;
    b->height = options->height;
    amb_status status = amb_context_create(NULL, &b->loader, error);
    if (!status)
        status = amb_assets_create(b->loader, &(amb_assets_options){.builtin_only = true}, &b->assets, error);
    if (!status)
        status = amb_frame_create(b->width, b->height, &b->frame, error);
    if (status)
        return status;
    const amb_scene *scene = amb_scene_by_name(amb_context_isa(b->loader), "julia");
    if (!scene)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "the scene julia is not in this build");
    b->params = malloc(scene->params.size);
    if (!b->params)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the julia workload");
    amb_params_defaults(&scene->params, b->params);
    return make_twin(b, scene, options->peer != NULL, error);
}

static amb_status run(void *state, const amb_context *context, amb_error *error)
{
    julia_bench *b = state;
    int i = 0;
    while (i < b->loaded_count && b->loaded[i].context != context)
        i++;
    if (i == b->loaded_count) {
        if (i == MAX_CONTEXTS)
            return amb_fail(error, AMB_ERROR_LIMIT, "the julia workload runs on at most %d contexts", MAX_CONTEXTS);
        b->loaded[i].context = context;
        b->loaded[i].scene = amb_scene_by_name(amb_context_isa(context), "julia");
        amb_status status = b->loaded[i].scene->load(context, b->assets, &b->loaded[i].state, error);
        if (status)
            return status;
        b->loaded_count++;
    }
    amb_scene_job job = {.context = context,
                         .params = b->params,
                         .time = moment,
                         .width = b->width,
                         .height = b->height,
                         .frame = b->frame};
    return b->loaded[i].scene->frame(b->loaded[i].state, &job, error);
}

static amb_status run_peer(void *state, amb_error *error)
{
    const julia_bench *b = state;
    return julia_peer_run(&b->peer, error);
}

static amb_status difference(void *state, double *rmse, amb_error *error)
{
    const julia_bench *b = state;
    float *pixels = malloc((size_t)b->width * (size_t)b->height * 4 * sizeof *pixels);
    if (!pixels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    gl_read(&b->peer.target, pixels);
    *rmse = bench_rmse(b->frame->layer[0].image, pixels);
    free(pixels);
    return gl_check(error);
}

static bench_count count(const void *state, const amb_context *context)
{
    const julia_bench *b = state;
    (void)context;
    return (bench_count){.flops = b->flops, .items = 1e-6 * b->width * b->height, .unit = "Mpixels/s"};
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
