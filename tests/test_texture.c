/* Textures against a double-precision sampler written from the GL formulas (texture_reference.c), and every instruction
 * set against one lane, bit for bit. */
#include "tests/texture_pairs.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

/* ---- sampling --------------------------------------------------------------------------------------------------- */

/* Coordinate rounding: 2⁻²³ of a size of 32 on three axes and |uv| ≤ 3.5 stays below 2e-5 of the contrast. */
static const double coordinate_bound = 2e-5;
/* The level's fraction: lod_log2 promises 1e-4, halved by the square root; 2e-4 with the blend of unit contrast. */
static const double gradient_bound = 2e-4;

static void test_2d_matches_reference(void **unused)
{
    (void)unused;
    static const int size[][2] = {{32, 32}, {32, 8}, {1, 1}, {1, 16}, {17, 5}, {31, 30}, {2, 3}};
    static batch p;
    uint32_t state = 1;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_2D, every_texel[f], size[z][0], size[z][1], 1, true, &state);
            double stored = storage_bound(every_texel[f], true);
            for (int round = 0; round < 4; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, false, 5.0, &state);
                run_everywhere(&b, &s, PROBE_2D_LOD, &p);
                compare_batch(&b, &s, PROBE_2D_LOD, &p, stored + coordinate_bound);
                s.max_anisotropy = (int)(pair_random(&state) % 18);
                run_everywhere(&b, &s, PROBE_2D_GRAD, &p);
                compare_batch(&b, &s, PROBE_2D_GRAD, &p, stored + gradient_bound);
            }
            close_both(&b);
        }
}

static void test_3d_matches_reference(void **unused)
{
    (void)unused;
    static const int size[][3] = {{8, 8, 8}, {16, 4, 7}, {1, 3, 5}, {5, 9, 1}};
    static batch p;
    uint32_t state = 2;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_3D, every_texel[f], size[z][0], size[z][1], size[z][2], true, &state);
            for (int round = 0; round < 3; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, false, 4.0, &state);
                run_everywhere(&b, &s, PROBE_3D_LOD, &p);
                compare_batch(&b, &s, PROBE_3D_LOD, &p, storage_bound(every_texel[f], true) + coordinate_bound);
            }
            close_both(&b);
        }
}

static void test_cube_matches_reference(void **unused)
{
    (void)unused;
    static const int size[] = {16, 1, 2, 5};
    static batch p;
    uint32_t state = 3;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_CUBE, every_texel[f], size[z], size[z], 1, true, &state);
            double stored =
                storage_bound(every_texel[f], true) + storage_bound(every_texel[f], true); /* corners again */
            for (int round = 0; round < 3; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, true, 4.0, &state);
                run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
                compare_batch(&b, &s, PROBE_CUBE_LOD, &p, stored + coordinate_bound);
                run_everywhere(&b, &s, PROBE_CUBE_GRAD, &p);
                compare_batch(&b, &s, PROBE_CUBE_GRAD, &p, stored + gradient_bound);
            }
            close_both(&b);
        }
}

/* Taps of an anisotropic cube look-up are spread in direction space. */
static void test_cube_anisotropy(void **unused)
{
    (void)unused;
    static batch p;
    uint32_t state = 4;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 16, 16, 1, true, &state);
    amb_sampler s = {.filter = AMB_TRILINEAR, .max_anisotropy = 16};
    random_probes(&p, true, 4.0, &state);
    run_everywhere(&b, &s, PROBE_CUBE_GRAD, &p);
    compare_batch(&b, &s, PROBE_CUBE_GRAD, &p, gradient_bound);
    close_both(&b);
}

/* The plain form takes from each quad exactly the differences that a GPU takes. */
static void test_quads_give_the_gradients(void **unused)
{
    (void)unused;
    static batch p;
    static float quad[BATCH][4];
    uint32_t state = 5;
    for (int cube = 0; cube < 2; cube++) {
        both b = make_both(cube ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D, AMB_TEXEL_RGBA16F, 16, 16, 1, true, &state);
        amb_sampler s = {.filter = AMB_TRILINEAR, .max_anisotropy = 4};
        random_probes(&p, cube, 4.0, &state);
        for (int i = 0; i < BATCH; i++) {
            const probe *q = &p.in[i & ~3];
            for (int a = 0; a < 3; a++) {
                p.in[i].dx[a] = q[(i & 2) + 1].at[a] - q[i & 2].at[a];
                p.in[i].dy[a] = q[(i & 1) + 2].at[a] - q[i & 1].at[a];
            }
        }
        probe_texture(1, b.texture, &s, cube ? PROBE_CUBE_GRAD : PROBE_2D_GRAD, p.in, BATCH, p.out);
        for (const int *lanes = probe_lanes() + 1; *lanes; lanes++) {
            probe_texture(*lanes, b.texture, &s, cube ? PROBE_CUBE_QUAD : PROBE_2D_QUAD, p.in, BATCH, quad);
            assert_memory_equal(quad, p.out, sizeof quad);
        }
        close_both(&b);
    }
}

