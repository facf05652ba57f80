/* One group of AMB_LANES pixels: early tests, interpolation, the fragment shader, and what output.h does after it. Part
 * of tile_wide.c, which finds the covered blocks.
 *
 * A block whose quads are all live is shaded as it is. Of others the live quads wait in a queue until quads of further
 * triangles fill the lanes: small triangles would waste most of them otherwise. A quad keeps its own helper lanes, so
 * derivatives, and bits, do not depend on the packing. */
#ifndef AMBIANCE_RASTER_FRAGMENT_H
#define AMBIANCE_RASTER_FRAGMENT_H

#include "raster/clock.h"
#include "raster/samples.h"

/* What shading needs of a triangle; rebuilt per tile, the same numbers in each, and only when a block is covered. */
typedef struct raster_shading {
    const raster_chunk *chunk;
    const amb_draw *draw;
    uint32_t number[3]; /* vertices */
    uint32_t primitive_front;
    float inverse_area; /* of the edge functions' sum */
    bool prepared;      /* from here to affine */
    const raster_vertex *vertex[3];
    float z0, dz1, dz2;
    float inverse_w[3]; /* scaled by a power of two so that the largest is in [1, 2) */
    float bias;         /* of depth */
    bool attributes;    /* base and delta are filled */
    float base[AMB_MAX_VARYINGS + 16], delta1[AMB_MAX_VARYINGS + 16], delta2[AMB_MAX_VARYINGS + 16];
} raster_shading;

/* D3D11's depth bias for floating-point depth. */
static inline float depth_bias(const raster_shading *s)
{
    const amb_draw *draw = s->draw;
    const raster_chunk *chunk = s->chunk;
    const raster_vertex *const *v = s->vertex;
    float most = amb_s_max(amb_s_max(s->vertex[0]->z, s->vertex[1]->z), s->vertex[2]->z), unit, slope = 0.0f;
    uint32_t bits;
    memcpy(&bits, &most, sizeof bits);
    uint32_t exponent = bits >> 23 & 255u;
    bits = exponent > 23 ? (exponent - 23u) << 23 : 0; /* 2^(e - 23) */
    memcpy(&unit, &bits, sizeof unit);
    if (!chunk->draw->lines && !chunk->draw->points) {
        /* Edge functions 1 and 2 change by a per pixel to the right and b per pixel down. */
        float a1 = (float)(v[2]->y - v[0]->y), b1 = (float)(v[0]->x - v[2]->x);
        float a2 = (float)(v[0]->y - v[1]->y), b2 = (float)(v[1]->x - v[0]->x);
        float dx = (s->dz1 * a1 + s->dz2 * a2) * s->inverse_area, dy = (s->dz1 * b1 + s->dz2 * b2) * s->inverse_area;
        dx = dx < 0.0f ? -dx : dx, dy = dy < 0.0f ? -dy : dy;
        slope = amb_s_max(dx, dy);
    }
    float bias = draw->depth_bias * unit + draw->depth_bias_slope * slope;
    if (draw->depth_bias_clamp > 0.0f)
        bias = amb_s_min(bias, draw->depth_bias_clamp);
    if (draw->depth_bias_clamp < 0.0f)
        bias = amb_s_max(bias, draw->depth_bias_clamp);
    return bias;
}

static inline void prepare_shading(raster_shading *s)
{
    const raster_vertex *v[3];
    for (int i = 0; i < 3; i++)
        s->vertex[i] = v[i] = raster_vertex_at(s->chunk, s->number[i]);
    s->z0 = v[0]->z;
    s->dz1 = v[1]->z - v[0]->z;
    s->dz2 = v[2]->z - v[0]->z;
    float w0 = v[0]->inverse_w, w1 = v[1]->inverse_w, w2 = v[2]->inverse_w;
    float most = amb_s_max(w0, amb_s_max(w1, w2)), scale;
    uint32_t bits;
    memcpy(&bits, &most, sizeof bits);
    bits = (254u << 23) - (bits & 0x7f800000u); /* 1/w is below 2¹²⁷: a normal number remains */
    memcpy(&scale, &bits, sizeof scale);
    s->inverse_w[0] = w0 * scale, s->inverse_w[1] = w1 * scale, s->inverse_w[2] = w2 * scale;
    s->bias = 0.0f;
    if (s->draw->depth_bias != 0.0f || s->draw->depth_bias_slope != 0.0f)
        s->bias = depth_bias(s);
    s->attributes = false;
    s->prepared = true;
}

