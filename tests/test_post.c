/* The post chain itself: its text, its errors, and what holds for every pass: the same bits everywhere, bad pixels
 * contained, odd sizes, fades that keep their hue. */
#include "post_frames.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Every pass, with parameters away from their defaults. */
static const char *const every_pass[] = {
    "mlaa:threshold=5",
    "mlaa:threshold=5,corners=1",
    "dispersion:amount=7,scale=20",
    "exposure:stops=-1.5",
    "bloom:threshold=0.6,intensity=0.5",
    "bloom:reduce=half,sigma=0.8",
    "bloom:reduce=eighth,sigma=3",
    "brightpass:cutoff=0.4",
    "brightpass:view=brightpass",
    "adjust:blur=0.6,saturation=1.5,contrast=1.2,brightness=0.9,black=0.1,white=0.2",
    "vignette:strength=0.8",
    "grain:amount=0.2,size=3,colored=true",
    "display:curve=filmic,dither=ordered",
    "display:curve=reinhard,encode=rec709,dither=gradient",
    "display:curve=aces",
    "mlaa;dispersion;bloom;brightpass;adjust:blur=0.2;vignette;grain;display:curve=filmic",
};
#define PASSES ((int)(sizeof every_pass / sizeof *every_pass))

static const int sizes[][2] = {{1, 1},   {1, 9},   {9, 1},   {2, 2},    {3, 5},
                               {16, 16}, {17, 33}, {63, 65}, {129, 70}, {530, 67}};
#define SIZES ((int)(sizeof sizes / sizeof *sizes))

static void every_isa_and_thread_count_gives_the_same_bits(void **state)
{
    (void)state;
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    static const int threads[] = {1, 2, 5};
    for (int s = 0; s < SIZES; s++) {
        amb_frame *picture = post_picture(sizes[s][0], sizes[s][1], (uint32_t)s);
        for (int p = 0; p < PASSES; p++) {
            amb_frame *first = NULL;
            for (int i = 0; i < 9; i++) {
                if (!amb_isa_available(isas[i / 3]) || (i % 3 != s % 3 && sizes[s][0] < 60))
                    continue; /* small ones take turns with the thread counts */
                amb_frame *frame = post_copy(picture);
                post_apply(frame, every_pass[p], isas[i / 3], threads[i % 3], 7, s % 2);
                if (first) {
                    post_assert_same(first, frame, every_pass[p]);
                    amb_frame_close(&frame);
                } else {
                    first = frame;
                }
            }
            amb_frame_close(&first);
        }
        amb_frame_close(&picture);
    }
}

/* Every pass does something, or the tests above would pass for passes that do nothing. */
static void every_pass_changes_the_picture(void **state)
{
    (void)state;
    amb_frame *picture = post_picture(129, 70, 3);
    for (int p = 0; p < PASSES; p++) {
        amb_frame *frame = post_copy(picture);
        post_apply(frame, every_pass[p], AMB_ISA_AUTO, 2, 1, 0);
        const amb_image *a = amb_frame_layer(picture, "color"), *b = amb_frame_layer(frame, "color");
        assert_memory_not_equal(a->data, b->data, a->stride * (size_t)a->height * 3 * sizeof(float));
        for (int y = 0; y < a->height; y++) /* and leaves alpha alone */
            assert_memory_equal(amb_image_row(a, 3, y), amb_image_row(b, 3, y), (size_t)a->width * sizeof(float));
        amb_frame_close(&frame);
    }
    amb_frame_close(&picture);
}

