/* The tile stage: all chunks of a batch, in order, over one tile, from loading its pixels to storing them. */
#include "raster/lines.h"
#include "raster/multisample.h"
#include "raster/tile_texture.h"

#define raster_tile_play WIDE(raster_tile)
void raster_tile_play(const amb_pass *pass, int tile, raster_scratch *scratch, int thread);

/* ---- the tile's pixels ------------------------------------------------------------------------------------------ */

#if AMB_LANES == 16 && AMB_X86
#define RASTER_WHOLE_ROWS 1
/* Four blocks side by side, quads in row order, to four rows of sixteen pixels, or back. */
static inline void exchange_rows(__m512 r[4])
{
    __m512 ab = _mm512_shuffle_f32x4(r[0], r[1], 0x44), cd = _mm512_shuffle_f32x4(r[2], r[3], 0x44);
    __m512 ab2 = _mm512_shuffle_f32x4(r[0], r[1], 0xee), cd2 = _mm512_shuffle_f32x4(r[2], r[3], 0xee);
    r[0] = _mm512_shuffle_f32x4(ab, cd, 0x88), r[1] = _mm512_shuffle_f32x4(ab, cd, 0xdd);
    r[2] = _mm512_shuffle_f32x4(ab2, cd2, 0x88), r[3] = _mm512_shuffle_f32x4(ab2, cd2, 0xdd);
}

/* One channel of four rows of pixels, to the image past the caches (nobody reads it again soon) or from it. */
static void transfer_rows(const raster_tile *tile, float *lanes, float *row, size_t stride, bool to_image)
{
    const size_t step = (size_t)block_planes(tile) * AMB_LANES;
    for (int x = 0; x < tile->right; x += 16, lanes += 4 * step) {
        __m512 r[4];
        for (size_t i = 0; i < 4; i++)
            r[i] = to_image ? (__m512)rows_of(f_load(lanes + i * step)) : _mm512_load_ps(row + i * stride + x);
        exchange_rows(r);
        for (size_t i = 0; i < 4; i++)
            if (to_image)
                _mm512_stream_ps(row + i * stride + x, r[i]);
            else
                f_store(lanes + i * step, rows_of((f32x)r[i]));
    }
}
#else
#define RASTER_WHOLE_ROWS 0
static void transfer_rows(const raster_tile *tile, float *lanes, float *row, size_t stride, bool to_image)
{
    (void)tile, (void)lanes, (void)row, (void)stride, (void)to_image;
}
#endif

/* Copies one channel between the tile's blocks and the image's rows. Rows of an image are padded to whole blocks. */
static void transfer(const raster_tile *tile, const amb_image *image, int channel, int plane, bool to_image)
{
    const size_t row_bytes = AMB_BLOCK_W * sizeof(float);
    for (int y = 0; y < tile->bottom; y += AMB_BLOCK_H) {
        float *row = amb_image_row(image, channel, tile->y0 + y) + tile->x0;
        float *lanes = block_at(tile, 0, y / AMB_BLOCK_H) + plane * AMB_LANES;
        int rows = tile->bottom - y < AMB_BLOCK_H ? tile->bottom - y : AMB_BLOCK_H;
        if (RASTER_WHOLE_ROWS && rows == AMB_BLOCK_H) {
            transfer_rows(tile, lanes, row, image->stride, to_image);
            continue;
        }
        for (int x = 0; x < tile->right; x += AMB_BLOCK_W, lanes += (size_t)block_planes(tile) * AMB_LANES) {
            float block[AMB_LANES] = {0};
            if (to_image)
                f_store(block, rows_of(f_load(lanes)));
            for (int r = 0; r < rows; r++) {
                float *in_image = row + (size_t)r * image->stride + x;
                memcpy(to_image ? in_image : block + r * AMB_BLOCK_W, to_image ? block + r * AMB_BLOCK_W : in_image,
                       row_bytes);
            }
            if (!to_image)
                f_store(lanes, rows_of(f_load(block)));
        }
    }
}

