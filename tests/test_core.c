/* Contexts, threads, errors, images, frames and parameter tables. */
#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/param.h>
#include <ambiance/vec.h>

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <cmocka.h>

#define CONTAINS(error, words) assert_non_null(strstr((error).detail, words))

/* ---- context ---------------------------------------------------------------------------------------------------- */

typedef struct visits {
    int count[1000];
    int threads;
    int outside;
    float denormal_half[1000];
} visits;

static void visit(void *user, int index, int thread)
{
    visits *v = user;
    volatile float tiny = FLT_MIN;
    v->count[index]++;
    v->denormal_half[index] = tiny * 0.5f;
    if (thread < 0 || thread >= v->threads)
        v->outside = 1;
}

static void every_index_runs_once_with_ieee_defaults(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 5; threads++) {
        amb_context *context;
        assert_int_equal(amb_context_create(&(amb_context_options){.threads = threads}, &context, NULL), AMB_OK);
        assert_int_equal(amb_context_threads(context), threads);
        visits v = {.threads = threads};
#if defined(__x86_64__)
        unsigned before = _mm_getcsr();
        _mm_setcsr(before | 0x8040u); /* a host that flushes denormals must not change our floats */
#endif
        amb_parallel_for(context, 1000, visit, &v);
        amb_parallel_for(context, 0, visit, &v);
#if defined(__x86_64__)
        unsigned after = _mm_getcsr();
        _mm_setcsr(before);
        assert_int_equal(after & 0x8040u, 0x8040u); /* and gets its own mode back */
#endif
        for (int i = 0; i < 1000; i++) {
            assert_int_equal(v.count[i], 1);
            assert_true(v.denormal_half[i] != 0);
        }
        assert_false(v.outside);
        amb_context_close(&context);
        assert_null(context);
    }
}

