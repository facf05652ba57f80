/* Scene mercury: the generated maps have no seams, and a frame's components add up to the report's formulas. */
#include "core/texture_layout.h"
#include "scenes/builtin/builtin.h"

#include <ambiance/scene.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { WIDTH = 120, HEIGHT = 90 };

typedef struct fixture {
    amb_context *context;
    amb_assets *assets;
    amb_show *show;
} fixture;

static int set_up(void **state)
{
    fixture *f = calloc(1, sizeof *f);
    *state = f;
    return !f || amb_context_create(NULL, &f->context, NULL) ||
           amb_assets_create(f->context, &(amb_assets_options){.builtin_only = true}, &f->assets, NULL) ||
           amb_show_open(f->context, f->assets, "mercury", &f->show, NULL);
}

static int tear_down(void **state)
{
    fixture *f = *state;
    amb_show_close(&f->show);
    amb_assets_close(&f->assets);
    amb_context_close(&f->context);
    free(f);
    return 0;
}

/* ---- generated maps --------------------------------------------------------------------------------------------- */

static double luminance_at(const amb_texture *t, int x, int y)
{
    v4 c;
    texels_decode(t->storage, texel_at(t, 0, (x + t->info.width) % t->info.width, y, 0), 1, &c);
    return 0.2126 * (double)c.x + 0.7152 * (double)c.y + 0.0722 * (double)c.z;
}

/* Mean absolute difference of columns x and x + 1. */
static double column_step(const amb_texture *t, int x)
{
    double sum = 0;
    for (int y = 0; y < t->info.height; y++)
        sum += fabs(luminance_at(t, x + 1, y) - luminance_at(t, x, y));
    return sum / t->info.height;
}

/* The date line is a column like any other; the pole rows are one point. */
static void check_seamless(const amb_texture *t, double pole_bound)
{
    double steps = 0, across = column_step(t, t->info.width - 1);
    for (int x = 0; x < 64; x++)
        steps += column_step(t, 31 + x * (t->info.width / 64)) / 64;
    assert_true(across < 2.0 * steps);
    for (int end = 0; end < 2; end++) {
        int y = end ? t->info.height - 1 : 0;
        double lo = 1e9, hi = -1e9;
        for (int x = 0; x < t->info.width; x++) {
            lo = fmin(lo, luminance_at(t, x, y));
            hi = fmax(hi, luminance_at(t, x, y));
        }
        assert_true(hi - lo < pole_bound);
    }
}

static void test_maps_are_seamless(void **state)
{
    fixture *f = *state;
    const amb_texture *map = NULL;
    assert_int_equal(amb_assets_texture(f->assets, "mercury/color", &map, NULL), AMB_OK);
    check_seamless(map, 0.08);
    assert_int_equal(amb_assets_texture(f->assets, "stars", &map, NULL), AMB_OK);
    check_seamless(map, 0.05);
}

/* Dark dust, bright rays: the albedo of an airless world. */
static void test_map_looks_like_mercury(void **state)
{
    fixture *f = *state;
    const amb_texture *map = NULL;
    assert_int_equal(amb_assets_texture(f->assets, "mercury/color", &map, NULL), AMB_OK);
    double sum = 0, square = 0, count = 0;
    for (int y = 256; y < map->info.height - 256; y += 8)
        for (int x = 0; x < map->info.width; x += 8) {
            double l = luminance_at(map, x, y);
            sum += l, square += l * l, count++;
        }
    double mean = sum / count, deviation = sqrt(square / count - mean * mean);
    assert_true(mean > 0.12 && mean < 0.35);
    assert_true(deviation > 0.01 && deviation < 0.12);
}

/* ---- frames ----------------------------------------------------------------------------------------------------- */

static void set(fixture *f, const char *name, const char *value)
{
    assert_int_equal(amb_show_set(f->show, name, value, NULL), AMB_OK);
}

static amb_frame *render(fixture *f, double time)
{
    static const char *const all[] = {"all", NULL};
    amb_frame *frame = NULL;
    assert_int_equal(amb_show_render(f->show, time, WIDTH, HEIGHT, all, &frame, NULL), AMB_OK);
    return frame;
}

