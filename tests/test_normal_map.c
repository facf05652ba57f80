/* The normal-map maker against its formulas in double precision, texel by texel. */
#include <ambiance/context.h>
#include <ambiance/normal_map.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static amb_context *context_of(int threads)
{
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(&(amb_context_options){.threads = threads}, &context, NULL), AMB_OK);
    return context;
}

static amb_image *random_image(int width, int height, int channels, unsigned seed)
{
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(width, height, channels, &image, NULL), AMB_OK);
    for (int c = 0; c < channels; c++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                seed = seed * 1664525u + 1013904223u;
                amb_image_row(image, c, y)[x] = (float)(seed >> 8) / 16777216.0f;
            }
    return image;
}

/* ---- the formulas, in double ------------------------------------------------------------------------------------- */

typedef struct {
    int width, height;
    bool wrap;
} grid;
static size_t at(const grid *g, int x, int y)
{
    x = g->wrap ? ((x % g->width) + g->width) % g->width : x < 0 ? 0 : x >= g->width ? g->width - 1 : x;
    y = y < 0 ? 0 : y >= g->height ? g->height - 1 : y;
    return (size_t)y * (size_t)g->width + (size_t)x;
}

static double height_of(const amb_image *image, int x, int y)
{
    double r = (double)amb_image_row(image, 0, y)[x];
    if (image->channels == 1)
        return r;
    return 0.2126 * r + 0.7152 * (double)amb_image_row(image, 1, y)[x] + 0.0722 * (double)amb_image_row(image, 2, y)[x];
}

/* n[3·texel + k] */
static void reference(const amb_image *image, const amb_normal_map_options *o, double *n)
{
    static const double sobel[3] = {1, 2, 1}, binomial[5] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
    grid g = {image->width, image->height, o->wrap_u};
    size_t count = (size_t)g.width * (size_t)g.height;
    double *h = calloc(count, sizeof *h), *b = calloc(2 * count, sizeof *b), *next = calloc(2 * count, sizeof *next);
    for (int y = 0; y < g.height; y++)
        for (int x = 0; x < g.width; x++)
            h[at(&g, x, y)] = height_of(image, x, y);
    for (int y = 0; y < g.height; y++)
        for (int x = 0; x < g.width; x++) {
            double su = 0, sv = 0;
            for (int i = -1; i <= 1; i++) {
                su += sobel[i + 1] * (h[at(&g, x + 1, y + i)] - h[at(&g, x - 1, y + i)]) / 8;
                sv += sobel[i + 1] * (h[at(&g, x + i, y + 1)] - h[at(&g, x + i, y - 1)]) / 8;
            }
            if (o->longitude_latitude)
                su /= fmax(sin(acos(-1.0) * (y + 0.5) / g.height), 0.25);
            su *= (double)o->strength, sv *= (double)o->strength;
            double length = sqrt(su * su + sv * sv + 1);
            double *to = n + 3 * at(&g, x, y);
            to[0] = -su / length, to[1] = -sv / length, to[2] = 1 / length;
            b[2 * at(&g, x, y)] = to[0], b[2 * at(&g, x, y) + 1] = to[1];
        }
    for (int octave = 1; octave <= o->octaves; octave++) {
        int step = 1 << (octave - 1);
        memset(next, 0, 2 * count * sizeof *next);
        for (int y = 0; y < g.height; y++)
            for (int x = 0; x < g.width; x++)
                for (int k = 0; k < 2; k++) {
                    double sum = 0;
                    for (int j = -2; j <= 2; j++)
                        for (int i = -2; i <= 2; i++)
                            sum += binomial[i + 2] * binomial[j + 2] *
                                   b[2 * at(&g, x + i * step, y + j * step) + (size_t)k];
                    next[2 * at(&g, x, y) + (size_t)k] = sum;
                    double top = fmin(fmax(pow((double)o->gain, octave) * sum, -1), 1),
                           *base = n + 3 * at(&g, x, y) + k;
                    /* Photoshop's overlay of two coded values, decoded again. */
                    double lower = (*base + 1) / 2, upper = (top + 1) / 2;
                    double overlay = lower < 0.5 ? 2 * lower * upper : 1 - 2 * (1 - lower) * (1 - upper);
                    *base = overlay * 2 - 1;
                }
        memcpy(b, next, 2 * count * sizeof *next);
    }
    for (size_t i = 0; i < count; i++) {
        double *v = n + 3 * i, length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int k = 0; k < 3; k++)
            v[k] /= length;
    }
    free(h);
    free(b);
    free(next);
}

static void check(int width, int height, int channels, const amb_normal_map_options *o)
{
    amb_context *context = context_of(2);
    amb_image *color = random_image(width, height, channels, (unsigned)(width * 31 + height)), *out = NULL;
    double *want = calloc(3 * (size_t)width * (size_t)height, sizeof *want);
    reference(color, o, want);
    assert_int_equal(amb_normal_map_make(context, color, o, &out, NULL), AMB_OK);
    assert_int_equal(out->channels, 3);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int k = 0; k < 3; k++) {
                double got = (double)amb_image_row(out, k, y)[x], truth = want[3 * (y * width + x) + k];
                if (!(fabs(got - truth) < 4e-6))
                    fail_msg("%d x %d texel (%d, %d) component %d: %.9g, truth %.9g", width, height, x, y, k, got,
                             truth);
            }
    free(want);
    amb_image_close(&out);
    amb_image_close(&color);
    amb_context_close(&context);
}

