/* The scene earth, one sample a pixel, without stars: ground, clouds and two draws of air; ours through the scene
 * itself, and its GLSL twin. */
#include "bench/earth.h"
#include "bench/bench.h"
#include "core/dispatch.h"

#include <ambiance/assets.h>
#include <ambiance/scene.h>
#include <stdlib.h>
#include <string.h>

extern const planet_body planet_earth_x4;
#if defined(__x86_64__)
extern const planet_body planet_earth_x8, planet_earth_x16;
#endif

enum { MAX_ISAS = 3 };

typedef struct earth_bench {
    int width, height;
    void *params;
    amb_frame *frame;
    amb_context *loader;
    amb_assets *assets;
    struct {
        amb_isa isa;
        const amb_scene *scene;
        void *state;
    } loaded[MAX_ISAS]; /* once for each instruction set */
    int loaded_count;
    amb_pass_stats stats; /* of the last frame */
    bool has_peer;
    earth_peer peer;
} earth_bench;

static void close_bench(void *state)
{
    earth_bench *b = state;
    if (!b)
        return;
    for (int i = 0; i < b->loaded_count; i++)
        b->loaded[i].scene->unload(b->loaded[i].state);
    if (b->has_peer)
        earth_peer_close(&b->peer);
    amb_assets_close(&b->assets);
    amb_context_close(&b->loader);
    amb_frame_close(&b->frame);
    free(b->params);
    free(b);
}

/* The scene loaded for an instruction set; NULL: see error. */
static void *loaded(earth_bench *b, amb_isa isa, const amb_context *context, const amb_scene **scene, amb_error *error)
{
    int i = 0;
    *scene = amb_scene_by_name(isa, "earth");
    while (i < b->loaded_count && b->loaded[i].isa != isa)
        i++;
    if (i == b->loaded_count) {
        b->loaded[i].isa = isa;
        b->loaded[i].scene = *scene;
        if ((*scene)->load(context, b->assets, &b->loaded[i].state, error))
            return NULL;
        b->loaded_count++;
    }
    return b->loaded[i].state;
}

static const void *parameter(const earth_bench *b, const amb_scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->params.count; i++)
        if (strcmp(scene->params.table[i].name, name) == 0)
            return (const char *)b->params + scene->params.table[i].offset;
    return NULL;
}
static float number(const earth_bench *b, const amb_scene *scene, const char *name)
{
    const float *value = parameter(b, scene, name);
    return value ? *value : 0.0f;
}

static const amb_texture *texture_of(const void *state, size_t offset)
{
    return *(const amb_texture *const *)(const void *)((const char *)state + offset);
}

static amb_status make_twin(earth_bench *b, amb_error *error)
{
    amb_isa isa = amb_context_isa(b->loader);
    const amb_scene *scene;
    const void *state = loaded(b, isa, b->loader, &scene, error);
    if (!state)
        return error->status ? error->status : AMB_ERROR_MEMORY;
    const planet_body *body = AMB_DISPATCH(isa, &planet_earth);
    const planet_air_params *air = parameter(b, scene, "air_height"); /* their first */
    amb_canvas canvas = {.factor = 1, .width = b->width, .height = b->height};
    amb_scene_job job = {.context = b->loader, .params = b->params, .width = b->width, .height = b->height};
    planet_view view = planet_view_at(state, b->params, &job, &canvas, body->flight);
    earth_twin twin = {.view = view,
                       .air = planet_atmosphere(air, view.sun_rgb),
                       .ground = texture_of(state, body->made[0].offset),
                       .relief = texture_of(state, body->made[1].offset),
                       .clouds = texture_of(state, body->made[2].offset),
                       .night = texture_of(state, body->map[1].offset),
                       .wrap = number(b, scene, "wrap"),
                       .night_gain = number(b, scene, "night"),
                       .gloss = number(b, scene, "gloss"),
                       .gloss_exponent = number(b, scene, "gloss_exponent"),
                       .bump = number(b, scene, "bump"),
                       .parallax = number(b, scene, "parallax"),
                       .cover = number(b, scene, "clouds"),
                       .cloud_shell = 1.0f + number(b, scene, "cloud_height"),
                       .cloud_ring = number(b, scene, "cloud_ring"),
                       .cloud_shadow = number(b, scene, "cloud_shadow"),
                       .cloud_bump = number(b, scene, "cloud_bump"),
                       .ground_gain = air->ground,
                       .dome_gain = air->dome};
    b->has_peer = true;
    return earth_peer_open(&twin, b->width, b->height, &b->peer, error);
}

