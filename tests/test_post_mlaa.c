/* MLAA against its definition (truth_mlaa.c), and against what it is for: pictures with many samples a pixel. */
#include "post_frames.h"
#include "truth_mlaa.h"

#include <ambiance/scene.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define THRESHOLD 12.0

/* Linear grey of a CIE L*. */
static float grey(double lightness)
{
    double f = (lightness + 16.0) / 116.0;
    return (float)(lightness > 8.0 ? f * f * f : lightness * 27.0 / 24389.0);
}

static amb_frame *black_frame(int width, int height)
{
    amb_frame *frame;
    assert_int_equal(amb_frame_create(width, height, &frame, NULL), AMB_OK);
    return frame;
}

static void put(const amb_frame *frame, int x, int y, float value)
{
    if (x >= 0 && y >= 0 && x < frame->width && y < frame->height)
        for (int c = 0; c < 3; c++)
            amb_image_row(amb_frame_layer(frame, "color"), c, y)[x] = value;
}

static float layer_at(const amb_frame *frame, const char *name, int channel, int x, int y)
{
    return amb_image_row(amb_frame_layer(frame, name), channel, y)[x];
}

/* Runs the pass and holds every intermediate and the picture to the truth. `frame` is consumed. */
static void check_frame(amb_frame *frame, double threshold, double corners, const char *what)
{
    truth_image truth = truth_of_frame(frame);
    truth_mlaa m = truth_mlaa_detect(&truth, 1.0, threshold);
    char text[64];
    m.corners = corners;
    snprintf(text, sizeof text, "mlaa:threshold=%.9g,corners=%.9g", threshold, corners);
    post_apply(frame, text, AMB_ISA_AUTO, 1, 0, 1);
    /* Where the distance is within rounding of the threshold, either answer is right: take the pass's. */
    for (int y = 0; y < m.height; y++)
        for (int x = 0; x < m.width; x++) {
            size_t i = (size_t)y * (size_t)m.width + (size_t)x;
            int right = layer_at(frame, "mlaa.edges", 0, x, y) != 0.0f;
            int down = layer_at(frame, "mlaa.edges", 1, x, y) != 0.0f;
            if ((right != m.right[i] && m.right_margin[i] > 1e-3) || (down != m.down[i] && m.down_margin[i] > 1e-3))
                fail_msg("%s: discontinuities at (%d, %d) are %d %d, should be %d %d", what, x, y, right, down,
                         m.right[i], m.down[i]);
            m.right[i] = (unsigned char)right;
            m.down[i] = (unsigned char)down;
        }
    truth_mlaa_propagate(&m);
    truth_mlaa_weigh(&m);
    truth_mlaa_blend(&m, &truth);
    for (int y = 0; y < m.height; y++)
        for (int x = 0; x < m.width; x++)
            for (int c = 0; c < 4; c++) {
                int i = y * m.width + x;
                double distance = (double)layer_at(frame, "mlaa.distance", c, x, y);
                double weight = (double)layer_at(frame, "mlaa.weights", c, x, y);
                if (distance != m.distance[c][i])
                    fail_msg("%s: distance %d at (%d, %d) of %dx%d is %g, should be %d", what, c, x, y, m.width,
                             m.height, distance, m.distance[c][i]);
                if (!(fabs(weight - m.weight[c][i]) <= 1e-7)) /* one division and subtraction in single precision */
                    fail_msg("%s: weight %d at (%d, %d) of %dx%d is %.9g, should be %.9g", what, c, x, y, m.width,
                             m.height, weight, m.weight[c][i]);
                if (c < 3) {
                    double got = (double)layer_at(frame, "color", c, x, y), expected = truth_at(&truth, x, y)[c];
                    if (!(fabs(got - expected) <= 5e-7 * (1.0 + fabs(expected))))
                        fail_msg("%s: colour %d at (%d, %d) is %.9g, should be %.9g", what, c, x, y, got, expected);
                }
            }
    truth_mlaa_free(&m);
    truth_free(&truth);
    amb_frame_close(&frame);
}

/* ---- against the definition -------------------------------------------------------------------------------------- */

