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

typedef struct fixture {
    amb_context *context;
    amb_image *color[3], *depth;
    raster_test_vertex vertex[3];
    truth_triangle pieces[7]; /* of the triangle; only the first is used: nothing here is clipped */
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
    amb_target target = {.color = {f->color[0], f->color[1], f->color[2]}, .depth = f->depth, .clear_depth = 1.0f};
    amb_pass *pass = NULL;
    amb_draw d = {.lanes = shaders->lanes,
                  .vertex = shaders->vertex,
                  .fragment = shaders->value,
                  .uniforms = &uniforms,
                  .uniforms_size = sizeof uniforms,
                  .varying_floats = 4,
                  .count = 3};
    assert_int_equal(amb_pass_begin(f->context, &target, &pass, NULL), AMB_OK);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
}

/* The exact weights of the corners at a pixel centre, from the snapped window triangle. */
static void screen_weights(const truth_triangle *t, int x, int y, double weight[3])
{
    int64_t px = 256 * (int64_t)x + 128, py = 256 * (int64_t)y + 128;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t cross = (t->x[k] - t->x[j]) * (py - t->y[j]) - (t->y[k] - t->y[j]) * (px - t->x[j]);
        weight[i] = (double)cross / (double)truth_area(t);
    }
}

static double value_of(const v4 *v, int component) { return (double)(&v->x)[component]; }

/* The perspective-correct value, and the condition: how much larger the terms are than their sum. */
static double true_value(const fixture *f, int x, int y, int component, double *condition)
{
    double weight[3], sum = 0, size = 0, top = 0;
    screen_weights(f->pieces, x, y, weight);
    for (int i = 0; i < 3; i++) {
        double p = weight[i] / (double)f->vertex[i].clip.w;
        sum += p, size += fabs(p);
        top += p * value_of(&f->vertex[i].value, component);
    }
    *condition = size / fabs(sum);
    return top / sum;
}

static double largest(const fixture *f, int component)
{
    double m = 0;
    for (int i = 0; i < 3; i++)
        m = fmax(m, fabs(value_of(&f->vertex[i].value, component)));
    return m;
}

typedef struct errors {
    double depth, value, derivative; /* in units of 2⁻²⁴ of the largest corner value, times the condition */
    int64_t pixels;
} errors;

static void check_pixel(const fixture *f, int x, int y, errors *worst)
{
    const double unit = 0x1p-24;
    double weight[3], depth = 0, condition;
    screen_weights(f->pieces, x, y, weight);
    for (int i = 0; i < 3; i++)
        depth += weight[i] * (double)f->vertex[i].clip.z / (double)f->vertex[i].clip.w;
    worst->depth = fmax(worst->depth, fabs((double)amb_image_row(f->depth, 0, y)[x] - depth) / unit);
    assert_true(amb_image_row(f->depth, 0, y)[x] == amb_image_row(f->color[2], 2, y)[x]);
    for (int c = 0; c < 4; c++) {
        double truth = true_value(f, x, y, c, &condition);
        double error = fabs((double)amb_image_row(f->color[0], c, y)[x] - truth) / (unit * largest(f, c));
        worst->value = fmax(worst->value, error);
    }
    assert_true(amb_image_row(f->color[0], 3, y)[x] == 3.25f); /* a constant stays exactly constant */
    double along[2], conditions[2];
    for (int axis = 0; axis < 2; axis++) { /* x, then y */
        double c0, c1;
        int x0 = axis ? x : x & ~1, y0 = axis ? y & ~1 : y;
        along[axis] = true_value(f, x0 + !axis, y0 + axis, 0, &c1) - true_value(f, x0, y0, 0, &c0);
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
                        check_pixel(&f, x, y, &worst);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shading_inputs_match_double_precision),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
