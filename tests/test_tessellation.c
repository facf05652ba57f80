/* The tessellator against the rules of Direct3D 11, and tessellated draws against exact coverage. */
#include "raster/internal.h"
#include "tests/stage_shaders.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t random_state = 1;

static uint32_t random_bits(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    uint64_t x = random_state ^ random_state >> 33;
    return (uint32_t)((x * 0xff51afd7ed558ccdu) >> 32);
}
static float uniform(float lo, float hi) { return lo + (hi - lo) * (float)(random_bits() >> 8) * 0x1p-24f; }
static int pick(int count) { return (int)(random_bits() % (uint32_t)count); }

/* Mostly small ones, whole ones, almost whole ones, ones out of range. */
static float random_factor(void)
{
    switch (pick(6)) {
    case 0:
        return 1.0f;
    case 1:
        return (float)(1 + pick(64));
    case 2:
        return (float)(1 + pick(64)) + uniform(-0.01f, 0.01f);
    case 3:
        return uniform(0.01f, 70.0f);
    default:
        return uniform(0.5f, 8.0f);
    }
}

/* ---- patterns --------------------------------------------------------------------------------------------------- */

typedef struct factors {
    float edge[4], inside[2];
} factors;

static factors random_factors(void)
{
    factors f;
    for (int i = 0; i < 4; i++)
        f.edge[i] = random_factor();
    for (int i = 0; i < 2; i++)
        f.inside[i] = random_factor();
    if (pick(8) == 0)
        for (int i = 0; i < 4; i++)
            f.edge[i] = f.inside[i & 1] = 1.0f;
    return f;
}

static int64_t fixed(float a) { return (int64_t)((double)a * 65536.0); }

/* Twice the area, in 1/65536 squared. Rounding may turn over a triangle of no width, by a unit. */
static int64_t doubled_area(const raster_pattern *p, const uint16_t *c)
{
    int64_t x[3], y[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        assert_true(c[k] < p->size.points);
        x[k] = fixed(p->u[c[k]]), y[k] = fixed(p->v[c[k]]);
    }
    for (int k = 0; k < 3; k++) {
        int64_t dx = x[(k + 1) % 3] - x[k], dy = y[(k + 1) % 3] - y[k];
        longest = dx * dx + dy * dy > longest ? dx * dx + dy * dy : longest;
    }
    int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    assert_true(area >= 0 || area * area <= 2 * longest);
    return area;
}

/* Areas sum to the domain's, exactly. */
static void check_area(const raster_pattern *p, amb_patch_shape shape)
{
    const int64_t whole = (shape == AMB_QUAD ? 2 : 1) * (int64_t)65536 * 65536;
    int64_t area = 0;
    for (uint32_t i = 0; i < p->size.triangles; i++) {
        const uint16_t *c = p->corner + (size_t)3 * i;
        assert_true(c[0] != c[1] && c[1] != c[2] && c[2] != c[0]);
        area += doubled_area(p, c);
    }
    assert_true(area == whole);
}