static void bad_contexts_are_refused(void **state)
{
    (void)state;
    amb_context *context;
    amb_error error;
    assert_int_equal(amb_context_create(&(amb_context_options){.threads = -1}, &context, &error), AMB_ERROR_ARGUMENT);
    CONTAINS(error, "threads -1");
    assert_null(context);
    assert_int_equal(amb_context_create(&(amb_context_options){.threads = 1025}, &context, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_context_create(&(amb_context_options){.isa = (amb_isa)3}, &context, &error), AMB_ERROR_ISA);
    amb_isa isa;
    assert_int_equal(amb_isa_parse("avx9", &isa, &error), AMB_ERROR_ARGUMENT);
    CONTAINS(error, "'avx9'");
    CONTAINS(error, "v2, v3, v4");
    assert_int_equal(amb_isa_parse("v3", &isa, &error), AMB_OK);
    assert_int_equal(isa, AMB_ISA_V3);
    amb_context_close(NULL);
}

static void error_lines_stay_one_line(void **state)
{
    (void)state;
    amb_error error;
    char longer[2000];
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    assert_int_equal(amb_fail(&error, AMB_ERROR_IO, "a\nb\033%s", "c\r"), AMB_ERROR_IO);
    assert_string_equal(error.detail, "a?b?c?");
    amb_fail(&error, AMB_ERROR_IO, "%s", longer);
    assert_int_equal(strlen(error.detail), sizeof error.detail - 1);
    for (int s = -8; s <= 0; s++)
        assert_true(strcmp(amb_status_text((amb_status)s), "unknown status") != 0);
}

/* ---- images and frames ------------------------------------------------------------------------------------------ */

static void image_sizes_are_checked(void **state)
{
    (void)state;
    static const struct {
        int width, height, channels;
        amb_status status;
    } bad[] = {{0, 5, 1, AMB_ERROR_ARGUMENT},  {5, -1, 1, AMB_ERROR_ARGUMENT},     {1000000, 1, 1, AMB_ERROR_LIMIT},
               {1, 65537, 1, AMB_ERROR_LIMIT}, {65536, 65536, 1, AMB_ERROR_LIMIT}, {4, 4, 0, AMB_ERROR_ARGUMENT},
               {4, 4, 5, AMB_ERROR_ARGUMENT}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        amb_image *image = (amb_image *)1;
        amb_error error;
        assert_int_equal(amb_image_create(bad[i].width, bad[i].height, bad[i].channels, &image, &error), bad[i].status);
        assert_null(image);
    }
}

static void image_rows_are_aligned_zeroed_and_hashed(void **state)
{
    (void)state;
    amb_image *image, *copy;
    assert_int_equal(amb_image_create(3, 2, 2, &image, NULL), AMB_OK);
    for (int c = 0; c < 2; c++)
        for (int y = 0; y < 2; y++) {
            float *row = amb_image_row(image, c, y);
            assert_int_equal((uintptr_t)row % 64, 0);
            for (int x = 0; x < 3; x++) {
                assert_true(row[x] == 0);
                row[x] = (float)(c * 6 + y * 3 + x);
            }
            row[3] = 99; /* padding is not part of the picture */
        }
    char hex[65], copied[65];
    amb_image_sha256(image, hex);
    /* sha256sum of the int32 3, 2, 2 and the floats 0…11, little-endian */
    assert_string_equal(hex, "c882711757f574e0c10ab0db729f4d326a211aa0d9df2ad166328b721c1911f8");
    assert_int_equal(amb_image_copy(image, &copy, NULL), AMB_OK);
    amb_image_sha256(copy, copied);
    assert_string_equal(copied, hex);
    amb_image_row(copy, 1, 1)[2] = 0;
    amb_image_sha256(copy, copied);
    assert_true(strcmp(copied, hex) != 0);
    amb_image_close(&image);
    amb_image_close(&image);
    amb_image_close(&copy);
}

static void frames_hold_named_layers(void **state)
{
    (void)state;
    amb_frame *frame;
    amb_image *image;
    amb_error error;
    assert_int_equal(amb_frame_create(7, 5, &frame, NULL), AMB_OK);
    assert_int_equal(amb_frame_layer(frame, "color")->channels, 4);
    assert_null(amb_frame_layer(frame, "depth"));
    assert_int_equal(amb_frame_add_layer(frame, "depth", 1, &image, NULL), AMB_OK);
    assert_ptr_equal(amb_frame_layer(frame, "depth"), image);
    assert_int_equal(amb_frame_add_layer(frame, "depth", 1, &image, &error), AMB_ERROR_ARGUMENT);
    CONTAINS(error, "depth");
    assert_int_equal(amb_frame_add_layer(frame, "", 1, &image, NULL), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_frame_add_layer(frame, "a name that is far too long to be a layer's", 1, &image, NULL),
                     AMB_ERROR_ARGUMENT);
    char name[8];
    for (int i = 2; i < AMB_MAX_LAYERS; i++) {
        snprintf(name, sizeof name, "l%d", i);
        assert_int_equal(amb_frame_add_layer(frame, name, 3, &image, NULL), AMB_OK);
    }
    assert_int_equal(amb_frame_add_layer(frame, "more", 3, &image, NULL), AMB_ERROR_LIMIT);
    amb_frame_close(&frame);
    assert_null(frame);
}

/* ---- parameters ------------------------------------------------------------------------------------------------- */

typedef struct lantern {
    float glow;
    int wicks, lit, paper;
    v3 tint;
} lantern;

static const char *const papers[] = {"rice", "silk", NULL};
static const amb_param lantern_table[] = {
    {"glow", AMB_PARAM_FLOAT, "cd", 0, 10, {0.1f}, NULL, offsetof(lantern, glow), "brightness"},
    {"wicks", AMB_PARAM_INT, "", 1, 9, {3}, NULL, offsetof(lantern, wicks), "number of flames"},
    {"lit", AMB_PARAM_BOOL, "", 0, 1, {1}, NULL, offsetof(lantern, lit), "burning"},
    {"paper", AMB_PARAM_CHOICE, "", 0, 1, {1}, papers, offsetof(lantern, paper), "shade"},
    {"tint", AMB_PARAM_COLOR, "", 0, 1, {1, 0.5f, 0.25f}, NULL, offsetof(lantern, tint), "colour"},
};
static const amb_params lantern_params = {lantern_table, 5, sizeof(lantern)};

static void defaults_come_from_the_table(void **state)
{
    (void)state;
    lantern l;
    amb_params_defaults(&lantern_params, &l);
    assert_true(l.glow == 0.1f && l.wicks == 3 && l.lit == 1 && l.paper == 1);
    assert_true(l.tint.x == 1 && l.tint.y == 0.5f && l.tint.z == 0.25f);
}

static void printed_values_read_back_to_the_same_bits(void **state)
{
    (void)state;
    uint32_t random = 7;
    for (int i = 0; i < 2000; i++) {
        lantern l, back;
        amb_params_defaults(&lantern_params, &l);
        back = l;
        float *numbers[] = {&l.tint.x, &l.tint.y, &l.tint.z, &l.glow};
        for (int n = 0; n < 4; n++) {
            random = random * 1664525u + 1013904223u;
            *numbers[n] = (float)(random >> 8) / 16777216.0f;
        }
        l.wicks = 1 + i % 9;
        l.lit = i & 1;
        l.paper = i >> 1 & 1;
        for (size_t p = 0; p < lantern_params.count; p++) {
            char text[128];
            int length = amb_params_print(&lantern_table[p], &l, text, sizeof text);
            assert_int_equal(length, strlen(text));
            assert_int_equal(amb_params_set(&lantern_params, &back, "scene lantern", lantern_table[p].name, text, NULL),
                             AMB_OK);
        }
        assert_memory_equal(&l, &back, sizeof l);
    }
    lantern l;
    amb_params_defaults(&lantern_params, &l);
    char text[64];
    amb_params_print(&lantern_table[0], &l, text, sizeof text);
    assert_string_equal(text, "0.1"); /* the shortest that reads back */
    assert_int_equal(amb_params_print(&lantern_table[4], &l, NULL, 0), strlen("1,0.5,0.25"));
}

static void bad_values_are_named_with_what_is_allowed(void **state)
{
    (void)state;
    static const struct {
        const char *name, *value, *words;
        amb_status status;
    } bad[] = {
        {"glow", "11", "'11' is not a number from 0 to 10 cd", AMB_ERROR_ARGUMENT},
        {"glow", "-0.1", "from 0 to 10", AMB_ERROR_ARGUMENT},
        {"glow", "nan", "'nan'", AMB_ERROR_ARGUMENT},
        {"glow", "inf", "'inf'", AMB_ERROR_ARGUMENT},
        {"glow", "", "''", AMB_ERROR_ARGUMENT},
        {"glow", "1x", "'1x'", AMB_ERROR_ARGUMENT},
        {"wicks", "2.5", "a whole number from 1 to 9", AMB_ERROR_ARGUMENT},
        {"lit", "maybe", "true or false", AMB_ERROR_ARGUMENT},
        {"paper", "tin", "one of rice, silk", AMB_ERROR_ARGUMENT},
        {"tint", "1,1", "three numbers", AMB_ERROR_ARGUMENT},
        {"tint", "1,1,1,1", "three numbers", AMB_ERROR_ARGUMENT},
        {"tint", "1,1,2", "three numbers", AMB_ERROR_ARGUMENT},
        {"glwo", "1", "did you mean 'glow'", AMB_ERROR_NOT_FOUND},
        {"zzzzzzzz", "1", "it has: glow, wicks, lit, paper, tint", AMB_ERROR_NOT_FOUND},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        lantern l, before;
        amb_error error = {0};
        amb_params_defaults(&lantern_params, &l);
        before = l;
        assert_int_equal(amb_params_set(&lantern_params, &l, "scene lantern", bad[i].name, bad[i].value, &error),
                         bad[i].status);
        CONTAINS(error, bad[i].words);
        CONTAINS(error, "scene lantern");
        assert_memory_equal(&l, &before, sizeof l);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_index_runs_once_with_ieee_defaults),
        cmocka_unit_test(bad_contexts_are_refused),
        cmocka_unit_test(error_lines_stay_one_line),
        cmocka_unit_test(image_sizes_are_checked),
        cmocka_unit_test(image_rows_are_aligned_zeroed_and_hashed),
        cmocka_unit_test(frames_hold_named_layers),
        cmocka_unit_test(defaults_come_from_the_table),
        cmocka_unit_test(printed_values_read_back_to_the_same_bits),
        cmocka_unit_test(bad_values_are_named_with_what_is_allowed),
    };
    return cmocka_run_group_tests_name("core", tests, NULL, NULL);
}
