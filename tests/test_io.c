/* Picture files: round trips, files of other programs (tests/data was written by exrmaketiled and ImageMagick), and
 * values worked out from the formats' definitions. */
#include "io/file.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

static char folder[] = "/tmp/ambiance-io-XXXXXX";

static const char *in_folder(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static float from_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void must(amb_status status, const amb_error *error)
{
    if (status != AMB_OK)
        fail_msg("%s", error->detail);
}

/* One line that names what it is about. */
static void must_fail(amb_status status, amb_status expected, const amb_error *error, const char *mentions)
{
    if (status != expected || error->status != expected || !strstr(error->detail, mentions) ||
        strchr(error->detail, '\n'))
        fail_msg("status %d, expected %d mentioning '%s': %s", status, expected, mentions,
                 status ? error->detail : "(succeeded)");
}

static amb_frame *random_frame(int width, int height, unsigned seed)
{
    static const struct {
        const char *name;
        int channels;
    } layers[] = {{"depth", 1}, {"position", 3}, {"motion", 2}, {"tint", 4}, {"a.dotted.name", 1}};
    amb_frame *frame;
    amb_error error;
    must(amb_frame_create(width, height, &frame, &error), &error);
    for (size_t i = 0; i < sizeof layers / sizeof *layers; i++)
        must(amb_frame_add_layer(frame, layers[i].name, layers[i].channels, &(amb_image *){NULL}, &error), &error);
    for (int l = 0; l < frame->layer_count; l++) {
        const amb_image *image = frame->layer[l].image;
        for (int c = 0; c < image->channels; c++)
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++) {
                    seed = seed * 1664525u + 1013904223u;
                    amb_image_row(image, c, y)[x] = from_bits(seed); /* every kind of float, NaN too */
                }
    }
    return frame;
}

/* The nearest half by search over all of them in double precision, ties to the even one: no bit tricks. */
static double half_value(unsigned half)
{
    int exponent = (int)(half >> 10 & 31), mantissa = (int)(half & 1023);
    double magnitude = exponent == 0 ? ldexp(mantissa, -24) : ldexp(1024 + mantissa, exponent - 25);
    return half & 0x8000 ? -magnitude : magnitude;
}

static double round_to_half(double value)
{
    double magnitude = fabs(value);
    if (isnan(value))
        return (double)NAN;
    unsigned low = 0, high = 0x7c00; /* 0x7c00 stands for 65536, what would come after the largest */
    while (high - low > 1) {
        unsigned middle = (low + high) / 2;
        *(half_value(middle) <= magnitude ? &low : &high) = middle;
    }
    double below = magnitude - half_value(low), above = half_value(high) - magnitude;
    unsigned nearest = below < above || (below == above && !(low & 1)) ? low : high;
    return copysign(nearest == 0x7c00 ? (double)INFINITY : half_value(nearest), value);
}

static void exr_round_trips_every_float(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 40}, {37, 1}, {16, 16}, {67, 35}};
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int type = AMB_HALF; type <= AMB_FLOAT; type++) {
            amb_frame *frame = random_frame(sizes[i][0], sizes[i][1], (unsigned)i * 7u + 1u), *back;
            amb_error error;
            must(amb_write_exr(frame, in_folder("trip.exr"), (amb_pixel_type)type, &error), &error);
            must(amb_read_exr(in_folder("trip.exr"), &back, &error), &error);
            assert_int_equal(back->layer_count, frame->layer_count);
            for (int l = 0; l < frame->layer_count; l++) {
                const amb_image *a = frame->layer[l].image, *b = amb_frame_layer(back, frame->layer[l].name);
                assert_non_null(b);
                assert_int_equal(b->channels, a->channels);
                assert_true(b->width == a->width && b->height == a->height);
                for (int c = 0; c < a->channels; c++)
                    for (int y = 0; y < a->height; y++)
                        for (int x = 0; x < a->width; x++) {
                            float sent = amb_image_row(a, c, y)[x], got = amb_image_row(b, c, y)[x];
                            if (type == AMB_FLOAT)
                                assert_int_equal(bits_of(got), bits_of(sent));
                            else if (isnan(sent))
                                assert_true(isnan(got));
                            else
                                assert_int_equal(bits_of(got), bits_of((float)round_to_half((double)sent)));
                        }
            }
            amb_frame_close(&frame);
            amb_frame_close(&back);
        }
}

