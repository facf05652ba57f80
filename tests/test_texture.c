/* Textures against a double-precision sampler written from the GL formulas (texture_reference.c), and every instruction
 * set against one lane, bit for bit. */
#include "tests/texture_probes.h"
#include "tests/texture_reference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

/* ---- helpers ---------------------------------------------------------------------------------------------------- */

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    uint32_t h = (*state ^ *state >> 15) * 0x2c1b3c6du;
    return h ^ h >> 13;
}
static double uniform(uint32_t *state, double lo, double hi)
{
    return lo + (hi - lo) * (next_random(state) / 4294967296.0);
}

/* Finite texels with values of about 0…1, so that error bounds are absolute. */
static void random_texel(amb_texel texel, uint32_t *state, unsigned char *to)
{
    for (int i = 0; i < ref_texel_bytes(texel); i++)
        to[i] = (unsigned char)(next_random(state) >> 8);
    if (texel == AMB_TEXEL_R16F || texel == AMB_TEXEL_RG16F || texel == AMB_TEXEL_RGBA16F) {
        for (int i = 0; i < ref_texel_bytes(texel); i += 2) {
            unsigned half = next_random(state) % 0x3c01;
            to[i] = (unsigned char)half, to[i + 1] = (unsigned char)(half >> 8);
        }
    } else if (texel == AMB_TEXEL_R32F || texel == AMB_TEXEL_RG32F || texel == AMB_TEXEL_RGBA32F) {
        for (int i = 0; i < ref_texel_bytes(texel); i += 4) {
            float value = (float)uniform(state, 0.0, 1.0);
            memcpy(to + i, &value, 4);
        }
    } else if (texel == AMB_TEXEL_R11G11B10F) {
        uint32_t word =
            next_random(state) % 0x3c1 | next_random(state) % 0x3c1 << 11 | next_random(state) % 0x1e1 << 22;
        memcpy(to, &word, 4);
    }
}

typedef struct {
    amb_texture *texture;
    ref_texture *reference;
    unsigned char *data;
} both;

static both make_both(amb_texture_kind kind, amb_texel texel, int width, int height, int depth, bool mips,
                      uint32_t *state)
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

static void close_both(both *b)
{
    amb_texture_close(&b->texture);
    assert_null(b->texture);
    ref_close(b->reference);
    free(b->data);
}

/* Storage rounding a texel may have on top: sRGB is kept with 11 bits, made levels in the storage's precision. */
static double storage_bound(amb_texel texel, bool mips)
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

enum { BATCH = 512 };
typedef struct {
    probe in[BATCH];
    float out[BATCH][4];
} batch;

/* Runs at one lane into out, and checks that every instruction set gives those bits. */
static void run_everywhere(const both *b, const amb_sampler *s, probe_mode mode, batch *p)
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
static void compare_batch(const both *b, const amb_sampler *s, probe_mode mode, const batch *p, double bound)
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

static void random_probes(batch *p, bool direction, double log_size, uint32_t *state)
{
    for (int i = 0; i < BATCH; i++) {
        /* Footprints from magnified to the whole texture, of any direction and up to 20:1. */
        double scale_x = exp2(uniform(state, -log_size - 1.0, 0.5)),
               scale_y = scale_x * exp2(uniform(state, -4.3, 4.3));
        for (int a = 0; a < 3; a++) {
            p->in[i].at[a] = (float)(direction ? uniform(state, -1.0, 1.0) : uniform(state, -2.5, 3.5));
            p->in[i].dx[a] = (float)(scale_x * uniform(state, -1.0, 1.0));
            p->in[i].dy[a] = (float)(scale_y * uniform(state, -1.0, 1.0));
        }
        p->in[i].lod = (float)uniform(state, -1.0, log_size + 1.0);
    }
}

static amb_sampler random_sampler(uint32_t *state)
{
    amb_sampler s = {.filter = (amb_filter)(next_random(state) % 3)};
    for (int a = 0; a < 3; a++)
        s.wrap[a] = (amb_wrap)(next_random(state) % 3);
    if (next_random(state) % 4 == 0)
        s.lod_bias = (float)uniform(state, -2.0, 2.0);
    if (next_random(state) % 4 == 0)
        s.lod_min = 0.7f;
    if (next_random(state) % 4 == 0)
        s.lod_max = 2.3f;
    return s;
}

