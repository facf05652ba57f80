/* A photographer's dark studio as an HDR environment: soft boxes around a subject at the origin. Light shapes are what
 * polished metal shows, so each box has a soft edge, a brighter heart and its own colour temperature. */
#include "scenes/builtin/paint.h"

#include <ambiance/math.h>

v4x WIDE(amb_studio_radiance)(v3x direction, const void *user);

/* A rectangular light on a plane: centre, half axes (orthogonal), radiance at its heart, relative softness of its edge.
 */
typedef struct soft_box {
    v3 center, half_width, half_height, radiance;
    float softness;
} soft_box;

static const soft_box boxes[] = {
    /* key: large and warm, high on the left */
    {{-4.2f, 3.4f, 3.0f}, {1.05f, 0.0f, 1.47f}, {-0.62f, 1.50f, 0.44f}, {11.0f, 9.4f, 7.6f}, 0.18f},
    /* fill: tall cool strip on the right */
    {{4.6f, 1.2f, 1.6f}, {-0.18f, 0.0f, 0.52f}, {0.0f, 2.3f, 0.0f}, {3.2f, 4.0f, 5.4f}, 0.25f},
    /* two rim strips behind */
    {{-2.6f, 1.6f, -4.2f}, {0.42f, 0.0f, -0.26f}, {0.0f, 2.2f, 0.0f}, {7.0f, 8.2f, 10.5f}, 0.2f},
    {{3.4f, 2.0f, -3.6f}, {0.36f, 0.0f, 0.34f}, {0.0f, 1.9f, 0.0f}, {10.5f, 7.6f, 5.0f}, 0.2f},
    /* overhead: wide and weak, shapes shoulders and wings */
    {{0.0f, 5.2f, -0.4f}, {1.7f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.1f}, {2.6f, 2.6f, 2.7f}, 0.35f},
};

static v3x box_light(const soft_box *box, v3x direction)
{
    v3 axis = v3_cross(box->half_width, box->half_height);
    f32x facing = v3x_dot(direction, v3x_splat(axis));
    f32x distance = f_set(v3_dot(box->center, axis)) / facing;
    v3x offset = v3x_sub(v3x_scale(direction, distance), v3x_splat(box->center));
    f32x u = v3x_dot(offset, v3x_splat(box->half_width)) * (1.0f / v3_dot(box->half_width, box->half_width));
    f32x v = v3x_dot(offset, v3x_splat(box->half_height)) * (1.0f / v3_dot(box->half_height, box->half_height));
    f32x one = f_set(1.0f), inner = f_set(1.0f - box->softness);
    f32x edge = (1.0f - f_smoothstep(inner, one, f_abs(u))) * (1.0f - f_smoothstep(inner, one, f_abs(v)));
    f32x heart = 1.0f - 0.45f * f_min(u * u + v * v, one);
    f32x bright = f_sel((distance > 0.0f) & f_is_finite(distance), edge * heart, f_set(0.0f));
    return v3x_scale(v3x_splat(box->radiance), bright);
}

/* The room: a grey cyclorama lit from the key side, a dark floor with a faint pool of light, darkness above. */
static v3x room(v3x direction)
{
    f32x up = direction.y;
    f32x wall = f_smoothstep(f_set(-0.35f), f_set(0.05f), up) * (1.0f - f_smoothstep(f_set(0.05f), f_set(0.85f), up));
    f32x behind =
        f_smoothstep(f_set(0.25f), f_set(-0.9f), direction.z); /* light on the back wall, around the subject */
    f32x floor = f_smoothstep(f_set(-0.1f), f_set(-1.0f), up);
    v3x colour = v3x_splat((v3){0.020f, 0.022f, 0.027f});
    colour = v3x_add(colour, v3x_scale(v3x_splat((v3){0.16f, 0.17f, 0.20f}), wall * (0.25f + 0.75f * behind)));
    return v3x_add(colour, v3x_scale(v3x_splat((v3){0.12f, 0.105f, 0.09f}), floor));
}

v4x WIDE(amb_studio_radiance)(v3x direction, const void *user)
{
    (void)user;
    v3x radiance = room(direction);
    for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++)
        radiance = v3x_add(radiance, box_light(&boxes[i], direction));
    return v4x_of3(radiance, f_set(1.0f));
}
