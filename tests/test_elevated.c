/* Scene elevated: its tessellated ground has no cracks, its flight is smooth, endless and above the ground. */
#include "core/dispatch.h"
#include "scenes/elevated_patches.h"
#include "tests/elevated_probe.h"

#include <ambiance/scene.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

AMB_DECLARE_WIDE(const elevated_probe *, elevated_probe_get, (void));

static amb_context *context;
static amb_noise_texture noise;
static elevated_params params; /* the scene's defaults */

static int setup(void **state)
{
    (void)state;
    amb_error error;
    amb_noise_texture_make(&noise, 1);
    if (amb_context_create(&(amb_context_options){.threads = 2}, &context, &error))
        return 1;
    const amb_scene *scene = amb_scene_by_name(amb_context_isa(context), "elevated");
    if (!scene || scene->params.size != sizeof params)
        return 1;
    amb_params_defaults(&scene->params, &params);
    return 0;
}
static int teardown(void **state)
{
    (void)state;
    amb_context_close(&context);
    return 0;
}

/* ---- the ground -------------------------------------------------------------------------------------------------- */

enum { SIZE = 640 };

/* From far above, heights leaning over to the side (so that a crack in height opens sideways): the sum of +1 for every
 * front and -1 for every back face over each pixel of a square of `half` cells around the eye. Returns pixels ≠ 1. */
static int wrongly_covered(amb_hull_shader hull, v3 eye, float half, float lean)
{
    const elevated_probe *probe = AMB_DISPATCH(amb_context_isa(context), elevated_probe_get)();
    elevated_uniforms u = {.eye = eye, .pixels = 1400.0f, .params = &params, .ceiling = 1.3f * params.height};
    amb_terrain_place(&u.ground, &noise, (uint32_t)params.seed, 1.0f, true, 1234, -99);
    float per_cell = 1.0f / half;
    u.world_to_clip = (m4){{{per_cell, lean * per_cell, 0.0f, -eye.x * per_cell},
                            {0.0f, 0.7f * lean * per_cell, -per_cell, eye.z * per_cell},
                            {0.0f, -0.1f, 0.0f, 0.5f},
                            {0.0f, 0.0f, 0.0f, 1.0f}}};
    m4 everything = {{{1e-9f, 0, 0, 0}, {0, 1e-9f, 0, 0}, {0, 0, 0, 0.5f}, {0, 0, 0, 1}}};
    amb_error error;
    amb_image *sum = NULL;
    amb_pass *pass = NULL;
    uint32_t *index = NULL, count = 0;
    assert_int_equal(elevated_patches(eye, everything, 12.0f, -1.0f, 1.0f, &index, &count, &error), AMB_OK);
    assert_int_equal(amb_image_create(SIZE, SIZE, 1, &sum, &error), AMB_OK);
    assert_int_equal(amb_pass_begin(context, &(amb_target){.color = {sum}}, &pass, &error), AMB_OK);
    amb_draw draw = {.label = "ground",
                     .lanes = probe->lanes,
                     .fragment = probe->signed_cover,
                     .uniforms = &u,
                     .uniforms_size = sizeof u,
                     .varying_floats = probe->varying_floats,
                     .indices = index,
                     .count = count,
                     .vertex_count = PATCH_INDICES,
                     .topology = AMB_PATCHES,
                     .tessellation = {.hull = hull,
                                      .domain = probe->domain,
                                      .corners = 1,
                                      .shape = AMB_QUAD,
                                      .partitioning = AMB_INTEGER,
                                      .clockwise = true},
                     .blend = {AMB_BLEND_ADD}};
    assert_int_equal(amb_pass_draw(pass, &draw, &error), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, &error), AMB_OK);
    int wrong = 0;
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++)
            wrong += amb_image_row(sum, 0, y)[x] != 1.0f;
    amb_image_close(&sum);
    free(index);
    return wrong;
}

static void ground_covers_every_pixel_once(void **state)
{
    (void)state;
    const elevated_probe *probe = AMB_DISPATCH(amb_context_isa(context), elevated_probe_get)();
    const v3 eyes[] = {{0.3f, 0.2f, 0.6f}, {0.93f, 0.1f, 0.07f}, {0.5f, 0.5f, 0.99f}};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(wrongly_covered(probe->hull, eyes[i], 0.6f, 1.5f), 0);
        /* the first rings, with their borders at 1 and 2 cells; from straight above; and all rings */
        assert_int_equal(wrongly_covered(probe->hull, eyes[i], 2.3f, 0.8f), 0);
        assert_int_equal(wrongly_covered(probe->hull, eyes[i], 1.2f, 0.0f), 0);
        assert_int_equal(wrongly_covered(probe->hull, eyes[i], 9.0f, 0.3f), 0);
    }
    assert_true(wrongly_covered(probe->careless_hull, eyes[0], 0.6f, 1.5f) > 10); /* the check can fail */
}

