/* Meshes: the sphere against its formula, smooth normals against analytic ones, tangents against the surface. */
#include <ambiance/mesh.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static double dot(v3 a, v3 b)
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}
static v3 cross(v3 a, v3 b) { return v3_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static v3 minus(v3 a, v3 b) { return v3_of(a.x - b.x, a.y - b.y, a.z - b.z); }
static v3 face_normal(const amb_mesh *m, uint32_t t)
{
    const uint32_t *i = m->index + 3 * t;
    return cross(minus(m->position[i[1]], m->position[i[0]]), minus(m->position[i[2]], m->position[i[0]]));
}

static amb_mesh *sphere(int rings, int segments)
{
    amb_mesh *m = NULL;
    amb_error error;
    assert_int_equal(amb_mesh_sphere(rings, segments, &m, &error), AMB_OK);
    assert_int_equal(amb_mesh_check(m, &error), AMB_OK);
    return m;
}

/* ---- sphere ----------------------------------------------------------------------------------------------------- */

static void test_sphere_is_a_sphere(void **unused)
{
    (void)unused;
    static const int size[][2] = {{2, 3}, {16, 32}, {7, 5}, {64, 128}};
    for (size_t s = 0; s < sizeof size / sizeof size[0]; s++) {
        int rings = size[s][0], segments = size[s][1];
        amb_mesh *m = sphere(rings, segments);
        assert_int_equal(m->vertex_count, (rings + 1) * (segments + 1));
        assert_int_equal(m->triangle_count, 2 * segments * (rings - 1));
        for (uint32_t i = 0; i < m->vertex_count; i++) {
            double u = (double)m->uv[i].x, v = (double)m->uv[i].y, pi = acos(-1.0);
            assert_true(fabs(u - (double)(i % (uint32_t)(segments + 1)) / segments) < 1e-6);
            assert_true(fabs(v - (double)(i / (uint32_t)(segments + 1)) / rings) < 1e-6);
            assert_true(fabs((double)m->position[i].x - sin(pi * v) * cos(2 * pi * u)) < 1e-6);
            assert_true(fabs((double)m->position[i].y - cos(pi * v)) < 1e-6);
            assert_true(fabs((double)m->position[i].z + sin(pi * v) * sin(2 * pi * u)) < 1e-6);
            assert_true(fabs(dot(m->normal[i], m->position[i]) - 1.0) < 1e-6);
        }
        for (uint32_t t = 0; t < m->triangle_count; t++) /* counter-clockwise from outside */
            assert_true(dot(face_normal(m, t), m->position[m->index[3 * t]]) > 0.0);
        amb_mesh_close(&m);
    }
}

/* Every edge of the welded sphere is shared by exactly two triangles, once in each direction. */
static void test_sphere_is_closed(void **unused)
{
    (void)unused;
    amb_mesh *m = sphere(9, 14);
    for (uint32_t e = 0; e < 3 * m->triangle_count; e++) {
        v3 a = m->position[m->index[e]], b = m->position[m->index[e % 3 == 2 ? e - 2 : e + 1]];
        int back = 0, same = 0;
        for (uint32_t f = 0; f < 3 * m->triangle_count; f++) {
            v3 c = m->position[m->index[f]], d = m->position[m->index[f % 3 == 2 ? f - 2 : f + 1]];
            back += a.x == d.x && a.y == d.y && a.z == d.z && b.x == c.x && b.y == c.y && b.z == c.z;
            same += a.x == c.x && a.y == c.y && a.z == c.z && b.x == d.x && b.y == d.y && b.z == d.z;
        }
        assert_int_equal(back, 1);
        assert_int_equal(same, 1);
    }
    amb_mesh_close(&m);
}

static void check_tangents(const amb_mesh *m, double orthogonality)
{
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        v4 t = m->tangent[i];
        v3 unit = v3_of(t.x, t.y, t.z);
        assert_true(fabs(dot(unit, unit) - 1.0) < 1e-5);
        assert_true(fabs(dot(unit, m->normal[i])) < orthogonality);
        assert_true(t.w == 1.0f || t.w == -1.0f);
    }
}

/* tangent follows u and w · normal × tangent follows v, on the generated sphere and after remaking. */
static void test_sphere_tangents(void **unused)
{
    (void)unused;
    amb_mesh *m = sphere(48, 96);
    for (int remade = 0; remade < 2; remade++) {
        check_tangents(m, 1e-6);
        for (uint32_t i = 0; i < m->vertex_count; i++) {
            double u = (double)m->uv[i].x * 2.0 * acos(-1.0), v = (double)m->uv[i].y * acos(-1.0);
            if (v < 0.1 || v > 3.04)
                continue; /* at the poles u has no direction */
            v3 t = v3_of(m->tangent[i].x, m->tangent[i].y, m->tangent[i].z), b = cross(m->normal[i], t);
            v3 east = v3_of((float)-sin(u), 0.0f, (float)-cos(u));
            v3 south = v3_of((float)(cos(v) * cos(u)), (float)-sin(v), (float)(-cos(v) * sin(u)));
            assert_true(dot(t, east) > 0.999);
            assert_true(dot(b, south) * (double)m->tangent[i].w > 0.999);
        }
        assert_int_equal(amb_mesh_tangents(m, NULL), AMB_OK);
    }
    amb_mesh_close(&m);
}

