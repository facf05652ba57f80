/* Comparison samplers and texture arrays against the double-precision sampler: a comparison's truth is that sampler
 * over a texture of the results, 1 where a texel passes and 0 where not. */
#include "tests/texture_probes.h"
#include "tests/texture_reference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { BATCH = 512, LAYERS = 5, MOST_BYTES = 1 << 16 };

static uint32_t random_state = 20;

static uint32_t next_random(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    uint32_t h = (random_state ^ random_state >> 15) * 0x2c1b3c6du;
    return h ^ h >> 13;
}
static double uniform(double lo, double hi) { return lo + (hi - lo) * (next_random() / 4294967296.0); }

/* Storage keeps these exactly. */
static const amb_texel exact_texel[] = {AMB_TEXEL_R8, AMB_TEXEL_R16F, AMB_TEXEL_R32F, AMB_TEXEL_RGBA16F,
                                        AMB_TEXEL_RGBA32F};

/* A few depths only, so that equal ones are common. */
static void fill_texels(amb_texel texel, unsigned char *data, size_t bytes)
{
    static const uint16_t half[] = {0x0000, 0x2e66, 0x3400, 0x3555, 0x3800, 0x3a00, 0x3c00, 0x3bff};
    for (size_t i = 0; i < bytes;) {
        unsigned pick = next_random() % 8;
        float value = (float)ref_half(half[pick]);
        if (texel == AMB_TEXEL_R8) {
            data[i++] = (unsigned char)(pick * 36);
        } else if (texel == AMB_TEXEL_R16F || texel == AMB_TEXEL_RGBA16F) {
            memcpy(data + i, &half[pick], 2);
            i += 2;
        } else {
            memcpy(data + i, &value, 4);
            i += 4;
        }
    }
}

static bool passes(amb_compare mode, double reference, double texel)
{
    bool less = reference<texel, equal = reference == texel, greater = reference> texel;
    switch (mode) {
    case AMB_NEVER:
        return false;
    case AMB_LESS:
        return less;
    case AMB_EQUAL:
        return equal;
    case AMB_COMPARE_DEFAULT:
    case AMB_LESS_EQUAL:
        return less || equal;
    case AMB_GREATER:
        return greater;
    case AMB_NOT_EQUAL:
        return !equal;
    case AMB_GREATER_EQUAL:
        return greater || equal;
    case AMB_ALWAYS:
        break;
    }
    return true;
}

typedef struct maps {
    amb_texture_desc desc;
    unsigned char data[MOST_BYTES];
    amb_texture *texture;
    ref_texture *reference[LAYERS]; /* of each layer */
} maps;

static size_t level_texels(const amb_texture_desc *d)
{
    size_t texels = 0;
    for (int l = 0; l < (d->levels ? d->levels : 1); l++) {
        int w = d->width >> l > 1 ? d->width >> l : 1, h = d->height >> l > 1 ? d->height >> l : 1;
        texels += (size_t)w * (size_t)h * (d->kind == AMB_TEXTURE_CUBE ? 6 : 1);
    }
    return texels;
}

static void open_maps(maps *m, amb_texture_kind kind, amb_texel texel, int width, int height, int levels)
{
    bool array = kind == AMB_TEXTURE_2D_ARRAY;
    m->desc = (amb_texture_desc){.kind = kind, .texel = texel, .width = width, .height = height, .depth = LAYERS};
    m->desc.levels = array ? 1 : levels; /* so that a layer's data is one run */
    m->desc.make_mips = array;
    size_t bytes = level_texels(&m->desc) * (size_t)ref_texel_bytes(texel);
    m->desc.data = m->data, m->desc.data_bytes = bytes * (array ? LAYERS : 1);
    assert_true(m->desc.data_bytes <= sizeof m->data);
    fill_texels(texel, m->data, m->desc.data_bytes);
    assert_int_equal(amb_texture_create(&m->desc, &m->texture, NULL), AMB_OK);
    for (int i = 0; i < (array ? LAYERS : 1); i++) {
        amb_texture_desc one = m->desc;
        one.kind = array ? AMB_TEXTURE_2D : kind;
        one.data = m->data + (size_t)i * bytes;
        m->reference[i] = ref_create(&one);
    }
}

static void close_maps(maps *m)
{
    amb_texture_close(&m->texture);
    for (int i = 0; i < LAYERS; i++)
        if (m->reference[i])
            ref_close(m->reference[i]);
    memset(m, 0, sizeof *m);
}

/* Replaces every texel by its result. */
static void compare_reference(ref_texture *t, amb_compare mode, double reference)
{
    for (int l = 0; l < t->levels; l++)
        for (int i = 0; i < t->width[l] * t->height[l] * t->slices[l]; i++)
            t->texel[l][i].c[0] = passes(mode, reference, t->texel[l][i].c[0]);
}

