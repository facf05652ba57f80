#include "post_frames.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint32_t post_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    uint32_t h = *state ^ *state >> 15;
    h *= 0x2c1b3c6du;
    return h ^ h >> 13;
}

float post_uniform(uint32_t *state, float lo, float hi)
{
    return lo + (hi - lo) * (float)(post_random(state) >> 8) / 16777216.0f;
}

amb_frame *post_picture(int width, int height, uint32_t seed)
{
    amb_frame *frame;
    amb_error error = {0};
    if (amb_frame_create(width, height, &frame, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    amb_image *color = amb_frame_layer(frame, "color");
    uint32_t state = seed * 7919u + 1u;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 4; c++) {
                float soft = 0.4f + 0.3f * sinf(0.05f * (float)x + (float)c) * cosf(0.07f * (float)y);
                amb_image_row(color, c, y)[x] = soft + post_uniform(&state, 0.0f, 0.1f);
            }
    for (int spot = 0; spot < 8; spot++) {
        int cx = (int)(post_random(&state) % (uint32_t)width), cy = (int)(post_random(&state) % (uint32_t)height);
        int radius = 1 + (int)(post_random(&state) % 12u);
        float rgb[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = post_uniform(&state, 0.0f, spot % 2 ? 20.0f : 1.5f);
        for (int y = cy - radius; y <= cy + radius; y++)
            for (int x = cx - radius; x <= cx + radius; x++)
                if (x >= 0 && y >= 0 && x < width && y < height &&
                    (x - cx) * (x - cx) + (y - cy) * (y - cy) <= radius * radius)
                    for (int c = 0; c < 3; c++)
                        amb_image_row(color, c, y)[x] = rgb[c];
    }
    return frame;
}

amb_frame *post_copy(const amb_frame *frame)
{
    amb_frame *copy;
    amb_error error = {0};
    if (amb_frame_create(frame->width, frame->height, &copy, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    const amb_image *from = amb_frame_layer(frame, "color"), *to = amb_frame_layer(copy, "color");
    memcpy(to->data, from->data, from->stride * (size_t)from->height * (size_t)from->channels * sizeof(float));
    return copy;
}

void post_apply(amb_frame *frame, const char *text, amb_isa isa, int threads, long frame_index, int intermediates)
{
    amb_context_options options = {.isa = isa, .threads = threads};
    amb_context *context = NULL;
    amb_chain *chain = NULL;
    amb_error error = {0};
    if (amb_context_create(&options, &context, &error) != AMB_OK ||
        amb_chain_create(context, text, &chain, &error) != AMB_OK ||
        amb_chain_apply(chain, frame, frame_index, intermediates, &error) != AMB_OK)
        fail_msg("%s: %s", text, error.detail);
    amb_chain_close(&chain);
    amb_context_close(&context);
}

static uint32_t bits_of(float a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

void post_assert_same(const amb_frame *a, const amb_frame *b, const char *what)
{
    assert_int_equal(a->layer_count, b->layer_count);
    for (int l = 0; l < a->layer_count; l++) {
        const amb_image *p = a->layer[l].image, *q = b->layer[l].image;
        assert_int_equal(p->channels, q->channels);
        for (int c = 0; c < p->channels; c++)
            for (int y = 0; y < p->height; y++) {
                const float *s = amb_image_row(p, c, y), *t = amb_image_row(q, c, y);
                for (int x = 0; x < p->width; x++)
                    if (bits_of(s[x]) != bits_of(t[x]) && !(isnan(s[x]) && isnan(t[x])))
                        fail_msg("%s: layer %s channel %d at (%d, %d) of %dx%d: %.9g and %.9g", what, a->layer[l].name,
                                 c, x, y, p->width, p->height, (double)s[x], (double)t[x]);
            }
    }
}