/* Every half, both neighbours of every midpoint between halves, and the midpoints. */
static void exr_halves_round_to_nearest_even(void **state)
{
    amb_frame *frame, *back;
    amb_error error;
    (void)state;
    must(amb_frame_create(1024, 31 * 4, &frame, &error), &error);
    const amb_image *color = frame->layer[0].image;
    for (unsigned half = 0; half < 31 * 1024; half++) {
        float middle = (float)(0.5 * (half_value(half) + half_value(half + 1)));
        float values[4] = {(float)half_value(half), middle, nextafterf(middle, 0.0f), nextafterf(middle, 1e9f)};
        for (int i = 0; i < 4; i++)
            for (int c = 0; c < 4; c++)
                amb_image_row(color, c, (int)(half / 1024) * 4 + i)[half % 1024] = c & 1 ? -values[i] : values[i];
    }
    must(amb_write_exr(frame, in_folder("half.exr"), AMB_HALF, &error), &error);
    must(amb_read_exr(in_folder("half.exr"), &back, &error), &error);
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < color->height; y++)
            for (int x = 0; x < color->width; x++) {
                double expected = round_to_half((double)amb_image_row(color, c, y)[x]);
                assert_int_equal(bits_of(amb_image_row(back->layer[0].image, c, y)[x]), bits_of((float)expected));
            }
    amb_frame_close(&frame);
    amb_frame_close(&back);
}

static void exr_keeps_metadata_and_equal_frames_are_equal_files(void **state)
{
    amb_frame *frame = random_frame(50, 40, 5), *back;
    amb_error error;
    uint8_t *one, *two;
    size_t one_bytes, two_bytes;
    (void)state;
    snprintf(frame->meta.scene, sizeof frame->meta.scene, "julia");
    frame->meta.time = 1.0 / 3.0;
    frame->meta.parameters = strdup("steps=96 colour=1,0.5,0.25 name=\"two words\"");
    frame->meta.post = strdup("bloom threshold=1.5");
    snprintf(frame->meta.assets_sha256, sizeof frame->meta.assets_sha256, "%064d", 7);
    snprintf(frame->meta.version, sizeof frame->meta.version, "9.8.7");
    must(amb_write_exr(frame, in_folder("one.exr"), AMB_HALF, &error), &error);
    must(amb_read_exr(in_folder("one.exr"), &back, &error), &error);
    assert_string_equal(back->meta.scene, "julia");
    assert_true(back->meta.time == 1.0 / 3.0);
    assert_string_equal(back->meta.parameters, frame->meta.parameters);
    assert_string_equal(back->meta.post, frame->meta.post);
    assert_string_equal(back->meta.assets_sha256, frame->meta.assets_sha256);
    assert_string_equal(back->meta.version, "9.8.7");
    must(amb_read_file(in_folder("one.exr"), &one, &one_bytes, &error), &error);
    sleep(1); /* a clock in the file would show */
    must(amb_write_exr(frame, in_folder("two.exr"), AMB_HALF, &error), &error);
    must(amb_read_file(in_folder("two.exr"), &two, &two_bytes, &error), &error);
    assert_int_equal(one_bytes, two_bytes);
    assert_memory_equal(one, two, one_bytes);
    free(one);
    free(two);
    amb_frame_close(&frame);
    amb_frame_close(&back);
}

/* tests/data/fuzz_exr: two known pictures as exrmaketiled packed them. */
static void exr_of_other_programs(void **state)
{
    static const struct {
        const char *name;
        bool is_checks, is_lossy;
    } files[] = {{"tiled_none", false, false}, {"tiled_pxr24", false, false}, {"mip_zip", false, false},
                 {"zip_float", false, false},  {"flat_piz", true, false},     {"flat_rle", true, false},
                 {"flat_b44a", true, true}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[96];
        amb_frame *frame;
        amb_error error;
        snprintf(path, sizeof path, "tests/data/fuzz_exr/%s.exr", files[i].name);
        must(amb_read_exr(path, &frame, &error), &error);
        const amb_image *color = frame->layer[0].image;
        assert_int_equal(color->width, files[i].is_checks ? 40 : 5);
        assert_int_equal(color->height, files[i].is_checks ? 34 : 19);
        for (int c = 0; c < 4; c++)
            for (int y = 0; y < color->height; y++)
                for (int x = 0; x < color->width; x++) {
                    double expected = files[i].is_checks ? (x / 8 + y / 8) % 3 : (double)((float)(x * y + c) * 0.37f);
                    if (strcmp(files[i].name, "zip_float") != 0)
                        expected = round_to_half(expected);
                    double got = (double)amb_image_row(color, c, y)[x];
                    if (files[i].is_lossy)
                        assert_true(fabs(got - expected) <= 0.05 + 0.05 * fabs(expected));
                    else
                        assert_true(got == expected);
                }
        amb_frame_close(&frame);
    }
    amb_frame *frame;
    amb_error error;
    must_fail(amb_read_exr("tests/data/fuzz_exr/dwa.exr", &frame, &error), AMB_ERROR_FORMAT, &error, "DWA");
    assert_null(frame);
}

