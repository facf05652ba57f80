/* The landscape's built-in maps: heights, ground textures. */
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/tile.h"

enum { HEIGHT_SIZE = 2048, GROUND_SIZE = 1024 };

AMB_DECLARE_WIDE(void, amb_tile_row_lanes, (const amb_tile_row *row));

typedef struct tile_job {
    amb_image *image;
    amb_tile_field field;
    void (*row)(const amb_tile_row *row);
} tile_job;

static void paint_row(void *user, int y, int thread)
{
    (void)thread;
    const tile_job *job = user;
    job->row(&(amb_tile_row){job->image, y, job->field});
}

amb_status amb_tile_paint(const amb_context *context, int size, amb_tile_field field, amb_texel texel,
                          amb_texture **out, amb_error *error)
{
    tile_job job = {.field = field, .row = AMB_DISPATCH(amb_context_isa(context), amb_tile_row_lanes)};
    *out = NULL;
    amb_status status = amb_image_create(size, size, 4, &job.image, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, size, paint_row, &job);
        status = amb_texture_from_image(job.image, texel, true, out, error);
    }
    amb_image_close(&job.image);
    return status;
}

/* amb_builtin_NAME paints amb_NAME. */
#define MAP(NAME, SIZE, TEXEL)                                                                                       \
    AMB_DECLARE_WIDE(v4x, amb_##NAME, (v2x uv));                                                                     \
    amb_status amb_builtin_##NAME(const amb_context *context, amb_texture **out, amb_error *error)                   \
    {                                                                                                                \
        return amb_tile_paint(context, SIZE, AMB_DISPATCH(amb_context_isa(context), amb_##NAME), TEXEL, out, error); \
    }

MAP(hills_noise, 512, AMB_TEXEL_RGBA8)
MAP(hills, HEIGHT_SIZE, AMB_TEXEL_R32F)
MAP(ground_grass, GROUND_SIZE, AMB_TEXEL_SRGB8_A8)
MAP(ground_rock, GROUND_SIZE, AMB_TEXEL_SRGB8_A8)
MAP(ground_sand, GROUND_SIZE, AMB_TEXEL_SRGB8_A8)
MAP(ground_snow, GROUND_SIZE, AMB_TEXEL_SRGB8_A8)