static void random_pictures_agree(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1},   {1, 40},   {40, 1},    {2, 2},   {63, 5},
                                   {64, 64}, {65, 130}, {200, 150}, {600, 20}};
    uint32_t random = 1;
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int density = 1; density <= 5; density += 2) {
            int width = sizes[s][0], height = sizes[s][1];
            amb_frame *frame = black_frame(width, height); /* binary noise */
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++)
                    put(frame, x, y, post_random(&random) % 6 < (uint32_t)density ? 1.0f : 0.0f);
            check_frame(frame, THRESHOLD, 1.0, "binary noise");
            frame = black_frame(width, height); /* long steps: slanted lines and blocks */
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++)
                    put(frame, x, y, (x * density + y * 17) / 90 % 2 ? 0.9f : (x / 23 + y / 7) % 2 ? 0.3f : 0.05f);
            check_frame(frame, THRESHOLD, 0.25, "slanted lines");
            check_frame(post_picture(width, height, (uint32_t)density), 4.0, 0.5, "HDR picture");
        }
}

/* All sixteen pairs of ends, lengths 1…300, lying and standing. Four greys: A and B are across the line; N is near
 * enough to both to have no edge with either, F far from both. */
static void draw_line(amb_frame *frame, int vertical, int across, int first, int length, int start, int end)
{
    const float a = grey(50), b = grey(66), n = grey(58), f = grey(95);
    const float side_a[4] = {n, b, a, f}, side_b[4] = {n, b, a, f}; /* crossed: none, side a, side b, both */
    for (int i = -1; i <= length; i++) {
        float above = i < 0 ? side_a[start] : i == length ? side_a[end] : a;
        float below = i < 0 ? side_b[start] : i == length ? side_b[end] : b;
        int along = first + i;
        put(frame, vertical ? across : along, vertical ? along : across, above);
        put(frame, vertical ? across + 1 : along, vertical ? along : across + 1, below);
    }
}

/* Shape codes as documented: 1 + 4·start + end; and the line's own pixels must carry the weights of the polygon that an
 * L, Z or U stands for. */
static void check_line(const amb_frame *frame, int vertical, int across, int first, int length, int start, int end)
{
    for (int i = 0; i < length; i++) {
        int x = vertical ? across : first + i, y = vertical ? first + i : across;
        int back = i < 255 ? i : 255, ahead = length - 1 - i < 255 ? length - 1 - i : 255;
        bool sees_start = back == i, sees_end = ahead == length - 1 - i;
        float shape = layer_at(frame, "mlaa.shape", vertical, x, y);
        int code = 1 + 4 * (sees_start ? start : 0) + (sees_end ? end : 0);
        if (shape != (float)code)
            fail_msg("%s line of %d, ends %d %d: shape %g at %d, should be %d", vertical ? "standing" : "lying", length,
                     start, end, (double)shape, i, code);
        int side = back < ahead ? (sees_start ? start : 0) : ahead < back ? (sees_end ? end : 0) : 0;
        double p = back < ahead ? back : ahead, area = 0.5 * (1.0 - (2.0 * p + 1.0) / (back + ahead + 1.0));
        float towards_b = layer_at(frame, "mlaa.weights", vertical ? 3 : 1, x, y);
        float towards_a = layer_at(frame, "mlaa.weights", vertical ? 2 : 0, x + vertical, y + !vertical);
        if (fabs((double)towards_b - (side == 1 ? area : 0.0)) > 1e-7 ||
            fabs((double)towards_a - (side == 2 ? area : 0.0)) > 1e-7)
            fail_msg("%s line of %d, ends %d %d: weights %.9g %.9g at %d", vertical ? "standing" : "lying", length,
                     start, end, (double)towards_b, (double)towards_a, i);
    }
}

static void every_end_pattern_and_length(void **state)
{
    (void)state;
    for (int vertical = 0; vertical < 2; vertical++)
        for (int length = 1; length <= 300; length++) {
            int along = length + 9, across = 16 * 6;
            amb_frame *frame = black_frame(vertical ? across : along, vertical ? along : across);
            for (int i = 0; i < 16; i++)
                draw_line(frame, vertical, 6 * i + 2, 4, length, i / 4, i % 4);
            amb_frame *before = post_copy(frame);
            post_apply(frame, "mlaa:threshold=12,corners=1", AMB_ISA_AUTO, 1, 0, 1);
            for (int i = 0; i < 16; i++)
                check_line(frame, vertical, 6 * i + 2, 4, length, i / 4, i % 4);
            amb_frame_close(&frame);
            if (length % 37 == 1)
                check_frame(before, THRESHOLD, 0.25, "end patterns");
            else
                amb_frame_close(&before);
        }
}

