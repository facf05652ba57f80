/* Each pass against its plain double-precision version in truth_post.c, with the bound that docs/post.md states. */
#include "post_frames.h"
#include "truth_post.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const int sizes[][2] = {{1, 1}, {1, 12}, {13, 1}, {37, 23}, {64, 64}, {131, 70}, {1030, 11}};
#define SIZES ((int)(sizeof sizes / sizeof *sizes))

/* The largest difference, in units of absolute + relative·|truth|. */
static double difference(const amb_frame *frame, const truth_image *truth, double relative)
{
    truth_image got = truth_of_frame(frame);
    double worst = 0.0;
    for (size_t i = 0; i < (size_t)got.width * (size_t)got.height * 3; i++) {
        double d = fabs(got.value[i] - truth->value[i]) / (1.0 + relative * fabs(truth->value[i]));
        if (!(d <= worst))
            worst = isnan(d) ? HUGE_VAL : d;
    }
    truth_free(&got);
    return worst;
}

typedef struct compared {
    const char *chain;
    double bound; /* absolute, for light 1; grows in proportion for brighter light */
    void (*truth)(truth_image *image);
} compared;

/* Over all sizes: reports the worst and holds it to the bound. */
static void compare(const compared *c, bool negative)
{
    double worst = 0.0;
    for (int s = 0; s < SIZES; s++) {
        amb_frame *frame = post_picture(sizes[s][0], sizes[s][1], (uint32_t)s + 20);
        amb_image *color = amb_frame_layer(frame, "color");
        uint32_t state = 5;
        for (int i = 0; negative && i < 20; i++)
            amb_image_row(
                color, i % 3,
                (int)(post_random(&state) % (uint32_t)color->height))[post_random(&state) % (uint32_t)color->width] =
                i == 7   ? NAN
                : i == 8 ? -3.0f
                         : post_uniform(&state, -2.0f, 100.0f);
        truth_image truth = truth_of_frame(frame);
        c->truth(&truth);
        post_apply(frame, c->chain, AMB_ISA_AUTO, 2, 77, 0);
        for (size_t i = 0; i < (size_t)truth.width * (size_t)truth.height * 3; i++) {
            float *got = &amb_image_row(color, (int)(i % 3), (int)(i / 3) / truth.width)[(int)(i / 3) % truth.width];
            if (isnan(truth.value[i]) && isnan(*got)) {
                truth.value[i] = 0.0;
                *got = 0.0f;
            }
        }
        double d = difference(frame, &truth, 1.0);
        worst = d > worst ? d : worst;
        truth_free(&truth);
        amb_frame_close(&frame);
    }
    print_message("%-60s %.2e (bound %.0e)\n", c->chain, worst, c->bound);
    if (!(worst <= c->bound))
        fail_msg("%s: off by %g, bound %g", c->chain, worst, c->bound);
}

/* ---- bloom ------------------------------------------------------------------------------------------------------- */

static void bloom_half(truth_image *t) { truth_bloom(t, 0.7, 0.3, 1.0, 2); }
static void bloom_quarter(truth_image *t) { truth_bloom(t, 1.0, 0.5, (double)1.7f, 4); }
static void bloom_eighth(truth_image *t) { truth_bloom(t, 0.0, 1.0, 4.0, 8); }

static void bloom_is_true(void **state)
{
    (void)state;
    static const compared c[] = {
        {"bloom:threshold=0.7,intensity=0.3,sigma=1,reduce=half", 1e-6, bloom_half},
        {"bloom:threshold=1,intensity=0.5,sigma=1.7,reduce=quarter", 1e-6, bloom_quarter},
        {"bloom:threshold=0,intensity=1,sigma=4,reduce=eighth", 1e-6, bloom_eighth},
    };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        compare(&c[i], false);
        compare(&c[i], true);
    }
}

static void coursework_weights(truth_image *t) { truth_brightpass(t, (double)0.4f, 2.0, 2, 0, 0); }
static void normalized_weights(truth_image *t) { truth_brightpass(t, (double)0.4f, 0.5, 4, 1, 0); }
static void view(truth_image *t) { truth_brightpass(t, 0.25, 1.0, 2, 0, 1); }

static void brightpass_is_true(void **state)
{
    (void)state;
    static const compared c[] = {
        {"brightpass:cutoff=0.4,glare=2", 5e-7, coursework_weights},
        {"brightpass:cutoff=0.4,glare=0.5,reduce=quarter,weights=normalized", 5e-7, normalized_weights},
        {"brightpass:cutoff=0.25,view=brightpass", 3e-7, view},
    };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        compare(&c[i], false);
        compare(&c[i], true);
    }
}

