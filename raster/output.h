/* What happens to fragments after their shader: stencil and depth tests, blending, masked stores; and a tile's memory.
 * Part of tile_wide.c. */
#ifndef AMBIANCE_RASTER_OUTPUT_H
#define AMBIANCE_RASTER_OUTPUT_H

#include "core/compare_lanes.h"
#include "raster/internal.h"

#define RASTER_QUADS (AMB_LANES / 4)
#define RASTER_SAMPLE_GROUPS (RASTER_MAX_SAMPLES / RASTER_QUADS)

/* A tile being played. Its pixels lie block by block; a block holds `planes` runs of AMB_LANES floats: depth first,
 * stencil if there is one, then every channel of every attachment.
 *
 * Where pixels have samples a run is as many times longer and goes quad by quad: four pixels of sample 0, of sample 1,
 * … So a quad's samples are `sample_groups` groups of AMB_LANES lanes side by side (the last lanes may be the next
 * quad's), and in a set of samples of a quad sample n of pixel p is bit 4n + p. */
typedef struct raster_tile {
    const amb_pass *pass;
    float *data;
    int x0, y0;                             /* pixels */
    int blocks_x;                           /* a row of the tile */
    int right, bottom;                      /* pixels of the target inside the tile */
    int clip_x0, clip_y0, clip_x1, clip_y1; /* of the draw: its scissor, in pixels of the tile, ends exclusive */
    bool clipped;                           /* it leaves out some of them */
    float *spare;                           /* a block that is nobody's */
    const int32_t *packing;                 /* raster_scratch's, and */
    const int32_t (*boxes)[RASTER_SMALL_BOX * RASTER_SMALL_BOX];
    int sample_groups;                                                   /* where pixels have samples: see below */
    uint32_t all_samples;                                                /* of a quad */
    i32x sample_x[RASTER_SAMPLE_GROUPS], sample_y[RASTER_SAMPLE_GROUPS]; /* 1/256 pixel from its centre */
    int thread;
    amb_pass_stats *stats;
} raster_tile;

static inline int block_planes(const raster_tile *tile) { return tile->pass->planes * tile->pass->samples; }

static inline float *block_at(const raster_tile *tile, int bx, int by)
{
    return tile->data + (size_t)(by * tile->blocks_x + bx) * (size_t)block_planes(tile) * AMB_LANES;
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

/* ---- access ----------------------------------------------------------------------------------------------------- */

/* Where the lanes' pixels lie: plane 0 of each quad. Either a whole block, or quads from anywhere in the tile; two of
 * them may be the same quad as long as no pixel is live in both. */
typedef struct raster_pixels {
    float *quad[RASTER_QUADS];
    size_t stride;               /* where pixels have samples: floats from a plane to the next */
    uint32_t mask[RASTER_QUADS]; /* and which samples are meant */
} raster_pixels;

typedef enum raster_layout {
    RASTER_BLOCK,      /* a whole block */
    RASTER_PACKED,     /* quads */
    RASTER_ONE_QUAD,   /* a lane a sample: one of the quad's groups */
    RASTER_ALL_SAMPLES /* of quads: those in `mask`. What is stored goes to all of them; nothing can be loaded. */
} raster_layout;

AMB_INLINE f32x load_quads(const float *const quad[RASTER_QUADS], size_t offset)
{
#if AMB_LANES == 16
    __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(quad[0] + offset));
    r = _mm512_insertf32x4(r, _mm_loadu_ps(quad[1] + offset), 1);
    r = _mm512_insertf32x4(r, _mm_loadu_ps(quad[2] + offset), 2);
    return (f32x)_mm512_insertf32x4(r, _mm_loadu_ps(quad[3] + offset), 3);
#elif AMB_LANES == 8
    return (f32x)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(quad[0] + offset)),
                                      _mm_loadu_ps(quad[1] + offset), 1);
#else
    return f_load(quad[0] + offset);
#endif
}

AMB_INLINE size_t plane_offset(const raster_pixels *at, int plane, raster_layout how)
{
    return (size_t)plane * (how <= RASTER_PACKED ? AMB_LANES : at->stride);
}