/* Lines that begin or end at the picture's border, there as in the middle, and corners: a border crosses nothing. */
static void lines_at_borders_and_corners(void **state)
{
    (void)state;
    for (int width = 1; width <= 70; width += (width < 8 ? 1 : 31))
        for (int height = 2; height <= 70; height += (height < 8 ? 1 : 31))
            for (int kind = 0; kind < 6; kind++) {
                amb_frame *frame = black_frame(width, height);
                for (int y = 0; y < height; y++)
                    for (int x = 0; x < width; x++) {
                        bool lit = kind == 0   ? y >= height / 2
                                   : kind == 1 ? x >= width / 2
                                   : kind == 2 ? y >= height / 2 && x >= width / 2
                                   : kind == 3 ? y < 1 + x / 5
                                   : kind == 4 ? x < 1 + y / 5
                                               : (x == 0 || y == 0 || x == width - 1 || y == height - 1);
                        put(frame, x, y, lit ? 1.0f : 0.0f);
                    }
                check_frame(frame, THRESHOLD, kind % 2 ? 0.25 : 1.0, "borders");
            }
}

/* The two truths agree with each other: by distances, and by whole lines. */
static void lines_and_distances_agree(void **state)
{
    (void)state;
    uint32_t random = 9;
    for (int i = 0; i < 30; i++) {
        truth_mlaa a = truth_mlaa_new(90, 50), b = truth_mlaa_new(90, 50);
        for (int j = 0; j < 90 * 50; j++) {
            a.right[j] = b.right[j] = j % 90 < 89 && post_random(&random) % 10 < 2 + (uint32_t)i / 5;
            a.down[j] = b.down[j] = j / 90 < 49 && post_random(&random) % 10 < 2 + (uint32_t)i / 5;
        }
        truth_mlaa_propagate(&a);
        truth_mlaa_weigh(&a);
        truth_mlaa_weigh_lines(&b);
        for (int d = 0; d < 4; d++)
            for (int j = 0; j < 90 * 50; j++)
                if (fabs(a.weight[d][j] - b.weight[d][j]) > 1e-12)
                    fail_msg("weight %d at (%d, %d): %g by distances, %g by lines", d, j % 90, j / 90, a.weight[d][j],
                             b.weight[d][j]);
        truth_mlaa_free(&a);
        truth_mlaa_free(&b);
    }
}

/* Lines far longer than a pixel sees, across many tiles. */
static void very_long_lines(void **state)
{
    (void)state;
    for (int vertical = 0; vertical < 2; vertical++) {
        amb_frame *frame = black_frame(vertical ? 12 : 1500, vertical ? 1500 : 12);
        for (int i = 0; i < 1500; i++)
            for (int j = 0; j < 12; j++)
                put(frame, vertical ? j : i, vertical ? i : j,
                    j > 3 + i / 700     ? 1.0f
                    : j == 1 && i % 256 ? 1.0f
                                        : 0.0f);
        check_frame(frame, THRESHOLD, vertical ? 1.0 : 0.125, "very long lines");
    }
}

/* Light that clips to the same white has no edge; exposure moves where that is. */
static void detection_sees_what_the_display_shows(void **state)
{
    (void)state;
    for (int stops = -2; stops <= 0; stops += 2) {
        amb_frame *frame = black_frame(20, 20);
        for (int y = 0; y < 20; y++)
            for (int x = 0; x < 20; x++)
                put(frame, x, y, y < 10 + x / 10 ? 1.2f : 3.0f);
        char text[64];
        snprintf(text, sizeof text, "mlaa:exposure=%d", stops);
        post_apply(frame, text, AMB_ISA_AUTO, 1, 0, 1);
        assert_true(layer_at(frame, "mlaa.edges", 1, 3, 9) == (stops < 0 ? 1.0f : 0.0f));
        amb_frame_close(&frame);
    }
}

/* A blend never leaves the range of the pixel and its neighbours, however many corners meet. */
static void blends_stay_between_neighbours(void **state)
{
    (void)state;
    uint32_t random = 3;
    for (int i = 0; i < 20; i++) {
        amb_frame *frame = black_frame(100, 80);
        for (int y = 0; y < 80; y++)
            for (int x = 0; x < 100; x++)
                put(frame, x, y, (float)(post_random(&random) % 3) * ((x + y) % 7 < 4 ? 0.5f : 0.1f));
        amb_frame *before = post_copy(frame);
        post_apply(frame, "mlaa:threshold=1", AMB_ISA_AUTO, 1, 0, 0);
        for (int y = 1; y < 79; y++)
            for (int x = 1; x < 99; x++) {
                float lo = 1e9f, hi = -1e9f;
                for (int k = 0; k < 5; k++) {
                    float v = layer_at(before, "color", 0, x + (k == 1) - (k == 2), y + (k == 3) - (k == 4));
                    lo = v < lo ? v : lo;
                    hi = v > hi ? v : hi;
                }
                float got = layer_at(frame, "color", 0, x, y);
                assert_true(got >= lo - 1e-6f && got <= hi + 1e-6f);
            }
        amb_frame_close(&frame);
        amb_frame_close(&before);
    }
}

