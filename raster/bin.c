/* Binning: a counting sort of a chunk's triangles into the tiles their boxes touch, in order. A triangle on many tiles
 * goes to the chunk's list of large ones instead, which every tile looks through: so a chunk's bins stay small. Then
 * the same for a batch: a list of chunks for every tile. */
#include "raster/internal.h"

typedef struct tile_box {
    uint32_t x0, y0, x1, y1;
} tile_box;

static tile_box box_of(const raster_triangle *t, unsigned shift)
{
    return (tile_box){(t->x0_y0 & 0xffffu) >> shift, t->x0_y0 >> 16 >> shift, t->v1_x1 >> 16 >> shift,
                      t->v2_y1 >> 16 >> shift};
}

#define SEVERAL (UINT32_MAX - 1)
#define LARGE UINT32_MAX

static bool is_large(tile_box b) { return (b.x1 - b.x0 + 1) * (b.y1 - b.y0 + 1) > RASTER_LARGE_TILES; }

static tile_box box_union(tile_box a, tile_box b)
{
    return (tile_box){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1,
                      a.y1 > b.y1 ? a.y1 : b.y1};
}

static void set_bounds(raster_chunk *chunk, tile_box all)
{
    chunk->tile_x0 = (uint16_t)all.x0, chunk->tile_y0 = (uint16_t)all.y0;
    chunk->tile_x1 = (uint16_t)all.x1, chunk->tile_y1 = (uint16_t)all.y1;
}

/* Counts every tile's triangles. Leaves in tile_of the only tile of a triangle or what else it is. all: tiles of the
 * large ones. */
static uint32_t count_entries(const amb_pass *pass, raster_chunk *chunk, unsigned shift, uint32_t *tile_of,
                              tile_box *all)
{
    const uint32_t tiles_x = (uint32_t)pass->tiles_x;
    uint32_t large = 0;
    for (uint32_t i = 0; i < chunk->triangle_count; i++) {
        tile_box b = box_of(&chunk->triangle[i], shift);
        uint32_t first = b.y0 * tiles_x + b.x0, last = b.y1 * tiles_x + b.x1;
        tile_of[i] = first;
        if (first == last) {
            chunk->tile_start[first]++;
        } else if (is_large(b)) {
            tile_of[i] = LARGE;
            *all = box_union(*all, b);
            large++;
        } else {
            tile_of[i] = SEVERAL;
            for (uint32_t y = b.y0; y <= b.y1; y++)
                for (uint32_t x = b.x0; x <= b.x1; x++)
                    chunk->tile_start[y * tiles_x + x]++;
        }
    }
    return large;
}

/* Turns counts into every tile's end: placing moves it down to the start. all: also holds the tiles that have any. */
static uint32_t sum_entries(const amb_pass *pass, raster_chunk *chunk, tile_box *all)
{
    uint32_t entries = 0, *start = chunk->tile_start;
    for (uint32_t y = 0; y < (uint32_t)pass->tiles_y; y++)
        for (uint32_t x = 0; x < (uint32_t)pass->tiles_x; x++, start++) {
            if (*start > 0)
                *all = box_union(*all, (tile_box){x, y, x, y});
            entries += *start;
            *start = entries;
        }
    *start = entries;
    return entries;
}

static void place_entries(const amb_pass *pass, raster_chunk *chunk, unsigned shift, const uint32_t *tile_of)
{
    uint16_t *large = chunk->large + chunk->large_count;
    for (uint32_t i = chunk->triangle_count; i-- > 0;) {
        if (tile_of[i] < SEVERAL) {
            chunk->entry[--chunk->tile_start[tile_of[i]]] = (uint16_t)i;
            continue;
        }
        if (tile_of[i] == LARGE) {
            *--large = (uint16_t)i;
            continue;
        }
        tile_box b = box_of(&chunk->triangle[i], shift);
        for (uint32_t y = b.y0; y <= b.y1; y++)
            for (uint32_t x = b.x0; x <= b.x1; x++)
                chunk->entry[--chunk->tile_start[y * (uint32_t)pass->tiles_x + x]] = (uint16_t)i;
    }
}

