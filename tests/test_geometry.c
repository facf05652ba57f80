/* The geometry stage: what a shader emits must give the very pixels of the same primitives drawn without it, in the
 * same order. */
#include "raster/internal.h"
#include "tests/raster_shaders.h"
#include "tests/stage_draws.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define WIDTH 200
#define HEIGHT 150
#define INPUTS 400
#define MOST (INPUTS * AMB_MAX_GEOMETRY_VERTICES)

/* ---- the two ways ----------------------------------------------------------------------------------------------- */

/* A draw of `count` vertices of given positions. */
static amb_draw draw_of(const amb_context *context, const stage_test_uniforms *uniforms, amb_topology topology,
                        uint32_t count)
{
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    return (amb_draw){.lanes = s->lanes,
                      .vertex = s->vertex,
                      .fragment = s->shade,
                      .uniforms = uniforms,
                      .uniforms_size = sizeof *uniforms,
                      .varying_floats = 4,
                      .count = count,
                      .blend = {AMB_BLEND_ALPHA},
                      .topology = topology};
}

/* The list of primitives that the geometry shader is to make of all inputs. */
typedef struct list {
    raster_test_vertex *vertex;
    uint32_t count;
} list;

static void append(list *l, v4 clip, v4 value)
{
    assert_true(l->count < 3 * MOST);
    l->vertex[l->count++] = (raster_test_vertex){clip, value};
}

/* A strip of vertices v[0…count-1] as a list of what `output` says. */
static void append_strip(list *l, amb_topology output, const raster_test_vertex *v, int count)
{
    const int corners = output == AMB_TRIANGLES ? 3 : output == AMB_LINES ? 2 : 1;
    for (int i = 0; i + corners <= count; i++) {
        const int turn = corners == 3 ? i & 1 : 0;
        append(l, v[i].clip, v[i].value);
        if (corners > 1)
            append(l, v[i + 1 + turn].clip, v[i + 1 + turn].value);
        if (corners > 2)
            append(l, v[i + 2 - turn].clip, v[i + 2 - turn].value);
    }
}

static void compare(const amb_context *context, const amb_draw *draw, const list *expected, amb_topology output)
{
    const raster_test_shaders *plain = raster_test_shaders_of(amb_context_isa(context));
    const raster_test_uniforms uniforms = {.vertex = expected->vertex};
    amb_draw direct = *draw;
    amb_pass_stats stats, direct_stats;
    direct.vertex = plain->vertex;
    direct.uniforms = &uniforms;
    direct.uniforms_size = sizeof uniforms;
    direct.count = expected->count;
    direct.topology = output;
    direct.geometry = (amb_geometry){0};
    amb_image *a = draw_image(context, draw, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &stats);
    amb_image *b = draw_image(context, &direct, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, &direct_stats);
    assert_same_pixels(a, b);
    assert_int_equal(stats.triangles_in, direct_stats.triangles_in);
    assert_int_equal(stats.triangles_clipped, direct_stats.triangles_clipped);
    assert_int_equal(stats.triangles_culled, direct_stats.triangles_culled);
    assert_int_equal(stats.triangles_binned, direct_stats.triangles_binned);
    assert_int_equal(stats.fragments_shaded, direct_stats.fragments_shaded);
    assert_true(stats.fragments_shaded > 300);
    amb_image_close(&a);
    amb_image_close(&b);
}

static void random_corners(v4 *clip, int count)
{
    for (int i = 0; i < count; i++) {
        float w = uniform(0.5f, 2.0f);
        clip[i] = (v4){uniform(-1.3f, 1.3f) * w, uniform(-1.3f, 1.3f) * w, uniform(-0.2f, 1.1f) * w, w};
    }
}

/* ---- triangles -------------------------------------------------------------------------------------------------- */

static void triangles_pass_and_are_culled(void **state)
{
    (void)state;
    static v4 clip[3 * INPUTS];
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip};
    list all = {calloc(3 * MOST, sizeof(raster_test_vertex)), 0}, some = {calloc(3 * MOST, sizeof *all.vertex), 0};
    random_corners(clip, 3 * INPUTS);
    for (int i = 0; i < 3 * INPUTS; i++) {
        append(&all, clip[i], (v4){(float)i, 0.0f, 0.0f, 1.0f});
        if (i / 3 % 3 != 1)
            append(&some, clip[i], (v4){(float)i, 0.0f, 0.0f, 1.0f});
    }
    amb_draw d = draw_of(context, &uniforms, AMB_TRIANGLES, 3 * INPUTS);
    d.geometry = (amb_geometry){.shader = s->same, .vertices = 3};
    compare(context, &d, &all, AMB_TRIANGLES);
    d.geometry.shader = s->cull;
    compare(context, &d, &some, AMB_TRIANGLES);
    d.wireframe = true;
    compare(context, &d, &some, AMB_TRIANGLES);
    free(all.vertex);
    free(some.vertex);
    amb_context_close(&context);
}

