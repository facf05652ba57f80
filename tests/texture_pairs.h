/* A texture of the library and the same one of the reference, sampled side by side. */
#ifndef AMBIANCE_TESTS_TEXTURE_PAIRS_H
#define AMBIANCE_TESTS_TEXTURE_PAIRS_H

#include "tests/texture_probes.h"
#include "tests/texture_reference.h"

enum { TEXELS = AMB_TEXEL_LAST + 1 };
extern const amb_texel every_texel[TEXELS];

typedef struct {
    amb_texture *texture;
    ref_texture *reference;
    unsigned char *data;
} both;

enum { BATCH = 512 };
typedef struct {
    probe in[BATCH];
    float out[BATCH][4];
} batch;

uint32_t pair_random(uint32_t *state);
double pair_uniform(uint32_t *state, double lo, double hi);
both make_both(amb_texture_kind kind, amb_texel texel, int width, int height, int depth, bool mips, uint32_t *state);
void close_both(both *b);
/* Storage rounding a texel may have on top: sRGB is kept with 11 bits, made levels in the storage's precision. */
double storage_bound(amb_texel texel, bool mips);
/* Runs at one lane into out, and checks that every instruction set gives those bits. */
void run_everywhere(const both *b, const amb_sampler *s, probe_mode mode, batch *p);
/* All probes within `bound` of the reference; where rounding may choose other texels a few may be skipped. */
void compare_batch(const both *b, const amb_sampler *s, probe_mode mode, const batch *p, double bound);
void random_probes(batch *p, bool direction, double log_size, uint32_t *state);
amb_sampler random_sampler(uint32_t *state);

#endif
