/* Sphere tracing of shapes with known intersections, for test_march.c. */
#include "tests/march_lists.h"

#include <ambiance/march.h>

static f32x sphere(v3x p, const void *user)
{
    (void)user;
    return v3x_length(v3x_sub(p, v3x_splat((v3){0.1f, 0.2f, -0.1f}))) - 0.75f;
}
static f32x torus(v3x p, const void *user) /* around y, radii 0.7 and 0.25 */
{
    (void)user;
    f32x ring = f_sqrt(p.x * p.x + p.z * p.z) - 0.7f;
    return f_sqrt(ring * ring + p.y * p.y) - 0.25f;
}
static f32x box(v3x p, const void *user)
{
    (void)user;
    f32x x = f_abs(p.x) - 0.5f, y = f_abs(p.y) - 0.6f, z = f_abs(p.z) - 0.7f, zero = f_set(0.0f);
    return v3x_length((v3x){f_max(x, zero), f_max(y, zero), f_max(z, zero)}) + f_min(f_max(x, f_max(y, z)), zero);
}

void WIDE(march_list)(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit)
{
    amb_march_limits limits = {MARCH_FOOTPRINT, MARCH_TOLERANCE, MARCH_LEAST, steps};
    for (int first = 0; first < count; first += AMB_LANES) {
        float f[8][AMB_LANES] = {{0}};
        uint32_t bits = 0;
        for (int i = 0; i < AMB_LANES && first + i < count; i++) {
            const marched_ray *r = &ray[first + i];
            const float values[8] = {r->origin.x,    r->origin.y,    r->origin.z, r->direction.x,
                                     r->direction.y, r->direction.z, r->t0,       r->t1};
            for (int k = 0; k < 8; k++)
                f[k][i] = values[k];
            bits |= r->dead ? 0u : 1u << i;
        }
        v3x o = {f_load(f[0]), f_load(f[1]), f_load(f[2])}, d = {f_load(f[3]), f_load(f[4]), f_load(f[5])};
        f32x t0 = f_load(f[6]), t1 = f_load(f[7]), radius = f_set(MARCH_CONE), cone;
        maskx live = m_from_bits(bits);
        amb_marched m;
        if (shape == MARCH_SPHERE) {
            m = amb_march(sphere, NULL, o, d, t0, t1, &limits, live);
            cone = amb_march_cone(sphere, NULL, o, d, t0, t1, radius, MARCH_LEAST, steps, live);
        } else if (shape == MARCH_TORUS) {
            m = amb_march(torus, NULL, o, d, t0, t1, &limits, live);
            cone = amb_march_cone(torus, NULL, o, d, t0, t1, radius, MARCH_LEAST, steps, live);
        } else {
            m = amb_march(box, NULL, o, d, t0, t1, &limits, live);
            cone = amb_march_cone(box, NULL, o, d, t0, t1, radius, MARCH_LEAST, steps, live);
        }
        for (int i = 0; i < AMB_LANES && first + i < count; i++)
            hit[first + i] = (marched_hit){m_lane(m.hit, i), f_lane(m.t, i), f_lane(m.distance, i), i_lane(m.steps, i),
                                           f_lane(cone, i)};
    }
}
