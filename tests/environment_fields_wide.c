/* Radiance fields with known integrals, for test_environment.c. */
#include "scenes/builtin/paint.h"

v4x WIDE(test_radiance_linear)(v3x direction, const void *user);

/* a + b·direction, per channel: irradiance/π is a + ⅔ b·normal exactly. */
v4x WIDE(test_radiance_linear)(v3x direction, const void *user)
{
    const float *k = user; /* three rows of a, bx, by, bz */
    f32x channel[3];
    for (int i = 0; i < 3; i++, k += 4)
        channel[i] = k[0] + ((direction.x * k[1] + direction.y * k[2]) + direction.z * k[3]);
    return (v4x){channel[0], channel[1], channel[2], f_set(1.0f)};
}
