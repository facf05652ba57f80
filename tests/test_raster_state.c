/* State: order, blending, depth, discard, full-screen draws, kept targets, hostile input, errors, and the same bits
 * from every instruction set, thread count, tile size and batch size. */
#include "raster/internal.h"
#include "tests/raster_shaders.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t random_state = 3;

static double uniform(double lo, double hi)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(random_state >> 40) / 16777216.0;
}

static amb_context *context_of(amb_isa isa, int threads)
{
    amb_context_options options = {isa, threads};
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    return context;
}

static amb_image *image_of(int width, int height, int channels)
{
    amb_image *image = NULL;
    assert_int_equal(amb_image_create(width, height, channels, &image, NULL), AMB_OK);
    return image;
}

static float pixel(const amb_image *image, int channel, int x, int y) { return amb_image_row(image, channel, y)[x]; }

/* A triangle over the whole window at depth z. */
static void cover_all(raster_test_vertex v[3], float z, v4 value)
{
    const float corner[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
    for (int i = 0; i < 3; i++)
        v[i] = (raster_test_vertex){{corner[i][0], corner[i][1], z, 1}, value};
}

static amb_draw draw_of(const raster_test_shaders *s, const raster_test_uniforms *u, uint32_t count)
{
    return (amb_draw){.label = "test",
                      .lanes = s->lanes,
                      .vertex = s->vertex,
                      .fragment = s->value,
                      .uniforms = u,
                      .uniforms_size = sizeof *u,
                      .varying_floats = 4,
                      .count = count};
}

/* ---- one pass with everything, whatever runs it -------------------------------------------------------------------
 */

#define SCENE_TRIANGLES 9000

typedef struct scene {
    raster_test_vertex *vertex;
    uint32_t *index;
} scene;

static scene make_scene(void)
{
    scene s = {calloc(SCENE_TRIANGLES * 3, sizeof(raster_test_vertex)), calloc(SCENE_TRIANGLES * 3, sizeof(uint32_t))};
    for (int i = 0; i < SCENE_TRIANGLES; i++) {
        double cx = uniform(-1.1, 1.1), cy = uniform(-1.1, 1.1), size = i % 50 == 0 ? 2.0 : i % 9 == 0 ? 0.3 : 0.03;
        for (int k = 0; k < 3; k++) {
            double w = exp(uniform(-1, 1)) * (i % 31 == 0 && k == 0 ? -1 : 1);
            s.vertex[i * 3 + k].clip =
                (v4){(float)((cx + uniform(-size, size)) * w), (float)((cy + uniform(-size, size)) * w),
                     (float)(uniform(0, 1) * w), (float)w};
            s.vertex[i * 3 + k].value =
                (v4){(float)uniform(0, 2), (float)uniform(0, 1), (float)uniform(-1, 1), (float)uniform(0, 1)};
            s.index[i * 3 + k] = (uint32_t)(i * 3 + k);
        }
    }
    return s;
}

static amb_pass_stats render_scene(const scene *s, amb_isa isa, int threads, int tile, size_t batch, char digest[4][65])
{
    const int width = 233, height = 147;
    amb_context *context = context_of(isa, threads);
    const raster_test_shaders *shaders = raster_test_shaders_of(isa);
    amb_image *image[4] = {image_of(width, height, 4), image_of(width, height, 3), image_of(width, height, 4),
                           image_of(width, height, 1)};
    amb_target target = {.color = {image[0], image[1], image[2]},
                         .depth = image[3],
                         .clear_depth = 1.0f,
                         .clear_color = {{0.1f, 0.2f, 0.3f, 0.4f}}};
    raster_test_uniforms u = {.vertex = s->vertex, .depth = 0.5f, .discard = 0.4f};
    amb_pass *pass = NULL;
    assert_int_equal(raster_pass_begin(context, &target, tile, batch, &pass, NULL), AMB_OK);
    amb_draw d = draw_of(shaders, &u, SCENE_TRIANGLES);
    d.indices = s->index, d.vertex_count = SCENE_TRIANGLES * 3;
    d.blend[0] = AMB_BLEND_ALPHA, d.blend[1] = AMB_BLEND_ADD;
    d.targets_off = 2;
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    amb_draw screen = {.lanes = shaders->lanes, .fragment = shaders->screen, .blend = {AMB_BLEND_ADD}};
    assert_int_equal(amb_pass_draw(pass, &screen, NULL), AMB_OK);
    d.indices = s->index + SCENE_TRIANGLES, d.depth_compare = AMB_ALWAYS, d.depth_write_off = true;
    d.blend[0] = AMB_BLEND_MULTIPLY, d.targets_off = 0;
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    d.indices = s->index + SCENE_TRIANGLES * 2, d.fragment = shaders->write_depth, d.writes_depth = true;
    d.depth_write_off = false, d.depth_compare = AMB_LESS, d.blend[0] = AMB_BLEND_ALPHA, d.instances = 3;
    u.offset = (v4){0.1f, 0, 0, 0}; /* uniforms were copied when drawn */
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    amb_pass_stats stats;
    assert_int_equal(amb_pass_finish(&pass, &stats, NULL), AMB_OK);
    for (int i = 0; i < 4; i++) {
        amb_image_sha256(image[i], digest[i]);
        amb_image_close(&image[i]);
    }
    amb_context_close(&context);
    return stats;
}

static void nothing_changes_the_bits(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    const int threads[] = {1, 2, 5}, tiles[] = {16, 32, 64, 128};
    scene s = make_scene();
    char first[4][65], other[4][65];
    amb_pass_stats a = render_scene(&s, AMB_ISA_V2, 1, 64, RASTER_BATCH_BYTES, first);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4 && amb_isa_available(isas[i]); k++) {
            amb_pass_stats b =
                render_scene(&s, isas[i], threads[k % 3], tiles[k], k % 2 ? RASTER_BATCH_BYTES : 0, other);
            for (int n = 0; n < 4; n++)
                assert_string_equal(first[n], other[n]);
            assert_int_equal(a.vertices, b.vertices);
            assert_int_equal(a.triangles_in, b.triangles_in);
            assert_int_equal(a.triangles_clipped, b.triangles_clipped);
            assert_int_equal(a.triangles_culled, b.triangles_culled);
            assert_int_equal(a.triangles_binned, b.triangles_binned);
            assert_int_equal(a.fragments_shaded, b.fragments_shaded);
        }
    assert_true(a.triangles_in == SCENE_TRIANGLES / 3 * 5);
    assert_true(a.triangles_clipped > 0);
    free(s.vertex);
    free(s.index);
}

