/* Textures in shaders: what a rasterized surface shows against the double-precision sampler, with the level of detail
 * from quads or given by the shader; and look-ups in the vertex stage. */
#include "tests/raster_shaders.h"
#include "tests/texture_reference.h"
#include "tests/truth_raster.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE 48
#define TEXELS 32

static uint64_t random_state = 17;

static double uniform(double lo, double hi)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(random_state >> 40) / 16777216.0;
}

typedef struct fixture {
    amb_context *context;
    amb_image *color[2];
    amb_texture *texture;
    ref_texture *reference;
    raster_test_vertex vertex[3];
    raster_test_uniforms uniforms;
    truth_triangle piece;
    long checked, skipped;
    double worst; /* error over bound */
} fixture;

static void open_fixture(fixture *f, amb_isa isa, amb_texture_kind kind)
{
    const size_t faces = kind == AMB_TEXTURE_CUBE ? 6 : 1, floats = faces * TEXELS * TEXELS * 4;
    float *data = malloc(floats * sizeof *data);
    for (size_t i = 0; i < floats; i++)
        data[i] = (float)uniform(0, 1);
    amb_texture_desc desc = {.kind = kind,
                             .texel = AMB_TEXEL_RGBA32F,
                             .width = TEXELS,
                             .height = TEXELS,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = floats * sizeof *data};
    amb_context_options options = {.isa = isa, .threads = 1};
    assert_int_equal(amb_context_create(&options, &f->context, NULL), AMB_OK);
    assert_int_equal(amb_texture_create(&desc, &f->texture, NULL), AMB_OK);
    f->reference = ref_create(&desc);
    for (int i = 0; i < 2; i++)
        assert_int_equal(amb_image_create(SIZE, SIZE, 4, &f->color[i], NULL), AMB_OK);
    f->uniforms = (raster_test_uniforms){.vertex = f->vertex, .texture = f->texture};
    free(data);
}

static void close_fixture(fixture *f)
{
    for (int i = 0; i < 2; i++)
        amb_image_close(&f->color[i]);
    amb_texture_close(&f->texture);
    ref_close(f->reference);
    amb_context_close(&f->context);
}

static bool random_triangle(fixture *f, bool cube)
{
    float clip[3][4];
    truth_triangle pieces[7];
    double repeat = exp2(uniform(0, 3)), spread = uniform(20, 120);
    for (int i = 0; i < 3; i++) {
        double w = exp(uniform(-1, 1)), x = SIZE / 2.0 + uniform(-spread, spread),
               y = SIZE / 2.0 + uniform(-spread, spread);
        f->vertex[i].clip =
            (v4){(float)((x / (SIZE * 0.5) - 1) * w), (float)((1 - y / (SIZE * 0.5)) * w), (float)(0.5 * w), (float)w};
        f->vertex[i].value = (v4){(float)uniform(-repeat, repeat), (float)uniform(-repeat, repeat), (float)repeat, 1};
        if (cube)
            f->vertex[i].value = (v4){(float)uniform(-1, 1), (float)uniform(-1, 1), (float)uniform(-1, 1), 1};
        memcpy(clip[i], &f->vertex[i].clip, sizeof clip[i]);
    }
    if (truth_clip((const float(*)[4])clip, SIZE, SIZE, 1, pieces) != 1 || truth_area(pieces) == 0)
        return false;
    f->piece = pieces[0];
    return true;
}

static void draw(fixture *f, bool cube)
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(f->context));
    amb_target target = {.color = {f->color[0], f->color[1]}};
    amb_pass *pass = NULL;
    amb_draw d = {.lanes = shaders->lanes,
                  .vertex = shaders->vertex,
                  .fragment = cube ? shaders->textured_cube : shaders->textured,
                  .uniforms = &f->uniforms,
                  .uniforms_size = sizeof f->uniforms,
                  .varying_floats = 4,
                  .count = 3};
    assert_int_equal(amb_pass_begin(f->context, &target, &pass, NULL), AMB_OK);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
}

