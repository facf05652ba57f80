/* Distances against brute force in double precision: the least distance to densely sampled surfaces and curves. */
#include "tests/sdf_probe_wide.h"

#include <ambiance/context.h>
#include <ambiance/sdf.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct d3 {
    double x, y, z;
} d3;

static uint32_t seed = 1;
static double uniform(double lo, double hi)
{
    seed = seed * 1664525u + 1013904223u;
    return lo + (hi - lo) * (double)(seed >> 8) / 16777216.0;
}
static v3 random_point(double range)
{
    return (v3){(float)uniform(-range, range), (float)uniform(-range, range), (float)uniform(-range, range)};
}
static d3 wide(v3 a) { return (d3){(double)a.x, (double)a.y, (double)a.z}; }
static double distance(d3 a, d3 b)
{
    return sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}
static d3 mix(d3 a, d3 b, double t)
{
    return (d3){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t};
}

/* Least of |p - c(t)| - r(t) over balls along a segment: coarse samples, then ever finer ones about the best. */
static double swept_balls(d3 p, d3 a, d3 b, double ra, double rb)
{
    double best = 1e9, best_t = 0.0, lo = 0.0, hi = 1.0;
    for (int pass = 0; pass < 4; pass++) {
        for (int i = 0; i <= 200; i++) {
            double t = lo + (hi - lo) * i / 200.0, d = distance(p, mix(a, b, t)) - (ra + (rb - ra) * t);
            if (d < best) {
                best = d;
                best_t = t;
            }
        }
        double span = (hi - lo) / 100.0;
        lo = fmax(best_t - span, 0.0);
        hi = fmin(best_t + span, 1.0);
    }
    return best;
}

static void capsules_and_cones(void **state)
{
    (void)state;
    for (int i = 0; i < 400; i++) {
        v3 a = random_point(1.0), b = random_point(1.0), p = random_point(2.0);
        double length = distance(wide(a), wide(b));
        float ra = (float)uniform(0.05, 0.6), rb = (float)((double)ra + uniform(-0.9, 0.9) * length);
        if (length < 0.05 || rb < 0.0f)
            continue;
        double truth = swept_balls(wide(p), wide(a), wide(b), (double)ra, (double)ra);
        assert_true(fabs((double)sdf_capsule(v3x_splat(p), a, b, ra) - truth) < 2e-6);
        truth = swept_balls(wide(p), wide(a), wide(b), (double)ra, (double)rb);
        assert_true(fabs((double)sdf_round_cone(v3x_splat(p), a, b, ra, rb) - truth) < 1e-5);
    }
}

static void torus(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        v3 p = random_point(1.5);
        double best = 1e9;
        for (int k = 0; k < 20000; k++) {
            double angle = k * (6.283185307179586 / 20000.0);
            best = fmin(best, distance(wide(p), (d3){0.7 * cos(angle), 0.0, 0.7 * sin(angle)}));
        }
        assert_true(fabs((double)sdf_torus(v3x_splat(p), 0.7f, 0.25f) - (best - 0.25)) < 2e-6);
    }
}

/* Nearest of the points of a box's surface on a grid; `round` is taken off a box smaller by it. */
static double box_surface(d3 p, d3 half)
{
    double best = 1e9;
    for (int face = 0; face < 6; face++)
        for (int i = 0; i <= 100; i++)
            for (int j = 0; j <= 100; j++) {
                double s = face & 1 ? 1.0 : -1.0, u = i / 50.0 - 1.0, v = j / 50.0 - 1.0;
                d3 q = face < 2 ? (d3){s, u, v} : face < 4 ? (d3){u, s, v} : (d3){u, v, s};
                best = fmin(best, distance(p, (d3){q.x * half.x, q.y * half.y, q.z * half.z}));
            }
    return best;
}

static void boxes(void **state)
{
    (void)state;
    const v3 half = {0.5f, 0.3f, 0.7f};
    for (int i = 0; i < 60; i++) {
        v3 p = random_point(1.2);
        bool inside = fabsf(p.x) < half.x && fabsf(p.y) < half.y && fabsf(p.z) < half.z;
        double truth = box_surface(wide(p), wide(half)), ours = (double)sdf_box(v3x_splat(p), half, 0.0f);
        assert_true(inside == (ours < 0.0));
        assert_true(fabs(ours) <= truth + 1e-6 && truth - fabs(ours) < 0.01); /* samples are at most 0.014 apart */
        v3 core = {0.4f, 0.2f, 0.6f};
        truth = box_surface(wide(p), wide(core));
        bool inside_core = fabsf(p.x) < core.x && fabsf(p.y) < core.y && fabsf(p.z) < core.z;
        truth = (inside_core ? -truth : truth) - 0.1;
        assert_true(fabs((double)sdf_box(v3x_splat(p), half, 0.1f) - truth) < 0.01);
    }
}

