/* Jupiter's key frames and velocity map from any still map of it, a photograph or a painting. */
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/giants.h"
#include "scenes/builtin/paint.h"

#include <ambiance/math.h>
#include <stdlib.h>

AMB_DECLARE_WIDE(v4x, amb_jupiter_key, (v3x direction, const void *still));
AMB_DECLARE_WIDE(v4x, amb_jupiter_velocity, (v3x direction, const void *still));

enum { COLUMNS = 256, ROWS = 128, MEAN_ROWS = 1024 };
static const amb_sampler smooth = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};

/* Level of detail at which a map is `columns` texels wide. */
static float level_of(const amb_texture *map, int columns)
{
    return f_max(f_log2((float)amb_texture_describe(map).width / (float)columns), 0.0f);
}

/* How much redder than the rest of its latitude the map is: ROWS × COLUMNS. */
static void redness(const amb_texture *map, float *out)
{
    float level = level_of(map, COLUMNS);
    for (int y = 0; y < ROWS; y++) {
        float mean = 0.0f;
        for (int x = 0; x < COLUMNS; x++) {
            v2x uv = {((float)x + 0.5f) / COLUMNS, ((float)y + 0.5f) / ROWS};
            v4x c = amb_sample_2d_lod(map, &smooth, uv, level);
            out[y * COLUMNS + x] = (c.x - c.z) / (c.x + c.y + c.z + 1.0e-3f);
            mean += out[y * COLUMNS + x];
        }
        for (int x = 0; x < COLUMNS; x++)
            out[y * COLUMNS + x] -= mean / COLUMNS;
    }
}

/* The middle of the reddest area of the spot's size between 12° and 32° south. */
static amb_status find_spot(const amb_texture *map, v3 *out, amb_error *error)
{
    const int wide = 8, high = 5; /* half its size in cells */
    const int first = ROWS * (90 + 12) / 180, last = ROWS * (90 + 32) / 180;
    float best = -1.0e9f;
    int best_x = 0, best_y = first;
    float *red = malloc(sizeof *red * ROWS * COLUMNS);
    if (!red)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for Jupiter's key frames");
    redness(map, red);
    for (int y = first; y <= last; y++)
        for (int x = 0; x < COLUMNS; x++) {
            float sum = 0.0f;
            for (int j = -high; j <= high; j++)
                for (int i = -wide; i <= wide; i++)
                    sum += red[(y + j) * COLUMNS + (x + i + COLUMNS) % COLUMNS];
            if (sum > best)
                best = sum, best_x = x, best_y = y;
        }
    free(red);
    float longitude = (((float)best_x + 0.5f) * (2.0f / COLUMNS) - 1.0f) * AMB_PI;
    float polar = ((float)best_y + 0.5f) * (AMB_PI / ROWS), sine = amb_sin(polar);
    *out = (v3){sine * amb_sin(longitude), amb_cos(polar), -(sine * amb_cos(longitude))};
    return AMB_OK;
}

static amb_status zonal_means(const amb_texture *map, amb_texture **out, amb_error *error)
{
    amb_image *image = NULL;
    float level = level_of(map, MEAN_ROWS);
    amb_status status = amb_image_create(1, MEAN_ROWS, 4, &image, error);
    for (int y = 0; y < MEAN_ROWS && status == AMB_OK; y++) {
        v3 sum = {0, 0, 0};
        for (int x = 0; x < COLUMNS; x++) {
            v2x uv = {((float)x + 0.5f) / COLUMNS, ((float)y + 0.5f) / MEAN_ROWS};
            v4x c = amb_sample_2d_lod(map, &smooth, uv, level);
            sum = v3_add(sum, (v3){c.x, c.y, c.z});
        }
        amb_image_row(image, 0, y)[0] = sum.x / COLUMNS;
        amb_image_row(image, 1, y)[0] = sum.y / COLUMNS;
        amb_image_row(image, 2, y)[0] = sum.z / COLUMNS;
        amb_image_row(image, 3, y)[0] = 1.0f;
    }
    if (status == AMB_OK)
        status = amb_texture_from_image(image, AMB_TEXEL_RGBA32F, false, out, error);
    amb_image_close(&image);
    return status;
}

amb_status jupiter_still_open(const amb_texture *map, jupiter_still *out, amb_texture **zonal, amb_error *error)
{
    *out = (jupiter_still){.map = map};
    *zonal = NULL;
    amb_status status = find_spot(map, &out->spot, error);
    if (status == AMB_OK)
        status = zonal_means(map, zonal, error);
    out->zonal = *zonal;
    return status;
}

static amb_status key_frame(const amb_context *context, const amb_texture *map, int key, amb_texture **out,
                            amb_error *error)
{
    jupiter_still still;
    amb_texture *zonal;
    amb_texture_info info = amb_texture_describe(map);
    amb_status status = jupiter_still_open(map, &still, &zonal, error);
    still.key = (float)key;
    if (status == AMB_OK)
        status =
            amb_map_paint(context, info.width, info.height, 1, AMB_DISPATCH(amb_context_isa(context), amb_jupiter_key),
                          &still, AMB_TEXEL_SRGB8_A8, out, error);
    amb_texture_close(&zonal);
    return status;
}

#define KEY(NUMBER)                                                                                  \
    amb_status amb_builtin_jupiter_key##NUMBER(const amb_context *context, const amb_texture *still, \
                                               amb_texture **out, amb_error *error)                  \
    {                                                                                                \
        return key_frame(context, still, NUMBER, out, error);                                        \
    }
KEY(1)
KEY(2)
KEY(3)
KEY(4)

amb_status amb_builtin_jupiter_velocity(const amb_context *context, const amb_texture *map, amb_texture **out,
                                        amb_error *error)
{
    jupiter_still still = {.map = map};
    amb_status status = find_spot(map, &still.spot, error);
    if (status == AMB_OK)
        status = amb_map_paint(context, 1024, 512, 1, AMB_DISPATCH(amb_context_isa(context), amb_jupiter_velocity),
                               &still, AMB_TEXEL_R16F, out, error);
    return status;
}
