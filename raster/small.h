/* Small triangles, up to AMB_LANES of a draw together. Each has few quads in its box; all their quads are written in a
 * row, triangle by triangle. First a lane is a quad with the numbers of its own triangle: those without a covered pixel
 * are dropped. Then a lane is a pixel, RASTER_QUADS quads at a time. So lanes are not wasted on a block around every
 * triangle, and what a triangle costs alone is next to nothing.
 *
 * Values are those of coverage.h and fragment.h to the last bit. Part of tile_wide.c. */
#ifndef AMBIANCE_RASTER_SMALL_H
#define AMBIANCE_RASTER_SMALL_H

#include "raster/coverage.h"

#if AMB_LANES > 4

#define RASTER_GROUP_QUADS (AMB_LANES * RASTER_SMALL_BOX * RASTER_SMALL_BOX + AMB_LANES)

typedef struct small_group {
    i32x c[3], a[3], b[3]; /* edge functions, from the tile's first pixel */
    f32x bias[3], inverse_area;
    f32x z0, dz1, dz2, inverse_w[3], depth_bias;
    i32x primitive_front;
    const uint32_t *vertex;            /* the chunk's */
    int32_t at[3][AMB_LANES];          /* words from there to the varyings of each triangle's vertices */
    int count;                         /* quads */
    int32_t quad[RASTER_GROUP_QUADS];  /* triangle | x << 8 | y << 16, pixels; | covered pixels << 24, once sieved */
    int32_t place[RASTER_GROUP_QUADS]; /* floats from the tile's first to the quad's plane 0 */
    int32_t index[RASTER_GROUP_QUADS]; /* of the quad in its tile */
} small_group;

/* The quads that a triangle's box touches inside the tile, first and last. */
typedef struct quad_box {
    i32x x0, y0, x1, y1;
} quad_box;

static inline quad_box quads_in_tile(const raster_tile *tile, const edge_group *g)
{
    i32x low = i_load((const int32_t *)(const void *)g->low), high = i_load((const int32_t *)(const void *)g->high);
    const i32x side = i_set(tile->pass->tile_size - 1), zero = i_set(0);
    return (quad_box){i_max((low & 0xffff) - tile->x0, zero) >> 1, i_max((low >> 16 & 0xffff) - tile->y0, zero) >> 1,
                      i_min((high & 0xffff) - tile->x0, side) >> 1, i_min((high >> 16 & 0xffff) - tile->y0, side) >> 1};
}

/* Which triangles of the group are played here? */
static inline uint32_t find_small(const raster_tile *tile, const raster_chunk *chunk, const edge_group *g)
{
    if (chunk->draw->lines || chunk->draw->points)
        return 0;
    quad_box box = quads_in_tile(tile, g);
    i32x width = box.x1 - box.x0, height = box.y1 - box.y0;
    return g->small & m_bits((width >= 0) & (height >= 0) & (width < RASTER_SMALL_BOX) & (height < RASTER_SMALL_BOX));
}

/* Window depth and 1/w of the triangles, as prepare_shading makes them. */
static inline void prepare_group(raster_shading *s, const edge_group *g, small_group *m, int first, int end)
{
    const f32x *z = g->z, *w = g->inverse_w;
    m->z0 = z[0], m->dz1 = z[1] - z[0], m->dz2 = z[2] - z[0];
    f32x scale = f_from_bits((254 << 23) - (f_bits(f_max(w[0], f_max(w[1], w[2]))) & 0x7f800000));
    for (int i = 0; i < 3; i++)
        m->inverse_w[i] = w[i] * scale;
    m->depth_bias = f_set(0.0f);
    if (s->draw->depth_bias == 0.0f && s->draw->depth_bias_slope == 0.0f)
        return;
    float bias[AMB_LANES] = {0};
    for (int n = first; n < end; n++) {
        for (int i = 0; i < 3; i++)
            s->number[i] = g->number[i][n];
        s->inverse_area = g->inverse_area[n];
        prepare_shading(s);
        bias[n] = s->bias;
    }
    m->depth_bias = f_load(bias);
}

