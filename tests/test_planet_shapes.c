/* Planets in double precision: shadows of rings and of planets against traced rays, normals of spheroids. */
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"
#include "tests/truth_vec.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A planet turned any way, oblate. */
static planet_view random_view(void)
{
    vec pole = random_direction(), x = vec_unit(vec_cross(pole, random_direction()));
    planet_view view = {.scale = {1.0f, (float)uniform(0.8, 1.0), 1.0f}, .eye = {3, 1, 2}};
    view.axis[0] = v3_from(x);
    view.axis[1] = v3_from(pole);
    view.axis[2] = v3_from(vec_cross(x, pole));
    view.to_sun = v3_from(random_direction());
    return view;
}

/* Own coordinates of a world direction or point. */
static vec own(const planet_view *view, vec w)
{
    return (vec){vec_dot(w, vec_of(view->axis[0])), vec_dot(w, vec_of(view->axis[1])),
                 vec_dot(w, vec_of(view->axis[2]))};
}
static vec world(const planet_view *view, vec o)
{
    vec w = {0, 0, 0};
    w = vec_add(w, vec_of(view->axis[0]), o.x);
    w = vec_add(w, vec_of(view->axis[1]), o.y);
    return vec_add(w, vec_of(view->axis[2]), o.z);
}

/* Rings with one opaque zone: a point of the planet is dark where its ray to the sun crosses the ring plane there.
 * Tolerance: 0.008 planet radii at the zone's edges. */
static void test_ring_shadow_on_the_planet(void **state)
{
    (void)state;
    enum { TEXELS = 4096, FIRST = 1200, LAST = 2500 };
    const double inner = (double)RINGS_INNER, width = (double)RINGS_OUTER - inner;
    const double from = inner + width * FIRST / TEXELS, to = inner + width * LAST / TEXELS;
    amb_image *image = NULL;
    amb_texture *rings = NULL;
    assert_int_equal(amb_image_create(TEXELS, 1, 4, &image, NULL), AMB_OK);
    for (int x = FIRST; x < LAST; x++)
        amb_image_row(image, 3, 0)[x] = 1.0f;
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, &rings, NULL), AMB_OK);
    int dark = 0, lit = 0;
    for (int i = 0; i < 20000; i++) {
        planet_surface u = {.view = random_view(), .rings = rings, .ring_shadow = 1.0f};
        vec d = random_direction();
        vec on = {d.x, d.y * (double)u.view.scale.y, d.z}, sun = own(&u.view, vec_of(u.view.to_sun));
        double way = -on.y / sun.y;
        vec at = vec_add(on, sun, way);
        double radius = sqrt(at.x * at.x + at.z * at.z);
        if (fabs(radius - from) < 0.008 || fabs(radius - to) < 0.008 || fabs(on.y) < 1e-3 || fabs(sun.y) < 1e-2)
            continue;
        bool shadowed = way > 0 && radius > from && radius < to;
        double got = (double)planet_under_rings(&u, v3x_from(world(&u.view, on)));
        assert_true(fabs(got - (shadowed ? 0.0 : 1.0)) < 1e-3);
        shadowed ? dark++ : lit++;
    }
    assert_true(dark > 500 && lit > 5000);
    amb_texture_close(&rings);
    amb_image_close(&image);
}

/* A point of the rings is dark where its ray to the sun meets the spheroid: half the light is gone within
 * ln 2 / sharpness of the edge. Tolerance: 0.004 planet radii at sharpness 400. */
