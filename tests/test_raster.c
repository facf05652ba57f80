/* Coverage: exactly the truth rasterizer's pixels, and every pixel of a mesh exactly once. */
#include "raster/internal.h"
#include "tests/raster_shaders.h"
#include "tests/truth_raster.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- random numbers and triangles ---------------------------------------------------------------------------------
 */

static uint64_t random_state = 1;

static uint32_t random_bits(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = random_state ^ random_state >> 33;
    return (uint32_t)((x * 0xff51afd7ed558ccdu) >> 32);
}
static double uniform(double lo, double hi) { return lo + (hi - lo) * (random_bits() / 4294967296.0); }
static int pick(int count) { return (int)(random_bits() % (uint32_t)count); }

/* Clip coordinates of a window position; exact where width and height are powers of two and w is one. */
static v4 at_window(double x, double y, double z, double w, int width, int height)
{
    return (v4){(float)((x / (width * 0.5) - 1.0) * w), (float)((1.0 - y / (height * 0.5)) * w), (float)(z * w),
                (float)w};
}

enum { TINY, MEDIUM, SLIVER, HUGE_ONE, ON_CENTRES, DEGENERATE, CLIPPED, GUARD, QUARTER, PERSPECTIVE, KINDS };

static void random_triangle(int kind, raster_test_vertex v[3], int width, int height)
{
    double cx = uniform(-4, width + 4), cy = uniform(-4, height + 4), far_out = uniform(1e3, 1e5);
    double angle = uniform(0, 6.2831853), length = uniform(1, 80);
    for (int i = 0; i < 3; i++) {
        double x = cx, y = cy, z = uniform(0, 1), w = 1;
        switch (kind) {
        case TINY:
            x += uniform(-1.5, 1.5), y += uniform(-1.5, 1.5);
            break;
        case MEDIUM:
            x += uniform(-20, 20), y += uniform(-20, 20);
            break;
        case SLIVER:
            x += cos(angle) * length * (i - 1) + uniform(-0.02, 0.02);
            y += sin(angle) * length * (i - 1) + uniform(-0.02, 0.02);
            break;
        case HUGE_ONE:
            x += uniform(-far_out, far_out), y += uniform(-far_out, far_out);
            break;
        case ON_CENTRES:
            x = pick(width) + 0.5, y = pick(height) + 0.5;
            break;
        case DEGENERATE:
            x = floor(cx) + i * pick(3), y = floor(cy) + i * pick(2);
            break;
        case CLIPPED:
            x += uniform(-90, 90), y += uniform(-90, 90), z = uniform(-1, 2), w = uniform(-1.5, 2);
            break;
        case GUARD:
            x += uniform(-2e6, 2e6), y += uniform(-40, 40) * pick(50000), w = uniform(0.01, 3);
            break;
        case QUARTER:
            x = pick(width * 4) / 4.0, y = pick(height * 4) / 4.0;
            break;
        default:
            x += uniform(-30, 30), y += uniform(-30, 30), w = exp(uniform(-9, 9));
            break;
        }
        v[i].clip = at_window(x, y, z, w, width, height);
    }
}

/* ---- against the truth --------------------------------------------------------------------------------------------
 */

typedef struct canvas {
    int width, height, triangle;
    float *count, *sum;
} canvas;

static void add_pixel(void *user, int x, int y)
{
    canvas *c = user;
    c->count[y * c->width + x] += 1.0f;
    c->sum[y * c->width + x] += (float)(c->triangle % 61 + 1);
}

/* D3D's standard positions, sixteenths of a pixel from the centre, by log2 of their number. */
static const int8_t positions[4][16] = {
    {0, 0}, {4, 4, -4, -4}, {-2, -6, 6, -2, -6, 2, 2, 6}, {1, -3, -1, 3, 5, 1, -3, -5, -5, 5, -7, -1, 3, 7, 7, -7}};

typedef struct setting {
    const amb_context *context;
    int width, height, tile_size, log_samples;
} setting;