/* Edges move their origin to the tile's first pixel; they stay far inside 32 bits. */
static inline void gather_edges(const raster_tile *tile, const edge_group *g, small_group *m)
{
    i32x low = i_load((const int32_t *)(const void *)g->low);
    i32x x = box_origin(low & 0xffff, tile->x0, AMB_BLOCK_W) - tile->x0,
         y = box_origin(low >> 16 & 0xffff, tile->y0, AMB_BLOCK_H) - tile->y0;
    for (int i = 0; i < 3; i++) {
        m->a[i] = i_load(g->a[i]), m->b[i] = i_load(g->b[i]);
        m->c[i] = i_load(g->c[i]) - m->a[i] * x - m->b[i] * y;
        m->bias[i] = f_load(g->bias[i]);
    }
    m->inverse_area = f_load(g->inverse_area);
    m->primitive_front = i_load((const int32_t *)(const void *)g->primitive_front);
}

/* Writes the quads of triangles first…end-1 in a row. */
static inline void list_quads(const raster_tile *tile, const edge_group *g, small_group *m, int first, int end)
{
    quad_box box = quads_in_tile(tile, g);
    i32x width = box.x1 - box.x0, height = box.y1 - box.y0;
    int32_t corner[AMB_LANES], shape[AMB_LANES], quads[AMB_LANES];
    i_store(corner, i_lane_index() | (box.x0 << 9) | (box.y0 << 17));
    i_store(shape, width + height * RASTER_SMALL_BOX);
    i_store(quads, (width + 1) * (height + 1));
    m->count = 0;
    for (int n = first; n < end; n++) { /* whole vectors are written, the next begins where this one's quads end */
        const int32_t *offset = tile->boxes[shape[n]];
        for (int k = 0; k < quads[n]; k += AMB_LANES)
            i_store(m->quad + m->count + k, i_load(offset + k) + corner[n]);
        m->count += quads[n];
    }
}

/* The pixels of the quads that their triangles cover, by edge functions of constant c: bits 24 to 27. */
static inline i32x covered_pixels(const raster_tile *tile, const small_group *m, const i32x c[3], i32x quad)
{
    i32x triangle = quad & 255, x = quad >> 8 & 255, y = quad >> 16;
    i32x outside[4] = {{0}, {0}, {0}, {0}};
    for (int i = 0; i < 3; i++) {
        i32x a = permute_i(m->a[i], triangle), b = permute_i(m->b[i], triangle);
        i32x e = permute_i(c[i], triangle) + a * x + b * y;
        outside[0] |= e, outside[1] |= e + a, outside[2] |= e + b, outside[3] |= (e + a) + b;
    }
    if (tile->clipped)
        for (int i = 0; i < 4; i++) {
            i32x px = x + (i & 1), py = y + (i >> 1);
            maskx in = (px >= tile->clip_x0) & (px < tile->clip_x1) & (py >= tile->clip_y0) & (py < tile->clip_y1);
            outside[i] |= i_sel(in, i_set(0), i_set(-1));
        }
    i32x covered = i_set(0);
    for (int i = 0; i < 4; i++)
        covered |= ((i32x)((u32x)~outside[i] >> 31)) << (24 + i);
    return covered;
}

/* Where quads lie in the tile: plane 0, and their number. */
static inline void locate_quads(const raster_tile *tile, i32x quad, int32_t *place, int32_t *index)
{
    i32x x = quad >> 8 & 255, y = quad >> 16 & 255;
#if AMB_LANES == 16
    i32x block = (y >> 2) * tile->blocks_x + (x >> 2), part = (y & 2) | (x >> 1 & 1);
#else
    i32x block = (y >> 1) * tile->blocks_x + (x >> 2), part = x >> 1 & 1;
#endif
    i_store(place, block * (block_planes(tile) * AMB_LANES) + part * (4 * tile->pass->samples));
    i_store(index, block * RASTER_QUADS + part);
}

/* Keeps the quads of which a pixel is covered, by edge functions of constant c: a lane a quad. */
static inline void sieve_quads(const raster_tile *tile, small_group *m, const i32x c[3])
{
    int kept = 0;
    for (int first = 0; first < m->count; first += AMB_LANES) {
        i32x quad = i_load(m->quad + first), covered = covered_pixels(tile, m, c, quad);
        maskx some = (covered != 0) & (i_lane_index() < m->count - first);
        quad = i_compress(quad | covered, some);
        i_store(m->quad + kept, quad); /* never past what was read */
        locate_quads(tile, quad, m->place + kept, m->index + kept);
        kept += __builtin_popcount(m_bits(some));
    }
    m->count = kept;
    /* What a row reads past them is a quad without covered pixels. */
    i_store(m->quad + kept, i_set(0));
    i_store(m->place + kept, i_set(0));
    i_store(m->index + kept, i_set(0));
}

