/* Every distance function at a list of points, one variant an instruction set. */
#ifndef AMB_TESTS_SDF_PROBE_WIDE_H
#define AMB_TESTS_SDF_PROBE_WIDE_H

#include <ambiance/vec.h>

#define PROBE_FUNCTIONS 17

/* value[f·count + i]: function f at point i; count a multiple of 16. */
void sdf_probe_x1(const float *x, const float *y, const float *z, int count, float *value);
void sdf_probe_x4(const float *x, const float *y, const float *z, int count, float *value);
void sdf_probe_x8(const float *x, const float *y, const float *z, int count, float *value);
void sdf_probe_x16(const float *x, const float *y, const float *z, int count, float *value);

#endif
