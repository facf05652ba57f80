/* Which samples of a tile a triangle covers: exactly the fill rule of coverage.h, at every sample's own position. Quad
 * by quad, a lane a sample: the edge functions of a quad's first pixel plus what is the same for all quads of a
 * triangle. Part of tile_wide.c. */
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

static void set_samples(raster_tile *tile)
{
    const int samples = tile->pass->samples;
    const int8_t *position = sample_positions(samples);
    tile->sample_groups = samples > RASTER_QUADS ? samples / RASTER_QUADS : 1;
    tile->all_samples = (uint32_t)((1ull << 4 * samples) - 1u);
    for (int g = 0; g < tile->sample_groups; g++) {
        int32_t x[AMB_LANES], y[AMB_LANES];
        for (int lane = 0; lane < AMB_LANES; lane++) {
            int n = (g * RASTER_QUADS + lane / 4) % samples;
            x[lane] = position[2 * n] * (RASTER_SUBPIXEL / 16), y[lane] = position[2 * n + 1] * (RASTER_SUBPIXEL / 16);
        }
        tile->sample_x[g] = i_load(x), tile->sample_y[g] = i_load(y);
    }
}

/* An edge function, exact: 256·whole + fraction at some pixel's centre, changing by 256·a and 256·b a pixel. */
typedef struct sample_edge {
    int64_t whole;
    int32_t fraction, a, b;
} sample_edge;

static inline bool owns_its_samples(int32_t a, int32_t b) { return a > 0 || (a == 0 && b > 0); }

/* What the quads of a triangle have in common, where 32 bits are enough. As in raster_edge, a sample is inside where
 * the integer is not negative, and bias makes it exact. */
typedef struct sample_triangle {
    i32x offset[3][RASTER_SAMPLE_GROUPS];
    f32x bias[3][RASTER_SAMPLE_GROUPS];
    float z0, dz1, dz2, inverse_area, depth_bias;
} sample_triangle;

/* groups, here and below: tile->sample_groups, which callers may know. */
static inline void set_sample_edge(const raster_tile *tile, int groups, sample_triangle *t, int i, int32_t a, int32_t b,
                                   int32_t fraction)
{
    const i32x pixel = (i_lane_index() & 1) * a + (i_lane_index() >> 1 & 1) * b;
    const i32x on_edge = i_set(owns_its_samples(a, b) ? 0 : 1);
    for (int g = 0; g < groups; g++) {
        i32x moved = (tile->sample_x[g] * a + tile->sample_y[g] * b) + fraction, rest = moved & 255;
        i32x excluded = i_sel(rest == 0, on_edge, i_set(0));
        t->offset[i][g] = pixel + (moved >> 8) - excluded;
        t->bias[i][g] = i_to_f(excluded) + i_to_f(rest) * (1.0f / 256.0f);
    }
}

static inline f32x sample_depths(const sample_triangle *t, f32x e1, f32x e2)
{
    return f_saturate(((t->z0 + t->dz1 * (e1 * t->inverse_area)) + t->dz2 * (e2 * t->inverse_area)) + t->depth_bias);
}

/* The samples of a quad that the triangle covers, and the depth of all of them. whole: at its first pixel. */
static inline uint32_t cover_quad(const raster_tile *tile, int groups, const sample_triangle *t, const int32_t whole[3],
                                  f32x *depth)
{
    uint32_t covered = 0;
    for (int g = 0; g < groups; g++) {
        i32x e = (t->offset[0][g] + whole[0]) | (t->offset[1][g] + whole[1]) | (t->offset[2][g] + whole[2]);
        covered |= m_bits(e >= 0) << g * AMB_LANES;
    }
    covered &= tile->all_samples;
    for (int g = 0; g < groups && covered != 0; g++)
        depth[g] = sample_depths(t, i_to_f(t->offset[1][g] + whole[1]) + t->bias[1][g],
                                 i_to_f(t->offset[2][g] + whole[2]) + t->bias[2][g]);
    return covered;
}

