/* The tessellator against the rules of Direct3D 11: what it makes of factors. */
#include "raster/internal.h"
#include "tests/stage_draws.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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
        assert_true((int)c[k] < p->size.points);
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
    for (int32_t i = 0; i < p->size.triangles; i++) {
        const uint16_t *c = p->corner + 3 * i;
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

static uint32_t segments_of(int32_t factor, amb_partitioning partitioning)
{
    uint32_t up = ((uint32_t)factor + 65535) / 65536;
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
    const uint32_t edges = 3 * (uint32_t)p->size.triangles;
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
    assert_int_equal(p->size.points - (int)(edges + outer) / 2 + p->size.triangles, 1);
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

/* ---- against another implementation ----------------------------------------------------------------------------- */

/* Patch number n of the list that was run on another implementation. */
static void listed_patch(uint32_t n, amb_patch_shape *shape, amb_partitioning *partitioning, factors *f)
{
    uint32_t bits = n * 2654435761u;
    *shape = (amb_patch_shape)(n & 1u);
    *partitioning = (amb_partitioning)(n / 2 % 3);
    for (int i = 0; i < 6; i++) {
        bits = bits * 1664525u + 1013904223u;
        float a = (float)(bits >> 8) * (n / 6 & 1u ? 0x1p-21f : 0x1p-18f) + 0.01f; /* up to 8, up to 64 */
        *(i < 4 ? &f->edge[i] : &f->inside[i - 4]) = a;
    }
}

/* FNV-1a of a triangle's coordinates in 1/65536, its lowest corner first. */
static uint64_t hash_triangle(uint64_t hash, const float u[3], const float v[3])
{
    int first = 0;
    for (int k = 1; k < 3; k++)
        if (u[k] < u[first] || (u[k] == u[first] && v[k] < v[first]))
            first = k;
    for (int k = 0; k < 6; k++) {
        float a = k & 1 ? v[(first + k / 2) % 3] : u[(first + k / 2) % 3];
        hash = (hash ^ (uint64_t)(a * 65536.0f)) * 0x100000001b3u;
    }
    return hash;
}

/* 1200 patches, triangle by triangle and in their order, as Mesa 22.3's llvmpipe tessellates them in OpenGL (read back
 * by transform feedback), whose tessellator is Microsoft's reference. */
static void patterns_are_those_of_direct3d(void **state)
{
    (void)state;
    raster_pattern p = {0};
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t n = 0; n < 1200; n++) {
        amb_patch_shape shape;
        amb_partitioning partitioning;
        factors f;
        listed_patch(n, &shape, &partitioning, &f);
        const raster_factors clamped = raster_clamp_factors(shape, partitioning, f.edge, f.inside);
        assert_true(raster_make_pattern(&p, shape, partitioning, &clamped));
        for (int32_t i = 0; i < p.size.triangles; i++) {
            const uint16_t *c = p.corner + 3 * i;
            hash = hash_triangle(hash, (float[3]){p.u[c[0]], p.u[c[1]], p.u[c[2]]},
                                 (float[3]){p.v[c[0]], p.v[c[1]], p.v[c[2]]});
        }
    }
    raster_free_pattern(&p);
    assert_true(hash == 0x375ba0b7ad35132fu);
}

/* ---- points on an edge ------------------------------------------------------------------------------------------ */

/* When marks of a ruler are made coarse to fine, left to right: where is number n? */
static double ruler(int n)
{
    int level = 1;
    while (level * 2 <= n)
        level *= 2;
    return n == 0 ? 0.0 : (2.0 * (n - level) + 1.0) / (2.0 * level);
}

/* Point n of a factor's edge, without rounding: between the places it has at the whole factors below and above, where
 * the mark that is new above comes out of its neighbour. */
static double true_place(double factor, amb_partitioning partitioning, int n, int segments)
{
    if (2 * n > segments)
        return 1.0 - true_place(factor, partitioning, segments - n, segments);
    if (partitioning == AMB_INTEGER)
        return (double)n / segments;
    const int odd = partitioning == AMB_FRACTIONAL_ODD, high = segments, low = factor < high ? high - 2 : high;
    if (low == high || 2 * n == segments)
        return (double)n / segments;
    const int mark = odd ? (low - 1) / 2 : low / 2;
    int rank = 0;
    for (int k = 0; k < mark; k++)
        rank += ruler(k) < ruler(mark);
    const double below = (double)(n > rank ? n - 1 : n) / low, above = (double)n / high, t = (factor - low) / 2.0;
    return below + (above - below) * t;
}

static void check_edge(float factor, amb_partitioning partitioning)
{
    static raster_pattern p;
    const float edge[4] = {1.0f, factor, 1.0f, 1.0f}, inside[2] = {3.0f, 3.0f};
    const raster_factors f = raster_clamp_factors(AMB_QUAD, partitioning, edge, inside);
    const double used = (double)f.edge[1] / 65536.0;
    const int first = (int)segments_of(f.edge[0], partitioning), segments = (int)segments_of(f.edge[1], partitioning);
    assert_true(raster_make_pattern(&p, AMB_QUAD, partitioning, &f));
    for (int n = 0; n <= segments; n++) { /* the edge v = 0 comes second */
        const uint32_t at = (uint32_t)(first + n), mirrored = (uint32_t)(first + segments - n);
        assert_true(p.v[at] == 0.0f);
        assert_true(p.u[at] == 1.0f - p.u[mirrored]);
        assert_true(n == 0 || p.u[at] >= p.u[at - 1]);
        /* Direct3D multiplies by reciprocals of 16 bits: up to 32 times half a unit, and a rounding */
        if (fabs((double)p.u[at] - true_place(used, partitioning, n, segments)) > 16.6 / 65536.0)
            fail_msg("factor %g, partitioning %d, point %d: %g, not %g", (double)factor, (int)partitioning, n,
                     (double)p.u[at], true_place(used, partitioning, n, segments));
    }
    assert_true(p.u[first] == 0.0f && p.u[first + segments] == 1.0f);
    raster_free_pattern(&p);
}

static void edges_are_divided_as_the_rules_say(void **state)
{
    (void)state;
    for (int partitioning = AMB_INTEGER; partitioning <= AMB_FRACTIONAL_EVEN; partitioning++)
        for (int i = 1; i <= 64 * 37; i++)
            check_edge((float)i / 37.0f, (amb_partitioning)partitioning);
    for (int i = 1; i <= 63; i++) /* just above, some rounded reciprocals lead across the middle */
        for (int partitioning = AMB_INTEGER; partitioning <= AMB_FRACTIONAL_EVEN; partitioning++)
            check_edge((float)i + 0.002f, (amb_partitioning)partitioning);
}

static void factors_are_clamped_or_cull(void **state)
{
    (void)state;
    const float inside[2] = {2.0f, 2.0f};
    static const float culling[5] = {0.0f, -0.0f, -3.0f, NAN, -INFINITY};
    for (int partitioning = AMB_INTEGER; partitioning <= AMB_FRACTIONAL_EVEN; partitioning++)
        for (int shape = AMB_QUAD; shape <= AMB_TRIANGLE; shape++)
            for (int e = 0; e < 4; e++)
                for (int i = 0; i < 5; i++) {
                    float edge[4] = {5.0f, 5.0f, 5.0f, 5.0f};
                    edge[e] = culling[i];
                    raster_factors f =
                        raster_clamp_factors((amb_patch_shape)shape, (amb_partitioning)partitioning, edge, inside);
                    assert_true((f.edge[0] == 0) == (e < 3 || shape == AMB_QUAD));
                }
    static const float in[7] = {0.25f, 1.0f, 1.5f, 2.25f, 63.5f, 64.0f, INFINITY};
    static const double out[3][7] = {
        {1, 1, 2, 3, 64, 64, 64}, {1, 1, 1.5, 2.25, 63, 63, 63}, {2, 2, 2, 2.25, 63.5, 64, 64}};
    for (int partitioning = AMB_INTEGER; partitioning <= AMB_FRACTIONAL_EVEN; partitioning++)
        for (int i = 0; i < 7; i++) {
            const float edge[4] = {in[i], in[i], in[i], in[i]};
            raster_factors f = raster_clamp_factors(AMB_QUAD, (amb_partitioning)partitioning, edge, edge);
            assert_true((double)f.edge[3] / 65536.0 == out[partitioning][i]);
            assert_true((double)f.inside[1] / 65536.0 == out[partitioning][i]);
        }
    /* Inside factors that are no number, or below one, are the least; a fractional odd one leaves room for a ring. */
    const float two[4] = {2.0f, 2.0f, 2.0f, 2.0f}, none[2] = {NAN, -INFINITY};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(raster_clamp_factors(AMB_QUAD, AMB_INTEGER, two, none).inside[i], 65536);
        assert_int_equal(raster_clamp_factors(AMB_QUAD, AMB_FRACTIONAL_ODD, two, none).inside[i], 65537);
        assert_int_equal(raster_clamp_factors(AMB_QUAD, AMB_FRACTIONAL_EVEN, two, none).inside[i], 131072);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns_cover_their_domain_once),
        cmocka_unit_test(patterns_are_those_of_direct3d),
        cmocka_unit_test(edges_are_divided_as_the_rules_say),
        cmocka_unit_test(factors_are_clamped_or_cull),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
