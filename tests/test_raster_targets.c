/* Textures as targets: what each format stores, faces, layers, slices and levels, kept contents, resolved samples. */
#include "core/texture_layout.h"
#include "raster/internal.h"
#include "tests/format_truth.h"
#include "tests/raster_shaders.h"
#include "tests/texture_reference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t random_state = 5;

static uint32_t next_random(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((random_state ^ random_state >> 29) >> 16);
}
static double uniform(double lo, double hi) { return lo + (hi - lo) * (next_random() / 4294967296.0); }

static float float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static amb_context *context_of(amb_isa isa, int threads)
{
    amb_context_options options = {isa, threads};
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    return context;
}

static amb_texture *empty_texture(amb_texture_kind kind, amb_texel texel, int width, int height, int depth, bool mips)
{
    amb_texture *texture = NULL;
    amb_texture_desc desc = {
        .kind = kind, .texel = texel, .width = width, .height = height, .depth = depth, .make_mips = mips};
    assert_int_equal(amb_texture_create(&desc, &texture, NULL), AMB_OK);
    return texture;
}

static amb_image *slice_of(const amb_texture *texture, int level, int slice)
{
    amb_image *image = NULL;
    assert_int_equal(amb_texture_to_image(texture, level, slice, &image, NULL), AMB_OK);
    return image;
}

static float pixel(const amb_image *image, int channel, int x, int y) { return amb_image_row(image, channel, y)[x]; }
static bool same(float a, float b) { return a == b || (isnan(a) && isnan(b)); }

/* One full-screen draw of a table of four floats a pixel. */
static void draw_table(const amb_context *context, const amb_target *target, const float *table, int width,
                       amb_blend blend, int tile)
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    raster_test_uniforms u = {.table = table, .table_width = width};
    amb_draw d = {.lanes = shaders->lanes, .fragment = shaders->table, .uniforms = &u, .uniforms_size = sizeof u};
    for (int i = 0; i < AMB_MAX_TARGETS; i++)
        d.blend[i] = blend;
    d.depth_compare = AMB_ALWAYS;
    amb_pass *pass = NULL;
    amb_error error;
    if (raster_pass_begin(context, target, tile, RASTER_BATCH_BYTES, &pass, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
}

static float *random_table(int pixels, double lo, double hi)
{
    float *table = malloc((size_t)pixels * 4 * sizeof *table);
    for (int i = 0; i < pixels * 4; i++)
        table[i] = (float)uniform(lo, hi);
    return table;
}

/* ---- formats ------------------------------------------------------------------------------------------------------
 */

enum { WIDE_TABLE = 512, HIGH_TABLE = 256, TABLE = WIDE_TABLE * HIGH_TABLE };

static const float special[] = {
    NAN,       -NAN,     INFINITY,   -INFINITY, 0.0f,     -0.0f,       1e-45f,     -1e-45f,   1e-40f,     0x1p-24f,
    0x1p-25f,  0x3p-26f, 0x1p-14f,   0x1p-15f,  6.0e-5f,  65504.0f,    65519.996f, 65520.0f,  65536.0f,   3.4e38f,
    -65520.0f, -1.0f,    0.5f,       1.0f,      2.0f,     0.99999994f, 65024.0f,   64512.0f,  65023.996f, 0x1p-20f,
    0x1p-21f,  0x1p-19f, 0.0031308f, 0.04045f,  64000.0f, 1.0e5f,      0x1p-126f,  -0x1p-24f, 0x1.8p-24f};

/* Values where rounding is decided: the middle between neighbours of the format, and the floats beside it. */
static float decisive(amb_texel texel, int channel)
{
    double a, b;
    if (format_is_unorm(texel)) {
        double code = (next_random() % 255 + 0.5) / 255.0;
        a = b = texel == AMB_TEXEL_SRGB8_A8 && channel < 3
                    ? (code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4))
                    : code;
    } else {
        int mantissa = texel != AMB_TEXEL_R11G11B10F ? 10 : channel < 2 ? 6 : 5;
        unsigned code = next_random() % ((31u << mantissa) - 1);
        a = ref_small(code, mantissa), b = ref_small(code + 1, mantissa);
    }
    float middle = (float)((a + b) / 2);
    int beside = (int)(next_random() % 3) - 1;
    return beside < 0 ? nextafterf(middle, -1.0f) : beside > 0 ? nextafterf(middle, INFINITY) : middle;
}

