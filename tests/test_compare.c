/* The comparison library against values worked out by hand and against a plain count in double precision. */
#include <ambiance/compare.h>

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static float from_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void ulp_counts_representable_floats(void **state)
{
    (void)state;
    assert_int_equal(amb_ulp_distance(1.0f, 1.0f), 0);
    assert_int_equal(amb_ulp_distance(1.0f, 1.0f + FLT_EPSILON), 1);
    assert_int_equal(amb_ulp_distance(1.0f, 1.0f - FLT_EPSILON), 2); /* floats are twice as dense below 1 */
    assert_int_equal(amb_ulp_distance(1.0f, 2.0f), 1 << 23);
    assert_int_equal(amb_ulp_distance(0.0f, -0.0f), 0);
    assert_int_equal(amb_ulp_distance(-0.0f, from_bits(1)), 1);                 /* smallest denormal */
    assert_int_equal(amb_ulp_distance(from_bits(0x80000003), from_bits(4)), 7); /* -3 to +4 denormals, one zero */
    assert_int_equal(amb_ulp_distance(-1.0f, 1.0f), 2 * 0x3f800000ll);
    assert_int_equal(amb_ulp_distance(FLT_MAX, INFINITY), 1);
    assert_int_equal(amb_ulp_distance(-INFINITY, INFINITY), 2ll * 0x7f800000ll);
    assert_true(amb_ulp_distance(NAN, 1.0f) == UINT64_MAX);
    assert_true(amb_ulp_distance(NAN, NAN) == UINT64_MAX);
}

/* Steps from one float to the next with the library function, an independent way to count. */
static void ulp_agrees_with_nextafter(void **state)
{
    (void)state;
    const float starts[] = {-3.0f, -FLT_MIN, -from_bits(5), 0.0f, from_bits(9), 0.999f, 16777215.0f};
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        float value = starts[i];
        for (uint64_t steps = 0; steps < 40; steps++) {
            assert_int_equal(amb_ulp_distance(starts[i], value), steps);
            assert_int_equal(amb_ulp_distance(value, starts[i]), steps);
            value = nextafterf(value, INFINITY);
        }
    }
}

static amb_frame *new_frame(int width, int height)
{
    amb_frame *frame;
    assert_int_equal(amb_frame_create(width, height, &frame, NULL), AMB_OK);
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                amb_image_row(frame->layer[0].image, c, y)[x] = (float)(c + 1) + (float)(y * width + x) / 64.0f;
    return frame;
}

static amb_comparison *compare(const amb_frame *a, const amb_frame *b, const amb_compare_options *options)
{
    amb_comparison *c;
    amb_error error = {0};
    assert_int_equal(amb_compare_frames(a, b, options, &c, &error), AMB_OK);
    return c;
}

