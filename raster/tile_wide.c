/* The tile stage: all chunks of a batch, in order, over one tile. Edge functions are exact integers; a block is
 * rejected or accepted by its corners, and only blocks on an edge are tested pixel by pixel. */
#include "raster/fragment.h"

#include <stdlib.h>

#define raster_tile_play WIDE(raster_tile)
void raster_tile_play(const amb_pass *pass, int tile, raster_scratch *scratch, int thread);

/* An edge function E(x, y) = 256·(c + a·x + b·y + bias) over the tile's pixels, and the pixel is inside where
 * c + a·x + b·y ≥ 0: the constant's fraction and the fill rule are in the bias. */
typedef struct edge {
    int64_t c;
    int32_t a, b;
    float bias;
} edge;

static edge make_edge(const raster_tile *tile, const raster_vertex *from, const raster_vertex *to)
{
    int32_t a = from->y - to->y, b = to->x - from->x;
    int64_t value = (int64_t)a * ((int64_t)tile->x0 * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2 - from->x) +
                    (int64_t)b * ((int64_t)tile->y0 * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2 - from->y);
    bool top_left = a > 0 || (a == 0 && b > 0);
    int32_t fraction = (int32_t)(value & 255);
    int32_t excluded = !top_left && fraction == 0; /* on-edge samples belong to the other side */
    return (edge){(value >> 8) - excluded, a, b, (float)excluded + (float)fraction * (1.0f / 256.0f)};
}

static int32_t extent(int32_t a, int32_t b, int32_t c)
{
    int32_t lo = a < b ? a : b, hi = a < b ? b : a;
    lo = c < lo ? c : lo, hi = c > hi ? c : hi;
    return ((hi - lo) >> 8) + 1;
}

/* Do the edge functions fit 32 bits over every pixel looked at? Depends on the triangle alone, so that all tiles
 * agree. */
static bool fits_32_bits(const raster_vertex *const v[3], const edge e[3])
{
    int64_t w = extent(v[0]->x, v[1]->x, v[2]->x) + 2 * RASTER_MAX_TILE;
    int64_t h = extent(v[0]->y, v[1]->y, v[2]->y) + 2 * RASTER_MAX_TILE;
    for (int i = 0; i < 3; i++)
        if (llabs((int64_t)e[i].a) * w + llabs((int64_t)e[i].b) * h >= INT32_MAX)
            return false;
    return true;
}

typedef struct block_box {
    int x0, y0, x1, y1;
} block_box; /* inclusive */

/* ---- coverage --------------------------------------------------------------------------------------------------- */

/* Every lane of a block by 32-bit edge functions; k: their values at the block's first pixel. */
static inline void test_block(const raster_tile *tile, raster_shading *s, const edge e[3], const i32x step[3], int bx,
                              int by, bool full)
{
    i32x k[3];
    f32x weight[3];
    int32_t x = bx * AMB_BLOCK_W, y = by * AMB_BLOCK_H;
    for (int i = 0; i < 3; i++)
        k[i] = ((int32_t)e[i].c + e[i].a * x + e[i].b * y) + step[i];
    maskx cover = full ? m_set(true) : (k[0] | k[1] | k[2]) >= 0;
    if (!full && !m_any(cover))
        return;
    for (int i = 0; i < 3; i++)
        weight[i] = i_to_f(k[i]) + e[i].bias;
    fragment_triangle(tile, s, bx, by, cover, weight);
}

/* AMB_LANES blocks of a row at once: which ones may be covered, which ones are covered wholly? */
static void test_row(const edge e[3], int bx, int by, uint32_t *touched, uint32_t *full)
{
    maskx may = m_set(true), all = m_set(true);
    for (int i = 0; i < 3; i++) {
        int32_t step_x = e[i].a * (AMB_BLOCK_W - 1), step_y = e[i].b * (AMB_BLOCK_H - 1);
        int32_t most = (step_x > 0 ? step_x : 0) + (step_y > 0 ? step_y : 0), least = step_x + step_y - most;
        i32x k = ((int32_t)e[i].c + e[i].a * (bx * AMB_BLOCK_W) + e[i].b * (by * AMB_BLOCK_H)) +
                 i_lane_index() * (e[i].a * AMB_BLOCK_W);
        may &= k + most >= 0;
        all &= k + least >= 0;
    }
    *touched = m_bits(may);
    *full = m_bits(all);
}

