/* The torso: what shows of it at the neck, and what the bodice's cloth lies on. */
#include "scenes/builtin/statue.h"

f32x statue_torso(v3x p)
{
    f32x d = sdf_ellipsoid(v3x_sub(p, v3x_splat((v3){-0.002f, 0.745f, -0.004f})), (v3){0.069f, 0.088f, 0.050f});
    d = sdf_smooth_union(d, sdf_capsule(p, (v3){-0.084f, 0.817f, -0.010f}, (v3){0.084f, 0.806f, -0.010f}, 0.026f),
                         0.035f);
    for (int side = -1; side <= 1; side += 2) {
        float s = (float)side;
        d = sdf_smooth_union(
            d, sdf_round_cone(p, (v3){s * 0.006f, 0.855f, -0.012f}, (v3){s * 0.07f, 0.815f, -0.014f}, 0.018f, 0.02f),
            0.03f);
        d = sdf_smooth_union(d,
                             sdf_ellipsoid(v3x_sub(p, v3x_splat((v3){s * 0.033f - 0.002f, 0.737f, 0.036f})),
                                           (v3){0.030f, 0.031f, 0.026f}),
                             0.018f);
    }
    return sdf_smooth_union(d, sdf_capsule(p, (v3){0.0f, 0.81f, -0.008f}, (v3){-0.002f, 0.885f, 0.006f}, 0.0245f),
                            0.02f);
}