/* Counts, in a truth's canvas, the samples that every triangle owns. */
static canvas count_truth(const setting *s, const raster_test_vertex *vertex, int triangles)
{
    canvas truth = {.width = s->width, .height = s->height};
    truth.count = calloc((size_t)(s->width * s->height), sizeof *truth.count);
    truth.sum = calloc((size_t)(s->width * s->height), sizeof *truth.sum);
    for (int i = 0; i < triangles; i++) {
        float clip[3][4];
        truth_triangle piece[7];
        for (int k = 0; k < 3; k++)
            memcpy(clip[k], &vertex[i * 3 + k].clip, sizeof clip[k]);
        truth.triangle = i;
        int pieces = truth_clip((const float(*)[4])clip, s->width, s->height, 1, piece);
        for (int p = 0; p < pieces; p++)
            for (int n = 0; n < 1 << s->log_samples; n++)
                truth_fill_sample(&piece[p], s->width, s->height, positions[s->log_samples][2 * n],
                                  positions[s->log_samples][2 * n + 1], add_pixel, &truth);
    }
    return truth;
}

/* Draws triangles in one additive pass: how often each, and the sum of their numbers. */
static amb_image *draw_added(const setting *s, amb_draw draw)
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(s->context));
    amb_image *image = NULL;
    amb_pass *pass = NULL;
    assert_int_equal(amb_image_create(s->width, s->height, 2, &image, NULL), AMB_OK);
    amb_target target = {.color = {image}, .samples = 1 << s->log_samples};
    assert_int_equal(raster_pass_begin(s->context, &target, s->tile_size, RASTER_BATCH_BYTES, &pass, NULL), AMB_OK);
    draw.lanes = shaders->lanes, draw.vertex = shaders->vertex, draw.fragment = shaders->one;
    draw.uniforms_size = sizeof(raster_test_uniforms);
    draw.varying_floats = 4;
    draw.blend[0] = AMB_BLEND_ADD;
    assert_int_equal(amb_pass_draw(pass, &draw, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
    return image;
}

/* How many pixels differ from the truth? Sums of small whole numbers, over 1, 2, 4 or 8, are exact. */
static int differing_pixels(const setting *s, const raster_test_vertex *vertex, int triangles)
{
    raster_test_uniforms uniforms = {.vertex = vertex};
    amb_image *image = draw_added(s, (amb_draw){.uniforms = &uniforms, .count = (uint32_t)triangles * 3});
    canvas truth = count_truth(s, vertex, triangles);
    int differences = 0;
    float samples = (float)(1 << s->log_samples);
    for (int y = 0; y < s->height; y++)
        for (int x = 0; x < s->width; x++)
            differences += amb_image_row(image, 0, y)[x] != truth.count[y * s->width + x] / samples ||
                           amb_image_row(image, 1, y)[x] != truth.sum[y * s->width + x] / samples;
    free(truth.count);
    free(truth.sum);
    amb_image_close(&image);
    return differences;
}

static int random_batch(const setting *s, int kind, int triangles)
{
    raster_test_vertex *vertex = calloc((size_t)triangles * 3, sizeof *vertex);
    for (int i = 0; i < triangles; i++) {
        random_triangle(kind, vertex + i * 3, s->width, s->height);
        for (int k = 0; k < 3; k++)
            vertex[i * 3 + k].value = (v4){(float)(i % 61 + 1), 0, 0, 0};
    }
    int differences = differing_pixels(s, vertex, triangles);
    free(vertex);
    return differences;
}

static bool long_form(void) { return getenv("AMBIANCE_TEST_LONG") != NULL; }

static void random_triangles_cover_the_truth(void **state)
{
    (void)state;
    const int sizes[4][2] = {{64, 64}, {61, 67}, {64, 64}, {96, 33}};
    const int batch = 2500;
    int64_t per_kind = long_form() ? 1000000 : 100000, drawn = 0;
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (int kind = 0; kind < KINDS; kind++) {
        int64_t differences = 0;
        for (int64_t i = 0; i < per_kind; i += batch) {
            const int *size = sizes[i / batch % 4];
            differences += random_batch(&(setting){context, size[0], size[1], 64, 0}, kind, batch);
            drawn += batch;
        }
        if (differences)
            print_error("kind %d: %lld pixels differ\n", kind, (long long)differences);
        assert_int_equal(differences, 0);
    }
    print_message("%lld random triangles, 0 differing pixels\n", (long long)drawn);
    amb_context_close(&context);
}

/* The truth's two forms agree: row by row, and pixel by pixel. */
static void the_truth_agrees_with_itself(void **state)
{
    (void)state;
    enum { WIDTH = 40, HEIGHT = 36 };
    for (int i = 0; i < 3000; i++) {
        raster_test_vertex v[3];
        float clip[3][4], count[WIDTH * HEIGHT] = {0}, sum[WIDTH * HEIGHT];
        random_triangle(i % KINDS, v, WIDTH, HEIGHT);
        for (int k = 0; k < 3; k++)
            memcpy(clip[k], &v[k].clip, sizeof clip[k]);
        truth_triangle piece[7];
        int n = i / KINDS % 8, dx = positions[3][2 * n], dy = positions[3][2 * n + 1];
        canvas c = {.width = WIDTH, .height = HEIGHT, .count = count, .sum = sum};
        int pieces = truth_clip((const float(*)[4])clip, WIDTH, HEIGHT, 1, piece);
        for (int p = 0; p < pieces; p++)
            truth_fill_sample(&piece[p], WIDTH, HEIGHT, dx, dy, add_pixel, &c);
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            int owned = 0;
            for (int k = 0; k < pieces; k++)
                owned += truth_area(&piece[k]) != 0 && truth_covers_sample(&piece[k], p % WIDTH, p / WIDTH, dx, dy);
            assert_true(count[p] == (float)owned);
        }
    }
}