static void random_probes(probe *in, bool direction, double reference)
{
    for (int i = 0; i < BATCH; i++) {
        memset(&in[i], 0, sizeof in[i]);
        for (int a = 0; a < 3; a++) {
            in[i].at[a] = (float)(direction ? uniform(-1, 1) : uniform(-2.5, 3.5));
            in[i].dx[a] = (float)(exp2(uniform(-6, 0)) * uniform(-1, 1));
            in[i].dy[a] = (float)(exp2(uniform(-6, 0)) * uniform(-1, 1));
        }
        if (direction && i % 3 == 0) /* near a corner of the cube */
            for (int a = 0; a < 3; a++)
                in[i].at[a] = (float)((in[i].at[a] < 0.0f ? -1 : 1) * uniform(0.9, 1));
        in[i].lod = (float)uniform(-1, 3);
        in[i].layer = (float)((int)(next_random() % (LAYERS + 2)) - 1); /* also one below and one above */
        in[i].reference = (float)reference;
    }
}

static void run_everywhere(const maps *m, const amb_sampler *s, probe_mode mode, const probe *in, float out[BATCH][4])
{
    static float other[BATCH][4];
    const int *lanes = probe_lanes();
    probe_texture(lanes[0], m->texture, s, mode, in, BATCH, out);
    for (int i = 1; lanes[i]; i++) {
        probe_texture(lanes[i], m->texture, s, mode, in, BATCH, other);
        assert_memory_equal(other, out, sizeof other);
    }
}

static ref_sample reference_at(const maps *m, const amb_sampler *s, probe_mode mode, const probe *p)
{
    const double at[3] = {(double)p->at[0], (double)p->at[1], (double)p->at[2]};
    const double dx[2] = {(double)p->dx[0], (double)p->dx[1]}, dy[2] = {(double)p->dy[0], (double)p->dy[1]};
    int layer = p->layer < 0.0f ? 0 : p->layer >= (float)LAYERS ? LAYERS - 1 : (int)p->layer;
    if (mode == PROBE_COMPARE_CUBE)
        return ref_cube_lod(m->reference[0], s, at, (double)p->lod);
    if (mode == PROBE_ARRAY_GRAD)
        return ref_2d_grad(m->reference[layer], s, at, dx, dy);
    return ref_2d_lod(m->reference[mode == PROBE_COMPARE_2D ? 0 : layer], s, at, (double)p->lod);
}

static void check(const maps *m, const amb_sampler *s, probe_mode mode, const probe *in, double bound)
{
    static float out[BATCH][4];
    int skipped = 0, channels = mode >= PROBE_COMPARE_2D ? 1 : 4;
    run_everywhere(m, s, mode, in, out);
    for (int i = 0; i < BATCH; i++) {
        ref_sample r = reference_at(m, s, mode, &in[i]);
        skipped += r.ambiguous;
        for (int c = 0; c < channels && !r.ambiguous; c++)
            if (!(fabs((double)out[i][c] - r.color.c[c]) <= bound))
                fail_msg("mode %d filter %d compare %d texel %d at (%g, %g, %g) lod %g layer %g: %.9g, truth %.9g",
                         (int)mode, (int)s->filter, (int)s->compare, (int)m->desc.texel, (double)in[i].at[0],
                         (double)in[i].at[1], (double)in[i].at[2], (double)in[i].lod, (double)in[i].layer,
                         (double)out[i][c], r.color.c[c]);
    }
    assert_true(skipped < BATCH / 8);
}

static amb_sampler random_sampler(void)
{
    amb_sampler s = {.filter = (amb_filter)(next_random() % 3), .lod_bias = next_random() % 4 ? 0.0f : 0.6f};
    for (int a = 0; a < 3; a++)
        s.wrap[a] = (amb_wrap)(next_random() % 3);
    return s;
}

/* A texel's own depth, or one between them. */
static double random_reference(const maps *m)
{
    const ref_texture *t = m->reference[0];
    double own = t->texel[0][next_random() % (uint32_t)(t->width[0] * t->height[0])].c[0];
    bool exact = m->desc.texel != AMB_TEXEL_R8; /* n/255 is not a float */
    return exact && next_random() % 2 ? own : (double)(float)uniform(-0.1, 1.1);
}

/* Weights are rounded as the colours' are: 2⁻²³ of a size of 32 and |uv| ≤ 3.5 (test_texture.c). */
static const double bound = 2e-5;

static void comparisons_match_double_precision(void **unused)
{
    (void)unused;
    static maps m;
    static probe in[BATCH];
    static const int size[][2] = {{32, 16}, {1, 1}, {17, 5}, {16, 16}};
    for (size_t f = 0; f < sizeof exact_texel / sizeof exact_texel[0]; f++)
        for (int z = 0; z < 4; z++)
            for (int mode = AMB_COMPARE_DEFAULT; mode <= AMB_ALWAYS; mode++)
                for (int cube = 0; cube < 2; cube++) {
                    int width = cube ? size[z][1] : size[z][0];
                    open_maps(&m, cube ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D, exact_texel[f], width, size[z][1],
                              width == 1 ? 1 : 3);
                    amb_sampler s = random_sampler();
                    s.compare = (amb_compare)mode;
                    double reference = random_reference(&m);
                    random_probes(in, cube, reference);
                    compare_reference(m.reference[0], s.compare, reference);
                    check(&m, &s, cube ? PROBE_COMPARE_CUBE : PROBE_COMPARE_2D, in, bound);
                    close_maps(&m);
                }
}

