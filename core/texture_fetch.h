/* Texels into lanes: what the samplers share. Lanes look at different texels, levels and faces; everything here is a
 * pure function of its own lane.
 *
 * A bilinear footprint reads two texels of a row at once (padding keeps them adjacent), so a row costs one load of
 * 8 to 32 bytes a lane and a transposition, instead of one gather a channel and texel. */
#ifndef AMBIANCE_CORE_TEXTURE_FETCH_H
#define AMBIANCE_CORE_TEXTURE_FETCH_H

#include "core/gather.h"
#include "core/texture_layout.h"

#include <ambiance/half.h>

/* ---- colours ---------------------------------------------------------------------------------------------------- */

/* Channels that a storage holds; the rest are filled in by finish_color. */
AMB_INLINE int storage_channels(texture_storage store) { return store == STORE_FLOAT1 ? 1 : 4; }

typedef struct {
    f32x c[4];
} colorx;                /* as stored, UNORM8 in 0…255; while it is filtered, in 0…255·UNORM8_ONE */
#define UNORM8_ONE 16384 /* the sum of a filter's weights */

/* Channel k of a texel's words. */
AMB_INLINE f32x decode_channel(texture_storage store, const u32x *word, int k)
{
    switch (store) {
    case STORE_UNORM8:
        return i_to_f(u_as_i(word[0] >> (unsigned)(8 * k) & 255u));
    case STORE_HALF4:
        return half_to_f(k & 1 ? word[k >> 1] >> 16 : word[k >> 1] & 0xffffu);
    case STORE_FLOAT1:
    case STORE_FLOAT4:
        break;
    }
    return f_from_bits(u_as_i(word[k]));
}

AMB_INLINE void decode_words(texture_storage store, const u32x *word, colorx *out)
{
    for (int k = 0; k < storage_channels(store); k++)
        out->c[k] = decode_channel(store, word, k);
}

AMB_INLINE void fetch_texel(const amb_texture *t, texture_storage store, i32x texel, colorx *out)
{
    u32x word[4];
    if (store == STORE_FLOAT4)
        fetch_4(t->data, texel * 4, word);
    else if (store == STORE_HALF4)
        fetch_2(t->data, texel * 2, word);
    else
        word[0] = u_gather(t->data, texel);
    decode_words(store, word, out);
}

/* The words of a texel and of the next one of its row. */
AMB_INLINE void fetch_pair_words(const amb_texture *t, texture_storage store, i32x texel, u32x word[8])
{
    if (store == STORE_FLOAT4) {
        fetch_4(t->data, texel * 4, word);
        fetch_4(t->data, texel * 4 + 4, word + 4);
    } else if (store == STORE_HALF4) {
        fetch_4(t->data, texel * 2, word);
    } else {
        fetch_2(t->data, texel, word);
    }
}

/* Both as colours. */
AMB_INLINE void fetch_pair(const amb_texture *t, texture_storage store, i32x texel, colorx *a, colorx *b)
{
    u32x word[8];
    fetch_pair_words(t, store, texel, word);
    decode_words(store, word, a);
    decode_words(store, word + storage_words(store), b);
}

/* A filtered colour's channels in 0…1. */
AMB_INLINE v4x finish_color(texture_storage store, const colorx *c)
{
    if (store == STORE_FLOAT1)
        return (v4x){c->c[0], f_set(0.0f), f_set(0.0f), f_set(1.0f)};
    const float scale = store == STORE_UNORM8 ? 1.0f / 255.0f / UNORM8_ONE : 1.0f;
    return (v4x){c->c[0] * scale, c->c[1] * scale, c->c[2] * scale, c->c[3] * scale};
}

/* Float to int for values known to fit: no clamps. */
AMB_INLINE i32x small_to_i(f32x a)
{
#if AMB_LANES == 1
    return (int32_t)a;
#else
    return __builtin_convertvector(a, i32x);
#endif
}

/* ---- levels ----------------------------------------------------------------------------------------------------- */

typedef struct {
    i32x base, pitch, slice;
    f32x width, height, depth;
} levelx;

/* table[index] of a sixteen-entry table. */
AMB_INLINE i32x lookup_level(const void *table, i32x index)
{
#if AMB_X86 && AMB_LANES == 16
    return (i32x)_mm512_permutexvar_epi32((__m512i)index, _mm512_loadu_si512(table));
#else
    return i_gather(table, index);
#endif
}

AMB_INLINE levelx level_at(const amb_texture *t, i32x level)
{
#if !(AMB_X86 && AMB_LANES == 16) /* where a look-up costs more than finding out that all lanes agree */
    int first = i_lane(level, 0);
    if (m_all(level == first))
        return (levelx){i_set(t->base[first]),  i_set(t->pitch[first]),  i_set(t->slice[first]),
                        f_set(t->width[first]), f_set(t->height[first]), f_set(t->depth[first])};
#endif
    return (levelx){lookup_level(t->base, level),
                    lookup_level(t->pitch, level),
                    lookup_level(t->slice, level),
                    f_from_bits(lookup_level(t->width, level)),
                    f_from_bits(lookup_level(t->height, level)),
                    f_from_bits(lookup_level(t->depth, level))};
}