/* The quads from `first` on whose covered pixels are not waiting, in the queue or before them in the row: their lanes.
 * Marks the live ones as waiting. */
static inline uint32_t take_quads(raster_queue *queue, const raster_quads *q, uint32_t covered, uint32_t live)
{
    for (int i = 0; i < RASTER_QUADS; i++) {
        uint8_t *waiting = &queue->waiting[q->index[i]];
        if ((*waiting & covered >> 4 * i & 15u) != 0)
            return (1u << 4 * i) - 1u;
        *waiting |= (uint8_t)(live >> 4 * i & 15u);
    }
    return AMB_ALL_LANES;
}

/* The covered lanes that pass the early tests. */
static inline uint32_t test_early(const raster_tile *tile, const amb_draw *draw, const raster_quads *q,
                                  uint32_t covered)
{
    if (tests_late(draw))
        return covered;
    return covered & m_bits(output_tests(tile, draw, &q->at, q->primitive_front < 0, q->depth, RASTER_PACKED));
}

/* Tests and writes the lanes for good, without a shader. */
static inline void update_quads(const raster_tile *tile, const amb_draw *draw, const raster_quads *q, maskx live)
{
    update_depth_stencil(tile, draw, &q->at, q->primitive_front < 0, q->depth, live, RASTER_PACKED);
}

/* play_quads where one pixel is covered twice: quad by quad as far as needed. */
static __attribute__((noinline)) void play_in_order(const raster_tile *tile, const amb_draw *draw, raster_queue *queue,
                                                    const raster_quads *q, uint32_t covered)
{
    for (uint32_t taken; covered != 0; covered &= ~taken) {
        uint32_t live = draw->fragment ? test_early(tile, draw, q, covered) : covered;
        taken = take_quads(queue, q, covered, live);
        live &= taken;
        if (!draw->fragment) {
            update_quads(tile, draw, q, m_from_bits(live));
            for (int i = 0; i < RASTER_QUADS; i++)
                queue->waiting[q->index[i]] = 0;
        } else if (live != 0) {
            queue_quads(tile, queue, q, live);
        }
        if (taken != AMB_ALL_LANES)
            flush_queue(tile, queue);
    }
}

/* Is a pixel covered by two quads of the row, or already waiting? */
static inline bool meets_others(const raster_queue *queue, const raster_quads *q, maskx cover)
{
    i32x pixel = i_sel(cover, q->position, ~i_lane_index()); /* one's own where not covered */
#if AMB_LANES == 16
    maskx same = (pixel == (i32x)_mm512_shuffle_i32x4((__m512i)pixel, (__m512i)pixel, 0x39)) |
                 (pixel == (i32x)_mm512_shuffle_i32x4((__m512i)pixel, (__m512i)pixel, 0x4e));
#else
    maskx same = pixel == (i32x)_mm256_permute2x128_si256((__m256i)pixel, (__m256i)pixel, 1);
#endif
    if (m_any(same))
        return true;
    if (queue->count == 0)
        return false;
    uint32_t waiting = 0;
    for (uint32_t i = 0; i < RASTER_QUADS; i++)
        waiting |= (uint32_t)queue->waiting[q->index[i]] << 4 * i;
    return (waiting & m_bits(cover)) != 0;
}

/* Tests, shades or queues the covered lanes, in order where one pixel is covered twice. */
static inline void play_quads(const raster_tile *tile, const amb_draw *draw, raster_queue *queue, raster_quads *q,
                              maskx cover)
{
    if (meets_others(queue, q, cover)) {
        play_in_order(tile, draw, queue, q, m_bits(cover));
        return;
    }
    if (!draw->fragment) {
        update_quads(tile, draw, q, cover);
        return;
    }
    uint32_t live = test_early(tile, draw, q, m_bits(cover));
    if (queue->count == 0 && all_quads_live(live))
        shade_quads(tile, draw, q, live);
    else if (live != 0)
        queue_quads(tile, queue, q, live);
}