static void fill_hostile(amb_texel texel, float *table)
{
    for (int i = 0; i < TABLE * 4; i++) {
        switch (i / 4 % 4) {
        case 0:
            table[i] = special[next_random() % (sizeof special / sizeof *special)];
            break;
        case 1:
            table[i] = float_of(next_random()); /* every exponent, NaNs too */
            break;
        case 2:
            table[i] = decisive(texel, i % 4) * (next_random() % 8 ? 1.0f : -1.0f);
            break;
        default:
            table[i] = (float)uniform(-0.2, 1.2);
        }
    }
}

static const amb_texel formats[] = {AMB_TEXEL_R8,   AMB_TEXEL_RG8,   AMB_TEXEL_RGBA8,   AMB_TEXEL_SRGB8_A8,
                                    AMB_TEXEL_R16F, AMB_TEXEL_RG16F, AMB_TEXEL_RGBA16F, AMB_TEXEL_R11G11B10F,
                                    AMB_TEXEL_R32F, AMB_TEXEL_RG32F, AMB_TEXEL_RGBA32F};
enum { FORMATS = sizeof formats / sizeof *formats };

/* The stored code against exact arithmetic: only within 2⁻¹⁶ of where two codes meet may rounding of the product
 * decide. */
static void check_code(amb_texel texel, int channel, float value, float stored)
{
    double distance, code = (double)stored;
    int exact = format_exact_code(texel, channel, (double)value, &distance);
    if (texel == AMB_TEXEL_SRGB8_A8 && channel < 3)
        code = code <= 0.0031308 ? 12.92 * code : 1.055 * pow(code, 1 / 2.4) - 0.055;
    double off = fabs(code * 255.0 - exact);
    if (off > 1e-4 && !(distance < 0x1p-16 && off < 1.0001))
        fail_msg("format %d channel %d: %.9g is stored as code %g, exactly %d", (int)texel, channel, (double)value,
                 code * 255.0, exact);
}

static void every_format_stores_what_its_definition_says(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    float *table = malloc(TABLE * 4 * sizeof *table);
    for (int f = 0; f < FORMATS; f++) {
        fill_hostile(formats[f], table);
        for (int i = 0; i < 3; i++) {
            if (!amb_isa_available(isas[i]))
                continue;
            amb_context *context = context_of(isas[i], 1);
            amb_texture *texture = empty_texture(AMB_TEXTURE_2D, formats[f], WIDE_TABLE, HIGH_TABLE, 0, false);
            draw_table(context, &(amb_target){.color_texture = {{texture, 0, 0}}}, table, WIDE_TABLE, AMB_BLEND_OFF,
                       64);
            amb_image *image = slice_of(texture, 0, 0);
            assert_int_equal(image->channels, format_channels(formats[f]));
            for (int n = 0; n < TABLE; n++)
                for (int c = 0; c < image->channels; c++) {
                    float got = pixel(image, c, n % WIDE_TABLE, n / WIDE_TABLE), value = table[4 * n + c];
                    if (format_is_unorm(formats[f]))
                        check_code(formats[f], c, value, got);
                    if (!same(got, format_truth(formats[f], c, value)))
                        fail_msg("%s, format %d channel %d: %.9g is stored as %.9g, truth %.9g", amb_isa_name(isas[i]),
                                 (int)formats[f], c, (double)value, (double)got,
                                 (double)format_truth(formats[f], c, value));
                }
            amb_image_close(&image);
            amb_texture_close(&texture);
            amb_context_close(&context);
        }
    }
    free(table);
}

