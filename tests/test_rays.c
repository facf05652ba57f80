/* Ray queries against brute force: double precision for truth, a plain float scan of every triangle for the bits, on
 * every instruction set of ours and of Embree. */
#include "march/rays_internal.h"
#include "tests/truth_rays.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- helpers ----------------------------------------------------------------------------------------------------- */

static float uniform(uint32_t *state, float lo, float hi)
{
    *state = *state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (float)(*state >> 8) / 16777216.0f;
}
static v3 uniform3(uint32_t *state, float lo, float hi)
{
    float x = uniform(state, lo, hi), y = uniform(state, lo, hi), z = uniform(state, lo, hi);
    return (v3){x, y, z};
}
static uint32_t bits_of(float a)
{
    uint32_t r;
    memcpy(&r, &a, 4);
    return r;
}

static amb_mesh *new_mesh(uint32_t vertices, uint32_t triangles)
{
    amb_mesh *m = calloc(1, sizeof *m);
    assert_non_null(m);
    m->vertex_count = vertices;
    m->triangle_count = triangles;
    m->position = calloc(vertices + 1, sizeof(v3));
    m->index = calloc(3 * (size_t)triangles + 1, sizeof(uint32_t));
    assert_non_null(m->position);
    assert_non_null(m->index);
    return m;
}
static void free_mesh(amb_mesh *m)
{
    free(m->position);
    free(m->index);
    free(m);
}

typedef void (*tracer)(const amb_rays *rays, const listed_ray *ray, int count, listed_hit *hit);
static tracer tracer_of(amb_isa isa)
{
#if defined(__x86_64__)
    return isa == AMB_ISA_V4 ? trace_list_x16 : isa == AMB_ISA_V3 ? trace_list_x8 : trace_list_x4;
#else
    (void)isa;
    return trace_list_x4;
#endif
}

static amb_context *context_of(amb_isa isa)
{
    amb_context_options options = {.isa = isa, .threads = 2};
    amb_context *context = NULL;
    assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
    return context;
}