static void cover_32(const raster_tile *tile, raster_shading *s, const edge e[3], block_box box)
{
    i32x step[3];
    for (int i = 0; i < 3; i++)
        step[i] = i_block_x() * e[i].a + i_block_y() * e[i].b;
    bool few = (box.x1 - box.x0 + 1) * (box.y1 - box.y0 + 1) <= 4;
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx += AMB_LANES) {
            int last = box.x1 - bx < AMB_LANES - 1 ? box.x1 - bx : AMB_LANES - 1;
            uint32_t touched = 0, full = 0, wanted = (uint32_t)((2ull << last) - 1u);
            if (few)
                touched = AMB_ALL_LANES;
            else
                test_row(e, bx, by, &touched, &full);
            for (touched &= wanted; touched != 0; touched &= touched - 1) {
                int n = __builtin_ctz(touched);
                test_block(tile, s, e, step, bx + n, by, (full >> n & 1u) != 0);
            }
        }
}

/* The same for triangles whose edge functions need more than 32 bits: doubles hold them exactly. */
static void cover_wide(const raster_tile *tile, raster_shading *s, const edge e[3], block_box box)
{
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx++) {
            float weight[3][AMB_LANES];
            uint32_t cover = AMB_ALL_LANES;
            bool outside = false;
            for (int i = 0; i < 3 && !outside; i++) {
                int64_t x = bx * AMB_BLOCK_W, y = by * AMB_BLOCK_H, k = e[i].c + e[i].a * x + e[i].b * y;
                uint32_t inside = 0;
                for (int lane = 0; lane < AMB_LANES; lane++) {
                    int64_t value =
                        k + (int64_t)e[i].a * i_lane(i_block_x(), lane) + (int64_t)e[i].b * i_lane(i_block_y(), lane);
                    inside |= (uint32_t)(value >= 0) << lane;
                    weight[i][lane] = (float)((double)value + (double)e[i].bias);
                }
                cover &= inside;
                outside = cover == 0;
            }
            if (outside)
                continue;
            const f32x w[3] = {f_load(weight[0]), f_load(weight[1]), f_load(weight[2])};
            fragment_triangle(tile, s, bx, by, m_from_bits(cover), w);
        }
}

static void prepare_shading(raster_shading *s, const raster_chunk *chunk, const raster_triangle *t)
{
    const raster_vertex *const *v = s->vertex;
    int64_t area =
        (int64_t)(v[1]->x - v[0]->x) * (v[2]->y - v[0]->y) - (int64_t)(v[2]->x - v[0]->x) * (v[1]->y - v[0]->y);
    s->draw = &chunk->draw->state;
    s->inverse_area = (float)(256.0 / (double)area);
    s->z0 = v[0]->z;
    s->dz1 = v[1]->z - v[0]->z;
    s->dz2 = v[2]->z - v[0]->z;
    float w0 = v[0]->inverse_w, w1 = v[1]->inverse_w, w2 = v[2]->inverse_w;
    float most = amb_s_max(w0, amb_s_max(w1, w2));
    s->inverse_w[0] = w0 / most, s->inverse_w[1] = w1 / most, s->inverse_w[2] = w2 / most;
    s->affine = w0 == w1 && w1 == w2;
    s->front = t->primitive_front >> 31 != 0;
    s->primitive = (int)(t->primitive_front & 0x7fffffffu);
    s->attributes = false;
}

static void play_triangle(const raster_tile *tile, raster_shading *s, const raster_chunk *chunk, uint32_t number)
{
    const raster_triangle *t = &chunk->triangle[number];
    int x0 = t->x0 - tile->x0, y0 = t->y0 - tile->y0, x1 = t->x1 - tile->x0, y1 = t->y1 - tile->y0;
    int side = tile->pass->tile_size;
    if (x0 >= side || y0 >= side || x1 < 0 || y1 < 0)
        return;
    block_box box = {(x0 > 0 ? x0 : 0) / AMB_BLOCK_W, (y0 > 0 ? y0 : 0) / AMB_BLOCK_H,
                     (x1 < side ? x1 : side - 1) / AMB_BLOCK_W, (y1 < side ? y1 : side - 1) / AMB_BLOCK_H};
    for (int i = 0; i < 3; i++)
        s->vertex[i] = (const raster_vertex *)(const void *)(chunk->vertex + (size_t)t->v[i] * chunk->stride);
    edge e[3]; /* edge i lies opposite vertex i */
    for (int i = 0; i < 3; i++) {
        e[i] = make_edge(tile, s->vertex[(i + 1) % 3], s->vertex[(i + 2) % 3]);
        /* Wholly outside this tile? */
        int64_t most =
            (e[i].a > 0 ? (int64_t)e[i].a : 0) * (side - 1) + (e[i].b > 0 ? (int64_t)e[i].b : 0) * (side - 1);
        if (e[i].c + most < 0)
            return;
    }
    prepare_shading(s, chunk, t);
    if (fits_32_bits(s->vertex, e))
        cover_32(tile, s, e, box);
    else
        cover_wide(tile, s, e, box);
}

