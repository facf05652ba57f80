/* What reaches the fragment shader, against double precision: depth, perspective-correct varyings, quad derivatives. */
#include "tests/raster_shaders.h"
#include "tests/truth_raster.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE 48

static uint64_t random_state = 7;

static double uniform(double lo, double hi)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(random_state >> 40) / 16777216.0;
}

static int next_pick(int count) { return (int)(uniform(0, 1) * count); }

typedef struct fixture {
    amb_context *context;
    amb_image *color[3], *depth;
    raster_test_vertex vertex[3];
    int samples;
    amb_topology topology;
    truth_triangle pieces[7]; /* of the triangle, clipped */
} fixture;

static void open_fixture(fixture *f, amb_isa isa)
{
    amb_context_options options = {.isa = isa, .threads = 1};
    assert_int_equal(amb_context_create(&options, &f->context, NULL), AMB_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(amb_image_create(SIZE, SIZE, 4, &f->color[i], NULL), AMB_OK);
    assert_int_equal(amb_image_create(SIZE, SIZE, 1, &f->depth, NULL), AMB_OK);
}

static void close_fixture(fixture *f)
{
    for (int i = 0; i < 3; i++)
        amb_image_close(&f->color[i]);
    amb_image_close(&f->depth);
    amb_context_close(&f->context);
}

/* A triangle in front of the eye, with its own w, depth and values at each corner; true if it has an area. */
static bool random_triangle(fixture *f, double spread, double log_w)
{
    double cx = uniform(0, SIZE), cy = uniform(0, SIZE);
    float clip[3][4];
    for (int i = 0; i < 3; i++) {
        double w = exp(uniform(-log_w, log_w)), z = uniform(0.001, 0.999);
        double x = cx + uniform(-spread, spread), y = cy + uniform(-spread, spread);
        f->vertex[i].clip =
            (v4){(float)((x / (SIZE * 0.5) - 1) * w), (float)((1 - y / (SIZE * 0.5)) * w), (float)(z * w), (float)w};
        f->vertex[i].value = (v4){(float)uniform(-8, 8), (float)uniform(0, 1), (float)uniform(-1e4, 1e4), 3.25f};
        memcpy(clip[i], &f->vertex[i].clip, sizeof clip[i]);
    }
    return truth_clip(clip, SIZE, SIZE, 1, f->pieces) == 1 && truth_area(f->pieces) != 0;
}

static void draw(fixture *f)
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(f->context));
    raster_test_uniforms uniforms = {.vertex = f->vertex};
    amb_target target = {.color = {f->color[0], f->color[1], f->color[2]},
                         .depth = f->depth,
                         .clear_depth = 1.0f,
                         .samples = f->samples};
    amb_pass *pass = NULL;
    amb_draw d = {.lanes = shaders->lanes,
                  .vertex = shaders->vertex,
                  .fragment = shaders->value,
                  .uniforms = &uniforms,
                  .uniforms_size = sizeof uniforms,
                  .varying_floats = 4,
                  .topology = f->topology,
                  .count = 3};
    assert_int_equal(amb_pass_begin(f->context, &target, &pass, NULL), AMB_OK);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
}

/* Component c of the value at the corners of a piece of the triangle. */
static void corner_values(const fixture *f, const truth_triangle *piece, int c, double corner[3])
{
    for (int i = 0; i < 3; i++) {
        corner[i] = 0;
        for (int k = 0; k < 3; k++)
            corner[i] += piece->weight[i][k] * (double)(&f->vertex[k].value.x)[c];
    }
}

static double true_value(const fixture *f, const truth_triangle *piece, int x, int y, int c, double *condition)
{
    double corner[3];
    corner_values(f, piece, c, corner);
    return truth_value(piece, corner, x, y, 0, 0, condition);
}

static double largest(const fixture *f, int component)
{
    double m = 0;
    for (int i = 0; i < 3; i++)
        m = fmax(m, fabs((double)(&f->vertex[i].value.x)[component]));
    return m;
}

typedef struct errors {
    double depth, value, derivative; /* in units of 2⁻²⁴ of the largest corner value, times the condition */
    int64_t pixels;
} errors;

