#include "tests/texture_pairs.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

const amb_texel every_texel[TEXELS] = {AMB_TEXEL_R8,         AMB_TEXEL_RG8,     AMB_TEXEL_RGBA8, AMB_TEXEL_SRGB8_A8,
                                       AMB_TEXEL_R16F,       AMB_TEXEL_RGBA16F, AMB_TEXEL_R32F,  AMB_TEXEL_RGBA32F,
                                       AMB_TEXEL_R11G11B10F, AMB_TEXEL_RG16F,   AMB_TEXEL_RG32F};
uint32_t pair_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    uint32_t h = (*state ^ *state >> 15) * 0x2c1b3c6du;
    return h ^ h >> 13;
}
double pair_uniform(uint32_t *state, double lo, double hi)
{
    return lo + (hi - lo) * (pair_random(state) / 4294967296.0);
}

/* Finite texels with values of about 0…1, so that error bounds are absolute. */
static void random_texel(amb_texel texel, uint32_t *state, unsigned char *to)
{
    for (int i = 0; i < ref_texel_bytes(texel); i++)
        to[i] = (unsigned char)(pair_random(state) >> 8);
    if (texel == AMB_TEXEL_R16F || texel == AMB_TEXEL_RG16F || texel == AMB_TEXEL_RGBA16F) {
        for (int i = 0; i < ref_texel_bytes(texel); i += 2) {
            unsigned half = pair_random(state) % 0x3c01;
            to[i] = (unsigned char)half, to[i + 1] = (unsigned char)(half >> 8);
        }
    } else if (texel == AMB_TEXEL_R32F || texel == AMB_TEXEL_RG32F || texel == AMB_TEXEL_RGBA32F) {
        for (int i = 0; i < ref_texel_bytes(texel); i += 4) {
            float value = (float)pair_uniform(state, 0.0, 1.0);
            memcpy(to + i, &value, 4);
        }
    } else if (texel == AMB_TEXEL_R11G11B10F) {
        uint32_t word =
            pair_random(state) % 0x3c1 | pair_random(state) % 0x3c1 << 11 | pair_random(state) % 0x1e1 << 22;
        memcpy(to, &word, 4);
    }
}

both make_both(amb_texture_kind kind, amb_texel texel, int width, int height, int depth, bool mips, uint32_t *state)
{
    size_t count = (size_t)width * (size_t)height *
                   (size_t)(kind == AMB_TEXTURE_CUBE ? 6
                            : kind == AMB_TEXTURE_3D ? depth
                                                     : 1);
    size_t bytes = (size_t)ref_texel_bytes(texel);
    both b = {.data = malloc(count * bytes)};
    assert_non_null(b.data);
    for (size_t i = 0; i < count; i++)
        random_texel(texel, state, b.data + i * bytes);
    amb_texture_desc desc = {.kind = kind,
                             .texel = texel,
                             .width = width,
                             .height = height,
                             .depth = depth,
                             .make_mips = mips,
                             .data = b.data,
                             .data_bytes = count * bytes};
    amb_error error;
    assert_int_equal(amb_texture_create(&desc, &b.texture, &error), AMB_OK);
    b.reference = ref_create(&desc);
    assert_int_equal(amb_texture_describe(b.texture).levels, b.reference->levels);
    return b;
}

void close_both(both *b)
{
    amb_texture_close(&b->texture);
    assert_null(b->texture);
    ref_close(b->reference);
    free(b->data);
}

/* Storage rounding a texel may have on top: sRGB is kept with 11 bits, made levels in the storage's precision. */
double storage_bound(amb_texel texel, bool mips)
{
    switch (texel) {
    case AMB_TEXEL_R8:
    case AMB_TEXEL_RG8:
    case AMB_TEXEL_RGBA8:
        return mips ? 0.5 / 255 + 1e-6 : 1e-6;
    case AMB_TEXEL_SRGB8_A8:
        return mips ? 2 * 0x1p-12 : 0x1p-12;
    case AMB_TEXEL_RG16F:
    case AMB_TEXEL_RGBA16F:
    case AMB_TEXEL_R11G11B10F:
        return mips ? 0x1p-12 : 1e-7;
    case AMB_TEXEL_R16F:
    case AMB_TEXEL_R32F:
    case AMB_TEXEL_RG32F:
    case AMB_TEXEL_RGBA32F:
        break;
    }
    return 1e-6;
}

