/* Which pixels of a tile a line or a point covers. Part of tile_wide.c.
 *
 * Lines follow D3D11's diamond-exit rule: a pixel is covered when the segment, walked from its first end to its last,
 * leaves the diamond |x| + |y| ≤ ½ about the pixel's centre. The diamond holds its two lower edges and neither its
 * upper edges nor its left, right and top corners, but for steep lines (|dy| > |dx|) the right corner too. */
#ifndef AMBIANCE_RASTER_LINES_H
#define AMBIANCE_RASTER_LINES_H

#include "raster/coverage.h"

typedef struct raster_line {
    int64_t x0, y0, x1, y1; /* 1/256 pixel */
    bool steep;
} raster_line;

/* The part of 0…1 where a line's parameter fulfils every condition so far. */
typedef struct raster_span {
    int64_t low, low_by, high, high_by; /* fractions low / low_by and high / high_by */
    bool low_in, high_in;               /* are the ends themselves inside? */
} raster_span;

/* Narrows the span to start + change · t ≤ 128, or < 128 if strict; false when nothing is left. */
static inline bool narrow(raster_span *s, int64_t start, int64_t change, bool strict)
{
    if (change == 0)
        return strict ? start < 128 : start <= 128;
    int64_t by = change > 0 ? change : -change, bound = change > 0 ? 128 - start : start - 128;
    if (change > 0) { /* t ≤ bound / by */
        int64_t here = bound * s->high_by, there = s->high * by;
        if (here < there || (here == there && strict)) {
            s->high_in = here == there ? s->high_in && !strict : !strict;
            s->high = bound, s->high_by = by;
        }
    } else { /* t ≥ bound / by */
        int64_t here = bound * s->low_by, there = s->low * by;
        if (here > there || (here == there && strict)) {
            s->low_in = here == there ? s->low_in && !strict : !strict;
            s->low = bound, s->low_by = by;
        }
    }
    int64_t low = s->low * s->high_by, high = s->high * s->low_by;
    return low < high || (low == high && s->low_in && s->high_in);
}

/* Is (u, v), relative to the pixel's centre with v down, in the diamond? */
static inline bool in_diamond(int64_t u, int64_t v, bool steep)
{
    return (u + v <= 128 && v - u <= 128 && u - v < 128 && -u - v < 128) || (steep && u == 128 && v == 0);
}

/* cx, cy: a pixel's centre. */
static bool line_covers(const raster_line *line, int64_t cx, int64_t cy)
{
    int64_t u = line->x0 - cx, v = line->y0 - cy, dx = line->x1 - line->x0, dy = line->y1 - line->y0;
    if (in_diamond(line->x1 - cx, line->y1 - cy, line->steep))
        return false;
    raster_span span = {0, 1, 1, 1, true, true};
    if (narrow(&span, u + v, dx + dy, false) && narrow(&span, v - u, dy - dx, false) &&
        narrow(&span, u - v, dx - dy, true) && narrow(&span, -u - v, -dx - dy, true))
        return true;
    /* Through the right corner? */
    int64_t to_corner = 128 - u;
    return line->steep && to_corner * dy + v * dx == 0 && (dy > 0 ? v <= 0 && v + dy >= 0 : v >= 0 && v + dy <= 0);
}

static void play_line_block(const raster_tile *tile, raster_shading *s, raster_queue *queue, const raster_line *line,
                            int bx, int by)
{
    int64_t dx = line->x1 - line->x0, dy = line->y1 - line->y0;
    int64_t cx = ((int64_t)tile->x0 + bx * AMB_BLOCK_W) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t cy = ((int64_t)tile->y0 + by * AMB_BLOCK_H) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t middle_x = cx + (AMB_BLOCK_W - 1) * 128 - line->x0, middle_y = cy + (AMB_BLOCK_H - 1) * 128 - line->y0;
    if (llabs(dx * middle_y - dy * middle_x) > (llabs(dx) * AMB_BLOCK_H + llabs(dy) * AMB_BLOCK_W) * 128)
        return; /* too far from the block */
    uint32_t cover = 0;
    float to_first[AMB_LANES], to_last[AMB_LANES]; /* both exact before division: 1 - t would cancel */
    float length = (float)(line->steep ? dy : dx);
    for (int lane = 0; lane < AMB_LANES; lane++) {
        int64_t x = cx + (int64_t)i_lane(i_block_x(), lane) * RASTER_SUBPIXEL;
        int64_t y = cy + (int64_t)i_lane(i_block_y(), lane) * RASTER_SUBPIXEL;
        cover |= (uint32_t)line_covers(line, x, y) << lane;
        to_first[lane] = (float)(line->steep ? y - line->y0 : x - line->x0) / length;
        to_last[lane] = (float)(line->steep ? line->y1 - y : line->x1 - x) / length;
    }
    if (cover == 0)
        return;
    const f32x weight[3] = {f_saturate(f_load(to_last)), f_saturate(f_load(to_first)), f_set(0.0f)};
    fragment_triangle(tile, s, queue, bx, by, m_from_bits(cover), weight);
}

/* Coverage and varyings of the line of vertices 0 and 1; t of a pixel is that of its centre along the longer axis. */
static void play_line(const raster_tile *tile, raster_shading *s, raster_queue *queue, uint32_t low, uint32_t high)
{
    const raster_chunk *chunk = s->chunk;
    const uint32_t *v = s->number;
    const raster_vertex *from = raster_vertex_at(chunk, v[0]), *to = raster_vertex_at(chunk, v[1]);
    raster_line line = {from->x, from->y, to->x, to->y, false};
    line.steep = llabs(line.y1 - line.y0) > llabs(line.x1 - line.x0);
    if (line.x0 == line.x1 && line.y0 == line.y1)
        return; /* never leaves a diamond */
    raster_box box = box_in_tile(tile, low, high);
    s->inverse_area = 1.0f;
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx++)
            play_line_block(tile, s, queue, &line, bx, by);
}

/* A square about vertex 0, its left and upper edges inside, its right and lower ones outside. */
static void play_point(const raster_tile *tile, raster_shading *s, raster_queue *queue, uint32_t low, uint32_t high)
{
    const raster_vertex *v = raster_vertex_at(s->chunk, s->number[0]);
    const int32_t x = v->x, y = v->y;
    float size = s->draw->point_size > 0.0f ? s->draw->point_size : 1.0f;
    int32_t half = (int32_t)f_lane(f_round(f_set(size * (0.5f * (float)RASTER_SUBPIXEL))), 0);
    raster_box box = box_in_tile(tile, low, high);
    const f32x weight[3] = {f_set(1.0f), f_set(0.0f), f_set(0.0f)};
    s->inverse_area = 1.0f;
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx++) {
            i32x cx = (i_set(tile->x0 + bx * AMB_BLOCK_W) + i_block_x()) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
            i32x cy = (i_set(tile->y0 + by * AMB_BLOCK_H) + i_block_y()) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
            maskx cover = (cx >= x - half) & (cx < x + half) & (cy >= y - half) & (cy < y + half);
            if (m_any(cover))
                fragment_triangle(tile, s, queue, bx, by, cover, weight);
        }
}

#endif