static double cylinder_surface(d3 p, double radius, double half)
{
    double best = 1e9;
    for (int i = 0; i < 300; i++)
        for (int j = 0; j <= 60; j++) {
            double angle = i * (6.283185307179586 / 300.0), c = cos(angle), s = sin(angle);
            best = fmin(best, distance(p, (d3){radius * c, half * (j / 30.0 - 1.0), radius * s}));
            best = fmin(best, distance(p, (d3){radius * c * j / 60.0, half, radius * s * j / 60.0}));
            best = fmin(best, distance(p, (d3){radius * c * j / 60.0, -half, radius * s * j / 60.0}));
        }
    return best;
}

static void cylinders(void **state)
{
    (void)state;
    for (int i = 0; i < 60; i++) {
        v3 p = random_point(1.2);
        double truth = cylinder_surface(wide(p), 0.4, 0.6), ours = (double)sdf_cylinder(v3x_splat(p), 0.4f, 0.6f, 0.0f);
        assert_true((sqrt((double)(p.x * p.x + p.z * p.z)) < 0.4 && fabsf(p.y) < 0.6f) == (ours < 0.0));
        assert_true(fabs(ours) <= truth + 1e-6 && truth - fabs(ours) < 0.01);
        /* An extruded disc is the same solid, turned. */
        v3 turned = {p.x, p.z, p.y};
        float disc = __builtin_sqrtf(turned.x * turned.x + turned.y * turned.y) - 0.4f;
        assert_true(fabs((double)sdf_extrude(disc, turned.z, 0.6f) - ours) < 1e-6);
    }
}

/* First-order bound: zero on the surface, right sign, slope 1 there, at most twice the distance elsewhere. */
static void ellipsoids(void **state)
{
    (void)state;
    for (int shape = 0; shape < 8; shape++) {
        v3 radii = {(float)uniform(0.3, 0.9), (float)uniform(0.3, 0.9), (float)uniform(0.3, 0.9)};
        for (int i = 0; i < 25; i++) {
            v3 p = random_point(1.5);
            double nearest = 1e9;
            for (int u = 0; u < 400; u++)
                for (int v = 0; v <= 200; v++) {
                    double a = u * (6.283185307179586 / 400.0), b = v * (3.141592653589793 / 200.0);
                    nearest = fmin(nearest,
                                   distance(wide(p), (d3){(double)radii.x * cos(a) * sin(b), (double)radii.y * cos(b),
                                                          (double)radii.z * sin(a) * sin(b)}));
                }
            double scaled = (double)v3_length((v3){p.x / radii.x, p.y / radii.y, p.z / radii.z});
            double ours = (double)sdf_ellipsoid(v3x_splat(p), radii);
            assert_true((scaled < 1.0) == (ours < 0.0));
            assert_true(fabs(ours) < 2.0 * nearest + 1e-3);
            /* From a surface point outwards by a thousandth. */
            v3 on = v3_scale(p, (float)(1.0 / scaled));
            v3 normal =
                v3_normalize((v3){on.x / (radii.x * radii.x), on.y / (radii.y * radii.y), on.z / (radii.z * radii.z)});
            assert_true(fabsf(sdf_ellipsoid(v3x_splat(on), radii)) < 2e-6f);
            assert_true(fabsf(sdf_ellipsoid(v3x_splat(v3_add(on, v3_scale(normal, 1e-3f))), radii) - 1e-3f) < 1e-5f);
        }
        float least = radii.x < radii.y ? radii.x : radii.y;
        least = least < radii.z ? least : radii.z;
        assert_true(sdf_ellipsoid((v3x){0.0f, 0.0f, 0.0f}, radii) == -least);
    }
}

static void bezier_curves(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        v3 a = random_point(1.0), b = random_point(1.0), c = random_point(1.0), p = random_point(1.5);
        double best = 1e9;
        for (int k = 0; k <= 20000; k++) {
            double t = k / 20000.0;
            best = fmin(best, distance(wide(p), mix(mix(wide(a), wide(b), t), mix(wide(b), wide(c), t), t)));
        }
        sdf_curve curve = sdf_bezier(v3x_splat(p), a, b, c);
        double t = (double)curve.t;
        assert_true(t >= 0.0 && t <= 1.0);
        assert_true((double)curve.distance > best - 2e-6);
        assert_true((double)curve.distance <
                    best + 2e-3); /* two nearest points may compete: then either may be taken */
        double there = distance(wide(p), mix(mix(wide(a), wide(b), t), mix(wide(b), wide(c), t), t));
        assert_true(fabs(there - (double)curve.distance) < 2e-3);
    }
    /* A straight "curve" is a segment. */
    for (int i = 0; i < 100; i++) {
        v3 p = random_point(2.0), a = {-0.5f, 0.0f, 0.0f}, c = {0.5f, 0.0f, 0.0f};
        double truth = swept_balls(wide(p), wide(a), wide(c), 0.0, 0.0);
        assert_true(fabs((double)sdf_bezier(v3x_splat(p), a, (v3){0.0f, 0.0f, 0.0f}, c).distance - truth) < 2e-6);
    }
}