static inline void run_shader(const raster_tile *tile, const amb_draw *draw, const amb_fs_in *in, amb_fs_out *out)
{
    out->depth = in->depth;
    out->live = in->live;
    out->color[0] = out->color[1] = (v4x){0}; /* also a second source of blending, or an alpha that means coverage */
    for (int i = 2; i < tile->pass->target_count; i++)
        out->color[i] = (v4x){0};
    const bool timed = tile->pass->target.time_stages;
    const uint64_t start = raster_start(timed);
    draw->fragment(in, out);
    raster_lap(timed, tile->stats, AMB_STAGE_FRAGMENTS, start);
    out->live &= in->live;
    if (draw->writes_depth)
        out->depth = f_saturate(out->depth);
    else
        out->depth = in->depth;
    tile->stats->blocks_shaded++;
    tile->stats->fragments_shaded += (uint64_t)__builtin_popcount(m_bits(in->live));
}

/* Runs the fragment shader and everything after it on the lanes of in->live. */
static inline void shade_group(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, amb_fs_in *in,
                               bool late, raster_layout how)
{
    amb_fs_out out;
    run_shader(tile, draw, in, &out);
    maskx live = out.live;
    const bool timed = tile->pass->target.time_stages;
    const uint64_t start = raster_start(timed);
    if (draw->alpha_to_coverage)
        live &= out.color[0].w >= 0.5f;
    if (late || draw->stencil.on)
        live = update_depth_stencil(tile, draw, at, in->front, out.depth, live, how);
    else if (!draw->depth_write_off)
        store_plane(tile, at, 0, out.depth, live, how);
    if (m_any(live))
        store_colors(tile, draw, at, &out, live, how);
    raster_lap(timed, tile->stats, AMB_STAGE_OUTPUT, start);
}

/* The same where pixels have samples: those of at->mask. depth: of each, quad by quad. */
static inline void shade_samples(const raster_tile *tile, const amb_draw *draw, raster_pixels *at, amb_fs_in *in,
                                 const f32x *depth)
{
    amb_fs_out out;
    run_shader(tile, draw, in, &out);
    const bool timed = tile->pass->target.time_stages;
    const uint64_t start = raster_start(timed);
    write_samples(tile, draw, at, in->front, &out, depth);
    raster_lap(timed, tile->stats, AMB_STAGE_OUTPUT, start);
}

/* Gives the covered lanes of a block, minus those that fail an early test. */
static inline maskx live_lanes(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, maskx covered,
                               f32x depth, maskx front, bool late)
{
    if (!draw->fragment) {
        if (m_any(covered))
            update_depth_stencil(tile, draw, at, front, depth, covered, RASTER_BLOCK);
        return m_set(false);
    }
    return late ? covered : covered & output_tests(tile, draw, at, front, depth, RASTER_BLOCK);
}

/* Window coordinates of pixels packed as x | y << 16. */
static inline void set_position(amb_fs_in *in, i32x position)
{
    in->x = i_to_f(position & 0xffff) + 0.5f;
    in->y = i_to_f(u_as_i(i_as_u(position) >> 16)) + 0.5f;
}

static inline i32x block_position(const raster_tile *tile, int bx, int by)
{
    return (i_set(tile->x0 + bx * AMB_BLOCK_W) + i_block_x()) |
           ((i_set(tile->y0 + by * AMB_BLOCK_H) + i_block_y()) << 16);
}

static inline bool all_quads_live(uint32_t live)
{
    live |= live >> 1;
    live |= live >> 2;
    return (live & (AMB_ALL_LANES / 15u)) == AMB_ALL_LANES / 15u;
}

