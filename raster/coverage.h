/* Which pixels of a tile a triangle covers. Edge functions are exact integers; a block is rejected or accepted by its
 * corners, and only blocks on an edge are tested pixel by pixel. Part of tile_wide.c. */
#ifndef AMBIANCE_RASTER_COVERAGE_H
#define AMBIANCE_RASTER_COVERAGE_H

#include "core/gather.h"
#include "raster/fragment.h"

#include <stdlib.h>

/* Triangles of smaller extent have edge functions of less than 2³¹ everywhere near them, fraction bits included:
 * 2 · (extent + 1024) · extent. */
#define RASTER_SMALL 28000

/* An edge function E(x, y) = 256·(c + a·x + b·y + bias) in pixels from the first pixel of a box, and the pixel is
 * inside where c + a·x + b·y ≥ 0: the constant's fraction and the fill rule are in the bias. */
typedef struct raster_edge {
    int64_t c;
    int32_t a, b;
    float bias;
} raster_edge;

typedef struct raster_box {
    int x0, y0, x1, y1;
} raster_box; /* blocks of the tile, inclusive */

/* The bounds' blocks inside this tile; empty (x0 > x1 or y0 > y1) when they miss it. */
static inline raster_box box_in_tile(const raster_tile *tile, uint32_t low, uint32_t high)
{
    int side = tile->pass->tile_size;
    int x0 = (int)(low & 0xffffu) - tile->x0, y0 = (int)(low >> 16) - tile->y0;
    int x1 = (int)(high & 0xffffu) - tile->x0, y1 = (int)(high >> 16) - tile->y0;
    if (x0 >= side || y0 >= side || x1 < 0 || y1 < 0)
        return (raster_box){1, 1, 0, 0};
    return (raster_box){(x0 > 0 ? x0 : 0) / AMB_BLOCK_W, (y0 > 0 ? y0 : 0) / AMB_BLOCK_H,
                        (x1 < side ? x1 : side - 1) / AMB_BLOCK_W, (y1 < side ? y1 : side - 1) / AMB_BLOCK_H};
}

/* ---- 32 bits ---------------------------------------------------------------------------------------------------- */

/* Every lane of a block; x, y: its first pixel, from the box's. */
static inline void test_block(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_edge e[3],
                              const i32x step[3], raster_box box, int bx, int by, bool full)
{
    i32x k[3];
    f32x weight[3];
    int32_t x = (bx - box.x0) * AMB_BLOCK_W, y = (by - box.y0) * AMB_BLOCK_H;
    for (int i = 0; i < 3; i++)
        k[i] = ((int32_t)e[i].c + e[i].a * x + e[i].b * y) + step[i];
    maskx cover = full ? m_set(true) : (k[0] | k[1] | k[2]) >= 0;
    if (!full && !m_any(cover))
        return;
    for (int i = 0; i < 3; i++)
        weight[i] = i_to_f(k[i]) + e[i].bias;
    fragment_triangle(tile, s, queue, bx, by, cover, weight);
}

/* AMB_LANES blocks of a row at once: which ones may be covered, which ones are covered wholly? */
static inline void test_row(const raster_edge e[3], raster_box box, int bx, int by, uint32_t *touched, uint32_t *full)
{
    maskx may = m_set(true), all = m_set(true);
    int32_t x = (bx - box.x0) * AMB_BLOCK_W, y = (by - box.y0) * AMB_BLOCK_H;
    for (int i = 0; i < 3; i++) {
        int32_t step_x = e[i].a * (AMB_BLOCK_W - 1), step_y = e[i].b * (AMB_BLOCK_H - 1);
        int32_t most = (step_x > 0 ? step_x : 0) + (step_y > 0 ? step_y : 0), least = step_x + step_y - most;
        i32x k = ((int32_t)e[i].c + e[i].a * x + e[i].b * y) + i_lane_index() * (e[i].a * AMB_BLOCK_W);
        may &= k + most >= 0;
        all &= k + least >= 0;
    }
    *touched = m_bits(may);
    *full = m_bits(all);
}