/* Distance of two floats in units in the last place. */
static int64_t ulps(float a, float b)
{
    int32_t i, j;
    memcpy(&i, &a, sizeof i);
    memcpy(&j, &b, sizeof j);
    return llabs((int64_t)i - (int64_t)j);
}

/* An impulse far from the edges: its blurred self is the Gaussian's three-fold convolution with itself, each way, and
 * it sums to the impulse. At half size and no threshold a 2×2 impulse is exactly one cell of light 1. */
static void an_impulse_gives_the_kernel_and_keeps_its_energy(void **state)
{
    (void)state;
    static const double sigmas[] = {0.3, 0.7, 1.0, 1.7, 2.5, 4.0};
    for (int s = 0; s < 6; s++) {
        double tap[7], kernel[19] = {0}, twice[13] = {0};
        truth_gaussian_taps((double)(float)sigmas[s], tap);
        for (int i = 0; i < 7; i++)
            for (int j = 0; j < 7; j++)
                twice[i + j] += tap[i] * tap[j];
        for (int i = 0; i < 13; i++)
            for (int j = 0; j < 7; j++)
                kernel[i + j] += twice[i] * tap[j];
        amb_frame *frame = post_picture(128, 96, 1);
        amb_image *color = amb_frame_layer(frame, "color");
        memset(color->data, 0, color->stride * 96 * 4 * sizeof(float));
        for (int i = 0; i < 4; i++)
            amb_image_row(color, 1, 48 + i / 2)[64 + i % 2] = 1.0f;
        char text[96];
        snprintf(text, sizeof text, "bloom:threshold=0,intensity=1,reduce=half,sigma=%.9g", sigmas[s]);
        post_apply(frame, text, AMB_ISA_AUTO, 1, 0, 1);
        const amb_image *blurred = amb_frame_layer(frame, "bloom.blurred");
        double sum = 0.0, worst = 0.0;
        for (int y = 0; y < 96; y++)
            for (int x = 0; x < 128; x++) {
                /* Bilinear: ¾ of the own cell, ¼ of the nearer neighbour, each way. */
                double expected = 1.0;
                int cell[2] = {x / 2 - 32 + 9, y / 2 - 24 + 9},
                    near[2] = {cell[0] + (x % 2 ? 1 : -1), cell[1] + (y % 2 ? 1 : -1)};
                for (int a = 0; a < 2; a++)
                    expected *= 0.75 * (cell[a] >= 0 && cell[a] < 19 ? kernel[cell[a]] : 0.0) +
                                0.25 * (near[a] >= 0 && near[a] < 19 ? kernel[near[a]] : 0.0);
                double got = (double)amb_image_row(blurred, 1, y)[x];
                worst = fmax(worst, fabs(got - expected));
                sum += got;
            }
        if (!(worst <= 2e-7) || !(fabs(sum / 4.0 - 1.0) <= 2e-6))
            fail_msg("sigma %g: off by %g, sum %.9g", sigmas[s], worst, sum / 4.0);
        amb_frame_close(&frame);
    }
}

/* The taps sum to 1 within 1 ULP: seen on a picture of one colour, whose glow must be that colour. */
static void a_flat_picture_keeps_its_light(void **state)
{
    (void)state;
    for (int s = 3; s <= 40; s++) {
        amb_frame *frame = post_picture(67, 45, 1);
        amb_image *color = amb_frame_layer(frame, "color");
        for (int c = 0; c < 3; c++)
            for (int y = 0; y < 45; y++)
                for (int x = 0; x < 67; x++)
                    amb_image_row(color, c, y)[x] = 1.0f;
        char text[96];
        snprintf(text, sizeof text, "bloom:threshold=0,intensity=1,sigma=%.9g", 0.1 * s);
        post_apply(frame, text, AMB_ISA_AUTO, 1, 0, 1);
        const amb_image *blurred = amb_frame_layer(frame, "bloom.blurred");
        for (int y = 0; y < 45; y++)
            for (int x = 0; x < 67; x++) /* six convolutions: each may round by an ULP */
                if (ulps(amb_image_row(blurred, 0, y)[x], 1.0f) > 6 + 2)
                    fail_msg("sigma %g: %.9g", 0.1 * s, (double)amb_image_row(blurred, 0, y)[x]);
        amb_frame_close(&frame);
    }
}

