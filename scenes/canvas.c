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

/* An image of the canvas: at one sample a pixel the frame's own layer, where it has that one. */
static amb_status take_image(const amb_scene_job *job, const amb_canvas *canvas, const char *layer, int channels,
                             amb_image **out, amb_error *error)
{
    *out = canvas->factor == 1 ? amb_frame_layer(job->frame, layer) : NULL;
    return *out ? AMB_OK : amb_image_create(canvas->width, canvas->height, channels, out, error);
}
static void give_image(const amb_scene_job *job, const char *layer, amb_image **image)
{
    if (*image != amb_frame_layer(job->frame, layer))
        amb_image_close(image);
    *image = NULL;
}

static const char *layer_of(const amb_canvas *canvas, const amb_aov *aovs, int attachment)
{
    return attachment == 0 ? "color" : aovs[canvas->aov[attachment]].name;
}

static void canvas_close(const amb_scene_job *job, const amb_aov *aovs, amb_canvas *canvas)
{
    amb_pass_close(&canvas->pass);
    give_image(job, "depth", &canvas->depth);
    for (int i = 0; i < canvas->count; i++)
        give_image(job, layer_of(canvas, aovs, i), &canvas->image[i]);
    canvas->count = 0;
}

static amb_status create_images(const amb_scene_job *job, const amb_aov *aovs, size_t aov_count, amb_canvas *canvas,
                                amb_error *error)
{
    amb_status status = take_image(job, canvas, "depth", 1, &canvas->depth, error);
    if (status == AMB_OK)
        status = take_image(job, canvas, "color", 4, &canvas->image[canvas->count++], error);
    for (size_t i = 0; i < aov_count && status == AMB_OK; i++) {
        if (strcmp(aovs[i].name, "depth") == 0 || !amb_frame_layer(job->frame, aovs[i].name))
            continue;
        if (canvas->count == AMB_MAX_TARGETS)
            return amb_fail(error, AMB_ERROR_LIMIT, "AOVs: at most %d at once besides depth", AMB_MAX_TARGETS - 1);
        canvas->slot[i] = canvas->count;
        canvas->aov[canvas->count] = (int)i;
        status = take_image(job, canvas, aovs[i].name, aovs[i].channels, &canvas->image[canvas->count++], error);
    }
    return status;
}

amb_status canvas_begin(const amb_scene_job *job, const amb_aov *aovs, size_t aov_count, int factor, amb_canvas *canvas,
                        amb_error *error)
{
    *canvas = (amb_canvas){.factor = factor, .width = job->width * factor, .height = job->height * factor};
    amb_status status = create_images(job, aovs, aov_count, canvas, error);
    if (status == AMB_OK) {
        amb_target target = {.depth = canvas->depth, .clear_depth = 1.0f, .time_stages = job->stats != NULL};
        for (int i = 0; i < canvas->count; i++)
            target.color[i] = canvas->image[i];
        status = amb_pass_begin(job->context, &target, &canvas->pass, error);
    }
    if (status != AMB_OK)
        canvas_close(job, aovs, canvas);
    return status;
}

void canvas_add_stats(const amb_scene_job *job, const amb_pass_stats *stats)
{
    amb_pass_stats *sum = job->stats;
    if (!sum)
        return;
    sum->vertices += stats->vertices;
    sum->patches += stats->patches;
    sum->patches_culled += stats->patches_culled;
    sum->domain_points += stats->domain_points;
    sum->geometry_in += stats->geometry_in;
    sum->geometry_vertices += stats->geometry_vertices;
    sum->triangles_in += stats->triangles_in;
    sum->triangles_clipped += stats->triangles_clipped;
    sum->triangles_culled += stats->triangles_culled;
    sum->triangles_binned += stats->triangles_binned;
    sum->blocks_shaded += stats->blocks_shaded;
    sum->fragments_shaded += stats->fragments_shaded;
    for (int i = 0; i < AMB_STAGES; i++)
        sum->ticks[i] += stats->ticks[i];
}

amb_status canvas_finish(const amb_scene_job *job, const amb_aov *aovs, amb_canvas *canvas, amb_status status,
                         amb_error *error)
{
    amb_pass_stats stats = {0};
    if (status == AMB_OK)
        status = amb_pass_finish(&canvas->pass, &stats, error);
    canvas_add_stats(job, &stats);
    if (status == AMB_OK && canvas->factor > 1) {
        for (int i = 0; i < canvas->count; i++) {
            const char *name = layer_of(canvas, aovs, i);
            amb_supersample_resolve(job->context, canvas->image[i], amb_frame_layer(job->frame, name), canvas->factor,
                                    mixes(name));
        }
        amb_image *depth = amb_frame_layer(job->frame, "depth");
        if (depth)
            amb_supersample_resolve(job->context, canvas->depth, depth, canvas->factor, false);
    }
    canvas_close(job, aovs, canvas);
    return status;
}
