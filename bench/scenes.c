/* Every scene of the registry: ms a frame with one thread and with all, and the share of each stage of its passes. */
#include "bench/bench.h"

#include <ambiance/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX_FRAMES = 15 };

typedef struct scene_row {
    double load, one, all; /* seconds: loading, and the medians of frames */
    amb_pass_stats stats;  /* of one frame */
} scene_row;

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static amb_status time_frames(const amb_scene *scene, const void *state, amb_scene_job job,
                              const amb_context *const context[2], int frames, scene_row *row, amb_error *error)
{
    double seconds[2][MAX_FRAMES];
    amb_status status = AMB_OK;
    for (int i = -1; i < frames && !status; i++) /* the first warms up */
        for (int k = 0; k < 2 && !status; k++) {
            job.context = context[k];
            double start = bench_seconds();
            status = scene->frame(state, &job, error);
            if (i >= 0)
                seconds[k][i] = bench_seconds() - start;
        }
    for (int k = 0; k < 2; k++)
        qsort(seconds[k], (size_t)frames, sizeof seconds[k][0], by_value);
    row->one = seconds[0][frames / 2];
    row->all = seconds[1][frames / 2];
    job.stats = &row->stats;
    return status ? status : scene->frame(state, &job, error);
}

static amb_status measure(const amb_scene *scene, const amb_context *const context[2], const bench_options *options,
                          int frames, scene_row *row, amb_error *error)
{
    amb_assets *assets = NULL;
    amb_frame *frame = NULL;
    void *state = NULL, *params = calloc(1, scene->params.size);
    amb_status status = params ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "no memory for %s", scene->name);
    if (!status)
        status = amb_assets_create(context[1], &(amb_assets_options){.builtin_only = true}, &assets, error);
    if (!status)
        status = amb_frame_create(options->width, options->height, &frame, error);
    double start = bench_seconds();
    if (!status)
        status = scene->load(context[1], assets, &state, error);
    row->load = bench_seconds() - start;
    if (!status) {
        amb_params_defaults(&scene->params, params);
        amb_scene_job job = {.params = params,
                             .time = (double)(0.3f * scene->seconds),
                             .width = options->width,
                             .height = options->height,
                             .frame = frame};
        status = time_frames(scene, state, job, context, frames, row, error);
    }
    if (state)
        scene->unload(state);
    amb_frame_close(&frame);
    amb_assets_close(&assets);
    free(params);
    return status;
}

static double share(const scene_row *row, int stage)
{
    double all = 0.0;
    for (int i = 0; i < AMB_STAGES; i++)
        all += (double)row->stats.ticks[i];
    return all > 0.0 ? 100.0 * (double)row->stats.ticks[stage] / all : 0.0;
}

static void print_row(const amb_scene *scene, const scene_row *row)
{
    printf("  %-13s %8.0f %9.1f %9.1f %6.2fx %8.1f ", scene->name, row->load * 1e3, row->one * 1e3, row->all * 1e3,
           row->one / row->all, (double)row->stats.fragments_shaded * 1e-6);
    for (int i = 0; i < AMB_STAGES; i++)
        printf(" %9.0f%%", share(row, i));
    printf("\n");
    fflush(stdout);
}

static void print_json(const amb_scene *scene, const scene_row *row, bool first)
{
    printf("%s\n    {\"name\": \"%s\", \"load_s\": %.6g, \"one_thread_s\": %.6g, \"all_threads_s\": %.6g, "
           "\"fragments\": %.6g",
           first ? "" : ",", scene->name, row->load, row->one, row->all, (double)row->stats.fragments_shaded);
    for (int i = 0; i < AMB_STAGES; i++)
        printf(", \"%s\": %.4g", amb_stage_name((amb_stage)i), share(row, i));
    printf("}");
}

int bench_scenes(const bench_options *options, int frames, bool json)
{
    amb_context *one = NULL, *all = NULL;
    amb_error error = {0};
    int failed = 0;
    frames = frames < MAX_FRAMES ? frames : MAX_FRAMES;
    if (amb_context_create(&(amb_context_options){.threads = 1}, &one, &error) ||
        amb_context_create(&(amb_context_options){.threads = options->threads}, &all, &error)) {
        fprintf(stderr, "ambiance-bench: scenes: %s\n", error.detail);
        amb_context_close(&one);
        return 1;
    }
    const amb_context *const context[2] = {one, all};
    if (!json) {
        printf("\nscenes: default parameters, built-in assets, without post, %s, median of %d; stages' shares of the "
               "time in passes\n  %-13s %8s %9s %6s %2d %7s %8s ",
               amb_isa_name(amb_context_isa(all)), frames, "", "load ms", "1 thread", "", options->threads, "",
               "Mfrags");
        for (int i = 0; i < AMB_STAGES; i++)
            printf(" %10s", amb_stage_name((amb_stage)i));
        printf("\n");
    }
    for (int i = 0; i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(amb_context_isa(all), i);
        scene_row row = {0};
        if (measure(scene, context, options, frames, &row, &error)) {
            fprintf(stderr, "ambiance-bench: scene %s: %s\n", scene->name, error.detail);
            failed = 1;
        } else if (json) {
            print_json(scene, &row, i == 0);
        } else {
            print_row(scene, &row);
        }
    }
    amb_context_close(&one);
    amb_context_close(&all);
    return failed;
}