static void test_planet_shadow_on_the_rings(void **state)
{
    (void)state;
    int dark = 0, lit = 0;
    for (int i = 0; i < 20000; i++) {
        planet_view view = random_view();
        double a = uniform(0, 2 * PI), r = uniform((double)RINGS_INNER, (double)RINGS_OUTER), s = (double)view.scale.y;
        vec at = {r * cos(a), 0, r * sin(a)}, sun = own(&view, vec_of(view.to_sun));
        /* |at + k·sun| = 1 with y divided by the semi-axis: the discriminant for spheroids of radius 1 ± tolerance. */
        double qa = sun.x * sun.x + sun.y * sun.y / (s * s) + sun.z * sun.z;
        double qb = at.x * sun.x + at.z * sun.z, qc = at.x * at.x + at.z * at.z;
        double tolerance = 0.004;
        bool inside = qb < 0 && qb * qb - qa * (qc - (1 - tolerance) * (1 - tolerance)) > 0;
        bool outside = qb > 0 || qb * qb - qa * (qc - (1 + 1e-5) * (1 + 1e-5)) < 0;
        double got = (double)planet_rings_sunlight(&view, v3x_from(world(&view, at)), 400.0f);
        if (inside)
            assert_true(got < 0.5), dark++;
        if (outside)
            assert_true(got == 1.0), lit++;
    }
    assert_true(dark > 500 && lit > 5000);
}

/* Spheroid normals against cross products of central differences of its points. */
static void test_spheroid_normals(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 4000; i++) {
        planet_view view = random_view();
        double lat = uniform(-1.5, 1.5), lon = uniform(-PI, PI), h = 1e-5, s = (double)view.scale.y;
        vec p[5];
        for (int k = 0; k < 5; k++) {
            double b = lat + (k == 1 ? h : k == 2 ? -h : 0), l = lon + (k == 3 ? h : k == 4 ? -h : 0);
            p[k] = world(&view, (vec){cos(b) * sin(l), s * sin(b), cos(b) * cos(l)});
        }
        vec want = vec_unit(vec_cross(vec_add(p[3], p[4], -1), vec_add(p[1], p[2], -1)));
        planet_point got = planet_point_of(&view, v3x_from(p[0]));
        vec off = vec_add(vec_ofx(got.normal), want, -1);
        worst = fmax(worst, sqrt(vec_dot(off, off)));
        /* The tangents are unit, at right angles to it, and point east and south. */
        assert_true(fabs(vec_dot(vec_ofx(got.east), want)) < 1e-4 && fabs(vec_dot(vec_ofx(got.south), want)) < 1e-4);
        assert_true(vec_dot(vec_ofx(got.east), vec_add(p[3], p[4], -1)) > 0);
        assert_true(vec_dot(vec_ofx(got.south), vec_add(p[1], p[2], -1)) < 0);
    }
    assert_true(worst < 1e-5);
}

/* How map coordinates change from pixel to pixel, against differences in double precision: also across ±180°, where u
 * jumps and a difference of u itself would pick the smallest mip; only near a pole u's change is less. */
static void test_map_gradients_have_no_seam(void **state)
{
    (void)state;
    double worst = 0;
    int across = 0;
    for (int i = 0; i < 20000; i++) {
        double lat = uniform(-1.45, 1.45), lon = i & 1 ? PI + uniform(-1e-3, 1e-3) : uniform(-PI, PI);
        double to_lat = lat + uniform(-2e-3, 2e-3), to_lon = lon + uniform(-2e-3, 2e-3);
        vec d = {cos(lat) * sin(lon), sin(lat), -cos(lat) * cos(lon)};
        vec e = {cos(to_lat) * sin(to_lon), sin(to_lat), -cos(to_lat) * cos(to_lon)};
        v2x change = planet_uv_change(v3x_from(d), v3x_from(vec_add(e, d, -1)));
        v2x here = planet_uv(v3x_from(d)), there = planet_uv(v3x_from(e));
        double u = (double)there.x - (double)here.x, v = (double)there.y - (double)here.y;
        across += fabs(u) > 0.5;
        u -= round(u);
        u *= cos(lat); /* as if a texel were as wide everywhere as at the equator */
        worst = fmax(worst, fmax(fabs((double)change.x - u), fabs((double)change.y - v)));
    }
    assert_true(across > 2000);
    assert_true(worst < 1.5e-6 * 4); /* of changes up to 3e-4: curvature and float */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ring_shadow_on_the_planet),
        cmocka_unit_test(test_planet_shadow_on_the_rings),
        cmocka_unit_test(test_spheroid_normals),
        cmocka_unit_test(test_map_gradients_have_no_seam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