static amb_rays *rays_of(const amb_context *context, const char *embree, const amb_rays_geometry *g, uint32_t count)
{
    amb_rays *rays = NULL;
    amb_error error = {AMB_OK, ""};
    if (amb_rays_create_on(embree, context, g, count, &rays, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    return rays;
}

/* Traces on every available instruction set of ours × of Embree's, requires equal bits, and returns the hits. */
static listed_hit *trace_everywhere(const amb_rays_geometry *g, uint32_t geometry_count, const listed_ray *ray,
                                    int count)
{
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    const char *const embree[] = {NULL, "isa=sse2", "isa=sse4.2", "isa=avx", "isa=avx2", "isa=avx512"};
    listed_hit *first = NULL;
    for (int i = 0; i < 3; i++) {
        if (!amb_isa_available(isas[i]))
            continue;
        amb_context *context = context_of(isas[i]);
        for (int e = 0; e < 6; e++) {
            if (e >= 3 && !amb_isa_available(e == 5 ? AMB_ISA_V4 : AMB_ISA_V3))
                continue;
            amb_rays *rays = rays_of(context, embree[e], g, geometry_count);
            /* The query's lanes need not be the callbacks' lanes. */
            for (int q = 0; q < 3; q++) {
                if (!amb_isa_available(isas[q]) || (e > 0 && q != i))
                    continue;
                listed_hit *hit = malloc((size_t)count * sizeof *hit);
                assert_non_null(hit);
                tracer_of(isas[q])(rays, ray, count, hit);
                if (first == NULL) {
                    first = hit;
                    continue;
                }
                for (int k = 0; k < count; k++)
                    if (memcmp(&first[k], &hit[k], sizeof hit[k]) != 0)
                        fail_msg("ray %d differs: lanes %d, callbacks %d, Embree %s: t %a primitive %d, not %a %d", k,
                                 isas[q], isas[i], embree[e] ? embree[e] : "default", (double)hit[k].t,
                                 hit[k].primitive, (double)first[k].t, first[k].primitive);
                free(hit);
            }
            amb_rays_close(&rays);
        }
        amb_context_close(&context);
    }
    return first;
}

/* ---- triangles --------------------------------------------------------------------------------------------------- */

static amb_mesh *soup(uint32_t triangles, float size, uint32_t seed)
{
    amb_mesh *m = new_mesh(3 * triangles, triangles);
    for (uint32_t i = 0; i < triangles; i++) {
        v3 c = i < 2 ? (v3){(float)i * 2 - 1, 1, 1} : uniform3(&seed, -1, 1); /* the first two fix the scene's radius */
        for (uint32_t k = 0; k < 3; k++) {
            m->position[3 * i + k] = v3_add(c, uniform3(&seed, -size, size));
            m->index[3 * i + k] = 3 * i + k;
        }
    }
    return m;
}

static void make_rays(listed_ray *ray, int count, float reach, uint32_t seed)
{
    for (int i = 0; i < count; i++) {
        v3 origin = uniform3(&seed, -reach, reach), target = uniform3(&seed, -1, 1);
        ray[i] = (listed_ray){origin, v3_sub(target, origin), 0, i % 3 ? INFINITY : uniform(&seed, 0.1f, 2), 0};
    }
}

enum { RAYS = 3001 };

static void random_soups_hit_what_brute_force_hits(void **state)
{
    (void)state;
    listed_ray *ray = malloc(RAYS * sizeof *ray);
    for (int round = 0; round < 3; round++) {
        amb_mesh *m = soup(round == 0 ? 5 : 700, round == 1 ? 0.3f : 0.08f, (uint32_t)round + 7);
        make_rays(ray, RAYS, round == 2 ? 1 : 3, (uint32_t)round + 20);
        amb_rays_geometry g = {.mesh = m};
        listed_hit *hit = trace_everywhere(&g, 1, ray, RAYS);
        int clear = 0, hits = 0;
        for (int i = 0; i < RAYS; i++) {
            listed_hit same = scan(m, &ray[i]);
            assert_int_equal(hit[i].hit, same.hit);
            assert_int_equal(hit[i].occluded, same.hit);
            assert_int_equal(hit[i].primitive, same.primitive);
            assert_int_equal(hit[i].geometry, same.hit ? 0 : -1);
            assert_int_equal(bits_of(hit[i].t), bits_of(same.t));
            assert_int_equal(bits_of(hit[i].u), bits_of(same.u));
            assert_int_equal(bits_of(hit[i].v), bits_of(same.v));
            hits += hit[i].hit;
            truth t = true_hit(m, &ray[i]);
            if (!t.clear || fabs(t.t - (double)ray[i].t_far) < 1e-4)
                continue;
            clear++;
            assert_int_equal(hit[i].hit, t.hit && t.t < (double)ray[i].t_far);
            if (!hit[i].hit)
                continue;
            assert_int_equal(hit[i].primitive, t.primitive);
            assert_true(fabs((double)hit[i].t - t.t) < 2e-5 * (1 + t.t));
            assert_true(fabs((double)hit[i].u - t.u) < 2e-3 && fabs((double)hit[i].v - t.v) < 2e-3);
            v3 normal = hit[i].normal;
            double cosine =
                (double)normal.x * t.normal[0] + (double)normal.y * t.normal[1] + (double)normal.z * t.normal[2];
            assert_true(cosine > 0.9999);
        }
        assert_true(clear > RAYS * 3 / 4);
        assert_true(hits > (round == 0 ? 1 : RAYS / 8));
        free(hit);
        free_mesh(m);
    }
    free(ray);
}

static void slivers_agree_with_the_scan_and_degenerate_triangles_are_never_hit(void **state)
{
    (void)state;
    uint32_t seed = 5;
    amb_mesh *m = soup(900, 0.5f, 3);
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        v3 *p = m->position + 3 * i;
        if (i % 3 == 0) /* needle */
            p[2] = v3_add(v3_lerp(p[0], p[1], uniform(&seed, 0, 1)), uniform3(&seed, -1e-6f, 1e-6f));
        if (i % 3 == 1) /* exactly no area: a repeated corner, or three points of a line */
            p[1] = v3_scale(p[0], i % 2 ? 1 : -1), p[2] = v3_scale(p[0], 0.5f);
        if (i % 3 == 2) /* crumb */
            p[1] = v3_add(p[0], uniform3(&seed, -1e-5f, 1e-5f)), p[2] = v3_add(p[0], uniform3(&seed, -1e-5f, 1e-5f));
    }
    listed_ray *ray = malloc(RAYS * sizeof *ray);
    for (int i = 0; i < RAYS; i++) { /* aimed at the triangles: at random points of them */
        const v3 *p = m->position + 3 * (size_t)(i % 900);
        v3 at = v3_lerp(v3_lerp(p[0], p[1], uniform(&seed, 0, 1)), p[2], uniform(&seed, 0, 1));
        v3 origin = uniform3(&seed, -3, 3);
        ray[i] = (listed_ray){origin, v3_sub(at, origin), 0, INFINITY, 0};
    }
    amb_rays_geometry g = {.mesh = m};
    listed_hit *hit = trace_everywhere(&g, 1, ray, RAYS);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        hits += hit[i].hit;
        assert_true(hit[i].primitive % 3 != 1);
        assert_int_equal(hit[i].occluded, hit[i].hit);
        listed_hit same = scan(m, &ray[i]);
        if (bits_of(same.t) == bits_of(hit[i].t))
            continue;
        /* The scan has no box test, and seen edge-on its t is anyone's guess: then its point is off the triangle. */
        const v3 *p = m->position + 3 * same.primitive;
        v3 at = v3_add(ray[i].origin, v3_scale(ray[i].direction, same.t));
        v3 lo = v3_min(v3_min(p[0], p[1]), p[2]), hi = v3_max(v3_max(p[0], p[1]), p[2]);
        v3 off = v3_max(v3_sub(lo, at), v3_sub(at, hi));
        assert_true(same.primitive % 3 == 1 || off.x > 1e-5f || off.y > 1e-5f || off.z > 1e-5f);
    }
    assert_true(hits > RAYS / 10);
    free(hit);
    free(ray);
    free_mesh(m);
}

