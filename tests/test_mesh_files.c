/* Model files: one known shape in every format, and files that lie. */
#include "io/file.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static void must(amb_status status, const amb_error *error)
{
    if (status != AMB_OK)
        fail_msg("%s", error->detail);
}

static double area(const amb_mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        double p[3][3], e[2][3], n[3];
        for (int k = 0; k < 3; k++) {
            v3 a = mesh->position[mesh->index[3 * i + (uint32_t)k]];
            p[k][0] = (double)a.x, p[k][1] = (double)a.y, p[k][2] = (double)a.z;
        }
        for (int k = 0; k < 3; k++)
            e[0][k] = p[1][k] - p[0][k], e[1][k] = p[2][k] - p[0][k];
        for (int k = 0; k < 3; k++)
            n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
        sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}

/* A 1 × 2 rectangle at z = 0 and a triangle of 2 × 3 / 2 at x = 0: area 5, bounds (0, 0, 0) to (1, 2, 3); glTF moves it
 * by 10 along x and doubles it. */
static void one_shape_in_every_format(void **state)
{
    static const struct {
        const char *name;
        double scale, x;
        uint32_t vertices;
        bool has_normals, has_materials;
    } files[] = {{"quad.obj", 1, 0, 5, true, false},    {"materials.obj", 1, 0, 7, false, true},
                 {"ascii.ply", 1, 0, 5, false, false},  {"little.ply", 1, 0, 5, false, false},
                 {"big.ply", 1, 0, 5, false, false},    {"embedded.gltf", 2, 10, 5, false, false},
                 {"binary.glb", 2, 10, 5, false, false}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[96];
        amb_mesh *mesh;
        amb_error error;
        v3 low, high;
        snprintf(path, sizeof path, "tests/data/fuzz_mesh/%s", files[i].name);
        must(amb_read_mesh(path, &mesh, &error), &error);
        must(amb_mesh_check(mesh, &error), &error);
        amb_mesh_bounds(mesh, &low, &high);
        double s = files[i].scale, x = files[i].x;
        assert_int_equal(mesh->triangle_count, 3);
        assert_int_equal(mesh->vertex_count, files[i].vertices);
        assert_true(fabs(area(mesh) - 5.0 * s * s) < 1e-5);
        assert_true((double)low.x == x && low.y == 0.0f && low.z == 0.0f);
        assert_true((double)high.x == x + s && (double)high.y == 2 * s && (double)high.z == 3 * s);
        assert_true((mesh->normal != NULL) == files[i].has_normals);
        assert_true((mesh->material != NULL) == files[i].has_materials);
        amb_mesh_close(&mesh);
        assert_null(mesh);
    }
}

static void obj_attributes(void **state)
{
    amb_mesh *mesh;
    amb_error error;
    (void)state;
    must(amb_read_mesh("tests/data/fuzz_mesh/quad.obj", &mesh, &error), &error);
    assert_non_null(mesh->uv);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        assert_true(mesh->normal[i].x == 0.0f && mesh->normal[i].y == 0.0f &&
                    mesh->normal[i].z == 1.0f); /* was 2 long */
        if (mesh->position[i].x == 1.0f)        /* v points up in the file, down in ours */
            assert_true(mesh->uv[i].x == 1.0f && mesh->uv[i].y == (mesh->position[i].y == 2.0f ? 0.0f : 1.0f));
    }
    amb_mesh_close(&mesh);
    must(amb_read_mesh("tests/data/fuzz_mesh/materials.obj", &mesh, &error), &error);
    assert_true(mesh->material[0] != mesh->material[1]);
    amb_mesh_close(&mesh);
}

#define PLY_HEADER(VERTICES, FACES)                                                                              \
    "ply\nformat ascii 1.0\nelement vertex " VERTICES "\nproperty float x\nproperty float y\nproperty float z\n" \
    "element face " FACES "\nproperty list uchar int vertex_indices\nend_header\n"
