/* What happens to fragments after their shader: stencil and depth tests, blending, masked stores; and a tile's memory.
 * Part of tile_wide.c. */
#ifndef AMBIANCE_RASTER_OUTPUT_H
#define AMBIANCE_RASTER_OUTPUT_H

#include "raster/internal.h"

/* A tile being played. Its pixels lie block by block; a block holds `planes` runs of AMB_LANES floats: depth first,
 * stencil if there is one, then every channel of every attachment. */
typedef struct raster_tile {
    const amb_pass *pass;
    float *data;
    int x0, y0;                             /* pixels */
    int blocks_x;                           /* a row of the tile */
    int right, bottom;                      /* pixels of the target inside the tile */
    int clip_x0, clip_y0, clip_x1, clip_y1; /* of the draw: its scissor, in pixels of the tile, ends exclusive */
    int thread;
    amb_pass_stats *stats;
} raster_tile;

static inline float *block_at(const raster_tile *tile, int bx, int by)
{
    return tile->data + (size_t)(by * tile->blocks_x + bx) * (size_t)tile->pass->planes * AMB_LANES;
}

/* Lanes inside the target and the draw's scissor. */
static inline maskx inside_clip(const raster_tile *tile, int bx, int by)
{
    int x = bx * AMB_BLOCK_W, y = by * AMB_BLOCK_H;
    if (x >= tile->clip_x0 && y >= tile->clip_y0 && x + AMB_BLOCK_W <= tile->clip_x1 &&
        y + AMB_BLOCK_H <= tile->clip_y1)
        return m_set(true);
    i32x lane_x = i_set(x) + i_block_x(), lane_y = i_set(y) + i_block_y();
    return (lane_x >= tile->clip_x0) & (lane_x < tile->clip_x1) & (lane_y >= tile->clip_y0) & (lane_y < tile->clip_y1);
}

/* ---- depth and stencil ------------------------------------------------------------------------------------------ */

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

static inline maskx stencil_passes(amb_compare compare, i32x reference, i32x stored)
{
    switch (compare) {
    case AMB_NEVER:
        return m_set(false);
    case AMB_LESS:
        return reference < stored;
    case AMB_EQUAL:
        return reference == stored;
    case AMB_LESS_EQUAL:
        return reference <= stored;
    case AMB_GREATER:
        return reference > stored;
    case AMB_NOT_EQUAL:
        return reference != stored;
    case AMB_GREATER_EQUAL:
        return reference >= stored;
    default:
        return m_set(true); /* ALWAYS, DEFAULT */
    }
}

static inline i32x stencil_result(amb_stencil_op op, i32x stored, int reference)
{
    switch (op) {
    case AMB_STENCIL_ZERO:
        return i_set(0);
    case AMB_STENCIL_REPLACE:
        return i_set(reference);
    case AMB_STENCIL_INCREMENT_CLAMP:
        return i_min(stored + 1, i_set(255));
    case AMB_STENCIL_DECREMENT_CLAMP:
        return i_max(stored - 1, i_set(0));
    case AMB_STENCIL_INVERT:
        return ~stored & 255;
    case AMB_STENCIL_INCREMENT_WRAP:
        return (stored + 1) & 255;
    case AMB_STENCIL_DECREMENT_WRAP:
        return (stored - 1) & 255;
    default:
        return stored;
    }
}

static inline i32x load_stencil(const raster_tile *tile, const float *block)
{
    return f_to_i(f_load(block + (size_t)tile->pass->stencil_plane * AMB_LANES)) & 255;
}

/* Which lanes pass the draw's stencil and depth tests. */
static inline maskx output_tests(const raster_tile *tile, const amb_draw *draw, const float *block, bool front,
                                 f32x depth)
{
    maskx passed = depth_passes(draw->depth_compare, depth, f_load(block));
    if (draw->stencil.on) {
        int mask = 255 & ~draw->stencil.read_mask_off;
        passed &= stencil_passes(front ? draw->stencil.front.compare : draw->stencil.back.compare,
                                 i_set(draw->stencil.reference & mask), load_stencil(tile, block) & mask);
    }
    return passed;
}

/* Tests the live lanes for good, writes depth and stencil, and returns the lanes whose colour is to be written. */
static inline maskx update_depth_stencil(const raster_tile *tile, const amb_draw *draw, float *block, bool front,
                                         f32x depth, maskx live)
{
    const amb_stencil *stencil = &draw->stencil;
    maskx near_enough = depth_passes(draw->depth_compare, depth, f_load(block)), passed = live & near_enough;
    if (stencil->on) {
        const amb_stencil_face *face = front ? &stencil->front : &stencil->back;
        i32x stored = load_stencil(tile, block);
        int read = 255 & ~stencil->read_mask_off, write = 255 & ~stencil->write_mask_off;
        maskx match = stencil_passes(face->compare, i_set(stencil->reference & read), stored & read);
        i32x result = i_sel(near_enough, stencil_result(face->pass, stored, stencil->reference),
                            stencil_result(face->depth_fail, stored, stencil->reference));
        result = i_sel(match, result, stencil_result(face->fail, stored, stencil->reference));
        result = i_sel(live, (result & write) | (stored & ~write), stored);
        f_store(block + (size_t)tile->pass->stencil_plane * AMB_LANES, i_to_f(result));
        passed &= match;
    }
    if (!draw->depth_write_off)
        f_store(block, f_sel(passed, depth, f_load(block)));
    return passed;
}