/* The primitive's number that a fragment shader sees is that of the input. */
static void numbers_are_those_of_the_input(void **state)
{
    (void)state;
    static v4 clip[3 * INPUTS];
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip};
    random_corners(clip, 3 * INPUTS);
    amb_draw d = draw_of(context, &uniforms, AMB_TRIANGLES, 3 * INPUTS);
    d.fragment = s->number;
    d.blend[0] = AMB_BLEND_OFF;
    d.instances = 2;
    amb_image *a = draw_image(context, &d, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, NULL);
    d.geometry = (amb_geometry){.shader = s->same, .vertices = 3};
    amb_image *b = draw_image(context, &d, WIDTH, HEIGHT, 64, RASTER_BATCH_BYTES, NULL);
    assert_same_pixels(a, b);
    amb_image_close(&a);
    amb_image_close(&b);
    amb_context_close(&context);
}

/* ---- points ----------------------------------------------------------------------------------------------------- */

static v4 moved(v4 clip, float x, float y)
{
    clip.x += x;
    clip.y += y;
    return clip;
}

static void points_become_billboards(void **state)
{
    (void)state;
    static v4 clip[INPUTS];
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip, .size = {0.07f, 0.11f, 0.0f, 0.0f}};
    list expected = {calloc(3 * MOST, sizeof(raster_test_vertex)), 0};
    random_corners(clip, INPUTS);
    for (int n = 0; n < INPUTS; n++) {
        raster_test_vertex strip[4];
        for (int i = 0; i < 4; i++)
            strip[i] = (raster_test_vertex){
                moved(clip[n], i & 1 ? uniforms.size.x : -uniforms.size.x, i & 2 ? uniforms.size.y : -uniforms.size.y),
                {(float)n, (float)i, 0.0f, 1.0f}};
        append_strip(&expected, AMB_TRIANGLES, strip, 4);
    }
    amb_draw d = draw_of(context, &uniforms, AMB_POINTS, INPUTS);
    d.geometry = (amb_geometry){.shader = s->billboard, .vertices = 4};
    compare(context, &d, &expected, AMB_TRIANGLES);
    free(expected.vertex);
    amb_context_close(&context);
}

/* Vertex i of what the strips of point n are made of. */
static raster_test_vertex zigzag(const stage_test_uniforms *u, int n, int i)
{
    return (raster_test_vertex){moved(u->clip[n], u->size.x * (float)i, i & 1 ? u->size.y : 0.0f),
                                {(float)n, (float)i, 0.0f, 1.0f}};
}

static void points_become_many_vertices(void **state)
{
    (void)state;
    static v4 clip[INPUTS];
    static const amb_topology outputs[3] = {AMB_TRIANGLES, AMB_LINES, AMB_POINTS};
    static const int most[4] = {7, 31, 100, 256};
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    list expected = {calloc(3 * MOST, sizeof(raster_test_vertex)), 0};
    random_corners(clip, INPUTS);
    for (int k = 0; k < 4; k++)
        for (int o = 0; o < 3; o++) {
            const stage_test_uniforms uniforms = {
                .clip = clip, .emitted = most[k], .size = {0.005f, 0.03f, 0.0f, 0.0f}};
            expected.count = 0;
            for (int n = 0; n < INPUTS; n++) {
                raster_test_vertex strip[AMB_MAX_GEOMETRY_VERTICES];
                for (int i = 0; i < most[k] - n % 7; i++)
                    strip[i] = zigzag(&uniforms, n, i);
                append_strip(&expected, outputs[o], strip, most[k] - n % 7);
            }
            amb_draw d = draw_of(context, &uniforms, AMB_POINTS, INPUTS);
            d.point_size = 3.0f;
            d.geometry = (amb_geometry){.shader = s->amplify, .output = outputs[o], .vertices = most[k]};
            compare(context, &d, &expected, outputs[o]);
        }
    free(expected.vertex);
    amb_context_close(&context);
}

/* Vertices beyond the draw's most are ignored. */
static void what_is_too_much_is_dropped(void **state)
{
    (void)state;
    static v4 clip[INPUTS];
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip, .emitted = 40, .size = {0.005f, 0.03f, 0.0f, 0.0f}};
    list expected = {calloc(3 * MOST, sizeof(raster_test_vertex)), 0};
    random_corners(clip, INPUTS);
    for (int n = 0; n < INPUTS; n++) {
        raster_test_vertex strip[10];
        for (int i = 0; i < 10; i++)
            strip[i] = zigzag(&uniforms, n, i);
        append_strip(&expected, AMB_TRIANGLES, strip, 10);
    }
    amb_draw d = draw_of(context, &uniforms, AMB_POINTS, INPUTS);
    d.geometry = (amb_geometry){.shader = s->amplify, .vertices = 10};
    compare(context, &d, &expected, AMB_TRIANGLES);
    free(expected.vertex);
    amb_context_close(&context);
}

