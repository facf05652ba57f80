/* Descriptions of textures that are refused, each with its one line. */
#include <ambiance/texture.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static void test_bad_descriptions(void **unused)
{
    (void)unused;
    unsigned char data[64] = {0};
    const amb_texture_desc good = {.texel = AMB_TEXEL_R8, .width = 8, .height = 8, .data = data, .data_bytes = 64};
    const struct {
        amb_texture_desc desc;
        amb_status status;
        const char *line;
    } bad[] = {
        {{.kind = (amb_texture_kind)7, .texel = AMB_TEXEL_R8, .width = 8, .height = 8, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: kind 7 is unknown; allowed are 2D, cube, 3D and 2D array"},
        {{.texel = (amb_texel)11, .width = 8, .height = 8, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: texel format 11 is unknown; allowed are 0 to 10"},
        {{.width = 0, .height = 8, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: width is 0; it must be at least 1"},
        {{.width = 8, .height = -3, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: height is -3; it must be at least 1"},
        {{.kind = AMB_TEXTURE_3D, .width = 8, .height = 8, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: depth is 0; it must be at least 1"},
        {{.width = 32769, .height = 8, .data = data, .data_bytes = 64},
         AMB_ERROR_LIMIT,
         "texture: width is 32769; at most 32768 are allowed"},
        {{.kind = AMB_TEXTURE_CUBE, .width = 8, .height = 4, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: cube faces are 8 x 4; they must be square"},
        {{.width = 8, .height = 8, .levels = 5, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: levels is 5; a 2D texture of this size has 1 to 4 (0 means 1)"},
        {{.width = 8, .height = 8, .levels = -1, .data = data, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: levels is -1; a 2D texture of this size has 1 to 4 (0 means 1)"},
        {{.width = 8, .height = 8, .data = NULL, .data_bytes = 64},
         AMB_ERROR_ARGUMENT,
         "texture: data is NULL; it must point to 64 bytes of texels, or data_bytes be 0"},
        {{.width = 8, .height = 8, .data = data, .data_bytes = 63},
         AMB_ERROR_ARGUMENT,
         "texture: data_bytes is 63; this description needs exactly 64"},
        {{.kind = AMB_TEXTURE_3D,
          .texel = AMB_TEXEL_R8,
          .width = 2048,
          .height = 2048,
          .depth = 512,
          .data = data,
          .data_bytes = (size_t)2048 * 2048 * 512},
         AMB_ERROR_LIMIT,
         "texture: 2048 x 2048 x 512 texels take more than 8 GiB; use a smaller size or format"},
    };
    amb_texture *t = NULL;
    amb_error error;
    assert_int_equal(amb_texture_create(&good, &t, &error), AMB_OK);
    amb_texture_close(&t);
    amb_texture_close(&t);
    amb_texture_close(NULL);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        t = (amb_texture *)&error;
        assert_int_equal(amb_texture_create(&bad[i].desc, &t, &error), bad[i].status);
        assert_string_equal(error.detail, bad[i].line);
        assert_null(t);
        assert_int_equal(amb_texture_create(&bad[i].desc, &t, NULL), bad[i].status);
    }
    assert_int_equal(amb_texture_create(NULL, &t, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_texture_create(&good, NULL, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_texture_from_image(NULL, AMB_TEXEL_R8, false, &t, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: image is NULL; it must be an image");
}
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_descriptions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
