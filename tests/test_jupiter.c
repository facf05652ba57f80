/* Jupiter's key frames: made from any still map, they drift as the velocity map says, and what moves between them stays
 * one feature. */
#include "core/texture_layout.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/giants.h"
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

enum { KEY_WIDTH = 512, KEY_HEIGHT = 256 };

static double grey(const amb_texture *t, int x, int y)
{
    v4 c;
    texels_decode(t->storage, texel_at(t, 0, (x + t->info.width) % t->info.width, y, 0), 1, &c);
    return (double)c.y;
}

/* One bright feature, a Gaussian around column x, on black; or one value. */
static amb_texture *feature_map(double x, float level)
{
    amb_image *image = NULL;
    amb_texture *map = NULL;
    assert_int_equal(amb_image_create(KEY_WIDTH, 4, 4, &image, NULL), AMB_OK);
    for (int y = 0; y < 4; y++)
        for (int i = 0; i < KEY_WIDTH; i++)
            for (int c = 0; c < 4; c++)
                amb_image_row(image, c, y)[i] = x < 0 ? level : (float)exp(-(i - x) * (i - x) / 18.0);
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA32F, false, &map, NULL), AMB_OK);
    amb_image_close(&image);
    return map;
}

typedef struct peaks {
    int count;
    double place, height; /* of the highest */
} peaks;

/* Local maxima above a quarter of a feature's height along the equator at `blend` between two keys. */
static peaks peaks_at(planet_surface *u, float blend)
{
    double row[KEY_WIDTH];
    peaks found = {0, 0, 0};
    u->blend = blend;
    for (int i = 0; i < KEY_WIDTH; i++) {
        planet_point p = {.uv = {((float)i + 0.5f) / KEY_WIDTH, 0.5f}};
        row[i] = (double)planet_surface_colour(u, &p).x;
    }
    for (int i = 1; i + 1 < KEY_WIDTH; i++)
        if (row[i] > 0.25 && row[i] >= row[i - 1] && row[i] > row[i + 1]) {
            found.count++;
            if (row[i] > found.height)
                found.height = row[i], found.place = i;
        }
    return found;
}

/* A feature 24 texels east in the next key, and a map that says so: one peak, on its way. A cross-fade shows two. */
static void test_moving_feature_stays_one(void **state)
{
    (void)state;
    amb_texture *key = feature_map(200, 0), *next = feature_map(224, 0);
    amb_texture *east = feature_map(-1, (128.0f + 63.5f) / 255.0f), *still = feature_map(-1, 128.0f / 255.0f);
    planet_surface u = {.colour = key, .next = next, .drift = 48.0f / KEY_WIDTH};
    for (int i = 1; i < 8; i++) {
        float blend = (float)i / 8.0f;
        u.velocity = east;
        peaks moved = peaks_at(&u, blend);
        assert_int_equal(moved.count, 1);
        assert_true(fabs(moved.place - (200.0 + 24.0 * (double)blend)) <= 0.51);
        assert_true(moved.height > 0.98);
    }
    u.velocity = still;
    assert_int_equal(peaks_at(&u, 0.5f).count, 2);
    amb_texture_close(&key);
    amb_texture_close(&next);
    amb_texture_close(&east);
    amb_texture_close(&still);
}

/* A row without its slow changes. */
static void details(const amb_texture *t, int y, double *out)
{
    for (int x = 0; x < KEY_WIDTH; x++) {
        double mean = 0;
        for (int i = -24; i <= 24; i++)
            mean += grey(t, x + i, y) / 49.0;
        out[x] = grey(t, x, y) - mean;
    }
}

/* Σ a(x) b(x + shift), b at whole texels. */
static double product(const double *a, const double *b, int shift)
{
    double sum = 0;
    for (int x = 0; x < KEY_WIDTH; x++)
        sum += a[x] * b[(x + shift + KEY_WIDTH) % KEY_WIDTH];
    return sum;
}

/* Shift of b against a by the peak of their correlation. */
static double shift_between(const double *a, const double *b)
{
    int best = 0;
    for (int s = -10; s <= 10; s++)
        best = product(a, b, s) > product(a, b, best) ? s : best;
    double l = product(a, b, best - 1), c = product(a, b, best), r = product(a, b, best + 1);
    return best + 0.5 * (l - r) / (l - 2.0 * c + r);
}