/* ---- sampling --------------------------------------------------------------------------------------------------- */

static const amb_texel every_texel[] = {AMB_TEXEL_R8,         AMB_TEXEL_RG8,     AMB_TEXEL_RGBA8, AMB_TEXEL_SRGB8_A8,
                                        AMB_TEXEL_R16F,       AMB_TEXEL_RGBA16F, AMB_TEXEL_R32F,  AMB_TEXEL_RGBA32F,
                                        AMB_TEXEL_R11G11B10F, AMB_TEXEL_RG16F,   AMB_TEXEL_RG32F};
enum { TEXELS = sizeof every_texel / sizeof every_texel[0] };

/* Coordinate rounding: 2⁻²³ of a size of 32 on three axes and |uv| ≤ 3.5 stays below 2e-5 of the contrast. */
static const double coordinate_bound = 2e-5;
/* The level's fraction: lod_log2 promises 1e-4, halved by the square root; 2e-4 with the blend of unit contrast. */
static const double gradient_bound = 2e-4;

static void test_2d_matches_reference(void **unused)
{
    (void)unused;
    static const int size[][2] = {{32, 32}, {32, 8}, {1, 1}, {1, 16}, {17, 5}, {31, 30}, {2, 3}};
    static batch p;
    uint32_t state = 1;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_2D, every_texel[f], size[z][0], size[z][1], 1, true, &state);
            double stored = storage_bound(every_texel[f], true);
            for (int round = 0; round < 4; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, false, 5.0, &state);
                run_everywhere(&b, &s, PROBE_2D_LOD, &p);
                compare_batch(&b, &s, PROBE_2D_LOD, &p, stored + coordinate_bound);
                s.max_anisotropy = (int)(next_random(&state) % 18);
                run_everywhere(&b, &s, PROBE_2D_GRAD, &p);
                compare_batch(&b, &s, PROBE_2D_GRAD, &p, stored + gradient_bound);
            }
            close_both(&b);
        }
}

static void test_3d_matches_reference(void **unused)
{
    (void)unused;
    static const int size[][3] = {{8, 8, 8}, {16, 4, 7}, {1, 3, 5}, {5, 9, 1}};
    static batch p;
    uint32_t state = 2;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_3D, every_texel[f], size[z][0], size[z][1], size[z][2], true, &state);
            for (int round = 0; round < 3; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, false, 4.0, &state);
                run_everywhere(&b, &s, PROBE_3D_LOD, &p);
                compare_batch(&b, &s, PROBE_3D_LOD, &p, storage_bound(every_texel[f], true) + coordinate_bound);
            }
            close_both(&b);
        }
}

static void test_cube_matches_reference(void **unused)
{
    (void)unused;
    static const int size[] = {16, 1, 2, 5};
    static batch p;
    uint32_t state = 3;
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_CUBE, every_texel[f], size[z], size[z], 1, true, &state);
            double stored =
                storage_bound(every_texel[f], true) + storage_bound(every_texel[f], true); /* corners again */
            for (int round = 0; round < 3; round++) {
                amb_sampler s = random_sampler(&state);
                random_probes(&p, true, 4.0, &state);
                run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
                compare_batch(&b, &s, PROBE_CUBE_LOD, &p, stored + coordinate_bound);
                run_everywhere(&b, &s, PROBE_CUBE_GRAD, &p);
                compare_batch(&b, &s, PROBE_CUBE_GRAD, &p, stored + gradient_bound);
            }
            close_both(&b);
        }
}

/* Taps of an anisotropic cube look-up are spread in direction space. */
static void test_cube_anisotropy(void **unused)
{
    (void)unused;
    static batch p;
    uint32_t state = 4;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 16, 16, 1, true, &state);
    amb_sampler s = {.filter = AMB_TRILINEAR, .max_anisotropy = 16};
    random_probes(&p, true, 4.0, &state);
    run_everywhere(&b, &s, PROBE_CUBE_GRAD, &p);
    compare_batch(&b, &s, PROBE_CUBE_GRAD, &p, gradient_bound);
    close_both(&b);
}