/* ---- order, blending, depth ---------------------------------------------------------------------------------------
 */

static void triangles_blend_in_order(void **state)
{
    (void)state;
    enum { LAYERS = 6000 }; /* more than a chunk */
    amb_context *context = context_of(AMB_ISA_AUTO, 5);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image = image_of(5, 3, 4);
    amb_target target = {.color = {image}, .clear_color = {{1, 0, 0, 0.5f}}};
    raster_test_vertex *vertex = calloc(LAYERS * 3, sizeof *vertex);
    float color = 1, alpha = 0.5f;
    for (int i = 0; i < LAYERS; i++) {
        float value = (float)uniform(0, 1), a = (float)uniform(0, 0.2);
        cover_all(vertex + i * 3, 0.5f, (v4){value, 0, 0, a});
        color = value * a + color * (1.0f - a);
        alpha = a + alpha * (1.0f - a);
    }
    raster_test_uniforms u = {.vertex = vertex};
    amb_pass *pass = NULL;
    assert_int_equal(raster_pass_begin(context, &target, 16, 0, &pass, NULL), AMB_OK);
    amb_draw d = draw_of(shaders, &u, LAYERS * 3);
    d.blend[0] = AMB_BLEND_ALPHA;
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
    for (int i = 0; i < 15; i++) {
        assert_true(pixel(image, 0, i % 5, i / 5) == color);
        assert_true(pixel(image, 3, i % 5, i / 5) == alpha);
    }
    free(vertex);
    amb_image_close(&image);
    amb_context_close(&context);
}

