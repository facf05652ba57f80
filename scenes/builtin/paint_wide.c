#include "scenes/builtin/paint.h"

#include "core/dispatch.h"
#include "scenes/builtin/cube_face.h"
#include <ambiance/math.h>

AMB_DECLARE_WIDE(void, amb_paint_row_lanes, (const amb_paint_row *row));
AMB_DECLARE_WIDE(v4x, amb_panorama_radiance, (v3x direction, const void *panorama));

/* Direction through (x, y) of a map, in pixels. */
static v3x map_direction(f32x x, f32x y, const amb_image *image)
{
    f32x longitude = (x * (2.0f / (float)image->width) - 1.0f) * AMB_PI;
    f32x polar = y * (AMB_PI / (float)image->height);
    f32x sine = f_sin(polar);
    return (v3x){sine * f_sin(longitude), f_cos(polar), -(sine * f_cos(longitude))};
}

static v3x surface_direction(const amb_paint_row *row, f32x x, f32x y)
{
    if (row->surface == AMB_PAINT_MAP)
        return map_direction(x, y, row->image);
    return cube_face_direction(row->surface, cube_face_coordinate(x, row->image->width),
                               cube_face_coordinate(y, row->image->width));
}

void WIDE(amb_paint_row_lanes)(const amb_paint_row *row)
{
    float step = 1.0f / (float)row->samples;
    float weight = step * step;
    for (int x = 0; x < row->image->width; x += AMB_LANES) { /* rows are padded to 16 */
        f32x column = i_to_f(i_lane_index() + x);
        v4x sum = v4x_splat((v4){0, 0, 0, 0});
        for (int j = 0; j < row->samples; j++)
            for (int i = 0; i < row->samples; i++) {
                f32x at_x = column + ((float)i + 0.5f) * step;
                f32x at_y = f_set((float)row->y + ((float)j + 0.5f) * step);
                sum = v4x_add(sum, row->field(surface_direction(row, at_x, at_y), row->user));
            }
        f32x most = f_set(65504.0f);
        f_store(amb_image_row(row->image, 0, row->y) + x, f_min(sum.x * weight, most));
        f_store(amb_image_row(row->image, 1, row->y) + x, f_min(sum.y * weight, most));
        f_store(amb_image_row(row->image, 2, row->y) + x, f_min(sum.z * weight, most));
        f_store(amb_image_row(row->image, 3, row->y) + x, f_min(sum.w * weight, most));
    }
}

/* The centre of the panorama looks along -z, +x is to its right, the top row is +y. */
v4x WIDE(amb_panorama_radiance)(v3x direction, const void *panorama)
{
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    v2x uv = {f_atan2(direction.x, -direction.z) * (0.5f * AMB_INV_PI) + 0.5f,
              f_acos(f_clamp(direction.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI};
    return amb_sample_2d_lod(panorama, &sampler, uv, f_set(0.0f));
}
