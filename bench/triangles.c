/* Workloads about triangles alone, with the plain shaders: a million tiny ones, a shadow map's depth-only pass, ten
 * thousand small draws; and the memory that ten million take. */
#include "bench/boulder.h"
#include "bench/plain.h"

#include <ambiance/math.h>
#include <ambiance/random.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHEETS = 3, SHEET_QUADS = 408, SHADOW_SIZE = 2048, DRAWS = 10000, COPIES = 100 };

typedef struct triangles_state {
    picture picture;
    amb_mesh *mesh;
    plain_uniforms *uniforms; /* one a draw */
    amb_draw *draw;
    size_t draws;
    bool depth_only;
    plain_peer peer;
} triangles_state;

static void triangles_close(void *state)
{
    triangles_state *s = state;
    if (!s)
        return;
    if (s->picture.has_peer)
        plain_peer_close(&s->peer);
    picture_close(&s->picture);
    amb_mesh_close(&s->mesh);
    free(s->uniforms);
    free(s->draw);
    free(s);
}

static amb_status create(size_t draws, void **state, triangles_state **out, amb_error *error)
{
    triangles_state *s = *out = *state = calloc(1, sizeof *s);
    if (s) {
        s->draws = draws;
        s->uniforms = calloc(draws, sizeof *s->uniforms);
        s->draw = calloc(draws, sizeof *s->draw);
    }
    return s && s->uniforms && s->draw ? AMB_OK
                                       : amb_fail(error, AMB_ERROR_MEMORY, "no memory for the draws of a workload");
}

/* Once the picture, the mesh and every draw's uniforms are there. */
static amb_status open_peer(triangles_state *s, amb_error *error)
{
    return s->picture.has_peer ? plain_peer_open(&s->uniforms[0], &s->peer, error) : AMB_OK;
}

static void make_draws(triangles_state *s, const amb_context *context)
{
    for (size_t i = 0; i < s->draws; i++)
        s->draw[i] = plain_draw(context, &s->uniforms[i], s->depth_only);
}

static amb_status triangles_run(void *state, const amb_context *context, amb_error *error)
{
    triangles_state *s = state;
    make_draws(s, context);
    return picture_pass(&s->picture, context, s->draw, s->draws, error);
}

static amb_status triangles_run_peer(void *state, amb_error *error)
{
    const triangles_state *s = state;
    picture_peer_begin(&s->picture);
    plain_peer_bind(&s->peer);
    for (size_t i = 0; i < s->draws; i++)
        plain_peer_draw(&s->peer, s->uniforms[i].offset, s->uniforms[i].color);
    return picture_peer_end(&s->picture, error);
}

static amb_status triangles_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    triangles_state *s = state;
    make_draws(s, context);
    return picture_facts(&s->picture, context, s->draw, s->draws, facts, error);
}

static amb_status triangles_difference(void *state, double *rmse, amb_error *error)
{
    return picture_difference(&((triangles_state *)state)->picture, rmse, error);
}

/* Bytes: the pictures, a vertex's 24 (positions only: 12) and an index's 4, each once. Arithmetic: a vertex's matrix
 * and window (28 + 15), a triangle's edges and area (35), a fragment's edges, depth, weights and Lambert (50). */
static bench_count triangles_count(const void *state, const amb_context *context)
{
    const triangles_state *s = state;
    (void)context;
    const amb_pass_stats *n = &s->picture.stats;
    return (bench_count){.flops = (double)n->vertices * 43.0 + (double)n->triangles_binned * 35.0 +
                                  (double)n->fragments_shaded * 50.0,
                         .bytes = picture_bytes(&s->picture) + (double)n->vertices * (s->depth_only ? 12.0 : 24.0) +
                                  (double)n->triangles_in * 12.0,
                         .items = (double)n->triangles_in * 1e-6,
                         .unit = "Mtriangles/s"};
}

/* ---- tiny: three wavy sheets across the window ------------------------------------------------------------------- */