/* A chunk of few triangles: every tile in its bounds looks through all of them. */
static void leave_unbinned(raster_chunk *chunk, unsigned shift)
{
    tile_box all = {UINT16_MAX, UINT16_MAX, 0, 0};
    for (uint32_t i = 0; i < chunk->triangle_count; i++)
        all = box_union(all, box_of(&chunk->triangle[i], shift));
    set_bounds(chunk, all);
}

void raster_bin(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y;
    const unsigned shift = (unsigned)__builtin_ctz((unsigned)pass->tile_size);
    chunk->binned = chunk->triangle_count > RASTER_UNBINNED;
    if (!chunk->binned) {
        leave_unbinned(chunk, shift);
        return;
    }
    chunk->tile_start = raster_take(&scratch->batch, (tiles + 1) * sizeof *chunk->tile_start);
    if (!chunk->tile_start)
        goto error;
    memset(chunk->tile_start, 0, (tiles + 1) * sizeof *chunk->tile_start);
    tile_box all = {UINT16_MAX, UINT16_MAX, 0, 0};
    const uint32_t large = count_entries(pass, chunk, shift, scratch->tile_of, &all),
                   entries = sum_entries(pass, chunk, &all);
    chunk->entry = raster_take(&scratch->batch, ((size_t)entries + large) * sizeof *chunk->entry);
    if (!chunk->entry)
        goto error;
    chunk->large = chunk->entry + entries;
    chunk->large_count = large;
    set_bounds(chunk, all);
    place_entries(pass, chunk, shift, scratch->tile_of);
    return;
error:
    scratch->failed = true;
}

/* ---- the tiles' chunks ------------------------------------------------------------------------------------------- */

/* Calls that count (`place` false) or place a chunk at every tile it touches. */
static void at_tiles(amb_pass *pass, size_t number, bool place)
{
    const raster_chunk *chunk = &pass->chunk[number];
    const unsigned shift = (unsigned)__builtin_ctz((unsigned)pass->tile_size);
    uint32_t x0 = chunk->tile_x0, y0 = chunk->tile_y0, x1 = chunk->tile_x1, y1 = chunk->tile_y1;
    bool everywhere = !chunk->binned || chunk->large_count > 0; /* in these bounds */
    if (chunk->count == 0) {
        const raster_draw *d = chunk->draw;
        x0 = (uint32_t)d->x0 >> shift, y0 = (uint32_t)d->y0 >> shift;
        x1 = (uint32_t)(d->x1 - 1) >> shift, y1 = (uint32_t)(d->y1 - 1) >> shift;
    } else if (chunk->triangle_count == 0) {
        return;
    }
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++) {
            size_t tile = (size_t)y * (size_t)pass->tiles_x + x;
            if (!everywhere && chunk->tile_start[tile] == chunk->tile_start[tile + 1])
                continue;
            if (place)
                pass->tile_chunk[--pass->tile_first[tile]] = (uint16_t)number;
            else
                pass->tile_first[tile]++;
        }
}

bool raster_list_chunks(amb_pass *pass)
{
    const size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y;
    memset(pass->tile_first, 0, (tiles + 1) * sizeof *pass->tile_first);
    for (size_t i = 0; i < pass->chunk_count; i++)
        at_tiles(pass, i, false);
    uint32_t count = 0;
    for (size_t i = 0; i < tiles; i++) { /* each tile's end; placing moves it down to the start */
        count += pass->tile_first[i];
        pass->tile_first[i] = count;
    }
    pass->tile_first[tiles] = count;
    if (!raster_grow(&pass->tile_chunk, &pass->tile_chunk_capacity, (size_t)count + 1, sizeof *pass->tile_chunk))
        return false;
    for (size_t i = pass->chunk_count; i-- > 0;)
        at_tiles(pass, i, true);
    return true;
}