/* Patches tile the plane around the eye: every point of a lattice in exactly one. */
static void patches_tile_the_plane(void **state)
{
    (void)state;
    m4 everything = {{{1e-9f, 0, 0, 0}, {0, 1e-9f, 0, 0}, {0, 0, 0, 0.5f}, {0, 0, 0, 1}}};
    static unsigned char seen[512][512];
    for (int round = 0; round < 8; round++) {
        v3 eye = {(float)round * 0.137f, 0.1f, 1.0f - (float)round * 0.119f};
        uint32_t *index, count;
        amb_error error;
        assert_int_equal(elevated_patches(eye, everything, 30.0f, -1.0f, 1.0f, &index, &count, &error), AMB_OK);
        memset(seen, 0, sizeof seen);
        for (uint32_t i = 0; i < count; i++) {
            int32_t patch = (int32_t)index[i], steps = (int32_t)(patch_side(patch) / PATCH_SIDE);
            int32_t x = patch_x(patch) * steps + 256, z = patch_z(patch) * steps + 256;
            for (int32_t a = z > 0 ? z : 0; a < z + steps && a < 512; a++)
                for (int32_t b = x > 0 ? x : 0; b < x + steps && b < 512; b++)
                    seen[a][b]++;
        }
        for (int z = 0; z < 512; z++)
            for (int x = 0; x < 512; x++) {
                float dx = ((float)x - 255.5f) * PATCH_SIDE - eye.x, dz = ((float)z - 255.5f) * PATCH_SIDE - eye.z;
                assert_true(seen[z][x] <= 1);
                assert_true(seen[z][x] == 1 || dx * dx + dz * dz > 29.0f * 29.0f);
            }
        free(index);
    }
}

/* ---- the flight -------------------------------------------------------------------------------------------------- */

/* From frame to frame at 60 a second, now and after a day, a week and a year: the eye moves as the speed says, without
 * jumps, also where the lattice point under it changes. */
static void flight_is_smooth_however_far(void **state)
{
    (void)state;
    const double starts[] = {0, 86400, 7 * 86400.0, 365 * 86400.0, -3600};
    for (size_t s = 0; s < sizeof starts / sizeof *starts; s++) {
        elevated_place before = elevated_place_at(&noise, &params, starts[s]);
        int moves = 0;
        for (int i = 1; i <= 600; i++) {
            elevated_place now = elevated_place_at(&noise, &params, starts[s] + i / 60.0);
            float step_x = (float)(now.x - before.x) + (now.eye.x - before.eye.x);
            float step_z = (float)(now.z - before.z) + (now.eye.z - before.eye.z), step_y = now.eye.y - before.eye.y;
            moves += now.z != before.z;
            assert_true(fabsf(step_z + params.speed / 60) < 1e-6f);
            assert_true(fabsf(step_x) < params.speed / 60 && fabsf(step_y) < 1.2f * params.speed / 60);
            assert_true(now.eye.x >= 0 && now.eye.x < 1.000001f && now.eye.z >= 0 && now.eye.z < 1.000001f);
            before = now;
        }
        assert_in_range(moves, 1, 2); /* 10 s at 0.1 cells/s */
    }
}

/* Two bases a cell apart see the same mountains around the eye, a year out: to 1e-5 of a cell. */
static void ground_stays_where_it_was(void **state)
{
    (void)state;
    elevated_place place = elevated_place_at(&noise, &params, 365 * 86400.0);
    amb_terrain here, next;
    amb_terrain_place(&here, &noise, 7, 1.0f, true, place.x, place.z);
    amb_terrain_place(&next, &noise, 7, 1.0f, true, place.x, place.z - 1);
    for (int i = 0; i < 400; i++) {
        int row = i / 20;
        v2x p = {(float)(i % 20) * 0.31f - 3.0f, (float)row * 0.29f - 3.0f};
        float a = terrain_at(&here, p, 12.0f).height, b = terrain_at(&next, (v2x){p.x, p.y + 1.0f}, 12.0f).height;
        assert_true(fabsf(a - b) < 1e-5f);
    }
}

/* The eye keeps off the ground of all octaves over two hours of flight. */
static void eye_is_above_the_ground(void **state)
{
    (void)state;
    float least = 1e9f;
    for (int i = 0; i < 1500; i++) {
        elevated_place place = elevated_place_at(&noise, &params, 4.8 * i);
        amb_terrain ground;
        amb_terrain_place(&ground, &noise, (uint32_t)params.seed, params.erosion, params.turned != 0, place.x, place.z);
        float y = params.height * terrain_at(&ground, (v2x){place.eye.x, place.eye.z}, 12.0f).height;
        least = fminf(least, place.eye.y - y);
    }
    assert_true(least > 0.02f); /* twice the near plane */
}

/* Octaves of the geometry fade with the eye's distance. From one frame to the next, 60 a second, that moves no point of
 * the ground by more than a fifth of a pixel of a 1440×1080 picture, and by a fiftieth on average. */