/* Whatever two textures are, a pair of look-ups gives what each gives alone. */
static void test_pairs_are_two_look_ups(void **unused)
{
    (void)unused;
    static batch p;
    static float alone[2][BATCH][4], pair[2][BATCH][4];
    uint32_t state = 6;
    for (int f = 0; f < TEXELS; f++)
        for (int unlike = 0; unlike < 4; unlike++) {
            amb_texel other = unlike == 1 ? every_texel[(f + 1) % TEXELS] : every_texel[f];
            both b[2] = {make_both(AMB_TEXTURE_2D, every_texel[f], 16, 8, 1, true, &state),
                         make_both(AMB_TEXTURE_2D, other, unlike == 2 ? 17 : 16, 8, 1, unlike != 3, &state)};
            const amb_texture *textures[2] = {b[0].texture, b[1].texture};
            for (int round = 0; round < 6; round++) {
                amb_sampler s = random_sampler(&state);
                s.max_anisotropy = round % 3 == 2 ? 8 : 1;
                random_probes(&p, false, 4.0, &state);
                for (const int *lanes = probe_lanes() + 1; *lanes; lanes++) {
                    for (int k = 0; k < 2; k++)
                        probe_texture(*lanes, textures[k], &s, PROBE_2D_QUAD, p.in, BATCH, alone[k]);
                    probe_pair(*lanes, textures, &s, p.in, BATCH, pair[0], pair[1]);
                    assert_memory_equal(pair, alone, sizeof pair);
                }
            }
            close_both(&b[0]);
            close_both(&b[1]);
        }
}

/* ---- 8-bit formats ---------------------------------------------------------------------------------------------- */

enum { BIG = 8, SMALL = 4 };

static double wrapped_code(const unsigned char *codes, int size, int x, int y, int channel)
{
    return codes[(((y + size) % size) * size + (x + size) % size) * 4 + channel];
}

/* Bilinear, repeating, in 0…255. */
static double filtered_code(const unsigned char *codes, int size, const float at[2], int channel)
{
    double x = (double)at[0] * size - 0.5, y = (double)at[1] * size - 0.5, fx = x - floor(x), fy = y - floor(y);
    int left = (int)floor(x), top = (int)floor(y);
    double above = wrapped_code(codes, size, left, top, channel) * (1 - fx) +
                   wrapped_code(codes, size, left + 1, top, channel) * fx;
    double below = wrapped_code(codes, size, left, top + 1, channel) * (1 - fx) +
                   wrapped_code(codes, size, left + 1, top + 1, channel) * fx;
    return above * (1 - fy) + below * fy;
}

/* Their weights have 14 bits: colours are within 2⁻¹² of full scale, between texels and between levels. */
static void test_unorm_weights(void **unused)
{
    (void)unused;
    uint32_t state = 13;
    static batch p;
    static unsigned char codes[(BIG * BIG + SMALL * SMALL) * 4];
    double worst = 0.0;
    for (int round = 0; round < 200; round++) {
        for (size_t i = 0; i < sizeof codes; i++)
            codes[i] =
                round % 2 ? (unsigned char)(pair_random(&state) >> 9) : (unsigned char)-(pair_random(&state) >> 9 & 1);
        amb_texture_desc desc = {.kind = AMB_TEXTURE_2D,
                                 .texel = AMB_TEXEL_RGBA8,
                                 .width = BIG,
                                 .height = BIG,
                                 .levels = 2,
                                 .data = codes,
                                 .data_bytes = sizeof codes};
        both b = {0};
        assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
        amb_sampler s = {.filter = AMB_TRILINEAR};
        for (int i = 0; i < BATCH; i++) {
            p.in[i].at[0] = (float)pair_uniform(&state, 0, 1), p.in[i].at[1] = (float)pair_uniform(&state, 0, 1);
            p.in[i].lod = (float)pair_uniform(&state, 0, 1);
        }
        run_everywhere(&b, &s, PROBE_2D_LOD, &p);
        for (int i = 0; i < BATCH; i++)
            for (int k = 0; k < 4; k++) {
                double near = filtered_code(codes, BIG, p.in[i].at, k);
                double far = filtered_code(codes + BIG * BIG * 4, SMALL, p.in[i].at, k);
                double exact = (near + (far - near) * (double)p.in[i].lod) / 255.0;
                worst = fmax(worst, fabs((double)p.out[i][k] - exact));
            }
        amb_texture_close(&b.texture);
    }
    assert_true(worst < 1.0 / 4096.0);
    assert_true(worst > 1.0 / 65536.0); /* else the textures were too tame to find the worst */
}