/* ---- the queue of quads ----------------------------------------------------------------------------------------- */

/* Quads anywhere in the tile, each of any triangle of the draw. */
typedef struct raster_quads {
    raster_pixels at;
    uint16_t index[RASTER_QUADS];          /* of the quad in its tile */
    const float *varying[3][RASTER_QUADS]; /* of its three vertices */
    f32x p[3], depth;                      /* perspective weights before division */
    i32x position, primitive_front;
    f32x sample_depth[RASTER_QUADS * RASTER_SAMPLE_GROUPS]; /* where pixels have samples: quad by quad, closely */
} raster_quads;

typedef struct raster_queue {
    const amb_draw *draw;
    int count;     /* quads waiting, below RASTER_QUADS */
    uint32_t live; /* bits of their lanes */
    raster_quads quads;
    union {                                                     /* by quad of the tile */
        uint8_t waiting[RASTER_MAX_TILE * RASTER_MAX_TILE / 4]; /* bits of the pixels that wait */
        uint32_t waiting_samples[RASTER_MAX_TILE * RASTER_MAX_TILE / 4];
    };
} raster_queue;

/* Lane `component` of every quad, to all lanes of the quad. */
#if AMB_LANES == 16
#define QUAD_SPLAT(a, component) ((f32x)_mm512_permute_ps((__m512)(a), 0x55 * (component)))
#elif AMB_LANES == 8
#define QUAD_SPLAT(a, component) ((f32x)_mm256_permute_ps((__m256)(a), 0x55 * (component)))
#else
#define QUAD_SPLAT(a, component) AMB_QUAD_(a, component, component, component, component)
#endif

/* The varyings of quads of different triangles. Records are padded, so that four floats can always be read. */
static inline void interpolate_quads(const raster_quads *q, int floats, f32x b1, f32x b2, f32x *varying)
{
    for (int i = 0; i < floats; i += 4) {
        f32x base = load_quads(q->varying[0], (size_t)i);
        f32x delta1 = load_quads(q->varying[1], (size_t)i) - base;
        f32x delta2 = load_quads(q->varying[2], (size_t)i) - base;
#define COMPONENT(k) varying[i + k] = (QUAD_SPLAT(base, k) + QUAD_SPLAT(delta1, k) * b1) + QUAD_SPLAT(delta2, k) * b2
        COMPONENT(0);
        COMPONENT(1);
        COMPONENT(2);
        COMPONENT(3);
#undef COMPONENT
    }
}

/* The quads of a block of one triangle, but where they lie. e: the edge functions. */
static inline void block_quads(raster_quads *q, const raster_shading *s, const f32x e[3], f32x depth, i32x position)
{
    for (int i = 0; i < 3; i++)
        q->p[i] = e[i] * s->inverse_w[i];
    q->depth = depth;
    q->position = position;
    q->primitive_front = i_set((int32_t)s->primitive_front);
    for (int i = 0; i < RASTER_QUADS; i++)
        for (int k = 0; k < 3; k++)
            q->varying[k][i] = s->vertex[k]->varying;
}
static __attribute__((noinline)) void shade_quads(const raster_tile *tile, const amb_draw *draw, raster_quads *q,
                                                  uint32_t live)
{
    f32x varying[AMB_MAX_VARYINGS + 4];
    amb_fs_in in = {.uniforms = draw->uniforms, .varyings = varying, .depth = q->depth};
    in.live = m_from_bits(live);
    in.front = q->primitive_front < 0;
    in.primitive = q->primitive_front & INT32_MAX;
    in.thread = tile->thread;
    set_position(&in, q->position);
    f32x scale = 1.0f / ((q->p[0] + q->p[1]) + q->p[2]);
    interpolate_quads(q, draw->varying_floats, q->p[1] * scale, q->p[2] * scale, varying);
    if (tile->pass->samples > 1)
        shade_samples(tile, draw, &q->at, &in, q->sample_depth);
    else
        shade_group(tile, draw, &q->at, &in, tests_late(draw), RASTER_PACKED);
}