/* A chain's fused sweep gives what its passes give one at a time. */
static void fusing_changes_nothing(void **state)
{
    (void)state;
    amb_frame *fused = post_picture(211, 103, 5), *single = post_copy(fused);
    post_apply(fused,
               "exposure:stops=0.5;bloom;adjust:blur=0.3,saturation=0.7;grain;vignette;bloom:reduce=half;display",
               AMB_ISA_AUTO, 2, 4, 0);
    static const char *const parts[] = {
        "exposure:stops=0.5", "bloom",  "adjust:blur=0.3,saturation=0.7", "grain", "vignette",
        "bloom:reduce=half",  "display"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        post_apply(single, parts[i], AMB_ISA_AUTO, 1, 4, 0);
    post_assert_same(fused, single, "fused chain");
    amb_frame_close(&fused);
    amb_frame_close(&single);
}

/* One chain over many frames reuses memory: the second frame must not see the first's. */
static void a_chain_may_be_used_again(void **state)
{
    (void)state;
    amb_context *context;
    amb_chain *chain;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    assert_int_equal(amb_chain_create(context, every_pass[PASSES - 1], &chain, NULL), AMB_OK);
    for (int i = 0; i < 4; i++) {
        amb_frame *a = post_picture(100 + 40 * (i % 3), 80, (uint32_t)i), *b = post_copy(a);
        assert_int_equal(amb_chain_apply(chain, a, i, 0, NULL), AMB_OK);
        post_apply(b, every_pass[PASSES - 1], AMB_ISA_AUTO, 0, i, 0);
        post_assert_same(a, b, "a chain's later frame");
        amb_frame_close(&a);
        amb_frame_close(&b);
    }
    amb_chain_close(&chain);
    amb_chain_close(&chain);
    amb_context_close(&context);
}

/* ---- bad pixels -------------------------------------------------------------------------------------------------- */

/* How far from a bad pixel a pass may look: none of these may turn NaN or infinite. */
static void bad_pixels_stay_alone(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, -5.0f};
    for (int p = 0; p < PASSES; p++)
        for (int b = 0; b < 6; b++) {
            amb_frame *frame = post_picture(80, 60, 11);
            amb_image *color = amb_frame_layer(frame, "color");
            amb_image_row(color, b % 3, 31)[40] = bad[b];
            amb_image_row(color, 1, 0)[0] = bad[b];
            post_apply(frame, every_pass[p], AMB_ISA_AUTO, 2, 1, 0);
            for (int y = 0; y < 60; y++)
                for (int x = 0; x < 80; x++)
                    for (int c = 0; c < 3; c++) {
                        float value = amb_image_row(color, c, y)[x];
                        bool own = (x == 40 && y == 31) || (x == 0 && y == 0);
                        if (!own && !(fabsf(value) < 1e6f))
                            fail_msg("%s: %g beside the bad pixel %g, at (%d, %d)", every_pass[p], (double)value,
                                     (double)bad[b], x, y);
                        if (strncmp(every_pass[p], "display", 7) == 0 && !(value >= 0.0f && value <= 1.0f))
                            fail_msg("%s: display value %g", every_pass[p], (double)value);
                    }
            amb_frame_close(&frame);
        }
}

static void wide_and_tall_pictures(void **state)
{
    (void)state;
    static const int size[][2] = {{16384, 3}, {5, 4096}};
    for (int i = 0; i < 2; i++) {
        amb_frame *a = post_picture(size[i][0], size[i][1], 2), *b = post_copy(a);
        post_apply(a, every_pass[PASSES - 1], AMB_ISA_AUTO, 2, 1, 0);
        post_apply(b, every_pass[PASSES - 1], AMB_ISA_V2, 1, 1, 0);
        post_assert_same(a, b, "wide or tall");
        amb_frame_close(&a);
        amb_frame_close(&b);
    }
}

/* Frame indices repeat exactly and differ from each other, negative ones too. */
static void noise_repeats_by_frame_index(void **state)
{
    (void)state;
    static const char *const noisy[] = {"grain:amount=0.3", "dispersion:amount=9"};
    static const long index[] = {0, 1, 2, -1, 1000000007, 5000000000};
    for (int p = 0; p < 2; p++) {
        amb_frame *frame[6];
        for (int i = 0; i < 6; i++) {
            frame[i] = post_picture(90, 50, 1);
            post_apply(frame[i], noisy[p], AMB_ISA_AUTO, 2, index[i], 0);
            amb_frame *again = post_picture(90, 50, 1);
            post_apply(again, noisy[p], AMB_ISA_AUTO, 1, index[i], 0);
            post_assert_same(frame[i], again, noisy[p]);
            amb_frame_close(&again);
            const amb_image *color = amb_frame_layer(frame[i], "color");
            for (int j = 0; j < i; j++)
                assert_memory_not_equal(color->data, amb_frame_layer(frame[j], "color")->data,
                                        color->stride * 50 * sizeof(float));
        }
        for (int i = 0; i < 6; i++)
            amb_frame_close(&frame[i]);
    }
}

/* ---- the fade to black of the Ambiance report, figure 55
 * ----------------------------------------------------------------------- */

/* A sun of light (9, 7, 2.5) is white on the screen. Fading to black in HDR keeps the ratio of its channels, so its
 * yellow comes back; fading what the screen shows would give grey. */
