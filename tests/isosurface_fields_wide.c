#include "tests/isosurface_fields_wide.h"

#include <ambiance/sdf.h>

static f32x sphere(const void *user, v3x p)
{
    (void)user;
    return sdf_sphere(p, 0.7f);
}

static f32x torus(const void *user, v3x p)
{
    (void)user;
    return sdf_torus(p, 0.6f, 0.2f);
}

static f32x tangle(const void *user, v3x p)
{
    (void)user;
    f32x waves = f_sin(p.x * 23.0f) * f_sin(p.y * 29.0f) + f_sin(p.y * 31.0f) * f_sin(p.z * 19.0f) +
                 f_sin(p.z * 27.0f) * f_sin(p.x * 21.0f);
    return f_max(waves * 0.02f, sdf_sphere(p, 0.8f));
}

/* Corners of the grid with cells of 1/16 get a random sign each. */
static f32x noise(const void *user, v3x p)
{
    (void)user;
    i32x x = f_to_i(f_floor(p.x * 16.0f + 0.5f)), y = f_to_i(f_floor(p.y * 16.0f + 0.5f)),
         z = f_to_i(f_floor(p.z * 16.0f + 0.5f));
    u32x h = i_as_u(x) * 0x9e3779b1u ^ i_as_u(y) * 0x85ebca77u ^ i_as_u(z) * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    f32x value = (i_to_f(u_as_i(h >> 9)) * (1.0f / 4194304.0f) - 1.0f) * 0.05f;
    return f_max(value, sdf_sphere(p, 0.8f));
}

static f32x steep(const void *user, v3x p)
{
    (void)user;
    return sdf_sphere(p, 0.7f) * 2.0f;
}

static f32x empty(const void *user, v3x p)
{
    (void)user;
    return f_abs(p.x) + 1.0f;
}

amb_field WIDE(test_field_at)(test_field which)
{
    static const amb_field field[FIELD_COUNT] = {sphere, torus, tangle, noise, steep, empty};
    return field[which];
}
