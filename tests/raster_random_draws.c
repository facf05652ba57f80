/* The truth of a random draw: its primitives, one after the other, as the stages before the rasterizer make them. */
#include "tests/raster_random_pass.h"

#include "raster/tessellate.h"

#include <math.h>
#include <string.h>

/* Positions of primitive n's corners; returns how many, 0 past the last primitive. */
static int corners_of(amb_topology topology, int n, int count, int at[3])
{
    static const int corners[] = {3, 3, 3, 2, 2, 1};
    int first = topology == AMB_TRIANGLES ? 3 * n : topology == AMB_LINES ? 2 * n : n;
    for (int k = 0; k < 3; k++)
        at[k] = topology == AMB_TRIANGLE_FAN && k == 0 ? 0 : first + k;
    if (topology == AMB_TRIANGLE_STRIP && n % 2)
        at[1] = first + 2, at[2] = first + 1;
    if (first + corners[topology] > count)
        return 0;
    return corners[topology];
}

/* What the copying geometry shader makes of a primitive: strips of its corners, as far as vertices are allowed. */
static void truth_copies(random_pass *p, const float clip[3][4], int corners)
{
    const raster_test_uniforms *u = &p->now->uniforms;
    const amb_geometry *g = &p->now->state.geometry;
    const int needed = g->output == AMB_TRIANGLES ? 3 : g->output == AMB_LINES ? 2 : 1;
    int emitted = 0;
    for (int c = 0; c < u->copies && c < RASTER_TEST_COPIES(p->primitive); c++) {
        float strip[3][4];
        for (int k = 0; k < corners && emitted < g->vertices; k++, emitted++) {
            for (int i = 0; i < 4; i++)
                strip[k][i] = clip[k][i] + (&u->step.x)[i] * (float)c;
            if (k + 1 >= needed)
                random_truth_primitive(p, (const float(*)[4])(strip + k + 1 - needed), needed);
        }
    }
}

/* Index value `at` of a draw, and its vertex's place; false when it is out of range. */
static bool corner_at(const random_draw *d, int at, int instance, float clip[4])
{
    const float *offset = &d->uniforms.offset.x;
    uint32_t v = d->state.indices ? d->index[at] : (uint32_t)at;
    if (d->state.indices && v >= d->state.vertex_count)
        return false;
    memcpy(clip, &d->vertex[v].clip, sizeof(float[4]));
    for (int c = 0; c < 4; c++)
        clip[c] += offset[c] * (float)instance;
    return true;
}

static void after_vertices(random_pass *p, const float clip[3][4], int corners)
{
    if (p->now->state.geometry.shader)
        truth_copies(p, clip, corners);
    else
        random_truth_primitive(p, clip, corners);
}

/* What the domain shaders make of a point. */
static void domain_point(const amb_tessellation *t, const float corner[4][4], float u, float v, float clip[4])
{
    float left = 1.0f - u, bottom = 1.0f - v;
    for (int i = 0; i < 4; i++)
        clip[i] = t->shape == AMB_QUAD ? (corner[0][i] * (left * bottom) + corner[1][i] * (u * bottom)) +
                                             (corner[2][i] * (u * v) + corner[3][i] * (left * v))
                                       : (corner[0][i] * u + corner[1][i] * v) + corner[2][i] * (left - v);
}

/* A patch: the pattern is the library's own, which test_tessellation.c checks; what is done with it is not. */
static void truth_patch(random_pass *p, const float corner[4][4], raster_pattern *pattern)
{
    static const float table[8] = RASTER_TEST_FACTORS;
    const amb_tessellation *t = &p->now->state.tessellation;
    float factor[6], clip[3][4];
    for (int i = 0; i < 6; i++) {
        int pick = RASTER_TEST_FACTOR(p->primitive, i, p->now->uniforms.factors);
        factor[i] = pick == 7 && p->now->uniforms.factors % 2 == 0 ? 2.0f : table[pick];
    }
    const raster_factors f = raster_clamp_factors(t->shape, t->partitioning, factor, factor + 4);
    if (f.edge[0] == 0 || !raster_make_pattern(pattern, t->shape, t->partitioning, &f))
        return;
    const int per = t->points ? 1 : 3, count = t->points ? pattern->size.points : pattern->size.triangles;
    for (int n = 0; n < count; n++) {
        for (int k = 0; k < per; k++) {
            int turned = t->clockwise && !t->points ? (3 - k) % 3 : k; /* the first corner stays */
            int point = t->points ? n : pattern->corner[3 * n + turned];
            domain_point(t, corner, pattern->u[point], pattern->v[point], clip[k]);
        }
        after_vertices(p, (const float(*)[4])clip, per);
    }
}

static void truth_patches(random_pass *p, const random_draw *d, int instance)
{
    raster_pattern pattern = {0};
    const int corners = d->state.tessellation.corners, used = d->state.tessellation.shape == AMB_QUAD ? 4 : 3;
    for (int n = 0; (n + 1) * corners <= (int)d->state.count; n++, p->primitive++) {
        float corner[4][4] = {{0}}, unused[4];
        bool valid = true;
        for (int k = 0; k < corners; k++)
            valid &= corner_at(d, n * corners + k, instance, k < used ? corner[k] : unused);
        if (valid)
            truth_patch(p, (const float(*)[4])corner, &pattern);
    }
    raster_free_pattern(&pattern);
}

static void truth_primitives(random_pass *p, const random_draw *d, int instance)
{
    int at[3] = {0}, corners;
    for (int n = 0; (corners = corners_of(d->state.topology, n, (int)d->state.count, at)) > 0; n++, p->primitive++) {
        float clip[3][4] = {{0}};
        bool valid = true;
        for (int k = 0; k < corners; k++)
            valid = valid && corner_at(d, at[k], instance, clip[k]);
        if (valid)
            after_vertices(p, (const float(*)[4])clip, corners);
    }
}

void random_truth_draw(random_pass *p, const random_draw *d)
{
    p->now = d;
    p->primitive = 0;
    p->front = true;
    if (random_is_screen(&d->state)) {
        for (int i = 0; i < p->width * p->height; i++)
            random_truth_pixel(p, i % p->width, i / p->width);
        return;
    }
    int instances = d->state.instances ? (int)d->state.instances : 1;
    for (int i = 0; i < instances; i++) {
        if (d->state.topology == AMB_PATCHES)
            truth_patches(p, d, i);
        else
            truth_primitives(p, d, i);
    }
}