#if AMB_LANES > 4
static inline f32x permute(f32x a, i32x index)
{
#if AMB_LANES == 16
    return (f32x)_mm512_permutexvar_ps((__m512i)index, (__m512)a);
#else
    return (f32x)_mm256_permutevar8x32_ps((__m256)a, (__m256i)index);
#endif
}
static inline i32x permute_i(i32x a, i32x index) { return f_bits(permute(f_from_bits(a), index)); }

/* The kept lanes moved together, in order; others after them. */
static inline i32x i_compress(i32x a, maskx kept)
{
#if AMB_LANES == 16
    return (i32x)_mm512_maskz_compress_epi32((__mmask16)m_bits(kept), (__m512i)a);
#else
    uint64_t bytes = _pdep_u64(m_bits(kept), 0x0101010101010101u) * 0xff; /* of the numbers of lanes */
    __m128i index = _mm_cvtsi64_si128((int64_t)_pext_u64(0x0706050403020100u, bytes));
    return permute_i(a, (i32x)_mm256_cvtepu8_epi32(index));
#endif
}

/* Shades the waiting quads. */
static __attribute__((noinline)) void flush_queue(const raster_tile *tile, raster_queue *queue)
{
    if (queue->count == 0)
        return;
    raster_quads *q = &queue->quads;
    for (int i = 0; i < queue->count; i++)
        if (tile->pass->samples > 1)
            queue->waiting_samples[q->index[i]] = 0;
        else
            queue->waiting[q->index[i]] = 0;
    for (int i = queue->count; i < RASTER_QUADS; i++) { /* dead lanes: any valid memory */
        q->at.quad[i] = tile->spare;
        q->at.mask[i] = 0;
        for (int k = 0; k < 3; k++)
            q->varying[k][i] = q->varying[k][0];
    }
    shade_quads(tile, queue->draw, q, queue->live);
    queue->count = 0;
    queue->live = 0;
}

/* Is one of the block's covered pixels waiting? Then its turn must come first. */
static inline void flush_overlap(const raster_tile *tile, raster_queue *queue, uint32_t first_quad, uint32_t covered)
{
    uint32_t waiting = 0;
    for (uint32_t i = 0; i < RASTER_QUADS; i++)
        waiting |= (uint32_t)queue->waiting[first_quad + i] << 4 * i;
    if ((waiting & covered) != 0)
        flush_queue(tile, queue);
}

/* What belongs to a quad's samples. */
static inline void queue_samples(const raster_tile *tile, raster_queue *queue, const raster_quads *from, int quad,
                                 int slot)
{
    raster_quads *to = &queue->quads;
    const int groups = tile->sample_groups;
    to->at.stride = from->at.stride;
    to->at.mask[slot] = from->at.mask[quad];
    queue->waiting_samples[from->index[quad]] |= from->at.mask[quad];
    for (int g = 0; g < groups; g++)
        to->sample_depth[slot * groups + g] = from->sample_depth[quad * groups + g];
}

/* Puts those of the quads that have a live lane into the queue. None of their live pixels waits already. */
static inline void queue_quads(const raster_tile *tile, raster_queue *queue, const raster_quads *from, uint32_t live)
{
    uint32_t wanted = 0;
    for (int i = 0; i < RASTER_QUADS; i++)
        wanted |= (uint32_t)((live >> 4 * i & 15u) != 0) << i;
    raster_quads *to = &queue->quads;
    while (wanted != 0) {
        int first = queue->count;
        i32x index = i_load(tile->packing + (size_t)(wanted * RASTER_QUADS + (uint32_t)first) * AMB_LANES);
        maskx taken = i_lane_index() >= 4 * first;
        for (int k = 0; k < 3; k++)
            to->p[k] = f_sel(taken, permute(from->p[k], index), to->p[k]);
        to->depth = f_sel(taken, permute(from->depth, index), to->depth);
        to->position = i_sel(taken, permute_i(from->position, index), to->position);
        to->primitive_front = i_sel(taken, permute_i(from->primitive_front, index), to->primitive_front);
        for (; wanted != 0 && queue->count < RASTER_QUADS; wanted &= wanted - 1) {
            int quad = __builtin_ctz(wanted), slot = queue->count++;
            uint32_t pixels = live >> 4 * quad & 15u;
            queue->live |= pixels << 4 * slot;
            if (tile->pass->samples > 1)
                queue_samples(tile, queue, from, quad, slot);
            else
                queue->waiting[from->index[quad]] |= (uint8_t)pixels;
            to->index[slot] = from->index[quad];
            to->at.quad[slot] = from->at.quad[quad];
            for (int k = 0; k < 3; k++)
                to->varying[k][slot] = from->varying[k][quad];
        }
        if (queue->count == RASTER_QUADS)
            flush_queue(tile, queue);
    }
}

