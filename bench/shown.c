#include "bench/shown.h"

#include <stdlib.h>

amb_status shown_open(const char *name, double time, const bench_options *options, shown *out, amb_error *error)
{
    *out = (shown){.name = name, .time = time, .width = options->width, .height = options->height};
    amb_status status = amb_context_create(NULL, &out->loader, error);
    if (!status)
        status = amb_assets_create(out->loader, &(amb_assets_options){.builtin_only = true}, &out->assets, error);
    if (!status)
        status = amb_frame_create(out->width, out->height, &out->frame, error);
    if (status)
        return status;
    const amb_scene *scene = amb_scene_by_name(amb_context_isa(out->loader), name);
    if (!scene)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "the scene %s is not in this build", name);
    out->params = calloc(1, scene->params.size);
    if (!out->params)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the %s workload", name);
    amb_params_defaults(&scene->params, out->params);
    return AMB_OK;
}

void shown_close(shown *s)
{
    for (int i = 0; i < s->loaded_count; i++)
        s->loaded[i].scene->unload(s->loaded[i].state);
    amb_assets_close(&s->assets);
    amb_context_close(&s->loader);
    amb_frame_close(&s->frame);
    free(s->params);
    *s = (shown){0};
}

amb_status shown_load(shown *s, const amb_context *context, const amb_scene **scene, void **state, amb_error *error)
{
    int i = 0;
    *scene = amb_scene_by_name(amb_context_isa(context), s->name);
    while (i < s->loaded_count && s->loaded[i].scene != *scene)
        i++;
    if (i == s->loaded_count) {
        amb_status status = (*scene)->load(context, s->assets, &s->loaded[i].state, error);
        if (status)
            return status;
        s->loaded[i].scene = *scene;
        s->loaded_count++;
    }
    *state = s->loaded[i].state;
    return AMB_OK;
}

amb_status shown_run(shown *s, const amb_context *context, amb_pass_stats *stats, amb_error *error)
{
    const amb_scene *scene;
    void *state;
    amb_status status = shown_load(s, context, &scene, &state, error);
    amb_scene_job job = {.context = context,
                         .params = s->params,
                         .time = s->time,
                         .width = s->width,
                         .height = s->height,
                         .frame = s->frame,
                         .stats = stats};
    return status ? status : scene->frame(state, &job, error);
}

amb_status shown_difference(const shown *s, const gl_target *target, double *rmse, amb_error *error)
{
    float *pixels = malloc((size_t)s->width * (size_t)s->height * 4 * sizeof *pixels);
    if (!pixels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    gl_read(target, pixels);
    *rmse = bench_rmse(s->frame->layer[0].image, pixels);
    free(pixels);
    return gl_check(error);
}