/* The published layout: red in bits 0-10, green in 11-21, blue in 22-31 (OpenGL 4.6 §3.7.?, DXGI). A texture given as
 * packed words, kept by a pass that writes half of it, comes back unchanged where nothing was written. */
static void kept_texels_come_back(void **state)
{
    (void)state;
    enum { SIDE = 37 };
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    for (int f = 0; f < FORMATS; f++) {
        size_t bytes = (size_t)ref_texel_bytes(formats[f]);
        unsigned char *data = malloc(SIDE * SIDE * bytes);
        for (size_t i = 0; i < SIDE * SIDE * bytes; i++)
            data[i] = (unsigned char)next_random();
        amb_texture_desc desc = {
            .texel = formats[f], .width = SIDE, .height = SIDE, .data = data, .data_bytes = SIDE * SIDE * bytes};
        amb_texture *texture = NULL;
        assert_int_equal(amb_texture_create(&desc, &texture, NULL), AMB_OK);
        const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
        float *table = random_table(SIDE * SIDE, 0, 1);
        raster_test_uniforms u = {.table = table, .table_width = SIDE};
        amb_draw d = {.lanes = shaders->lanes, .fragment = shaders->table, .uniforms = &u, .uniforms_size = sizeof u};
        d.scissor = (amb_rect){3, 5, 20, 1000};
        amb_pass *pass = NULL;
        amb_target target = {.color_texture = {{texture, 0, 0}}, .keep = true};
        assert_int_equal(raster_pass_begin(context, &target, 16, 0, &pass, NULL), AMB_OK);
        assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
        assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        amb_image *image = slice_of(texture, 0, 0);
        for (int n = 0; n < SIDE * SIDE; n++) {
            int x = n % SIDE, y = n / SIDE;
            bool written = x >= 3 && x < 23 && y >= 5;
            ref_color old = ref_decode(formats[f], data + (size_t)n * bytes);
            for (int c = 0; c < image->channels; c++) {
                float want = written ? format_truth(formats[f], c, table[4 * n + c]) : (float)old.c[c],
                      got = pixel(image, c, x, y);
                assert_true(same(got, want));
            }
        }
        amb_image_close(&image);
        amb_texture_close(&texture);
        free(table);
        free(data);
    }
    amb_context_close(&context);
}

/* ---- blending ------------------------------------------------------------------------------------------------------
 */

/* Layer upon layer of every plain mode: each step reads what the format kept of the one before. */
static void blending_reads_the_stored_value(void **state)
{
    (void)state;
    enum { SIDE = 32, LAYERS = 24 };
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    for (int f = 0; f < FORMATS; f++) {
        amb_texture *texture = empty_texture(AMB_TEXTURE_2D, formats[f], SIDE, SIDE, 0, false);
        int channels = format_channels(formats[f]);
        float truth[SIDE * SIDE][4];
        for (int n = 0; n < SIDE * SIDE; n++)
            for (int c = 0; c < 4; c++)
                truth[n][c] = format_truth(formats[f], c, 0.3f);
        for (int layer = 0; layer < LAYERS; layer++) {
            float *table = random_table(SIDE * SIDE, -0.25, 1.25);
            amb_blend mode = (amb_blend)(layer % 4);
            amb_target target = {.color_texture = {{texture, 0, 0}}, .clear_color = {{0.3f, 0.3f, 0.3f, 0.3f}}};
            target.keep = layer > 0;
            draw_table(context, &target, table, SIDE, mode, 16);
            for (int n = 0; n < SIDE * SIDE; n++) {
                float s[4];
                for (int c = 0; c < 4; c++)
                    s[c] = format_is_unorm(formats[f]) ? fminf(fmaxf(table[4 * n + c], 0.0f), 1.0f) : table[4 * n + c];
                for (int c = 0; c < channels; c++) {
                    float d = truth[n][c], rest = 1.0f - s[3], value = s[c];
                    if (mode == AMB_BLEND_ALPHA)
                        value = (c == 3 ? s[3] : s[c] * s[3]) + d * rest;
                    if (mode == AMB_BLEND_ADD)
                        value = s[c] + d;
                    if (mode == AMB_BLEND_MULTIPLY)
                        value = s[c] * d;
                    truth[n][c] = format_truth(formats[f], c, value);
                }
            }
            free(table);
            amb_image *image = slice_of(texture, 0, 0);
            for (int n = 0; n < SIDE * SIDE; n++)
                for (int c = 0; c < channels; c++)
                    if (!same(truth[n][c], pixel(image, c, n % SIDE, n / SIDE)))
                        fail_msg("format %d layer %d channel %d: %.9g, truth %.9g", (int)formats[f], layer, c,
                                 (double)pixel(image, c, n % SIDE, n / SIDE), (double)truth[n][c]);
            amb_image_close(&image);
        }
        amb_texture_close(&texture);
    }
    amb_context_close(&context);
}