/* Closed, slightly bumpy ball around the origin: no ray from inside may leave, whatever edge or vertex it is aimed at.
 */
static void no_ray_slips_through_shared_edges(void **state)
{
    (void)state;
    enum { RINGS = 14, SEGMENTS = 22 };
    amb_mesh *m = new_mesh(2 + (RINGS - 1) * SEGMENTS, 2 * SEGMENTS * (RINGS - 1));
    uint32_t seed = 9, n = 0;
    m->position[0] = (v3){0, 1, 0};
    m->position[1] = (v3){0, -1, 0};
    for (uint32_t r = 1; r < RINGS; r++)
        for (uint32_t s = 0; s < SEGMENTS; s++) {
            double b = M_PI * r / RINGS, a = 2 * M_PI * s / SEGMENTS;
            v3 p = {(float)(sin(b) * cos(a)), (float)cos(b), (float)(sin(b) * sin(a))};
            m->position[2 + (r - 1) * SEGMENTS + s] = v3_scale(p, uniform(&seed, 0.999f, 1.001f));
        }
    for (uint32_t r = 0; r < RINGS; r++)
        for (uint32_t s = 0; s < SEGMENTS; s++) {
            uint32_t next = (s + 1) % SEGMENTS;
            uint32_t a = r == 0 ? 0 : 2 + (r - 1) * SEGMENTS + s, b = r == 0 ? 0 : 2 + (r - 1) * SEGMENTS + next;
            uint32_t c = r == RINGS - 1 ? 1 : 2 + r * SEGMENTS + s, d = r == RINGS - 1 ? 1 : 2 + r * SEGMENTS + next;
            const uint32_t quad[6] = {a, b, c, b, d, c};
            for (uint32_t k = r == 0 ? 3 : 0; k < (r == RINGS - 1 ? 3u : 6u); k++)
                m->index[n++] = quad[k];
        }
    assert_int_equal(n, 3 * m->triangle_count);
    enum { MANY = 30000 };
    listed_ray *ray = malloc(MANY * sizeof *ray);
    for (int i = 0; i < MANY; i++) {
        uint32_t k = 3 * ((uint32_t)i % m->triangle_count);
        v3 a = m->position[m->index[k]], b = m->position[m->index[k + 1]];
        float along = i % 4 == 0 ? 0 : i % 4 == 1 ? 0.5f : uniform(&seed, 0, 1);
        v3 origin = i % 5 == 0 ? (v3){0, 0, 0} : uniform3(&seed, -0.3f, 0.3f);
        ray[i] = (listed_ray){origin, v3_sub(v3_lerp(a, b, along), origin), 0, INFINITY, 0};
    }
    amb_rays_geometry g = {.mesh = m};
    listed_hit *hit = trace_everywhere(&g, 1, ray, MANY);
    for (int i = 0; i < MANY; i++)
        if (!hit[i].hit || !hit[i].occluded || fabsf(hit[i].t - 1) > 0.02f)
            fail_msg("ray %d left the closed mesh (t %g)", i, (double)hit[i].t);
    free(hit);
    free(ray);
    free_mesh(m);
}

