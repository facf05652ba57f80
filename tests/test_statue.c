/* The built-in statue: one closed surface of the promised size, the same on every instruction set. */
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "tests/manifold.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static amb_mesh *statue_of(amb_isa isa, int threads)
{
    amb_context *context = NULL;
    amb_context_options options = {.isa = isa, .threads = threads};
    amb_mesh *mesh = NULL;
    amb_error error = {0};
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    if (amb_builtin_statue(context, &mesh, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    amb_context_close(&context);
    return mesh;
}

static amb_mesh *statue; /* made once: the widest instruction set, 2 threads */

static int make_statue(void **state)
{
    (void)state;
    statue = statue_of(AMB_ISA_AUTO, 2);
    return 0;
}

static int close_statue(void **state)
{
    (void)state;
    amb_mesh_close(&statue);
    return 0;
}

static uint32_t root(uint32_t *parent, uint32_t a)
{
    while (parent[a] != a)
        a = parent[a] = parent[parent[a]];
    return a;
}

/* Pieces that no edge joins: floating bits and hollows inside. */
static int pieces(const amb_mesh *mesh)
{
    uint32_t *parent = malloc(mesh->vertex_count * sizeof *parent);
    assert_non_null(parent);
    int count = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < mesh->triangle_count * 3; i++)
        parent[root(parent, mesh->index[i])] = root(parent, mesh->index[i - i % 3]);
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        count += parent[i] == i;
    free(parent);
    return count;
}

static void statue_is_one_closed_surface(void **state)
{
    (void)state;
    const amb_mesh *mesh = statue;
    assert_true(mesh->triangle_count >= 100000);
    assert_int_equal(amb_mesh_check(mesh, NULL), AMB_OK);
    check_manifold(mesh);
    assert_int_equal(pieces(mesh), 1);
    v3 lo, hi;
    amb_mesh_bounds(mesh, &lo, &hi);
    assert_true(lo.y > -0.14f && lo.y < -0.13f && hi.y > 1.2f && hi.y < 1.35f); /* plinth's foot; torch's tip */
    assert_true(hi.x - lo.x > 0.8f && hi.x - lo.x < hi.y - lo.y);               /* wings; taller than wide */
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        assert_true(fabsf(v3_length(mesh->normal[i]) - 1.0f) < 1e-5f);
}

/* Normals agree with the triangles around them: hardly any face looks away from its own corners' normals. */
static void normals_agree_with_faces(void **state)
{
    (void)state;
    const amb_mesh *mesh = statue;
    double away = 0.0, all = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *i = mesh->index + (size_t)t * 3;
        v3 a = mesh->position[i[0]], face = v3_cross(v3_sub(mesh->position[i[1]], a), v3_sub(mesh->position[i[2]], a));
        v3 mean = v3_add(v3_add(mesh->normal[i[0]], mesh->normal[i[1]]), mesh->normal[i[2]]);
        double area = 0.5 * (double)v3_length(face);
        all += area;
        away += v3_dot(face, mean) < 0.0f ? area : 0.0;
    }
    assert_true(all > 1.0 && away < 0.002 * all);
}

static void same_statue_everywhere(void **state)
{
    (void)state;
    const amb_mesh *truth = statue;
    amb_mesh *mesh = statue_of(AMB_ISA_V2, 3);
    assert_int_equal(mesh->vertex_count, truth->vertex_count);
    assert_int_equal(mesh->triangle_count, truth->triangle_count);
    assert_memory_equal(mesh->position, truth->position, truth->vertex_count * sizeof(v3));
    assert_memory_equal(mesh->normal, truth->normal, truth->vertex_count * sizeof(v3));
    assert_memory_equal(mesh->index, truth->index, (size_t)truth->triangle_count * 3 * sizeof(uint32_t));
    amb_mesh_close(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statue_is_one_closed_surface),
        cmocka_unit_test(normals_agree_with_faces),
        cmocka_unit_test(same_statue_everywhere),
    };
    return cmocka_run_group_tests(tests, make_statue, close_statue);
}