/* The plain form takes from each quad exactly the differences that a GPU takes. */
static void test_quads_give_the_gradients(void **unused)
{
    (void)unused;
    static batch p;
    static float quad[BATCH][4];
    uint32_t state = 5;
    for (int cube = 0; cube < 2; cube++) {
        both b = make_both(cube ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D, AMB_TEXEL_RGBA16F, 16, 16, 1, true, &state);
        amb_sampler s = {.filter = AMB_TRILINEAR, .max_anisotropy = 4};
        random_probes(&p, cube, 4.0, &state);
        for (int i = 0; i < BATCH; i++) {
            const probe *q = &p.in[i & ~3];
            for (int a = 0; a < 3; a++) {
                p.in[i].dx[a] = q[(i & 2) + 1].at[a] - q[i & 2].at[a];
                p.in[i].dy[a] = q[(i & 1) + 2].at[a] - q[i & 1].at[a];
            }
        }
        probe_texture(1, b.texture, &s, cube ? PROBE_CUBE_GRAD : PROBE_2D_GRAD, p.in, BATCH, p.out);
        for (const int *lanes = probe_lanes() + 1; *lanes; lanes++) {
            probe_texture(*lanes, b.texture, &s, cube ? PROBE_CUBE_QUAD : PROBE_2D_QUAD, p.in, BATCH, quad);
            assert_memory_equal(quad, p.out, sizeof quad);
        }
        close_both(&b);
    }
}

/* ---- made levels ------------------------------------------------------------------------------------------------ */

/* Every texel of every level through a nearest look-up at its centre. */
static void check_levels(const both *b, double bound)
{
    amb_sampler s = {.filter = AMB_NEAREST};
    static batch p;
    for (int l = 0; l < b->reference->levels; l++) {
        int w = b->reference->width[l], h = b->reference->height[l], count = w * h;
        for (int first = 0; first < count; first += BATCH) {
            for (int i = 0; i < BATCH; i++) {
                int at = (first + i) % count;
                p.in[i] = (probe){.at = {((float)(at % w) + 0.5f) / (float)w, ((float)(at / w) + 0.5f) / (float)h},
                                  .lod = (float)l};
            }
            run_everywhere(b, &s, PROBE_2D_LOD, &p);
            for (int i = 0; i < BATCH; i++)
                for (int k = 0; k < 4; k++) {
                    double want = b->reference->texel[l][(first + i) % count].c[k];
                    if (!(fabs((double)p.out[i][k] - want) <= bound * (l ? 1.0 : fabs(want)) + 1e-30))
                        fail_msg("level %d texel %d channel %d: %.9g, reference %.9g", l, (first + i) % count, k,
                                 (double)p.out[i][k], want);
                }
        }
    }
}

static void test_mips_match_brute_force(void **unused)
{
    (void)unused;
    uint32_t state = 6;
    static const int size[][2] = {{16, 16}, {13, 7}, {1, 9}, {27, 2}};
    for (int f = 0; f < TEXELS; f++)
        for (size_t z = 0; z < sizeof size / sizeof size[0]; z++) {
            both b = make_both(AMB_TEXTURE_2D, every_texel[f], size[z][0], size[z][1], 1, true, &state);
            check_levels(&b, storage_bound(every_texel[f], true));
            close_both(&b);
        }
}

static void test_given_levels_are_kept(void **unused)
{
    (void)unused;
    uint32_t state = 7;
    unsigned char data[4 * (64 + 16 + 4)];
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)next_random(&state);
    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA8,
                             .width = 8,
                             .height = 8,
                             .levels = 3,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = sizeof data};
    amb_error error;
    both b = {.reference = ref_create(&desc), .data = NULL};
    assert_int_equal(amb_texture_create(&desc, &b.texture, &error), AMB_OK);
    assert_int_equal(amb_texture_describe(b.texture).levels, 4);
    check_levels(&b, storage_bound(AMB_TEXEL_RGBA8, true));
    close_both(&b);
    desc.make_mips = false;
    assert_int_equal(amb_texture_create(&desc, &b.texture, &error), AMB_OK);
    assert_int_equal(amb_texture_describe(b.texture).levels, 3);
    amb_texture_close(&b.texture);
}