AMB_INLINE f32x load_plane(const raster_pixels *at, int plane, raster_layout how)
{
    size_t offset = plane_offset(at, plane, how);
    if (how == RASTER_BLOCK || how == RASTER_ONE_QUAD)
        return f_load(at->quad[0] + offset);
    return load_quads((const float *const *)at->quad, offset);
}

AMB_INLINE void store_lanes(float *first, f32x value, maskx live)
{
#if AMB_LANES == 16
    _mm512_mask_storeu_ps(first, (__mmask16)m_bits(live), (__m512)value);
#else
    f_store(first, f_sel(live, value, f_load(first)));
#endif
}

/* Quad number `quad` of the lanes, to all quads. */
AMB_INLINE f32x spread_quad(f32x a, int quad)
{
#if AMB_LANES == 16
    __m512 v = (__m512)a;
    return (f32x)(quad == 0   ? _mm512_shuffle_f32x4(v, v, 0x00)
                  : quad == 1 ? _mm512_shuffle_f32x4(v, v, 0x55)
                  : quad == 2 ? _mm512_shuffle_f32x4(v, v, 0xaa)
                              : _mm512_shuffle_f32x4(v, v, 0xff));
#elif AMB_LANES == 8
    __m256 v = (__m256)a;
    return (f32x)(quad == 0 ? _mm256_permute2f128_ps(v, v, 0x00) : _mm256_permute2f128_ps(v, v, 0x11));
#else
    (void)quad;
    return a;
#endif
}

/* The samples of a quad that are in `mask`, of one group, as lanes. */
AMB_INLINE maskx group_lanes(uint32_t mask, int group)
{
    return m_from_bits(mask >> group * AMB_LANES & AMB_ALL_LANES);
}

static inline raster_pixels one_group(const raster_pixels *at, int quad, int group)
{
    return (raster_pixels){.quad = {at->quad[quad] + group * AMB_LANES}, .stride = at->stride};
}

/* Every pixel's value to those of its samples that are in at->mask. */
AMB_INLINE void store_all_samples(const raster_tile *tile, const raster_pixels *at, int plane, f32x value)
{
    size_t offset = plane_offset(at, plane, RASTER_ALL_SAMPLES);
    for (int k = 0; k < RASTER_QUADS; k++) {
        f32x quad = spread_quad(value, k);
        for (int g = 0; g < tile->sample_groups; g++)
            store_lanes(at->quad[k] + offset + g * AMB_LANES, quad, group_lanes(at->mask[k], g));
    }
}

/* Writes the live lanes; the others keep what they hold. */
AMB_INLINE void store_plane(const raster_tile *tile, const raster_pixels *at, int plane, f32x value, maskx live,
                            raster_layout how)
{
    size_t offset = plane_offset(at, plane, how);
    float *first = at->quad[0] + offset;
    if (how == RASTER_ALL_SAMPLES) {
        store_all_samples(tile, at, plane, value);
        return;
    }
    if (how == RASTER_BLOCK || how == RASTER_ONE_QUAD || AMB_LANES == 4) {
        store_lanes(first, value, live);
        return;
    }
#if AMB_LANES == 16
    uint32_t bits = m_bits(live);
    _mm_mask_storeu_ps(first, (__mmask8)(bits & 15u), _mm512_castps512_ps128((__m512)value));
    _mm_mask_storeu_ps(at->quad[1] + offset, (__mmask8)(bits >> 4 & 15u), _mm512_extractf32x4_ps((__m512)value, 1));
    _mm_mask_storeu_ps(at->quad[2] + offset, (__mmask8)(bits >> 8 & 15u), _mm512_extractf32x4_ps((__m512)value, 2));
    _mm_mask_storeu_ps(at->quad[3] + offset, (__mmask8)(bits >> 12), _mm512_extractf32x4_ps((__m512)value, 3));
#elif AMB_LANES == 8
    float *second = at->quad[1] + offset;
    __m256 v = (__m256)value, m = (__m256)live;
    _mm_storeu_ps(first, _mm_blendv_ps(_mm_loadu_ps(first), _mm256_castps256_ps128(v), _mm256_castps256_ps128(m)));
    _mm_storeu_ps(second,
                  _mm_blendv_ps(_mm_loadu_ps(second), _mm256_extractf128_ps(v, 1), _mm256_extractf128_ps(m, 1)));
#endif
}