static size_t blocks_of(const raster_tile *tile)
{
    return (size_t)tile->blocks_x * (size_t)(tile->pass->tile_size / AMB_BLOCK_H);
}

/* A plane of all samples, or of one: see below. */
static void fill(const raster_tile *tile, int plane, size_t samples, float value)
{
    const size_t blocks = blocks_of(tile), block_floats = (size_t)block_planes(tile) * AMB_LANES;
    for (size_t i = 0; i < blocks; i++)
        for (size_t n = 0; n < samples; n++)
            f_store(tile->data + i * block_floats + ((size_t)plane * samples + n) * AMB_LANES, f_set(value));
}

/* Pixels come and go as if they had one sample, each block's planes at its front. This gives every sample of a plane
 * what the plane so holds, from the last plane on, as planes of all samples lie farther back. */
static void spread_samples(const raster_tile *tile)
{
    const size_t blocks = blocks_of(tile), samples = (size_t)tile->pass->samples;
    for (size_t i = 0; i < blocks; i++) {
        float *block = tile->data + i * (size_t)block_planes(tile) * AMB_LANES;
        for (size_t plane = (size_t)tile->pass->planes; plane-- > 0;) {
            f32x value = f_load(block + plane * AMB_LANES);
            float *to = block + plane * samples * AMB_LANES;
            for (size_t k = 0; k < RASTER_QUADS; k++)
                for (int g = 0; g < tile->sample_groups; g++)
                    store_lanes(to + 4 * k * samples + g * AMB_LANES, spread_quad(value, (int)k),
                                group_lanes(tile->all_samples, g));
        }
    }
}

/* The attachment and channel of a plane, if it is one of colour. */
static const raster_attachment *color_of_plane(const amb_pass *pass, int plane)
{
    for (int i = 0; i < pass->target_count; i++)
        if (plane >= pass->color[i].first && plane < pass->color[i].first + pass->color[i].channels)
            return &pass->color[i];
    return NULL;
}

/* Puts one plane a pixel to the blocks' fronts: the average of a colour's samples, neighbours in pairs, then pairs of
 * pairs; of others sample 0. Planes must be taken in order. */
static void resolve_plane(const raster_tile *tile, int plane)
{
    const size_t blocks = blocks_of(tile), stride = (size_t)tile->pass->samples * AMB_LANES;
    const raster_attachment *a = color_of_plane(tile->pass, plane);
    const int samples = tile->pass->samples;
    for (size_t i = 0; i < blocks; i++) {
        float *block = tile->data + i * (size_t)tile->pass->planes * stride, *at = block + (size_t)plane * stride;
        const float *quad[RASTER_QUADS];
        for (int k = 0; k < RASTER_QUADS; k++)
            quad[k] = at + 4 * k * samples;
        f32x sum[RASTER_MAX_SAMPLES];
        for (int n = 0; n < (a ? samples : 1); n++)
            sum[n] = load_quads(quad, (size_t)(4 * n));
        for (int n = samples; a && n > 1; n /= 2)
            for (int k = 0; k < n / 2; k++)
                sum[k] = sum[2 * k] + sum[2 * k + 1];
        if (a)
            sum[0] = quantize(a->format, tile->pass->srgb, plane - a->first, sum[0] * (1.0f / (float)samples));
        f_store(block + plane * AMB_LANES, sum[0]);
    }
}

static void resolve_samples(const raster_tile *tile)
{
    for (int plane = 0; plane < tile->pass->planes; plane++)
        resolve_plane(tile, plane);
}

/* Fills an attachment's planes with its pixels, or with its clear value. */
static void load_attachment(const raster_tile *tile, const raster_attachment *a, bool from_target, size_t samples)
{
    const bool partial = tile->right < tile->pass->tile_size || tile->bottom < tile->pass->tile_size;
    for (int c = 0; c < a->channels && (!from_target || partial); c++)
        fill(tile, a->first + c, samples, from_target ? 0.0f : a->clear[c]);
    for (int c = 0; from_target && a->image && c < a->channels; c++)
        transfer(tile, a->image, c, a->first + c, false);
    if (from_target && a->texture)
        transfer_texture(tile, a, false);
}