static void equal_distances_go_to_the_lower_geometry_and_primitive(void **state)
{
    (void)state;
    amb_mesh *m = new_mesh(40, 40);
    for (uint32_t i = 0; i < 40; i++)
        m->position[i] = (v3){i % 3 == 1, i % 3 == 2, (float)(i / 3 % 4)};
    for (uint32_t i = 0; i < 40; i++) /* triangles 0…39 are ten copies each of four; the nearest is at z = 3 */
        for (uint32_t k = 0; k < 3; k++)
            m->index[3 * i + k] = 3 * ((39 - i) % 4) + k;
    amb_rays_sphere late = {{0.25f, 0.25f, 2}, 1}; /* top at z = 3, exactly */
    amb_rays_geometry g[3] = {{.mesh = m}, {.mesh = m}, {.spheres = &late, .sphere_count = 1}};
    listed_ray ray[4];
    for (int i = 0; i < 4; i++)
        ray[i] = (listed_ray){{0.25f, 0.25f, 5}, {0, 0, i & 1 ? -1.0f : -2.0f}, 0, i & 2 ? INFINITY : i & 1 ? 2 : 1, 0};
    listed_hit *hit = trace_everywhere(g, 3, ray, 4);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(hit[i].geometry, 0);
        assert_int_equal(hit[i].primitive, 0);
        assert_true(hit[i].t == (i & 1 ? 2 : 1));
        assert_true(fabsf(hit[i].normal.z - 1) < 1e-6f);
    }
    free(hit);
    free_mesh(m);
}

/* ---- limits of the ray ------------------------------------------------------------------------------------------- */

static void limits_are_near_exclusive_and_far_inclusive(void **state)
{
    (void)state;
    enum { TRIED = 400 };
    amb_mesh *m = soup(1, 0.9f, 8);
    listed_ray ray[TRIED], limited[4 * TRIED];
    make_rays(ray, TRIED, 2, 3);
    for (int i = 0; i < TRIED; i++) {
        v3 at =
            v3_lerp(m->position[0], v3_lerp(m->position[1], m->position[2], (float)(i % 20) / 16), (float)i / TRIED);
        ray[i] = (listed_ray){ray[i].origin, v3_sub(at, ray[i].origin), 0, INFINITY, 0};
    }
    amb_rays_geometry g = {.mesh = m};
    listed_hit *hit = trace_everywhere(&g, 1, ray, TRIED);
    int hits = 0;
    for (int i = 0; i < TRIED; i++)
        for (int k = 0; k < 4; k++) {
            float t = hit[i].hit ? hit[i].t : 1;
            limited[4 * i + k] = ray[i];
            limited[4 * i + k].t_far = k == 0 ? t : k == 1 ? nextafterf(t, 0) : INFINITY;
            limited[4 * i + k].t_near = k == 2 ? t : k == 3 ? nextafterf(t, 0) : -1;
        }
    listed_hit *again = trace_everywhere(&g, 1, limited, 4 * TRIED);
    for (int i = 0; i < TRIED; i++) {
        hits += hit[i].hit;
        for (int k = 0; k < 4; k++) {
            const listed_hit *h = &again[4 * i + k];
            assert_int_equal(h->hit, hit[i].hit && (k == 0 || k == 3));
            assert_int_equal(h->occluded, h->hit);
            assert_int_equal(bits_of(h->t), bits_of(h->hit ? hit[i].t : limited[4 * i + k].t_far));
        }
    }
    assert_true(hits > 20);
    free(again);
    free(hit);
    free_mesh(m);
}