/* Every compare mode against the three relations of new and stored depth. */
static void depth_compares(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    const int passes[9][3] = {{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                              {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    const float depth[3] = {0.25f, 0.5f, 0.75f};
    amb_image *image = image_of(4, 4, 4), *z = image_of(4, 4, 1);
    for (int compare = 0; compare < 9; compare++)
        for (int i = 0; i < 3; i++)
            for (int writes = 0; writes < 2; writes++) {
                raster_test_vertex vertex[3];
                cover_all(vertex, writes ? depth[i] * 0.5f : depth[i], (v4){1, 1, 1, 1});
                raster_test_uniforms u = {.vertex = vertex, .depth = 2.0f};
                amb_target target = {.color = {image}, .depth = z, .clear_depth = 0.5f};
                amb_pass *pass = NULL;
                assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
                amb_draw d = draw_of(shaders, &u, 3);
                d.depth_compare = (amb_compare)compare;
                d.writes_depth = writes != 0;
                d.fragment = writes ? shaders->write_depth : shaders->value;
                d.depth_write_off = compare % 2 != 0;
                assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
                assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
                assert_true(pixel(image, 0, 1, 1) == (passes[compare][i] ? 1.0f : 0.0f));
                assert_true(pixel(z, 0, 1, 1) == (passes[compare][i] && !d.depth_write_off ? depth[i] : 0.5f));
            }
    amb_image_close(&image);
    amb_image_close(&z);
    amb_context_close(&context);
}

static void discarded_fragments_write_nothing(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image = image_of(8, 8, 4), *z = image_of(8, 8, 1);
    raster_test_vertex vertex[3];
    cover_all(vertex, 0.25f, (v4){0, 0, 0, 0});
    vertex[1].value.x = 2.0f; /* value.x runs from 0 to 1 over the window's width */
    raster_test_uniforms u = {.vertex = vertex, .discard = 0.5f};
    amb_target target = {.color = {image}, .depth = z, .clear_depth = 1.0f, .clear_color = {{9, 9, 9, 9}}};
    amb_pass *pass = NULL;
    amb_pass_stats stats;
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    amb_draw d = draw_of(shaders, &u, 3);
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, &stats, NULL), AMB_OK);
    for (int x = 0; x < 8; x++) {
        bool kept = x >= 4;
        assert_true((pixel(image, 0, x, 3) == 9.0f) == !kept);
        assert_true(pixel(z, 0, x, 3) == (kept ? 0.25f : 1.0f));
    }
    assert_int_equal(stats.fragments_shaded, 64);
    amb_image_close(&image);
    amb_image_close(&z);
    amb_context_close(&context);
}

static void faces_are_told_by_winding(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image[3] = {image_of(4, 4, 4), image_of(4, 4, 4), image_of(4, 4, 4)};
    for (int i = 0; i < 12; i++) {
        bool reversed = i & 1, clockwise = i >> 1 & 1;
        amb_cull cull = (amb_cull)(i / 4);
        raster_test_vertex vertex[3];
        cover_all(vertex, 0.5f, (v4){1, 1, 1, 1}); /* counter-clockwise on the screen */
        if (reversed) {
            raster_test_vertex swap = vertex[1];
            vertex[1] = vertex[2], vertex[2] = swap;
        }
        bool front = reversed == clockwise;
        raster_test_uniforms u = {.vertex = vertex};
        amb_target target = {.color = {image[0], image[1], image[2]}};
        amb_pass *pass = NULL;
        assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
        amb_draw d = draw_of(shaders, &u, 3);
        d.cull = cull, d.front_clockwise = clockwise;
        assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
        assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        bool drawn = cull == AMB_CULL_NONE || (cull == AMB_CULL_BACK) == front;
        assert_true(pixel(image[0], 0, 2, 2) == (drawn ? 1.0f : 0.0f));
        assert_true(pixel(image[2], 1, 2, 2) == (drawn && front ? 1.0f : 0.0f));
    }
    for (int i = 0; i < 3; i++)
        amb_image_close(&image[i]);
    amb_context_close(&context);
}

/* ---- targets ------------------------------------------------------------------------------------------------------
 */

static void full_screen_draws_touch_every_pixel_once(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image = image_of(131, 71, 4), *z = image_of(131, 71, 1);
    amb_target target = {.color = {image}, .depth = z, .clear_depth = 1.0f};
    amb_pass *pass = NULL;
    amb_pass_stats stats;
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    amb_draw d = {.lanes = shaders->lanes, .fragment = shaders->screen, .blend = {AMB_BLEND_ADD}};
    assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, &stats, NULL), AMB_OK);
    for (int y = 0; y < 71; y++)
        for (int x = 0; x < 131; x++) {
            assert_true(pixel(image, 0, x, y) == (float)x + 0.5f && pixel(image, 1, x, y) == (float)y + 0.5f);
            assert_true(pixel(image, 2, x, y) == 1.0f && pixel(image, 3, x, y) == 1.0f);
        }
    assert_int_equal(stats.fragments_shaded, 131 * 71);
    amb_image_close(&image);
    amb_image_close(&z);
    amb_context_close(&context);
}