/* How far inside the edge is a pixel's best sample, more or less? In pixels' steps. */
static inline int64_t best_sample(const raster_tile *tile, const sample_edge *e)
{
    const int8_t *position = sample_positions(tile->pass->samples);
    int64_t most = INT64_MIN;
    for (int n = 0; n < tile->pass->samples; n++) {
        int64_t moved = (int64_t)e->a * position[2 * n] + (int64_t)e->b * position[2 * n + 1];
        most = moved > most ? moved : most;
    }
    return e->whole + ((e->fraction + most * (RASTER_SUBPIXEL / 16)) >> 8);
}

/* ---- block by block --------------------------------------------------------------------------------------------- */

/* Doubles hold what does not fit 32 bits exactly. */
typedef double f64x __attribute__((vector_size(8 * AMB_LANES)));
typedef int64_t i64x __attribute__((vector_size(8 * AMB_LANES)));

/* A triangle in a tile. */
typedef struct sample_cover {
    sample_edge edge[3]; /* from the box's first pixel */
    raster_edge best[3]; /* of each pixel's best sample */
    raster_box box;
    bool fits; /* 32 bits: otherwise offsets are in `wide` */
    sample_triangle triangle;
    f64x wide[3][RASTER_SAMPLE_GROUPS];
} sample_cover;

static inline f64x f_to_wide(f32x a) { return __builtin_convertvector(a, f64x); }

/* set_sample_edge where 32 bits are not enough. */
static void set_wide_edge(const raster_tile *tile, sample_cover *c, int i)
{
    const sample_edge *e = &c->edge[i];
    for (int g = 0; g < tile->sample_groups; g++) {
        double offset[AMB_LANES];
        float bias[AMB_LANES];
        for (int lane = 0; lane < AMB_LANES; lane++) {
            int64_t moved = (int64_t)e->a * i_lane(tile->sample_x[g], lane) +
                            (int64_t)e->b * i_lane(tile->sample_y[g], lane) + e->fraction;
            int32_t rest = (int32_t)(moved & 255), excluded = rest == 0 && !owns_its_samples(e->a, e->b);
            offset[lane] =
                (double)((int64_t)e->a * (lane & 1) + (int64_t)e->b * (lane >> 1 & 1) + (moved >> 8) - excluded);
            bias[lane] = (float)excluded + (float)rest * (1.0f / 256.0f);
        }
        memcpy(&c->wide[i][g], offset, sizeof offset);
        c->triangle.bias[i][g] = f_load(bias);
    }
}

/* cover_quad where 32 bits are not enough. */
static uint32_t cover_wide_quad(const raster_tile *tile, const sample_cover *c, const double whole[3], f32x *depth)
{
    uint32_t covered = 0;
    for (int g = 0; g < tile->sample_groups; g++) {
        f64x e[3];
        i64x outside = {0};
        for (int i = 0; i < 3; i++) {
            e[i] = c->wide[i][g] + whole[i];
            outside |= e[i] < 0.0;
        }
        covered |= m_bits(__builtin_convertvector(~outside, i32x)) << g * AMB_LANES;
        depth[g] = sample_depths(&c->triangle, __builtin_convertvector(e[1] + f_to_wide(c->triangle.bias[1][g]), f32x),
                                 __builtin_convertvector(e[2] + f_to_wide(c->triangle.bias[2][g]), f32x));
    }
    return covered & tile->all_samples;
}

/* An edge's function at the pixels' centres of a block, as a weight. x, y: the block's first pixel, from the box's. */
static inline f32x edge_over_block(const sample_edge *e, int x, int y, bool fits)
{
    int32_t excluded = e->fraction == 0 && !owns_its_samples(e->a, e->b);
    float bias = (float)excluded + (float)e->fraction * (1.0f / 256.0f);
    int64_t k = e->whole - excluded + (int64_t)e->a * x + (int64_t)e->b * y;
    if (fits)
        return i_to_f((int32_t)k + (i_block_x() * e->a + i_block_y() * e->b)) + bias;
    float value[AMB_LANES];
    for (int lane = 0; lane < AMB_LANES; lane++)
        value[lane] = (float)((double)(k + (int64_t)e->a * i_lane(i_block_x(), lane) +
                                       (int64_t)e->b * i_lane(i_block_y(), lane)) +
                              (double)bias);
    return f_load(value);
}

