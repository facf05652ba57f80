/* Between texels: 2×2 of a level, or of two levels. Part of the samplers (texture*_wide.c).
 *
 * A look-up is longer than what a processor can hold in flight, and instructions enter its schedulers in program order:
 * what waits for addresses must not stand before what could run meanwhile. So weights come before loads here, and what
 * is loaded is used up in portions. */
#ifndef AMBIANCE_CORE_TEXTURE_FILTER_H
#define AMBIANCE_CORE_TEXTURE_FILTER_H

#include "core/texture_fetch.h"

/* Where 2×2 texels lie: the first of them, the distance to the row below, and the weights of the second column and
 * row. */
typedef struct {
    i32x texel, pitch;
    f32x fx, fy;
} quad_place;

/* ---- floats ----------------------------------------------------------------------------------------------------- */

/* Their words: of the upper two, then of the lower two. */
typedef struct {
    u32x word[2][8];
} quad_words;

AMB_INLINE void fetch_quad(const amb_texture *t, texture_storage store, const quad_place *at, quad_words *q)
{
    fetch_pair_words(t, store, at->texel, q->word[0]);
    fetch_pair_words(t, store, at->texel + at->pitch, q->word[1]);
}

/* Channel k between the four: first from row to row, then from column to column. */
AMB_INLINE f32x bilinear_channel(texture_storage store, const quad_place *at, const quad_words *q, int k)
{
    const int next = storage_words(store);
    f32x left = f_lerp(decode_channel(store, q->word[0], k), decode_channel(store, q->word[1], k), at->fy);
    f32x right =
        f_lerp(decode_channel(store, q->word[0] + next, k), decode_channel(store, q->word[1] + next, k), at->fy);
    return f_lerp(left, right, at->fx);
}

/* Between two levels. A far texel that is infinite must not count where it has no weight. */
AMB_INLINE f32x between_levels(f32x near, f32x far, f32x blend)
{
    return f_sel(blend > 0.0f, f_lerp(near, far, blend), near);
}

#if AMB_X86
/* ---- texels of four channels, pixel by pixel -------------------------------------------------------------------- */

/* Registers hold the four channels of a lane in each block of four words; register i of four: those of lanes 4j + i. */

/* Texels' numbers, spilled as in gather.h. */
typedef struct {
    int32_t above[AMB_LANES], below[AMB_LANES];
} __attribute__((aligned(64))) quad_offsets;

AMB_INLINE void spill_offsets(const quad_place *at, quad_offsets *o)
{
    i_store(o->above, at->texel);
    i_store(o->below, at->texel + at->pitch);
}
/* Loads by `offsets` come after `value`, in the order of the program; the empty statement does nothing else. */
#define LOADS_AFTER_(offsets, value) __asm__("" : "+m"(offsets), "+v"(value))

/* Word i of every block, to all of it. */
AMB_INLINE i32x splat_in_blocks(i32x a, int i)
{
    switch (i) {
    case 0:
        return (i32x)LANES_(shuffle_epi32)((LANES_INT_)a, 0x00);
    case 1:
        return (i32x)LANES_(shuffle_epi32)((LANES_INT_)a, 0x55);
    case 2:
        return (i32x)LANES_(shuffle_epi32)((LANES_INT_)a, 0xaa);
    }
    return (i32x)LANES_(shuffle_epi32)((LANES_INT_)a, 0xff);
}
AMB_INLINE f32x f_splat_in_blocks(f32x a, int i) { return f_from_bits(splat_in_blocks(f_bits(a), i)); }
#endif

/* ---- UNORM8: integers ------------------------------------------------------------------------------------------- */

/* Weights are multiples of 1/UNORM8_ONE that sum to 1: constants stay what they are. Coordinates' fractions have 15
 * bits. A colour is within 2⁻¹² of full scale of the exact one. */

/* Words as two signed 16-bit halves each. */
AMB_INLINE i32x raise_half(i32x low) { return u_as_i(i_as_u(low) << 16); }
#if AMB_X86
AMB_INLINE i32x halves_sub(i32x a, i32x b) { return (i32x)LANES_(sub_epi16)((LANES_INT_)a, (LANES_INT_)b); }
/* a·b/2¹⁵, to the nearest, ties up */
AMB_INLINE i32x halves_mul(i32x a, i32x b) { return (i32x)LANES_(mulhrs_epi16)((LANES_INT_)a, (LANES_INT_)b); }
#else
AMB_INLINE i32x low_half(i32x a) { return u_as_i(i_as_u(a) << 16) >> 16; }
AMB_INLINE i32x join_halves(i32x low, i32x high) { return (low & 0xffff) | raise_half(high); }
AMB_INLINE i32x halves_sub(i32x a, i32x b) { return join_halves(low_half(a) - low_half(b), (a >> 16) - (b >> 16)); }
AMB_INLINE i32x halves_mul(i32x a, i32x b)
{
    return join_halves((low_half(a) * low_half(b) + 0x4000) >> 15, ((a >> 16) * (b >> 16) + 0x4000) >> 15);
}
/* The sum of both halves' products. */
AMB_INLINE i32x halves_dot(i32x a, i32x b) { return low_half(a) * low_half(b) + (a >> 16) * (b >> 16); }
#endif