/* Component c of the value at a pixel's centre. */
static double value_at(const fixture *f, int c, int x, int y, double *condition)
{
    double corner[3];
    for (int i = 0; i < 3; i++)
        corner[i] = (double)(&f->vertex[i].value.x)[c];
    return truth_value(&f->piece, corner, x, y, 0, 0, condition);
}

typedef struct footprint {
    double at[3], dx[3], dy[3]; /* value and its differences in the quad */
    double slack;               /* error of a difference, relative to the shorter of the two */
} footprint;

static footprint footprint_at(const fixture *f, int x, int y)
{
    footprint p;
    double c00, c10, c01, largest = 0, length_x = 0, length_y = 0;
    int x0 = x & ~1, y0 = y & ~1;
    for (int c = 0; c < 3; c++) {
        p.at[c] = value_at(f, c, x, y, NULL);
        p.dx[c] = value_at(f, c, x0 + 1, y, &c10) - value_at(f, c, x0, y, &c00);
        p.dy[c] = value_at(f, c, x, y0 + 1, &c01) - value_at(f, c, x, y0, &c00);
        for (int i = 0; i < 3; i++)
            largest = fmax(largest, fabs((double)(&f->vertex[i].value.x)[c]));
        length_x += p.dx[c] * p.dx[c], length_y += p.dy[c] * p.dy[c];
    }
    double condition = fmax(fmax(c00, c10), c01);
    p.slack =
        12 * 0x1p-24 * largest * condition * condition / sqrt(fmin(length_x, length_y)); /* test_raster_shading.c */
    return p;
}

static void compare(fixture *f, const amb_image *image, int x, int y, const ref_sample *truth, double bound)
{
    if (truth->ambiguous) {
        f->skipped++;
        return;
    }
    f->checked++;
    for (int c = 0; c < 4; c++) {
        double error = fabs((double)amb_image_row(image, c, y)[x] - truth->color.c[c]);
        f->worst = fmax(f->worst, error / bound);
        if (!(error <= bound))
            fail_msg("(%d, %d) channel %d: %.9g, truth %.9g, bound %g (filter %d, anisotropy %d)", x, y, c,
                     (double)amb_image_row(image, c, y)[x], truth->color.c[c], bound, (int)f->uniforms.sampler.filter,
                     f->uniforms.sampler.max_anisotropy);
    }
}

/* Of a colour, where contrast is 1: the level's own error (texture.h) and a coordinate's, which is within 8 · 2⁻²⁴ of
 * at most 8, on 32 texels. */
static const double sampler_bound = 1e-4 + 32 * 8 * 8 * 0x1p-24;

/* A relative error of a footprint moves the level by 1.44 of it, and a colour by at most as much. Above this the level
 * or the number of taps may be another one. */
static const double most_slack = 2e-4;

static void check_pixel_2d(fixture *f, int x, int y)
{
    const raster_test_uniforms *u = &f->uniforms;
    footprint p = footprint_at(f, x, y);
    if (p.slack < most_slack) {
        ref_sample truth = ref_2d_grad(f->reference, &u->sampler, p.at, p.dx, p.dy);
        compare(f, f->color[0], x, y, &truth, sampler_bound + 1.5 * p.slack);
    } else {
        f->skipped++;
    }
    const double dx[2] = {(double)u->ddx.x, (double)u->ddx.y}, dy[2] = {(double)u->ddy.x, (double)u->ddy.y};
    ref_sample given = ref_2d_grad(f->reference, &u->sampler, p.at, dx, dy);
    compare(f, f->color[1], x, y, &given, sampler_bound);
}

static void check_pixel_cube(fixture *f, int x, int y)
{
    footprint p = footprint_at(f, x, y);
    double length = sqrt(p.at[0] * p.at[0] + p.at[1] * p.at[1] + p.at[2] * p.at[2]);
    if (p.slack >= most_slack || length < 0.1) { /* near the middle of the cube nothing is known */
        f->skipped++;
        return;
    }
    ref_sample truth = ref_cube_grad(f->reference, &f->uniforms.sampler, p.at, p.dx, p.dy);
    compare(f, f->color[0], x, y, &truth, 1e-4 + 2 * 16 * 8 * 0x1p-24 / length + 1.5 * p.slack);
}