#else
static inline void flush_queue(const raster_tile *tile, raster_queue *queue) { (void)tile, (void)queue; }
#endif

/* ---- blocks ----------------------------------------------------------------------------------------------------- */

/* Differences from vertex 0: varying = base + delta1·b1 + delta2·b2. */
static inline void make_attributes(raster_shading *s)
{
    const float *a = s->vertex[0]->varying, *b = s->vertex[1]->varying, *c = s->vertex[2]->varying;
    int floats = s->draw->varying_floats;
    for (int i = 0; i < floats; i++) {
        s->base[i] = a[i];
        s->delta1[i] = b[i] - a[i];
        s->delta2[i] = c[i] - a[i];
    }
    s->attributes = true;
}

/* The varyings of a block of one triangle. */
static inline void interpolate_block(raster_shading *s, const f32x p[3], f32x *varying)
{
    int floats = s->draw->varying_floats;
    if (floats > 0 && !s->attributes)
        make_attributes(s);
    f32x scale = 1.0f / ((p[0] + p[1]) + p[2]), b1 = p[1] * scale, b2 = p[2] * scale;
    for (int i = 0; i < floats; i++)
        varying[i] = (s->base[i] + s->delta1[i] * b1) + s->delta2[i] * b2;
}

/* Depth from the edge functions. */
static inline f32x depth_at(const raster_shading *s, const f32x e[3])
{
    return f_saturate(((s->z0 + s->dz1 * (e[1] * s->inverse_area)) + s->dz2 * (e[2] * s->inverse_area)) + s->bias);
}

/* A block of which the samples in q->at.mask are covered, of depth q->sample_depth. e: the edge functions at the
 * pixels' centres. */
static inline void fragment_samples(const raster_tile *tile, raster_shading *s, raster_queue *queue, int bx, int by,
                                    raster_quads *q, const f32x e[3])
{
    const amb_draw *draw = s->draw;
    const maskx front = m_set(s->primitive_front >> 31 != 0);
    const uint32_t first_quad = (uint32_t)(by * tile->blocks_x + bx) * RASTER_QUADS;
    block_samples(tile, bx, by, &q->at);
    keep_pixels(&q->at, m_bits(inside_clip(tile, bx, by)));
    if (!draw->fragment) {
        update_samples(tile, draw, &q->at, front, q->sample_depth);
        return;
    }
#if AMB_LANES > 4
    uint32_t met = 0;
    for (uint32_t i = 0; i < RASTER_QUADS; i++) {
        q->index[i] = (uint16_t)(first_quad + i);
        met |= queue->waiting_samples[first_quad + i] & q->at.mask[i];
    }
    if (met != 0)
        flush_queue(tile, queue);
#else
    (void)queue, (void)first_quad;
#endif
    if (!tests_late(draw))
        test_samples(tile, draw, &q->at, front, q->sample_depth);
    const uint32_t live = pixels_of_samples(&q->at);
    if (live == 0)
        return;
    block_quads(q, s, e, depth_at(s, e), block_position(tile, bx, by));
#if AMB_LANES > 4
    if (!all_quads_live(live)) {
        queue_quads(tile, queue, q, live);
        return;
    }
#endif
    shade_quads(tile, draw, q, live);
}