/* ---- depth and stencil ------------------------------------------------------------------------------------------ */

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

static inline i32x load_stencil(const raster_tile *tile, const raster_pixels *at, raster_layout how)
{
    return f_to_i(load_plane(at, tile->pass->stencil_plane, how)) & 255;
}

/* Which lanes pass the stencil test of the side they show? */
static inline maskx stencil_matches(const amb_stencil *s, i32x stored, maskx front)
{
    int mask = 255 & ~s->read_mask_off;
    i32x reference = i_set(s->reference & mask);
    return (front & stencil_passes(s->front.compare, reference, stored & mask)) |
           (~front & stencil_passes(s->back.compare, reference, stored & mask));
}

/* Tests must wait for the shader when it makes the depth, and when a failed test would change the stencil of a fragment
 * that the shader may still discard. */
static inline bool tests_late(const amb_draw *draw)
{
    const amb_stencil *s = &draw->stencil;
    return draw->writes_depth ||
           (s->on && (s->front.fail | s->front.depth_fail | s->back.fail | s->back.depth_fail) != AMB_STENCIL_KEEP);
}

/* Which lanes pass the draw's stencil and depth tests. */
static inline maskx output_tests(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, maskx front,
                                 f32x depth, raster_layout how)
{
    maskx passed = compare_lanes(draw->depth_compare, depth, load_plane(at, 0, how));
    if (draw->stencil.on)
        passed &= stencil_matches(&draw->stencil, load_stencil(tile, at, how), front);
    return passed;
}

static inline i32x stencil_update(const amb_stencil *s, const amb_stencil_face *face, i32x stored, maskx match,
                                  maskx near_enough)
{
    i32x result = i_sel(near_enough, stencil_result(face->pass, stored, s->reference),
                        stencil_result(face->depth_fail, stored, s->reference));
    return i_sel(match, result, stencil_result(face->fail, stored, s->reference));
}

/* Tests the live lanes for good, writes depth and stencil, and returns the lanes whose colour is to be written. */
static inline maskx update_depth_stencil(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at,
                                         maskx front, f32x depth, maskx live, raster_layout how)
{
    const amb_stencil *s = &draw->stencil;
    maskx near_enough = compare_lanes(draw->depth_compare, depth, load_plane(at, 0, how)), passed = live & near_enough;
    if (s->on) {
        i32x stored = load_stencil(tile, at, how);
        int write = 255 & ~s->write_mask_off;
        maskx match = stencil_matches(s, stored, front);
        i32x result = i_sel(front, stencil_update(s, &s->front, stored, match, near_enough),
                            stencil_update(s, &s->back, stored, match, near_enough));
        result = (result & write) | (stored & ~write);
        store_plane(tile, at, tile->pass->stencil_plane, i_to_f(result), live, how);
        passed &= match;
    }
    if (!draw->depth_write_off)
        store_plane(tile, at, 0, depth, passed, how);
    return passed;
}

/* ---- blending --------------------------------------------------------------------------------------------------- */