static void check_kind(amb_texture_kind kind)
{
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    const bool cube = kind == AMB_TEXTURE_CUBE;
    for (int i = 0; i < 3; i++) {
        fixture f = {0};
        if (!amb_isa_available(isas[i]))
            continue;
        open_fixture(&f, isas[i], kind);
        for (int n = 0; n < 120; n++) {
            amb_sampler *s = &f.uniforms.sampler;
            *s = (amb_sampler){.filter = (amb_filter)(1 + n % 2), .max_anisotropy = n % 3 ? 0 : 1 + n % 16};
            s->wrap[0] = (amb_wrap)(n % 3), s->wrap[1] = (amb_wrap)(n / 3 % 3);
            f.uniforms.ddx = (v2){(float)uniform(-0.1, 0.1), (float)uniform(-0.1, 0.1)};
            f.uniforms.ddy = (v2){(float)uniform(-0.1, 0.1), (float)uniform(-0.1, 0.1)};
            if (!random_triangle(&f, cube))
                continue;
            draw(&f, cube);
            for (int p = 0; p < SIZE * SIZE; p++) {
                int x = p % SIZE, y = p / SIZE;
                if (!truth_covers(&f.piece, x, y))
                    continue;
                if (cube)
                    check_pixel_cube(&f, x, y);
                else
                    check_pixel_2d(&f, x, y);
            }
        }
        print_message("%s: %ld samples, %ld skipped where rounding decides; worst error %.2f of the bound\n",
                      amb_isa_name(isas[i]), f.checked, f.skipped, f.worst);
        assert_true(f.checked > 20000 && f.skipped < f.checked / 4);
        close_fixture(&f);
    }
}

static void surfaces_match_the_double_sampler(void **state)
{
    (void)state;
    check_kind(AMB_TEXTURE_2D);
}

static void reflections_match_the_double_sampler(void **state)
{
    (void)state;
    check_kind(AMB_TEXTURE_CUBE);
}

/* A point on every pixel; each vertex looks its colour up. */
static void vertices_fetch_texels(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    for (int i = 0; i < 3; i++) {
        fixture f = {0};
        if (!amb_isa_available(isas[i]))
            continue;
        open_fixture(&f, isas[i], AMB_TEXTURE_2D);
        const raster_test_shaders *shaders = raster_test_shaders_of(isas[i]);
        raster_test_vertex *vertex = calloc(SIZE * SIZE, sizeof *vertex);
        for (int n = 0; n < SIZE * SIZE; n++) {
            int row = n / SIZE;
            double x = n % SIZE + 0.5, y = row + 0.5;
            vertex[n].clip = (v4){(float)(x / (SIZE * 0.5) - 1), (float)(1 - y / (SIZE * 0.5)), 0.5f, 1};
            vertex[n].value = (v4){(float)uniform(-1, 2), (float)uniform(-1, 2), (float)uniform(-1, 6), 0};
        }
        raster_test_uniforms u = {.vertex = vertex, .texture = f.texture, .sampler = {.filter = AMB_TRILINEAR}};
        amb_target target = {.color = {f.color[0]}};
        amb_pass *pass = NULL;
        amb_draw d = {.lanes = shaders->lanes,
                      .vertex = shaders->fetch,
                      .fragment = shaders->value,
                      .topology = AMB_POINTS,
                      .uniforms = &u,
                      .uniforms_size = sizeof u,
                      .varying_floats = 4,
                      .count = SIZE * SIZE};
        assert_int_equal(amb_pass_begin(f.context, &target, &pass, NULL), AMB_OK);
        assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
        assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        for (int n = 0; n < SIZE * SIZE; n++) {
            const v4 *v = &vertex[n].value;
            ref_sample truth =
                ref_2d_lod(f.reference, &u.sampler, (double[2]){(double)v->x, (double)v->y}, (double)v->z);
            compare(&f, f.color[0], n % SIZE, n / SIZE, &truth, 2e-5);
        }
        assert_true(f.checked == SIZE * SIZE);
        free(vertex);
        close_fixture(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_match_the_double_sampler),
        cmocka_unit_test(reflections_match_the_double_sampler),
        cmocka_unit_test(vertices_fetch_texels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