static void ground_does_not_swim(void **state)
{
    (void)state;
    const elevated_probe *probe = AMB_DISPATCH(amb_context_isa(context), elevated_probe_get)();
    enum { COUNT = 4096 };
    static float x[COUNT], z[COUNT], y[2][COUNT];
    float tangent = tanf(params.fov * 0.5f * 3.14159265f / 180.0f);
    elevated_uniforms u = {.pixels = 0.5f * 1080.0f / tangent, .params = &params};
    double most = 0, sum = 0;
    for (int round = 0; round < 20; round++) {
        elevated_place a = elevated_place_at(&noise, &params, 7.0 * round);
        elevated_place b = elevated_place_at(&noise, &params, 7.0 * round + 1.0 / 60);
        if (a.x != b.x || a.z != b.z)
            continue;
        amb_terrain_place(&u.ground, &noise, (uint32_t)params.seed, params.erosion, true, a.x, a.z);
        for (int i = 0; i < COUNT; i++) { /* from 0.25 to 30 cells ahead */
            int row = i / 64;
            float distance = 0.25f * powf(120.0f, (float)row / 63.0f), side = ((float)(i % 64) - 31.5f) / 63.0f;
            x[i] = a.eye.x + distance * side;
            z[i] = a.eye.z - distance;
        }
        for (int k = 0; k < 2; k++) {
            u.eye = k ? b.eye : a.eye;
            probe->heights(&u, x, z, y[k], COUNT);
        }
        for (int i = 0; i < COUNT; i++) {
            double pixels = fabs((double)(y[1][i] - y[0][i])) * (double)u.pixels / (double)(a.eye.z - z[i]);
            most = fmax(most, pixels);
            sum += pixels / (20.0 * COUNT);
        }
    }
    if (most > 0.2 || sum > 0.02)
        fail_msg("points move by up to %g pixels, %g on average", most, sum);
    assert_true(most > 0);
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static amb_frame *render(double time, const char *const *set, const char *const *aovs, int width, int height)
{
    amb_error error;
    amb_assets *assets = NULL;
    amb_show *show = NULL;
    amb_frame *frame = NULL;
    assert_int_equal(amb_assets_create(context, &(amb_assets_options){.builtin_only = true}, &assets, &error), AMB_OK);
    assert_int_equal(amb_show_open(context, assets, "elevated", &show, &error), AMB_OK);
    for (; set && *set; set += 2)
        assert_int_equal(amb_show_set(show, set[0], set[1], &error), AMB_OK);
    assert_int_equal(amb_show_render(show, time, width, height, aovs, &frame, &error), AMB_OK);
    amb_show_close(&show);
    amb_assets_close(&assets);
    return frame;
}

/* The two normals of the scene agree over a picture; so do marched and estimated shadows in most of it. */
static void options_agree(void **state)
{
    (void)state;
    const char *const aovs[] = {"normal", "shadow", NULL};
    const char *const plain[] = {"samples", "1", "shadow_octaves", "5", NULL};
    const char *const other[] = {"samples", "1",       "shadow_octaves", "5", "normals",
                                 "central", "shadows", "estimate",       NULL};
    amb_frame *a = render(3.0, plain, aovs, 160, 120), *b = render(3.0, other, aovs, 160, 120);
    amb_image *na = amb_frame_layer(a, "normal"), *nb = amb_frame_layer(b, "normal");
    double turned = 0;
    int count = 0;
    for (int y = 0; y < 120; y++)
        for (int x = 0; x < 160; x++) {
            double dot = 0, size = 0;
            for (int c = 0; c < 3; c++) {
                dot += (double)amb_image_row(na, c, y)[x] * (double)amb_image_row(nb, c, y)[x];
                size += fabs((double)amb_image_row(na, c, y)[x]);
            }
            if (size == 0)
                continue;
            turned += acos(fmin(dot, 1));
            count++;
        }
    assert_true(count > 5000);
    assert_true(turned / count < 0.08); /* 4.6° on average at most: central differences blur the finest octave */
    amb_frame_close(&a);
    amb_frame_close(&b);
}

/* Haze hides the far ground in the sky's own light: where fog is all, colour is the horizon's. */
static void every_pixel_is_light(void **state)
{
    (void)state;
    const char *const heights[] = {"-12", "0", "1", "8", "40", "90"};
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
        const char *const set[] = {"samples", "1", "sun_elevation", heights[i], "turbidity", i & 1 ? "9" : "2", NULL};
        amb_frame *frame = render(40.0 * (double)i + 86400.0, set, NULL, 96, 72);
        amb_image *color = amb_frame_layer(frame, "color");
        for (int y = 0; y < 72; y++)
            for (int x = 0; x < 96; x++)
                for (int c = 0; c < 3; c++) {
                    float light = amb_image_row(color, c, y)[x];
                    assert_true(light >= 0.0f && light < 1.0e5f);
                }
        amb_frame_close(&frame);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_covers_every_pixel_once), cmocka_unit_test(patches_tile_the_plane),
        cmocka_unit_test(flight_is_smooth_however_far),   cmocka_unit_test(ground_stays_where_it_was),
        cmocka_unit_test(eye_is_above_the_ground),        cmocka_unit_test(options_agree),
        cmocka_unit_test(ground_does_not_swim),           cmocka_unit_test(every_pixel_is_light),
    };
    return cmocka_run_group_tests_name("elevated", tests, setup, teardown);
}
