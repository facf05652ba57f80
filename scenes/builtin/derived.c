/* Maps made from other maps, for planets of which the pack or the user has not all. */
#include "scenes/builtin/builtin.h"
#include "scenes/planet.h"
#include "shade/color.h"

#include <ambiance/math.h>

typedef struct brightness_rows {
    const amb_texture *colour;
    amb_image *image;
} brightness_rows;

static void brightness_row(void *user, int y, int thread)
{
    (void)thread;
    static const amb_sampler nearest = {.filter = AMB_NEAREST};
    const brightness_rows *job = user;
    float *row = amb_image_row(job->image, 0, y);
    for (int x = 0; x < job->image->width; x++) {
        v2x uv = {((float)x + 0.5f) / (float)job->image->width, ((float)y + 0.5f) / (float)job->image->height};
        row[x] = color_luminance(v4x_xyz(amb_sample_2d_lod(job->colour, &nearest, uv, 0.0f)));
    }
}

amb_status amb_builtin_brightness(const amb_context *context, const amb_texture *colour, amb_texture **out,
                                  amb_error *error)
{
    amb_texture_info info = amb_texture_describe(colour);
    brightness_rows job = {.colour = colour};
    *out = NULL;
    amb_status status = amb_image_create(info.width, info.height, 1, &job.image, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, brightness_row, &job);
        status = amb_texture_from_image(job.image, AMB_TEXEL_R16F, true, out, error);
    }
    amb_image_close(&job.image);
    return status;
}

amb_status amb_builtin_mars_relief(const amb_context *context, const amb_texture *height, amb_texture **out,
                                   amb_error *error)
{
    const amb_normal_map_options relief = {
        .strength = 26.0f, .octaves = 3, .gain = 1.0f, .wrap_u = true, .longitude_latitude = true};
    return planet_normal_texture(context, height, &relief, true, out, error);
}