/* A good file whose data window is changed to say something enormous. */
static void exr_with_a_huge_header_takes_no_memory(void **state)
{
    static const struct {
        int32_t width, height;
        amb_status expected;
    } claims[] = {{1000000, 1000000, AMB_ERROR_LIMIT},
                  {65536, 65536, AMB_ERROR_LIMIT},
                  {65536, 4096, AMB_ERROR_FORMAT}, /* allowed, but not from two thousand bytes */
                  {0, 10, AMB_ERROR_FORMAT},
                  {INT32_MAX, 1, AMB_ERROR_LIMIT}};
    uint8_t *data;
    size_t bytes;
    amb_error error;
    (void)state;
    must(amb_read_file("tests/data/fuzz_exr/zip_float.exr", &data, &bytes, &error), &error);
    uint8_t *window = memmem(data, bytes, "dataWindow\0box2i\0\20\0\0\0", 21);
    assert_non_null(window);
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    for (size_t i = 0; i < sizeof claims / sizeof *claims; i++) {
        amb_frame *frame;
        int32_t corner[2] = {claims[i].width - 1, claims[i].height - 1};
        memcpy(window + 21 + 8, corner, sizeof corner);
        amb_status status = amb_read_exr_memory(data, bytes, "huge.exr", &frame, &error);
        if (status == AMB_OK || (status != claims[i].expected && status != AMB_ERROR_FORMAT))
            fail_msg("%dx%d: status %d: %s", claims[i].width, claims[i].height, status, error.detail);
        assert_null(frame);
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024); /* KiB */
    free(data);
}

/* Pictures that claim 10⁶ pixels a side, each in its own way: refused before memory is taken. */
static void pictures_with_huge_headers(void **state)
{
    uint8_t png[] = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\x0f\x42\x40\0\x0f\x42\x40\x08\x06\0\0\0CRC4"
                    "\0\0\0\0IEND\xae\x42\x60\x82";
    uint8_t jpeg[] = "\xff\xd8\xff\xc0\0\x0b\x08\xff\xff\xff\xff\x01\x01\x11\0\xff\xd9";
    uint8_t hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n\2\2";
    uint32_t ktx[16] = {0, 0, 0, 0x04030201, 0x8c3b, 4, 0x1907, 0x8c3a, 0x1907, 1000000, 1000000, 0, 0, 6, 1, 0};
    const struct {
        const void *data;
        size_t bytes;
    } files[] = {{png, sizeof png - 1}, {jpeg, sizeof jpeg - 1}, {hdr, sizeof hdr - 1}, {ktx, sizeof ktx}};
    uint32_t sum = (uint32_t)crc32(0, png + 12, 17);
    struct rusage before, after;
    (void)state;
    for (int i = 0; i < 4; i++)
        png[29 + i] = (uint8_t)(sum >> (24 - 8 * i));
    memcpy(ktx, "\xabKTX 11\xbb\r\n\x1a\n", 12);
    getrusage(RUSAGE_SELF, &before);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        amb_texture *texture;
        amb_error error;
        amb_status status = amb_read_texture_memory(files[i].data, files[i].bytes, "huge", true, &texture, &error);
        if (status != AMB_ERROR_LIMIT && status != AMB_ERROR_FORMAT)
            fail_msg("file %zu: status %d", i, status);
        assert_null(texture);
        if (i != 0) /* libstb refuses such a PNG itself */
            assert_int_equal(status, AMB_ERROR_LIMIT);
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024); /* KiB */
}