static void cover_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue, sample_cover *c, int bx,
                          int by)
{
    sample_triangle *t = &c->triangle;
    int x = (bx - c->box.x0) * AMB_BLOCK_W, y = (by - c->box.y0) * AMB_BLOCK_H;
    raster_quads q;
    uint32_t any = 0;
    if (!s->prepared) {
        prepare_shading(s);
        t->z0 = s->z0, t->dz1 = s->dz1, t->dz2 = s->dz2, t->inverse_area = s->inverse_area, t->depth_bias = s->bias;
    }
    for (int k = 0; k < RASTER_QUADS; k++) {
        int quad_x = x + 2 * (k & 1), quad_y = y + (k & 2);
        f32x *depth = q.sample_depth + k * tile->sample_groups;
        int32_t whole[3];
        double wide[3];
        for (int i = 0; i < 3; i++) {
            int64_t value = c->edge[i].whole + (int64_t)c->edge[i].a * quad_x + (int64_t)c->edge[i].b * quad_y;
            whole[i] = (int32_t)value, wide[i] = (double)value;
        }
        any |= q.at.mask[k] =
            c->fits ? cover_quad(tile, tile->sample_groups, t, whole, depth) : cover_wide_quad(tile, c, wide, depth);
    }
    if (any == 0)
        return;
    f32x weight[3];
    for (int i = 0; i < 3; i++)
        weight[i] = edge_over_block(&c->edge[i], x, y, c->fits);
    fragment_samples(tile, s, queue, bx, by, &q, weight);
}

/* A block's best corner is outside an edge: in 64 bits. */
static inline bool block_outside(const raster_edge best[3], int x, int y)
{
    for (int i = 0; i < 3; i++) {
        int64_t step_x = (int64_t)best[i].a * (AMB_BLOCK_W - 1), step_y = (int64_t)best[i].b * (AMB_BLOCK_H - 1);
        if (best[i].c + (int64_t)best[i].a * x + (int64_t)best[i].b * y + (step_x > 0 ? step_x : 0) +
                (step_y > 0 ? step_y : 0) <
            0)
            return true;
    }
    return false;
}

static void play_blocks(const raster_tile *tile, raster_shading *s, raster_queue *queue, sample_cover *c)
{
    const raster_box box = c->box;
    for (int by = box.y0; by <= box.y1; by++)
        for (int bx = box.x0; bx <= box.x1; bx += AMB_LANES) {
            int last = box.x1 - bx < AMB_LANES - 1 ? box.x1 - bx : AMB_LANES - 1;
            uint32_t touched = AMB_ALL_LANES, full;
            if (c->fits)
                test_row(c->best, box, bx, by, &touched, &full);
            for (touched &= (uint32_t)((2ull << last) - 1u); touched != 0; touched &= touched - 1) {
                int n = __builtin_ctz(touched);
                if (c->fits || !block_outside(c->best, (bx + n - box.x0) * AMB_BLOCK_W, (by - box.y0) * AMB_BLOCK_H))
                    cover_samples(tile, s, queue, c, bx + n, by);
            }
        }
}