/* What the row's quads from `first` on have of their own, and which lanes of the first `most` may be covered. */
static inline maskx take_row(const raster_tile *tile, const small_group *m, int first, int most, i32x quad,
                             raster_quads *q)
{
    for (int i = 0; i < RASTER_QUADS; i++) {
        q->index[i] = (uint16_t)m->index[first + i];
        q->at.quad[i] = tile->data + m->place[first + i];
    }
    i32x pixel = i_set(1 << 24) << (i_lane_index() & 3);
    return ((quad & pixel) != 0) & (i_lane_index() < 4 * most);
}

/* What the pixels of a row of RASTER_QUADS quads have at their centres, and for a shader. */
static inline void place_row(const raster_tile *tile, const small_group *m, const int32_t *row, bool shaded,
                             raster_quads *q)
{
    i32x quad = permute_i(i_load(row), i_lane_index() >> 2), triangle = quad & 255;
    i32x x = (quad >> 8 & 255) + (i_lane_index() & 1), y = (quad >> 16 & 255) + (i_lane_index() >> 1 & 1);
    q->position = (x + tile->x0) | ((y + tile->y0) << 16);
    q->primitive_front = permute_i(m->primitive_front, triangle);
    f32x weight[3];
    for (int i = 0; i < 3; i++)
        weight[i] =
            i_to_f(permute_i(m->c[i], triangle) + permute_i(m->a[i], triangle) * x + permute_i(m->b[i], triangle) * y) +
            permute(m->bias[i], triangle);
    f32x inverse_area = permute(m->inverse_area, triangle);
    q->depth = f_saturate(((permute(m->z0, triangle) + permute(m->dz1, triangle) * (weight[1] * inverse_area)) +
                           permute(m->dz2, triangle) * (weight[2] * inverse_area)) +
                          permute(m->depth_bias, triangle));
    if (!shaded)
        return;
    for (int k = 0; k < 3; k++) {
        q->p[k] = weight[k] * permute(m->inverse_w[k], triangle);
        for (int i = 0; i < RASTER_QUADS; i++)
            q->varying[k][i] = (const float *)(const void *)(m->vertex + m->at[k][row[i] & 255]);
    }
}

/* The first `most` of RASTER_QUADS of the row, from `first` on. */
static inline void play_row(const raster_tile *tile, const amb_draw *draw, raster_queue *queue, const small_group *m,
                            int first, int most)
{
    raster_quads q;
    i32x quad = permute_i(i_load(m->quad + first), i_lane_index() >> 2);
    maskx cover = take_row(tile, m, first, most, quad, &q);
    place_row(tile, m, m->quad + first, draw->fragment != NULL, &q);
    play_quads(tile, draw, queue, &q, cover);
}

/* Lists the quads of triangles first…end-1 of the group, all of them small. */
static inline void gather_small(const raster_tile *tile, raster_shading *s, const edge_group *g, small_group *m,
                                int first, int end)
{
    gather_edges(tile, g, m);
    prepare_group(s, g, m, first, end);
    m->vertex = s->chunk->vertex;
    for (int k = 0; k < 3; k++)
        i_store(m->at[k],
                i_load((const int32_t *)(const void *)g->number[k]) * (int32_t)s->chunk->stride + RASTER_VERTEX_WORDS);
    list_quads(tile, g, m, first, end);
}

/* How many quads the first row takes: they fill the queue, so that the next are shaded as they lie. */
static inline int first_row(const raster_queue *queue) { return RASTER_QUADS - queue->count; }

static void play_small(const raster_tile *tile, raster_shading *s, raster_queue *queue, const edge_group *g, int first,
                       int end)
{
    small_group m;
    gather_small(tile, s, g, &m, first, end);
    sieve_quads(tile, &m, m.c);
    for (int i = 0, most = first_row(queue); i < m.count; i += most, most = RASTER_QUADS)
        play_row(tile, s->draw, queue, &m, i, most);
}

#else
static inline uint32_t find_small(const raster_tile *tile, const raster_chunk *chunk, const edge_group *g)
{
    (void)tile, (void)chunk, (void)g;
    return 0;
}
static inline void play_small(const raster_tile *tile, raster_shading *s, raster_queue *queue, const edge_group *g,
                              int first, int end)
{
    (void)tile, (void)s, (void)queue, (void)g, (void)first, (void)end;
}
#endif

#endif
