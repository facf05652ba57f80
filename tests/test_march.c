/* Sphere tracing against exact intersections in double precision, on every number of lanes. */
#include "tests/march_lists.h"

#include <ambiance/context.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 2003 };

static float uniform(uint32_t *state, float lo, float hi)
{
    *state = *state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (float)(*state >> 8) / 16777216.0f;
}
static v3 uniform3(uint32_t *state, float lo, float hi)
{
    float x = uniform(state, lo, hi), y = uniform(state, lo, hi), z = uniform(state, lo, hi);
    return (v3){x, y, z};
}

static void make_rays(marched_ray *ray, uint32_t seed)
{
    for (int i = 0; i < RAYS; i++) {
        v3 direction = v3_normalize(uniform3(&seed, -1, 1));
        v3 at = uniform3(&seed, -0.9f, 0.9f);
        ray[i] = (marched_ray){v3_sub(at, v3_scale(direction, 3)), direction, 0, 6, 0};
    }
}

/* ---- exact --------------------------------------------------------------------------------------------------------
 */

typedef struct exact {
    int hit, clear;
    double t;
} exact;

static exact exact_sphere(const marched_ray *r)
{
    double f[3] = {(double)r->origin.x - 0.1, (double)r->origin.y - 0.2, (double)r->origin.z + 0.1};
    double d[3] = {(double)r->direction.x, (double)r->direction.y, (double)r->direction.z};
    double a = 0, b = 0, c = -0.75 * 0.75;
    for (int k = 0; k < 3; k++)
        a += d[k] * d[k], b += f[k] * d[k], c += f[k] * f[k];
    double disc = b * b - a * c;
    return (exact){disc >= 0, fabs(disc) > 1e-2, disc >= 0 ? (-b - sqrt(disc)) / a : 0};
}

static exact exact_box(const marched_ray *r)
{
    const double half[3] = {0.5, 0.6, 0.7};
    double o[3] = {(double)r->origin.x, (double)r->origin.y, (double)r->origin.z};
    double d[3] = {(double)r->direction.x, (double)r->direction.y, (double)r->direction.z};
    double enter = -1e9, leave = 1e9, cosine = 0;
    for (int k = 0; k < 3; k++) {
        double t0 = (-half[k] - o[k]) / d[k], t1 = (half[k] - o[k]) / d[k];
        if (fmin(t0, t1) > enter)
            enter = fmin(t0, t1), cosine = fabs(d[k]);
        leave = fmin(leave, fmax(t0, t1));
    }
    return (exact){enter <= leave, fabs(enter - leave) > 2e-2 && cosine > 0.05, enter};
}

/* The quartic's first root, by its sign changes: F = (|p|² + R² - r²)² - 4R²(x² + z²), in steps far below its wiggles.
 */
static double torus_value(const marched_ray *r, double t)
{
    double x = (double)r->origin.x + t * (double)r->direction.x, y = (double)r->origin.y + t * (double)r->direction.y;
    double z = (double)r->origin.z + t * (double)r->direction.z;
    double k = x * x + y * y + z * z + 0.7 * 0.7 - 0.25 * 0.25;
    return k * k - 4 * 0.7 * 0.7 * (x * x + z * z);
}
static exact exact_torus(const marched_ray *r)
{
    double least = 1e9;
    for (double t = 0; t < 6; t += 2e-3) {
        double value = torus_value(r, t);
        least = fmin(least, fabs(value));
        if (value > 0)
            continue;
        double lo = t - 2e-3, hi = t;
        for (int i = 0; i < 60; i++) {
            double mid = 0.5 * (lo + hi);
            *(torus_value(r, mid) > 0 ? &lo : &hi) = mid;
        }
        double slope = (torus_value(r, lo - 1e-5) - torus_value(r, lo + 1e-5)) / 2e-5;
        return (exact){1, slope > 0.2, lo};
    }
    return (exact){0, least > 5e-3, 0};
}

/* ---- lanes --------------------------------------------------------------------------------------------------------
 */

typedef void (*marcher)(marched_shape shape, const marched_ray *ray, int count, int steps, marched_hit *hit);

/* Marches at one lane and at every other width, which must agree in every bit. */
static void march_everywhere(marched_shape shape, const marched_ray *ray, int steps, marched_hit *hit)
{
    march_list_x1(shape, ray, RAYS, steps, hit);
    const struct {
        amb_isa isa;
        marcher march;
    } wider[] = {
        {AMB_ISA_V2, march_list_x4},
#if defined(__x86_64__)
        {AMB_ISA_V3, march_list_x8},
        {AMB_ISA_V4, march_list_x16},
#endif
    };
    for (size_t w = 0; w < sizeof wider / sizeof wider[0]; w++) {
        static marched_hit other[RAYS];
        if (!amb_isa_available(wider[w].isa))
            continue;
        wider[w].march(shape, ray, RAYS, steps, other);
        for (int i = 0; i < RAYS; i++)
            if (memcmp(&hit[i], &other[i], sizeof hit[i]) != 0)
                fail_msg("%d lanes: ray %d stops at %a, not %a", wider[w].isa, i, (double)other[i].t, (double)hit[i].t);
    }
}