static void check_pixel(const fixture *f, const truth_triangle *piece, int x, int y, errors *worst)
{
    const double unit = 0x1p-24, depth = fmin(fmax(truth_depth(piece, x, y, 0, 0), 0), 1);
    double condition;
    worst->depth = fmax(worst->depth, fabs((double)amb_image_row(f->depth, 0, y)[x] - depth) / unit);
    assert_true(amb_image_row(f->depth, 0, y)[x] == amb_image_row(f->color[2], 2, y)[x]);
    for (int c = 0; c < 4; c++) {
        double truth = true_value(f, piece, x, y, c, &condition);
        double error = fabs((double)amb_image_row(f->color[0], c, y)[x] - truth) / (unit * largest(f, c));
        worst->value = fmax(worst->value, error);
    }
    assert_true(amb_image_row(f->color[0], 3, y)[x] == 3.25f); /* a constant stays exactly constant */
    double along[2], conditions[2];
    for (int axis = 0; axis < 2; axis++) { /* x, then y */
        double c0, c1;
        int x0 = axis ? x : x & ~1, y0 = axis ? y & ~1 : y;
        along[axis] = true_value(f, piece, x0 + !axis, y0 + axis, 0, &c1) - true_value(f, piece, x0, y0, 0, &c0);
        conditions[axis] = fmax(c0, c1) * fmax(c0, c1);
        double got = (double)amb_image_row(f->color[1], axis, y)[x];
        worst->derivative =
            fmax(worst->derivative, fabs(got - along[axis]) / (unit * largest(f, 0) * conditions[axis]));
    }
    assert_true(amb_image_row(f->color[1], 2, y)[x] == (float)x + 0.5f);
    assert_true(amb_image_row(f->color[1], 3, y)[x] == (float)y + 0.5f);
    worst->pixels++;
}

static void shading_inputs_match_double_precision(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    for (int i = 0; i < 3; i++) {
        fixture f = {0};
        errors worst = {0};
        if (!amb_isa_available(isas[i]))
            continue;
        open_fixture(&f, isas[i]);
        for (int n = 0; n < 2400; n++) {
            const double spreads[] = {3, 15, 60, 3000, 50000}, ws[] = {0, 1, 4};
            if (!random_triangle(&f, spreads[n % 5], ws[n / 5 % 3]))
                continue;
            draw(&f);
            for (int y = 0; y < SIZE; y++)
                for (int x = 0; x < SIZE; x++) {
                    bool covered = truth_covers(f.pieces, x, y) != 0;
                    assert_int_equal(covered, amb_image_row(f.color[2], 3, y)[x] == 1.0f);
                    if (covered)
                        check_pixel(&f, f.pieces, x, y, &worst);
                }
        }
        print_message("%s: %lld pixels; worst errors in 2^-24: depth %.2f, varyings %.2f, derivatives %.2f\n",
                      amb_isa_name(isas[i]), (long long)worst.pixels, worst.depth, worst.value, worst.derivative);
        assert_true(worst.pixels > 100000);
        assert_true(worst.depth <= 4.0);
        assert_true(worst.value <= 8.0);
        assert_true(worst.derivative <= 12.0);
        close_fixture(&f);
    }
}

/* A triangle that the near plane, the far plane or the guard band cuts; how many pieces are left. */
static int random_clipped_triangle(fixture *f)
{
    float clip[3][4];
    for (int i = 0; i < 3; i++) {
        double far_out = next_pick(4) == 0 ? 1e6 : 3, w = uniform(-1, 3);
        f->vertex[i].clip =
            (v4){(float)uniform(-far_out, far_out), (float)uniform(-3, 3), (float)(uniform(-1, 1.5) * w), (float)w};
        f->vertex[i].value = (v4){(float)uniform(-8, 8), (float)uniform(0, 1), (float)uniform(-1e4, 1e4), 3.25f};
        memcpy(clip[i], &f->vertex[i].clip, sizeof clip[i]);
    }
    return truth_clip((const float(*)[4])clip, SIZE, SIZE, 1, f->pieces);
}

/* Clipping makes new corners; values on the pieces are still the triangle's. */
static void clipped_triangles_keep_their_values(void **state)
{
    (void)state;
    fixture f = {0};
    errors worst = {0};
    int clipped = 0;
    open_fixture(&f, AMB_ISA_AUTO);
    for (int n = 0; n < 3000; n++) {
        int pieces = random_clipped_triangle(&f);
        clipped += pieces > 1;
        if (pieces == 0)
            continue;
        draw(&f);
        for (int i = 0; i < pieces; i++)
            for (int y = 0; y < SIZE && truth_area(&f.pieces[i]) != 0; y++)
                for (int x = 0; x < SIZE; x++)
                    if (truth_covers(&f.pieces[i], x, y))
                        check_pixel(&f, &f.pieces[i], x, y, &worst);
    }
    print_message("%d clipped, %lld pixels; worst errors in 2^-24: depth %.2f, varyings %.2f, derivatives %.2f\n",
                  clipped, (long long)worst.pixels, worst.depth, worst.value, worst.derivative);
    assert_true(clipped > 500 && worst.pixels > 100000);
    assert_true(worst.depth <= 4.0);
    assert_true(worst.value <= 8.0);
    assert_true(worst.derivative <= 12.0);
    close_fixture(&f);
}