static int compare_edges(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static uint32_t segments_of(uint32_t factor, amb_partitioning partitioning)
{
    uint32_t up = (factor + 65535) / 65536;
    if (partitioning == AMB_INTEGER)
        return up;
    return (up & 1u) == (partitioning == AMB_FRACTIONAL_ODD) ? up : up + 1;
}

/* Inner edges belong to two triangles that run along them in opposite directions, outer ones to one triangle: neither
 * hole nor T. There are as many outer ones as the edges have segments, and Euler's formula tells a disc. */
static void check_topology(const raster_pattern *p, const raster_factors *f, amb_patch_shape shape,
                           amb_partitioning partitioning)
{
    static uint32_t edge[3 * RASTER_PATTERN_TRIANGLES];
    const uint32_t edges = 3 * p->size.triangles;
    uint32_t outer = 0, segments = 0;
    for (uint32_t i = 0; i < edges; i++) {
        uint32_t a = p->corner[i], b = p->corner[i % 3 == 2 ? i - 2 : i + 1];
        edge[i] = a < b ? a << 17 | b << 1 : b << 17 | a << 1 | 1u;
    }
    qsort(edge, edges, sizeof *edge, compare_edges);
    for (uint32_t i = 0; i < edges; i++) {
        assert_true(i == 0 || edge[i] != edge[i - 1]);
        outer += (i == 0 || edge[i - 1] != (edge[i] ^ 1u)) && (i + 1 == edges || edge[i + 1] != (edge[i] ^ 1u));
    }
    for (int i = 0; i < (shape == AMB_QUAD ? 4 : 3); i++)
        segments += segments_of(f->edge[i], partitioning);
    assert_int_equal(outer, segments);
    assert_int_equal((int)p->size.points - (int)(edges + outer) / 2 + (int)p->size.triangles, 1);
}

static void patterns_cover_their_domain_once(void **state)
{
    (void)state;
    raster_pattern p = {0};
    for (int round = 0; round < 6000; round++) {
        const amb_patch_shape shape = (amb_patch_shape)pick(2);
        const amb_partitioning partitioning = (amb_partitioning)pick(3);
        const factors f = random_factors();
        const raster_factors clamped = raster_clamp_factors(shape, partitioning, f.edge, f.inside);
        const raster_pattern_size size = raster_size_pattern(shape, partitioning, &clamped);
        assert_true(raster_make_pattern(&p, shape, partitioning, &clamped));
        assert_int_equal(size.points, p.size.points);
        assert_int_equal(size.triangles, p.size.triangles);
        assert_true(size.points <= RASTER_PATTERN_POINTS && size.triangles <= RASTER_PATTERN_TRIANGLES);
        check_area(&p, shape);
        if (round % 8 == 0)
            check_topology(&p, &clamped, shape, partitioning);
    }
    raster_free_pattern(&p);
}

/* ---- drawing ---------------------------------------------------------------------------------------------------- */

typedef struct mesh {
    int columns, rows;
    v4 *clip;
    uint32_t *index;
    float *factor;
    uint32_t patches;
} mesh;

/* A factor of the edge between two corners, the same from both sides. */
static float edge_factor(uint32_t a, uint32_t b, uint32_t seed)
{
    random_state = (uint64_t)(a < b ? a : b) << 40 ^ (uint64_t)(a < b ? b : a) << 8 ^ seed;
    random_bits();
    return random_factor();
}

/* A net of patches over more than the window, its inner corners moved about, every patch turned at random. */
static mesh make_mesh(int columns, int rows, amb_patch_shape shape, uint32_t seed)
{
    mesh m = {.columns = columns, .rows = rows};
    const uint32_t corners = shape == AMB_QUAD ? 4 : 3;
    m.patches = (uint32_t)(columns * rows) * (shape == AMB_QUAD ? 1 : 2);
    m.clip = calloc((size_t)((columns + 1) * (rows + 1)), sizeof *m.clip);
    m.index = calloc(m.patches * corners + 4, sizeof *m.index);
    m.factor = calloc((size_t)m.patches * 6, sizeof *m.factor);
    random_state = seed;
    for (int y = 0; y <= rows; y++)
        for (int x = 0; x <= columns; x++) {
            float dx = x == 0 || x == columns ? 0.0f : uniform(-0.3f, 0.3f);
            float dy = y == 0 || y == rows ? 0.0f : uniform(-0.3f, 0.3f);
            m.clip[y * (columns + 1) + x] = (v4){((float)x + dx) / (float)columns * 2.2f - 1.1f,
                                                 ((float)y + dy) / (float)rows * 2.2f - 1.1f, 0.5f, 1.0f};
        }
    uint32_t patch = 0;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++)
            for (uint32_t half = 0; half < (shape == AMB_QUAD ? 1u : 2u); half++, patch++) {
                uint32_t at = (uint32_t)(y * (columns + 1) + x), right = at + 1, up = at + (uint32_t)columns + 1;
                uint32_t around[4] = {at, right, up + 1, up};
                if (shape == AMB_TRIANGLE && half == 1)
                    around[0] = at, around[1] = up + 1, around[2] = up;
                random_state = seed * 77u + patch;
                uint32_t turn = random_bits() % corners;
                uint32_t *c = m.index + patch * corners;
                float *f = m.factor + (size_t)patch * 6;
                for (uint32_t k = 0; k < corners; k++)
                    c[k] = around[(k + turn) % corners];
                if (shape == AMB_QUAD) { /* u = 0: corners 0 and 3; v = 0: 0 and 1; u = 1: 1 and 2; v = 1: 3 and 2 */
                    f[0] = edge_factor(c[0], c[3], seed), f[1] = edge_factor(c[0], c[1], seed);
                    f[2] = edge_factor(c[1], c[2], seed), f[3] = edge_factor(c[3], c[2], seed);
                } else {
                    f[0] = edge_factor(c[1], c[2], seed), f[1] = edge_factor(c[0], c[2], seed);
                    f[2] = edge_factor(c[0], c[1], seed);
                }
                random_state = seed * 99u + patch;
                f[4] = random_factor(), f[5] = random_factor();
            }
    return m;
}