static void two_kept_passes_equal_one(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    scene s = make_scene();
    char digest[2][2][65];
    for (int split = 0; split < 2; split++) {
        amb_image *image = image_of(77, 59, 4), *z = image_of(77, 59, 1);
        amb_target target = {.color = {image}, .depth = z, .clear_depth = 0.8f, .clear_color = {{1, 2, 3, 4}}};
        raster_test_uniforms u = {.vertex = s.vertex};
        amb_pass *pass = NULL;
        for (int half = 0; half < 2; half++) {
            if (half == 0 || split) {
                target.keep = half == 1;
                assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
            }
            amb_draw d = draw_of(shaders, &u, SCENE_TRIANGLES);
            d.indices = s.index + half * SCENE_TRIANGLES, d.vertex_count = SCENE_TRIANGLES * 3;
            d.blend[0] = AMB_BLEND_ALPHA;
            assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
            if (half == 1 || split)
                assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        }
        amb_image_sha256(image, digest[split][0]);
        amb_image_sha256(z, digest[split][1]);
        amb_image_close(&image);
        amb_image_close(&z);
    }
    assert_string_equal(digest[0][0], digest[1][0]);
    assert_string_equal(digest[0][1], digest[1][1]);
    free(s.vertex);
    free(s.index);
    amb_context_close(&context);
}

static void an_empty_pass_clears(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    amb_image *image = image_of(70, 3, 2), *z = image_of(70, 3, 1);
    amb_target target = {.color = {image}, .depth = z, .clear_depth = 0.5f, .clear_color = {{1, 2, 3, 4}}};
    amb_pass *pass = NULL;
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
    assert_null(pass);
    for (int x = 0; x < 70; x++)
        assert_true(pixel(image, 0, x, 2) == 1.0f && pixel(image, 1, x, 2) == 2.0f && pixel(z, 0, x, 2) == 0.5f);
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    amb_pass_close(&pass);
    assert_null(pass);
    amb_pass_close(&pass);
    amb_image_close(&image);
    amb_image_close(&z);
    amb_context_close(&context);
}

/* ---- hostile input ------------------------------------------------------------------------------------------------
 */