#define THREE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define GLTF(ACCESSOR, BUFFER)                                                                            \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]," \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{" ACCESSOR         \
    "\"componentType\":5126,\"type\":\"VEC3\"}]" BUFFER "}"

static void files_that_lie_are_refused(void **state)
{
    static const struct {
        const char *extension, *text, *mentions;
    } files[] = {
        {"obj", "", "empty"},
        {"obj", "no model at all\n", ""},
        {"obj", THREE "f 1 2 4\n", "must name vertices"},
        {"obj", THREE "f 1 2 0\n", "must name vertices"},
        {"obj", THREE "f 1 2 -4\n", "must name vertices"},
        {"obj", THREE "f 1 2 99999999999999999999\n", "must name vertices"},
        {"obj", THREE "f 1/1 2/1 3/1\n", "must name vertices"},
        {"obj", THREE "f 1 2 x\n", "must name vertices"},
        {"obj", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "complete"},
        {"obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "finite"},
        {"obj", "v 0 0 1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ""},
        {"obj", THREE "p 1\n", ""},
        {"ply", "plx\n", "header"},
        {"ply", "ply\nformat ascii 1.0\n", "truncated"},
        {"ply", "ply\nformat ascii 2.0\nend_header\n", "header"},
        {"ply", "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", "header"},
        {"ply", PLY_HEADER("4000000000", "1"), "4000000000"},
        {"ply", PLY_HEADER("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ""},
        {"ply", PLY_HEADER("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "instance 1 of 1"},
        {"ply", PLY_HEADER("3", "1") "0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n", "instance 1 of 1"},
        {"ply", PLY_HEADER("3", "1") "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "instance 2 of 3"},
        {"ply", PLY_HEADER("3", "1") "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "finite"},
        {"ply", PLY_HEADER("3", "0") "0 0 0\n1 0 0\n0 1 0\n", ""},
        {"gltf", "{", ""},
        {"gltf", "{}", ""},
        {"gltf", GLTF("\"count\":4000000000,", ""), "count"},
        {"gltf", GLTF("\"count\":1e30,", ""), "count"},
        {"gltf", GLTF("\"count\":-3,", ""), "count"},
        {"gltf", GLTF("\"count\":3,\"bufferView\":7,", ""), ""},
        {"gltf", GLTF("\"count\":3,", ",\"buffers\":[{\"byteLength\":3000000000}]"), "byteLength"},
        {"glb", "glTF", "truncated"},
        {"glb", "glTF\2\0\0\0\xff\xff\xff\x7f", "truncated"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        amb_mesh *mesh;
        amb_error error = {.detail = "(no message)"};
        amb_status status =
            amb_read_mesh_memory(files[i].text, strlen(files[i].text), files[i].extension, "lie.file", &mesh, &error);
        if (status != AMB_ERROR_FORMAT && status != AMB_ERROR_LIMIT)
            fail_msg("%s: status %d", files[i].text, status);
        assert_null(mesh);
        if (!strstr(error.detail, files[i].mentions) || !strstr(error.detail, "lie.file") || strchr(error.detail, '\n'))
            fail_msg("%s: %s", files[i].text, error.detail);
    }
}

static void unknown_kinds_and_missing_files(void **state)
{
    amb_mesh *mesh;
    amb_error error;
    (void)state;
    assert_int_equal(amb_read_mesh("Makefile", &mesh, &error), AMB_ERROR_FORMAT);
    assert_non_null(strstr(error.detail, ".obj .ply .gltf .glb"));
    assert_int_equal(amb_read_mesh("tests/none.obj", &mesh, &error), AMB_ERROR_IO);
    assert_int_equal(amb_read_mesh("tests", &mesh, &error), AMB_ERROR_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_shape_in_every_format),
        cmocka_unit_test(obj_attributes),
        cmocka_unit_test(files_that_lie_are_refused),
        cmocka_unit_test(unknown_kinds_and_missing_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