static void png_round_trips(void **state)
{
    static const int sizes[][2] = {{1, 1}, {256, 1}, {3, 257}, {31, 17}};
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int channels = 1; channels <= 4; channels++) {
            amb_image *image, *back;
            amb_error error;
            bool is_linear = true;
            must(amb_image_create(sizes[i][0], sizes[i][1], channels, &image, &error), &error);
            for (int c = 0; c < channels; c++)
                for (int y = 0; y < image->height; y++)
                    for (int x = 0; x < image->width; x++)
                        amb_image_row(image, c, y)[x] = (float)((x + 3 * y + 7 * c) & 255) / 255.0f;
            must(amb_write_png(image, in_folder("trip.png"), &error), &error);
            must(amb_read_image(in_folder("trip.png"), &back, &is_linear, &error), &error);
            assert_false(is_linear);
            assert_int_equal(back->channels, channels);
            for (int c = 0; c < channels; c++)
                for (int y = 0; y < image->height; y++)
                    for (int x = 0; x < image->width; x++)
                        assert_true(amb_image_row(back, c, y)[x] == amb_image_row(image, c, y)[x]);
            amb_image_close(&image);
            amb_image_close(&back);
        }
}

static void png_quantises_to_nearest_and_contains_bad_values(void **state)
{
    const float values[] = {NAN, -INFINITY, -1.0f, 0.0f, 0.4f / 255, 0.6f / 255, 1.0f, 2.0f, INFINITY, 127.6f / 255};
    const int expected[] = {0, 0, 0, 0, 0, 1, 255, 255, 255, 128};
    const int count = sizeof values / sizeof *values;
    amb_image *image, *back;
    amb_error error;
    (void)state;
    must(amb_image_create(count, 1, 1, &image, &error), &error);
    memcpy(image->data, values, sizeof values);
    must(amb_write_png(image, in_folder("bad.png"), &error), &error);
    must(amb_read_image(in_folder("bad.png"), &back, NULL, &error), &error);
    for (int x = 0; x < count; x++)
        assert_int_equal((int)(back->data[x] * 255.0f + 0.5f), expected[x]);
    amb_image_close(&image);
    amb_image_close(&back);
}

/* The same little picture through ImageMagick: interlaced, 16 bits, JPEG. */
static void images_of_other_programs(void **state)
{
    static const struct {
        const char *name;
        int channels;
        double tolerance;
    } files[] = {{"rgb3.png", 3, 0.0},
                 {"interlaced.png", 3, 0.0},
                 {"deep.png", 4, 0.0},
                 {"baseline.jpg", 3, 1.0},
                 {"progressive.jpg", 3, 1.0}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[96];
        amb_image *image;
        amb_error error;
        double sum = 0.0, expected_sum = 0.0;
        snprintf(path, sizeof path, "tests/data/fuzz_image/%s", files[i].name);
        must(amb_read_image(path, &image, NULL, &error), &error);
        assert_int_equal(image->channels, files[i].channels);
        assert_true(image->width == 7 && image->height == 5);
        for (int c = 0; c < image->channels; c++)
            for (int y = 0; y < 5; y++)
                for (int x = 0; x < 7; x++) {
                    double expected = round((x * 37 + y * 11 + c * 5) % 17 / 16.0 * 255.0) / 255.0;
                    double got = (double)amb_image_row(image, c, y)[x];
                    assert_true(fabs(got - expected) <= files[i].tolerance + 1e-6);
                    sum += got;
                    expected_sum += expected;
                }
        assert_true(fabs(sum - expected_sum) < 0.05 * expected_sum);
        amb_image_close(&image);
    }
}

/* m · 2^(e-136), by the Radiance definition. */
static void radiance_values(void **state)
{
    amb_image *image;
    amb_error error;
    bool is_linear = false;
    (void)state;
    must(amb_read_image("tests/data/fuzz_image/flat.hdr", &image, &is_linear, &error), &error);
    assert_true(is_linear);
    assert_true(image->width == 3 && image->height == 2 && image->channels == 3);
    for (int i = 0; i < 6; i++) {
        const int mantissa[3] = {40 * i, 100, 200};
        for (int c = 0; c < 3; c++)
            assert_true((double)amb_image_row(image, c, i / 3)[i % 3] == ldexp(mantissa[c], 128 + i - 136));
    }
    amb_image_close(&image);
    must(amb_read_image("tests/data/fuzz_image/runs.hdr", &image, NULL, &error), &error);
    for (int x = 0; x < 9; x++) /* a run of five, then four literals; the shared exponent plane likewise */
        for (int y = 0; y < 2; y++) {
            int red = x < 5 ? 90 : 100 + x - 5 + y, exponent = x < 5 ? 120 : 100 + x - 5 + y;
            assert_true((double)amb_image_row(image, 0, y)[x] == ldexp(red, exponent - 136));
        }
    amb_image_close(&image);
}

