#include "core/isosurface_wide.h"

#include <ambiance/isosurface.h>

void WIDE(amb_iso_values)(const struct amb_isosurface_desc *desc, const amb_iso_points *points, float *out)
{
    for (int i = 0; i < points->count; i += AMB_LANES) {
        v3x p = {f_load(points->x + i), f_load(points->y + i), f_load(points->z + i)};
        f_store(out + i, desc->field(desc->user, p));
    }
}