/* A triangle of any size. */
static void play_multisample(const raster_tile *tile, raster_shading *s, raster_queue *queue, uint32_t low,
                             uint32_t high)
{
    sample_cover c = {.box = box_in_tile(tile, low, high)};
    if (c.box.x0 > c.box.x1)
        return;
    int32_t x[3], y[3];
    window_corners(s, x, y);
    int64_t px = ((int64_t)tile->x0 + c.box.x0 * AMB_BLOCK_W) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    int64_t py = ((int64_t)tile->y0 + c.box.y0 * AMB_BLOCK_H) * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int32_t a = y[j] - y[k], b = x[k] - x[j];
        int64_t value = a * (px - x[j]) + b * (py - y[j]);
        c.edge[i] = (sample_edge){value >> 8, (int32_t)(value & 255), a, b};
        c.best[i] = (raster_edge){.c = best_sample(tile, &c.edge[i]), .a = a, .b = b};
    }
    int64_t area = (int64_t)(x[1] - x[0]) * (y[2] - y[0]) - (int64_t)(x[2] - x[0]) * (y[1] - y[0]);
    s->inverse_area = 256.0f / (float)area;
    c.fits = fits_32_bits(x, y, c.best);
    for (int i = 0; i < 3; i++)
        if (c.fits)
            set_sample_edge(tile, tile->sample_groups, &c.triangle, i, c.edge[i].a, c.edge[i].b, c.edge[i].fraction);
        else
            set_wide_edge(tile, &c, i);
    play_blocks(tile, s, queue, &c);
}

/* ---- small triangles together, as small.h plays them ------------------------------------------------------------ */

#if AMB_LANES > 4

typedef struct sample_group {
    small_group m;
    int32_t whole[3][AMB_LANES], a[3][AMB_LANES], b[3][AMB_LANES]; /* edges, from the tile's first pixel */
    int32_t fraction[3][AMB_LANES];
    float z0[AMB_LANES], dz1[AMB_LANES], dz2[AMB_LANES], inverse_area[AMB_LANES], depth_bias[AMB_LANES];
    int32_t primitive_front[AMB_LANES];
    /* The row being gathered: live quads, which may all wait. */
    int count;
    int32_t row[AMB_LANES];
    raster_quads quads;
} sample_group;

/* Fills what depends on m. best: edges as m's, of whichever sample of a pixel lies farthest inside. */
static inline void gather_sample_edges(const raster_tile *tile, sample_group *g, i32x best[3])
{
    const int8_t *position = sample_positions(tile->pass->samples);
    const small_group *m = &g->m;
    for (int i = 0; i < 3; i++) {
        i32x a = m->a[i] * (RASTER_SUBPIXEL / 16), b = m->b[i] * (RASTER_SUBPIXEL / 16);
        i32x most = a * position[0] + b * position[1];
        for (int n = 1; n < tile->pass->samples; n++)
            most = i_max(most, a * position[2 * n] + b * position[2 * n + 1]);
        i32x fraction = f_to_i(m->bias[i] * 256.0f); /* 256: a pixel on the edge that c leaves out */
        i32x whole = m->c[i] + (fraction >> 8);
        best[i] = whole + (((fraction & 255) + most) >> 8);
        i_store(g->whole[i], whole), i_store(g->fraction[i], fraction & 255);
        i_store(g->a[i], m->a[i]), i_store(g->b[i], m->b[i]);
    }
    f_store(g->z0, m->z0), f_store(g->dz1, m->dz1), f_store(g->dz2, m->dz2);
    f_store(g->inverse_area, m->inverse_area), f_store(g->depth_bias, m->depth_bias);
    i_store(g->primitive_front, m->primitive_front);
}

static inline void set_sample_triangle(const raster_tile *tile, int groups, const sample_group *g, int n,
                                       sample_triangle *t)
{
    for (int i = 0; i < 3; i++)
        set_sample_edge(tile, groups, t, i, g->a[i][n], g->b[i][n], g->fraction[i][n]);
    t->z0 = g->z0[n], t->dz1 = g->dz1[n], t->dz2 = g->dz2[n];
    t->inverse_area = g->inverse_area[n], t->depth_bias = g->depth_bias[n];
}