static void textures_keep_what_files_hold(void **state)
{
    static const struct {
        const char *path;
        bool srgb;
        amb_texture_kind kind;
        amb_texel texel;
        int width, levels;
    } files[] = {{"tests/data/fuzz_image/rgb3.png", true, AMB_TEXTURE_2D, AMB_TEXEL_SRGB8_A8, 7, 3},
                 {"tests/data/fuzz_image/rgb3.png", false, AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 7, 3},
                 {"tests/data/fuzz_image/rgb1.png", false, AMB_TEXTURE_2D, AMB_TEXEL_R8, 7, 3},
                 {"tests/data/fuzz_image/rgb1.png", true, AMB_TEXTURE_2D, AMB_TEXEL_SRGB8_A8, 7, 3},
                 {"tests/data/fuzz_image/deep.png", false, AMB_TEXTURE_2D, AMB_TEXEL_RGBA32F, 7, 3},
                 {"tests/data/fuzz_image/runs.hdr", false, AMB_TEXTURE_2D, AMB_TEXEL_RGBA16F, 9, 4},
                 {"tests/data/fuzz_exr/zip_float.exr", false, AMB_TEXTURE_2D, AMB_TEXEL_RGBA16F, 5, 5},
                 {"tests/data/fuzz_ktx/flat.ktx", false, AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 4, 3},
                 {"tests/data/fuzz_ktx/cube.ktx", false, AMB_TEXTURE_CUBE, AMB_TEXEL_R11G11B10F, 4, 3}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        amb_texture *texture;
        amb_error error;
        must(amb_read_texture(files[i].path, files[i].srgb, &texture, &error), &error);
        amb_texture_info info = amb_texture_describe(texture);
        if (info.kind != files[i].kind || info.texel != files[i].texel || info.width != files[i].width ||
            info.levels != files[i].levels)
            fail_msg("%s: kind %d texel %d width %d levels %d", files[i].path, info.kind, info.texel, info.width,
                     info.levels);
        amb_texture_close(&texture);
    }
}

static void wrong_kinds_are_named(void **state)
{
    amb_frame *frame;
    amb_image *image;
    amb_texture *texture;
    amb_error error;
    (void)state;
    must_fail(amb_read_exr("tests/data/fuzz_image/rgb3.png", &frame, &error), AMB_ERROR_FORMAT, &error, "rgb3.png");
    must_fail(amb_read_image("Makefile", &image, NULL, &error), AMB_ERROR_FORMAT, &error, "Makefile");
    must_fail(amb_read_texture("Makefile", true, &texture, &error), AMB_ERROR_FORMAT, &error, "Makefile");
    must_fail(amb_read_image("tests/no-such.png", &image, NULL, &error), AMB_ERROR_IO, &error, "No such file");
    must_fail(amb_read_exr("tests", &frame, &error), AMB_ERROR_IO, &error, "folder");
    must_fail(amb_read_exr("", &frame, &error), AMB_ERROR_ARGUMENT, &error, "empty");
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    static const char *const names[] = {"trip.exr", "half.exr", "one.exr", "two.exr", "trip.png", "bad.png"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        unlink(in_folder(names[i]));
    return rmdir(folder); /* fails, and says so, when a writer left a temporary file */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_round_trips_every_float),
        cmocka_unit_test(exr_halves_round_to_nearest_even),
        cmocka_unit_test(exr_keeps_metadata_and_equal_frames_are_equal_files),
        cmocka_unit_test(exr_of_other_programs),
        cmocka_unit_test(exr_with_a_huge_header_takes_no_memory),
        cmocka_unit_test(pictures_with_huge_headers),
        cmocka_unit_test(png_round_trips),
        cmocka_unit_test(png_quantises_to_nearest_and_contains_bad_values),
        cmocka_unit_test(images_of_other_programs),
        cmocka_unit_test(radiance_values),
        cmocka_unit_test(textures_keep_what_files_hold),
        cmocka_unit_test(wrong_kinds_are_named),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