static void bad_rays_and_dead_lanes_miss_without_touching_their_neighbours(void **state)
{
    (void)state;
    amb_mesh *m = soup(300, 0.3f, 4);
    const float bad[] = {NAN, INFINITY, -INFINITY};
    enum { TRIED = 640 };
    listed_ray ray[TRIED], spoilt[TRIED];
    make_rays(ray, TRIED, 2, 30);
    memcpy(spoilt, ray, sizeof ray);
    for (int i = 0; i < TRIED; i += 2) {
        listed_ray *r = &spoilt[i];
        float *field = (i / 2) % 9 < 3 ? &r->origin.x : &r->direction.x;
        switch (i / 2 % 9) {
        case 0:
        case 1:
        case 2:
        case 3:
        case 4:
        case 5:
            field[i / 2 % 3] = bad[i / 18 % 3];
            break;
        case 6:
            r->direction = (v3){0, 0, 0};
            break;
        case 7:
            r->dead = 1;
            break;
        default:
            *(i / 18 % 2 ? &r->t_near : &r->t_far) = NAN;
            break;
        }
    }
    amb_rays_geometry g = {.mesh = m};
    listed_hit *clean = trace_everywhere(&g, 1, ray, TRIED), *hit = trace_everywhere(&g, 1, spoilt, TRIED);
    for (int i = 0; i < TRIED; i++) {
        if (i % 2) {
            assert_memory_equal(&hit[i], &clean[i], sizeof hit[i]);
            continue;
        }
        assert_false(hit[i].hit || hit[i].occluded);
        assert_int_equal(hit[i].geometry, -1);
        assert_int_equal(hit[i].primitive, -1);
        assert_int_equal(bits_of(hit[i].t), bits_of(spoilt[i].t_far));
    }
    free(clean);
    free(hit);
    free_mesh(m);
}

static void the_length_of_the_direction_only_scales_t(void **state)
{
    (void)state;
    enum { TRIED = 600 };
    amb_mesh *m = soup(300, 0.3f, 4);
    amb_rays_sphere ball = {{0.1f, 0.2f, 0.3f}, 0.4f};
    amb_rays_geometry g[2] = {{.mesh = m}, {.spheres = &ball, .sphere_count = 1}};
    listed_ray ray[TRIED], scaled[TRIED];
    make_rays(ray, TRIED, 2, 31);
    listed_hit *hit = trace_everywhere(g, 2, ray, TRIED);
    const float factor[] = {0x1p-90f, 0x1p-9f, 0x1p20f, 0x1p100f};
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < TRIED; i++) {
            scaled[i] = ray[i];
            scaled[i].direction = v3_scale(ray[i].direction, factor[k]);
            scaled[i].t_far = ray[i].t_far / factor[k];
        }
        listed_hit *other = trace_everywhere(g, 2, scaled, TRIED);
        for (int i = 0; i < TRIED; i++) {
            assert_int_equal(other[i].hit, hit[i].hit);
            assert_int_equal(other[i].primitive, hit[i].primitive);
            assert_int_equal(bits_of(other[i].t * factor[k]), bits_of(hit[i].t));
        }
        free(other);
    }
    free(hit);
    free_mesh(m);
}