/* A constant texture is constant at every level, filter and footprint. */
static void test_constant_stays_constant(void **unused)
{
    (void)unused;
    static batch p;
    uint32_t state = 8;
    float data[4 * 15 * 9];
    for (size_t i = 0; i < sizeof data / sizeof *data; i++)
        data[i] = 0.7f;
    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA32F,
                             .width = 15,
                             .height = 9,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = sizeof data};
    both b = {0};
    assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
    for (int round = 0; round < 20; round++) {
        amb_sampler s = random_sampler(&state);
        s.max_anisotropy = (int)(next_random(&state) % 17);
        random_probes(&p, false, 4.0, &state);
        run_everywhere(&b, &s, PROBE_2D_GRAD, &p);
        for (int i = 0; i < BATCH; i++)
            assert_true(fabsf(p.out[i][0] - 0.7f) < 2e-6f);
    }
    amb_texture_close(&b.texture);
}

/* ---- cube seams ------------------------------------------------------------------------------------------------- */

/* Along great circles and through corners, neighbouring directions never jump by more than the steepest slope allows.
 */
static void test_cube_is_continuous(void **unused)
{
    (void)unused;
    uint32_t state = 9;
    static batch p;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 8, 8, 1, true, &state);
    amb_sampler s = {.filter = AMB_TRILINEAR};
    for (int path = 0; path < 60; path++) {
        double from[3], to[3];
        for (int a = 0; a < 3; a++) {
            double corner = path & (1 << a) ? 1.0 : -1.0, edge = (path / 8) % 3 == a ? uniform(&state, -1, 1) : corner;
            double middle = path < 24 ? corner : edge; /* through corners, then across edges */
            double step = uniform(&state, -1e-3, 1e-3);
            from[a] = middle - step;
            to[a] = middle + step;
        }
        for (int i = 0; i < BATCH; i++)
            for (int a = 0; a < 3; a++) {
                p.in[i].at[a] = (float)(from[a] + (to[a] - from[a]) * i / (BATCH - 1.0));
                p.in[i].lod = 0.3f;
            }
        run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
        /* A step is at most 2·1.8e-3/511 long: on a face of 8 texels across 2 units, 8 texels a unit with the slant of
         * a corner, under 6e-5 texels; two axes of unit contrast plus rounding. */
        for (int i = 1; i < BATCH; i++)
            for (int k = 0; k < 4; k++)
                assert_true(fabsf(p.out[i][k] - p.out[i - 1][k]) < 1.5e-4f);
    }
    close_both(&b);
}

static void test_corner_is_average_of_three(void **unused)
{
    (void)unused;
    uint32_t state = 10;
    static batch p;
    both b = make_both(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA32F, 4, 4, 1, false, &state);
    amb_sampler s = {.filter = AMB_BILINEAR};
    for (int i = 0; i < BATCH; i++)
        for (int a = 0; a < 3; a++)
            p.in[i].at[a] = i & (1 << a) ? 1.0f : -1.0f;
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    /* At a cube's corner four weights of ¼ meet three texels and their average: the average. The texels nearest to
     * (+,+,+): face +x top left, +y bottom right, +z top right. */
    const ref_color *t = b.reference->texel[0];
    for (int k = 0; k < 4; k++) {
        double want = (t[0].c[k] + t[2 * 16 + 15].c[k] + t[4 * 16 + 3].c[k]) / 3.0;
        assert_true(fabs((double)p.out[7][k] - want) < 1e-6);
    }
    close_both(&b);
}

