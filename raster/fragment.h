/* One block of AMB_LANES pixels: early tests, interpolation, the fragment shader, and what output.h does after it. Part
 * of tile_wide.c, which finds the covered blocks. */
#ifndef AMBIANCE_RASTER_FRAGMENT_H
#define AMBIANCE_RASTER_FRAGMENT_H

#include "raster/output.h"

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
    bool affine;        /* all w equal: perspective-correct weights are the screen's */
    bool attributes;    /* base and delta are filled */
    float base[AMB_MAX_VARYINGS + 16], delta1[AMB_MAX_VARYINGS + 16], delta2[AMB_MAX_VARYINGS + 16];
} raster_shading;

/* D3D11's depth bias for floating-point depth. */
static inline float depth_bias(const raster_shading *s)
{
    const amb_draw *draw = s->draw;
    const raster_chunk *chunk = s->chunk;
    const uint32_t *v = s->number;
    float most = amb_s_max(amb_s_max(s->vertex[0]->z, s->vertex[1]->z), s->vertex[2]->z), unit, slope = 0.0f;
    uint32_t bits;
    memcpy(&bits, &most, sizeof bits);
    uint32_t exponent = bits >> 23 & 255u;
    bits = exponent > 23 ? (exponent - 23u) << 23 : 0; /* 2^(e - 23) */
    memcpy(&unit, &bits, sizeof unit);
    if (draw->topology <= AMB_TRIANGLE_FAN && !draw->wireframe) {
        /* Edge functions 1 and 2 change by a per pixel to the right and b per pixel down. */
        float a1 = (float)(chunk->y[v[2]] - chunk->y[v[0]]), b1 = (float)(chunk->x[v[0]] - chunk->x[v[2]]);
        float a2 = (float)(chunk->y[v[0]] - chunk->y[v[1]]), b2 = (float)(chunk->x[v[1]] - chunk->x[v[0]]);
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
    s->affine = w0 == w1 && w1 == w2;
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

/* Tests must wait for the shader when it makes the depth, and when a failed test would change the stencil of a fragment
 * that the shader may still discard. */
static inline bool tests_late(const amb_draw *draw)
{
    const amb_stencil *s = &draw->stencil;
    return draw->writes_depth ||
           (s->on && (s->front.fail | s->front.depth_fail | s->back.fail | s->back.depth_fail) != AMB_STENCIL_KEEP);
}

/* Runs the fragment shader and everything after it on the lanes of in->live. */
static inline void shade_block(const raster_tile *tile, const amb_draw *draw, float *block, amb_fs_in *in, f32x depth,
                               bool front, bool late)
{
    amb_fs_out out;
    out.depth = depth;
    out.live = in->live;
    for (int i = 0; i < tile->pass->target_count; i++)
        out.color[i] = (v4x){0};
    if (tile->pass->target_count < 2)
        out.color[1] = (v4x){0}; /* may be a second source of blending */
    draw->fragment(in, &out);
    maskx live = in->live & out.live;
    if (draw->writes_depth)
        depth = f_saturate(out.depth);
    tile->stats->blocks_shaded++;
    tile->stats->fragments_shaded += (uint64_t)__builtin_popcount(m_bits(in->live));
    if (late || draw->stencil.on)
        live = update_depth_stencil(tile, draw, block, front, depth, live);
    else if (!draw->depth_write_off)
        f_store(block, f_sel(live, depth, f_load(block)));
    if (m_any(live))
        store_colors(tile, draw, block, &out, live);
}

/* Gives the covered lanes of a block, minus those that fail an early test. */
static inline maskx live_lanes(const raster_tile *tile, const amb_draw *draw, float *block, int bx, int by, maskx cover,
                               f32x depth, bool front, bool late)
{
    maskx live = cover & inside_clip(tile, bx, by);
    if (!draw->fragment) {
        if (m_any(live))
            update_depth_stencil(tile, draw, block, front, depth, live);
        return m_set(false);
    }
    return late ? live : live & output_tests(tile, draw, block, front, depth);
}

static inline void block_position(const raster_tile *tile, int bx, int by, amb_fs_in *in)
{
    in->x = i_to_f(i_set(tile->x0 + bx * AMB_BLOCK_W) + i_block_x()) + 0.5f;
    in->y = i_to_f(i_set(tile->y0 + by * AMB_BLOCK_H) + i_block_y()) + 0.5f;
}

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

/* A covered block of a triangle. e: the three edge functions at the lanes' pixel centres, in units of 1/256 of the
 * exact integer; each is the weight of the vertex opposite. Inside the triangle all are ≥ 0, so nothing cancels: the
 * error of a varying stays within a few units in the last place of the largest of its three vertices' values. */
static inline void fragment_triangle(const raster_tile *tile, raster_shading *s, int bx, int by, maskx cover,
                                     const f32x e[3])
{
    const amb_draw *draw = s->draw;
    float *block = block_at(tile, bx, by);
    if (!s->prepared)
        prepare_shading(s);
    f32x l1 = e[1] * s->inverse_area, l2 = e[2] * s->inverse_area;
    f32x depth = f_saturate(((s->z0 + s->dz1 * l1) + s->dz2 * l2) + s->bias);
    const bool front = s->primitive_front >> 31 != 0, late = tests_late(draw);
    maskx live = live_lanes(tile, draw, block, bx, by, cover, depth, front, late);
    if (!m_any(live))
        return;
    f32x varying[AMB_MAX_VARYINGS + 1];
    amb_fs_in in = {.uniforms = draw->uniforms, .varyings = varying, .depth = depth, .live = live};
    in.front = m_set(front);
    in.primitive = (int)(s->primitive_front & 0x7fffffffu);
    in.thread = tile->thread;
    block_position(tile, bx, by, &in);
    int floats = draw->varying_floats;
    if (floats > 0) {
        if (!s->attributes)
            make_attributes(s);
        f32x b1 = l1, b2 = l2;
        if (!s->affine) {
            f32x p0 = e[0] * s->inverse_w[0], p1 = e[1] * s->inverse_w[1], p2 = e[2] * s->inverse_w[2];
            f32x scale = 1.0f / ((p0 + p1) + p2);
            b1 = p1 * scale, b2 = p2 * scale;
        }
        for (int i = 0; i < floats; i++)
            varying[i] = (s->base[i] + s->delta1[i] * b1) + s->delta2[i] * b2;
    }
    shade_block(tile, draw, block, &in, depth, front, late);
}

/* A block of a full-screen draw. */
static inline void fragment_screen(const raster_tile *tile, const amb_draw *draw, int bx, int by)
{
    float *block = block_at(tile, bx, by);
    f32x depth = f_set(1.0f);
    const bool late = tests_late(draw);
    maskx live = live_lanes(tile, draw, block, bx, by, m_set(true), depth, true, late);
    if (!m_any(live))
        return;
    amb_fs_in in = {.uniforms = draw->uniforms, .depth = depth, .live = live};
    in.front = m_set(true);
    in.thread = tile->thread;
    block_position(tile, bx, by, &in);
    shade_block(tile, draw, block, &in, depth, true, late);
}

#endif