static void store_attachment(const raster_tile *tile, const raster_attachment *a)
{
    for (int c = 0; a->image && c < a->channels; c++)
        transfer(tile, a->image, c, a->first + c, true);
    if (a->texture)
        transfer_texture(tile, a, true);
}

static void load_tile(const raster_tile *tile, bool from_target)
{
    const amb_pass *pass = tile->pass;
    const size_t samples = from_target ? 1 : (size_t)pass->samples;
    fill(tile, 0, samples, 0.0f); /* without a depth attachment */
    load_attachment(tile, &pass->depth, from_target, samples);
    load_attachment(tile, &pass->stencil, from_target, samples);
    for (int i = 0; i < pass->target_count; i++)
        load_attachment(tile, &pass->color[i], from_target, samples);
    if (from_target && pass->samples > 1)
        spread_samples(tile);
}

static void store_tile(const raster_tile *tile)
{
    const amb_pass *pass = tile->pass;
    for (int i = 0; i < pass->target_count; i++)
        store_attachment(tile, &pass->color[i]);
    store_attachment(tile, &pass->stencil);
    store_attachment(tile, &pass->depth);
#if RASTER_WHOLE_ROWS
    _mm_sfence();
#endif
}

/* ---- playing ---------------------------------------------------------------------------------------------------- */

static int clamp_to_tile(int pixel, int side) { return pixel < 0 ? 0 : pixel > side ? side : pixel; }

/* The draw's scissor in this tile; false when it misses it. */
static bool set_clip(raster_tile *tile, const raster_draw *draw)
{
    int side = tile->pass->tile_size;
    tile->clip_x0 = clamp_to_tile(draw->x0 - tile->x0, side), tile->clip_x1 = clamp_to_tile(draw->x1 - tile->x0, side);
    tile->clip_y0 = clamp_to_tile(draw->y0 - tile->y0, side), tile->clip_y1 = clamp_to_tile(draw->y1 - tile->y0, side);
    tile->clipped = tile->clip_x0 > 0 || tile->clip_y0 > 0 || tile->clip_x1 < side || tile->clip_y1 < side;
    return tile->clip_x0 < tile->clip_x1 && tile->clip_y0 < tile->clip_y1;
}

/* Consecutive full-screen draws, row of blocks by row of blocks, so that a row stays in the nearest cache. */
static void play_screens(raster_tile *tile, const uint16_t *number, size_t count)
{
    for (int by = 0; by * AMB_BLOCK_H < tile->bottom; by++)
        for (size_t i = 0; i < count; i++) {
            const raster_draw *draw = tile->pass->chunk[number[i]].draw;
            if (!set_clip(tile, draw) || (by + 1) * AMB_BLOCK_H <= tile->clip_y0 || by * AMB_BLOCK_H >= tile->clip_y1)
                continue;
            for (int bx = tile->clip_x0 / AMB_BLOCK_W; bx * AMB_BLOCK_W < tile->clip_x1; bx++)
                fragment_screen(tile, &draw->state, bx, by);
        }
}

/* One primitive of a group. */
static inline void play_one(const raster_tile *tile, raster_shading *s, raster_queue *queue, const edge_group *g, int n)
{
    for (int i = 0; i < 3; i++)
        s->number[i] = g->number[i][n];
    s->primitive_front = g->primitive_front[n];
    s->prepared = false;
    if (s->chunk->draw->lines) {
        play_line(tile, s, queue, g->low[n], g->high[n]);
    } else if (s->chunk->draw->points) {
        play_point(tile, s, queue, g->low[n], g->high[n]);
    } else if (tile->pass->samples > 1) {
        play_multisample(tile, s, queue, g->low[n], g->high[n]);
    } else if (!(g->small >> n & 1u)) {
        play_large(tile, s, queue, g->low[n], g->high[n]);
    } else {
        raster_edge e[3];
        for (int i = 0; i < 3; i++)
            e[i] = (raster_edge){g->c[i][n], g->a[i][n], g->b[i][n], g->bias[i][n]};
        s->inverse_area = g->inverse_area[n];
        cover_32(tile, s, queue, e, box_in_tile(tile, g->low[n], g->high[n]));
    }
}