/* ---- the tile's pixels ------------------------------------------------------------------------------------------ */

/* Copies one channel between the tile's blocks and the image's rows, two pixels (half a quad) at a time. */
static void transfer(const raster_tile *tile, const amb_image *image, int channel, int plane, bool to_image)
{
    const size_t pair = 2 * sizeof(float);
    for (int y = 0; y < tile->bottom; y++) {
        float *row = amb_image_row(image, channel, tile->y0 + y) + tile->x0;
        int by = y / AMB_BLOCK_H, in_y = y % AMB_BLOCK_H;
        for (int x = 0; x < tile->right; x += 2) {
            int in_x = x % AMB_BLOCK_W;
            int quad = (in_y / 2) * (AMB_BLOCK_W / 2) + in_x / 2;
            float *lanes = block_at(tile, x / AMB_BLOCK_W, by) + plane * AMB_LANES + 4 * quad + 2 * (in_y & 1);
            memcpy(to_image ? row + x : lanes, to_image ? lanes : row + x, pair);
        }
    }
}

static void fill(const raster_tile *tile, int plane, float value)
{
    const size_t blocks = (size_t)tile->blocks_x * (size_t)(tile->pass->tile_size / AMB_BLOCK_H);
    for (size_t i = 0; i < blocks; i++)
        f_store(tile->data + (i * (size_t)tile->pass->planes + (size_t)plane) * AMB_LANES, f_set(value));
}

static void load_tile(const raster_tile *tile, bool from_images)
{
    const amb_target *target = &tile->pass->target;
    for (int i = 0; i < tile->pass->target_count; i++) {
        const float *clear = &target->clear_color[i].x;
        for (int c = 0; c < target->color[i]->channels; c++) {
            fill(tile, tile->pass->channel_first[i] + c, from_images ? 0.0f : clear[c]);
            if (from_images)
                transfer(tile, target->color[i], c, tile->pass->channel_first[i] + c, false);
        }
    }
    fill(tile, 0, from_images || !target->depth ? 0.0f : target->clear_depth);
    if (target->depth && from_images)
        transfer(tile, target->depth, 0, 0, false);
}

static void store_tile(const raster_tile *tile)
{
    const amb_target *target = &tile->pass->target;
    for (int i = 0; i < tile->pass->target_count; i++)
        for (int c = 0; c < target->color[i]->channels; c++)
            transfer(tile, target->color[i], c, tile->pass->channel_first[i] + c, true);
    if (target->depth)
        transfer(tile, target->depth, 0, 0, true);
}

/* ---- playing ---------------------------------------------------------------------------------------------------- */

static void play_screen(const raster_tile *tile, const amb_draw *draw)
{
    for (int by = 0; by * AMB_BLOCK_H < tile->bottom; by++)
        for (int bx = 0; bx * AMB_BLOCK_W < tile->right; bx++)
            fragment_screen(tile, draw, bx, by);
}

/* The chunk's binned and large triangles, merged back into their order. */
static void play_chunk(const raster_tile *tile, raster_shading *s, const raster_chunk *chunk, int number)
{
    const uint16_t *binned = chunk->entry + chunk->tile_start[number];
    const uint16_t *binned_end = chunk->entry + chunk->tile_start[number + 1];
    const uint16_t *large = chunk->large, *large_end = chunk->large + chunk->large_count;
    while (binned < binned_end || large < large_end) {
        bool take_large = binned == binned_end || (large < large_end && *large < *binned);
        play_triangle(tile, s, chunk, take_large ? *large++ : *binned++);
    }
}

void raster_tile_play(const amb_pass *pass, int number, raster_scratch *scratch, int thread)
{
    raster_tile tile = {.pass = pass, .data = scratch->tile, .thread = thread, .stats = &scratch->stats};
    raster_shading shading;
    tile.x0 = number % pass->tiles_x * pass->tile_size;
    tile.y0 = number / pass->tiles_x * pass->tile_size;
    tile.blocks_x = pass->tile_size / AMB_BLOCK_W;
    tile.right = pass->width - tile.x0 < pass->tile_size ? pass->width - tile.x0 : pass->tile_size;
    tile.bottom = pass->height - tile.y0 < pass->tile_size ? pass->height - tile.y0 : pass->tile_size;
    load_tile(&tile, pass->target.keep || pass->tile_started[number]);
    for (size_t i = 0; i < pass->chunk_count; i++) {
        const raster_chunk *chunk = &pass->chunk[i];
        if (chunk->count == 0)
            play_screen(&tile, &chunk->draw->state);
        else
            play_chunk(&tile, &shading, chunk, number);
    }
    store_tile(&tile);
}