/* One attachment, with one of the plain modes. */
AMB_INLINE void store_target(const raster_tile *tile, const raster_pixels *at, raster_format format,
                             const raster_srgb *srgb, int plane, int channels, amb_blend mode, const f32x color[4],
                             maskx live, raster_layout how)
{
    f32x source[4];
    for (int c = 0; c < 4; c++)
        source[c] = is_unorm(format) ? f_saturate(color[c]) : color[c];
    f32x rest = 1.0f - source[3];
    for (int c = 0; c < channels; c++, plane++) {
        f32x value = source[c];
        if (mode == AMB_BLEND_ALPHA)
            value = (c == 3 ? source[3] : source[c] * source[3]) + load_plane(at, plane, how) * rest;
        else if (mode == AMB_BLEND_ADD)
            value = source[c] + load_plane(at, plane, how);
        else if (mode == AMB_BLEND_MULTIPLY)
            value = source[c] * load_plane(at, plane, how);
        store_plane(tile, at, plane, quantize(format, srgb, c, value), live, how);
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
static __attribute__((noinline)) void store_general(const raster_tile *tile, const raster_pixels *at, int plane,
                                                    const amb_draw *draw, int target, const amb_fs_out *out, maskx live,
                                                    raster_layout how)
{
    const raster_attachment *a = &tile->pass->color[target];
    const bool clamped = is_unorm(a->format);
    static const amb_blend_equation known[AMB_BLEND_EQUATION] = {
        [AMB_BLEND_ALPHA] = {AMB_FACTOR_SOURCE_ALPHA, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA, AMB_FACTOR_ONE,
                             AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA, 0, 0},
        [AMB_BLEND_ADD] = {AMB_FACTOR_ONE, AMB_FACTOR_ONE, AMB_FACTOR_ONE, AMB_FACTOR_ONE, 0, 0},
    };
    amb_blend mode = draw->blend[target];
    const amb_blend_equation *q = mode == AMB_BLEND_EQUATION ? &draw->equation[target] : &known[mode];
    const v4x *s = &out->color[target], *t = &out->color[1];
    f32x source[4] = {s->x, s->y, s->z, s->w}, second[4] = {t->x, t->y, t->z, t->w};
    float constant[4] = {draw->blend_constant.x, draw->blend_constant.y, draw->blend_constant.z,
                         draw->blend_constant.w};
    for (int c = 0; c < 4 && clamped; c++) {
        source[c] = f_saturate(source[c]), second[c] = f_saturate(second[c]);
        constant[c] = amb_s_min(amb_s_max(constant[c], 0.0f), 1.0f);
    }
    f32x stored[4] = {f_set(0.0f), f_set(0.0f), f_set(0.0f), f_set(1.0f)};
    for (int c = 0; c < a->channels; c++)
        stored[c] = load_plane(at, plane + c, how);
    for (int c = 0; c < a->channels; c++) {
        if (draw->channels_off[target] >> c & 1)
            continue;
        amb_factor fs = c == 3 ? q->alpha_source : q->color_source, ft = c == 3 ? q->alpha_target : q->color_target;
        f32x value = mode == AMB_BLEND_OFF ? source[c]
                     : mode == AMB_BLEND_MULTIPLY
                         ? source[c] * stored[c]
                         : blend_result(c == 3 ? q->alpha_op : q->color_op, source[c],
                                        blend_factor(fs, c, source, second, stored, constant), stored[c],
                                        blend_factor(ft, c, source, second, stored, constant));
        store_plane(tile, at, plane + c, quantize(a->format, tile->pass->srgb, c, value), live, how);
    }
}

/* The plain modes on what is not float: one body a format. */
static __attribute__((noinline)) void store_rounded(const raster_tile *tile, const raster_pixels *at, int plane,
                                                    const raster_attachment *a, amb_blend mode, const f32x source[4],
                                                    maskx live, raster_layout how)
{
    const raster_srgb *srgb = tile->pass->srgb;
    if (a->format == RASTER_HALF)
        store_target(tile, at, RASTER_HALF, srgb, plane, a->channels, mode, source, live, how);
    else if (a->format == RASTER_UNORM8)
        store_target(tile, at, RASTER_UNORM8, srgb, plane, a->channels, mode, source, live, how);
    else if (a->format == RASTER_SRGB8)
        store_target(tile, at, RASTER_SRGB8, srgb, plane, 4, mode, source, live, how);
    else
        store_target(tile, at, RASTER_SMALL_FLOAT, srgb, plane, 3, mode, source, live, how);
}

static inline void spread_color(const v4x *color, int quad, v4x *to)
{
    *to = (v4x){spread_quad(color->x, quad), spread_quad(color->y, quad), spread_quad(color->z, quad),
                spread_quad(color->w, quad)};
}

/* An attachment that is read: quad by quad, a lane a sample. */
static __attribute__((noinline)) void blend_samples(const raster_tile *tile, const amb_draw *draw,
                                                    const raster_pixels *at, int target, const amb_fs_out *out)
{
    const raster_attachment *a = &tile->pass->color[target];
    const amb_blend mode = draw->blend[target];
    const bool general = mode == AMB_BLEND_EQUATION || draw->channels_off[target] != 0;
    for (int k = 0; k < RASTER_QUADS; k++) {
        if (at->mask[k] == 0)
            continue;
        amb_fs_out spread;
        spread_color(&out->color[target], k, &spread.color[target]);
        if (general && target != 1)
            spread_color(&out->color[1], k, &spread.color[1]);
        const v4x *color = &spread.color[target];
        const f32x source[4] = {color->x, color->y, color->z, color->w};
        for (int g = 0; g < tile->sample_groups; g++) {
            const raster_pixels one = one_group(at, k, g);
            const maskx live = group_lanes(at->mask[k], g);
            if (general)
                store_general(tile, &one, a->first, draw, target, &spread, live, RASTER_ONE_QUAD);
            else if (a->format != RASTER_FLOAT)
                store_rounded(tile, &one, a->first, a, mode, source, live, RASTER_ONE_QUAD);
            else if (a->channels == 4)
                store_target(tile, &one, RASTER_FLOAT, NULL, a->first, 4, mode, source, live, RASTER_ONE_QUAD);
            else
                store_target(tile, &one, RASTER_FLOAT, NULL, a->first, a->channels, mode, source, live,
                             RASTER_ONE_QUAD);
        }
    }
}

AMB_INLINE void store_colors_of(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at,
                                const amb_fs_out *out, maskx live, raster_layout how)
{
    const amb_pass *pass = tile->pass;
    for (int i = 0; i < pass->target_count; i++) {
        if (draw->targets_off >> i & 1u)
            continue;
        const f32x source[4] = {out->color[i].x, out->color[i].y, out->color[i].z, out->color[i].w};
        const raster_attachment *a = &pass->color[i];
        const amb_blend mode = how == RASTER_ALL_SAMPLES ? AMB_BLEND_OFF : draw->blend[i];
        const bool masked = draw->channels_off[i] != 0;
        if (how == RASTER_ALL_SAMPLES && (draw->blend[i] != AMB_BLEND_OFF || masked))
            blend_samples(tile, draw, at, i, out);
        else if (mode == AMB_BLEND_EQUATION || masked)
            store_general(tile, at, a->first, draw, i, out, live, how);
        else if (a->format != RASTER_FLOAT)
            store_rounded(tile, at, a->first, a, mode, source, live, how);
        else if (a->channels == 4) /* the usual case, unrolled */
            store_target(tile, at, RASTER_FLOAT, NULL, a->first, 4, mode, source, live, how);
        else
            store_target(tile, at, RASTER_FLOAT, NULL, a->first, a->channels, mode, source, live, how);
    }
}

/* A form for each layout, which so knows how its pixels lie. */
#define STORE_FORM_(name, how)                                                                                         \
    static __attribute__((noinline)) void name(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, \
                                               const amb_fs_out *out, maskx live)                                      \
    {                                                                                                                  \
        store_colors_of(tile, draw, at, out, live, how);                                                               \
    }
STORE_FORM_(store_block_colors, RASTER_BLOCK)
STORE_FORM_(store_packed_colors, RASTER_PACKED)
STORE_FORM_(store_colors_of_samples, RASTER_ALL_SAMPLES)
#undef STORE_FORM_

static inline void store_colors(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at,
                                const amb_fs_out *out, maskx live, raster_layout how)
{
    if (how == RASTER_PACKED)
        store_packed_colors(tile, draw, at, out, live);
    else if (how == RASTER_ALL_SAMPLES)
        store_colors_of_samples(tile, draw, at, out, live);
    else
        store_block_colors(tile, draw, at, out, live);
}

#endif