/* Plays `count` primitives of the chunk, in order: runs of small triangles together; `index` is readable to AMB_LANES.
 */
static inline void play_group(const raster_tile *tile, raster_shading *s, raster_queue *queue,
                              const raster_chunk *chunk, const int32_t *index, int count)
{
    edge_group g;
    make_group(tile, chunk, index, &g);
    uint32_t small = find_small(tile, chunk, &g);
    for (int n = 0; n < count;) {
        int end = n;
        while (end < count && (small >> end & 1u) != 0)
            end++;
        if (end > n) {
            if (tile->pass->samples > 1)
                play_small_samples(tile, s, queue, &g, n, end);
            else
                play_small(tile, s, queue, &g, n, end);
            n = end;
        } else {
            play_one(tile, s, queue, &g, n++);
        }
    }
}

/* A chunk's triangles, whichever tiles they touch. */
static void play_unbinned(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_chunk *chunk)
{
    const int32_t count = (int32_t)chunk->triangle_count;
    for (int32_t first = 0; first < count; first += AMB_LANES) {
        int32_t index[AMB_LANES];
        i_store(index, i_min(i_lane_index() + first, i_set(count - 1)));
        play_group(tile, s, queue, chunk, index, count - first < AMB_LANES ? count - first : AMB_LANES);
    }
}

/* Asks for what the next group will read: its vertices, and the triangles of the one after it. Half of them will do:
 * neighbours in a bin are mostly neighbours in memory. */
static inline void prefetch_group(const raster_chunk *chunk, const uint16_t *next, const uint16_t *end)
{
    for (ptrdiff_t i = 0; i < AMB_LANES && i < end - next; i += 2) {
        const raster_triangle *t = &chunk->triangle[next[i]];
        if (i + AMB_LANES < end - next)
            __builtin_prefetch(&chunk->triangle[next[i + AMB_LANES]]);
        __builtin_prefetch(raster_vertex_at(chunk, t->v0_primitive & 0xffffu));
        __builtin_prefetch(raster_vertex_at(chunk, t->v1_x1 & 0xffffu));
        __builtin_prefetch(raster_vertex_at(chunk, t->v2_y1 & 0xffffu));
    }
}

/* The chunk's binned and large triangles, merged back into their order. */
static void play_binned(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_chunk *chunk,
                        int number)
{
    const uint16_t *binned = chunk->entry + chunk->tile_start[number];
    const uint16_t *binned_end = chunk->entry + chunk->tile_start[number + 1];
    const uint16_t *large = chunk->large, *large_end = chunk->large + chunk->large_count;
    while (binned < binned_end || large < large_end) {
        int32_t index[AMB_LANES];
        int count = 0;
        for (; count < AMB_LANES && (binned < binned_end || large < large_end); count++) {
            bool take_large = binned == binned_end || (large < large_end && *large < *binned);
            index[count] = take_large ? *large++ : *binned++;
        }
        for (int i = count; i < AMB_LANES; i++)
            index[i] = index[0];
        prefetch_group(chunk, binned, binned_end);
        play_group(tile, s, queue, chunk, index, count);
    }
}

static void play_chunk(raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_chunk *chunk, int number)
{
    s->chunk = chunk;
    s->draw = &chunk->draw->state;
    if (!set_clip(tile, chunk->draw))
        return;
    if (queue->draw != s->draw)
        flush_queue(tile, queue);
    queue->draw = s->draw;
    if (chunk->binned)
        play_binned(tile, s, queue, chunk, number);
    else
        play_unbinned(tile, s, queue, chunk);
}