static void black_does_not_bloom(void **state)
{
    (void)state;
    amb_frame *frame = post_picture(80, 60, 1), *before = NULL;
    amb_image *color = amb_frame_layer(frame, "color");
    for (size_t i = 0; i < color->stride * 60 * 3; i++)
        color->data[i] = color->data[i] > 1.0f ? 1.0f : color->data[i]; /* white brick, no sun */
    before = post_copy(frame);
    post_apply(frame, "bloom:threshold=1,intensity=1", AMB_ISA_AUTO, 2, 0, 0);
    post_assert_same(frame, before, "no light above the threshold");
    amb_frame_close(&frame);
    amb_frame_close(&before);
}

/* ---- colour ------------------------------------------------------------------------------------------------------ */

static void adjust_plain(truth_image *t)
{
    truth_adjust(t, &(truth_adjustment){0, 1.5, (double)1.2f, (double)0.18f, (double)0.9f, 0.25, 0.125, 1, 4});
}
static void adjust_blurred(truth_image *t)
{
    truth_adjust(t, &(truth_adjustment){0.75, 0, 1, (double)0.18f, 1, 0, 0, (double)1.7f, 4});
}
static void vignetted(truth_image *t) { truth_vignette(t, (double)0.7f); }

static void colour_is_true(void **state)
{
    (void)state;
    static const compared c[] = {
        {"adjust:saturation=1.5,contrast=1.2,brightness=0.9,black=0.25,white=0.125", 2e-6, adjust_plain},
        {"adjust:blur=0.75,saturation=0", 1e-6, adjust_blurred},
        {"vignette:strength=0.7", 5e-7, vignetted},
    };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        compare(&c[i], false);
        compare(&c[i], true);
    }
}

static void grey_grain(truth_image *t) { truth_grain(t, (double)0.3f, 1, 0, 77); }
static void coarse_grain(truth_image *t) { truth_grain(t, (double)0.3f, 5, 1, 77); }
static void near_dispersion(truth_image *t) { truth_dispersion(t, 3.0, 16.0, 77); }
static void far_dispersion(truth_image *t) { truth_dispersion(t, 40.0, 7.0, 77 / 10); }

/* Displacements are rounded to about 1e-6 of a pixel (1e-4 at column 1000), times the steepest slope, 20 a pixel. */
static void noise_is_true(void **state)
{
    (void)state;
    static const compared c[] = {
        {"grain:amount=0.3", 2e-7, grey_grain},
        {"grain:amount=0.3,size=5,colored=true", 2e-7, coarse_grain},
        {"dispersion:amount=3,scale=16", 5e-4, near_dispersion},
        {"dispersion:amount=40,scale=7,hold=10", 5e-3, far_dispersion},
    };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++)
        compare(&c[i], false);
}

/* Grain is centred, and its spread is that of the triangular distribution: σ = amount/√6 at light 1. */
static void grain_has_its_distribution(void **state)
{
    (void)state;
    amb_frame *frame = post_picture(512, 512, 1);
    amb_image *color = amb_frame_layer(frame, "color");
    for (size_t i = 0; i < color->stride * 512 * 3; i++)
        color->data[i] = 1.0f;
    post_apply(frame, "grain:amount=0.5,colored=true", AMB_ISA_AUTO, 2, 3, 0);
    double n = 512.0 * 512.0, cross = 0.0;
    for (int c = 0; c < 3; c++) {
        double sum = 0.0, squares = 0.0;
        for (int i = 0; i < 512 * 512; i++) {
            double v = (double)amb_image_row(color, c, 0)[i] - 1.0;
            sum += v;
            squares += v * v;
            cross += v * ((double)amb_image_row(color, (c + 1) % 3, 0)[i] - 1.0);
        }
        assert_true(fabs(sum / n) < 4 * 0.5 / sqrt(6 * n));
        assert_true(fabs(squares / n / (0.25 / 6.0) - 1.0) < 0.01);
    }
    assert_true(fabs(cross / n) < 0.001);
    amb_frame_close(&frame);
}

/* ---- display ----------------------------------------------------------------------------------------------------- */

static truth_screen screen;
static void shown(truth_image *t) { truth_display(t, &screen); }

static void display_is_true(void **state)
{
    (void)state;
    static const char *const curve[] = {"clamp", "reinhard", "filmic", "aces"};
    static const char *const encode[] = {"srgb", "rec709", "linear"};
    for (int i = 0; i < 12; i++) {
        screen = (truth_screen){0.5 * (i - 6), (double)4.5f, curve[i / 3], encode[i % 3], "none"};
        char text[128];
        snprintf(text, sizeof text, "display:exposure=%g,white=4.5,curve=%s,encode=%s", screen.exposure, screen.curve,
                 screen.encode);
        compare(&(compared){text, 5e-7, shown}, false);
        compare(&(compared){text, 5e-7, shown}, true);
    }
}