/* ---- faces, layers, slices, levels --------------------------------------------------------------------------------
 */

/* Draws into every slice of every level, each its own picture, in a shuffled order; all must then be there. */
static void every_slice_is_a_target(void **state)
{
    (void)state;
    static const struct {
        amb_texture_kind kind;
        int width, height, depth;
    } shape[] = {{AMB_TEXTURE_2D, 37, 20, 0},
                 {AMB_TEXTURE_CUBE, 24, 24, 0},
                 {AMB_TEXTURE_3D, 20, 12, 7},
                 {AMB_TEXTURE_2D_ARRAY, 33, 18, 5}};
    amb_context *context = context_of(AMB_ISA_AUTO, 3);
    for (int s = 0; s < 4; s++) {
        amb_texture *texture =
            empty_texture(shape[s].kind, AMB_TEXEL_RGBA16F, shape[s].width, shape[s].height, shape[s].depth, true);
        int levels = amb_texture_describe(texture).levels, count = 0, order[64][2];
        for (int level = 0; level < levels; level++)
            for (int slice = 0; slice < level_slices(&texture->info, level); slice++, count++)
                order[count][0] = level, order[count][1] = slice;
        for (int i = count - 1; i > 0; i--) {
            int k = (int)(next_random() % (uint32_t)(i + 1)), swap[2] = {order[i][0], order[i][1]};
            memcpy(order[i], order[k], sizeof swap);
            memcpy(order[k], swap, sizeof swap);
        }
        float *table[64];
        for (int i = 0; i < count; i++) {
            int width = level_size(shape[s].width, order[i][0]), height = level_size(shape[s].height, order[i][0]);
            table[i] = random_table(width * height, -4, 4);
            draw_table(context, &(amb_target){.color_texture = {{texture, order[i][0], order[i][1]}}}, table[i], width,
                       AMB_BLEND_OFF, 16);
        }
        for (int i = 0; i < count; i++) {
            amb_image *image = slice_of(texture, order[i][0], order[i][1]);
            for (int n = 0; n < image->width * image->height; n++)
                for (int c = 0; c < 4; c++)
                    assert_true(pixel(image, c, n % image->width, n / image->width) ==
                                format_truth(AMB_TEXEL_RGBA16F, c, table[i][4 * n + c]));
            amb_image_close(&image);
            free(table[i]);
        }
        amb_texture_close(&texture);
    }
    amb_context_close(&context);
}

/* Every level, with its borders. */
static void assert_same_texels(const amb_texture *a, const amb_texture *b)
{
    assert_int_equal(a->info.levels, b->info.levels);
    for (int l = 0; l < a->info.levels; l++) {
        int width = level_size(a->info.width, l) + 1, height = level_size(a->info.height, l) + 1;
        size_t bytes = (size_t)(1 + width) * (size_t)storage_words(a->storage) * sizeof(uint32_t);
        for (int z = 0; z < level_slices(&a->info, l); z++)
            for (int y = -1; y < height; y++)
                assert_memory_equal(texel_at(a, l, -1, y, z), texel_at(b, l, -1, y, z), bytes);
    }
}