/* Small draws' chunks lie far apart: what the tile will read of the coming ones is asked for in time. */
static inline void prefetch_chunks(const amb_pass *pass, const uint16_t *next, const uint16_t *end)
{
    if (end - next > 4)
        for (size_t line = 0; line < sizeof(raster_chunk); line += 64)
            __builtin_prefetch((const char *)&pass->chunk[next[4]] + line);
    if (end - next > 2) {
        const raster_chunk *chunk = &pass->chunk[next[2]];
        const char *state = (const char *)chunk->draw;
        for (size_t line = 0; line < sizeof *chunk->draw; line += 64)
            __builtin_prefetch(state + line);
        if (chunk->count == 0)
            return;
        for (uint32_t i = 0; i < 8; i++) {
            __builtin_prefetch((const char *)chunk->triangle + 64 * i);
            __builtin_prefetch((const char *)chunk->vertex + 64 * i);
        }
    }
}

void raster_tile_play(const amb_pass *pass, int number, raster_scratch *scratch, int thread)
{
    raster_tile tile = {.pass = pass, .data = scratch->tile, .thread = thread, .stats = &scratch->stats};
    raster_shading shading;
    raster_queue queue = {.quads.p = {f_set(1.0f)}};
    tile.spare = scratch->tile + raster_tile_floats(pass);
    tile.packing = scratch->packing;
    tile.boxes = scratch->boxes;
    tile.x0 = number % pass->tiles_x * pass->tile_size;
    tile.y0 = number / pass->tiles_x * pass->tile_size;
    tile.blocks_x = pass->tile_size / AMB_BLOCK_W;
    if (pass->samples > 1)
        set_samples(&tile);
    tile.right = pass->width - tile.x0 < pass->tile_size ? pass->width - tile.x0 : pass->tile_size;
    tile.bottom = pass->height - tile.y0 < pass->tile_size ? pass->height - tile.y0 : pass->tile_size;
    const size_t bytes = raster_tile_floats(pass) * sizeof(float);
    const bool timed = pass->target.time_stages;
    uint64_t lap = raster_start(timed);
    if (pass->samples > 1 && pass->tile_store[number])
        memcpy(tile.data, pass->tile_store[number], bytes);
    else
        load_tile(&tile, pass->target.keep || pass->tile_started[number]);
    lap = raster_lap(timed, tile.stats, AMB_STAGE_TILES, lap);
    const uint64_t nested = tile.stats->ticks[AMB_STAGE_FRAGMENTS] + tile.stats->ticks[AMB_STAGE_OUTPUT];
    const uint16_t *next = pass->tile_chunk + pass->tile_first[number];
    const uint16_t *end = pass->tile_chunk + pass->tile_first[number + 1];
    while (next < end) {
        size_t screens = 0;
        prefetch_chunks(pass, next, end);
        while (next + screens < end && pass->chunk[next[screens]].count == 0)
            screens++;
        if (screens > 0) {
            flush_queue(&tile, &queue);
            play_screens(&tile, next, screens);
        } else {
            play_chunk(&tile, &shading, &queue, &pass->chunk[*next], number);
        }
        next += screens > 0 ? screens : 1;
    }
    flush_queue(&tile, &queue);
    lap = raster_lap(timed, tile.stats, AMB_STAGE_COVERAGE, lap);
    tile.stats->ticks[AMB_STAGE_COVERAGE] -=
        tile.stats->ticks[AMB_STAGE_FRAGMENTS] + tile.stats->ticks[AMB_STAGE_OUTPUT] - nested;
    if (pass->samples > 1 && !pass->last_batch) { /* the samples must last until it */
        if (!pass->tile_store[number])
            pass->tile_store[number] = malloc(bytes);
        if (pass->tile_store[number])
            memcpy(pass->tile_store[number], tile.data, bytes);
        else
            scratch->failed = true;
        return;
    }
    if (pass->samples > 1)
        resolve_samples(&tile);
    store_tile(&tile);
    raster_lap(timed, tile.stats, AMB_STAGE_TILES, lap);
}
