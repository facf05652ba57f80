/* Making textures: levels against brute force, and textures from images. */
#include "tests/texture_pairs.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

/* ---- made levels ------------------------------------------------------------------------------------------------ */

/* Every texel of every level through a nearest look-up at its centre. */
static void check_levels(const both *b, double bound)
{
    amb_sampler s = {.filter = AMB_NEAREST};
    static batch p;
    for (int l = 0; l < b->reference->levels; l++) {
        int w = b->reference->width[l], h = b->reference->height[l], count = w * h;
        for (int first = 0; first < count; first += BATCH) {
            for (int i = 0; i < BATCH; i++) {
                int at = (first + i) % count;
                p.in[i] = (probe){.at = {((float)(at % w) + 0.5f) / (float)w, ((float)(at / w) + 0.5f) / (float)h},
                                  .lod = (float)l};
            }
            run_everywhere(b, &s, PROBE_2D_LOD, &p);
            for (int i = 0; i < BATCH; i++)
                for (int k = 0; k < 4; k++) {
                    double want = b->reference->texel[l][(first + i) % count].c[k];
                    if (!(fabs((double)p.out[i][k] - want) <= bound * (l ? 1.0 : fabs(want)) + 1e-30))
                        fail_msg("level %d texel %d channel %d: %.9g, reference %.9g", l, (first + i) % count, k,
                                 (double)p.out[i][k], want);
                }
        }
    }
}

static void test_mips_match_brute_force(void **unused)
{
    (void)unused;
    uint32_t state = 6;
    static const int size[][2] = {{16, 16}, {13, 7}, {1, 9}, {27, 2}};
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_2D, every_texel[f], size[z][0], size[z][1], 1, true, &state);
            check_levels(&b, storage_bound(every_texel[f], true));
            close_both(&b);
        }
}

static void test_given_levels_are_kept(void **unused)
{
    (void)unused;
    uint32_t state = 7;
    unsigned char data[4 * (64 + 16 + 4)];
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)pair_random(&state);
    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA8,
                             .width = 8,
                             .height = 8,
                             .levels = 3,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = sizeof data};
    amb_error error;
    both b = {.reference = ref_create(&desc), .data = NULL};
    assert_int_equal(amb_texture_create(&desc, &b.texture, &error), AMB_OK);
    assert_int_equal(amb_texture_describe(b.texture).levels, 4);
    check_levels(&b, storage_bound(AMB_TEXEL_RGBA8, true));
    close_both(&b);
    desc.make_mips = false;
    assert_int_equal(amb_texture_create(&desc, &b.texture, &error), AMB_OK);
    assert_int_equal(amb_texture_describe(b.texture).levels, 3);
    amb_texture_close(&b.texture);
}

/* A constant texture is constant at every level, filter and footprint. */
static void test_constant_stays_constant(void **unused)
{
    (void)unused;
    static batch p;
    uint32_t state = 8;
    float data[4 * 15 * 9];
    for (size_t i = 0; i < sizeof data / sizeof *data; i++)
        data[i] = 0.7f;
    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA32F,
                             .width = 15,
                             .height = 9,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = sizeof data};
    both b = {0};
    assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
    for (int round = 0; round < 20; round++) {
        amb_sampler s = random_sampler(&state);
        s.max_anisotropy = (int)(pair_random(&state) % 17);
        random_probes(&p, false, 4.0, &state);
        run_everywhere(&b, &s, PROBE_2D_GRAD, &p);
        for (int i = 0; i < BATCH; i++)
            assert_true(fabsf(p.out[i][0] - 0.7f) < 2e-6f);
    }
    amb_texture_close(&b.texture);
}

/* ---- from images ------------------------------------------------------------------------------------------------ */