static amb_status open_bench(const bench_options *options, void **state, amb_error *error)
{
    earth_bench *b = calloc(1, sizeof *b);
    *state = b;
    if (!b)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the earth workload");
    b->width = options->width;
    b->height = options->height;
    amb_status status = amb_context_create(NULL, &b->loader, error);
    if (!status)
        status = amb_assets_create(b->loader, &(amb_assets_options){.builtin_only = true}, &b->assets, error);
    if (!status)
        status = amb_frame_create(b->width, b->height, &b->frame, error);
    if (status)
        return status;
    const amb_params *params = &amb_scene_by_name(amb_context_isa(b->loader), "earth")->params;
    b->params = calloc(1, params->size);
    if (!b->params)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the earth workload");
    amb_params_defaults(params, b->params);
    status = amb_params_set(params, b->params, "scene earth", "samples", "1", error);
    if (!status)
        status = amb_params_set(params, b->params, "scene earth", "stars", "0", error);
    return !status && options->peer ? make_twin(b, error) : status;
}

static amb_status run(void *state, const amb_context *context, amb_error *error)
{
    earth_bench *b = state;
    const amb_scene *scene;
    void *earth = loaded(b, amb_context_isa(context), context, &scene, error);
    if (!earth)
        return AMB_ERROR_MEMORY;
    amb_scene_job job = {
        .context = context, .params = b->params, .width = b->width, .height = b->height, .frame = b->frame};
    return scene->frame(earth, &job, error);
}

static amb_status run_peer(void *state, amb_error *error)
{
    return earth_peer_run(&((earth_bench *)state)->peer, error);
}

static amb_status difference(void *state, double *rmse, amb_error *error)
{
    const earth_bench *b = state;
    float *pixels = malloc((size_t)b->width * (size_t)b->height * 4 * sizeof *pixels);
    if (!pixels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    gl_read(&b->peer.target, pixels);
    *rmse = bench_rmse(b->frame->layer[0].image, pixels);
    free(pixels);
    return gl_check(error);
}

static amb_status facts(void *state, const amb_context *context, bench_facts *out, amb_error *error)
{
    earth_bench *b = state;
    const amb_scene *scene;
    void *earth = loaded(b, amb_context_isa(context), context, &scene, error);
    b->stats = (amb_pass_stats){0};
    amb_scene_job job = {.context = context,
                         .params = b->params,
                         .width = b->width,
                         .height = b->height,
                         .frame = b->frame,
                         .stats = &b->stats};
    amb_status status = scene->frame(earth, &job, error);
    double all = 0.0;
    for (int i = 0; i < AMB_STAGES; i++)
        all += (double)b->stats.ticks[i];
    for (int i = 0; i < AMB_STAGES && all > 0.0; i++)
        bench_fact(out, amb_stage_name((amb_stage)i), 100.0 * (double)b->stats.ticks[i] / all, "%");
    bench_fact(out, "fragments", (double)b->stats.fragments_shaded, "");
    return status;
}

const bench_workload bench_earth = {
    .name = "earth",
    .about = "the scene earth, no stars: day, night, gloss, relief, parallax, clouds, their shadow, air before and "
             "around it",
    .open = open_bench,
    .run = run,
    .run_peer = run_peer,
    .difference = difference,
    .facts = facts,
    .close = close_bench,
    .peer_goal = 3.0,
    .threads_goal = 1.9,
};
