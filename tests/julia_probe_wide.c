/* Distance and surface of Julia sets at listed points, for test_julia.c. */
#include "tests/julia_probe.h"

void WIDE(probe_julia)(const julia_set *set, const v3 *point, int count, julia_probed *out)
{
    for (int first = 0; first < count; first += AMB_LANES) {
        float x[AMB_LANES] = {0}, y[AMB_LANES] = {0}, z[AMB_LANES] = {0};
        for (int i = 0; i < AMB_LANES && first + i < count; i++) {
            x[i] = point[first + i].x;
            y[i] = point[first + i].y;
            z[i] = point[first + i].z;
        }
        v3x p = {f_load(x), f_load(y), f_load(z)};
        f32x distance = julia_distance(p, set);
        julia_surface surface = julia_surface_at(p, set);
        for (int i = 0; i < AMB_LANES && first + i < count; i++)
            out[first + i] = (julia_probed){f_lane(distance, i), f_lane(surface.trap, i), v3x_lane(surface.normal, i)};
    }
}