static void fading_to_black_keeps_the_sun_yellow(void **state)
{
    (void)state;
    static const float sun[3] = {9.0f, 7.0f, 2.5f};
    for (int step = 0; step <= 10; step++) {
        amb_frame *hdr = post_picture(40, 30, 1);
        amb_image *color = amb_frame_layer(hdr, "color");
        for (int y = 0; y < 30; y++)
            for (int x = 0; x < 40; x++)
                for (int c = 0; c < 3; c++) /* its texture: stripes */
                    amb_image_row(color, c, y)[x] = sun[c] * (x % 4 < 2 ? 1.0f : 0.8f);
        char text[64];
        snprintf(text, sizeof text, "adjust:black=%.9g", 0.1 * step);
        post_apply(hdr, text, AMB_ISA_AUTO, 1, 0, 0);
        float fade = 1.0f - (float)(0.1 * step);
        for (int c = 0; c < 3; c++) {
            assert_true(fabsf(amb_image_row(color, c, 5)[4] - sun[c] * fade) <= 2e-6f);
            assert_true(fabsf(amb_image_row(color, c, 5)[6] - 0.8f * sun[c] * fade) <= 2e-6f);
        }
        amb_frame *shown = post_copy(hdr);
        post_apply(shown, "display:curve=clamp", AMB_ISA_AUTO, 1, 0, 0);
        const amb_image *screen = amb_frame_layer(shown, "color");
        const float *r = amb_image_row(screen, 0, 5), *b = amb_image_row(screen, 2, 5);
        if (step == 0)
            assert_true(r[4] == 1.0f && b[4] == 1.0f && r[6] == 1.0f); /* clipped white, texture lost */
        if (step == 9)
            assert_true(r[4] > 1.5f * b[4] && r[6] < r[4]); /* yellow, and the stripes are back */
        amb_frame_close(&hdr);
        amb_frame_close(&shown);
    }
}

static void fade_to_white_and_black_arrive(void **state)
{
    (void)state;
    amb_frame *frame = post_picture(40, 30, 8);
    post_apply(frame, "adjust:white=1", AMB_ISA_AUTO, 1, 0, 0);
    const amb_image *color = amb_frame_layer(frame, "color");
    for (int x = 0; x < 40; x++)
        assert_true(amb_image_row(color, 1, 3)[x] == 1.0f);
    post_apply(frame, "adjust:black=1", AMB_ISA_AUTO, 1, 0, 0);
    for (int x = 0; x < 40; x++)
        assert_true(amb_image_row(color, 1, 3)[x] == 0.0f);
    amb_frame_close(&frame);
}

/* ---- text -------------------------------------------------------------------------------------------------------- */

static void check_error(const amb_context *context, const char *text, amb_status status, const char *part)
{
    amb_error error = {0};
    amb_chain *chain = (amb_chain *)&error;
    amb_status got = amb_chain_create(context, text, &chain, &error);
    if (got != status || !strstr(error.detail, part) || strchr(error.detail, '\n') || chain)
        fail_msg("'%s': status %d, '%s'; expected %d and '%s'", text, got, error.detail, status, part);
}

static void errors_are_one_clear_line(void **state)
{
    (void)state;
    amb_context *context;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    check_error(context, "blooom", AMB_ERROR_NOT_FOUND, "unknown post pass: blooom; did you mean bloom?");
    check_error(context, "bloom:tresh=1", AMB_ERROR_NOT_FOUND, "post pass bloom has no parameter 'tresh'");
    check_error(context, "bloom:threshold=-1", AMB_ERROR_ARGUMENT, "post pass bloom, parameter threshold: '-1'");
    check_error(context, "bloom:threshold=nan", AMB_ERROR_ARGUMENT, "'nan'");
    check_error(context, "bloom:threshold", AMB_ERROR_ARGUMENT, "'threshold' is not name=value");
    check_error(context, "display:curve=fil", AMB_ERROR_ARGUMENT, "one of clamp, reinhard, filmic, aces");
    check_error(context, "bloom;;display", AMB_ERROR_ARGUMENT, "pass 2 has no name");
    check_error(context, ";", AMB_ERROR_ARGUMENT, "pass 1 has no name");
    char long_chain[512] = "";
    for (size_t i = 0; i < AMB_MAX_CHAIN + 1; i++)
        memcpy(long_chain + 6 * i, "bloom;", 7);
    check_error(context, long_chain, AMB_ERROR_LIMIT, "at most 32 passes");
    amb_context_close(&context);
}

