/* Evaluating a field at lists of points, in packets of the field's own lanes. */
#ifndef AMB_CORE_ISOSURFACE_WIDE_H
#define AMB_CORE_ISOSURFACE_WIDE_H

#include "core/dispatch.h"

#define AMB_ISO_POINTS 4096 /* a multiple of every number of lanes */

/* After `count` the list is padded, by whoever evaluates it, with copies of point 0 up to a multiple of 16. */
typedef struct amb_iso_points {
    int count;
    float x[AMB_ISO_POINTS], y[AMB_ISO_POINTS], z[AMB_ISO_POINTS];
} amb_iso_points;

struct amb_isosurface_desc;
AMB_DECLARE_WIDE(void, amb_iso_values,
                 (const struct amb_isosurface_desc *desc, const amb_iso_points *points, float *out));
void amb_iso_values_x1(const struct amb_isosurface_desc *desc, const amb_iso_points *points, float *out);

#endif
