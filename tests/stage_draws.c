#include "tests/stage_draws.h"

#include "raster/internal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint64_t random_state = 1;

uint32_t random_bits(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = random_state ^ random_state >> 33;
    return (uint32_t)((x * 0xff51afd7ed558ccdu) >> 32);
}
float uniform(float lo, float hi) { return lo + (hi - lo) * (float)(random_bits() >> 8) * 0x1p-24f; }
int pick(int count) { return (int)(random_bits() % (uint32_t)count); }

float random_factor(void)
{
    switch (pick(6)) {
    case 0:
        return 1.0f;
    case 1:
        return (float)(1 + pick(64));
    case 2:
        return (float)(1 + pick(64)) + uniform(-0.01f, 0.01f);
    case 3:
        return uniform(0.01f, 70.0f);
    default:
        return uniform(0.5f, 8.0f);
    }
}

amb_context *make_context(amb_isa isa, int threads)
{
    amb_context *context = NULL;
    const amb_context_options options = {.isa = isa, .threads = threads};
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    return context;
}

amb_image *draw_image(const amb_context *context, const amb_draw *draw, int width, int height, int tile_size,
                      size_t batch_bytes, amb_pass_stats *stats)
{
    amb_image *image = NULL;
    amb_pass *pass = NULL;
    amb_error error = {0};
    assert_int_equal(amb_image_create(width, height, 4, &image, NULL), AMB_OK);
    amb_target target = {.color = {image}};
    assert_int_equal(raster_pass_begin(context, &target, tile_size, batch_bytes, &pass, NULL), AMB_OK);
    if (amb_pass_draw(pass, draw, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    assert_int_equal(amb_pass_finish(&pass, stats, NULL), AMB_OK);
    return image;
}

void assert_same_pixels(const amb_image *a, const amb_image *b)
{
    for (int c = 0; c < a->channels; c++)
        for (int y = 0; y < a->height; y++)
            assert_memory_equal(amb_image_row(a, c, y), amb_image_row(b, c, y), (size_t)a->width * sizeof(float));
}

void refuse(amb_pass *pass, const amb_draw *draw, const char *text)
{
    amb_error error = {0};
    assert_int_equal(amb_pass_draw(pass, draw, &error), AMB_ERROR_ARGUMENT);
    if (!strstr(error.detail, text))
        fail_msg("'%s' does not contain '%s'", error.detail, text);
}
