/* A tile's planes to and from a slice of a texture. Part of tile_wide.c. */
#ifndef AMBIANCE_RASTER_TILE_TEXTURE_H
#define AMBIANCE_RASTER_TILE_TEXTURE_H

#include "raster/output.h"

/* Lanes of a block in row order, and back: the same exchange of quads' rows. */
static inline f32x rows_of(f32x a)
{
#if AMB_LANES == 4
    return a;
#elif AMB_LANES == 8
    return __builtin_shufflevector(a, a, 0, 1, 4, 5, 2, 3, 6, 7);
#else
    return __builtin_shufflevector(a, a, 0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15);
#endif
}

/* Copies the texels of a block, in row order and a word a plane, from or to the texture. */
static inline void move_words(const raster_attachment *a, int x, int y, int columns, int rows,
                              uint32_t plane[4][AMB_LANES], bool to_texture)
{
    const int words = storage_words(a->texture->storage);
    for (int r = 0; r < rows; r++) {
        uint32_t *texel = texel_at(a->texture, a->level, x, y + r, a->slice);
        for (int i = 0; i < columns; i++)
            for (int k = 0; k < words; k++, texel++) {
                if (to_texture)
                    *texel = plane[k][r * AMB_BLOCK_W + i];
                else
                    plane[k][r * AMB_BLOCK_W + i] = *texel;
            }
    }
}

static inline void store_texture_block(const raster_attachment *a, const float *lanes, int x, int y, int columns,
                                       int rows)
{
    f32x value[4] = {f_set(0.0f), f_set(0.0f), f_set(0.0f), f_set(1.0f)};
    uint32_t plane[4][AMB_LANES];
    u32x word[4];
    for (int c = 0; c < a->channels; c++)
        value[c] = rows_of(f_load(lanes + (size_t)c * AMB_LANES));
    encode_texel(a->texture->storage, value, word);
    for (int k = 0; k < storage_words(a->texture->storage); k++)
        memcpy(plane[k], &word[k], sizeof word[k]);
    move_words(a, x, y, columns, rows, plane, true);
}

static inline void load_texture_block(const raster_attachment *a, const raster_srgb *srgb, float *lanes, int x, int y,
                                      int columns, int rows)
{
    f32x value[4];
    uint32_t plane[4][AMB_LANES] = {{0}};
    u32x word[4];
    move_words(a, x, y, columns, rows, plane, false);
    memcpy(word, plane, sizeof word);
    decode_texel(a->texture->storage, a->format, srgb, word, value);
    for (int c = 0; c < a->channels; c++)
        f_store(lanes + (size_t)c * AMB_LANES, rows_of(value[c]));
}

static void transfer_texture(const raster_tile *tile, const raster_attachment *a, bool to_texture)
{
    for (int y = 0; y < tile->bottom; y += AMB_BLOCK_H)
        for (int x = 0; x < tile->right; x += AMB_BLOCK_W) {
            float *lanes = block_at(tile, x / AMB_BLOCK_W, y / AMB_BLOCK_H) + (size_t)a->first * AMB_LANES;
            int columns = tile->right - x < AMB_BLOCK_W ? tile->right - x : AMB_BLOCK_W;
            int rows = tile->bottom - y < AMB_BLOCK_H ? tile->bottom - y : AMB_BLOCK_H;
            if (to_texture)
                store_texture_block(a, lanes, tile->x0 + x, tile->y0 + y, columns, rows);
            else
                load_texture_block(a, tile->pass->srgb, lanes, tile->x0 + x, tile->y0 + y, columns, rows);
        }
}

#endif