enum { SPOT_X = 380, SPOT_Y = 158 };

/* A still map: random clouds some texels wide, and a red oval. */
static amb_texture *still_map(void)
{
    amb_image *image = NULL;
    amb_texture *map = NULL;
    double noise[KEY_WIDTH];
    assert_int_equal(amb_image_create(KEY_WIDTH, KEY_HEIGHT, 4, &image, NULL), AMB_OK);
    for (int y = 0; y < KEY_HEIGHT; y++) {
        for (int x = 0; x < KEY_WIDTH; x++)
            noise[x] = uniform(-0.4, 0.4);
        for (int x = 0; x < KEY_WIDTH; x++) {
            double cloud = 0.5;
            for (int i = -3; i <= 3; i++)
                cloud += noise[(x + i + KEY_WIDTH) % KEY_WIDTH] * (4 - abs(i)) / 6.0;
            double across = (x - SPOT_X) / 19.0, down = (y - SPOT_Y) / 10.0;
            bool red = across * across + down * down < 1.0;
            for (int c = 0; c < 3; c++)
                amb_image_row(image, c, y)[x] = (float)fmin(fmax(cloud * (red && c > 0 ? 0.5 : 1.0), 0.0), 1.0);
        }
    }
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA32F, true, &map, NULL), AMB_OK);
    amb_image_close(&image);
    return map;
}

/* Texels a key frame at texel (x, y) of the still map. */
static double drift(const amb_texture *velocity, int x, int y)
{
    v4 v;
    int wide = velocity->info.width / KEY_WIDTH, high = velocity->info.height / KEY_HEIGHT;
    texels_decode(velocity->storage, texel_at(velocity, 0, x * wide, y * high, 0), 1, &v);
    return ((double)v.x * 255.0 - 128.0) / 127.0 * (double)JUPITER_KEY_DRIFT * 2.0 / (2.0 * PI) * KEY_WIDTH;
}

static amb_status (*const make_key[JUPITER_KEYS])(const amb_context *context, const amb_texture *still,
                                                  amb_texture **out, amb_error *error) = {
    NULL, amb_builtin_jupiter_key1, amb_builtin_jupiter_key2, amb_builtin_jupiter_key3, amb_builtin_jupiter_key4};

/* From every key to the next, the last to the first too, bands move as the velocity map says. */
static void test_keys_drift_as_the_velocity_map_says(void **state)
{
    (void)state;
    amb_context *context = NULL;
    amb_texture *made[JUPITER_KEYS] = {NULL}, *velocity = NULL, *still = still_map();
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (int i = 1; i < JUPITER_KEYS; i++)
        assert_int_equal(make_key[i](context, still, &made[i], NULL), AMB_OK);
    assert_int_equal(amb_builtin_jupiter_velocity(context, still, &velocity, NULL), AMB_OK);
    const amb_texture *key[JUPITER_KEYS] = {still, made[1], made[2], made[3], made[4]};
    double a[KEY_WIDTH], b[KEY_WIDTH];
    for (int i = 0; i < JUPITER_KEYS; i++) {
        double error = 0, swing = 0;
        int rows = 0;
        for (int y = 64; y < 192; y += 4) {
            double want = drift(velocity, 0, y);
            details(key[i], y, a);
            details(key[(i + 1) % JUPITER_KEYS], y, b);
            error += fabs(shift_between(a, b) - want);
            swing += fabs(want);
            rows++;
        }
        print_message("keys %d to %d: mean error %.3f of %.3f texels\n", i, (i + 1) % JUPITER_KEYS, error / rows,
                      swing / rows);
        assert_true(error / rows < 0.35 * swing / rows);
    }
    /* The spot was found, wherever it is, and rests; its latitude elsewhere does not. */
    assert_true(fabs(drift(velocity, SPOT_X, SPOT_Y)) < 0.01 && fabs(drift(velocity, SPOT_X - 150, SPOT_Y)) > 0.5);
    for (int i = 0; i < JUPITER_KEYS; i++)
        amb_texture_close(&made[i]);
    amb_texture_close(&still);
    amb_texture_close(&velocity);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moving_feature_stays_one),
        cmocka_unit_test(test_keys_drift_as_the_velocity_map_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
