#include "scenes/builtin/tile.h"

void WIDE(amb_tile_row_lanes)(const amb_tile_row *row);

void WIDE(amb_tile_row_lanes)(const amb_tile_row *row)
{
    float step = 1.0f / (float)row->image->width;
    f32x v = f_set(((float)row->y + 0.5f) * step);
    for (int x = 0; x < row->image->width; x += AMB_LANES) { /* the width is a multiple of 16 */
        v4x c = row->field((v2x){(i_to_f(i_lane_index() + x) + 0.5f) * step, v});
        f_store(amb_image_row(row->image, 0, row->y) + x, c.x);
        f_store(amb_image_row(row->image, 1, row->y) + x, c.y);
        f_store(amb_image_row(row->image, 2, row->y) + x, c.z);
        f_store(amb_image_row(row->image, 3, row->y) + x, c.w);
    }
}