/* Face order and orientation: each face's middle and its first texel, from the published table. */
static void test_cube_orientation(void **unused)
{
    (void)unused;
    static const float middle[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const float top_left[6][3] = {{1, .9f, .9f},   {-1, .9f, -.9f}, {-.9f, 1, -.9f},
                                         {-.9f, -1, .9f}, {-.9f, .9f, 1},  {.9f, .9f, -1}};
    unsigned char data[6 * 9];
    for (int i = 0; i < 54; i++)
        data[i] = (unsigned char)(i / 9 * 10 + (i % 9 == 0 ? 5 : 0)); /* the first texel is marked */
    amb_texture_desc desc = {.kind = AMB_TEXTURE_CUBE,
                             .texel = AMB_TEXEL_R8,
                             .width = 3,
                             .height = 3,
                             .data = data,
                             .data_bytes = sizeof data};
    both b = {0};
    assert_int_equal(amb_texture_create(&desc, &b.texture, NULL), AMB_OK);
    amb_sampler s = {.filter = AMB_NEAREST};
    static batch p;
    for (int i = 0; i < BATCH; i++)
        memcpy(p.in[i].at, i % 12 < 6 ? middle[i % 6] : top_left[i % 6], sizeof p.in[i].at);
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    for (int i = 0; i < 12; i++)
        assert_int_equal((int)(p.out[i][0] * 255.0f + 0.5f), i % 6 * 10 + (i < 6 ? 0 : 5));
    amb_texture_close(&b.texture);
}

/* ---- hostile coordinates ---------------------------------------------------------------------------------------- */

static void test_hostile_coordinates(void **unused)
{
    (void)unused;
    static const float value[] = {NAN,    INFINITY,    -INFINITY,   3.4e38f,        -3.4e38f,     1e30f,
                                  -1e20f, 16777217.0f, -0.0f,       0.0f,           1e-45f,       -1e-45f,
                                  1.0f,   -1.0f,       0.99999994f, -2147483648.0f, 4294967296.0f};
    enum { VALUES = sizeof value / sizeof value[0] };
    uint32_t state = 11;
    static batch p;
    for (int kind = 0; kind < 3; kind++) {
        both b = make_both((amb_texture_kind)kind, AMB_TEXEL_RGBA8, 4, 4, 4, true, &state);
        for (int round = 0; round < 60; round++) {
            amb_sampler s = random_sampler(&state);
            s.max_anisotropy = (int)(next_random(&state) % 17);
            for (int i = 0; i < BATCH; i++) {
                float *f = (float *)&p.in[i];
                for (size_t k = 0; k < sizeof(probe) / sizeof(float); k++)
                    f[k] = value[next_random(&state) % VALUES];
            }
            static const probe_mode modes[3][2] = {
                {PROBE_2D_LOD, PROBE_2D_GRAD}, {PROBE_CUBE_LOD, PROBE_CUBE_GRAD}, {PROBE_3D_LOD, PROBE_3D_LOD}};
            for (int m = 0; m < 2; m++) {
                run_everywhere(&b, &s, modes[kind][m], &p);
                for (int i = 0; i < BATCH; i++)
                    for (int k = 0; k < 4; k++)
                        assert_true(p.out[i][k] >= 0.0f && p.out[i][k] <= 1.0001f);
            }
        }
        close_both(&b);
    }
}

static void test_nan_and_infinity_sample_zero(void **unused)
{
    (void)unused;
    uint32_t state = 12;
    static batch p;
    both b = make_both(AMB_TEXTURE_2D, AMB_TEXEL_RGBA8, 4, 4, 1, false, &state);
    amb_sampler s = {.filter = AMB_BILINEAR};
    memset(&p, 0, sizeof p);
    p.in[1].at[0] = NAN, p.in[2].at[0] = INFINITY, p.in[3].at[1] = -INFINITY, p.in[4].lod = NAN;
    run_everywhere(&b, &s, PROBE_2D_LOD, &p);
    for (int i = 1; i < 5; i++)
        assert_memory_equal(p.out[i], p.out[0], sizeof p.out[0]);
    close_both(&b);
}

/* ---- from images ------------------------------------------------------------------------------------------------ */

static void test_from_image_round_trips(void **unused)
{
    (void)unused;
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(16, 16, 3, &image, NULL), AMB_OK);
    static const double bound[TEXELS] = {0.5 / 255, 0.5 / 255, 0.5 / 255, 0.0045,  0x1p-12, 0x1p-12,
                                         0,         0,         0x1p-6,    0x1p-12, 0};
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 16; x++)
            for (int c = 0; c < 3; c++)
                amb_image_row(image, c, y)[x] = (float)(x + 16 * y) / 255.0f * (c == 1 ? 0.5f : 1.0f);
    for (int f = 0; f < TEXELS; f++) {
        both b = {0};
        assert_int_equal(amb_texture_from_image(image, every_texel[f], false, &b.texture, NULL), AMB_OK);
        static batch p;
        for (int i = 0; i < BATCH; i++)
            p.in[i] = (probe){.at = {((float)(i % 16) + 0.5f) / 16.0f, ((float)(i / 16 % 16) + 0.5f) / 16.0f}};
        amb_sampler s = {.filter = AMB_NEAREST};
        run_everywhere(&b, &s, PROBE_2D_LOD, &p);
        bool one =
            every_texel[f] == AMB_TEXEL_R8 || every_texel[f] == AMB_TEXEL_R16F || every_texel[f] == AMB_TEXEL_R32F;
        for (int i = 0; i < 256; i++) {
            assert_true(fabs((double)p.out[i][0] - i / 255.0) <= bound[f] + 1e-6);
            assert_true(fabs((double)p.out[i][1] - (one ? 0.0 : i / 510.0)) <= bound[f] + 1e-6);
            assert_true(p.out[i][3] == 1.0f);
        }
        amb_texture_close(&b.texture);
    }
    amb_image_close(&image);
}