static void test_matches_the_formulas(void **unused)
{
    (void)unused;
    for (int octaves = 0; octaves <= 6; octaves += 2)
        for (int flags = 0; flags < 4; flags++) {
            amb_normal_map_options o = {.strength = 3.0f,
                                        .octaves = octaves,
                                        .gain = 1.7f,
                                        .wrap_u = flags & 1,
                                        .longitude_latitude = flags & 2};
            check(64, 32, 3, &o);
            check(37, 21, 1, &o);
            check(5, 3, 4, &o);
        }
    check(1, 1, 1,
          &(amb_normal_map_options){
              .strength = 1.0f, .octaves = AMB_MAX_NORMAL_MAP_OCTAVES, .gain = 8.0f, .wrap_u = true});
    check(16, 16, 3, &(amb_normal_map_options){.strength = -40.0f, .octaves = 3, .gain = 4.0f});
}

/* A plane has its own slope everywhere but at the edges; a flat image points straight up. */
static void test_planes(void **unused)
{
    (void)unused;
    amb_context *context = context_of(1);
    amb_image *plane = NULL, *out = NULL;
    assert_int_equal(amb_image_create(32, 32, 1, &plane, NULL), AMB_OK);
    amb_normal_map_options o = {.strength = 2.0f};
    assert_int_equal(amb_normal_map_make(context, plane, &o, &out, NULL), AMB_OK);
    assert_true(amb_image_row(out, 0, 9)[5] == 0.0f && amb_image_row(out, 1, 9)[5] == 0.0f &&
                amb_image_row(out, 2, 9)[5] == 1.0f);
    amb_image_close(&out);
    for (int y = 0; y < 32; y++)
        for (int x = 0; x < 32; x++)
            amb_image_row(plane, 0, y)[x] = 0.5f * (float)x - 0.25f * (float)y; /* slopes 1 and -½ */
    assert_int_equal(amb_normal_map_make(context, plane, &o, &out, NULL), AMB_OK);
    assert_true(fabs((double)amb_image_row(out, 0, 9)[5] + 1.0 / 1.5) < 1e-6); /* leans down the slope: -u */
    assert_true(fabs((double)amb_image_row(out, 1, 9)[5] - 0.5 / 1.5) < 1e-6); /* and +v */
    assert_true(fabs((double)amb_image_row(out, 2, 9)[5] - 1.0 / 1.5) < 1e-6);
    amb_image_close(&out);
    amb_image_close(&plane);
    amb_context_close(&context);
}

static void test_threads_do_not_matter(void **unused)
{
    (void)unused;
    amb_image *color = random_image(200, 90, 3, 7);
    char digest[2][65];
    for (int i = 0; i < 2; i++) {
        amb_context *context = context_of(i ? 5 : 1);
        amb_image *out = NULL;
        amb_normal_map_options o = {.strength = 5.0f, .octaves = 5, .gain = 2.0f, .wrap_u = true};
        assert_int_equal(amb_normal_map_make(context, color, &o, &out, NULL), AMB_OK);
        amb_image_sha256(out, digest[i]);
        amb_image_close(&out);
        amb_context_close(&context);
    }
    assert_string_equal(digest[0], digest[1]);
    amb_image_close(&color);
}

static void test_errors(void **unused)
{
    (void)unused;
    amb_context *context = context_of(1);
    amb_image *color = random_image(4, 4, 3, 1), *two = random_image(4, 4, 2, 1), *out = NULL;
    amb_error error;
    amb_normal_map_options o = {.octaves = 11};
    assert_int_equal(amb_normal_map_make(context, color, &o, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "normal map: octaves is 11; allowed are 0 to 10");
    o = (amb_normal_map_options){.gain = -1.0f};
    assert_int_equal(amb_normal_map_make(context, color, &o, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "normal map: gain is -1; allowed are 0 to 8");
    o = (amb_normal_map_options){.strength = INFINITY};
    assert_int_equal(amb_normal_map_make(context, color, &o, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "normal map: strength is inf; it must be finite");
    o = (amb_normal_map_options){0};
    assert_int_equal(amb_normal_map_make(context, two, &o, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "normal map: the image has 2 channels; allowed are 1, 3 and 4");
    assert_int_equal(amb_normal_map_make(context, NULL, &o, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "normal map: color is NULL");
    assert_int_equal(amb_normal_map_make(context, color, &o, NULL, &error), AMB_ERROR_ARGUMENT);
    assert_null(out);
    amb_image_close(&color);
    amb_image_close(&two);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_matches_the_formulas),
        cmocka_unit_test(test_planes),
        cmocka_unit_test(test_threads_do_not_matter),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