/* A texture that was rendered into equals, words and borders, one made of the same pixels. */
static void borders_and_mips_follow(void **state)
{
    (void)state;
    static const amb_texel texels[] = {AMB_TEXEL_RGBA8, AMB_TEXEL_SRGB8_A8, AMB_TEXEL_R32F, AMB_TEXEL_R11G11B10F,
                                       AMB_TEXEL_RGBA32F};
    enum { SIDE = 21 };
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    for (int i = 0; i < 10; i++) {
        bool cube = i % 2;
        amb_texture *drawn =
            empty_texture(cube ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D, texels[i / 2], SIDE, SIDE, 0, true);
        amb_texture *made = NULL;
        amb_image *face[6] = {NULL};
        for (int k = 0; k < (cube ? 6 : 1); k++) {
            float *table = random_table(SIDE * SIDE, 0, 1);
            draw_table(context, &(amb_target){.color_texture = {{drawn, 0, k}}}, table, SIDE, AMB_BLEND_OFF, 64);
            free(table);
            face[k] = slice_of(drawn, 0, k);
        }
        assert_int_equal(amb_texture_make_mips(drawn, NULL), AMB_OK);
        if (cube)
            assert_int_equal(amb_texture_cube_from_images(face, texels[i / 2], true, &made, NULL), AMB_OK);
        else
            assert_int_equal(amb_texture_from_image(face[0], texels[i / 2], true, &made, NULL), AMB_OK);
        assert_same_texels(drawn, made);
        for (int k = 0; k < 6; k++)
            amb_image_close(&face[k]);
        amb_texture_close(&drawn);
        amb_texture_close(&made);
    }
    amb_context_close(&context);
}

/* ---- samples, depth, many targets ---------------------------------------------------------------------------------
 */

