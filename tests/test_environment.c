/* Environment maps: orientation, panoramas, irradiance against exact integrals, the same bits everywhere. */
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/paint.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

AMB_DECLARE_WIDE(v4x, test_radiance_linear, (v3x direction, const void *user));
AMB_DECLARE_WIDE(v4x, amb_sky_radiance, (v3x direction, const void *user));
AMB_DECLARE_WIDE(v4x, amb_studio_radiance, (v3x direction, const void *user));

static const amb_sampler nearest = {.filter = AMB_NEAREST}, smooth = {.filter = AMB_BILINEAR};

static amb_context *context_of(amb_isa isa, int threads)
{
    amb_context *context;
    assert_int_equal(amb_context_create(&(amb_context_options){isa, threads}, &context, NULL), AMB_OK);
    return context;
}

static v3 sample(const amb_texture *cube, const amb_sampler *sampler, v3 d)
{
    v4x c = amb_sample_cube_lod(cube, sampler, (v3x){d.x, d.y, d.z}, 0);
    return (v3){c.x, c.y, c.z};
}

/* Spread directions: a Fibonacci spiral. */
static v3 spiral(int i, int count)
{
    double z = 1 - (2 * i + 1.0) / count, r = sqrt(1 - z * z), angle = i * 2.399963229728653;
    return (v3){(float)(r * cos(angle)), (float)(r * sin(angle)), (float)z};
}

static const float direction_as_colour[12] = {2, 1, 0, 0, 2, 0, 1, 0, 2, 0, 0, 1};

static void painted_cubes_look_up_by_direction(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    amb_texture *cube;
    amb_field radiance = AMB_DISPATCH(amb_context_isa(context), test_radiance_linear);
    assert_int_equal(amb_cube_paint(context, 64, 2, radiance, direction_as_colour, &cube, NULL), AMB_OK);
    for (int i = 0; i < 3000; i++) {
        v3 d = spiral(i, 3000), c = sample(cube, &smooth, d);
        assert_true(fabsf(c.x - 2 - d.x) < 4e-3f && fabsf(c.y - 2 - d.y) < 4e-3f && fabsf(c.z - 2 - d.z) < 4e-3f);
    }
    for (int face = 0; face < 6; face++) { /* amb_cube_direction names the same texels */
        v3 d = amb_cube_direction(face, 0.3f, -0.6f), c = sample(cube, &smooth, d);
        assert_true(fabsf(c.x - 2 - d.x) < 4e-3f && fabsf(c.y - 2 - d.y) < 4e-3f && fabsf(c.z - 2 - d.z) < 4e-3f);
    }
    amb_texture_close(&cube);
    amb_context_close(&context);
}

static void irradiance_equals_the_exact_integral(void **state)
{
    (void)state;
    static const float field[12] = {1, 0, 0, 0, 0.8f, 0.5f, -0.2f, 0.1f, 3, -1, 1, 1};
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    amb_field radiance = AMB_DISPATCH(amb_context_isa(context), test_radiance_linear);
    static const int sizes[] = {16, 64, 256};
    for (int s = 0; s < 3; s++) {
        amb_texture *environment, *irradiance;
        assert_int_equal(amb_cube_paint(context, sizes[s], 1, radiance, field, &environment, NULL), AMB_OK);
        assert_int_equal(amb_irradiance_cube(context, environment, &irradiance, NULL), AMB_OK);
        for (int i = 0; i < 2000; i++) {
            v3 n = spiral(i, 2000), e = sample(irradiance, &smooth, n);
            const float *got = &e.x;
            for (int c = 0; c < 3; c++) {
                const float *k = &field[4 * c];
                double slope = (double)k[1] * (double)n.x + (double)k[2] * (double)n.y + (double)k[3] * (double)n.z;
                double exact = (double)k[0] + 2.0 / 3.0 * slope;
                assert_true(fabs((double)got[c] - exact) < 0.006); /* halves and 32² faces, of values up to 4.7 */
            }
        }
        amb_texture_close(&environment);
        amb_texture_close(&irradiance);
    }
    amb_context_close(&context);
}