/* Shades the gathered row as it lies, or queues what there is of it. */
static void play_sample_row(const raster_tile *tile, const amb_draw *draw, raster_queue *queue, sample_group *g)
{
    raster_quads *q = &g->quads;
    if (g->count == 0)
        return;
    for (int k = g->count; k < RASTER_QUADS; k++) {
        g->row[k] = g->row[0];
        q->at.mask[k] = 0;
    }
    place_row(tile, &g->m, g->row, true, q);
    uint32_t live = pixels_of_samples(&q->at);
    if (queue->count == 0 && g->count == RASTER_QUADS) {
        for (int k = 0; k < RASTER_QUADS; k++)
            queue->waiting_samples[q->index[k]] = 0;
        shade_quads(tile, draw, q, live);
    } else {
        queue_quads(tile, queue, q, live);
    }
    g->count = 0;
}

/* Tests the covered samples of a quad; the live ones go to the row, or are written where there is no shader. */
static inline void take_sample_quad(const raster_tile *tile, int groups, const amb_draw *draw, raster_queue *queue,
                                    sample_group *g, int number, uint32_t covered, const f32x *depth)
{
    const int32_t quad = g->m.quad[number], index = g->m.index[number];
    const maskx front = m_set(g->primitive_front[quad & 255] < 0);
    raster_quads *q = &g->quads;
    if ((queue->waiting_samples[index] & covered) != 0) {
        play_sample_row(tile, draw, queue, g);
        flush_queue(tile, queue);
    }
    const int k = g->count;
    q->at.quad[k] = tile->data + g->m.place[number];
    q->at.mask[k] = covered;
    if (!draw->fragment) {
        update_quad(tile, draw, &q->at, k, front, depth);
        return;
    }
    if (!tests_late(draw))
        q->at.mask[k] = test_quad(tile, groups, draw, &q->at, k, covered, front, depth);
    if (q->at.mask[k] == 0)
        return;
    for (int i = 0; i < groups; i++)
        q->sample_depth[k * groups + i] = depth[i];
    q->index[k] = (uint16_t)index;
    g->row[k] = quad;
    queue->waiting_samples[index] |= q->at.mask[k];
    if (++g->count + queue->count == RASTER_QUADS)
        play_sample_row(tile, draw, queue, g);
}

AMB_INLINE void play_grouped_samples(const raster_tile *tile, int groups, raster_shading *s, raster_queue *queue,
                                     const edge_group *edges, int first, int end)
{
    sample_group g;
    i32x best[3];
    gather_small(tile, s, edges, &g.m, first, end);
    gather_sample_edges(tile, &g, best);
    sieve_quads(tile, &g.m, best);
    g.count = 0;
    g.quads.at.stride = (size_t)tile->pass->samples * AMB_LANES;
    for (int i = 0; i < g.m.count;) {
        const int n = g.m.quad[i] & 255;
        sample_triangle t;
        set_sample_triangle(tile, groups, &g, n, &t);
        for (; i < g.m.count && (g.m.quad[i] & 255) == n; i++) {
            const int32_t quad = g.m.quad[i], x = quad >> 8 & 255, y = quad >> 16 & 255;
            int32_t whole[3];
            f32x depth[RASTER_SAMPLE_GROUPS];
            for (int k = 0; k < 3; k++)
                whole[k] = g.whole[k][n] + g.a[k][n] * x + g.b[k][n] * y;
            uint32_t covered = cover_quad(tile, groups, &t, whole, depth) & all_of_pixels((uint32_t)quad >> 24, 0);
            if (covered != 0)
                take_sample_quad(tile, groups, s->draw, queue, &g, i, covered, depth);
        }
    }
    play_sample_row(tile, s->draw, queue, &g);
}

/* Four samples, the usual number, have a form of their own. */
static void play_small_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue, const edge_group *edges,
                               int first, int end)
{
    if (tile->sample_groups == 4 / RASTER_QUADS)
        play_grouped_samples(tile, 4 / RASTER_QUADS, s, queue, edges, first, end);
    else
        play_grouped_samples(tile, tile->sample_groups, s, queue, edges, first, end);
}

#else
static inline void play_small_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue,
                                      const edge_group *edges, int first, int end)
{
    (void)tile, (void)s, (void)queue, (void)edges, (void)first, (void)end;
}
#endif

#endif