/* Samples are averaged linearly and the average is stored: each sample covered by its own triangle. */
static void resolve_rounds_the_average(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    for (int f = 0; f < FORMATS; f++)
        for (int samples = 2; samples <= 8; samples *= 2) {
            amb_texture *texture = empty_texture(AMB_TEXTURE_2D, formats[f], 1, 1, 0, false);
            /* Alpha to coverage writes the first ⌊n·a + ½⌋ samples: one after the other from the last on. */
            raster_test_vertex vertex[8 * 3];
            float stored[8][4], mean[4] = {0};
            for (int i = 0; i < samples; i++) {
                v4 value = {(float)uniform(0, 1), (float)uniform(0, 1), (float)uniform(0, 1),
                            (float)(samples - i) / (float)samples};
                const float corner[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
                for (int k = 0; k < 3; k++)
                    vertex[3 * i + k] = (raster_test_vertex){{corner[k][0], corner[k][1], 0.5f, 1}, value};
                for (int c = 0; c < 4; c++)
                    stored[samples - 1 - i][c] = format_truth(formats[f], c, (&value.x)[c]);
            }
            for (int c = 0; c < 4; c++) {
                float v[8];
                for (int i = 0; i < samples; i++)
                    v[i] = stored[i][c];
                for (int n = samples; n > 1; n /= 2)
                    for (int i = 0; i < n / 2; i++)
                        v[i] = v[2 * i] + v[2 * i + 1];
                mean[c] = format_truth(formats[f], c, v[0] / (float)samples);
            }
            raster_test_uniforms u = {.vertex = vertex};
            amb_draw d = {.lanes = shaders->lanes, .vertex = shaders->vertex, .fragment = shaders->value};
            d.uniforms = &u, d.uniforms_size = sizeof u, d.varying_floats = 4, d.count = (uint32_t)samples * 3;
            d.alpha_to_coverage = true;
            amb_target target = {.color_texture = {{texture, 0, 0}}, .samples = samples};
            amb_pass *pass = NULL;
            assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
            assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
            assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
            amb_image *image = slice_of(texture, 0, 0);
            for (int c = 0; c < image->channels; c++)
                assert_true(pixel(image, c, 0, 0) == mean[c]);
            amb_image_close(&image);
            amb_texture_close(&texture);
        }
    amb_context_close(&context);
}

/* A depth texture holds the floats that a depth image holds, and can be compared against. */
static void depth_textures_equal_depth_images(void **state)
{
    (void)state;
    enum { SIDE = 67 };
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    raster_test_vertex vertex[300];
    for (int i = 0; i < 300; i++)
        vertex[i].clip = (v4){(float)uniform(-1.2, 1.2), (float)uniform(-1.2, 1.2), (float)uniform(0, 1), 1};
    raster_test_uniforms u = {.vertex = vertex};
    amb_draw d = {.lanes = shaders->lanes, .vertex = shaders->vertex, .uniforms = &u, .uniforms_size = sizeof u};
    d.varying_floats = 4, d.count = 300;
    amb_texture *map = empty_texture(AMB_TEXTURE_2D_ARRAY, AMB_TEXEL_R32F, SIDE, SIDE, 3, false);
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(SIDE, SIDE, 1, &image, NULL), AMB_OK);
    for (int textured = 0; textured < 2; textured++) {
        amb_target target = {.clear_depth = 1.0f};
        if (textured)
            target.depth_texture = (amb_texture_slice){map, 0, 2};
        else
            target.depth = image;
        for (int half = 0; half < 2; half++) { /* two passes, so that depth is kept too */
            amb_pass *pass = NULL;
            target.keep = half == 1;
            d.count = 150, u.vertex = vertex + 150 * half;
            assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
            assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
            assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        }
    }
    amb_image *layer = slice_of(map, 0, 2), *untouched = slice_of(map, 0, 1);
    int covered = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            assert_true(pixel(layer, 0, x, y) == pixel(image, 0, x, y));
            assert_true(pixel(untouched, 0, x, y) == 0.0f);
            covered += pixel(layer, 0, x, y) < 1.0f;
        }
    assert_true(covered > SIDE * SIDE / 2);
    amb_image_close(&layer);
    amb_image_close(&untouched);
    amb_image_close(&image);
    amb_texture_close(&map);
    amb_context_close(&context);
}

/* Sixteen attachments of all formats at once, images among them, each with its own mode and mask. */
static void many_formats_in_one_pass(void **state)
{
    (void)state;
    enum { SIDE = 45 };
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_target target = {0};
    amb_texel texel[AMB_MAX_TARGETS];
    for (int i = 0; i < AMB_MAX_TARGETS; i++) {
        texel[i] = i < FORMATS ? formats[i] : AMB_TEXEL_RGBA32F;
        target.clear_color[i] = (v4){0.25f, 0.5f, 0.75f, 1.0f};
        if (i < FORMATS)
            target.color_texture[i].texture = empty_texture(AMB_TEXTURE_2D, texel[i], SIDE, SIDE, 0, false);
        else
            assert_int_equal(amb_image_create(SIDE, SIDE, 4, &target.color[i], NULL), AMB_OK);
    }
    float *table = random_table(SIDE * SIDE, 0, 1);
    raster_test_uniforms u = {.table = table, .table_width = SIDE};
    amb_draw d = {.lanes = shaders->lanes, .fragment = shaders->table, .uniforms = &u, .uniforms_size = sizeof u};
    for (int i = 0; i < AMB_MAX_TARGETS; i++) {
        d.blend[i] = i % 3 == 1 ? AMB_BLEND_ADD : AMB_BLEND_OFF;
        d.channels_off[i] = i % 4 == 2 ? 2 : 0; /* green */
    }
    d.targets_off = 1u << 5;
    amb_pass *pass = NULL;
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
    for (int i = 0; i < AMB_MAX_TARGETS; i++) {
        amb_image *image = i < FORMATS ? slice_of(target.color_texture[i].texture, 0, 0) : target.color[i];
        for (int n = 0; n < SIDE * SIDE; n++)
            for (int c = 0; c < image->channels; c++) {
                float clear = format_truth(texel[i], c, (&target.clear_color[i].x)[c]), value = table[4 * n + c];
                float want = format_truth(texel[i], c, d.blend[i] == AMB_BLEND_ADD ? value + clear : value);
                if (i == 5 || (d.channels_off[i] >> c & 1))
                    want = clear;
                assert_true(pixel(image, c, n % SIDE, n / SIDE) == want);
            }
        if (i < FORMATS)
            amb_image_close(&image);
        amb_image_close(&target.color[i]);
        amb_texture_close(&target.color_texture[i].texture);
    }
    free(table);
    amb_context_close(&context);
}