static void blends(void **state)
{
    (void)state;
    const float k = 0.25f;
    for (int i = 0; i < 2000; i++) {
        float a = (float)uniform(-1.0, 1.0), b = (float)uniform(-1.0, 1.0), sharp = a < b ? a : b;
        float u = sdf_smooth_union(a, b, k);
        assert_true(u == sdf_smooth_union(b, a, k));
        assert_true(u <= sharp && u >= sharp - 0.25f * k - 1e-7f);
        if (fabsf(a - b) >= k)
            assert_true(u == sharp);
        /* Slopes: between 0 and 1 in each argument, together exactly 1 (raising both raises the result as much). */
        double slope_a = ((double)sdf_smooth_union(a + 0.01f, b, k) - (double)u) / 0.01;
        assert_true(slope_a > -1e-4 && slope_a < 1.0 + 1e-4);
        assert_true(fabs((double)sdf_smooth_union(a + 0.5f, b + 0.5f, k) - (double)u - 0.5) < 1e-6);
        assert_true(sdf_smooth_intersect(a, b, k) == -sdf_smooth_union(-a, -b, k));
        float both = sdf_smooth_subtract(a, b, k), cut = a > -b ? a : -b;
        assert_true(both >= cut && both <= cut + 0.25f * k + 1e-7f);
        assert_true(sdf_union(a, b) == sharp && sdf_subtract(a, b) == cut && sdf_intersect(a, b) == (a > b ? a : b));
        assert_true(fabsf(sdf_smooth_abs(a, 0.05f) - (fabsf(a) - 0.05f)) <= 0.05f);
        assert_true(sdf_smooth_abs(a, 0.05f) >= 0.0f && sdf_displace(a, b) == a - b);
    }
    /* In the middle the fillet is k/4 deep. */
    assert_true(fabsf(sdf_smooth_union(0.0f, 0.0f, k) + 0.25f * k) < 1e-7f);
}

static void changes_of_space(void **state)
{
    (void)state;
    const sdf_frame frame = {{0.1f, -0.2f, 0.3f}, {0.8f, 0.6f, 0.0f}, {-0.6f, 0.8f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    for (int i = 0; i < 200; i++) {
        v3 p = random_point(2.0), q = random_point(2.0);
        double before = distance(wide(p), wide(q));
        assert_true(fabs(distance(wide(v3x_lane(sdf_to_frame(v3x_splat(p), &frame), 0)),
                                  wide(v3x_lane(sdf_to_frame(v3x_splat(q), &frame), 0))) -
                         before) < 2e-6);
        double angle = 1.7 * (double)p.y;
        v3x twisted = sdf_twist(v3x_splat(p), 1.7f);
        assert_true(fabs((double)twisted.x - ((double)p.x * cos(angle) - (double)p.z * sin(angle))) < 2e-6);
        assert_true(fabs((double)twisted.z - ((double)p.x * sin(angle) + (double)p.z * cos(angle))) < 2e-6);
        assert_true(twisted.y == p.y);
    }
    v3 at = {0.1f + 0.8f, -0.2f + 0.6f, 0.3f}, one = v3x_lane(sdf_to_frame(v3x_splat(at), &frame), 0);
    assert_true(fabsf(one.x - 1.0f) < 1e-6f && fabsf(one.y) < 1e-6f && fabsf(one.z) < 1e-6f);
    assert_true(fabsf(sdf_half_space((v3x){0.0f, 3.0f, 0.0f}, (v3){0.0f, 1.0f, 0.0f}, 2.0f) - 1.0f) < 1e-6f);
    assert_true(fabsf(sdf_sphere((v3x){2.0f, 3.0f, 6.0f}, 5.0f) - 2.0f) < 1e-6f);
}

static void lanes_equal_one_lane(void **state)
{
    (void)state;
    enum { COUNT = 4096 };
    static float x[COUNT], y[COUNT], z[COUNT], truth[PROBE_FUNCTIONS * COUNT], value[PROBE_FUNCTIONS * COUNT];
    for (int i = 0; i < COUNT; i++) {
        v3 p = i == 0 ? (v3){0.0f, 0.0f, 0.0f} : random_point(i < 100 ? 0.01 : 2.0);
        x[i] = p.x;
        y[i] = p.y;
        z[i] = p.z;
    }
    sdf_probe_x1(x, y, z, COUNT, truth);
    sdf_probe_x4(x, y, z, COUNT, value);
    assert_memory_equal(value, truth, sizeof truth);
#if defined(__x86_64__)
    if (amb_isa_available(AMB_ISA_V3)) {
        sdf_probe_x8(x, y, z, COUNT, value);
        assert_memory_equal(value, truth, sizeof truth);
    }
    if (amb_isa_available(AMB_ISA_V4)) {
        sdf_probe_x16(x, y, z, COUNT, value);
        assert_memory_equal(value, truth, sizeof truth);
    }
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capsules_and_cones),
        cmocka_unit_test(torus),
        cmocka_unit_test(boxes),
        cmocka_unit_test(cylinders),
        cmocka_unit_test(ellipsoids),
        cmocka_unit_test(bezier_curves),
        cmocka_unit_test(blends),
        cmocka_unit_test(changes_of_space),
        cmocka_unit_test(lanes_equal_one_lane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
