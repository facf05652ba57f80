/* Textures and samplers. A texture changes only as a pass's target (raster.h) and by amb_texture_make_mips; sampling
 * may be called from any thread, but not of a texture that is being changed.
 *
 * Sampling follows the GL/D3D formulas (texel centres at .5, LOD from screen derivatives), with weights in full float
 * precision (14 bits for unorm formats) where a GPU has 8 bits. The lanes form is compiled once per instruction set.
 * NaN or infinite coordinates sample coordinate 0: never out of bounds. */
#ifndef AMBIANCE_TEXTURE_H
#define AMBIANCE_TEXTURE_H

#include <ambiance/image.h>
#include <ambiance/vec.h>

typedef enum amb_texture_kind {
    AMB_TEXTURE_2D,
    AMB_TEXTURE_CUBE,
    AMB_TEXTURE_3D,
    AMB_TEXTURE_2D_ARRAY
} amb_texture_kind;

typedef enum amb_texel {
    AMB_TEXEL_R8,
    AMB_TEXEL_RG8,
    AMB_TEXEL_RGBA8,    /* unorm */
    AMB_TEXEL_SRGB8_A8, /* rgb sRGB-coded, alpha linear; decoded before filtering, to 11 bits (1/18 of a code) */
    AMB_TEXEL_R16F,
    AMB_TEXEL_RGBA16F,
    AMB_TEXEL_R32F,
    AMB_TEXEL_RGBA32F,
    AMB_TEXEL_R11G11B10F,
    AMB_TEXEL_RG16F,
    AMB_TEXEL_RG32F,
} amb_texel; /* absent channels read 0, absent alpha 1 */
#define AMB_TEXEL_LAST AMB_TEXEL_RG32F

#define AMB_MAX_TEXTURE_SIZE 32768
#define AMB_MAX_TEXTURE_LEVELS 16

typedef struct amb_texture amb_texture;

typedef struct amb_texture_desc {
    amb_texture_kind kind;
    amb_texel texel;
    int width, height, depth; /* texels; cube: width == height; depth: of 3D, or layers of an array; else ignored */
    int levels;               /* levels given in `data`, each half the one before; 0 means 1 */
    bool make_mips;           /* complete the chain below the given levels with a box filter in linear light */
    /* Level by level; in a level layers, cube faces +x -x +y -y +z -z (D3D order and orientation) or slices, rows from
     * the top, texels; tightly packed. Copied. NULL: all zero, to be rendered into. */
    const void *data;
    size_t data_bytes; /* must match exactly; 0 for NULL */
} amb_texture_desc;

/* Errors: ARGUMENT, LIMIT, MEMORY. */
amb_status amb_texture_create(const amb_texture_desc *desc, amb_texture **out, amb_error *error);
/* From a planar image of 1…4 channels: render to texture, environment maps, generators. */
amb_status amb_texture_from_image(const amb_image *image, amb_texel texel, bool make_mips, amb_texture **out,
                                  amb_error *error);
/* From six square images of equal size, faces in D3D order. */
amb_status amb_texture_cube_from_images(amb_image *const faces[6], amb_texel texel, bool make_mips, amb_texture **out,
                                        amb_error *error);
void amb_texture_close(amb_texture **texture); /* frees and nulls */
/* Makes every level below the first anew from it, as make_mips does. Errors: MEMORY (levels are then as they were). */
amb_status amb_texture_make_mips(amb_texture *texture, amb_error *error);
/* A layer, face or slice of a level as an image of the format's channels; sRGB as the linear values of its codes.
 * Errors: ARGUMENT, LIMIT, MEMORY. */
amb_status amb_texture_to_image(const amb_texture *texture, int level, int slice, amb_image **out, amb_error *error);

typedef struct amb_texture_info {
    amb_texture_kind kind;
    amb_texel texel;
    int width, height, depth, levels;
} amb_texture_info;
amb_texture_info amb_texture_describe(const amb_texture *texture);

typedef enum amb_filter { AMB_NEAREST, AMB_BILINEAR, AMB_TRILINEAR } amb_filter;
typedef enum amb_wrap { AMB_REPEAT, AMB_CLAMP, AMB_MIRROR } amb_wrap;

typedef enum amb_compare {
    AMB_COMPARE_DEFAULT, /* what it means is said where it is used */
    AMB_NEVER,
    AMB_LESS,
    AMB_EQUAL,
    AMB_LESS_EQUAL,
    AMB_GREATER,
    AMB_NOT_EQUAL,
    AMB_GREATER_EQUAL,
    AMB_ALWAYS
} amb_compare;

typedef struct amb_sampler {
    amb_filter filter;      /* BILINEAR uses the nearest mip, TRILINEAR blends two; NEAREST: the nearest of both */
    amb_wrap wrap[3];       /* u, v, w; cubes ignore it: their edges are always seamless */
    float lod_bias;         /* added to the computed level */
    float lod_min, lod_max; /* clamp of the level; lod_max 0 means no upper bound */
    int max_anisotropy;     /* 0 or 1: isotropic; up to 16: EXT_texture_filter_anisotropic, 2D and cube _grad forms */
    amb_compare compare;    /* of comparison sampling: the reference against a texel; DEFAULT: LESS_EQUAL */
} amb_sampler;