/* Wherever a texture has one colour, that is its colour: to the last bit the code's value. */
static void test_unorm_constants_stay(void **unused)
{
    (void)unused;
    uint32_t state = 14;
    static batch p;
    static unsigned char codes[16 * 16 * 4];
    for (int code = 0; code < 256; code++) {
        memset(codes, code, sizeof codes);
        amb_texture_desc desc = {.kind = AMB_TEXTURE_2D,
                                 .texel = AMB_TEXEL_RGBA8,
                                 .width = 16,
                                 .height = 16,
                                 .make_mips = true,
                                 .data = codes,
                                 .data_bytes = sizeof codes};
        both b = {0};
        assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
        amb_sampler s = {.filter = (amb_filter)(code % 3)};
        random_probes(&p, false, 4.0, &state);
        run_everywhere(&b, &s, PROBE_2D_LOD, &p);
        for (int i = 0; i < BATCH; i++)
            assert_true(p.out[i][0] == (float)code * (1.0f / 255.0f));
        amb_texture_close(&b.texture);
    }
}

/* ---- cube seams ------------------------------------------------------------------------------------------------- */

/* Along great circles and through corners, neighbouring directions never jump by more than the steepest slope allows.
 */
static void test_cube_is_continuous(void **unused)
{
    (void)unused;
    uint32_t state = 9;
    static batch p;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 8, 8, 1, true, &state);
    amb_sampler s = {.filter = AMB_TRILINEAR};
    for (int path = 0; path < 60; path++) {
        double from[3], to[3];
        for (int a = 0; a < 3; a++) {
            double corner = path & (1 << a) ? 1.0 : -1.0,
                   edge = (path / 8) % 3 == a ? pair_uniform(&state, -1, 1) : corner;
            double middle = path < 24 ? corner : edge; /* through corners, then across edges */
            double step = pair_uniform(&state, -1e-3, 1e-3);
            from[a] = middle - step;
            to[a] = middle + step;
        }
        for (int i = 0; i < BATCH; i++)
            for (int a = 0; a < 3; a++) {
                p.in[i].at[a] = (float)(from[a] + (to[a] - from[a]) * i / (BATCH - 1.0));
                p.in[i].lod = 0.3f;
            }
        run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
        /* A step is at most 2·1.8e-3/511 long: on a face of 8 texels across 2 units, 8 texels a unit with the slant of
         * a corner, under 6e-5 texels; two axes of unit contrast plus rounding. */
        for (int i = 1; i < BATCH; i++)
            for (int k = 0; k < 4; k++)
                assert_true(fabsf(p.out[i][k] - p.out[i - 1][k]) < 1.5e-4f);
    }
    close_both(&b);
}

static void test_corner_is_average_of_three(void **unused)
{
    (void)unused;
    uint32_t state = 10;
    static batch p;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 4, 4, 1, false, &state);
    amb_sampler s = {.filter = AMB_BILINEAR};
    for (int i = 0; i < BATCH; i++)
        for (int a = 0; a < 3; a++)
            p.in[i].at[a] = i & (1 << a) ? 1.0f : -1.0f;
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    /* At a cube's corner four weights of ¼ meet three texels and their average: the average. The texels nearest to
     * (+,+,+): face +x top left, +y bottom right, +z top right. */
    const ref_color *t = b.reference->texel[0];
    for (int k = 0; k < 4; k++) {
        double want = (t[0].c[k] + t[2 * 16 + 15].c[k] + t[4 * 16 + 3].c[k]) / 3.0;
        assert_true(fabs((double)p.out[7][k] - want) < 1e-6);
    }
    close_both(&b);
}