/* ---- normals ---------------------------------------------------------------------------------------------------- */

static double worst_sphere_normal(const amb_mesh *m)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        double r = sqrt(dot(m->position[i], m->position[i])),
               angle = acos(fmin(1.0, dot(m->normal[i], m->position[i]) / r));
        worst = fmax(worst, angle);
    }
    return worst;
}

static void test_smooth_normals_of_a_sphere(void **unused)
{
    (void)unused;
    for (float scale = 1e-18f; scale < 1e19f; scale *= 1e9f) {
        amb_mesh *m = sphere(40, 80);
        for (uint32_t i = 0; i < m->vertex_count; i++)
            m->position[i] = v3_scale(m->position[i], scale);
        free(m->normal);
        m->normal = NULL;
        assert_int_equal(amb_mesh_smooth_normals(m, true, NULL), AMB_OK);
        assert_true(worst_sphere_normal(m) < 0.004); /* an angle-weighted fan of 4.5° facets */
        /* Welded: both sides of the seam agree in every bit. */
        for (uint32_t r = 0; r <= 40; r++)
            assert_memory_equal(&m->normal[r * 81], &m->normal[r * 81 + 80], sizeof(v3));
        /* Not welded: the seam's half fans lean away from each other. */
        assert_int_equal(amb_mesh_smooth_normals(m, false, NULL), AMB_OK);
        assert_true(worst_sphere_normal(m) > 0.01);
        amb_mesh_close(&m);
    }
}

/* A cube's corner of three faces, one of them split in two triangles at that corner: angle weights make it (1,1,1)/√3
 * whatever the split; area or count weights would not. */
static void test_normals_are_angle_weighted(void **unused)
{
    (void)unused;
    amb_mesh *m = NULL;
    assert_int_equal(amb_mesh_create(8, 4, &m, NULL), AMB_OK);
    const v3 p[8] = {{0, 0, 0}, {-1, 0, 0}, {0, -5, 0}, {0, 0, -3}, {-1, -5, 0}, {-0.0f, 0, 0}, {0, 0, 0}, {9, 9, 9}};
    memcpy(m->position, p, sizeof p);
    const uint32_t index[12] = {0, 1, 4, 0, 4, 2, 5, 2, 3, 6, 3, 1}; /* +z (split), +x, +y */
    memcpy(m->index, index, sizeof index);
    assert_int_equal(amb_mesh_smooth_normals(m, true, NULL), AMB_OK);
    for (int i = 0; i < 3; i++) {
        v3 n = m->normal[i == 0 ? 0 : i + 4]; /* 0, 5 and 6 are one point; -0 equals 0 */
        assert_true(fabs((double)n.x - sqrt(1.0 / 3.0)) < 1e-6);
        assert_true(fabs((double)n.y - sqrt(1.0 / 3.0)) < 1e-6);
        assert_true(fabs((double)n.z - sqrt(1.0 / 3.0)) < 1e-6);
    }
    assert_true(m->normal[7].x == 0.0f && m->normal[7].y == 1.0f && m->normal[7].z == 0.0f); /* of no face */
    amb_mesh_close(&m);
}