/* With samples the shader runs at the pixel's centre, covered or not, and each sample has the depth of its own place.
 */
static void samples_have_their_own_depth(void **state)
{
    (void)state;
    static const int first[4][2] = {{0, 0}, {4, 4}, {-2, -6}, {1, -3}}; /* sample 0: what a resolved depth is */
    fixture f = {0};
    double worst = 0;
    long pixels = 0;
    open_fixture(&f, AMB_ISA_AUTO);
    for (int n = 0; n < 1200; n++) {
        int log_samples = n % 4;
        if (!random_triangle(&f, n % 3 ? 40 : 3000, 1))
            continue;
        f.samples = 1 << log_samples;
        draw(&f);
        for (int y = 0; y < SIZE; y++)
            for (int x = 0; x < SIZE; x++) {
                int dx = first[log_samples][0], dy = first[log_samples][1];
                float depth = amb_image_row(f.depth, 0, y)[x];
                if (!truth_covers_sample(f.pieces, x, y, dx, dy)) {
                    assert_true(depth == 1.0f);
                    continue;
                }
                worst = fmax(worst, fabs((double)depth - truth_depth(f.pieces, x, y, dx, dy)) * 0x1p24);
                pixels++;
            }
    }
    print_message("%ld samples; worst depth error %.2f of 2^-24\n", pixels, worst);
    assert_true(pixels > 100000 && worst <= 4.0);
    close_fixture(&f);
}

/* Along a line t is that of the pixel's centre on the longer axis, clamped to the ends; depth is linear in it, values
 * perspective-correct. All of a point has its vertex's. */
static void check_line_pixel(const fixture *f, int x, int y, errors *worst)
{
    const truth_triangle *t = f->pieces;
    double dx = (double)(t->x[1] - t->x[0]), dy = (double)(t->y[1] - t->y[0]), depth;
    double along =
        fabs(dy) > fabs(dx) ? (256.0 * y + 128 - (double)t->y[0]) / dy : (256.0 * x + 128 - (double)t->x[0]) / dx;
    along = f->topology == AMB_POINTS ? 0 : fmin(fmax(along, 0), 1);
    const v4 *a = &f->vertex[0].clip, *b = &f->vertex[1].clip;
    double wa = (1 - along) / (double)a->w, wb = along / (double)b->w;
    depth = (1 - along) * (double)a->z / (double)a->w + along * (double)b->z / (double)b->w;
    worst->depth = fmax(worst->depth, fabs((double)amb_image_row(f->depth, 0, y)[x] - depth) * 0x1p24);
    for (int c = 0; c < 4; c++) {
        double truth = (wa * (double)(&f->vertex[0].value.x)[c] + wb * (double)(&f->vertex[1].value.x)[c]) / (wa + wb);
        double error = fabs((double)amb_image_row(f->color[0], c, y)[x] - truth) * 0x1p24 / largest(f, c);
        worst->value = fmax(worst->value, error);
        if (f->topology == AMB_POINTS)
            assert_true(amb_image_row(f->color[0], c, y)[x] == (&f->vertex[0].value.x)[c]);
    }
    worst->pixels++;
}

static void lines_and_points_interpolate(void **state)
{
    (void)state;
    fixture f = {0};
    errors worst = {0};
    open_fixture(&f, AMB_ISA_AUTO);
    for (int n = 0; n < 6000; n++) {
        const double spreads[] = {3, 60, 3000};
        f.topology = n % 4 ? AMB_LINES : AMB_POINTS;
        if (!random_triangle(&f, spreads[n % 3], n % 2 ? 3 : 0))
            continue;
        if (f.topology == AMB_POINTS)
            f.vertex[1] = f.vertex[2] = f.vertex[0]; /* three times over itself: depth LESS keeps the first */
        draw(&f);
        for (int y = 0; y < SIZE; y++)
            for (int x = 0; x < SIZE; x++)
                if (amb_image_row(f.color[2], 3, y)[x] == 1.0f)
                    check_line_pixel(&f, x, y, &worst);
    }
    print_message("%lld pixels; worst errors in 2^-24: depth %.2f, varyings %.2f\n", (long long)worst.pixels,
                  worst.depth, worst.value);
    assert_true(worst.pixels > 20000);
    assert_true(worst.depth <= 4.0);
    assert_true(worst.value <= 8.0);
    close_fixture(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clipped_triangles_keep_their_values),
        cmocka_unit_test(samples_have_their_own_depth),
        cmocka_unit_test(lines_and_points_interpolate),
        cmocka_unit_test(shading_inputs_match_double_precision),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