static void free_mesh(mesh *m)
{
    free(m->clip);
    free(m->index);
    free(m->factor);
}

static amb_draw mesh_draw(const amb_context *context, const mesh *m, stage_test_uniforms *uniforms,
                          amb_patch_shape shape, amb_partitioning partitioning)
{
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const uint32_t corners = shape == AMB_QUAD ? 4 : 3;
    *uniforms = (stage_test_uniforms){.clip = m->clip, .corners = (int)corners, .factor = m->factor};
    amb_draw d = {.lanes = s->lanes,
                  .fragment = s->covered,
                  .uniforms = uniforms,
                  .uniforms_size = sizeof *uniforms,
                  .varying_floats = 4,
                  .indices = m->index,
                  .count = m->patches * corners,
                  .vertex_count = (uint32_t)((m->columns + 1) * (m->rows + 1)),
                  .blend = {AMB_BLEND_ADD},
                  .topology = AMB_PATCHES};
    d.tessellation = (amb_tessellation){.hull = s->hull,
                                        .domain = shape == AMB_QUAD ? s->quad : s->triangle,
                                        .corners = (int)corners,
                                        .patch_floats = 16,
                                        .shape = shape,
                                        .partitioning = partitioning};
    return d;
}

/* Patches of different factors meet without crack or overlap: signed coverage is one everywhere. */
static void meshes_cover_every_pixel_once(void **state)
{
    (void)state;
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (uint32_t round = 0; round < 24; round++) {
        const amb_patch_shape shape = round & 1u ? AMB_TRIANGLE : AMB_QUAD;
        const amb_partitioning partitioning = (amb_partitioning)(round / 2 % 3);
        mesh m = make_mesh(2 + (int)round % 5, 3 + (int)round % 4, shape, round + 1);
        amb_image *image = NULL;
        amb_pass *pass = NULL;
        stage_test_uniforms uniforms;
        amb_error error = {0};
        amb_pass_stats stats;
        assert_int_equal(amb_image_create(320, 200, 2, &image, NULL), AMB_OK);
        amb_target target = {.color = {image}};
        assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
        amb_draw d = mesh_draw(context, &m, &uniforms, shape, partitioning);
        if (amb_pass_draw(pass, &d, &error) != AMB_OK)
            fail_msg("%s", error.detail);
        assert_int_equal(amb_pass_finish(&pass, &stats, NULL), AMB_OK);
        int wrong = 0;
        for (int y = 0; y < 200; y++)
            for (int x = 0; x < 320; x++)
                wrong += amb_image_row(image, 0, y)[x] != 1.0f;
        if (wrong != 0)
            fail_msg("round %u: %d pixels are not covered once", round, wrong);
        assert_int_equal(stats.patches, m.patches);
        assert_int_equal(stats.patches_culled, 0);
        amb_image_close(&image);
        free_mesh(&m);
    }
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns_cover_their_domain_once),
        cmocka_unit_test(meshes_cover_every_pixel_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
