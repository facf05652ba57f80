/* What an attachment stores. A tile works in floats; after every write they are rounded to the attachment's format, so
 * that blending reads what a GPU's would. Lanes or, in plain files, single floats.
 *
 * Rules (Direct3D 11.3 functional specification §3.2.3, OpenGL 4.6 §2.3.4–5, §17.3.6): floats to the nearest, ties to
 * even, halves overflow to infinity, 11- and 10-bit floats to their largest, negative ones to 0; unorm: NaN 0, clamped,
 * ⌊255·x + ½⌋; sRGB: the code nearest in coded space, alpha unorm. What is blended onto a unorm target is clamped to
 * 0…1 first. */
#ifndef AMBIANCE_RASTER_FORMATS_H
#define AMBIANCE_RASTER_FORMATS_H

#include "core/texture_fetch.h"

typedef enum raster_format {
    RASTER_FLOAT, /* as it is */
    RASTER_HALF,
    RASTER_SMALL_FLOAT, /* 11, 11 and 10 bits */
    RASTER_UNORM8,
    RASTER_SRGB8, /* rgb coded, alpha unorm */
} raster_format;

/* Codes of linear values: 128 buckets an octave from 2⁻¹³ to 1, fine enough that a bucket holds at most one edge. */
#define RASTER_SRGB_FIRST ((127 - 13) << 7)
#define RASTER_SRGB_BUCKETS (13 * 128 + 1)
typedef struct raster_srgb {
    float linear[256];
    float edge[256];                    /* between codes c and c + 1; edge[255] is beyond 1 */
    int32_t start[RASTER_SRGB_BUCKETS]; /* the code at a bucket's lower end */
} raster_srgb;

AMB_INLINE f32x quantize_unorm8(f32x value) { return f_trunc(f_saturate(value) * 255.0f + 0.5f) / 255.0f; }

AMB_INLINE f32x quantize_srgb8(const raster_srgb *srgb, f32x value)
{
    value = f_saturate(value);
    i32x code = i_gather(srgb->start, i_max((f_bits(value) >> 16) - RASTER_SRGB_FIRST, i_set(0)));
    code = i_sel(value >= f_gather(srgb->edge, code), code + 1, code);
    return f_gather(srgb->linear, code);
}

/* The stored value of a channel. srgb: for RASTER_SRGB8 only. */
AMB_INLINE f32x quantize(raster_format format, const raster_srgb *srgb, int channel, f32x value)
{
    switch (format) {
    case RASTER_HALF:
        return half_to_f(f_to_half(value));
    case RASTER_SMALL_FLOAT:
        return channel < 2 ? half_to_f(f_to_unsigned_small(value, 6) << 4)
                           : half_to_f(f_to_unsigned_small(value, 5) << 5);
    case RASTER_SRGB8:
        return channel < 3 ? quantize_srgb8(srgb, value) : quantize_unorm8(value);
    case RASTER_UNORM8:
        return quantize_unorm8(value);
    case RASTER_FLOAT:
        break;
    }
    return value;
}

AMB_INLINE bool is_unorm(raster_format format) { return format == RASTER_UNORM8 || format == RASTER_SRGB8; }

/* A texel's words from its stored values (absent channels 0, alpha 1), and back. */
AMB_INLINE void encode_texel(texture_storage storage, const f32x value[4], u32x word[4])
{
    switch (storage) {
    case STORE_UNORM8:
        word[0] = u_set(0);
        for (int c = 0; c < 4; c++)
            word[0] |= i_as_u(small_to_i(f_saturate(value[c]) * 255.0f + 0.5f)) << (unsigned)(8 * c);
        break;
    case STORE_HALF4:
        word[0] = f_to_half(value[0]) | f_to_half(value[1]) << 16;
        word[1] = f_to_half(value[2]) | f_to_half(value[3]) << 16;
        break;
    case STORE_FLOAT1:
    case STORE_FLOAT4:
        for (int c = 0; c < (storage == STORE_FLOAT1 ? 1 : 4); c++)
            word[c] = i_as_u(f_bits(value[c]));
        break;
    }
}

AMB_INLINE void decode_texel(texture_storage storage, raster_format format, const raster_srgb *srgb, const u32x word[4],
                             f32x value[4])
{
    colorx stored = {{f_set(0.0f), f_set(0.0f), f_set(0.0f), f_set(1.0f)}};
    decode_words(storage, word, &stored);
    for (int c = 0; c < 4; c++) {
        value[c] = storage == STORE_UNORM8 ? stored.c[c] / 255.0f : stored.c[c];
        if (format == RASTER_SRGB8) /* its storage is a little off the codes */
            value[c] = quantize(format, srgb, c, value[c]);
    }
}

#endif