static void arrays_match_double_precision(void **unused)
{
    (void)unused;
    static maps m;
    static probe in[BATCH];
    static const int size[][2] = {{16, 16}, {1, 1}, {9, 5}};
    for (size_t f = 0; f < sizeof exact_texel / sizeof exact_texel[0]; f++)
        for (int z = 0; z < 3; z++)
            for (int round = 0; round < 3; round++) {
                open_maps(&m, AMB_TEXTURE_2D_ARRAY, exact_texel[f], size[z][0], size[z][1], 1);
                assert_int_equal(amb_texture_describe(m.texture).depth, LAYERS);
                assert_int_equal(amb_texture_describe(m.texture).levels, m.reference[0]->levels);
                amb_sampler s = random_sampler();
                random_probes(in, false, 0.0);
                /* made levels are rounded to the storage: half a code of 255, half a unit of a half below 1 */
                double stored = exact_texel[f] == AMB_TEXEL_R8 ? 0.5 / 255 + 1e-6 : 0x1p-12;
                check(&m, &s, PROBE_ARRAY_LOD, in, stored + bound);
                s.max_anisotropy = (int)(next_random() % 8);
                check(&m, &s, PROBE_ARRAY_GRAD, in, stored + 2e-4);
                s.lod_max = 1e-6f; /* the given level: its depths are exact */
                s.filter = round ? AMB_BILINEAR : AMB_NEAREST, s.compare = AMB_GREATER;
                double reference = random_reference(&m);
                random_probes(in, false, reference);
                for (int i = 0; i < LAYERS; i++)
                    compare_reference(m.reference[i], s.compare, reference);
                check(&m, &s, PROBE_COMPARE_ARRAY, in, bound);
                close_maps(&m);
            }
}

/* The plain form takes from each quad the differences that a GPU takes; layers may differ within it. */
static void quads_give_the_gradients(void **unused)
{
    (void)unused;
    static maps m;
    static probe in[BATCH];
    static float given[BATCH][4], taken[BATCH][4];
    const amb_sampler s = {.filter = AMB_TRILINEAR, .max_anisotropy = 4};
    open_maps(&m, AMB_TEXTURE_2D_ARRAY, AMB_TEXEL_RGBA16F, 16, 16, 1);
    random_probes(in, false, 0.0);
    for (int i = 0; i < BATCH; i++)
        for (int a = 0; a < 2; a++) {
            const probe *q = &in[i & ~3];
            in[i].dx[a] = q[(i & 2) + 1].at[a] - q[i & 2].at[a];
            in[i].dy[a] = q[(i & 1) + 2].at[a] - q[i & 1].at[a];
        }
    probe_texture(1, m.texture, &s, PROBE_ARRAY_GRAD, in, BATCH, given);
    for (const int *lanes = probe_lanes() + 1; *lanes; lanes++) {
        probe_texture(*lanes, m.texture, &s, PROBE_ARRAY_QUAD, in, BATCH, taken);
        assert_memory_equal(taken, given, sizeof taken);
    }
    close_maps(&m);
}

/* NaN on either side fails all but NOT_EQUAL and ALWAYS; hostile coordinates sample something. */
static void hostile_comparisons(void **unused)
{
    (void)unused;
    static const float value[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-45f, 0.0f, -0.0f, 1.0f, 0.5f};
    static probe in[BATCH];
    static float out[BATCH][4];
    static maps m;
    for (int kind = 0; kind < 2; kind++) {
        open_maps(&m, kind ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D, AMB_TEXEL_R32F, 8, 8, 2);
        for (int i = 0; i < BATCH; i++) {
            float *f = (float *)&in[i];
            for (size_t k = 0; k < sizeof *in / sizeof *f; k++)
                f[k] = value[next_random() % 10];
        }
        for (int mode = AMB_NEVER; mode <= AMB_ALWAYS; mode++) {
            amb_sampler s = {.filter = (amb_filter)(mode % 3), .compare = (amb_compare)mode};
            run_everywhere(&m, &s, kind ? PROBE_COMPARE_CUBE : PROBE_COMPARE_2D, in, out);
            for (int i = 0; i < BATCH; i++) {
                assert_true(out[i][0] >= 0.0f && out[i][0] <= 1.0f);
                if (isnan(in[i].reference))
                    assert_true(out[i][0] == (mode == AMB_NOT_EQUAL || mode == AMB_ALWAYS ? 1.0f : 0.0f));
            }
        }
        close_maps(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comparisons_match_double_precision),
        cmocka_unit_test(arrays_match_double_precision),
        cmocka_unit_test(quads_give_the_gradients),
        cmocka_unit_test(hostile_comparisons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