static double at(const amb_frame *frame, const char *layer, int c, int x, int y)
{
    return (double)amb_image_row(amb_frame_layer(frame, layer), c, y)[x];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* color = albedo · (exposure · diffuse + starlight); normals are unit, the planet is where its sphere is. */
static void test_components_add_up(void **state)
{
    fixture *f = *state;
    int seen = 0;
    set(f, "samples", "1");
    set(f, "exposure", "2.5");
    set(f, "starlight", "0.01");
    set(f, "stars", "0");
    amb_frame *frame = render(f, 11.0);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            if (at(frame, "id", 0, x, y) == 0.0) {
                assert_true(at(frame, "depth", 0, x, y) == 1.0 && at(frame, "color", 1, x, y) == 0.0);
                continue;
            }
            double p[3], n[3], diffuse = at(frame, "diffuse", 0, x, y);
            for (int c = 0; c < 3; c++) {
                p[c] = at(frame, "position", c, x, y), n[c] = at(frame, "normal", c, x, y);
                double want = at(frame, "albedo", c, x, y) * (2.5 * diffuse + 0.01);
                assert_true(fabs(at(frame, "color", c, x, y) - want) < 1e-6);
            }
            assert_true(diffuse >= 0.0 && diffuse <= 1.0001);
            assert_true(fabs(sqrt(dot(n, n)) - 1.0) < 1e-5);
            assert_true(fabs(sqrt(dot(p, p)) - 1.0) < 1e-3);
            seen++;
        }
    assert_true(seen > WIDTH * HEIGHT / 4);
    amb_frame_close(&frame);
}

/* Without relief the light is the formula of the smooth sphere: ((n·l + w)/(1 + w))^k. */
static void test_smooth_sphere_matches_the_formula(void **state)
{
    fixture *f = *state;
    const double degree = acos(-1.0) / 180.0, w = 0.3, k = 0.47, azimuth = 135 * degree, elevation = -20 * degree;
    const double light[3] = {cos(elevation) * sin(azimuth), sin(elevation), cos(elevation) * cos(azimuth)};
    set(f, "bump", "0");
    set(f, "wrap", "0.3");
    set(f, "twilight", "0.05");
    set(f, "sun_azimuth", "135");
    set(f, "sun_elevation", "-20");
    amb_frame *frame = render(f, 20.0);
    int lit = 0, dark = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            if (at(frame, "id", 0, x, y) == 0.0)
                continue;
            double p[3] = {at(frame, "position", 0, x, y), at(frame, "position", 1, x, y),
                           at(frame, "position", 2, x, y)};
            double n_dot_l = dot(p, light) / sqrt(dot(p, p)), diffuse = at(frame, "diffuse", 0, x, y);
            if (n_dot_l > 0.05) { /* out of the shadowed zone */
                assert_true(fabs(diffuse - pow((n_dot_l + w) / (1 + w), k)) < 2e-4);
                lit++;
            } else if (n_dot_l < -0.05) {
                assert_true(diffuse == 0.0);
                dark++;
            }
        }
    assert_true(lit > 500 && dark > 500);
    amb_frame_close(&frame);
}

/* Any time renders directly, and the flight closes: one period later the camera is where it was. */
static void test_flight_closes(void **state)
{
    fixture *f = *state;
    set(f, "day", "0");
    amb_frame *a = render(f, 5.0), *b = render(f, 5.0 + 72.0);
    char digest[2][65];
    amb_image_sha256(amb_frame_layer(a, "color"), digest[0]);
    amb_image_sha256(amb_frame_layer(b, "color"), digest[1]);
    assert_string_equal(digest[0], digest[1]);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_maps_are_seamless), cmocka_unit_test(test_map_looks_like_mercury),
        cmocka_unit_test(test_components_add_up), cmocka_unit_test(test_smooth_sphere_matches_the_formula),
        cmocka_unit_test(test_flight_closes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