/* ---- does it help? ----------------------------------------------------------------------------------------------- */

#define ART 192 /* pixels a side */

typedef double (*art)(double x, double y); /* light at a point, 0…1 of ART */

/* Slanted bars, a fan of lines and a ring: a city's roofs and wires. */
static double line_art(double x, double y)
{
    double r = hypot(x - 96, y - 96), angle = atan2(y - 8, x - 8);
    if (fabs(r - 70) < 1.5 || fabs(r - 40) < 6)
        return 0.9;
    if (fabs(fmod(angle * 20.0 + 40.0, 1.0) - 0.5) < 0.12 && r < 66)
        return 0.7;
    if (r > 75 && fmod(fabs(0.23 * x + y), 24.0) < 7.0)
        return 0.5;
    return 0.05;
}

/* Strokes of a made-up script on white: stems, bowls, bars, 22 pixels high. */
static double text_art(double x, double y)
{
    int column = (int)(x / 16), row = (int)(y / 24);
    double u = x - 16 * column - 8, v = y - 24 * row - 12;
    uint32_t h = (uint32_t)(column * 7 + row * 13 + 5) * 2654435761u;
    u += 0.2 * v * (row % 3 - 1); /* some lines are slanted */
    bool ink = (h >> 28 & 1 && fabs(u + 5) < 1.3 && fabs(v) < 9) || (h >> 27 & 1 && fabs(hypot(u, v - 3) - 5) < 1.2) ||
               (h >> 26 & 1 && fabs(v - u) < 1.6 && fabs(u) < 7) || (h >> 25 & 1 && fabs(v + 8) < 1.2 && fabs(u) < 6) ||
               (h >> 24 & 1 && fabs(v + 2.3 * u) < 2.8 && fabs(v) < 9);
    return ink ? 0.02 : 0.95;
}

/* Something like the Julia set's outline: a blob whose edge turns through every angle, over a soft ramp. */
static double blob_art(double x, double y)
{
    double a = atan2(y - 96, x - 96), r = hypot(x - 96, y - 96);
    double edge = 60 + 14 * sin(3 * a) + 7 * sin(7 * a + 1) + 3 * sin(19 * a);
    return r < edge ? 0.35 + 0.4 * (x + y) / (2 * ART) : 0.02 + 0.1 * y / ART;
}

static void draw(truth_image *image, art light, int samples)
{
    for (int y = 0; y < ART; y++)
        for (int x = 0; x < ART; x++) {
            double sum = 0.0;
            for (int j = 0; j < samples; j++)
                for (int i = 0; i < samples; i++)
                    sum += light(x + (i + 0.5) / samples, y + (j + 0.5) / samples);
            for (int c = 0; c < 3; c++)
                truth_at(image, x, y)[c] = sum / (samples * samples);
        }
}

static double coded(double a) { return a <= 0.0031308 ? 12.92 * a : 1.055 * pow(a, 1 / 2.4) - 0.055; }

static size_t values(const truth_image *image) { return (size_t)image->width * (size_t)image->height * 3; }

static double shown(double light) { return coded(light < 0.0 ? 0.0 : light > 1.0 ? 1.0 : light); }

static double rmse(const truth_image *a, const truth_image *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < values(a); i++) {
        double d = shown(a->value[i]) - shown(b->value[i]);
        sum += d * d;
    }
    return sqrt(sum / (double)values(a));
}

/* Mean CIE Lab distance of both pictures as an eye blurs them: the luminance kernel of S-CIELAB (X. Zhang, B. Wandell
 * 1996) narrowed to one Gaussian of 0.8 pixels, which is what FLIP's filter comes to at 67 pixels a degree. */