/* A unit sheet in x and y, waves in z, facing +z. */
static amb_status make_sheet(amb_mesh **out, amb_error *error)
{
    const uint32_t side = SHEET_QUADS + 1;
    amb_status status = amb_mesh_create(side * side, 2 * SHEET_QUADS * SHEET_QUADS, out, error);
    if (status)
        return status;
    for (uint32_t i = 0; i < side * side; i++) {
        float x = (float)(i % side) * (2.0f / SHEET_QUADS) - 1.0f, y = (float)(i / side) * (2.0f / SHEET_QUADS) - 1.0f;
        (*out)->position[i] = (v3){x, y, 0.05f * (f_sin(9.0f * x) + f_sin(7.0f * y + 3.0f * x))};
    }
    uint32_t *index = (*out)->index;
    for (uint32_t i = 0; i < SHEET_QUADS * SHEET_QUADS; i++, index += 6) {
        uint32_t corner = i / SHEET_QUADS * side + i % SHEET_QUADS;
        const uint32_t two[6] = {corner, corner + 1, corner + side, corner + 1, corner + side + 1, corner + side};
        for (int k = 0; k < 6; k++)
            index[k] = two[k];
    }
    return amb_mesh_smooth_normals(*out, false, error);
}

static amb_status tiny_open(const bench_options *options, void **state, amb_error *error)
{
    triangles_state *s;
    amb_status status = create(SHEETS, state, &s, error);
    if (!status)
        status = picture_open(options, 1, &s->picture, error);
    if (!status)
        status = make_sheet(&s->mesh, error);
    if (status)
        return status;
    float fov = 0.62f, distance = 1.0f / (f_sin(fov * 0.5f) / f_cos(fov * 0.5f));
    amb_camera camera = amb_camera_look((v3){0, 0, distance}, (v3){0, 0, 0}, (v3){0, 1, 0}, fov, 0.5f, 20.0f,
                                        options->height, options->height); /* a sheet fills the window */
    for (int i = 0; i < SHEETS; i++)
        s->uniforms[i] = (plain_uniforms){.world_to_clip = camera.world_to_clip,
                                          .offset = {0, 0, 0.04f * (float)(i - 1)},
                                          .color = {0.9f - 0.3f * (float)i, 0.5f, 0.2f + 0.3f * (float)i},
                                          .to_sun = v3_normalize((v3){0.6f, 0.5f, 0.7f}),
                                          .scale = 1.0f,
                                          .mesh = s->mesh};
    return open_peer(s, error);
}

/* ---- shadow: a million triangles' depths ------------------------------------------------------------------------- */

static amb_status shadow_open(const bench_options *options, void **state, amb_error *error)
{
    triangles_state *s;
    amb_status status = create(1, state, &s, error);
    if (!status)
        status = picture_open_depth(options, options->quick ? SHADOW_SIZE / 2 : SHADOW_SIZE, &s->picture, error);
    if (!status)
        status = boulder_create(708, 707, &s->mesh, error);
    if (status)
        return status;
    s->depth_only = true;
    amb_camera light = amb_camera_look((v3){2.0f, 3.0f, 2.4f}, (v3){0, 0, 0}, (v3){0, 1, 0}, 0.55f, 0.5f, 20.0f, 1, 1);
    s->uniforms[0] =
        (plain_uniforms){.world_to_clip = light.world_to_clip, .to_sun = {0, 1, 0}, .scale = 1.0f, .mesh = s->mesh};
    return open_peer(s, error);
}

/* ---- draws: ten thousand spheres of 30 triangles; memory: a hundred of 100 000 ----------------------------------- */

