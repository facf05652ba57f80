/* A loaded scene, its parameters and its assets: amb_show_* of scene.h. */
#include <ambiance/scene.h>

#include "core/names.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct amb_show {
    const amb_context *context;
    const amb_scene *scene;
    void *params; /* scene->params.size bytes */
    void *state;  /* the scene's, from load */
    char owner[80];
    char assets_sha256[65];
};

static const char *scene_name(const void *user, int index)
{
    return amb_scene_by_index(*(const amb_isa *)user, index)->name;
}

amb_status amb_show_open(const amb_context *context, amb_assets *assets, const char *scene, amb_show **out,
                         amb_error *error)
{
    *out = NULL;
    amb_isa isa = amb_context_isa(context);
    const amb_scene *found = amb_scene_by_name(isa, scene);
    char hint[320];
    if (!found)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "unknown scene: %s; %s", scene,
                        amb_names_hint(scene, amb_scene_count(), scene_name, &isa, hint, sizeof hint));

    amb_status status = AMB_OK;
    amb_show *show = calloc(1, sizeof *show);
    if (show)
        show->params = calloc(1, found->params.size ? found->params.size : 1);
    if (!show || !show->params) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "scene %s: out of memory", found->name);
        goto error;
    }
    show->context = context;
    show->scene = found;
    snprintf(show->owner, sizeof show->owner, "scene %s", found->name);
    amb_params_defaults(&found->params, show->params);
    if (found->load && (status = found->load(context, assets, &show->state, error)) != AMB_OK)
        goto error;
    if (assets)
        amb_assets_digest(assets, show->assets_sha256);
    *out = show;
    return AMB_OK;

error:
    amb_show_close(&show);
    return status;
}

amb_status amb_show_set(amb_show *show, const char *name, const char *value, amb_error *error)
{
    return amb_params_set(&show->scene->params, show->params, show->owner, name, value, error);
}

static const char *aov_name(const void *user, int index) { return ((const amb_scene *)user)->aovs[index].name; }

amb_status amb_scene_choose_aovs(const amb_scene *scene, const char *const *names, bool *wanted, amb_error *error)
{
    for (; names && *names; names++) {
        bool is_all = strcmp(*names, "all") == 0, is_known = is_all;
        for (size_t i = 0; i < scene->aov_count; i++) {
            bool is_this = strcmp(*names, scene->aovs[i].name) == 0;
            if (wanted)
                wanted[i] |= is_all || is_this;
            is_known |= is_this;
        }
        char hint[320];
        if (!is_known)
            return amb_fail(error, AMB_ERROR_NOT_FOUND, "scene %s: unknown AOV: %s; %s", scene->name, *names,
                            amb_names_hint(*names, (int)scene->aov_count, aov_name, scene, hint, sizeof hint));
    }
    return AMB_OK;
}

/* Every parameter as name=value, space separated, in table order; NULL when out of memory. */
static char *describe_params(const amb_scene *scene, const void *values)
{
    const amb_params *params = &scene->params;
    char value[256];
    size_t size = 1, used = 0;
    for (size_t i = 0; i < params->count; i++)
        size += strlen(params->table[i].name) + 2 + (size_t)amb_params_print(&params->table[i], values, NULL, 0);
    char *text = malloc(size);
    if (!text)
        return NULL;
    text[0] = '\0';
    for (size_t i = 0; i < params->count; i++) {
        amb_params_print(&params->table[i], values, value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s=%s", i ? " " : "", params->table[i].name, value);
    }
    return text;
}

static amb_status describe_frame(const amb_show *show, double time, amb_frame *frame, amb_error *error)
{
    amb_metadata *meta = &frame->meta;
    snprintf(meta->scene, sizeof meta->scene, "%s", show->scene->name);
    snprintf(meta->version, sizeof meta->version, "%s", amb_version());
    memcpy(meta->assets_sha256, show->assets_sha256, sizeof meta->assets_sha256);
    meta->time = time;
    meta->parameters = describe_params(show->scene, show->params);
    if (!meta->parameters)
        return amb_fail(error, AMB_ERROR_MEMORY, "%s: out of memory", show->owner);
    return AMB_OK;
}

amb_status amb_show_render(const amb_show *show, double time, int width, int height, const char *const *aovs,
                           amb_frame **out, amb_error *error)
{
    const amb_scene *scene = show->scene;
    bool wanted[AMB_MAX_LAYERS] = {false};
    amb_frame *frame = NULL;
    amb_image *image;
    *out = NULL;

    if (!isfinite(time))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "%s: time: %g; any finite number of seconds is allowed", show->owner,
                        time);
    if (scene->aov_count >= AMB_MAX_LAYERS)
        return amb_fail(error, AMB_ERROR_LIMIT, "%s: %zu AOVs; at most %d are allowed", show->owner, scene->aov_count,
                        AMB_MAX_LAYERS - 1);
    amb_status status = amb_scene_choose_aovs(scene, aovs, wanted, error);
    if (status == AMB_OK)
        status = amb_frame_create(width, height, &frame, error);
    for (size_t i = 0; status == AMB_OK && i < scene->aov_count; i++)
        if (wanted[i])
            status = amb_frame_add_layer(frame, scene->aovs[i].name, scene->aovs[i].channels, &image, error);
    if (status == AMB_OK)
        status = describe_frame(show, time, frame, error);
    if (status != AMB_OK)
        goto error;

    amb_scene_job job = {.context = show->context,
                         .params = show->params,
                         .time = time,
                         .width = width,
                         .height = height,
                         .frame = frame};
    if ((status = scene->frame(show->state, &job, error)) != AMB_OK)
        goto error;
    *out = frame;
    return AMB_OK;

error:
    amb_frame_close(&frame);
    return status;
}

const amb_scene *amb_show_scene(const amb_show *show) { return show->scene; }

void amb_show_close(amb_show **show)
{
    if (!show || !*show)
        return;
    if ((*show)->scene && (*show)->scene->unload && (*show)->state)
        (*show)->scene->unload((*show)->state);
    free((*show)->params);
    free(*show);
    *show = NULL;
}