static void far_origins_keep_their_precision(void **state)
{
    (void)state;
    enum { TRIED = 900 };
    amb_mesh *m = soup(200, 0.3f, 4);
    amb_rays_geometry g = {.mesh = m};
    listed_ray ray[TRIED], back[TRIED];
    uint32_t seed = 77;
    for (int i = 0; i < TRIED; i++) { /* along an axis, so that both origins lie exactly on one line */
        v3 at = uniform3(&seed, -1, 1);
        float away = i % 3 == 0 ? 0x1p3f : i % 3 == 1 ? 0x1p12f : 0x1p24f;
        ray[i] = (listed_ray){{at.x, at.y, 4}, {0, 0, -1}, 0, INFINITY, 0};
        back[i] = (listed_ray){{at.x, at.y, 4 + away}, {0, 0, -1}, 0, INFINITY, 0};
    }
    listed_hit *near = trace_everywhere(&g, 1, ray, TRIED), *far = trace_everywhere(&g, 1, back, TRIED);
    int hits = 0;
    for (int i = 0; i < TRIED; i++) {
        assert_int_equal(near[i].hit, far[i].hit);
        assert_int_equal(near[i].primitive, far[i].primitive);
        hits += near[i].hit;
        if (near[i].hit)
            assert_true(fabsf(near[i].u - far[i].u) < 1e-3f && fabsf(near[i].v - far[i].v) < 1e-3f);
        if (near[i].hit)
            assert_true(fabs((double)far[i].t - ((double)back[i].origin.z - 4) - (double)near[i].t) <=
                        0x1p-22 * (double)far[i].t);
    }
    assert_true(hits > TRIED / 3);
    for (int i = 0; i < TRIED; i++) /* turned round, passing by, or ending before */
        switch (i % 3) {
        case 0:
            back[i].direction.z = 1;
            break;
        case 1:
            back[i].origin.x += 1e4f;
            break;
        default:
            back[i].t_far = back[i].origin.z - 3;
            break;
        }
    free(far);
    far = trace_everywhere(&g, 1, back, TRIED);
    for (int i = 0; i < TRIED; i++)
        assert_false(far[i].hit || far[i].occluded);
    free(near);
    free(far);
    free_mesh(m);
}

/* ---- spheres ----------------------------------------------------------------------------------------------------- */

static void spheres_agree_with_double_precision(void **state)
{
    (void)state;
    enum { BALLS = 60 };
    uint32_t seed = 12;
    amb_rays_sphere ball[BALLS + 3];
    for (int i = 0; i < BALLS; i++)
        ball[i] = (amb_rays_sphere){uniform3(&seed, -1, 1), uniform(&seed, 0.02f, i % 4 ? 0.2f : 0.7f)};
    ball[BALLS] = (amb_rays_sphere){{0, NAN, 0}, 9};
    ball[BALLS + 1] = (amb_rays_sphere){{0, 0, 0}, INFINITY};
    ball[BALLS + 2] = (amb_rays_sphere){{0, 0, 0}, -2};
    amb_rays_geometry g = {.spheres = ball, .sphere_count = BALLS + 3};
    listed_ray *ray = malloc(RAYS * sizeof *ray);
    make_rays(ray, RAYS, 2, 40);
    listed_hit *hit = trace_everywhere(&g, 1, ray, RAYS);
    int clear = 0, hits = 0, inside = 0;
    for (int i = 0; i < RAYS; i++) {
        ball_truth best = true_ball_hit(ball, BALLS, &ray[i]);
        const int which = best.ball;
        if (!best.clear)
            continue;
        clear++;
        assert_int_equal(hit[i].hit, which >= 0);
        assert_int_equal(hit[i].occluded, which >= 0);
        assert_int_equal(hit[i].primitive, which);
        if (which < 0)
            continue;
        hits++;
        inside += best.t == best.t_exit;
        assert_true(fabs((double)hit[i].t - best.t) < 2e-5 && fabs((double)hit[i].t_exit - best.t_exit) < 2e-5);
        v3 at = v3_add(ray[i].origin, v3_scale(ray[i].direction, (float)best.t));
        v3 n = v3_scale(v3_sub(at, ball[which].center), 1 / ball[which].radius);
        assert_true(v3_length(v3_sub(n, hit[i].normal)) < 1e-4f);
        assert_true(hit[i].u == 0 && hit[i].v == 0);
    }
    assert_true(clear > RAYS / 2 && hits > RAYS / 4 && inside > 20);
    free(hit);
    free(ray);
}

