/* Texel formats: from a description's packed data into storage, and between storage and float colours. */
#include "core/texture_layout.h"

#include <ambiance/half.h>

size_t texel_bytes(amb_texel texel)
{
    switch (texel) {
    case AMB_TEXEL_R8:
        return 1;
    case AMB_TEXEL_RG8:
    case AMB_TEXEL_R16F:
        return 2;
    case AMB_TEXEL_RGBA8:
    case AMB_TEXEL_SRGB8_A8:
    case AMB_TEXEL_R32F:
    case AMB_TEXEL_R11G11B10F:
    case AMB_TEXEL_RG16F:
        return 4;
    case AMB_TEXEL_RGBA16F:
    case AMB_TEXEL_RG32F:
        return 8;
    case AMB_TEXEL_RGBA32F:
        return 16;
    }
    return 0;
}

int texel_channels(amb_texel texel)
{
    switch (texel) {
    case AMB_TEXEL_R8:
    case AMB_TEXEL_R16F:
    case AMB_TEXEL_R32F:
        return 1;
    case AMB_TEXEL_RG8:
    case AMB_TEXEL_RG16F:
    case AMB_TEXEL_RG32F:
        return 2;
    case AMB_TEXEL_R11G11B10F:
        return 3;
    case AMB_TEXEL_RGBA8:
    case AMB_TEXEL_SRGB8_A8:
    case AMB_TEXEL_RGBA16F:
    case AMB_TEXEL_RGBA32F:
        break;
    }
    return 4;
}

texture_storage texel_storage(amb_texel texel)
{
    switch (texel) {
    case AMB_TEXEL_R8:
    case AMB_TEXEL_RG8:
    case AMB_TEXEL_RGBA8:
        return STORE_UNORM8;
    case AMB_TEXEL_R16F:
    case AMB_TEXEL_R32F:
        return STORE_FLOAT1;
    case AMB_TEXEL_RG32F:
    case AMB_TEXEL_RGBA32F:
        return STORE_FLOAT4;
    case AMB_TEXEL_SRGB8_A8:
    case AMB_TEXEL_RG16F:
    case AMB_TEXEL_RGBA16F:
    case AMB_TEXEL_R11G11B10F:
        break;
    }
    return STORE_HALF4;
}

/* ---- sRGB (IEC 61966-2-1) --------------------------------------------------------------------------------------- */

/* x^2.4 for 0 < x ≤ 1 as the fifth root of x¹², by Newton's iteration from above: IEEE operations only. */
static double power_2_4(double x)
{
    double x3 = x * x * x, a = x3 * x3 * x3 * x3, root = 1.0;
    for (int i = 0; i < 64; i++) {
        double r2 = root * root, next = (4.0 * root + a / (r2 * r2)) / 5.0;
        if (!(next < root))
            break;
        root = next;
    }
    return root;
}

static double srgb_decode(double code)
{
    double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : power_2_4((c + 0.055) / 1.055);
}

/* The least float that is not below a positive value, so that floats compare with it as with the value itself. */
static float least_float(double value)
{
    float nearest = (float)value;
    uint32_t bits;
    memcpy(&bits, &nearest, sizeof bits);
    bits += (double)nearest < value;
    memcpy(&nearest, &bits, sizeof bits);
    return nearest;
}

void srgb_tables(float linear[256], float edges[256])
{
    for (int c = 0; c < 256; c++) {
        linear[c] = (float)srgb_decode(c);
        edges[c] = least_float(srgb_decode(c < 255 ? c + 0.5 : 255.0));
    }
}

/* The number of edges at or below the value. */
uint32_t srgb_code(const float edges[256], float linear)
{
    uint32_t code = 0;
    for (uint32_t step = 128; step; step /= 2)
        if (linear >= edges[code + step - 1])
            code += step;
    return code;
}

/* ---- description → storage -------------------------------------------------------------------------------------- */

static uint16_t read16(const unsigned char *p)
{
    uint16_t value;
    memcpy(&value, p, sizeof value);
    return value;
}
static uint32_t read32(const unsigned char *p)
{
    uint32_t value;
    memcpy(&value, p, sizeof value);
    return value;
}
static uint32_t float_word(float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}
static float word_float(uint32_t word)
{
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}
/* 0…255 as a half of 0…1. */
static uint32_t unorm8_half(uint32_t code) { return f_to_half((float)code / 255.0f); }

