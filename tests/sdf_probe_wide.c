#include "tests/sdf_probe_wide.h"

#include <ambiance/sdf.h>

static void at_point(v3x p, f32x value[PROBE_FUNCTIONS])
{
    const v3 a = {-0.4f, -0.3f, 0.1f}, b = {0.5f, 0.2f, -0.3f}, c = {-0.1f, 0.6f, 0.4f};
    const sdf_frame frame = {{0.1f, -0.2f, 0.3f}, {0.8f, 0.6f, 0.0f}, {-0.6f, 0.8f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    sdf_curve curve = sdf_bezier(p, a, b, c);
    v3x twisted = sdf_twist(p, 2.5f), moved = sdf_to_frame(p, &frame);
    f32x sphere = sdf_sphere(p, 0.5f), box = sdf_box(p, (v3){0.3f, 0.5f, 0.4f}, 0.05f);
    f32x all[PROBE_FUNCTIONS] = {sphere,
                                 sdf_half_space(p, (v3){0.6f, 0.0f, 0.8f}, 0.2f),
                                 sdf_ellipsoid(p, (v3){0.3f, 0.6f, 0.4f}),
                                 sdf_capsule(p, a, b, 0.2f),
                                 sdf_round_cone(p, a, b, 0.3f, 0.1f),
                                 sdf_torus(p, 0.6f, 0.2f),
                                 box,
                                 sdf_cylinder(p, 0.4f, 0.5f, 0.1f),
                                 sdf_extrude(sphere, p.z, 0.3f),
                                 curve.distance,
                                 curve.t,
                                 sdf_smooth_union(sphere, box, 0.1f),
                                 sdf_smooth_intersect(sphere, box, 0.1f),
                                 sdf_smooth_subtract(sphere, box, 0.1f),
                                 sdf_smooth_abs(p.x, 0.1f),
                                 twisted.x + twisted.z,
                                 moved.x + moved.y + moved.z};
    for (int i = 0; i < PROBE_FUNCTIONS; i++)
        value[i] = all[i];
}

void WIDE(sdf_probe)(const float *x, const float *y, const float *z, int count, float *value)
{
    for (int i = 0; i < count; i += AMB_LANES) {
        f32x result[PROBE_FUNCTIONS];
        at_point((v3x){f_load(x + i), f_load(y + i), f_load(z + i)}, result);
        for (int f = 0; f < PROBE_FUNCTIONS; f++)
            f_store(value + f * count + i, result[f]);
    }
}