static void bad_vertices_take_only_their_triangle(void **state)
{
    (void)state;
    const float bad[] = {NAN, INFINITY, -INFINITY};
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image = image_of(16, 16, 1);
    for (int component = 0; component < 4; component++)
        for (int i = 0; i < 4; i++) {
            raster_test_vertex vertex[9];
            cover_all(vertex, 0.5f, (v4){1, 0, 0, 0});
            cover_all(vertex + 3, 0.5f, (v4){1, 0, 0, 0});
            cover_all(vertex + 6, 0.5f, (v4){1, 0, 0, 0});
            uint32_t index[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 0}; /* and one corner without a triangle */
            if (i < 3)
                (&vertex[3 + component % 3].clip.x)[component] = bad[i];
            else
                index[3 + component % 3] = component == 0 ? 9 : UINT32_MAX - (uint32_t)component;
            raster_test_uniforms u = {.vertex = vertex};
            amb_target target = {.color = {image}};
            amb_pass *pass = NULL;
            amb_pass_stats stats;
            assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
            amb_draw d = draw_of(shaders, &u, 10);
            d.indices = index, d.vertex_count = 9, d.fragment = shaders->one, d.blend[0] = AMB_BLEND_ADD;
            assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
            assert_int_equal(amb_pass_finish(&pass, &stats, NULL), AMB_OK);
            assert_int_equal(stats.triangles_in, 3);
            assert_int_equal(stats.triangles_binned, 2);
            for (int y = 0; y < 16; y++)
                for (int x = 0; x < 16; x++)
                    assert_true(pixel(image, 0, x, y) == 2.0f);
        }
    amb_image_close(&image);
    amb_context_close(&context);
}

static void refuse(amb_pass *pass, const amb_draw *draw, amb_status status, const char *words)
{
    amb_error error = {0};
    assert_int_equal(amb_pass_draw(pass, draw, &error), status);
    assert_int_equal(error.status, status);
    if (!strstr(error.detail, words))
        fail_msg("'%s' does not contain '%s'", error.detail, words);
}