AMB_INLINE i32x fraction_15(f32x a) { return small_to_i(a * 32768.0f); }

/* Of a row's two texels: left | right << 16. */
typedef struct {
    i32x above, below;
} quad_weights;

/* The low halves of `total` split by the low halves of fx and fy, likewise the high ones. */
AMB_INLINE void split_weights(i32x total, i32x fx, i32x fy, quad_weights *low, quad_weights *high)
{
    i32x below = halves_mul(total, fy), above = halves_sub(total, below);
    i32x below_right = halves_mul(below, fx), below_left = halves_sub(below, below_right);
    i32x above_right = halves_mul(above, fx), above_left = halves_sub(above, above_right);
    low->above = (above_left & 0xffff) | raise_half(above_right);
    low->below = (below_left & 0xffff) | raise_half(below_right);
    high->above = u_as_i(i_as_u(above_left) >> 16) | (above_right & -0x10000);
    high->below = u_as_i(i_as_u(below_left) >> 16) | (below_right & -0x10000);
}

AMB_INLINE quad_weights weights_of(const quad_place *at)
{
    quad_weights w, none;
    split_weights(i_set(UNORM8_ONE), fraction_15(at->fx), fraction_15(at->fy), &w, &none);
    return w;
}

AMB_INLINE void weights_between(const quad_place *near, const quad_place *far, f32x blend, quad_weights *near_weights,
                                quad_weights *far_weights)
{
    i32x second = small_to_i(blend * (float)UNORM8_ONE);
    split_weights((UNORM8_ONE - second) | raise_half(second), fraction_15(near->fx) | raise_half(fraction_15(far->fx)),
                  fraction_15(near->fy) | raise_half(fraction_15(far->fy)), near_weights, far_weights);
}

#if AMB_X86
AMB_INLINE LANES_INT_ repeat_block(__m128i a)
{
#if AMB_LANES == 16
    return _mm512_broadcast_i32x4(a);
#elif AMB_LANES == 8
    return _mm256_broadcastsi128_si256(a);
#else
    return a;
#endif
}

/* Σ of texels' channels times weights of lane 4j + i, in block j. */
AMB_INLINE LANES_INT_ weigh_quads(const uint32_t *data, const quad_offsets *o, const quad_weights *w, int i)
{
    /* Bytes of a channel's two texels, as halves; rows are eight bytes each. */
    const LANES_INT_ above = repeat_block(_mm_setr_epi8(0, -1, 4, -1, 1, -1, 5, -1, 2, -1, 6, -1, 3, -1, 7, -1));
    const LANES_INT_ below = repeat_block(_mm_setr_epi8(8, -1, 12, -1, 9, -1, 13, -1, 10, -1, 14, -1, 11, -1, 15, -1));
#define ROWS_(j) load_two_pairs(data + o->above[(4 * (j) + i) % AMB_LANES], data + o->below[(4 * (j) + i) % AMB_LANES])
    LANES_INT_ texels = LANES_FROM_BLOCKS_(ROWS_(0), ROWS_(1), ROWS_(2), ROWS_(3));
#undef ROWS_
    return LANES_(add_epi32)(
        LANES_(madd_epi16)(LANES_(shuffle_epi8)(texels, above), (LANES_INT_)splat_in_blocks(w->above, i)),
        LANES_(madd_epi16)(LANES_(shuffle_epi8)(texels, below), (LANES_INT_)splat_in_blocks(w->below, i)));
}

AMB_INLINE void finish_sums(LANES_INT_ a, LANES_INT_ b, LANES_INT_ c, LANES_INT_ d, colorx *out)
{
    u32x channel[4];
    transpose_blocks(a, b, c, d, channel);
    for (int k = 0; k < 4; k++)
        out->c[k] = i_to_f(u_as_i(channel[k]));
}