static void hits_are_the_exact_ones(void **state)
{
    (void)state;
    static marched_ray ray[RAYS];
    static marched_hit hit[RAYS];
    for (int shape = 0; shape < MARCH_SHAPES; shape++) {
        make_rays(ray, (uint32_t)shape + 1);
        march_everywhere((marched_shape)shape, ray, MARCH_STEPS, hit);
        int clear = 0, hits = 0;
        for (int i = 0; i < RAYS; i++) {
            exact e = shape == MARCH_SPHERE ? exact_sphere(&ray[i])
                      : shape == MARCH_BOX  ? exact_box(&ray[i])
                                            : exact_torus(&ray[i]);
            if (!e.clear)
                continue;
            clear++;
            assert_int_equal(hit[i].hit, e.hit);
            if (!e.hit) {
                assert_true(hit[i].t > 6);
                continue;
            }
            hits++;
            /* In front of the surface by at most the threshold over the grazing cosine. */
            double threshold = fmax((double)(MARCH_FOOTPRINT * MARCH_TOLERANCE * hit[i].t), (double)MARCH_LEAST);
            assert_true((double)hit[i].t < e.t + 1e-5);
            assert_true((double)hit[i].t > e.t - 60 * threshold);
            assert_true((double)hit[i].distance <= threshold * 1.00001);
            assert_true(hit[i].steps > 1 && hit[i].steps < MARCH_STEPS);
            /* Nothing within the cone comes before `cone`; the axis is part of it. */
            assert_true((double)hit[i].cone < e.t && hit[i].cone > 0.5f);
        }
        assert_true(clear > RAYS / 2 && hits > RAYS / 4);
    }
}

/* Every ray inside the cone hits the same when started at the cone's t. */
static void starting_at_the_cone_skips_no_surface(void **state)
{
    (void)state;
    static marched_ray ray[RAYS], inside[RAYS];
    static marched_hit hit[RAYS], full[RAYS], late[RAYS];
    for (int shape = 0; shape < MARCH_SHAPES; shape++) {
        make_rays(ray, (uint32_t)shape + 10);
        march_everywhere((marched_shape)shape, ray, 200, hit);
        uint32_t seed = 4;
        for (int i = 0; i < RAYS; i++) {
            v3 aside = v3_scale(v3_normalize(uniform3(&seed, -1, 1)), MARCH_CONE * 0.9f);
            inside[i] = ray[i];
            inside[i].direction = v3_normalize(v3_add(ray[i].direction, aside));
        }
        march_list_x4((marched_shape)shape, inside, RAYS, MARCH_STEPS, full);
        for (int i = 0; i < RAYS; i++)
            inside[i].t0 = hit[i].cone;
        march_list_x4((marched_shape)shape, inside, RAYS, MARCH_STEPS, late);
        int different = 0;
        for (int i = 0; i < RAYS; i++) {
            different += full[i].hit != late[i].hit; /* grazing rays within the threshold may differ */
            if (full[i].hit)
                assert_true(hit[i].cone <= full[i].t + 1e-5f);
            if (full[i].hit && late[i].hit)
                assert_true(fabsf(full[i].t - late[i].t) < 0.02f);
        }
        assert_true(different <= RAYS / 200);
    }
}

static void limits_stop_every_lane_by_itself(void **state)
{
    (void)state;
    static marched_ray ray[RAYS];
    static marched_hit whole[RAYS], hit[RAYS];
    make_rays(ray, 30);
    march_everywhere(MARCH_TORUS, ray, MARCH_STEPS, whole);
    for (int i = 0; i < RAYS; i++) {
        if (i % 5 == 1)
            ray[i].dead = 1;
        if (i % 5 == 2)
            ray[i].t0 = NAN;
        if (i % 5 == 3)
            ray[i].t1 = whole[i].hit ? whole[i].t * 0.9f : 1;
        if (i % 5 == 4)
            ray[i].t0 = 7;
    }
    march_everywhere(MARCH_TORUS, ray, MARCH_STEPS, hit);
    for (int i = 0; i < RAYS; i++) {
        if (i % 5 == 0) {
            assert_memory_equal(&hit[i], &whole[i], sizeof hit[i]);
            continue;
        }
        assert_false(hit[i].hit);
        if (i % 5 != 3)
            assert_int_equal(hit[i].steps, 0);
    }
    march_everywhere(MARCH_TORUS, ray, 3, hit);
    for (int i = 0; i < RAYS; i++)
        assert_true(hit[i].steps <= 3 && (!hit[i].hit || whole[i].steps <= 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_are_the_exact_ones),
        cmocka_unit_test(starting_at_the_cone_skips_no_surface),
        cmocka_unit_test(limits_stop_every_lane_by_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