/* A dense sweep of the transfer functions: the bound, no step down by more than it, and the ends exact. */
static void encodings_sweep(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const char *text = kind ? "display:encode=rec709" : "display:encode=srgb";
        enum { N = 1024 };
        amb_frame *frame = post_picture(N, N, 1);
        amb_image *color = amb_frame_layer(frame, "color");
        for (int y = 0; y < N; y++)
            for (int x = 0; x < N; x++) /* even and logarithmic steps, in turn */
                for (int c = 0; c < 3; c++)
                    amb_image_row(color, c, y)[x] =
                        c ? (float)(y * N + x) / (float)(N * N - 1) : (float)exp2(-30.0 * (y * N + x) / (N * N - 1.0));
        truth_image truth = truth_of_frame(frame);
        screen = (truth_screen){0, 1, "clamp", kind ? "rec709" : "srgb", "none"};
        truth_display(&truth, &screen);
        post_apply(frame, text, AMB_ISA_AUTO, 2, 0, 0);
        double worst = difference(frame, &truth, 0.0);
        float before = 0.0f;
        for (int i = 0; i < N * N; i++) {
            float now = amb_image_row(color, 1, i / N)[i % N];
            assert_true(now >= before - 4e-7f && now <= 1.0f);
            before = now;
        }
        print_message("%s: %.2e (bound 4e-07)\n", text, worst);
        assert_true(worst <= 4e-7);
        assert_true(amb_image_row(color, 1, 0)[0] == 0.0f && amb_image_row(color, 1, N - 1)[N - 1] == 1.0f);
        truth_free(&truth);
        amb_frame_close(&frame);
    }
}

/* Dithered values are 8-bit levels; their mean is the undithered value, and no pixel is off by a whole level. */
static void dither_keeps_the_mean(void **state)
{
    (void)state;
    static const char *const kinds[] = {"ordered", "gradient"};
    for (int k = 0; k < 2; k++)
        for (int level = 0; level <= 40; level++) {
            float value = level == 40 ? 1.0f : 0.002f + 0.0247f * (float)level;
            amb_frame *frame = post_picture(256, 256, 1);
            amb_image *color = amb_frame_layer(frame, "color");
            for (size_t i = 0; i < color->stride * 256 * 3; i++)
                color->data[i] = value;
            char text[64];
            snprintf(text, sizeof text, "display:encode=linear,dither=%s", kinds[k]);
            post_apply(frame, text, AMB_ISA_AUTO, 1, 0, 0);
            double sum = 0.0;
            for (int i = 0; i < 256 * 256; i++) {
                double got = (double)amb_image_row(color, 0, 0)[i] * 255.0;
                assert_true(fabs(got - round(got)) < 1e-4);
                assert_true(fabs(got - 255.0 * (double)value) < 1.0);
                sum += got;
            }
            double mean = sum / 65536.0 - 255.0 * (double)value;
            if (!(fabs(mean) < (k ? 0.01 : 1.0 / 64.0)))
                fail_msg("%s at %g: mean off by %g levels", kinds[k], (double)value, mean);
            amb_frame_close(&frame);
        }
}

static void ordered_dither_is_bayers(void **state)
{
    (void)state;
    amb_frame *frame = post_picture(64, 64, 4);
    truth_image truth = truth_of_frame(frame);
    screen = (truth_screen){0, 1, "clamp", "linear", "ordered"};
    truth_display(&truth, &screen);
    post_apply(frame, "display:encode=linear,dither=ordered", AMB_ISA_AUTO, 1, 0, 0);
    int different = 0; /* a value within rounding of a threshold may go either way */
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 64; x++)
            for (int c = 0; c < 3; c++)
                different += fabs(truth_at(&truth, x, y)[c] -
                                  (double)amb_image_row(amb_frame_layer(frame, "color"), c, y)[x]) > 1e-6;
    assert_true(different <= 3);
    truth_free(&truth);
    amb_frame_close(&frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bloom_is_true),
        cmocka_unit_test(brightpass_is_true),
        cmocka_unit_test(an_impulse_gives_the_kernel_and_keeps_its_energy),
        cmocka_unit_test(a_flat_picture_keeps_its_light),
        cmocka_unit_test(black_does_not_bloom),
        cmocka_unit_test(colour_is_true),
        cmocka_unit_test(noise_is_true),
        cmocka_unit_test(grain_has_its_distribution),
        cmocka_unit_test(display_is_true),
        cmocka_unit_test(encodings_sweep),
        cmocka_unit_test(dither_keeps_the_mean),
        cmocka_unit_test(ordered_dither_is_bayers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
