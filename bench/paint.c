#include "bench/paint.h"

#include <ambiance/half.h>
#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <stdlib.h>

static int faces_of(const paint_chain *c) { return c->kind == AMB_TEXTURE_CUBE ? 6 : 1; }

static size_t chain_bytes(const paint_chain *c)
{
    size_t bytes = 0;
    for (int size = c->size; size > 0; size /= 2)
        bytes += (size_t)size * (size_t)size * c->texel_bytes * (size_t)faces_of(c);
    return bytes;
}

static amb_status chain_create(paint_chain *c, int size, amb_texture_kind kind, amb_texel texel, size_t texel_bytes,
                               amb_error *error)
{
    *c = (paint_chain){.size = size, .kind = kind, .texel = texel, .texel_bytes = texel_bytes};
    c->data = malloc(chain_bytes(c));
    return c->data ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "no memory to paint a texture of %d²", size);
}

void paint_close(paint_chain *c)
{
    free(c->data);
    c->data = NULL;
}

amb_status paint_texture(const paint_chain *c, amb_texture **out, amb_error *error)
{
    int levels = 0;
    for (int size = c->size; size > 0; size /= 2)
        levels++;
    amb_texture_desc desc = {.kind = c->kind,
                             .texel = c->texel,
                             .width = c->size,
                             .height = c->size,
                             .levels = levels,
                             .data = c->data,
                             .data_bytes = chain_bytes(c)};
    return amb_texture_create(&desc, out, error);
}

/* Box-filters RGBA8 level by level behind the first. */
static void shrink(uint8_t *chain, int size)
{
    for (; size > 1; size /= 2) {
        uint8_t *next = chain + (size_t)size * (size_t)size * 4;
        for (int y = 0; y < size / 2; y++)
            for (int x = 0; x < size / 2; x++)
                for (int c = 0; c < 4; c++) {
                    const uint8_t *a = chain + ((size_t)(2 * y) * (size_t)size + (size_t)(2 * x)) * 4 + c,
                                  *b = a + (size_t)size * 4;
                    next[((size_t)y * (size_t)(size / 2) + (size_t)x) * 4 + (size_t)c] =
                        (uint8_t)((a[0] + a[4] + b[0] + b[4] + 2) / 4);
                }
        chain = next;
    }
}

static uint8_t unorm8(float a) { return (uint8_t)(f_saturate(a) * 255.0f + 0.5f); }

amb_status paint_surface(int size, paint_chain *color, paint_chain *normal, amb_error *error)
{
    amb_status status = chain_create(color, size, AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 4, error);
    if (!status)
        status = chain_create(normal, size, AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 4, error);
    if (status)
        return status;
    uint8_t *c = color->data, *m = normal->data;
    for (int y = 0; y < size; y++)
        for (int x = 0; x < size; x++, c += 4, m += 4) {
            v2x p = {(float)x * (24.0f / (float)size), (float)y * (24.0f / (float)size)};
            noise2x n = fbm2(noise_value2, p, (amb_lattice){.seed = 5}, (amb_fbm){4, 2.0f, 0.5f});
            float t = 0.5f + 0.3f * n.value;
            c[0] = unorm8(0.25f + 0.6f * t), c[1] = unorm8(0.15f + 0.5f * t * t), c[2] = unorm8(0.1f + 0.3f * t * t);
            c[3] = unorm8(1.6f * t - 0.3f);
            v3 up = v3_normalize((v3){-0.12f * n.slope.x, -0.12f * n.slope.y, 1.0f});
            m[0] = unorm8(up.x * 0.5f + 0.5f), m[1] = unorm8(up.y * 0.5f + 0.5f), m[2] = unorm8(up.z * 0.5f + 0.5f);
            m[3] = 255;
        }
    shrink(color->data, size);
    shrink(normal->data, size);
    return AMB_OK;
}

/* The direction of face (x, y), both -1…1 from left to right and top to bottom. */
static v3 cube_direction(int face, float x, float y)
{
    const v3 d[6] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
    return v3_normalize(d[face]);
}

amb_status paint_sky(int size, paint_chain *sky, amb_error *error)
{
    amb_status status = chain_create(sky, size, AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA16F, 8, error);
    if (status)
        return status;
    uint16_t *texel = sky->data;
    for (; size > 0; size /= 2)
        for (int i = 0; i < 6 * size * size; i++, texel += 4) {
            int face = i / (size * size), y = i / size % size, x = i % size;
            v3 d = cube_direction(face, ((float)x + 0.5f) * 2.0f / (float)size - 1.0f,
                                  ((float)y + 0.5f) * 2.0f / (float)size - 1.0f);
            float up = 0.5f + 0.5f * d.y, window = amb_pow(f_max(0.6f * d.x + 0.8f * d.y, 0.0f), 40.0f) * 6.0f;
            float cloud =
                0.3f * noise_value3((v3x){d.x * 4.0f, d.y * 4.0f, d.z * 4.0f}, (amb_lattice){.seed = 2}).value;
            float rgba[4] = {0.3f + 0.3f * up + window + cloud, 0.35f + 0.4f * up + window + cloud,
                             0.4f + 0.7f * up + window + cloud, 1.0f};
            for (int c = 0; c < 4; c++)
                texel[c] = (uint16_t)f_to_half(rgba[c]);
        }
    return AMB_OK;
}