static void bad_draws_are_refused(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *image = image_of(4, 4, 4);
    amb_target target = {.color = {image}};
    amb_pass *pass = NULL;
    raster_test_uniforms u = {0};
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    const amb_draw good = draw_of(shaders, &u, 3);
    amb_draw d = good;
    refuse(pass, NULL, AMB_ERROR_ARGUMENT, "draw");
    refuse(NULL, &d, AMB_ERROR_ARGUMENT, "pass");
    d.lanes = 2, refuse(pass, &d, AMB_ERROR_ISA, "2 lanes"), d = good;
    d.vertex = NULL, d.fragment = NULL, refuse(pass, &d, AMB_ERROR_ARGUMENT, "fragment"), d = good;
    d.fragment = NULL, d.writes_depth = true, refuse(pass, &d, AMB_ERROR_ARGUMENT, "writes_depth"), d = good;
    d.uniforms = NULL, refuse(pass, &d, AMB_ERROR_ARGUMENT, "uniforms"), d = good;
    d.uniforms_size = 0, refuse(pass, &d, AMB_ERROR_ARGUMENT, "uniforms"), d = good;
    d.varying_floats = 65, refuse(pass, &d, AMB_ERROR_ARGUMENT, "65"), d = good;
    d.varying_floats = -1, refuse(pass, &d, AMB_ERROR_ARGUMENT, "-1"), d = good;
    d.cull = (amb_cull)3, refuse(pass, &d, AMB_ERROR_ARGUMENT, "cull is 3"), d = good;
    d.depth_compare = (amb_compare)9, refuse(pass, &d, AMB_ERROR_ARGUMENT, "depth_compare is 9"), d = good;
    d.blend[0] = (amb_blend)77, refuse(pass, &d, AMB_ERROR_ARGUMENT, "blend[0] is 77"), d = good;
    d.vertex_count = 5, refuse(pass, &d, AMB_ERROR_ARGUMENT, "without indices"), d = good;
    d.indices = (const uint32_t[3]){0}, refuse(pass, &d, AMB_ERROR_ARGUMENT, "vertex_count"), d = good;
    d.count = UINT32_MAX, refuse(pass, &d, AMB_ERROR_LIMIT, "count"), d = good;
    d.count = 3000000, d.instances = 3000, refuse(pass, &d, AMB_ERROR_LIMIT, "instances"), d = good;
    d.topology = (amb_topology)7, refuse(pass, &d, AMB_ERROR_ARGUMENT, "topology is 7"), d = good;
    d.point_size = -1, refuse(pass, &d, AMB_ERROR_ARGUMENT, "point_size is -1"), d = good;
    d.point_size = NAN, refuse(pass, &d, AMB_ERROR_ARGUMENT, "point_size"), d = good;
    d.scissor.width = -3, refuse(pass, &d, AMB_ERROR_ARGUMENT, "-3×0"), d = good;
    d.depth_bias_slope = INFINITY, refuse(pass, &d, AMB_ERROR_ARGUMENT, "bias"), d = good;
    d.stencil.on = true, refuse(pass, &d, AMB_ERROR_ARGUMENT, "no stencil image"), d = good;
    d.blend[0] = AMB_BLEND_EQUATION;
    d.equation[0].color_op = (amb_blend_op)5, refuse(pass, &d, AMB_ERROR_ARGUMENT, "operation is 5");
    d.equation[0].alpha_target = (amb_factor)17, refuse(pass, &d, AMB_ERROR_ARGUMENT, "factor is 17"), d = good;
    amb_pass_close(&pass);
    amb_image *second = image_of(4, 4, 1), *stencil = image_of(4, 4, 1);
    target.color[1] = second, target.stencil = stencil;
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    d.blend[0] = AMB_BLEND_EQUATION, d.equation[0].color_source = AMB_FACTOR_SECOND;
    refuse(pass, &d, AMB_ERROR_ARGUMENT, "one colour image"), d = good;
    d.stencil.on = true, d.stencil.back.compare = (amb_compare)-1;
    refuse(pass, &d, AMB_ERROR_ARGUMENT, "stencil compare is -1"), d = good;
    d.stencil.on = true, d.stencil.front.depth_fail = (amb_stencil_op)8;
    refuse(pass, &d, AMB_ERROR_ARGUMENT, "stencil operation is 8"), d = good;
    amb_pass_close(&pass);
    amb_image_close(&image);
    amb_image_close(&second);
    amb_image_close(&stencil);
    amb_context_close(&context);
}

/* A plane with known slopes: the bias is the larger one times depth_bias_slope, within float error. */
static void slope_bias_follows_the_plane(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    amb_image *z = image_of(32, 16, 1);
    for (int i = 0; i < 200; i++) {
        raster_test_vertex vertex[3];
        const double dx = uniform(-0.01, 0.01), dy = uniform(-0.01, 0.01), slope = uniform(-3, 3);
        double limit = i % 3 == 0 ? uniform(-0.01, 0.01) : 0.0, steep = fmax(fabs(dx), fabs(dy));
        cover_all(vertex, 0.0f, (v4){0, 0, 0, 0}); /* corners at window (0, 16), (64, 16) and (0, -16) */
        vertex[0].clip.z = (float)(0.5 + dy * 8), vertex[1].clip.z = (float)(0.5 + dx * 64 + dy * 8);
        vertex[2].clip.z = (float)(0.5 - dy * 24);
        raster_test_uniforms u = {.vertex = vertex};
        amb_target target = {.depth = z, .clear_depth = 1.0f};
        amb_pass *pass = NULL;
        assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
        amb_draw d = draw_of(shaders, &u, 3);
        d.fragment = NULL, d.depth_compare = AMB_ALWAYS, d.depth_clamp = true;
        d.depth_bias_slope = (float)slope, d.depth_bias_clamp = (float)limit;
        assert_int_equal(amb_pass_draw(pass, &d, NULL), AMB_OK);
        assert_int_equal(amb_pass_finish(&pass, NULL, NULL), AMB_OK);
        double bias = slope * steep;
        bias = limit > 0 ? fmin(bias, limit) : limit < 0 ? fmax(bias, limit) : bias;
        for (int y = 0; y < 16; y++)
            for (int x = 0; x < 32; x++) {
                double truth = 0.5 + dx * (x + 0.5) + dy * (y + 0.5 - 8) + bias;
                truth = fmin(fmax(truth, 0), 1);
                assert_true(fabs((double)pixel(z, 0, x, y) - truth) < 1e-6);
            }
    }
    amb_image_close(&z);
    amb_context_close(&context);
}