/* log2 of a non-negative float for levels of detail: exact at powers of two, within 1e-4 elsewhere; ≤ -127 at 0. */
AMB_INLINE f32x lod_log2(f32x a)
{
    i32x bits = f_bits(a);
    f32x exponent = i_to_f((bits >> 23) - 127);
    f32x m = f_from_bits((bits & 0x007fffff) | 0x3f800000) - 1.0f; /* log2(1+m) = m + m(1-m)·q(m) */
    f32x q = 0.4423216f + m * (-0.2690259f + m * (0.1497969f + m * -0.0446463f));
    return exponent + (m + m * (1.0f - m) * q);
}

/* How fine a look-up is: the level of detail, or, short of a logarithm, the squared length in texels of level 0 that it
 * is half the binary logarithm of. */
typedef struct {
    f32x value;
    bool squared;
} detailx;

/* A level; the next one counts by blend_of. */
typedef struct {
    i32x near;
    bool two;     /* some lane may blend */
    detailx rest; /* blend, if not squared */
} lod_levels;

AMB_INLINE i32x next_level(const amb_texture *t, i32x level) { return i_min(level + 1, i_set(t->info.levels - 1)); }

/* The levels of a (biased, then clamped) level of detail; NaN gives the lowest allowed. */
AMB_INLINE lod_levels levels_of_lod(const amb_texture *t, const amb_sampler *s, f32x lod)
{
    float last = (float)(t->info.levels - 1), top = s->lod_max > 0.0f && s->lod_max < last ? s->lod_max : last;
    float first = amb_s_max(amb_s_min(s->lod_min, top), 0.0f);
    lod = f_clamp(lod + s->lod_bias, f_set(first), f_set(top));
    if (s->filter != AMB_TRILINEAR)
        return (lod_levels){small_to_i(lod + 0.5f), false, {f_set(0.0f), false}};
    i32x near = small_to_i(lod);
    f32x blend = lod - i_to_f(near);
    return (lod_levels){near, m_any(blend > 0.0f), {blend, false}};
}

/* Without bias and bounds a footprint's exponent holds the level: texels are on their way before the logarithm is. */
AMB_INLINE detailx detail_of_square(const amb_texture *t, const amb_sampler *s, f32x square)
{
    const float last = (float)(t->info.levels - 1);
    if (s->filter == AMB_TRILINEAR && s->lod_bias == 0.0f && s->lod_min <= 0.0f &&
        !(s->lod_max > 0.0f && s->lod_max < last))
        return (detailx){square, true};
    return (detailx){lod_log2(square) * 0.5f, false};
}

AMB_INLINE lod_levels pick_levels(const amb_texture *t, const amb_sampler *s, detailx d)
{
    if (!d.squared)
        return levels_of_lod(t, s, d.value);
    f32x square = f_clamp(d.value, f_set(1.0f), f_set((float)(1 << 2 * (t->info.levels - 1))));
    i32x near = (f_bits(square) - (127 << 23)) >> 24;
    return (lod_levels){near, m_any(square > 1.0f), {square, true}};
}

/* 0…1, from `near` to the next level. Wanted late: see texture_filter.h. */
AMB_INLINE f32x blend_of(const lod_levels *l)
{
    return l->rest.squared ? lod_log2(l->rest.value) * 0.5f - i_to_f(l->near) : l->rest.value;
}

/* ---- footprints ------------------------------------------------------------------------------------------------- */

/* From the squared lengths, in texels of level 0, of the pixel's two axes. Isotropic: λ = log2 of the longer one
 * (OpenGL 4.6 §8.14.1). Anisotropic: N = min(⌈longer / shorter⌉, max), λ = log2(longer / N), N taps along the longer
 * axis (EXT_texture_filter_anisotropic). */
typedef struct {
    f32x square, taps; /* λ = ½·log2(square) */
    maskx along_x;
} footprintx;

AMB_INLINE footprintx footprint(f32x square_x, f32x square_y, int max_anisotropy)
{
    square_x = f_max(square_x, f_set(0.0f)); /* NaN becomes 0 */
    square_y = f_max(square_y, f_set(0.0f));
    maskx along_x = square_x >= square_y;
    f32x longer = f_sel(along_x, square_x, square_y), shorter = f_sel(along_x, square_y, square_x);
    if (max_anisotropy <= 1)
        return (footprintx){longer, f_set(1.0f), along_x};
    float most = max_anisotropy < 16 ? (float)max_anisotropy : 16.0f;
    f32x taps = f_clamp(f_ceil(f_sqrt(longer / shorter)), f_set(1.0f), f_set(most));
    return (footprintx){longer / (taps * taps), taps, along_x};
}

AMB_INLINE f32x finite_or_zero(f32x a) { return f_sel(f_is_finite(a), a, f_set(0.0f)); }

#endif
