#include "tests/manifold.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct half_edge {
    uint32_t from, to, next;
} half_edge; /* `next`: the triangle's vertex after `to` */

static int by_vertices(const void *a, const void *b)
{
    const half_edge *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return x->to < y->to ? -1 : x->to > y->to;
}

static half_edge *half_edges(const amb_mesh *mesh)
{
    half_edge *list = malloc((size_t)mesh->triangle_count * 3 * sizeof *list);
    assert_non_null(list);
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        for (uint32_t i = 0; i < 3; i++)
            list[t * 3 + i] =
                (half_edge){mesh->index[t * 3 + i], mesh->index[t * 3 + (i + 1) % 3], mesh->index[t * 3 + (i + 2) % 3]};
    qsort(list, (size_t)mesh->triangle_count * 3, sizeof *list, by_vertices);
    return list;
}

static const half_edge *find(const half_edge *list, size_t count, uint32_t from, uint32_t to)
{
    half_edge key = {from, to, 0};
    return bsearch(&key, list, count, sizeof *list, by_vertices);
}

/* Every directed edge is there once and its opposite is too; around each vertex the triangles form one closed fan.
 * Returns the Euler characteristic. */
int check_manifold(const amb_mesh *mesh)
{
    size_t count = (size_t)mesh->triangle_count * 3;
    half_edge *list = half_edges(mesh);
    for (size_t i = 0; i < count; i++) {
        assert_int_not_equal(list[i].from, list[i].to);
        if (i > 0)
            assert_true(by_vertices(&list[i - 1], &list[i]) < 0);
        assert_non_null(find(list, count, list[i].to, list[i].from));
    }
    for (size_t start = 0; start < count;) {
        size_t end = start, steps = 0;
        while (end < count && list[end].from == list[start].from)
            end++;
        const half_edge *e = &list[start];
        do { /* the triangle (from, to, next): the next one of the fan begins with the edge from → next */
            e = find(list, count, e->from, e->next);
            assert_non_null(e);
            steps++;
        } while (e != &list[start] && steps <= end - start);
        assert_int_equal(steps, end - start);
        start = end;
    }
    free(list);
    return (int)mesh->vertex_count - (int)(count / 2) + (int)mesh->triangle_count;
}