static void refuse_target(const amb_context *context, const amb_target *target, const char *words)
{
    amb_error error = {0};
    amb_pass *pass = (amb_pass *)&error; /* must be nulled */
    assert_int_equal(amb_pass_begin(context, target, &pass, &error), AMB_ERROR_ARGUMENT);
    assert_null(pass);
    if (!strstr(error.detail, words))
        fail_msg("'%s' does not contain '%s'", error.detail, words);
}

static void bad_targets_are_refused(void **state)
{
    (void)state;
    amb_context *context = context_of(AMB_ISA_AUTO, 1);
    amb_image *a = image_of(4, 4, 4), *b = image_of(4, 5, 4), *c = image_of(4, 4, 1);
    refuse_target(context, NULL, "target");
    refuse_target(NULL, &(amb_target){.color = {a}}, "context");
    refuse_target(context, &(amb_target){.keep = true}, "neither");
    refuse_target(context, &(amb_target){.color = {a, b}}, "4×5");
    refuse_target(context, &(amb_target){.color = {a}, .depth = b}, "4×5");
    refuse_target(context, &(amb_target){.color = {c}, .depth = a}, "4 channels");
    refuse_target(context, &(amb_target){.color = {a, c, a}}, "colour image 0 is also colour image 2");
    refuse_target(context, &(amb_target){.color = {a, c}, .depth = c}, "colour image 1 is also depth image 0");
    refuse_target(context, &(amb_target){.color = {a}, .stencil = a}, "4 channels");
    refuse_target(context, &(amb_target){.color = {a}, .depth = c, .stencil = c}, "also the stencil");
    refuse_target(context, &(amb_target){.color = {a}, .samples = 3}, "samples is 3");
    amb_image odd = *a;
    odd.width = 65537, refuse_target(context, &(amb_target){.color = {&odd}}, "65537×4; sizes of 1 to 65536");
    odd.width = 0, refuse_target(context, &(amb_target){.color = {&odd, a}}, "0×4");
    odd = *a, odd.height = -3, refuse_target(context, &(amb_target){.depth = c, .color = {&odd}}, "4×-3");
    odd = *a, odd.channels = 5, refuse_target(context, &(amb_target){.color = {&odd}}, "5 channels");
    odd = *a, odd.data = NULL, refuse_target(context, &(amb_target){.color = {&odd}}, "no pixels");
    amb_error error;
    amb_pass *none = NULL;
    assert_int_equal(amb_pass_begin(context, &(amb_target){.color = {a}}, NULL, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_pass_finish(&none, NULL, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_pass_finish(NULL, NULL, &error), AMB_ERROR_ARGUMENT);
    amb_image_close(&a);
    amb_image_close(&b);
    amb_image_close(&c);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_changes_the_bits),
        cmocka_unit_test(triangles_blend_in_order),
        cmocka_unit_test(depth_compares),
        cmocka_unit_test(discarded_fragments_write_nothing),
        cmocka_unit_test(faces_are_told_by_winding),
        cmocka_unit_test(full_screen_draws_touch_every_pixel_once),
        cmocka_unit_test(two_kept_passes_equal_one),
        cmocka_unit_test(an_empty_pass_clears),
        cmocka_unit_test(bad_vertices_take_only_their_triangle),
        cmocka_unit_test(bad_draws_are_refused),
        cmocka_unit_test(bad_targets_are_refused),
        cmocka_unit_test(slope_bias_follows_the_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
