/* A texture sampler in double precision, straight from the formulas of the OpenGL 4.6 specification (§8.14, table 8.19)
 * and of EXT_texture_filter_anisotropic. Slow, plain, and without a line of the library's. */
#ifndef AMBIANCE_TESTS_TEXTURE_REFERENCE_H
#define AMBIANCE_TESTS_TEXTURE_REFERENCE_H

#include <ambiance/texture.h>

typedef struct {
    double c[4];
} ref_color;

typedef struct ref_texture {
    amb_texture_kind kind;
    int width[16], height[16], slices[16], levels; /* slices: depth, 6 or 1 */
    ref_color *texel[16];
} ref_texture;

ref_color ref_decode(amb_texel texel, const unsigned char *bytes); /* one texel */
double ref_half(unsigned bits);
double ref_small(unsigned bits, int mantissa); /* unsigned, 5 exponent bits */
int ref_texel_bytes(amb_texel texel);

ref_texture *ref_create(const amb_texture_desc *desc);
void ref_close(ref_texture *texture);

/* A sample, and whether rounding of the coordinates could legally choose other texels, levels or taps. */
typedef struct {
    ref_color color;
    int ambiguous;
} ref_sample;
ref_sample ref_2d_lod(const ref_texture *t, const amb_sampler *s, const double uv[2], double lod);
ref_sample ref_2d_grad(const ref_texture *t, const amb_sampler *s, const double uv[2], const double dx[2],
                       const double dy[2]);
ref_sample ref_3d_lod(const ref_texture *t, const amb_sampler *s, const double uvw[3], double lod);
ref_sample ref_cube_lod(const ref_texture *t, const amb_sampler *s, const double direction[3], double lod);
ref_sample ref_cube_grad(const ref_texture *t, const amb_sampler *s, const double direction[3], const double dx[3],
                         const double dy[3]);

#endif
