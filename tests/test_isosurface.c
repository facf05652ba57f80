/* The mesher: closed oriented manifolds, known topology, vertices and normals against formulas, the same bits always.
 */
#include "tests/isosurface_fields_wide.h"
#include "tests/manifold.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static amb_context *context_of(amb_isa isa, int threads)
{
    amb_context *context = NULL;
    amb_context_options options = {.isa = isa, .threads = threads};
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    return context;
}

static amb_field field_of(int lanes, test_field which)
{
    switch (lanes) {
    case 1:
        return test_field_at_x1(which);
#if defined(__x86_64__)
    case 8:
        return test_field_at_x8(which);
    case 16:
        return test_field_at_x16(which);
#endif
    default:
        return test_field_at_x4(which);
    }
}

static amb_isosurface_desc desc_of(int lanes, test_field which, float cell)
{
    return (amb_isosurface_desc){.lanes = lanes,
                                 .field = field_of(lanes, which),
                                 .lo = {-1.0f, -1.0f, -1.0f},
                                 .hi = {1.0f, 1.0f, 1.0f},
                                 .cell = cell,
                                 .lipschitz = which == FIELD_NOISE    ? 1000.0f
                                              : which == FIELD_TANGLE ? 4.0f
                                                                      : 0.0f};
}

static amb_mesh *mesh_of(amb_isa isa, int threads, int lanes, test_field which, float cell)
{
    amb_context *context = context_of(isa, threads);
    amb_mesh *mesh = NULL;
    amb_error error = {0};
    amb_isosurface_desc desc = desc_of(lanes ? lanes : (int)amb_context_isa(context), which, cell);
    if (amb_isosurface(context, &desc, &mesh, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    assert_int_equal(amb_mesh_check(mesh, NULL), AMB_OK);
    amb_context_close(&context);
    return mesh;
}

static double signed_volume(const amb_mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        v3 a = mesh->position[mesh->index[t * 3]], b = mesh->position[mesh->index[t * 3 + 1]],
           c = mesh->position[mesh->index[t * 3 + 2]];
        sum += (double)a.x * ((double)b.y * (double)c.z - (double)b.z * (double)c.y) +
               (double)a.y * ((double)b.z * (double)c.x - (double)b.x * (double)c.z) +
               (double)a.z * ((double)b.x * (double)c.y - (double)b.y * (double)c.x);
    }
    return sum / 6.0;
}

static void sphere_is_a_sphere(void **state)
{
    (void)state;
    amb_mesh *mesh = mesh_of(AMB_ISA_AUTO, 2, 0, FIELD_SPHERE, 0.02f);
    assert_int_equal(check_manifold(mesh), 2);
    assert_true(mesh->triangle_count > 20000);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        v3 p = mesh->position[i], n = mesh->normal[i];
        double radius = sqrt((double)p.x * (double)p.x + (double)p.y * (double)p.y + (double)p.z * (double)p.z);
        assert_true(fabs(radius - 0.7) < 2e-6);
        double cosine = ((double)p.x * (double)n.x + (double)p.y * (double)n.y + (double)p.z * (double)n.z) / radius;
        assert_true(cosine > 1.0 - 1e-6);
    }
    double volume = 4.0 / 3.0 * 3.14159265358979 * 0.343;
    assert_true(fabs(signed_volume(mesh) - volume) < 1e-3 * volume); /* positive: the front is outside */
    amb_mesh_close(&mesh);
}

static void torus_is_a_torus(void **state)
{
    (void)state;
    amb_mesh *mesh = mesh_of(AMB_ISA_AUTO, 2, 0, FIELD_TORUS, 0.02f);
    assert_int_equal(check_manifold(mesh), 0);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        v3 p = mesh->position[i], n = mesh->normal[i];
        double ring = sqrt((double)p.x * (double)p.x + (double)p.z * (double)p.z);
        double tube = sqrt((ring - 0.6) * (ring - 0.6) + (double)p.y * (double)p.y);
        assert_true(fabs(tube - 0.2) < 2e-6);
        double cosine = ((double)p.x * (1.0 - 0.6 / ring) * (double)n.x + (double)p.y * (double)n.y +
                         (double)p.z * (1.0 - 0.6 / ring) * (double)n.z) /
                        tube;
        assert_true(cosine > 1.0 - 1e-5);
    }
    double volume = 2.0 * 3.14159265358979 * 3.14159265358979 * 0.6 * 0.04;
    assert_true(fabs(signed_volume(mesh) - volume) < 3e-3 * volume);
    amb_mesh_close(&mesh);
}