static void equal_frames_pass(void **state)
{
    (void)state;
    amb_frame *a = new_frame(5, 3), *b = new_frame(5, 3);
    amb_image_row(a->layer[0].image, 1, 2)[4] = NAN; /* the same bits on both sides */
    amb_image_row(b->layer[0].image, 1, 2)[4] = NAN;
    amb_comparison *c = compare(a, b, NULL);
    assert_true(c->passed);
    assert_int_equal(c->row_count, 4);
    assert_int_equal(c->total.values, 60);
    assert_int_equal(c->total.differing, 0);
    assert_int_equal(c->total.worst_x, -1);
    assert_true(isinf(c->total.psnr));
    free(c);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

/* Differences 0.5 at (1,0), -0.25 at (3,2) of green; 15 pixels. By hand: squares 0.25 + 0.0625 = 0.3125. */
static void numbers_by_hand(void **state)
{
    (void)state;
    amb_frame *a = new_frame(5, 3), *b = new_frame(5, 3);
    amb_image_row(b->layer[0].image, 1, 0)[1] += 0.5f;
    amb_image_row(b->layer[0].image, 1, 2)[3] -= 0.25f;
    amb_comparison *c = compare(a, b, &(amb_compare_options){.peak = 4.0});
    const amb_difference *green = &c->row[1].difference;
    assert_false(c->passed);
    assert_int_equal(green->values, 15);
    assert_int_equal(green->differing, 2);
    assert_int_equal(green->over, 2);
    assert_true(green->max_abs == 0.5);
    assert_int_equal(green->worst_x, 1);
    assert_int_equal(green->worst_y, 0);
    assert_int_equal(green->max_ulp, 1 << 21); /* 2.015625 and 2.515625 lie in [2, 4): steps of 2^-22 */
    assert_true(fabs(green->rmse - 0.14433756729740643) < 1e-15);   /* √(0.3125/15) */
    assert_true(fabs(green->psnr - 28.853612200315123) < 1e-9);     /* 20·log10(4/0.14433756…) */
    assert_true(fabs(c->total.rmse - 0.07216878364870322) < 1e-15); /* √(0.3125/60) */
    assert_int_equal(c->row[0].difference.differing, 0);
    assert_int_equal(c->row[2].difference.differing, 0);
    free(c);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

static bool passes(const amb_frame *a, const amb_frame *b, amb_compare_options options)
{
    amb_comparison *c = compare(a, b, &options);
    bool passed = c->passed;
    assert_true(passed == (c->total.over == 0));
    free(c);
    return passed;
}

static void tolerances_are_inclusive(void **state)
{
    (void)state;
    amb_frame *a = new_frame(2, 2), *b = new_frame(2, 2);
    float *value = &amb_image_row(b->layer[0].image, 0, 1)[1];
    *value += 0.125f;
    assert_true(passes(a, b, (amb_compare_options){.use_tolerance = true, .tolerance = 0.125}));
    assert_false(passes(a, b, (amb_compare_options){.use_tolerance = true, .tolerance = 0.1249}));
    uint64_t ulp = amb_ulp_distance(*value, *value - 0.125f);
    assert_true(passes(a, b, (amb_compare_options){.use_ulp = true, .max_ulp = ulp}));
    assert_false(passes(a, b, (amb_compare_options){.use_ulp = true, .max_ulp = ulp - 1}));
    /* Either is enough. */
    assert_true(passes(a, b, (amb_compare_options){.use_ulp = true, .use_tolerance = true, .tolerance = 0.2}));
    amb_frame_close(&a);
    amb_frame_close(&b);
}

static void zeros_and_nans(void **state)
{
    (void)state;
    amb_frame *a = new_frame(2, 1), *b = new_frame(2, 1);
    float *in_a = amb_image_row(a->layer[0].image, 2, 0), *in_b = amb_image_row(b->layer[0].image, 2, 0);
    in_a[0] = 0.0f;
    in_b[0] = -0.0f;
    assert_false(passes(a, b, (amb_compare_options){0})); /* exact means bits */
    assert_true(passes(a, b, (amb_compare_options){.use_tolerance = true}));
    assert_true(passes(a, b, (amb_compare_options){.use_ulp = true}));

    in_b[1] = NAN; /* against a number: over any tolerance */
    amb_compare_options loose = {
        .use_tolerance = true, .tolerance = (double)INFINITY, .use_ulp = true, .max_ulp = UINT64_MAX};
    assert_false(passes(a, b, loose));
    amb_comparison *c = compare(a, b, NULL);
    assert_int_equal(c->total.nan, 1);
    assert_int_equal(c->total.differing, 2);
    assert_true(c->total.max_abs == 0.0);
    assert_true(c->total.rmse == 0.0);
    free(c);

    in_a[1] = from_bits(0x7fc00001); /* two NaNs of different bits differ */
    in_b[1] = from_bits(0x7fc00002);
    assert_false(passes(a, b, loose));
    in_a[1] = in_b[1] = INFINITY;
    assert_true(passes(a, b, (amb_compare_options){.use_tolerance = true}));
    in_a[1] = -INFINITY;
    c = compare(a, b, NULL);
    assert_true(isinf(c->total.max_abs));
    free(c);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

static void layers_must_match(void **state)
{
    (void)state;
    amb_frame *a = new_frame(3, 2), *b = new_frame(3, 2);
    amb_image *image;
    assert_int_equal(amb_frame_add_layer(a, "depth", 1, &image, NULL), AMB_OK);
    assert_int_equal(amb_frame_add_layer(b, "normal", 3, &image, NULL), AMB_OK);
    amb_comparison *c = compare(a, b, NULL);
    assert_false(c->passed);
    assert_int_equal(c->row_count, 8);
    assert_int_equal(c->row[4].presence, AMB_ONLY_IN_A);
    assert_string_equal(c->row[4].layer, "depth");
    assert_int_equal(c->row[7].presence, AMB_ONLY_IN_B);
    assert_int_equal(c->row[7].channel, 2);
    free(c);
    assert_true(passes(a, b, (amb_compare_options){.layer = "color"}));

    amb_error error = {0};
    assert_int_equal(amb_compare_frames(a, b, &(amb_compare_options){.layer = "dept"}, &c, &error),
                     AMB_ERROR_NOT_FOUND);
    assert_string_equal(error.detail, "unknown layer: dept; did you mean depth?");
    assert_null(c);
    assert_int_equal(
        amb_compare_frames(a, b, &(amb_compare_options){.use_tolerance = true, .tolerance = -1.0}, &c, &error),
        AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "tolerance: -1; 0 or more is allowed");
    assert_int_equal(
        amb_compare_frames(a, b, &(amb_compare_options){.use_tolerance = true, .tolerance = (double)NAN}, &c, &error),
        AMB_ERROR_ARGUMENT);
    amb_frame_close(&b);
    b = new_frame(2, 3);
    c = compare(a, b, NULL);
    assert_true(c->sizes_differ);
    assert_false(c->passed);
    assert_int_equal(c->row_count, 0);
    free(c);
    amb_frame *difference;
    assert_int_equal(amb_compare_difference(a, b, NULL, &difference, &error), AMB_ERROR_ARGUMENT);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

static void difference_image(void **state)
{
    (void)state;
    amb_frame *a = new_frame(3, 2), *b = new_frame(3, 2), *d;
    amb_image_row(b->layer[0].image, 0, 1)[2] -= 0.75f;
    amb_image_row(b->layer[0].image, 3, 0)[0] = NAN;
    assert_int_equal(amb_compare_difference(a, b, NULL, &d, NULL), AMB_OK);
    for (int channel = 0; channel < 4; channel++)
        for (int y = 0; y < 2; y++)
            for (int x = 0; x < 3; x++) {
                float expected = channel == 0 && y == 1 && x == 2   ? 0.75f
                                 : channel == 3 && y == 0 && x == 0 ? INFINITY
                                                                    : 0.0f;
                assert_true(amb_image_row(d->layer[0].image, channel, y)[x] == expected);
            }
    amb_frame_close(&a);
    amb_frame_close(&b);
    amb_frame_close(&d);
}

/* A larger pair against a plain count; odd width so that row padding, which differs, must not be read. */
static void against_a_plain_count(void **state)
{
    (void)state;
    amb_frame *a, *b;
    assert_int_equal(amb_frame_create(131, 67, &a, NULL), AMB_OK);
    assert_int_equal(amb_frame_create(131, 67, &b, NULL), AMB_OK);
    uint32_t random = 12345;
    long double squares = 0;
    double greatest = 0;
    uint64_t differing = 0, over = 0;
    for (int y = 0; y < 67; y++) {
        float *row_a = amb_image_row(a->layer[0].image, 0, y), *row_b = amb_image_row(b->layer[0].image, 0, y);
        for (int x = 0; x < 131; x++) {
            random = random * 1664525u + 1013904223u;
            row_a[x] = (float)(int32_t)random * 1e-9f;
            row_b[x] = random >> 30 ? row_a[x] : row_a[x] + (float)(random & 0xffff) * 1e-4f;
            double distance = fabs((double)row_a[x] - (double)row_b[x]);
            squares += (long double)distance * (long double)distance;
            greatest = distance > greatest ? distance : greatest;
            differing += row_a[x] != row_b[x];
            over += distance > 2.5;
        }
        for (size_t x = 131; x < a->layer[0].image->stride; x++)
            row_a[x] = 99.0f;
    }
    amb_difference d = amb_compare_channel(a->layer[0].image, b->layer[0].image, 0,
                                           &(amb_compare_options){.use_tolerance = true, .tolerance = 2.5});
    assert_true(differing > 1000 && over > 100);
    assert_int_equal(d.differing, differing);
    assert_int_equal(d.over, over);
    assert_true(d.max_abs == greatest);
    assert_true(fabs(d.rmse - sqrt((double)(squares / (131.0L * 67.0L)))) < 1e-12 * d.rmse);
    amb_frame_close(&a);
    amb_frame_close(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ulp_counts_representable_floats),
        cmocka_unit_test(ulp_agrees_with_nextafter),
        cmocka_unit_test(equal_frames_pass),
        cmocka_unit_test(numbers_by_hand),
        cmocka_unit_test(tolerances_are_inclusive),
        cmocka_unit_test(zeros_and_nans),
        cmocka_unit_test(layers_must_match),
        cmocka_unit_test(difference_image),
        cmocka_unit_test(against_a_plain_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