AMB_INLINE void bilinear_unorm8(const amb_texture *t, const quad_place *at, colorx *out)
{
    quad_offsets o;
    quad_weights w = weights_of(at);
    spill_offsets(at, &o);
    LOADS_AFTER_(o, w.above);
    LOADS_AFTER_(o, w.below);
    finish_sums(weigh_quads(t->data, &o, &w, 0), weigh_quads(t->data, &o, &w, 1), weigh_quads(t->data, &o, &w, 2),
                weigh_quads(t->data, &o, &w, 3), out);
}

AMB_INLINE void trilinear_unorm8(const amb_texture *t, const quad_place *near, const quad_place *far, f32x blend,
                                 colorx *out)
{
    quad_offsets a, b;
    quad_weights u, v;
    weights_between(near, far, blend, &u, &v);
    spill_offsets(near, &a);
    spill_offsets(far, &b);
    LOADS_AFTER_(a, u.above);
    LOADS_AFTER_(a, u.below);
    LOADS_AFTER_(b, v.above);
    LOADS_AFTER_(b, v.below);
#define LEVELS_(i) LANES_(add_epi32)(weigh_quads(t->data, &a, &u, i), weigh_quads(t->data, &b, &v, i))
    finish_sums(LEVELS_(0), LEVELS_(1), LEVELS_(2), LEVELS_(3), out);
#undef LEVELS_
}
#else
AMB_INLINE i32x weigh_pair(const u32x word[2], i32x weights, int k)
{
    u32x left = word[0] >> (unsigned)(8 * k) & 255u, right = word[1] >> (unsigned)(8 * k) & 255u;
    return halves_dot(u_as_i(left | right << 16), weights);
}

AMB_INLINE i32x weigh_quad(const quad_words *q, const quad_weights *w, int k)
{
    return weigh_pair(q->word[0], w->above, k) + weigh_pair(q->word[1], w->below, k);
}

AMB_INLINE void bilinear_unorm8(const amb_texture *t, const quad_place *at, colorx *out)
{
    quad_words q;
    quad_weights w = weights_of(at);
    fetch_quad(t, STORE_UNORM8, at, &q);
    for (int k = 0; k < 4; k++)
        out->c[k] = i_to_f(weigh_quad(&q, &w, k));
}

AMB_INLINE void trilinear_unorm8(const amb_texture *t, const quad_place *near, const quad_place *far, f32x blend,
                                 colorx *out)
{
    quad_words a, b;
    quad_weights u, v;
    weights_between(near, far, blend, &u, &v);
    fetch_quad(t, STORE_UNORM8, near, &a);
    fetch_quad(t, STORE_UNORM8, far, &b);
    for (int k = 0; k < 4; k++)
        out->c[k] = i_to_f(weigh_quad(&a, &u, k) + weigh_quad(&b, &v, k));
}
#endif

/* ---- HALF4: where the processor converts halves ----------------------------------------------------------------- */

#define FILTERS_HALF4_ (AMB_X86 && AMB_LANES > 4)
#if FILTERS_HALF4_
/* Blocks 0, 2 (…) of a and of b, or 1, 3. */
AMB_INLINE f32x even_blocks(f32x a, f32x b)
{
#if AMB_LANES == 16
    return (f32x)_mm512_shuffle_f32x4((__m512)a, (__m512)b, 0x88);
#else
    return (f32x)_mm256_permute2f128_ps((__m256)a, (__m256)b, 0x20);
#endif
}
AMB_INLINE f32x odd_blocks(f32x a, f32x b)
{
#if AMB_LANES == 16
    return (f32x)_mm512_shuffle_f32x4((__m512)a, (__m512)b, 0xdd);
#else
    return (f32x)_mm256_permute2f128_ps((__m256)a, (__m256)b, 0x31);
#endif
}
/* The first half of the blocks, each twice; or the second half. */
AMB_INLINE f32x twice(f32x a, int half)
{
#if AMB_LANES == 16
    return (f32x)(half ? _mm512_shuffle_f32x4((__m512)a, (__m512)a, 0xfa)
                       : _mm512_shuffle_f32x4((__m512)a, (__m512)a, 0x50));
#else
    return (f32x)(half ? _mm256_permute2f128_ps((__m256)a, (__m256)a, 0x11)
                       : _mm256_permute2f128_ps((__m256)a, (__m256)a, 0x00));
#endif
}

/* Two texels of a row of the lanes 4j + i, for half of the j: two blocks a lane. */
AMB_INLINE f32x load_half_pairs(const uint32_t *data, const int32_t *offset, int i, int half)
{
#if AMB_LANES == 16
    const int32_t *first = offset + 8 * half + i;
    __m256i pairs = _mm256_castsi128_si256(load_quad(data + 2 * (ptrdiff_t)first[0]));
    return (f32x)_mm512_cvtph_ps(_mm256_inserti128_si256(pairs, load_quad(data + 2 * (ptrdiff_t)first[4]), 1));
#else
    return (f32x)_mm256_cvtph_ps(load_quad(data + 2 * (ptrdiff_t)offset[4 * half + i]));
#endif
}

