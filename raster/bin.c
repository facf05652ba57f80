/* Binning: a counting sort of a chunk's triangles into the tiles their boxes touch, in order. A triangle on many tiles
 * goes to the chunk's list of large ones instead, which every tile looks through: so a chunk's bins stay small. */
#include "raster/internal.h"

typedef struct tile_box {
    uint32_t x0, y0, x1, y1;
} tile_box;

static tile_box box_of(const raster_triangles *t, uint32_t i, unsigned shift)
{
    return (tile_box){(t->low[i] & 0xffffu) >> shift, t->low[i] >> 16 >> shift, (t->high[i] & 0xffffu) >> shift,
                      t->high[i] >> 16 >> shift};
}

static bool is_large(tile_box b) { return (b.x1 - b.x0 + 1) * (b.y1 - b.y0 + 1) > RASTER_LARGE_TILES; }

static uint32_t count_entries(const amb_pass *pass, raster_chunk *chunk, unsigned shift)
{
    uint32_t large = 0;
    for (uint32_t i = 0; i < chunk->triangle.count; i++) {
        tile_box b = box_of(&chunk->triangle, i, shift);
        if (is_large(b)) {
            large++;
            continue;
        }
        for (uint32_t y = b.y0; y <= b.y1; y++)
            for (uint32_t x = b.x0; x <= b.x1; x++)
                chunk->tile_start[y * (uint32_t)pass->tiles_x + x]++;
    }
    return large;
}

static void place_entries(const amb_pass *pass, raster_chunk *chunk, unsigned shift)
{
    for (uint32_t i = chunk->triangle.count; i-- > 0;) { /* backwards: starts move down to their final places */
        tile_box b = box_of(&chunk->triangle, i, shift);
        if (is_large(b)) {
            chunk->large[--chunk->large_count] = (uint16_t)i;
            continue;
        }
        for (uint32_t y = b.y0; y <= b.y1; y++)
            for (uint32_t x = b.x0; x <= b.x1; x++)
                chunk->entry[--chunk->tile_start[y * (uint32_t)pass->tiles_x + x]] = (uint16_t)i;
    }
}

void raster_bin(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y;
    const unsigned shift = (unsigned)__builtin_ctz((unsigned)pass->tile_size);
    if (!raster_grow(&chunk->tile_start, &chunk->tile_capacity, tiles + 1, sizeof *chunk->tile_start))
        goto error;
    memset(chunk->tile_start, 0, (tiles + 1) * sizeof *chunk->tile_start);
    uint32_t large = count_entries(pass, chunk, shift), entries = 0;
    for (size_t i = 0; i < tiles; i++) { /* each tile's end; placing moves it down to the start */
        entries += chunk->tile_start[i];
        chunk->tile_start[i] = entries;
    }
    chunk->tile_start[tiles] = entries;
    if (!raster_grow(&chunk->entry, &chunk->entry_capacity, (size_t)entries + 1, sizeof *chunk->entry) ||
        !raster_grow(&chunk->large, &chunk->large_capacity, (size_t)large + 1, sizeof *chunk->large))
        goto error;
    chunk->large_count = large;
    place_entries(pass, chunk, shift);
    chunk->large_count = large;
    return;
error:
    scratch->failed = true;
}