/* Runs at one lane into out, and checks that every instruction set gives those bits. */
void run_everywhere(const both *b, const amb_sampler *s, probe_mode mode, batch *p)
{
    static float other[BATCH][4];
    const int *lanes = probe_lanes();
    probe_texture(lanes[0], b->texture, s, mode, p->in, BATCH, p->out);
    for (int i = 1; lanes[i]; i++) {
        probe_texture(lanes[i], b->texture, s, mode, p->in, BATCH, other);
        if (memcmp(other, p->out, sizeof other))
            fail_msg("%d lanes differ from one lane (mode %d, filter %d)", lanes[i], (int)mode, (int)s->filter);
    }
}

static ref_sample reference(const both *b, const amb_sampler *s, probe_mode mode, const probe *p)
{
    double at[3], dx[3], dy[3];
    for (int a = 0; a < 3; a++)
        at[a] = (double)p->at[a], dx[a] = (double)p->dx[a], dy[a] = (double)p->dy[a];
    switch (mode) {
    case PROBE_2D_LOD:
        return ref_2d_lod(b->reference, s, at, (double)p->lod);
    case PROBE_2D_GRAD:
    case PROBE_2D_QUAD:
        return ref_2d_grad(b->reference, s, at, dx, dy);
    case PROBE_3D_LOD:
        return ref_3d_lod(b->reference, s, at, (double)p->lod);
    case PROBE_CUBE_LOD:
        return ref_cube_lod(b->reference, s, at, (double)p->lod);
    case PROBE_CUBE_GRAD:
    case PROBE_CUBE_QUAD:
    default: /* the rest: test_texture_compare.c */
        break;
    }
    return ref_cube_grad(b->reference, s, at, dx, dy);
}

/* All probes within `bound` of the reference; where rounding may choose other texels a few may be skipped. */
void compare_batch(const both *b, const amb_sampler *s, probe_mode mode, const batch *p, double bound)
{
    int skipped = 0;
    for (int i = 0; i < BATCH; i++) {
        ref_sample r = reference(b, s, mode, &p->in[i]);
        if (r.ambiguous) {
            skipped++;
            continue;
        }
        for (int k = 0; k < 4; k++)
            if (!(fabs((double)p->out[i][k] - r.color.c[k]) <= bound))
                fail_msg("mode %d filter %d wrap %d aniso %d texel %d at (%.9g, %.9g, %.9g) lod %g channel %d: %.9g, "
                         "reference "
                         "%.9g, bound %g",
                         (int)mode, (int)s->filter, (int)s->wrap[0], s->max_anisotropy,
                         (int)amb_texture_describe(b->texture).texel, (double)p->in[i].at[0], (double)p->in[i].at[1],
                         (double)p->in[i].at[2], (double)p->in[i].lod, k, (double)p->out[i][k], r.color.c[k], bound);
    }
    assert_true(skipped < BATCH / 10);
}

void random_probes(batch *p, bool direction, double log_size, uint32_t *state)
{
    for (int i = 0; i < BATCH; i++) {
        /* Footprints from magnified to the whole texture, of any direction and up to 20:1. */
        double scale_x = exp2(pair_uniform(state, -log_size - 1.0, 0.5)),
               scale_y = scale_x * exp2(pair_uniform(state, -4.3, 4.3));
        for (int a = 0; a < 3; a++) {
            p->in[i].at[a] = (float)(direction ? pair_uniform(state, -1.0, 1.0) : pair_uniform(state, -2.5, 3.5));
            p->in[i].dx[a] = (float)(scale_x * pair_uniform(state, -1.0, 1.0));
            p->in[i].dy[a] = (float)(scale_y * pair_uniform(state, -1.0, 1.0));
        }
        p->in[i].lod = (float)pair_uniform(state, -1.0, log_size + 1.0);
    }
}

amb_sampler random_sampler(uint32_t *state)
{
    amb_sampler s = {.filter = (amb_filter)(pair_random(state) % 3)};
    for (int a = 0; a < 3; a++)
        s.wrap[a] = (amb_wrap)(pair_random(state) % 3);
    if (pair_random(state) % 4 == 0)
        s.lod_bias = (float)pair_uniform(state, -2.0, 2.0);
    if (pair_random(state) % 4 == 0)
        s.lod_min = 0.7f;
    if (pair_random(state) % 4 == 0)
        s.lod_max = 2.3f;
    return s;
}