static double perceived(const truth_image *a, const truth_image *b)
{
    double sum = 0.0;
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            double p[3] = {0}, q[3] = {0}, total = 0.0;
            for (int k = 0; k < 25; k++) {
                int i = k % 5 - 2, j = k / 5 - 2;
                double w = exp(-(i * i + j * j) / (2 * 0.64));
                total += w;
                for (int c = 0; c < 3; c++) {
                    p[c] += w * truth_at(a, x + i, y + j)[c];
                    q[c] += w * truth_at(b, x + i, y + j)[c];
                }
            }
            for (int c = 0; c < 3; c++) {
                p[c] /= total;
                q[c] /= total;
            }
            sum += truth_lab_distance(p, q);
        }
    return sum / (double)(values(a) / 3);
}

static void box_blur(truth_image *image)
{
    truth_image from = *image;
    from.value = malloc(sizeof(double) * values(image));
    assert_non_null(from.value);
    memcpy(from.value, image->value, sizeof(double) * values(image));
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0.0;
                for (int k = 0; k < 9; k++)
                    sum += truth_at(&from, x + k % 3 - 1, y + k / 3 - 1)[c];
                truth_at(image, x, y)[c] = sum / 9;
            }
    truth_free(&from);
}

/* `frame` holds the picture of one sample a pixel; it is consumed. By both measures the pass must come closer to the
 * truth than the picture was, and than blurring it would. */
static void check_help(const char *name, amb_frame *frame, const truth_image *truth)
{
    truth_image jagged = truth_of_frame(frame), blurred = truth_of_frame(frame);
    box_blur(&blurred);
    post_apply(frame, "mlaa", AMB_ISA_AUTO, 1, 0, 0);
    truth_image smooth = truth_of_frame(frame);
    double r[3] = {rmse(&jagged, truth), rmse(&blurred, truth), rmse(&smooth, truth)};
    double p[3] = {perceived(&jagged, truth), perceived(&blurred, truth), perceived(&smooth, truth)};
    print_message("%-9s RMSE: none %.4f, 3x3 blur %.4f, mlaa %.4f; perceived: none %.3f, 3x3 blur %.3f, mlaa %.3f\n",
                  name, r[0], r[1], r[2], p[0], p[1], p[2]);
    assert_true(r[2] < r[0] && r[2] < r[1]);
    assert_true(p[2] < p[0] && p[2] < p[1]);
    truth_free(&jagged);
    truth_free(&blurred);
    truth_free(&smooth);
    amb_frame_close(&frame);
}

static void it_helps(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        art light;
    } pictures[] = {{"line art", line_art}, {"text", text_art}, {"blob", blob_art}};
    for (int i = 0; i < 3; i++) {
        amb_frame *frame = black_frame(ART, ART);
        truth_image jagged = truth_of_frame(frame), truth = truth_of_frame(frame);
        draw(&jagged, pictures[i].light, 1);
        draw(&truth, pictures[i].light, 16);
        for (int y = 0; y < ART; y++)
            for (int x = 0; x < ART; x++)
                put(frame, x, y, (float)truth_at(&jagged, x, y)[0]);
        check_help(pictures[i].name, frame, &truth);
        truth_free(&jagged);
        truth_free(&truth);
    }
}

static amb_frame *julia(const amb_context *context, const char *samples)
{
    amb_assets *assets = NULL;
    amb_show *show = NULL;
    amb_frame *frame = NULL;
    amb_error error = {0};
    if (amb_assets_create(context, &(amb_assets_options){.builtin_only = true}, &assets, &error) != AMB_OK ||
        amb_show_open(context, assets, "julia", &show, &error) != AMB_OK ||
        amb_show_set(show, "samples", samples, &error) != AMB_OK ||
        amb_show_render(show, 3.0, 240, 180, NULL, &frame, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    amb_show_close(&show);
    amb_assets_close(&assets);
    return frame;
}

/* The scene itself, against its own sixteen rays a pixel. */
static void it_helps_on_julia(void **state)
{
    (void)state;
    amb_context *context;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    amb_frame *many = julia(context, "16");
    truth_image truth = truth_of_frame(many);
    check_help("julia", julia(context, "1"), &truth);
    truth_free(&truth);
    amb_frame_close(&many);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_pictures_agree),
        cmocka_unit_test(every_end_pattern_and_length),
        cmocka_unit_test(lines_at_borders_and_corners),
        cmocka_unit_test(lines_and_distances_agree),
        cmocka_unit_test(very_long_lines),
        cmocka_unit_test(detection_sees_what_the_display_shows),
        cmocka_unit_test(blends_stay_between_neighbours),
        cmocka_unit_test(it_helps),
        cmocka_unit_test(it_helps_on_julia),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