AMB_INLINE f32x lerp_half_rows(const uint32_t *data, const quad_offsets *o, f32x fy, int i, int half)
{
    return f_lerp(load_half_pairs(data, o->above, i, half), load_half_pairs(data, o->below, i, half), twice(fy, half));
}

/* The lanes 4j + i between their four texels. */
AMB_INLINE f32x lerp_half_quads(const uint32_t *data, const quad_offsets *o, const quad_place *at, int i)
{
    f32x fy = f_splat_in_blocks(at->fy, i);
    f32x a = lerp_half_rows(data, o, fy, i, 0), b = lerp_half_rows(data, o, fy, i, 1);
    return f_lerp(even_blocks(a, b), odd_blocks(a, b), f_splat_in_blocks(at->fx, i));
}

AMB_INLINE void finish_blocks(f32x a, f32x b, f32x c, f32x d, colorx *out)
{
    u32x channel[4];
    transpose_blocks((LANES_INT_)a, (LANES_INT_)b, (LANES_INT_)c, (LANES_INT_)d, channel);
    for (int k = 0; k < 4; k++)
        out->c[k] = f_from_bits(u_as_i(channel[k]));
}

AMB_INLINE void bilinear_half4(const amb_texture *t, const quad_place *at, colorx *out)
{
    quad_offsets o;
    spill_offsets(at, &o);
    __asm__("" : "+m"(o));
#define PART_(i) lerp_half_quads(t->data, &o, at, i)
    finish_blocks(PART_(0), PART_(1), PART_(2), PART_(3), out);
#undef PART_
}

AMB_INLINE void trilinear_half4(const amb_texture *t, const quad_place *near, const quad_place *far, f32x blend,
                                colorx *out)
{
    quad_offsets a, b;
    spill_offsets(near, &a);
    spill_offsets(far, &b);
    LOADS_AFTER_(a, blend);
    LOADS_AFTER_(b, blend);
#define PART_(i)                                                                                \
    between_levels(lerp_half_quads(t->data, &a, near, i), lerp_half_quads(t->data, &b, far, i), \
                   f_splat_in_blocks(blend, i))
    finish_blocks(PART_(0), PART_(1), PART_(2), PART_(3), out);
#undef PART_
}
#endif

/* ---- filters ---------------------------------------------------------------------------------------------------- */

/* One texel, unfiltered. */
AMB_INLINE void filter_nearest(const amb_texture *t, texture_storage store, i32x texel, colorx *out)
{
    fetch_texel(t, store, texel, out);
    if (store == STORE_UNORM8)
        for (int k = 0; k < 4; k++)
            out->c[k] = out->c[k] * (float)UNORM8_ONE;
}

AMB_INLINE void filter_bilinear(const amb_texture *t, texture_storage store, const quad_place *at, colorx *out)
{
    if (store == STORE_UNORM8) {
        bilinear_unorm8(t, at, out);
        return;
    }
#if FILTERS_HALF4_
    if (store == STORE_HALF4) {
        bilinear_half4(t, at, out);
        return;
    }
#endif
    quad_words q;
    fetch_quad(t, store, at, &q);
    for (int k = 0; k < storage_channels(store); k++)
        out->c[k] = bilinear_channel(store, at, &q, k);
}

/* Between two levels, both at once: their chains of operations hide each other's latencies. */
AMB_INLINE void filter_trilinear(const amb_texture *t, texture_storage store, const quad_place *near,
                                 const quad_place *far, f32x blend, colorx *out)
{
    if (store == STORE_UNORM8) {
        trilinear_unorm8(t, near, far, blend, out);
        return;
    }
#if FILTERS_HALF4_
    if (store == STORE_HALF4) {
        trilinear_half4(t, near, far, blend, out);
        return;
    }
#endif
    quad_words a, b;
    fetch_quad(t, store, near, &a);
    fetch_quad(t, store, far, &b);
    for (int k = 0; k < storage_channels(store); k++)
        out->c[k] = between_levels(bilinear_channel(store, near, &a, k), bilinear_channel(store, far, &b, k), blend);
}

AMB_INLINE void lerp_colors(texture_storage store, const colorx *a, const colorx *b, f32x t, colorx *out)
{
    for (int k = 0; k < storage_channels(store); k++)
        out->c[k] = f_lerp(a->c[k], b->c[k], t);
}

#endif