/* Every sRGB code comes back from its own linear value. */
static void test_srgb_codes_round_trip(void **unused)
{
    (void)unused;
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(256, 1, 1, &image, NULL), AMB_OK);
    for (int c = 0; c < 256; c++) {
        unsigned char bytes[4] = {(unsigned char)c};
        /* Off the exact value by up to a third of a code, which still is the nearest. */
        unsigned char neighbour[4] = {(unsigned char)(c + (c < 255))};
        double value = ref_decode(AMB_TEXEL_SRGB8_A8, bytes).c[0],
               next = ref_decode(AMB_TEXEL_SRGB8_A8, neighbour).c[0];
        amb_image_row(image, 0, 0)[c] = (float)(value + 0.3 * (next - value));
    }
    both b = {0};
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_SRGB8_A8, false, &b.texture, NULL), AMB_OK);
    static batch p;
    for (int i = 0; i < BATCH; i++)
        p.in[i].at[0] = ((float)(i % 256) + 0.5f) / 256.0f;
    amb_sampler s = {.filter = AMB_NEAREST};
    run_everywhere(&b, &s, PROBE_2D_LOD, &p);
    for (int c = 0; c < 256; c++) {
        unsigned char bytes[4] = {(unsigned char)c};
        double want = ref_decode(AMB_TEXEL_SRGB8_A8, bytes).c[0];
        if (!(fabs((double)p.out[c][0] - want) <= 0x1.01p-11 * want))
            fail_msg("code %d: %.9g, reference %.9g", c, (double)p.out[c][0], want);
    }
    amb_texture_close(&b.texture);
    amb_image_close(&image);
}

static void test_cube_from_images(void **unused)
{
    (void)unused;
    amb_image *face[6] = {NULL};
    for (int i = 0; i < 6; i++) {
        assert_int_equal(amb_image_create(4, 4, 3, &face[i], NULL), AMB_OK);
        for (int y = 0; y < 4; y++)
            for (int x = 0; x < 4; x++)
                amb_image_row(face[i], 0, y)[x] = (float)i;
    }
    both b = {0};
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, NULL), AMB_OK);
    static batch p;
    for (int i = 0; i < BATCH; i++)
        p.in[i].at[i % 6 / 2] = i % 2 ? -2.0f : 2.0f;
    amb_sampler s = {.filter = AMB_TRILINEAR};
    run_everywhere(&b, &s, PROBE_CUBE_LOD, &p);
    for (int i = 0; i < 6; i++)
        assert_true(p.out[i][0] == (float)i);
    amb_texture_close(&b.texture);

    amb_error error;
    amb_image_close(&face[5]);
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, &error),
                     AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: face -z is NULL; it must be an image");
    assert_int_equal(amb_image_create(5, 4, 3, &face[5], NULL), AMB_OK);
    assert_int_equal(amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, &b.texture, &error),
                     AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "texture: face -z is 5 x 4; all faces must be 4 x 4, as face +x is wide");
    for (int i = 0; i < 6; i++)
        amb_image_close(&face[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_2d_matches_reference),
        cmocka_unit_test(test_3d_matches_reference),
        cmocka_unit_test(test_cube_matches_reference),
        cmocka_unit_test(test_cube_anisotropy),
        cmocka_unit_test(test_quads_give_the_gradients),
        cmocka_unit_test(test_mips_match_brute_force),
        cmocka_unit_test(test_given_levels_are_kept),
        cmocka_unit_test(test_constant_stays_constant),
        cmocka_unit_test(test_cube_is_continuous),
        cmocka_unit_test(test_corner_is_average_of_three),
        cmocka_unit_test(test_cube_orientation),
        cmocka_unit_test(test_hostile_coordinates),
        cmocka_unit_test(test_nan_and_infinity_sample_zero),
        cmocka_unit_test(test_from_image_round_trips),
        cmocka_unit_test(test_srgb_codes_round_trip),
        cmocka_unit_test(test_cube_from_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