static amb_status open_spheres(const bench_options *options, uint32_t count, int rings, int segments, float scale,
                               void **state, amb_error *error)
{
    triangles_state *s;
    amb_status status = create(count, state, &s, error);
    if (!status)
        status = picture_open(options, 1, &s->picture, error);
    if (!status)
        status = amb_mesh_sphere(rings, segments, &s->mesh, error);
    if (status)
        return status;
    amb_camera camera = amb_camera_look((v3){0, 0, 4}, (v3){0, 0, 0}, (v3){0, 1, 0}, 0.62f, 0.5f, 20.0f, options->width,
                                        options->height);
    for (uint32_t i = 0; i < count; i++) {
        float r[6];
        for (uint32_t k = 0; k < 6; k++)
            r[k] = amb_unit(amb_hash(6 * i + k));
        s->uniforms[i] = (plain_uniforms){.world_to_clip = camera.world_to_clip,
                                          .offset = {3.0f * r[0] - 1.5f, 2.2f * r[1] - 1.1f, 2.0f * r[2] - 1.0f},
                                          .color = {r[3], r[4], r[5]},
                                          .to_sun = v3_normalize((v3){0.6f, 0.8f, 0.5f}),
                                          .scale = scale,
                                          .mesh = s->mesh};
    }
    return open_peer(s, error);
}

static amb_status draws_open(const bench_options *options, void **state, amb_error *error)
{
    return open_spheres(options, DRAWS, 4, 5, 0.02f, state, error);
}

static amb_status memory_open(const bench_options *options, void **state, amb_error *error)
{
    return open_spheres(options, COPIES, 225, 224, 0.2f, state, error);
}

/* A line of /proc/self/status, in MiB. */
static double resident(const char *name)
{
    char line[200];
    long kib = 0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0)
            kib = strtol(line + strlen(name), NULL, 10);
    if (file)
        fclose(file);
    return (double)kib / 1024.0;
}

/* What the process grows by, at the most, while a pass of ever more triangles runs. */
static amb_status memory_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    static const char *const names[3] = {"peak of 100k triangles", "of 1M", "of 10M"};
    triangles_state *s = state;
    make_draws(s, context);
    for (size_t i = 0, draws = 1; i < 3; i++, draws *= 10) {
        amb_context *fresh = NULL; /* the other keeps the memory of the passes before */
        amb_context_options options = {amb_context_isa(context), amb_context_threads(context)};
        amb_status status = amb_context_create(&options, &fresh, error);
        if (status)
            return status;
        malloc_trim(0);
        FILE *reset = fopen("/proc/self/clear_refs", "w");
        if (reset) {
            fputs("5", reset); /* forget the peak */
            fclose(reset);
        }
        double before = resident("VmRSS:");
        status = picture_pass(&s->picture, fresh, s->draw, draws, error);
        amb_context_close(&fresh);
        if (status)
            return status;
        bench_fact(facts, names[i], resident("VmHWM:") - before, " MiB");
    }
    return AMB_OK;
}

#define TRIANGLES_WORKLOAD                                                                          \
    .run = triangles_run, .run_peer = triangles_run_peer, .difference = triangles_difference,       \
    .count = triangles_count, .facts = triangles_facts, .close = triangles_close, .peer_goal = 3.0, \
    .threads_goal = 1.9

const bench_workload bench_tiny = {
    .name = "tiny",
    .about = "1M triangles of 4.7 pixels: three wavy sheets, each across the window",
    .open = tiny_open,
    TRIANGLES_WORKLOAD,
};
const bench_workload bench_shadow = {
    .name = "shadow",
    .about = "depth only: 1M triangles into 2048x2048",
    .open = shadow_open,
    TRIANGLES_WORKLOAD,
};
const bench_workload bench_draws = {
    .name = "draws",
    .about = "10 000 draws with their own uniforms, 30 triangles each",
    .open = draws_open,
    TRIANGLES_WORKLOAD,
};
const bench_workload bench_memory = {
    .name = "memory",
    .about = "10M triangles in 100 draws, and what their pass takes of memory",
    .open = memory_open,
    .run = triangles_run,
    .count = triangles_count,
    .facts = memory_facts,
    .close = triangles_close,
    .threads_goal = 1.9,
};
