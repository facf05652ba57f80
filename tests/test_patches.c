/* Tessellated draws: exact coverage, the pixels of the same triangles drawn one by one, the same bits however run. */
#include "raster/internal.h"
#include "tests/raster_shaders.h"
#include "tests/stage_draws.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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
    m.clip = calloc((size_t)(columns + 1) * (size_t)(rows + 1), sizeof *m.clip);
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

#define WIDTH 320
#define HEIGHT 200

/* Patches of different factors meet without crack or overlap: coverage is one everywhere, where what rounding to the
 * window's grid turned over counts against it. */
static void meshes_cover_every_pixel_once(void **state)
{
    (void)state;
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    for (uint32_t round = 0; round < 36; round++) {
        const amb_patch_shape shape = round & 1u ? AMB_TRIANGLE : AMB_QUAD;
        const amb_partitioning partitioning = (amb_partitioning)(round / 2 % 3);
        mesh m = make_mesh(2 + (int)round % 5, 3 + (int)round % 4, shape, round + 1);
        stage_test_uniforms uniforms;
        amb_pass_stats stats;
        amb_draw d = mesh_draw(context, &m, &uniforms, shape, partitioning);
        amb_image *image = draw_image(context, &d, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &stats);
        int wrong = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
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

/* ---- draws against the same triangles drawn one by one ---------------------------------------------------------- */

static raster_test_vertex evaluate(const mesh *m, amb_patch_shape shape, uint32_t patch, float u, float v)
{
    const uint32_t *c = m->index + patch * (shape == AMB_QUAD ? 4 : 3);
    const float *p[4];
    raster_test_vertex out;
    float *clip = &out.clip.x;
    for (uint32_t k = 0; k < 4; k++)
        p[k] = &m->clip[c[k < 3 || shape == AMB_QUAD ? k : 0]].x;
    for (int i = 0; i < 4; i++) {
        if (shape == AMB_QUAD)
            clip[i] = (p[0][i] * ((1.0f - u) * (1.0f - v)) + p[1][i] * (u * (1.0f - v))) +
                      (p[2][i] * (u * v) + p[3][i] * ((1.0f - u) * v));
        else
            clip[i] = (p[0][i] * u + p[1][i] * v) + p[2][i] * ((1.0f - u) - v);
    }
    out.value = (v4){u, v, (float)patch, 0.0f};
    return out;
}

typedef struct list {
    raster_test_vertex *vertex;
    uint32_t count;
} list;

/* Every triangle of every patch, or every point. */
static list expand(const mesh *m, const amb_tessellation *t)
{
    list l = {NULL, 0};
    raster_pattern p = {0};
    for (uint32_t patch = 0; patch < m->patches; patch++) {
        const float *factor = m->factor + (size_t)patch * 6;
        const raster_factors f = raster_clamp_factors(t->shape, t->partitioning, factor, factor + 4);
        if (f.edge[0] == 0)
            continue;
        assert_true(raster_make_pattern(&p, t->shape, t->partitioning, &f));
        const uint32_t corners = (uint32_t)(t->points ? p.size.points : 3 * p.size.triangles);
        l.vertex = realloc(l.vertex, (l.count + corners) * sizeof *l.vertex);
        assert_non_null(l.vertex);
        for (uint32_t i = 0; i < corners; i++) {
            uint32_t from = t->clockwise ? i - i % 3 + (3 - i % 3) % 3 : i, point = t->points ? i : p.corner[from];
            l.vertex[l.count++] = evaluate(m, t->shape, patch, p.u[point], p.v[point]);
        }
    }
    raster_free_pattern(&p);
    return l;
}

static void compare_draws(const amb_context *context, const amb_draw *draw, const mesh *m, amb_topology output)
{
    const raster_test_shaders *plain = raster_test_shaders_of(amb_context_isa(context));
    const list expected = expand(m, &draw->tessellation);
    const raster_test_uniforms uniforms = {.vertex = expected.vertex};
    amb_draw direct = *draw;
    amb_pass_stats stats, direct_stats;
    direct.vertex = plain->vertex;
    direct.uniforms = &uniforms;
    direct.uniforms_size = sizeof uniforms;
    direct.indices = NULL;
    direct.vertex_count = 0;
    direct.count = expected.count;
    direct.topology = output;
    direct.tessellation = (amb_tessellation){0};
    direct.geometry = (amb_geometry){0};
    amb_image *a = draw_image(context, draw, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &stats);
    amb_image *b = draw_image(context, &direct, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &direct_stats);
    assert_same_pixels(a, b);
    assert_int_equal(stats.triangles_in, direct_stats.triangles_in);
    assert_int_equal(stats.triangles_culled, direct_stats.triangles_culled);
    assert_int_equal(stats.triangles_binned, direct_stats.triangles_binned);
    assert_int_equal(stats.fragments_shaded, direct_stats.fragments_shaded);
    assert_true(stats.fragments_shaded > 2000);
    amb_image_close(&a);
    amb_image_close(&b);
    free(expected.vertex);
}

/* Blended in order, with culling, both turns, wireframe, points, a geometry shader behind, and some patches culled. */
static void draws_are_their_triangles(void **state)
{
    (void)state;
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    for (uint32_t round = 0; round < 24; round++) {
        const amb_patch_shape shape = round & 1u ? AMB_TRIANGLE : AMB_QUAD;
        mesh m = make_mesh(4, 5, shape, round + 100);
        stage_test_uniforms uniforms;
        amb_draw d = mesh_draw(context, &m, &uniforms, shape, (amb_partitioning)(round / 2 % 3));
        for (uint32_t i = 0; i < m.patches * 6 && round % 6 == 5; i++)
            m.factor[i] = 64.0f; /* more than a chunk holds */
        for (uint32_t patch = 0; patch < m.patches; patch++)
            if (patch % 5 == 2)
                m.factor[patch * 6 + patch % 3] = patch % 2 ? NAN : 0.0f;
        d.fragment = s->shade;
        d.blend[0] = AMB_BLEND_ALPHA;
        d.tessellation.clockwise = round % 3 == 1;
        d.tessellation.points = round % 8 == 7;
        d.wireframe = round % 8 == 6;
        d.cull = round % 4 != 3 ? AMB_CULL_NONE : d.tessellation.clockwise ? AMB_CULL_FRONT : AMB_CULL_BACK;
        d.point_size = 3.0f;
        if (round / 6 % 2 == 1 && !d.tessellation.points)
            d.geometry = (amb_geometry){.shader = s->same, .vertices = 3};
        compare_draws(context, &d, &m, d.tessellation.points ? AMB_POINTS : AMB_TRIANGLES);
        free_mesh(&m);
    }
    amb_context_close(&context);
}

/* ---- same everywhere -------------------------------------------------------------------------------------------- */

/* Enough patches for several windows, some of 8192 triangles, which no chunk holds. */
static void pixels_depend_on_nothing_else(void **state)
{
    (void)state;
    static const amb_isa isas[3] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    static const int tiles[4] = {16, 32, 64, 128};
    for (int which = 0; which < 2; which++) {
        mesh m = make_mesh(which ? 150 : 6, which ? 120 : 5, AMB_QUAD, 7);
        amb_image *first = NULL;
        amb_pass_stats first_stats = {0};
        for (uint32_t i = 0; i < m.patches * 6; i++)
            m.factor[i] = which ? 1.0f + 0.5f * (float)(i * 7 % 5) : 64.0f - (float)(i % 4);
        for (int i = 0; i < 12; i++) {
            if (!amb_isa_available(isas[i % 3]))
                continue;
            amb_context *context = make_context(isas[i % 3], 1 + i % 5);
            stage_test_uniforms uniforms;
            amb_pass_stats stats;
            amb_draw d = mesh_draw(context, &m, &uniforms, AMB_QUAD, AMB_FRACTIONAL_EVEN);
            d.fragment = stage_test_shaders_of(isas[i % 3])->number;
            amb_image *image =
                draw_image(context, &d, WIDTH, HEIGHT, tiles[i / 3], i & 1 ? 0 : RASTER_BATCH_BYTES, &stats);
            if (!first) {
                first = image, first_stats = stats;
            } else {
                stats.blocks_shaded = first_stats.blocks_shaded; /* which depends on the lanes */
                assert_memory_equal(&stats, &first_stats, sizeof stats);
                assert_same_pixels(first, image);
                amb_image_close(&image);
            }
            amb_context_close(&context);
        }
        assert_true(first_stats.triangles_in > 100000);
        amb_image_close(&first);
        free_mesh(&m);
    }
}

/* ---- instances, indices, errors --------------------------------------------------------------------------------- */

static void instances_and_bad_indices(void **state)
{
    (void)state;
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    mesh m = make_mesh(5, 5, AMB_QUAD, 3);
    stage_test_uniforms uniforms;
    amb_pass_stats stats;
    m.factor = realloc(m.factor, (size_t)m.patches * 18 * sizeof *m.factor);
    for (uint32_t i = m.patches * 6; i < m.patches * 18; i++)
        m.factor[i] = i % 6 == 0 && i / 6 % 25 < 3 ? 0.0f : 2.0f; /* three patches culled, of two instances */
    m.index[4 * 7 + 1] = 36;                                      /* one more than there are */
    m.index[4 * 9 + 3] = UINT32_MAX;
    amb_draw d = mesh_draw(context, &m, &uniforms, AMB_QUAD, AMB_INTEGER);
    d.instances = 3;
    d.fragment = s->number;
    d.blend[0] = AMB_BLEND_OFF;
    amb_image *image = draw_image(context, &d, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &stats);
    assert_int_equal(stats.patches, 75);
    assert_int_equal(stats.patches_culled, 2 * 3 + 2 * 3);
    int seen[75] = {0};
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const int patch = (int)amb_image_row(image, 2, y)[x];
            assert_in_range(patch, 0, 74);
            if (amb_image_row(image, 3, y)[x] != 0.0f)
                assert_int_equal(patch, (int)amb_image_row(image, 3, y)[x]); /* the hull's number, the fragment's */
            seen[patch]++;
        }
    for (int i = 50; i < 75; i++) /* the last instance is on top, but for what it lacks */
        assert_true((seen[i] > 0) == (i >= 53 && i != 57 && i != 59));
    amb_image_close(&image);
    free_mesh(&m);
    amb_context_close(&context);
}

static void bad_draws_are_refused(void **state)
{
    (void)state;
    amb_context *context = make_context(AMB_ISA_AUTO, 1);
    mesh m = make_mesh(2, 2, AMB_QUAD, 1);
    stage_test_uniforms uniforms;
    amb_image *image = NULL;
    amb_pass *pass = NULL;
    assert_int_equal(amb_image_create(8, 8, 4, &image, NULL), AMB_OK);
    amb_target target = {.color = {image}};
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    amb_draw good = mesh_draw(context, &m, &uniforms, AMB_QUAD, AMB_INTEGER), d;
    assert_int_equal(amb_pass_draw(pass, &good, NULL), AMB_OK);
    d = good, d.tessellation.hull = NULL, refuse(pass, &d, "patches need a hull shader");
    d = good, d.tessellation.domain = NULL, refuse(pass, &d, "patches need a domain shader");
    d = good, d.topology = AMB_TRIANGLES, refuse(pass, &d, "a hull shader needs the topology AMB_PATCHES");
    d = good, d.tessellation.corners = 0, refuse(pass, &d, "tessellation.corners is 0; 1 to 32 are allowed");
    d = good, d.tessellation.corners = 33, refuse(pass, &d, "tessellation.corners is 33");
    d = good, d.tessellation.patch_floats = 129, refuse(pass, &d, "tessellation.patch_floats is 129; 0 to 128");
    d = good, d.tessellation.shape = (amb_patch_shape)2, refuse(pass, &d, "tessellation.shape is 2; 0 to 1");
    d = good, d.tessellation.partitioning = (amb_partitioning)3, refuse(pass, &d, "tessellation.partitioning is 3");
    d = good, d.vertex = stage_test_shaders_of(amb_context_isa(context))->vertex;
    refuse(pass, &d, "patches have no vertex shader");
    amb_pass_close(&pass);
    amb_image_close(&image);
    free_mesh(&m);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_cover_every_pixel_once), cmocka_unit_test(draws_are_their_triangles),
        cmocka_unit_test(pixels_depend_on_nothing_else), cmocka_unit_test(instances_and_bad_indices),
        cmocka_unit_test(bad_draws_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