static void strips_are_cut(void **state)
{
    (void)state;
    static v4 clip[INPUTS];
    static const amb_topology outputs[3] = {AMB_TRIANGLES, AMB_LINES, AMB_POINTS};
    amb_context *context = make_context(AMB_ISA_AUTO, 2);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip, .size = {0.03f, 0.08f, 0.0f, 0.0f}};
    list expected = {calloc(3 * MOST, sizeof(raster_test_vertex)), 0};
    random_corners(clip, INPUTS);
    for (int o = 0; o < 3; o++) {
        expected.count = 0;
        for (int n = 0; n < INPUTS; n++)
            for (int i = 0, length = n % 5 + 1; i < 16; length = length % STAGE_TEST_STRIP_LENGTH + 1) {
                raster_test_vertex strip[STAGE_TEST_STRIP_LENGTH];
                int count = 0;
                for (; count < length && i < 16; count++, i++)
                    strip[count] = zigzag(&uniforms, n, i);
                append_strip(&expected, outputs[o], strip, count);
            }
        amb_draw d = draw_of(context, &uniforms, AMB_POINTS, INPUTS);
        d.geometry = (amb_geometry){.shader = s->cuts, .output = outputs[o], .vertices = 16};
        compare(context, &d, &expected, outputs[o]);
    }
    free(expected.vertex);
    amb_context_close(&context);
}

/* ---- same everywhere -------------------------------------------------------------------------------------------- */

static void pixels_depend_on_nothing_else(void **state)
{
    (void)state;
    static v4 clip[INPUTS];
    static const amb_isa isas[3] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    static const int tiles[4] = {16, 32, 64, 128};
    const stage_test_uniforms uniforms = {.clip = clip, .emitted = 60, .size = {0.02f, 0.06f, 0.0f, 0.0f}};
    amb_image *first = NULL;
    amb_pass_stats first_stats;
    random_corners(clip, INPUTS);
    for (int i = 0; i < 12; i++) {
        const amb_isa isa = isas[i % 3];
        if (!amb_isa_available(isa))
            continue;
        amb_context *context = make_context(isa, 1 + i % 5);
        amb_pass_stats stats;
        amb_draw d = draw_of(context, &uniforms, AMB_POINTS, INPUTS);
        d.geometry = (amb_geometry){.shader = stage_test_shaders_of(isa)->amplify, .vertices = 60};
        amb_image *image = draw_image(context, &d, WIDTH, HEIGHT, tiles[i / 3], i & 1 ? 0 : RASTER_BATCH_BYTES, &stats);
        if (!first) {
            first = image, first_stats = stats;
        } else {
            assert_same_pixels(first, image);
            assert_int_equal(stats.geometry_in, first_stats.geometry_in);
            assert_int_equal(stats.geometry_vertices, first_stats.geometry_vertices);
            assert_int_equal(stats.triangles_in, first_stats.triangles_in);
            amb_image_close(&image);
        }
        amb_context_close(&context);
    }
    assert_int_equal(first_stats.geometry_in, INPUTS);
    uint64_t emitted = 0;
    for (int n = 0; n < INPUTS; n++)
        emitted += 60u - (uint64_t)(n % 7);
    assert_int_equal(first_stats.geometry_vertices, emitted);
    assert_int_equal(first_stats.triangles_in, emitted - 2 * INPUTS);
    amb_image_close(&first);
}

/* ---- errors ----------------------------------------------------------------------------------------------------- */

static void bad_draws_are_refused(void **state)
{
    (void)state;
    static v4 clip[3];
    amb_context *context = make_context(AMB_ISA_AUTO, 1);
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(context));
    const stage_test_uniforms uniforms = {.clip = clip};
    amb_image *image = NULL;
    amb_pass *pass = NULL;
    assert_int_equal(amb_image_create(8, 8, 4, &image, NULL), AMB_OK);
    amb_target target = {.color = {image}};
    assert_int_equal(amb_pass_begin(context, &target, &pass, NULL), AMB_OK);
    amb_draw good = draw_of(context, &uniforms, AMB_TRIANGLES, 3), d;
    good.geometry = (amb_geometry){.shader = s->same, .vertices = 3};
    assert_int_equal(amb_pass_draw(pass, &good, NULL), AMB_OK);
    d = good, d.geometry.vertices = 0, refuse(pass, &d, "geometry.vertices is 0; 1 to 256 are allowed");
    d = good, d.geometry.vertices = 257, refuse(pass, &d, "geometry.vertices is 257; 1 to 256 are allowed");
    d = good, d.geometry.input_floats = 65, refuse(pass, &d, "geometry.input_floats is 65; 0 to 64 are allowed");
    d = good, d.geometry.input_floats = -1, refuse(pass, &d, "geometry.input_floats is -1");
    d = good, d.geometry.output = AMB_TRIANGLE_FAN, refuse(pass, &d, "geometry.output is 2; AMB_TRIANGLES");
    d = good, d.vertex = NULL, refuse(pass, &d, "a full-screen draw cannot have a geometry shader");
    amb_pass_close(&pass);
    amb_image_close(&image);
    amb_context_close(&context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_pass_and_are_culled), cmocka_unit_test(numbers_are_those_of_the_input),
        cmocka_unit_test(points_become_billboards),      cmocka_unit_test(points_become_many_vertices),
        cmocka_unit_test(what_is_too_much_is_dropped),   cmocka_unit_test(strips_are_cut),
        cmocka_unit_test(pixels_depend_on_nothing_else), cmocka_unit_test(bad_draws_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
