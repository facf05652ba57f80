#include "scenes/canvas.h"

#include "scenes/supersample.h"

#include <string.h>

static bool mixes(const char *aov)
{
    static const char *const whole[] = {"depth", "position", "normal", "id"};
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++)
        if (strcmp(aov, whole[i]) == 0)
            return false;
    return true;
}

static void canvas_close(amb_canvas *canvas)
{
    amb_pass_close(&canvas->pass);
    amb_image_close(&canvas->depth);
    for (int i = 0; i < canvas->count; i++)
        amb_image_close(&canvas->image[i]);
    canvas->count = 0;
}

static amb_status create_images(const amb_scene_job *job, const amb_aov *aovs, size_t aov_count, amb_canvas *canvas,
                                amb_error *error)
{
    amb_status status = amb_image_create(canvas->width, canvas->height, 1, &canvas->depth, error);
    if (status == AMB_OK)
        status = amb_image_create(canvas->width, canvas->height, 4, &canvas->image[canvas->count++], error);
    for (size_t i = 0; i < aov_count && status == AMB_OK; i++) {
        if (strcmp(aovs[i].name, "depth") == 0 || !amb_frame_layer(job->frame, aovs[i].name))
            continue;
        if (canvas->count == AMB_MAX_TARGETS)
            return amb_fail(error, AMB_ERROR_LIMIT, "AOVs: at most %d at once besides depth", AMB_MAX_TARGETS - 1);
        canvas->slot[i] = canvas->count;
        canvas->aov[canvas->count] = (int)i;
        status =
            amb_image_create(canvas->width, canvas->height, aovs[i].channels, &canvas->image[canvas->count++], error);
    }
    return status;
}

amb_status canvas_begin(const amb_scene_job *job, const amb_aov *aovs, size_t aov_count, int factor, amb_canvas *canvas,
                        amb_error *error)
{
    *canvas = (amb_canvas){.factor = factor, .width = job->width * factor, .height = job->height * factor};
    amb_status status = create_images(job, aovs, aov_count, canvas, error);
    if (status == AMB_OK) {
        amb_target target = {.depth = canvas->depth, .clear_depth = 1.0f};
        for (int i = 0; i < canvas->count; i++)
            target.color[i] = canvas->image[i];
        status = amb_pass_begin(job->context, &target, &canvas->pass, error);
    }
    if (status != AMB_OK)
        canvas_close(canvas);
    return status;
}

amb_status canvas_finish(const amb_scene_job *job, const amb_aov *aovs, amb_canvas *canvas, amb_status status,
                         amb_error *error)
{
    if (status == AMB_OK)
        status = amb_pass_finish(&canvas->pass, NULL, error);
    if (status == AMB_OK) {
        amb_supersample_resolve(job->context, canvas->image[0], amb_frame_layer(job->frame, "color"), canvas->factor,
                                true);
        for (int i = 1; i < canvas->count; i++) {
            const char *name = aovs[canvas->aov[i]].name;
            amb_supersample_resolve(job->context, canvas->image[i], amb_frame_layer(job->frame, name), canvas->factor,
                                    mixes(name));
        }
        amb_image *depth = amb_frame_layer(job->frame, "depth");
        if (depth)
            amb_supersample_resolve(job->context, canvas->depth, depth, canvas->factor, false);
    }
    canvas_close(canvas);
    return status;
}
