/* Which samples of a tile a triangle covers: exactly the fill rule of coverage.h, at every sample's own position. Part
 * of tile_wide.c. */
#ifndef AMBIANCE_RASTER_MULTISAMPLE_H
#define AMBIANCE_RASTER_MULTISAMPLE_H

#include "raster/small.h"

/* D3D's standard positions, 1/16 pixel from the centre. */
static const int8_t *sample_positions(int samples)
{
    static const int8_t two[] = {4, 4, -4, -4};
    static const int8_t four[] = {-2, -6, 6, -2, -6, 2, 2, 6};
    static const int8_t eight[] = {1, -3, -1, 3, 5, 1, -3, -5, -5, 5, -7, -1, 3, 7, 7, -7};
    return samples == 2 ? two : samples == 4 ? four : eight;
}

typedef struct sample_edges {
    raster_edge e[RASTER_MAX_SAMPLES + 1][3]; /* of each sample; last the pixel's centre */
} sample_edges;

/* One edge function, its origin moved by (dx, dy) sixteenths of a pixel. value: at the box's first pixel's centre. */
static raster_edge moved_edge(int64_t value, int32_t a, int32_t b, int dx, int dy)
{
    value += (int64_t)a * (dx * (RASTER_SUBPIXEL / 16)) + (int64_t)b * (dy * (RASTER_SUBPIXEL / 16));
    bool top_left = a > 0 || (a == 0 && b > 0);
    int32_t fraction = (int32_t)(value & 255);
    int32_t excluded = !top_left && fraction == 0;
    return (raster_edge){(value >> 8) - excluded, a, b, (float)excluded + (float)fraction * (1.0f / 256.0f)};
}

/* Values of an edge's function over a block, as floats, and where they are inside. */
static inline maskx edge_over_block(const raster_edge *e, int x, int y, bool fits, f32x *weight)
{
    if (fits) {
        i32x k = ((int32_t)e->c + e->a * x + e->b * y) + (i_block_x() * e->a + i_block_y() * e->b);
        *weight = i_to_f(k) + e->bias;
        return k >= 0;
    }
    float value[AMB_LANES];
    uint32_t inside = 0;
    int64_t k = e->c + (int64_t)e->a * x + (int64_t)e->b * y;
    for (int lane = 0; lane < AMB_LANES; lane++) {
        int64_t v = k + (int64_t)e->a * i_lane(i_block_x(), lane) + (int64_t)e->b * i_lane(i_block_y(), lane);
        inside |= (uint32_t)(v >= 0) << lane;
        value[lane] = (float)((double)v + (double)e->bias);
    }
    *weight = f_load(value);
    return m_from_bits(inside);
}

static void cover_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue, const sample_edges *edges,
                          raster_box box, int bx, int by, bool fits)
{
    const int samples = tile->pass->samples;
    int x = (bx - box.x0) * AMB_BLOCK_W, y = (by - box.y0) * AMB_BLOCK_H;
    i32x covered = i_set(0);
    f32x weight[3], depth[RASTER_MAX_SAMPLES];
    if (!s->prepared)
        prepare_shading(s);
    for (int i = 0; i < samples; i++) {
        maskx cover = m_set(true);
        for (int k = 0; k < 3; k++)
            cover &= edge_over_block(&edges->e[i][k], x, y, fits, &weight[k]);
        depth[i] = depth_at(s, weight);
        covered |= cover & i_set(1 << i);
    }
    if (!m_any(covered != 0))
        return;
    for (int k = 0; k < 3; k++)
        edge_over_block(&edges->e[samples][k], x, y, fits, &weight[k]);
    fragment_samples(tile, s, queue, bx, by, covered, depth, weight);
}

static void play_multisample(const raster_tile *tile, raster_shading *s, raster_queue *queue, uint32_t low,
                             uint32_t high)
{
    const int samples = tile->pass->samples;
    const int8_t *position = sample_positions(samples);
    raster_box box = box_in_tile(tile, low, high);
    if (box.x0 > box.x1)
        return;
    int32_t x[3], y[3];
    window_corners(s, x, y);
    int64_t px = ((int64_t)tile->x0 + box.x0 * AMB_BLOCK_W) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t py = ((int64_t)tile->y0 + box.y0 * AMB_BLOCK_H) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    sample_edges edges;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int32_t a = y[j] - y[k], b = x[k] - x[j];
        int64_t value = a * (px - x[j]) + b * (py - y[j]);
        for (int n = 0; n < samples; n++)
            edges.e[n][i] = moved_edge(value, a, b, position[2 * n], position[2 * n + 1]);
        edges.e[samples][i] = moved_edge(value, a, b, 0, 0);
    }
    int64_t area = (int64_t)(x[1] - x[0]) * (y[2] - y[0]) - (int64_t)(x[2] - x[0]) * (y[1] - y[0]);
    s->inverse_area = 256.0f / (float)area;
    bool fits = fits_32_bits(x, y, edges.e[samples]);
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx++) {
            bool outside = false;
            for (int i = 0; i < 3; i++) { /* from the block's corner pixels, half a pixel farther out */
                const raster_edge *e = &edges.e[samples][i];
                int64_t wide = magnitude(e->a) * (AMB_BLOCK_W + 1) + magnitude(e->b) * (AMB_BLOCK_H + 1);
                int64_t middle = 2 * (e->c + (int64_t)e->a * ((bx - box.x0) * AMB_BLOCK_W) +
                                      (int64_t)e->b * ((by - box.y0) * AMB_BLOCK_H)) +
                                 (int64_t)e->a * (AMB_BLOCK_W - 1) + (int64_t)e->b * (AMB_BLOCK_H - 1);
                outside |= middle + wide + 2 < 0;
            }
            if (!outside)
                cover_samples(tile, s, queue, &edges, box, bx, by, fits);
        }
}