/* ---- errors -------------------------------------------------------------------------------------------------------
 */

static void refuse(const amb_context *context, amb_target target, const char *words)
{
    amb_error error = {0};
    amb_pass *pass = NULL;
    assert_int_equal(amb_pass_begin(context, &target, &pass, &error), AMB_ERROR_ARGUMENT);
    assert_null(pass);
    if (!strstr(error.detail, words))
        fail_msg("'%s' does not contain '%s'", error.detail, words);
}

static void bad_slices_are_refused(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    amb_texture *cube = empty_texture(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA8, 8, 8, 0, true);
    amb_texture *depth = empty_texture(AMB_TEXTURE_2D, AMB_TEXEL_R32F, 8, 8, 0, false);
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(8, 8, 4, &image, NULL), AMB_OK);
    refuse(context, (amb_target){.color_texture = {{cube, 4, 0}}}, "level is 4; it has 0 to 3");
    refuse(context, (amb_target){.color_texture = {{cube, -1, 0}}}, "level is -1");
    refuse(context, (amb_target){.color_texture = {{cube, 1, 6}}}, "slice is 6; its level 1 has 0 to 5");
    refuse(context, (amb_target){.color_texture = {{depth, 0, 1}}}, "slice is 1; its level 0 has 0 to 0");
    refuse(context, (amb_target){.color = {image}, .color_texture = {{cube, 0, 0}}}, "both an image and a texture");
    refuse(context, (amb_target){.depth = image, .depth_texture = {depth, 0, 0}}, "both an image and a texture");
    refuse(context, (amb_target){.color_texture = {{cube, 0, 0}, {cube, 0, 0}}},
           "colour texture 0 is also colour texture 1");
    refuse(context, (amb_target){.color_texture = {{depth, 0, 0}}, .depth_texture = {depth, 0, 0}},
           "also depth texture");
    refuse(context, (amb_target){.color_texture = {{cube, 0, 0}, {cube, 1, 0}}}, "4×4, the first attachment is 8×8");
    refuse(context, (amb_target){.depth_texture = {cube, 0, 0}}, "must be R32F");
    amb_error error;
    amb_image *out = NULL;
    assert_int_equal(amb_texture_to_image(cube, 4, 0, &out, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_texture_to_image(cube, 0, 6, &out, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: slice is 6; level 0 of this one has 0 to 5");
    assert_int_equal(amb_texture_to_image(NULL, 0, 0, &out, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_texture_make_mips(NULL, &error), AMB_ERROR_ARGUMENT);
    amb_image_close(&image);
    amb_texture_close(&cube);
    amb_texture_close(&depth);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_stores_what_its_definition_says),
        cmocka_unit_test(kept_texels_come_back),
        cmocka_unit_test(blending_reads_the_stored_value),
        cmocka_unit_test(every_slice_is_a_target),
        cmocka_unit_test(borders_and_mips_follow),
        cmocka_unit_test(resolve_rounds_the_average),
        cmocka_unit_test(depth_textures_equal_depth_images),
        cmocka_unit_test(many_formats_in_one_pass),
        cmocka_unit_test(bad_slices_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
