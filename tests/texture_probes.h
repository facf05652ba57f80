/* Drives the samplers of every instruction set over lists of plain structs. */
#ifndef AMBIANCE_TESTS_TEXTURE_PROBES_H
#define AMBIANCE_TESTS_TEXTURE_PROBES_H

#include <ambiance/texture.h>

typedef enum probe_mode {
    PROBE_2D_LOD,
    PROBE_2D_GRAD,
    PROBE_2D_QUAD,
    PROBE_3D_LOD,
    PROBE_CUBE_LOD,
    PROBE_CUBE_GRAD,
    PROBE_CUBE_QUAD,
    PROBE_ARRAY_LOD,
    PROBE_ARRAY_GRAD,
    PROBE_ARRAY_QUAD,
    PROBE_COMPARE_2D, /* results in the first component */
    PROBE_COMPARE_ARRAY,
    PROBE_COMPARE_CUBE
} probe_mode;

typedef struct probe {
    float at[3];        /* uv, uvw or direction */
    float dx[3], dy[3]; /* its derivatives; unused by LOD and QUAD modes */
    float lod;
    float layer, reference; /* of arrays; of comparisons */
} probe;

/* count must be a multiple of 16; QUAD modes take their quads from four probes in a row. lanes: 1, 4, 8 or 16. */
void probe_texture(int lanes, const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                   int count, float (*out)[4]);
void probe_texture_x1(const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                      int count, float (*out)[4]);
void probe_texture_x4(const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                      int count, float (*out)[4]);
void probe_texture_x8(const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                      int count, float (*out)[4]);
void probe_texture_x16(const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                       int count, float (*out)[4]);

/* amb_sample_2d_pair over quads of four probes in a row. lanes: 4, 8 or 16. */
void probe_pair(int lanes, const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                float (*first)[4], float (*second)[4]);
void probe_pair_x4(const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                   float (*first)[4], float (*second)[4]);
void probe_pair_x8(const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                   float (*first)[4], float (*second)[4]);
void probe_pair_x16(const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                    float (*first)[4], float (*second)[4]);

/* half.h over arrays; count a multiple of 16. */
typedef enum half_op { HALF_DECODE, HALF_ENCODE, SMALL_DECODE, SMALL_ENCODE } half_op;
/* DECODE: words in; floats out (SMALL: 3 a word). ENCODE: floats in (SMALL: 3 a word); words out. */
void probe_half(int lanes, half_op op, float *floats, uint32_t *words, int count);
void probe_half_x1(half_op op, float *floats, uint32_t *words, int count);
void probe_half_x4(half_op op, float *floats, uint32_t *words, int count);
void probe_half_x8(half_op op, float *floats, uint32_t *words, int count);
void probe_half_x16(half_op op, float *floats, uint32_t *words, int count);

/* The lane counts this machine can run, from 1 up; ends with 0. */
const int *probe_lanes(void);

#endif