/* A panorama painted in double precision from the same linear field, looked up through the cube made of it. */
static void panoramas_keep_their_directions(void **state)
{
    (void)state;
    enum { WIDTH = 512, HEIGHT = 256 };
    amb_image *image;
    amb_texture *panorama, *cube;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    assert_int_equal(amb_image_create(WIDTH, HEIGHT, 3, &image, NULL), AMB_OK);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double longitude = ((x + 0.5) / WIDTH - 0.5) * 6.283185307179586; /* 0 looks along -z, + to the right */
            double polar = (y + 0.5) / HEIGHT * 3.141592653589793;
            amb_image_row(image, 0, y)[x] = (float)(2 + sin(polar) * sin(longitude));
            amb_image_row(image, 1, y)[x] = (float)(2 + cos(polar));
            amb_image_row(image, 2, y)[x] = (float)(2 - sin(polar) * cos(longitude));
        }
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA32F, false, &panorama, NULL), AMB_OK);
    assert_int_equal(amb_panorama_to_cube(context, panorama, 128, &cube, NULL), AMB_OK);
    for (int i = 0; i < 3000; i++) {
        v3 d = spiral(i, 3000), c = sample(cube, &smooth, d);
        assert_true(fabsf(c.x - 2 - d.x) < 0.01f && fabsf(c.y - 2 - d.y) < 0.01f && fabsf(c.z - 2 - d.z) < 0.01f);
    }
    amb_image_close(&image);
    amb_texture_close(&panorama);
    amb_texture_close(&cube);
    amb_context_close(&context);
}

/* A map painted from a field holds it at the longitude and latitude of every direction, poles and ±180° included. */
static void painted_maps_look_up_by_longitude_and_latitude(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    amb_texture *map;
    amb_field field = AMB_DISPATCH(amb_context_isa(context), test_radiance_linear);
    assert_int_equal(amb_map_paint(context, 257, 128, 2, field, direction_as_colour, AMB_TEXEL_RGBA32F, &map, NULL),
                     AMB_OK);
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    for (int i = 0; i < 3000; i++) {
        v3 d = i == 0 ? (v3){0, 1, 0} : i == 1 ? (v3){0, -1, 0} : i == 2 ? (v3){0, 0, 1} : spiral(i, 3000);
        double u = 0.5 + atan2((double)d.x, -(double)d.z) / 6.283185307179586;
        double v = acos((double)d.y) / 3.141592653589793;
        v4x c = amb_sample_2d_lod(map, &sampler, (v2x){(float)u, (float)v}, 0);
        assert_true(fabsf(c.x - 2 - d.x) < 0.015f && fabsf(c.y - 2 - d.y) < 0.015f && fabsf(c.z - 2 - d.z) < 0.015f);
    }
    amb_texture_close(&map);
    amb_context_close(&context);
}

/* Both built-in environments, small, on every instruction set and thread count this machine has. */
static void environments_are_the_same_everywhere(void **state)
{
    (void)state;
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    amb_texture *first[2] = {NULL, NULL};
    for (int k = 0; k < 3; k++) {
        if (!amb_isa_available(isas[k]))
            continue;
        amb_context *context = context_of(isas[k], k + 1);
        for (int e = 0; e < 2; e++) {
            amb_field radiance =
                e ? AMB_DISPATCH(isas[k], amb_studio_radiance) : AMB_DISPATCH(isas[k], amb_sky_radiance);
            amb_texture *cube, *irradiance;
            assert_int_equal(amb_cube_paint(context, 64, 2, radiance, NULL, &cube, NULL), AMB_OK);
            assert_int_equal(amb_irradiance_cube(context, cube, &irradiance, NULL), AMB_OK);
            if (!first[e])
                assert_int_equal(amb_cube_paint(context, 64, 2, radiance, NULL, &first[e], NULL), AMB_OK);
            for (int i = 0; i < 20000; i++) {
                v3 d = spiral(i, 20000), a = sample(cube, &nearest, d), b = sample(first[e], &nearest, d);
                assert_memory_equal(&a, &b, sizeof a);
                assert_true(a.x >= 0 && a.y >= 0 && a.z >= 0 && a.x <= 65504);
                v3 light = sample(irradiance, &smooth, d);
                assert_true(light.x > 0 && light.x < 20 && light.z > 0 && light.z < 20);
            }
            amb_texture_close(&cube);
            amb_texture_close(&irradiance);
        }
        amb_context_close(&context);
    }
    amb_texture_close(&first[0]);
    amb_texture_close(&first[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(painted_cubes_look_up_by_direction),
        cmocka_unit_test(irradiance_equals_the_exact_integral),
        cmocka_unit_test(panoramas_keep_their_directions),
        cmocka_unit_test(painted_maps_look_up_by_longitude_and_latitude),
        cmocka_unit_test(environments_are_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("environment", tests, NULL, NULL);
}