static void every_variant_covers_the_truth(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    const int threads[] = {1, 2, 5}, tiles[] = {16, 32, 128};
    for (int i = 0; i < 3; i++) {
        amb_context *context = NULL;
        if (!amb_isa_available(isas[i]))
            continue;
        for (int k = 0; k < 3; k++) {
            amb_context_options options = {isas[i], threads[k]};
            assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
            for (int kind = 0; kind < KINDS; kind++)
                for (int samples = 0; samples < 4; samples++)
                    assert_int_equal(random_batch(&(setting){context, 150, 131, tiles[k], samples}, kind, 250), 0);
            amb_context_close(&context);
        }
    }
}

/* ---- meshes -------------------------------------------------------------------------------------------------------
 */

/* With a random number of samples a pixel. */
static int pixels_not_covered_once(const amb_context *context, const raster_test_vertex *vertex, uint32_t vertices,
                                   const uint32_t *index, uint32_t count, int size)
{
    raster_test_uniforms uniforms = {.vertex = vertex};
    amb_image *image =
        draw_added(&(setting){context, size, size, 64, pick(4)},
                   (amb_draw){.uniforms = &uniforms, .indices = index, .count = count, .vertex_count = vertices});
    int wrong = 0;
    for (int y = 0; y < size; y++)
        for (int x = 0; x < size; x++)
            wrong += amb_image_row(image, 0, y)[x] != 1.0f;
    amb_image_close(&image);
    return wrong;
}

/* A grid larger than the window, its inner points moved at random, each quad cut along a random diagonal; `plane`
 * tilts it in depth so that every vertex has its own w. */
static int jittered_grid(const amb_context *context, int cells, int size, bool plane)
{
    int side = cells + 1;
    raster_test_vertex *vertex = calloc((size_t)(side * side), sizeof *vertex);
    uint32_t *index = malloc((size_t)(cells * cells) * 6 * sizeof *index), *next = index;
    double step = (size + 8.0) / cells;
    for (int i = 0; i < side * side; i++) {
        double x = i % side * step - 4 + uniform(-0.15, 0.15) * step,
               y = i / side * step - 4 + uniform(-0.15, 0.15) * step;
        bool border = i % side == 0 || i / side == 0 || i % side == cells || i / side == cells;
        if (border)
            x = i % side * step - 4, y = i / side * step - 4;
        if (pick(3) == 0 && !border && step > 8)
            x = floor(x) + 0.5, y = floor(y) + 0.5;
        vertex[i].clip = at_window(x, y, 0.5, plane ? 1.0 + x * 0.01 : 1.0, size, size);
    }
    for (int y = 0; y < cells; y++)
        for (int x = 0; x < cells; x++) {
            uint32_t a = (uint32_t)(y * side + x), b = a + 1, c = a + (uint32_t)side, d = c + 1;
            const uint32_t cut[2][6] = {{a, b, c, b, d, c}, {a, b, d, a, d, c}};
            memcpy(next, cut[pick(2)], sizeof cut[0]);
            next += 6;
        }
    int wrong =
        pixels_not_covered_once(context, vertex, (uint32_t)(side * side), index, (uint32_t)(next - index), size);
    free(vertex);
    free(index);
    return wrong;
}