/* Face order and orientation: each face's middle and its first texel, from the published table. */
static void test_cube_orientation(void **unused)
{
    (void)unused;
    static const float middle[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const float top_left[6][3] = {{1, .9f, .9f},   {-1, .9f, -.9f}, {-.9f, 1, -.9f},
                                         {-.9f, -1, .9f}, {-.9f, .9f, 1},  {.9f, .9f, -1}};
    unsigned char data[6 * 9];
    for (int i = 0; i < 54; i++)
        data[i] = (unsigned char)(i / 9 * 10 + (i % 9 == 0 ? 5 : 0)); /* the first texel is marked */
    amb_texture_desc desc = {.kind = AMB_TEXTURE_CUBE,
                             .texel = AMB_TEXEL_R8,
                             .width = 3,
                             .height = 3,
                             .data = data,
                             .data_bytes = sizeof data};
    both b = {0};
    assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
    amb_sampler s = {.filter = AMB_NEAREST};
    static batch p;
    for (int i = 0; i < BATCH; i++)
        memcpy(p.in[i].at, i % 12 < 6 ? middle[i % 6] : top_left[i % 6], sizeof p.in[i].at);
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    for (int i = 0; i < 12; i++)
        assert_int_equal((int)(p.out[i][0] * 255.0f + 0.5f), i % 6 * 10 + (i < 6 ? 0 : 5));
    amb_texture_close(&b.texture);
}

/* ---- hostile coordinates ---------------------------------------------------------------------------------------- */

static void test_hostile_coordinates(void **unused)
{
    (void)unused;
    static const float value[] = {NAN,    INFINITY,    -INFINITY,   3.4e38f,        -3.4e38f,     1e30f,
                                  -1e20f, 16777217.0f, -0.0f,       0.0f,           1e-45f,       -1e-45f,
                                  1.0f,   -1.0f,       0.99999994f, -2147483648.0f, 4294967296.0f};
    enum { VALUES = sizeof value / sizeof value[0] };
    uint32_t state = 11;
    static batch p;
    for (int kind = 0; kind < 3; kind++) {
        both b = make_both((amb_texture_kind)kind, AMB_TEXEL_RGBA8, 4, 4, 4, true, &state);
        for (int round = 0; round < 60; round++) {
            amb_sampler s = random_sampler(&state);
            s.max_anisotropy = (int)(pair_random(&state) % 17);
            for (int i = 0; i < BATCH; i++) {
                float *f = (float *)&p.in[i];
                for (size_t k = 0; k < sizeof(probe) / sizeof(float); k++)
                    f[k] = value[pair_random(&state) % VALUES];
            }
            static const probe_mode modes[3][2] = {
                {PROBE_2D_LOD, PROBE_2D_GRAD}, {PROBE_CUBE_LOD, PROBE_CUBE_GRAD}, {PROBE_3D_LOD, PROBE_3D_LOD}};
            for (int m = 0; m < 2; m++) {
                run_everywhere(&b, &s, modes[kind][m], &p);
                for (int i = 0; i < BATCH; i++)
                    for (int k = 0; k < 4; k++)
                        assert_true(p.out[i][k] >= 0.0f && p.out[i][k] <= 1.0001f);
            }
        }
        close_both(&b);
    }
}

static void test_nan_and_infinity_sample_zero(void **unused)
{
    (void)unused;
    uint32_t state = 12;
    static batch p;
    both b = make_both(AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 4, 4, 1, false, &state);
    amb_sampler s = {.filter = AMB_BILINEAR};
    memset(&p, 0, sizeof p);
    p.in[1].at[0] = NAN, p.in[2].at[0] = INFINITY, p.in[3].at[1] = -INFINITY, p.in[4].lod = NAN;
    run_everywhere(&b, &s, PROBE_2D_LOD, &p);
    for (int i = 1; i < 5; i++)
        assert_memory_equal(p.out[i], p.out[0], sizeof p.out[0]);
    close_both(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_2d_matches_reference),       cmocka_unit_test(test_3d_matches_reference),
        cmocka_unit_test(test_cube_matches_reference),     cmocka_unit_test(test_cube_anisotropy),
        cmocka_unit_test(test_quads_give_the_gradients),   cmocka_unit_test(test_cube_is_continuous),
        cmocka_unit_test(test_corner_is_average_of_three), cmocka_unit_test(test_cube_orientation),
        cmocka_unit_test(test_hostile_coordinates),        cmocka_unit_test(test_nan_and_infinity_sample_zero),
        cmocka_unit_test(test_pairs_are_two_look_ups),     cmocka_unit_test(test_unorm_weights),
        cmocka_unit_test(test_unorm_constants_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
