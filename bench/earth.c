/* The scene earth, one sample a pixel, without stars: ground, clouds and two draws of air; ours through the scene
 * itself, and its GLSL twin. */
#include "bench/earth.h"
#include "bench/shown.h"
#include "core/dispatch.h"

#include <stdlib.h>
#include <string.h>

extern const planet_body planet_earth_x4;
#if defined(__x86_64__)
extern const planet_body planet_earth_x8, planet_earth_x16;
#endif

typedef struct earth_bench {
    shown shown;
    bool has_peer;
    earth_peer peer;
} earth_bench;

static void close_bench(void *state)
{
    earth_bench *b = state;
    if (!b)
        return;
    if (b->has_peer)
        earth_peer_close(&b->peer);
    shown_close(&b->shown);
    free(b);
}

static const void *parameter(const earth_bench *b, const amb_scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->params.count; i++)
        if (strcmp(scene->params.table[i].name, name) == 0)
            return (const char *)b->shown.params + scene->params.table[i].offset;
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
    const amb_scene *scene;
    void *state;
    amb_status status = shown_load(&b->shown, b->shown.loader, &scene, &state, error);
    if (status)
        return status;
    const planet_body *body = AMB_DISPATCH(amb_context_isa(b->shown.loader), &planet_earth);
    const planet_air_params *air = parameter(b, scene, "air_height"); /* their first */
    amb_canvas canvas = {.factor = 1, .width = b->shown.width, .height = b->shown.height};
    amb_scene_job job = {
        .context = b->shown.loader, .params = b->shown.params, .width = b->shown.width, .height = b->shown.height};
    planet_view view = planet_view_at(state, b->shown.params, &job, &canvas, body->flight);
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
    return earth_peer_open(&twin, b->shown.width, b->shown.height, &b->peer, error);
}

static amb_status open_bench(const bench_options *options, void **state, amb_error *error)
{
    earth_bench *b = calloc(1, sizeof *b);
    *state = b;
    if (!b)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the earth workload");
    amb_status status = shown_open("earth", 0.0, options, &b->shown, error);
    if (status)
        return status;
    const amb_params *params = &amb_scene_by_name(amb_context_isa(b->shown.loader), "earth")->params;
    status = amb_params_set(params, b->shown.params, "scene earth", "samples", "1", error);
    if (!status)
        status = amb_params_set(params, b->shown.params, "scene earth", "stars", "0", error);
    return !status && options->peer ? make_twin(b, error) : status;
}

static amb_status run(void *state, const amb_context *context, amb_error *error)
{
    return shown_run(&((earth_bench *)state)->shown, context, NULL, error);
}

static amb_status run_peer(void *state, amb_error *error)
{
    return earth_peer_run(&((earth_bench *)state)->peer, error);
}

static amb_status difference(void *state, double *rmse, amb_error *error)
{
    const earth_bench *b = state;
    return shown_difference(&b->shown, &b->peer.target, rmse, error);
}

static amb_status facts(void *state, const amb_context *context, bench_facts *out, amb_error *error)
{
    amb_pass_stats stats = {0};
    amb_status status = shown_run(&((earth_bench *)state)->shown, context, &stats, error);
    double all = 0.0;
    for (int i = 0; i < AMB_STAGES; i++)
        all += (double)stats.ticks[i];
    for (int i = 0; i < AMB_STAGES && all > 0.0; i++)
        bench_fact(out, amb_stage_name((amb_stage)i), 100.0 * (double)stats.ticks[i] / all, "%");
    bench_fact(out, "fragments", (double)stats.fragments_shaded, "");
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
