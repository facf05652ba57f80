/* One block of AMB_LANES pixels: early depth, fragment shader, late depth, blending, masked store. Part of
 * tile_wide.c, which finds the covered blocks. */
#ifndef AMBIANCE_RASTER_FRAGMENT_H
#define AMBIANCE_RASTER_FRAGMENT_H

#include "raster/internal.h"

/* A tile being played. Its pixels lie block by block; a block holds `planes` runs of AMB_LANES floats: depth first,
 * then every channel of every attachment. */
typedef struct raster_tile {
    const amb_pass *pass;
    float *data;
    int x0, y0;        /* pixels */
    int blocks_x;      /* a row of the tile */
    int right, bottom; /* pixels of the target inside the tile */
    int thread;
    amb_pass_stats *stats;
} raster_tile;

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
    bool affine;        /* all w equal: perspective-correct weights are the screen's */
    bool attributes;    /* base and delta are filled */
    float base[AMB_MAX_VARYINGS + 16], delta1[AMB_MAX_VARYINGS + 16], delta2[AMB_MAX_VARYINGS + 16];
} raster_shading;

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
    s->attributes = false;
    s->prepared = true;
}

static inline maskx depth_passes(amb_compare compare, f32x z, f32x stored)
{
    switch (compare) {
    case AMB_LESS:
        return z < stored;
    case AMB_EQUAL:
        return z == stored;
    case AMB_LESS_EQUAL:
        return z <= stored;
    case AMB_GREATER:
        return z > stored;
    case AMB_NOT_EQUAL:
        return z != stored;
    case AMB_GREATER_EQUAL:
        return z >= stored;
    case AMB_ALWAYS:
        return m_set(true);
    default:
        return m_set(false); /* NEVER */
    }
}

static inline float *block_at(const raster_tile *tile, int bx, int by)
{
    return tile->data + (size_t)(by * tile->blocks_x + bx) * (size_t)tile->pass->planes * AMB_LANES;
}

/* Lanes inside the target. */
static inline maskx inside_target(const raster_tile *tile, int bx, int by)
{
    if ((bx + 1) * AMB_BLOCK_W <= tile->right && (by + 1) * AMB_BLOCK_H <= tile->bottom)
        return m_set(true);
    return (i_set(bx * AMB_BLOCK_W) + i_block_x() < tile->right) &
           (i_set(by * AMB_BLOCK_H) + i_block_y() < tile->bottom);
}

static inline void store_plane(float *plane, f32x value, maskx live, bool all)
{
    f_store(plane, all ? value : f_sel(live, value, f_load(plane)));
}

/* One attachment of one block. */
static inline void store_target(float *plane, int channels, amb_blend mode, const f32x source[4], maskx live, bool all)
{
    f32x rest = 1.0f - source[3];
    switch (mode) {
    case AMB_BLEND_ALPHA:
        for (int c = 0; c < channels; c++) {
            float *p = plane + c * AMB_LANES;
            store_plane(p, (c == 3 ? source[3] : source[c] * source[3]) + f_load(p) * rest, live, all);
        }
        break;
    case AMB_BLEND_ADD:
        for (int c = 0; c < channels; c++)
            store_plane(plane + c * AMB_LANES, source[c] + f_load(plane + c * AMB_LANES), live, all);
        break;
    case AMB_BLEND_MULTIPLY:
        for (int c = 0; c < channels; c++)
            store_plane(plane + c * AMB_LANES, source[c] * f_load(plane + c * AMB_LANES), live, all);
        break;
    default:
        for (int c = 0; c < channels; c++)
            store_plane(plane + c * AMB_LANES, source[c], live, all);
    }
}

static inline void store_colors(const raster_tile *tile, const amb_draw *draw, float *block, const amb_fs_out *out,
                                maskx live)
{
    const amb_pass *pass = tile->pass;
    bool all = m_all(live);
    for (int i = 0; i < pass->target_count; i++) {
        if (draw->targets_off >> i & 1u)
            continue;
        const f32x source[4] = {out->color[i].x, out->color[i].y, out->color[i].z, out->color[i].w};
        float *plane = block + (size_t)pass->channel_first[i] * AMB_LANES;
        int channels = pass->target.color[i]->channels;
        if (channels == 4) /* the usual case, unrolled */
            store_target(plane, 4, draw->blend[i], source, live, all);
        else
            store_target(plane, channels, draw->blend[i], source, live, all);
    }
}

/* Runs the fragment shader and everything after it. `live` has passed the early test unless the shader writes depth. */
static inline void shade_block(const raster_tile *tile, const amb_draw *draw, float *block, amb_fs_in *in, f32x depth)
{
    amb_fs_out out;
    out.depth = depth;
    out.live = in->live;
    for (int i = 0; i < tile->pass->target_count; i++)
        out.color[i] = (v4x){0};
    draw->fragment(in, &out);
    maskx live = in->live & out.live;
    if (draw->writes_depth) {
        depth = f_saturate(out.depth);
        live &= depth_passes(draw->depth_compare, depth, f_load(block));
    }
    tile->stats->blocks_shaded++;
    tile->stats->fragments_shaded += (uint64_t)__builtin_popcount(m_bits(in->live));
    if (!m_any(live))
        return;
    if (!draw->depth_write_off)
        store_plane(block, depth, live, false);
    store_colors(tile, draw, block, &out, live);
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
    f32x depth = f_saturate((s->z0 + s->dz1 * l1) + s->dz2 * l2);
    maskx live = cover & inside_target(tile, bx, by);
    if (!draw->writes_depth)
        live &= depth_passes(draw->depth_compare, depth, f_load(block));
    if (!m_any(live))
        return;
    if (!draw->fragment) {
        if (!draw->depth_write_off)
            f_store(block, f_sel(live, depth, f_load(block)));
        return;
    }
    f32x varying[AMB_MAX_VARYINGS + 1];
    amb_fs_in in = {.uniforms = draw->uniforms, .varyings = varying, .depth = depth, .live = live};
    in.front = m_set(s->primitive_front >> 31 != 0);
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
    shade_block(tile, draw, block, &in, depth);
}

/* A block of a full-screen draw. */
static inline void fragment_screen(const raster_tile *tile, const amb_draw *draw, int bx, int by)
{
    float *block = block_at(tile, bx, by);
    f32x depth = f_set(1.0f);
    maskx live = inside_target(tile, bx, by);
    if (!draw->writes_depth)
        live &= depth_passes(draw->depth_compare, depth, f_load(block));
    if (!m_any(live))
        return;
    amb_fs_in in = {.uniforms = draw->uniforms, .depth = depth, .live = live};
    in.front = m_set(true);
    in.thread = tile->thread;
    block_position(tile, bx, by, &in);
    shade_block(tile, draw, block, &in, depth);
}

#endif