static void cover_32(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_edge e[3],
                     raster_box box)
{
    i32x step[3];
    for (int i = 0; i < 3; i++)
        step[i] = i_block_x() * e[i].a + i_block_y() * e[i].b;
    if ((box.x1 - box.x0 + 1) * (box.y1 - box.y0 + 1) <= 4) {
        for (int by = box.y0; by <= box.y1; by++)
            for (int bx = box.x0; bx <= box.x1; bx++)
                test_block(tile, s, queue, e, step, box, bx, by, false);
        return;
    }
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx += AMB_LANES) {
            int last = box.x1 - bx < AMB_LANES - 1 ? box.x1 - bx : AMB_LANES - 1;
            uint32_t touched, full;
            test_row(e, box, bx, by, &touched, &full);
            for (touched &= (uint32_t)((2ull << last) - 1u); touched != 0; touched &= touched - 1) {
                int n = __builtin_ctz(touched);
                test_block(tile, s, queue, e, step, box, bx + n, by, (full >> n & 1u) != 0);
            }
        }
}

/* ---- more than 32 bits: doubles hold the edge functions exactly ------------------------------------------------- */

static void cover_64(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_edge e[3],
                     raster_box box)
{
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx++) {
            float weight[3][AMB_LANES];
            uint32_t cover = AMB_ALL_LANES;
            for (int i = 0; i < 3 && cover != 0; i++) {
                int64_t x = (bx - box.x0) * AMB_BLOCK_W, y = (by - box.y0) * AMB_BLOCK_H;
                int64_t k = e[i].c + e[i].a * x + e[i].b * y;
                uint32_t inside = 0;
                for (int lane = 0; lane < AMB_LANES; lane++) {
                    int64_t value =
                        k + (int64_t)e[i].a * i_lane(i_block_x(), lane) + (int64_t)e[i].b * i_lane(i_block_y(), lane);
                    inside |= (uint32_t)(value >= 0) << lane;
                    weight[i][lane] = (float)((double)value + (double)e[i].bias);
                }
                cover &= inside;
            }
            if (cover == 0)
                continue;
            const f32x w[3] = {f_load(weight[0]), f_load(weight[1]), f_load(weight[2])};
            fragment_triangle(tile, s, queue, bx, by, m_from_bits(cover), w);
        }
}

static inline int64_t magnitude(int32_t a) { return a < 0 ? -(int64_t)a : (int64_t)a; }

/* Do the edge functions fit 32 bits over every pixel looked at? Depends on the triangle alone, so that all tiles
 * agree. */
static inline bool fits_32_bits(const int32_t x[3], const int32_t y[3], const raster_edge e[3])
{
    int32_t x0 = x[0], x1 = x[0], y0 = y[0], y1 = y[0];
    for (int i = 1; i < 3; i++) {
        x0 = x[i] < x0 ? x[i] : x0, x1 = x[i] > x1 ? x[i] : x1;
        y0 = y[i] < y0 ? y[i] : y0, y1 = y[i] > y1 ? y[i] : y1;
    }
    int64_t w = ((x1 - x0) >> 8) + 1 + 2 * RASTER_MAX_TILE, h = ((y1 - y0) >> 8) + 1 + 2 * RASTER_MAX_TILE;
    for (int i = 0; i < 3; i++)
        if (magnitude(e[i].a) * w + magnitude(e[i].b) * h >= INT32_MAX)
            return false;
    return true;
}

static inline void window_corners(const raster_shading *s, int32_t x[3], int32_t y[3])
{
    for (int i = 0; i < 3; i++) {
        const raster_vertex *v = raster_vertex_at(s->chunk, s->number[i]);
        x[i] = v->x, y[i] = v->y;
    }
}