static void test_from_image_round_trips(void **unused)
{
    (void)unused;
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(16, 16, 3, &image, NULL), AMB_OK);
    static const double bound[TEXELS] = {0.5 / 255, 0.5 / 255, 0.5 / 255, 0.0045,  0x1p-12, 0x1p-12,
                                         0,         0,         0x1p-6,    0x1p-12, 0};
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 16; x++)
            for (int c = 0; c < 3; c++)
                amb_image_row(image, c, y)[x] = (float)(x + 16 * y) / 255.0f * (c == 1 ? 0.5f : 1.0f);
    for (int f = 0; f < TEXELS; f++) {
        both b = {0};
        assert_int_equal(amb_texture_from_image(image, every_texel[f], false, &b.texture, NULL), AMB_OK);
        static batch p;
        for (int i = 0; i < BATCH; i++)
            p.in[i] = (probe){.at = {((float)(i % 16) + 0.5f) / 16.0f, ((float)(i / 16 % 16) + 0.5f) / 16.0f}};
        amb_sampler s = {.filter = AMB_NEAREST};
        run_everywhere(&b, &s, PROBE_2D_LOD, &p);
        bool one =
            every_texel[f] == AMB_TEXEL_R8 || every_texel[f] == AMB_TEXEL_R16F || every_texel[f] == AMB_TEXEL_R32F;
        for (int i = 0; i < 256; i++) {
            assert_true(fabs((double)p.out[i][0] - i / 255.0) <= bound[f] + 1e-6);
            assert_true(fabs((double)p.out[i][1] - (one ? 0.0 : i / 510.0)) <= bound[f] + 1e-6);
            assert_true(p.out[i][3] == 1.0f);
        }
        amb_texture_close(&b.texture);
    }
    amb_image_close(&image);
}

/* Every sRGB code comes back from its own linear value. */
static void test_srgb_codes_round_trip(void **unused)
{
    (void)unused;
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(256, 1, 1, &image, NULL), AMB_OK);
    for (int c = 0; c < 256; c++) {
        unsigned char bytes[4] = {(unsigned char)c};
        /* Off the exact value by up to a third of a code, which still is the nearest. */
        unsigned char neighbour[4] = {(unsigned char)(c + (c < 255))};
        double value = ref_decode(AMB_TEXEL_SRGB8_A8, bytes).c[0],
               next = ref_decode(AMB_TEXEL_SRGB8_A8, neighbour).c[0];
        amb_image_row(image, 0, 0)[c] = (float)(value + 0.3 * (next - value));
    }
    both b = {0};
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_SRGB8_A8, false, &b.texture, NULL), AMB_OK);
    static batch p;
    for (int i = 0; i < BATCH; i++)
        p.in[i].at[0] = ((float)(i % 256) + 0.5f) / 256.0f;
    amb_sampler s = {.filter = AMB_NEAREST};
    run_everywhere(&b, &s, PROBE_2D_LOD, &p);
    for (int c = 0; c < 256; c++) {
        unsigned char bytes[4] = {(unsigned char)c};
        double want = ref_decode(AMB_TEXEL_SRGB8_A8, bytes).c[0];
        if (!(fabs((double)p.out[c][0] - want) <= 0x1.01p-11 * want))
            fail_msg("code %d: %.9g, reference %.9g", c, (double)p.out[c][0], want);
    }
    amb_texture_close(&b.texture);
    amb_image_close(&image);
}

static void test_cube_from_images(void **unused)
{
    (void)unused;
    amb_image *face[6] = {NULL};
    for (int i = 0; i < 6; i++) {
        assert_int_equal(amb_image_create(4, 4, 3, &face[i], NULL), AMB_OK);
        for (int y = 0; y < 4; y++)
            for (int x = 0; x < 4; x++)
                amb_image_row(face[i], 0, y)[x] = (float)i;
    }
    both b = {0};
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, NULL), AMB_OK);
    static batch p;
    for (int i = 0; i < BATCH; i++)
        p.in[i].at[i % 6 / 2] = i % 2 ? -2.0f : 2.0f;
    amb_sampler s = {.filter = AMB_TRILINEAR};
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    for (int i = 0; i < 6; i++)
        assert_true(p.out[i][0] == (float)i);
    amb_texture_close(&b.texture);

    amb_error error;
    amb_image_close(&face[5]);
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, &error),
                     AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: face -z is NULL; it must be an image");
    assert_int_equal(amb_image_create(5, 4, 3, &face[5], NULL), AMB_OK);
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, &error),
                     AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: face -z is 5 x 4; all faces must be 4 x 4, as face +x is wide");
    for (int i = 0; i < 6; i++)
        amb_image_close(&face[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mips_match_brute_force),  cmocka_unit_test(test_given_levels_are_kept),
        cmocka_unit_test(test_constant_stays_constant), cmocka_unit_test(test_from_image_round_trips),
        cmocka_unit_test(test_srgb_codes_round_trip),   cmocka_unit_test(test_cube_from_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