static void test_degenerate_faces_are_ignored(void **unused)
{
    (void)unused;
    amb_mesh *m = NULL;
    assert_int_equal(amb_mesh_create(4, 3, &m, NULL), AMB_OK);
    const v3 p[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
    memcpy(m->position, p, sizeof p);
    const uint32_t index[9] = {0, 1, 2, 0, 1, 3, 1, 1, 2};
    memcpy(m->index, index, sizeof index);
    assert_int_equal(amb_mesh_smooth_normals(m, false, NULL), AMB_OK);
    for (int i = 0; i < 3; i++)
        assert_true(m->normal[i].z == 1.0f);
    assert_true(m->normal[3].y == 1.0f);
    m->uv = calloc(4, sizeof *m->uv); /* all equal: no direction of u anywhere */
    assert_int_equal(amb_mesh_tangents(m, NULL), AMB_OK);
    check_tangents(m, 1e-6);
    amb_mesh_close(&m);
}

/* A mirrored UV chart gives w = +1, an unmirrored one (v down) -1. */
static void test_tangent_handedness(void **unused)
{
    (void)unused;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        amb_mesh *m = NULL;
        assert_int_equal(amb_mesh_create(3, 1, &m, NULL), AMB_OK);
        const v3 p[3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
        memcpy(m->position, p, sizeof p);
        m->index[1] = 1, m->index[2] = 2;
        assert_int_equal(amb_mesh_smooth_normals(m, false, NULL), AMB_OK);
        m->uv = calloc(3, sizeof *m->uv);
        m->uv[0] = v2_of(0.25f, 1.0f), m->uv[1] = v2_of(mirrored ? 0.0f : 0.5f, 1.0f), m->uv[2] = v2_of(0.25f, 0.5f);
        assert_int_equal(amb_mesh_tangents(m, NULL), AMB_OK);
        for (int i = 0; i < 3; i++) {
            assert_true(m->tangent[i].x == (mirrored ? -1.0f : 1.0f));
            assert_true(m->tangent[i].w == (mirrored ? 1.0f : -1.0f));
        }
        amb_mesh_close(&m);
    }
}

/* ---- bounds and errors ------------------------------------------------------------------------------------------ */

static void test_bounds(void **unused)
{
    (void)unused;
    amb_mesh *m = NULL;
    v3 lo, hi;
    assert_int_equal(amb_mesh_create(0, 0, &m, NULL), AMB_OK);
    amb_mesh_bounds(m, &lo, &hi);
    assert_true(lo.x == 0.0f && hi.z == 0.0f);
    assert_int_equal(amb_mesh_check(m, NULL), AMB_OK);
    assert_int_equal(amb_mesh_smooth_normals(m, true, NULL), AMB_OK);
    amb_mesh_close(&m);
    assert_int_equal(amb_mesh_create(3, 0, &m, NULL), AMB_OK);
    m->position[0] = v3_of(1, 5, -2), m->position[1] = v3_of(3, -4, -7), m->position[2] = v3_of(2, 2, -9);
    amb_mesh_bounds(m, &lo, &hi);
    assert_true(lo.x == 1 && lo.y == -4 && lo.z == -9 && hi.x == 3 && hi.y == 5 && hi.z == -2);
    amb_mesh_close(&m);
    assert_null(m);
    amb_mesh_close(&m);
    amb_mesh_close(NULL);
}

static void test_check_names_the_first_fault(void **unused)
{
    (void)unused;
    amb_mesh *m = NULL;
    amb_error error;
    assert_int_equal(amb_mesh_create(3, 2, &m, NULL), AMB_OK);
    m->index[4] = 3;
    assert_int_equal(amb_mesh_check(m, &error), AMB_ERROR_FORMAT);
    assert_string_equal(error.detail, "mesh: corner 1 of triangle 1 is vertex 3; the mesh has 3 vertices");
    assert_int_equal(amb_mesh_smooth_normals(m, true, &error), AMB_ERROR_FORMAT);
    m->index[4] = 2;
    m->position[1].y = INFINITY;
    m->position[2].x = NAN;
    assert_int_equal(amb_mesh_check(m, &error), AMB_ERROR_FORMAT);
    assert_string_equal(error.detail, "mesh: position of vertex 1 is (0, inf, 0); positions must be finite");
    m->position[1].y = 0.0f;
    assert_int_equal(amb_mesh_check(m, &error), AMB_ERROR_FORMAT);
    assert_string_equal(error.detail, "mesh: position of vertex 2 is (nan, 0, 0); positions must be finite");
    m->position[2].x = 0.0f;
    assert_int_equal(amb_mesh_check(m, &error), AMB_OK);
    assert_int_equal(amb_mesh_check(NULL, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_mesh_tangents(m, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "mesh: tangents need normals and UVs; this mesh has no normals");
    assert_int_equal(amb_mesh_smooth_normals(m, false, &error), AMB_OK);
    assert_int_equal(amb_mesh_tangents(m, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "mesh: tangents need normals and UVs; this mesh has no UVs");
    amb_mesh_close(&m);
}

static void test_bad_arguments(void **unused)
{
    (void)unused;
    amb_mesh *m = NULL;
    amb_error error;
    assert_int_equal(amb_mesh_create(AMB_MAX_MESH_VERTICES + 1, 0, &m, &error), AMB_ERROR_LIMIT);
    assert_string_equal(error.detail, "mesh: 268435457 vertices; at most 268435456 are allowed");
    assert_int_equal(amb_mesh_create(0, AMB_MAX_MESH_TRIANGLES + 1, &m, &error), AMB_ERROR_LIMIT);
    assert_string_equal(error.detail, "mesh: 268435457 triangles; at most 268435456 are allowed");
    assert_int_equal(amb_mesh_create(1, 1, NULL, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_mesh_sphere(1, 3, &m, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "sphere: rings is 1; allowed are 2 to 8192");
    assert_int_equal(amb_mesh_sphere(2, 2, &m, &error), AMB_ERROR_ARGUMENT);
    assert_string_equal(error.detail, "sphere: segments is 2; allowed are 3 to 8192");
    assert_int_equal(amb_mesh_sphere(9000, 9, &m, &error), AMB_ERROR_ARGUMENT);
    assert_null(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_is_a_sphere),
        cmocka_unit_test(test_sphere_is_closed),
        cmocka_unit_test(test_sphere_tangents),
        cmocka_unit_test(test_smooth_normals_of_a_sphere),
        cmocka_unit_test(test_normals_are_angle_weighted),
        cmocka_unit_test(test_degenerate_faces_are_ignored),
        cmocka_unit_test(test_tangent_handedness),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_check_names_the_first_fault),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