/* A triangle of any size. */
static void play_large(const raster_tile *tile, raster_shading *s, raster_queue *queue, uint32_t low, uint32_t high)
{
    raster_box box = box_in_tile(tile, low, high);
    if (box.x0 > box.x1)
        return;
    int32_t x[3], y[3];
    window_corners(s, x, y);
    int64_t px = ((int64_t)tile->x0 + box.x0 * AMB_BLOCK_W) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t py = ((int64_t)tile->y0 + box.y0 * AMB_BLOCK_H) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t right = (box.x1 - box.x0 + 1) * AMB_BLOCK_W - 1, down = (box.y1 - box.y0 + 1) * AMB_BLOCK_H - 1;
    raster_edge e[3];
    for (int i = 0; i < 3; i++) { /* edge i lies opposite vertex i */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int32_t a = y[j] - y[k], b = x[k] - x[j];
        int64_t value = a * (px - x[j]) + b * (py - y[j]);
        bool top_left = a > 0 || (a == 0 && b > 0);
        int32_t fraction = (int32_t)(value & 255);
        int32_t excluded = !top_left && fraction == 0; /* on-edge samples belong to the other side */
        e[i] = (raster_edge){(value >> 8) - excluded, a, b, (float)excluded + (float)fraction * (1.0f / 256.0f)};
        if (e[i].c + (a > 0 ? a * right : 0) + (b > 0 ? b * down : 0) < 0)
            return; /* wholly outside this tile */
    }
    int64_t area = (int64_t)(x[1] - x[0]) * (y[2] - y[0]) - (int64_t)(x[2] - x[0]) * (y[1] - y[0]);
    s->inverse_area = 256.0f / (float)area;
    if (fits_32_bits(x, y, e))
        cover_32(tile, s, queue, e, box);
    else
        cover_64(tile, s, queue, e, box);
}

/* ---- AMB_LANES triangles at once --------------------------------------------------------------------------------- */

typedef struct edge_group {
    int32_t c[3][AMB_LANES], a[3][AMB_LANES], b[3][AMB_LANES];
    float bias[3][AMB_LANES], inverse_area[AMB_LANES];
    uint32_t number[3][AMB_LANES], primitive_front[AMB_LANES], low[AMB_LANES], high[AMB_LANES];
    f32x z[3], inverse_w[3];
    uint32_t small; /* lanes whose edges are filled */
} edge_group;

/* The first pixel of the block that a bound (x or y) falls into, inside the tile. */
static inline i32x box_origin(i32x bound, int tile_first, int block)
{
    return i_max(bound, i_set(tile_first)) & ~(block - 1);
}

static inline void make_group(const raster_tile *tile, const raster_chunk *chunk, const int32_t *index, edge_group *g)
{
    u32x record[4], vertex[4];
    i32x x[3], y[3];
    fetch_4(&chunk->triangle->v0_primitive, i_load(index) * (int32_t)(sizeof(raster_triangle) / sizeof(uint32_t)),
            record);
    i32x low = u_as_i(record[3]);
    i_store((int32_t *)(void *)g->low, low);
    i_store((int32_t *)(void *)g->high, u_as_i(record[1] >> 16 | (record[2] & 0xffff0000u)));
    i_store((int32_t *)(void *)g->primitive_front,
            u_as_i(((record[0] >> 16 & 0x7fffu) + chunk->primitive) | (record[0] & 0x80000000u)));
    for (int i = 0; i < 3; i++) {
        i32x number = u_as_i(record[i] & 0xffffu);
        i_store((int32_t *)(void *)g->number[i], number);
        fetch_4(chunk->vertex, number * (int32_t)chunk->stride, vertex);
        g->z[i] = f_from_bits(u_as_i(vertex[0])), g->inverse_w[i] = f_from_bits(u_as_i(vertex[1]));
        x[i] = u_as_i(vertex[2]), y[i] = u_as_i(vertex[3]);
    }
    i32x px = box_origin(low & 0xffff, tile->x0, AMB_BLOCK_W) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    i32x py = box_origin((i32x)((u32x)low >> 16), tile->y0, AMB_BLOCK_H) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    maskx small = m_set(true);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        i32x a = y[j] - y[k], b = x[k] - x[j];
        small &= (a < RASTER_SMALL) & (a > -RASTER_SMALL) & (b < RASTER_SMALL) & (b > -RASTER_SMALL);
        i32x value = a * (px - x[j]) + b * (py - y[j]);
        maskx top_left = (a > 0) | ((a == 0) & (b > 0));
        i32x fraction = value & 255;
        i32x excluded = i_sel(~top_left & (fraction == 0), i_set(1), i_set(0));
        i_store(g->c[i], (value >> 8) - excluded);
        i_store(g->a[i], a);
        i_store(g->b[i], b);
        f_store(g->bias[i], i_to_f(excluded) + i_to_f(fraction) * (1.0f / 256.0f));
    }
    i32x area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    f_store(g->inverse_area, 256.0f / i_to_f(area));
    g->small = m_bits(small);
}

#endif