/* A covered block of a triangle. e: the three edge functions at the lanes' pixel centres, in units of 1/256 of the
 * exact integer; each is the weight of the vertex opposite. Inside the triangle all are ≥ 0, so nothing cancels: the
 * error of a varying stays within a few units in the last place of the largest of its three vertices' values. */
static inline void fragment_triangle(const raster_tile *tile, raster_shading *s, raster_queue *queue, int bx, int by,
                                     maskx cover, const f32x e[3])
{
    const amb_draw *draw = s->draw;
    const raster_pixels at = {.quad = {block_at(tile, bx, by)}};
    if (!s->prepared)
        prepare_shading(s);
    if (tile->pass->samples > 1) { /* a line or a point: all samples of its pixels */
        raster_quads q;
        spread_depth(tile, depth_at(s, e), q.sample_depth);
        take_pixels(tile, &q.at, m_bits(cover));
        fragment_samples(tile, s, queue, bx, by, &q, e);
        return;
    }
    maskx covered = cover & inside_clip(tile, bx, by), front = m_set(s->primitive_front >> 31 != 0);
#if AMB_LANES > 4
    const uint32_t first_quad = (uint32_t)(by * tile->blocks_x + bx) * RASTER_QUADS;
    flush_overlap(tile, queue, first_quad, m_bits(covered));
#else
    (void)queue;
#endif
    f32x depth = depth_at(s, e);
    const bool late = tests_late(draw);
    maskx live = live_lanes(tile, draw, &at, covered, depth, front, late);
    uint32_t bits = m_bits(live);
    if (bits == 0)
        return;
#if AMB_LANES > 4
    if (!all_quads_live(bits)) {
        raster_quads q;
        block_quads(&q, s, e, depth, block_position(tile, bx, by));
        for (uint32_t i = 0; i < RASTER_QUADS; i++) {
            q.at.quad[i] = at.quad[0] + 4 * i;
            q.index[i] = (uint16_t)(first_quad + i);
        }
        queue_quads(tile, queue, &q, bits);
        return;
    }
#endif
    amb_fs_in in = {.uniforms = draw->uniforms, .depth = depth, .live = live, .front = front, .thread = tile->thread};
    in.primitive = i_set((int32_t)(s->primitive_front & 0x7fffffffu));
    set_position(&in, block_position(tile, bx, by));
    f32x varying[AMB_MAX_VARYINGS + 1];
    in.varyings = varying;
    const f32x p[3] = {e[0] * s->inverse_w[0], e[1] * s->inverse_w[1], e[2] * s->inverse_w[2]};
    interpolate_block(s, p, varying);
    shade_group(tile, draw, &at, &in, late, RASTER_BLOCK);
}

/* A block of a full-screen draw. */
static inline void fragment_screen(const raster_tile *tile, const amb_draw *draw, int bx, int by)
{
    raster_pixels at = {.quad = {block_at(tile, bx, by)}};
    const bool late = tests_late(draw);
    amb_fs_in in = {.uniforms = draw->uniforms, .depth = f_set(1.0f), .front = m_set(true), .thread = tile->thread};
    if (tile->pass->samples > 1) {
        f32x depth[RASTER_QUADS * RASTER_SAMPLE_GROUPS];
        spread_depth(tile, in.depth, depth);
        block_samples(tile, bx, by, &at);
        take_pixels(tile, &at, m_bits(inside_clip(tile, bx, by)));
        if (!late)
            test_samples(tile, draw, &at, in.front, depth);
        in.live = m_from_bits(pixels_of_samples(&at));
        set_position(&in, block_position(tile, bx, by));
        if (m_any(in.live))
            shade_samples(tile, draw, &at, &in, depth);
        return;
    }
    in.live = live_lanes(tile, draw, &at, inside_clip(tile, bx, by), in.depth, in.front, late);
    if (!m_any(in.live))
        return;
    set_position(&in, block_position(tile, bx, by));
    shade_group(tile, draw, &at, &in, late, RASTER_BLOCK);
}

#endif
