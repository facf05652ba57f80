/* How textures lie in memory: shared by the maker (texture*.c) and the samplers (texture*_wide.c).
 *
 * Every level has a border of one texel all around, so that a footprint never wraps: texel x + 1 is always the next one
 * in memory and row y + 1 the next row, from -1 on. Those of 2D and 3D levels hold the opposite side (what REPEAT
 * needs; CLAMP and MIRROR never give them weight), those of cube faces the neighbouring faces; a cube's corner is the
 * average of the three texels that meet there.
 *
 * Texels are stored as one of four kinds that decode exactly: */
#ifndef AMBIANCE_CORE_TEXTURE_LAYOUT_H
#define AMBIANCE_CORE_TEXTURE_LAYOUT_H

#include <ambiance/texture.h>

typedef enum texture_storage {
    STORE_UNORM8, /* one word, r g b a from the low byte: R8, RG8, RGBA8 */
    STORE_HALF4,  /* two words of two halves: RG16F, RGBA16F, R11G11B10F, and sRGB, decoded to linear (11 significant
                     bits) */
    STORE_FLOAT1, /* one word: R16F, R32F */
    STORE_FLOAT4, /* four words: RG32F, RGBA32F */
} texture_storage;

AMB_INLINE int storage_words(texture_storage storage)
{
    return storage == STORE_HALF4 ? 2 : storage == STORE_FLOAT4 ? 4 : 1;
}

struct amb_texture {
    amb_texture_info info;
    texture_storage storage;
    size_t words; /* of data, without slack */
    uint32_t *data;
    /* By level; in texels. Sixteen entries so that lanes can look them up in registers. */
    int32_t base[AMB_MAX_TEXTURE_LEVELS];  /* first stored texel: of the border */
    int32_t pitch[AMB_MAX_TEXTURE_LEVELS]; /* texels from a row to the next */
    int32_t slice[AMB_MAX_TEXTURE_LEVELS]; /* texels from a slice or face to the next */
    float width[AMB_MAX_TEXTURE_LEVELS], height[AMB_MAX_TEXTURE_LEVELS], depth[AMB_MAX_TEXTURE_LEVELS];
};

#define TEXTURE_LINE_WORDS 16  /* of a cache line; every row begins one */
#define TEXTURE_SLACK_WORDS 16 /* readable beyond the last texel */

/* Size of a dimension at a level. */
AMB_INLINE int level_size(int size, int level) { return size >> level ? size >> level : 1; }
/* Slices (3D), faces (cube: 6) or layers of a level. */
AMB_INLINE int level_slices(const amb_texture_info *info, int level)
{
    switch (info->kind) {
    case AMB_TEXTURE_CUBE:
        return 6;
    case AMB_TEXTURE_3D:
        return level_size(info->depth, level);
    case AMB_TEXTURE_2D_ARRAY:
        return info->depth;
    case AMB_TEXTURE_2D:
        break;
    }
    return 1;
}
/* Slices of border before the first one. */
AMB_INLINE int slice_border(const amb_texture_info *info) { return info->kind == AMB_TEXTURE_3D; }
/* The words of texel (x, y) of slice, face or layer z; -1 and the size are the border. */
AMB_INLINE uint32_t *texel_at(const amb_texture *t, int level, int x, int y, int z)
{
    size_t index = (size_t)t->base[level] + (size_t)(z + slice_border(&t->info)) * (size_t)t->slice[level] +
                   (size_t)(y + 1) * (size_t)t->pitch[level] + (size_t)(x + 1);
    return t->data + index * (size_t)storage_words(t->storage);
}

/* texture_texels.c: texels in and out of storage. */
size_t texel_bytes(amb_texel texel); /* of one texel in a description's data; 0 for an unknown format */
int texel_channels(amb_texel texel);
texture_storage texel_storage(amb_texel texel);
/* Converts `count` packed texels of the description's format into storage. linear_of_code: 256 halves, for sRGB. */
void texels_store(amb_texel texel, const uint16_t *linear_of_code, const void *source, int count, uint32_t *to);
void texels_decode(texture_storage storage, const uint32_t *from, int count, v4 *to);
void texels_encode(texture_storage storage, const v4 *from, int count, uint32_t *to);
/* Packs linear colours into a description's format; halves saturate at ±65504. `count` texels of texel_bytes each. */
void texels_pack(amb_texel texel, const float *linear_edges, const v4 *from, int count, void *to);
/* The nearest sRGB code. NaN gives 0. */
uint32_t srgb_code(const float linear_edges[256], float linear);
/* linear[c]: what sRGB code c means; edges[c]: where code c + 1 begins (c < 255). */
void srgb_tables(float linear[256], float edges[256]);

/* texture_mips.c */
amb_status texture_make_mips(amb_texture *texture, int first, amb_error *error); /* levels first … levels-1 */
void texture_pad(amb_texture *texture, int level);                               /* its border */

#endif