/* ---- small triangles together, as small.h plays them --------------------------------------------------------------
 */

#if AMB_LANES > 4

/* Edge functions in 1/256 of a pixel's step, their constants from the tile's first pixel: those may overflow, but near
 * the triangle nothing does. */
typedef struct sample_group {
    small_group m;
    u32x c[3];       /* less 1 where a sample on the edge belongs to the other side */
    i32x on_edge[3]; /* that 1 */
    i32x offset[RASTER_MAX_SAMPLES][3];
} sample_group;

/* Fills all but m. reach: edge functions as small_group's, of whichever sample of a pixel lies farthest inside. */
static inline void gather_sample_edges(const raster_tile *tile, sample_group *g, i32x reach[3])
{
    const int8_t *position = sample_positions(tile->pass->samples);
    const small_group *m = &g->m;
    for (int i = 0; i < 3; i++) {
        i32x a = m->a[i] * (RASTER_SUBPIXEL / 16), b = m->b[i] * (RASTER_SUBPIXEL / 16);
        i32x most = g->offset[0][i] = a * position[0] + b * position[1];
        for (int n = 1; n < tile->pass->samples; n++) {
            g->offset[n][i] = a * position[2 * n] + b * position[2 * n + 1];
            most = i_max(most, g->offset[n][i]);
        }
        i32x fraction = f_to_i(m->bias[i] * 256.0f); /* 256 where the fill rule is in c */
        reach[i] = m->c[i] + ((fraction + most) >> 8);
        g->on_edge[i] = i_sel((a > 0) | ((a == 0) & (b > 0)), i_set(0), i_set(1));
        g->c[i] = i_as_u(m->c[i]) * RASTER_SUBPIXEL + i_as_u(fraction - g->on_edge[i]);
    }
}

/* An edge function as a weight: in the unit that coverage.h gives it, and rounded once as there. */
static inline f32x sample_weight(i32x e) { return i_to_f(e) * (1.0f / 256.0f); }

/* The first `most` of RASTER_QUADS of the row, from `first` on. */
static inline void play_sample_row(const raster_tile *tile, const amb_draw *draw, raster_queue *queue,
                                   const sample_group *g, int first, int most)
{
    const small_group *m = &g->m;
    i32x quad = permute_i(i_load(m->quad + first), i_lane_index() >> 2), triangle = quad & 255;
    i32x x = (quad >> 8 & 255) + (i_lane_index() & 1), y = (quad >> 16 & 255) + (i_lane_index() >> 1 & 1);
    raster_quads q;
    maskx wanted = take_row(tile, m, first, most, quad, &q);
    i32x e[3];
    for (int i = 0; i < 3; i++)
        e[i] = u_as_i(i_as_u(permute_i(u_as_i(g->c[i]), triangle)) +
                      i_as_u(permute_i(m->a[i], triangle) * RASTER_SUBPIXEL) * i_as_u(x) +
                      i_as_u(permute_i(m->b[i], triangle) * RASTER_SUBPIXEL) * i_as_u(y));
    q.samples = i_set(0);
    for (int n = 0; n < tile->pass->samples; n++) {
        const i32x *offset = g->offset[n];
        i32x inside = (e[0] + permute_i(offset[0], triangle)) | (e[1] + permute_i(offset[1], triangle)) |
                      (e[2] + permute_i(offset[2], triangle));
        q.samples |= (inside >= 0) & i_set(1 << n);
    }
    q.samples &= wanted;
    const maskx cover = q.samples != 0;
    if (!m_any(cover))
        return;
    for (int i = 0; i < 3; i++) {
        e[i] += permute_i(g->on_edge[i], triangle);
        q.p[i] = sample_weight(e[i]) * permute(m->inverse_w[i], triangle);
    }
    f32x z0 = permute(m->z0, triangle), dz1 = permute(m->dz1, triangle), dz2 = permute(m->dz2, triangle);
    f32x inverse_area = permute(m->inverse_area, triangle), bias = permute(m->depth_bias, triangle);
#define DEPTH_(e1, e2) \
    f_saturate(((z0 + dz1 * (sample_weight(e1) * inverse_area)) + dz2 * (sample_weight(e2) * inverse_area)) + bias)
    q.depth = DEPTH_(e[1], e[2]);
    for (int n = 0; n < tile->pass->samples; n++)
        q.sample_depth[n] =
            DEPTH_(e[1] + permute_i(g->offset[n][1], triangle), e[2] + permute_i(g->offset[n][2], triangle));
#undef DEPTH_
    q.position = (x + tile->x0) | ((y + tile->y0) << 16);
    take_varyings(m, first, &q);
    play_quads(tile, draw, queue, &q, cover);
}

static void play_small_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue, const edge_group *edges,
                               int first, int end)
{
    sample_group g;
    i32x reach[3];
    gather_small(tile, s, edges, &g.m, first, end);
    gather_sample_edges(tile, &g, reach);
    sieve_quads(tile, &g.m, reach);
    for (int i = 0, most = first_row(queue); i < g.m.count; i += most, most = RASTER_QUADS)
        play_sample_row(tile, s->draw, queue, &g, i, most);
}

#else
static inline void play_small_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue,
                                      const edge_group *edges, int first, int end)
{
    (void)tile, (void)s, (void)queue, (void)edges, (void)first, (void)end;
}
#endif

#endif