/* ---- blending --------------------------------------------------------------------------------------------------- */

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

/* A factor of channel c. stored: the target's colour, absent channels 0 and alpha 1. */
static inline f32x blend_factor(amb_factor factor, int c, const f32x source[4], const f32x second[4],
                                const f32x stored[4], const float constant[4])
{
    switch (factor) {
    case AMB_FACTOR_ONE:
        return f_set(1.0f);
    case AMB_FACTOR_SOURCE:
        return source[c];
    case AMB_FACTOR_ONE_MINUS_SOURCE:
        return 1.0f - source[c];
    case AMB_FACTOR_SOURCE_ALPHA:
        return source[3];
    case AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA:
        return 1.0f - source[3];
    case AMB_FACTOR_TARGET:
        return stored[c];
    case AMB_FACTOR_ONE_MINUS_TARGET:
        return 1.0f - stored[c];
    case AMB_FACTOR_TARGET_ALPHA:
        return stored[3];
    case AMB_FACTOR_ONE_MINUS_TARGET_ALPHA:
        return 1.0f - stored[3];
    case AMB_FACTOR_SOURCE_ALPHA_SATURATE:
        return c == 3 ? f_set(1.0f) : f_min(source[3], 1.0f - stored[3]);
    case AMB_FACTOR_CONSTANT:
        return f_set(constant[c]);
    case AMB_FACTOR_ONE_MINUS_CONSTANT:
        return f_set(1.0f - constant[c]);
    case AMB_FACTOR_SECOND:
        return second[c];
    case AMB_FACTOR_ONE_MINUS_SECOND:
        return 1.0f - second[c];
    case AMB_FACTOR_SECOND_ALPHA:
        return second[3];
    case AMB_FACTOR_ONE_MINUS_SECOND_ALPHA:
        return 1.0f - second[3];
    default:
        return f_set(0.0f);
    }
}

static inline f32x blend_result(amb_blend_op op, f32x source, f32x source_factor, f32x stored, f32x stored_factor)
{
    switch (op) {
    case AMB_BLEND_DIFFERENCE:
        return source * source_factor - stored * stored_factor;
    case AMB_BLEND_REVERSE:
        return stored * stored_factor - source * source_factor;
    case AMB_BLEND_MIN:
        return f_min(source, stored);
    case AMB_BLEND_MAX:
        return f_max(source, stored);
    default:
        return source * source_factor + stored * stored_factor;
    }
}

/* Any equation, any channel mask. */
static __attribute__((noinline)) void store_general(float *plane, int channels, const amb_draw *draw, int target,
                                                    const amb_fs_out *out, maskx live)
{
    static const amb_blend_equation known[AMB_BLEND_EQUATION] = {
        [AMB_BLEND_ALPHA] = {AMB_FACTOR_SOURCE_ALPHA, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA, AMB_FACTOR_ONE,
                             AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA, 0, 0},
        [AMB_BLEND_ADD] = {AMB_FACTOR_ONE, AMB_FACTOR_ONE, AMB_FACTOR_ONE, AMB_FACTOR_ONE, 0, 0},
    };
    amb_blend mode = draw->blend[target];
    const amb_blend_equation *q = mode == AMB_BLEND_EQUATION ? &draw->equation[target] : &known[mode];
    const v4x *s = &out->color[target], *t = &out->color[1];
    const f32x source[4] = {s->x, s->y, s->z, s->w}, second[4] = {t->x, t->y, t->z, t->w};
    const float constant[4] = {draw->blend_constant.x, draw->blend_constant.y, draw->blend_constant.z,
                               draw->blend_constant.w};
    f32x stored[4] = {f_set(0.0f), f_set(0.0f), f_set(0.0f), f_set(1.0f)};
    for (int c = 0; c < channels; c++)
        stored[c] = f_load(plane + c * AMB_LANES);
    for (int c = 0; c < channels; c++) {
        if (draw->channels_off[target] >> c & 1)
            continue;
        amb_factor fs = c == 3 ? q->alpha_source : q->color_source, ft = c == 3 ? q->alpha_target : q->color_target;
        f32x value = mode == AMB_BLEND_OFF ? source[c]
                     : mode == AMB_BLEND_MULTIPLY
                         ? source[c] * stored[c]
                         : blend_result(c == 3 ? q->alpha_op : q->color_op, source[c],
                                        blend_factor(fs, c, source, second, stored, constant), stored[c],
                                        blend_factor(ft, c, source, second, stored, constant));
        f_store(plane + c * AMB_LANES, f_sel(live, value, stored[c]));
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
        if (draw->blend[i] == AMB_BLEND_EQUATION || draw->channels_off[i] != 0)
            store_general(plane, channels, draw, i, out, live);
        else if (channels == 4) /* the usual case, unrolled */
            store_target(plane, 4, draw->blend[i], source, live, all);
        else
            store_target(plane, channels, draw->blend[i], source, live, all);
    }
}

#endif