static void text_reads_back(void **state)
{
    (void)state;
    static const char *const texts[][2] = {
        {"", ""},
        {" none ", ""},
        {"exposure", "exposure:stops=0"},
        {" exposure : stops = 1.5 ; ", "exposure:stops=1.5"},
        {"vignette ;exposure:stops=0.1", "vignette:strength=0.5;exposure:stops=0.1"},
        {"grain:size=2,amount=0.25", "grain:amount=0.25,size=2,colored=false"},
    };
    amb_context *context;
    amb_chain *chain;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char printed[256], again[256], cut[8];
        assert_int_equal(amb_chain_create(context, texts[i][0], &chain, NULL), AMB_OK);
        int length = amb_chain_print(chain, printed, sizeof printed);
        assert_string_equal(printed, texts[i][1]);
        assert_int_equal(length, strlen(printed));
        assert_int_equal(amb_chain_print(chain, cut, sizeof cut), length);
        assert_true(strlen(cut) < sizeof cut && strncmp(cut, printed, strlen(cut)) == 0);
        assert_int_equal(amb_chain_print(chain, NULL, 0), length);
        amb_chain_close(&chain);
        assert_int_equal(amb_chain_create(context, printed, &chain, NULL), AMB_OK);
        amb_chain_print(chain, again, sizeof again);
        assert_string_equal(printed, again);
        amb_chain_close(&chain);
    }
    amb_context_close(&context);
}

static void unfit_frames_are_refused(void **state)
{
    (void)state;
    amb_context *context;
    amb_chain *chain;
    amb_error error;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    assert_int_equal(amb_chain_create(context, "mlaa;bloom", &chain, NULL), AMB_OK);
    amb_frame *frame = post_picture(20, 20, 1);
    amb_image *layer;
    assert_int_equal(amb_frame_add_layer(frame, "mlaa.edges", 1, &layer, NULL), AMB_OK);
    assert_int_equal(amb_chain_apply(chain, frame, 0, 1, &error), AMB_ERROR_ARGUMENT);
    assert_non_null(strstr(error.detail, "mlaa.edges"));
    for (int i = 0; frame->layer_count < AMB_MAX_LAYERS; i++) {
        char name[16];
        snprintf(name, sizeof name, "l%d", i);
        assert_int_equal(amb_frame_add_layer(frame, name, 1, &layer, NULL), AMB_OK);
    }
    assert_int_equal(amb_chain_apply(chain, frame, 0, 0, &error), AMB_OK);
    amb_chain_close(&chain);
    assert_int_equal(amb_chain_create(context, "bloom", &chain, NULL), AMB_OK);
    assert_int_equal(amb_chain_apply(chain, frame, 0, 1, &error), AMB_ERROR_LIMIT);
    amb_frame_close(&frame);
    amb_chain_close(&chain);
    amb_context_close(&context);
}

/* Intermediates have the names that the documentation promises, and colour is the same with and without them. */
static void intermediates_are_layers(void **state)
{
    (void)state;
    static const char *const names[] = {"mlaa.edges",   "mlaa.distance", "mlaa.shape",        "mlaa.weights",
                                        "bloom.bright", "bloom.blurred", "brightpass.bright", "brightpass.blurred"};
    amb_frame *with = post_picture(75, 41, 2), *without = post_copy(with);
    post_apply(with, "mlaa;bloom;brightpass", AMB_ISA_AUTO, 2, 0, 1);
    post_apply(without, "mlaa;bloom;brightpass", AMB_ISA_AUTO, 2, 0, 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_non_null(amb_frame_layer(with, names[i]));
    assert_int_equal(with->layer_count, 9);
    assert_int_equal(without->layer_count, 1);
    with->layer_count = 1; /* compare colour alone */
    post_assert_same(with, without, "intermediates");
    with->layer_count = 9;
    amb_frame_close(&with);
    amb_frame_close(&without);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_isa_and_thread_count_gives_the_same_bits),
        cmocka_unit_test(every_pass_changes_the_picture),
        cmocka_unit_test(fusing_changes_nothing),
        cmocka_unit_test(a_chain_may_be_used_again),
        cmocka_unit_test(bad_pixels_stay_alone),
        cmocka_unit_test(wide_and_tall_pictures),
        cmocka_unit_test(noise_repeats_by_frame_index),
        cmocka_unit_test(fading_to_black_keeps_the_sun_yellow),
        cmocka_unit_test(fade_to_white_and_black_arrive),
        cmocka_unit_test(errors_are_one_clear_line),
        cmocka_unit_test(text_reads_back),
        cmocka_unit_test(unfit_frames_are_refused),
        cmocka_unit_test(intermediates_are_layers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