/* Lanes forms. uv: 0…1 across the texture, v down. direction: any length. Results: r, g, b linear, a.
 * The plain form takes its derivatives from the 2×2 quads of the block (4 lanes or more); the _grad form takes
 * d(uv)/dx and d(uv)/dy per pixel; the _lod form a level (0 = full size). The level of detail computed from derivatives
 * is within 1e-4 of the exact one; a lane's colour is within a few ULP plus 2⁻²³·size of its steepest texel difference,
 * and for unorm formats within 2⁻¹² more (their weights have 14 bits).
 * Structures of lanes are passed in memory; the forms named _at, which the others call, take them in registers.
 * Sources: OpenGL 4.6 §8.14 and table 8.19, EXT_texture_filter_anisotropic. */
#if AMB_LANES > 1
#define amb_sample_2d_at WIDE(amb_sample_2d_at)
v4x amb_sample_2d_at(const amb_texture *texture, const amb_sampler *sampler, f32x u, f32x v);
AMB_INLINE v4x amb_sample_2d(const amb_texture *texture, const amb_sampler *sampler, v2x uv)
{
    return amb_sample_2d_at(texture, sampler, uv.x, uv.y);
}
/* Two textures at one place, first and second: as amb_sample_2d of each, but a colour and a normal map of one size and
 * format find their texels once and wait for them together. */
#define amb_sample_2d_pair_at WIDE(amb_sample_2d_pair_at)
void amb_sample_2d_pair_at(const amb_texture *first, const amb_texture *second, const amb_sampler *sampler, f32x u,
                           f32x v, v4x out[2]);
AMB_INLINE void amb_sample_2d_pair(const amb_texture *first, const amb_texture *second, const amb_sampler *sampler,
                                   v2x uv, v4x out[2])
{
    amb_sample_2d_pair_at(first, second, sampler, uv.x, uv.y, out);
}
#define amb_sample_cube_at WIDE(amb_sample_cube_at)
v4x amb_sample_cube_at(const amb_texture *texture, const amb_sampler *sampler, f32x x, f32x y, f32x z);
AMB_INLINE v4x amb_sample_cube(const amb_texture *texture, const amb_sampler *sampler, v3x direction)
{
    return amb_sample_cube_at(texture, sampler, direction.x, direction.y, direction.z);
}
#endif
#define amb_sample_2d_grad WIDE(amb_sample_2d_grad)
v4x amb_sample_2d_grad(const amb_texture *texture, const amb_sampler *sampler, v2x uv, v2x ddx, v2x ddy);
#define amb_sample_2d_lod_at WIDE(amb_sample_2d_lod_at)
v4x amb_sample_2d_lod_at(const amb_texture *texture, const amb_sampler *sampler, f32x u, f32x v, f32x lod);
AMB_INLINE v4x amb_sample_2d_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, f32x lod)
{
    return amb_sample_2d_lod_at(texture, sampler, uv.x, uv.y, lod);
}
#define amb_sample_cube_grad WIDE(amb_sample_cube_grad)
v4x amb_sample_cube_grad(const amb_texture *texture, const amb_sampler *sampler, v3x direction, v3x ddx, v3x ddy);
#define amb_sample_cube_lod_at WIDE(amb_sample_cube_lod_at)
v4x amb_sample_cube_lod_at(const amb_texture *texture, const amb_sampler *sampler, f32x x, f32x y, f32x z, f32x lod);
AMB_INLINE v4x amb_sample_cube_lod(const amb_texture *texture, const amb_sampler *sampler, v3x direction, f32x lod)
{
    return amb_sample_cube_lod_at(texture, sampler, direction.x, direction.y, direction.z, lod);
}
#define amb_sample_3d_lod WIDE(amb_sample_3d_lod)
v4x amb_sample_3d_lod(const amb_texture *texture, const amb_sampler *sampler, v3x uvw, f32x lod);

/* Arrays: the layer is clamped to 0…depth-1. The plain 2D forms sample layer 0 of an array. */
#if AMB_LANES > 1
#define amb_sample_2d_array WIDE(amb_sample_2d_array)
v4x amb_sample_2d_array(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer);
#endif
#define amb_sample_2d_array_grad WIDE(amb_sample_2d_array_grad)
v4x amb_sample_2d_array_grad(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer, v2x ddx,
                             v2x ddy);
#define amb_sample_2d_array_lod WIDE(amb_sample_2d_array_lod)
v4x amb_sample_2d_array_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer, f32x lod);

/* Comparison sampling, for shadow maps: each texel's red is compared, `reference OP red`, and it is the results, 1 or
 * 0, that are filtered: BILINEAR is the 2×2 percentage-closer filter. Compares with a NaN fail, but NOT_EQUAL and
 * ALWAYS pass. max_anisotropy is ignored. Source: Direct3D 11 SampleCmpLevelZero; Reeves, Salesin, Cook, "Rendering
 * antialiased shadows with depth maps", 1987. */
#define amb_compare_2d_lod WIDE(amb_compare_2d_lod)
f32x amb_compare_2d_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, f32x reference, f32x lod);
#define amb_compare_2d_array_lod WIDE(amb_compare_2d_array_lod)
f32x amb_compare_2d_array_lod(const amb_texture *texture, const amb_sampler *sampler, v2x uv, i32x layer,
                              f32x reference, f32x lod);
#define amb_compare_cube_lod WIDE(amb_compare_cube_lod)
f32x amb_compare_cube_lod(const amb_texture *texture, const amb_sampler *sampler, v3x direction, f32x reference,
                          f32x lod);

#endif