/* Thin walls and random signs: every ambiguous case, still a manifold; random signs need the joints of doubled faces.
 */
static void hard_fields_stay_manifold(void **state)
{
    (void)state;
    amb_mesh *mesh = mesh_of(AMB_ISA_AUTO, 2, 0, FIELD_TANGLE, 0.05f);
    check_manifold(mesh);
    assert_true(signed_volume(mesh) > 0.0);
    amb_mesh_close(&mesh);
    mesh = mesh_of(AMB_ISA_AUTO, 2, 0, FIELD_NOISE, 0.0625f);
    assert_true(mesh->triangle_count > 5000);
    check_manifold(mesh);
    amb_mesh_close(&mesh);
}

static void same_bits_for_lanes_and_threads(void **state)
{
    (void)state;
    static const test_field fields[] = {FIELD_TORUS, FIELD_TANGLE, FIELD_NOISE};
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    for (int f = 0; f < 3; f++) {
        float cell = fields[f] == FIELD_NOISE ? 0.0625f : 0.04f;
        amb_mesh *truth = mesh_of(AMB_ISA_AUTO, 1, 1, fields[f], cell);
        for (int i = 0; i < 3; i++) {
            if (!amb_isa_available(isas[i]))
                continue;
            amb_mesh *mesh = mesh_of(isas[i], 1 + 2 * i, 0, fields[f], cell);
            assert_int_equal(mesh->vertex_count, truth->vertex_count);
            assert_int_equal(mesh->triangle_count, truth->triangle_count);
            assert_memory_equal(mesh->position, truth->position, truth->vertex_count * sizeof(v3));
            assert_memory_equal(mesh->normal, truth->normal, truth->vertex_count * sizeof(v3));
            assert_memory_equal(mesh->index, truth->index, truth->triangle_count * 3 * sizeof(uint32_t));
            amb_mesh_close(&mesh);
        }
        amb_mesh_close(&truth);
    }
}

static void empty_field_gives_empty_mesh(void **state)
{
    (void)state;
    amb_mesh *mesh = mesh_of(AMB_ISA_AUTO, 2, 0, FIELD_EMPTY, 0.1f);
    assert_int_equal(mesh->vertex_count, 0);
    assert_int_equal(mesh->triangle_count, 0);
    amb_mesh_close(&mesh);
}

static void expect_error(amb_isosurface_desc desc, amb_status status, const char *part)
{
    amb_context *context = context_of(AMB_ISA_AUTO, 2);
    amb_mesh *mesh = NULL;
    amb_error error = {0};
    if (desc.lanes == 0)
        desc.lanes = (int)amb_context_isa(context);
    assert_int_equal(amb_isosurface(context, &desc, &mesh, &error), status);
    assert_null(mesh);
    if (strstr(error.detail, part) == NULL)
        fail_msg("\"%s\" lacks \"%s\"", error.detail, part);
    amb_context_close(&context);
}

static void errors_say_what(void **state)
{
    (void)state;
    amb_isosurface_desc desc = desc_of(1, FIELD_SPHERE, 0.1f);
    desc.hi.x = 0.5f;
    expect_error(desc, AMB_ERROR_ARGUMENT, "touches the box");
    desc = desc_of(1, FIELD_SPHERE, 0.0f);
    expect_error(desc, AMB_ERROR_ARGUMENT, "cell 0");
    desc = desc_of(1, FIELD_SPHERE, (float)NAN);
    expect_error(desc, AMB_ERROR_ARGUMENT, "cell nan");
    desc = desc_of(1, FIELD_SPHERE, 1e-5f);
    expect_error(desc, AMB_ERROR_LIMIT, "cells along axis 0");
    desc = desc_of(1, FIELD_SPHERE, 0.1f);
    desc.field = NULL;
    expect_error(desc, AMB_ERROR_ARGUMENT, "no field");
    desc = desc_of(1, FIELD_SPHERE, 0.1f);
    desc.lanes = 2;
    expect_error(desc, AMB_ERROR_ISA, "2 lanes");
    desc = desc_of(1, FIELD_STEEP, 0.02f);
    expect_error(desc, AMB_ERROR_ARGUMENT, "lipschitz = 1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_a_sphere),           cmocka_unit_test(torus_is_a_torus),
        cmocka_unit_test(hard_fields_stay_manifold),    cmocka_unit_test(same_bits_for_lanes_and_threads),
        cmocka_unit_test(empty_field_gives_empty_mesh), cmocka_unit_test(errors_say_what),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