/* Spokes from a point inside the window to a rim far outside. */
static int fan(const amb_context *context, int spokes, int size, double radius)
{
    raster_test_vertex *vertex = calloc((size_t)spokes + 1, sizeof *vertex);
    uint32_t *index = malloc((size_t)spokes * 3 * sizeof *index);
    double cx = uniform(0, size), cy = uniform(0, size), phase = uniform(0, 6);
    if (pick(2))
        cx = floor(cx) + 0.5, cy = floor(cy) + 0.5;
    vertex[spokes].clip = at_window(cx, cy, 0.5, 1, size, size);
    for (int i = 0; i < spokes; i++) {
        double angle = phase + 6.283185307 * i / spokes;
        vertex[i].clip =
            at_window(cx + radius * cos(angle), cy + radius * sin(angle), 0.5, uniform(0.5, 2), size, size);
        index[i * 3] = (uint32_t)spokes, index[i * 3 + 1] = (uint32_t)i,
                  index[i * 3 + 2] = (uint32_t)((i + 1) % spokes);
    }
    int wrong = pixels_not_covered_once(context, vertex, (uint32_t)spokes + 1, index, (uint32_t)spokes * 3, size);
    free(vertex);
    free(index);
    return wrong;
}

/* The ground seen from just above it, reaching behind the eye: near-clipped grid cells must still meet. */
static int ground(const amb_context *context, int cells, int size)
{
    int side = cells + 1;
    raster_test_vertex *vertex = calloc((size_t)(side * side), sizeof *vertex);
    uint32_t *index = malloc((size_t)(cells * cells) * 6 * sizeof *index), *next = index;
    for (int i = 0; i < side * side; i++) {
        double x = (i % side - cells * 0.5) * 3, z = (i / side - cells * 0.2) * 3; /* two fifths of it behind the eye */
        double tilt = 1.2, y = -1.5, view_y = y * cos(tilt) + z * sin(tilt), view_z = z * cos(tilt) - y * sin(tilt);
        vertex[i].clip = (v4){(float)x, (float)view_y, (float)((view_z - 0.1) * 1.001), (float)view_z};
    }
    for (int y = 0; y < cells; y++)
        for (int x = 0; x < cells; x++) {
            uint32_t a = (uint32_t)(y * side + x), b = a + 1, c = a + (uint32_t)side, d = c + 1;
            memcpy(next, (uint32_t[6]){a, b, c, b, d, c}, 6 * sizeof *next);
            next += 6;
        }
    int wrong =
        pixels_not_covered_once(context, vertex, (uint32_t)(side * side), index, (uint32_t)(next - index), size);
    free(vertex);
    free(index);
    return wrong;
}

static void meshes_cover_every_pixel_once(void **state)
{
    (void)state;
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (int i = 0; i < 40; i++) {
        assert_int_equal(jittered_grid(context, 1 + pick(90), 130, i % 2 != 0), 0);
        assert_int_equal(ground(context, 5 + pick(60), 120), 0);
        assert_int_equal(fan(context, 3 + pick(400), 97, i % 3 == 0 ? 9e4 : 1000), 0);
    }
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_truth_agrees_with_itself),
        cmocka_unit_test(random_triangles_cover_the_truth),
        cmocka_unit_test(every_variant_covers_the_truth),
        cmocka_unit_test(meshes_cover_every_pixel_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