/* ---- building ---------------------------------------------------------------------------------------------------- */

static void check_refused(const amb_rays_geometry *g, uint32_t count, amb_status expected)
{
    amb_context *context = context_of(AMB_ISA_AUTO);
    amb_rays *rays = (amb_rays *)(void *)&rays;
    amb_error error = {AMB_OK, ""};
    assert_int_equal(amb_rays_create(context, g, count, &rays, &error), expected);
    assert_null(rays);
    assert_int_equal(error.status, expected);
    assert_true(strlen(error.detail) > 10 && strchr(error.detail, '\n') == NULL);
    amb_context_close(&context);
}

static void hostile_input_is_refused(void **state)
{
    (void)state;
    amb_mesh *m = soup(4, 1, 1);
    amb_rays_sphere large = {{0, 0, 0}, 1e30f};
    check_refused(&(amb_rays_geometry){0}, 1, AMB_ERROR_ARGUMENT);
    check_refused(&(amb_rays_geometry){.mesh = m, .spheres = &large, .sphere_count = 1}, 1, AMB_ERROR_ARGUMENT);
    check_refused(&(amb_rays_geometry){.spheres = &large, .sphere_count = 1}, 1, AMB_ERROR_LIMIT);
    check_refused(NULL, 3, AMB_ERROR_ARGUMENT);
    m->index[7] = 12;
    check_refused(&(amb_rays_geometry){.mesh = m}, 1, AMB_ERROR_FORMAT);
    m->index[7] = UINT32_MAX;
    check_refused(&(amb_rays_geometry){.mesh = m}, 1, AMB_ERROR_FORMAT);
    m->index[7] = 7;
    m->position[5].y = NAN;
    check_refused(&(amb_rays_geometry){.mesh = m}, 1, AMB_ERROR_FORMAT);
    m->position[5].y = -INFINITY;
    check_refused(&(amb_rays_geometry){.mesh = m}, 1, AMB_ERROR_FORMAT);
    m->position[5].y = -2e18f;
    check_refused(&(amb_rays_geometry){.mesh = m}, 1, AMB_ERROR_LIMIT);
    m->position[5].y = 0;
    amb_mesh no_index = *m;
    no_index.index = NULL;
    check_refused(&(amb_rays_geometry){.mesh = &no_index}, 1, AMB_ERROR_ARGUMENT);
    free_mesh(m);
}

static void empty_scenes_miss(void **state)
{
    (void)state;
    amb_mesh *m = new_mesh(3, 1); /* one triangle of one point */
    listed_ray ray[20];
    make_rays(ray, 20, 2, 1);
    amb_rays_geometry g[2] = {{.mesh = m}, {.mesh = m}};
    for (uint32_t count = 0; count < 3; count++) {
        listed_hit *hit = trace_everywhere(count ? g : NULL, count, ray, 20);
        for (int i = 0; i < 20; i++)
            assert_false(hit[i].hit || hit[i].occluded);
        free(hit);
    }
    amb_rays *none = NULL;
    amb_rays_close(&none);
    amb_rays_close(NULL);
    free_mesh(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_soups_hit_what_brute_force_hits),
        cmocka_unit_test(slivers_agree_with_the_scan_and_degenerate_triangles_are_never_hit),
        cmocka_unit_test(no_ray_slips_through_shared_edges),
        cmocka_unit_test(equal_distances_go_to_the_lower_geometry_and_primitive),
        cmocka_unit_test(limits_are_near_exclusive_and_far_inclusive),
        cmocka_unit_test(bad_rays_and_dead_lanes_miss_without_touching_their_neighbours),
        cmocka_unit_test(the_length_of_the_direction_only_scales_t),
        cmocka_unit_test(far_origins_keep_their_precision),
        cmocka_unit_test(spheres_agree_with_double_precision),
        cmocka_unit_test(hostile_input_is_refused),
        cmocka_unit_test(empty_scenes_miss),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