void texels_store(amb_texel texel, const uint16_t *linear_of_code, const void *source, int count, uint32_t *to)
{
    const unsigned char *p = source;
    for (int i = 0; i < count; i++) {
        switch (texel) {
        case AMB_TEXEL_R8:
            *to++ = *p | 0xff000000u;
            break;
        case AMB_TEXEL_RG8:
            *to++ = read16(p) | 0xff000000u;
            break;
        case AMB_TEXEL_RGBA8:
            *to++ = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
            break;
        case AMB_TEXEL_SRGB8_A8:
            *to++ = linear_of_code[p[0]] | (uint32_t)linear_of_code[p[1]] << 16;
            *to++ = linear_of_code[p[2]] | unorm8_half(p[3]) << 16;
            break;
        case AMB_TEXEL_R16F:
            *to++ = float_word(half_to_f(read16(p)));
            break;
        case AMB_TEXEL_R32F:
            *to++ = read32(p);
            break;
        case AMB_TEXEL_RG16F:
            *to++ = read32(p);
            *to++ = 0x3c00u << 16;
            break;
        case AMB_TEXEL_RGBA16F:
            *to++ = read32(p);
            *to++ = read32(p + 4);
            break;
        case AMB_TEXEL_RG32F:
            *to++ = read32(p);
            *to++ = read32(p + 4);
            *to++ = 0;
            *to++ = float_word(1.0f);
            break;
        case AMB_TEXEL_RGBA32F:
            for (int c = 0; c < 4; c++)
                *to++ = read32(p + 4 * c);
            break;
        case AMB_TEXEL_R11G11B10F: { /* each component is a half without its sign and lowest bits */
            uint32_t word = read32(p);
            *to++ = (word & 0x7ffu) << 4 | (word >> 11 & 0x7ffu) << 20;
            *to++ = (word >> 22) << 5 | 0x3c00u << 16;
            break;
        }
        }
        p += texel_bytes(texel);
    }
}

/* ---- storage ↔ float -------------------------------------------------------------------------------------------- */

void texels_decode(texture_storage storage, const uint32_t *from, int count, v4 *to)
{
    for (int i = 0; i < count; i++, from += storage_words(storage)) {
        switch (storage) {
        case STORE_UNORM8:
            to[i] = v4_scale(v4_of((float)(from[0] & 255u), (float)(from[0] >> 8 & 255u), (float)(from[0] >> 16 & 255u),
                                   (float)(from[0] >> 24)),
                             1.0f / 255.0f);
            break;
        case STORE_HALF4:
            to[i] = v4_of(half_to_f(from[0] & 0xffffu), half_to_f(from[0] >> 16), half_to_f(from[1] & 0xffffu),
                          half_to_f(from[1] >> 16));
            break;
        case STORE_FLOAT1:
            to[i] = v4_of(word_float(from[0]), 0.0f, 0.0f, 1.0f);
            break;
        case STORE_FLOAT4:
            to[i] = v4_of(word_float(from[0]), word_float(from[1]), word_float(from[2]), word_float(from[3]));
            break;
        }
    }
}

static uint32_t unorm8(float value) { return (uint32_t)f_to_i(f_saturate(value) * 255.0f + 0.5f); }

void texels_encode(texture_storage storage, const v4 *from, int count, uint32_t *to)
{
    for (int i = 0; i < count; i++) {
        v4 c = from[i];
        switch (storage) {
        case STORE_UNORM8:
            *to++ = unorm8(c.x) | unorm8(c.y) << 8 | unorm8(c.z) << 16 | unorm8(c.w) << 24;
            break;
        case STORE_HALF4:
            *to++ = f_to_half(c.x) | f_to_half(c.y) << 16;
            *to++ = f_to_half(c.z) | f_to_half(c.w) << 16;
            break;
        case STORE_FLOAT1:
            *to++ = float_word(c.x);
            break;
        case STORE_FLOAT4:
            *to++ = float_word(c.x);
            *to++ = float_word(c.y);
            *to++ = float_word(c.z);
            *to++ = float_word(c.w);
            break;
        }
    }
}

/* ---- float colours → description -------------------------------------------------------------------------------- */

static uint32_t saturated_half(float value)
{
    return f_to_half(f_is_finite(value) ? f_clamp(value, -65504.0f, 65504.0f) : value);
}

void texels_pack(amb_texel texel, const float *linear_edges, const v4 *from, int count, void *to)
{
    unsigned char *p = to;
    for (int i = 0; i < count; i++, p += texel_bytes(texel)) {
        v4 c = from[i];
        uint32_t word[4] = {0};
        switch (texel) {
        case AMB_TEXEL_R8:
        case AMB_TEXEL_RG8:
        case AMB_TEXEL_RGBA8:
            texels_encode(STORE_UNORM8, &c, 1, word);
            break;
        case AMB_TEXEL_SRGB8_A8:
            word[0] = srgb_code(linear_edges, c.x) | srgb_code(linear_edges, c.y) << 8 |
                      srgb_code(linear_edges, c.z) << 16 | unorm8(c.w) << 24;
            break;
        case AMB_TEXEL_R16F:
            word[0] = saturated_half(c.x);
            break;
        case AMB_TEXEL_RG16F:
        case AMB_TEXEL_RGBA16F:
            word[0] = saturated_half(c.x) | saturated_half(c.y) << 16;
            word[1] = saturated_half(c.z) | saturated_half(c.w) << 16;
            break;
        case AMB_TEXEL_R32F:
        case AMB_TEXEL_RG32F:
        case AMB_TEXEL_RGBA32F:
            texels_encode(STORE_FLOAT4, &c, 1, word);
            break;
        case AMB_TEXEL_R11G11B10F:
            word[0] = r11g11b10_encode((v3x){c.x, c.y, c.z});
            break;
        }
        memcpy(p, word, texel_bytes(texel)); /* little-endian, as every machine the library is built for */
    }
}
