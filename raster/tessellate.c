/* The tessellator: see tessellate.h. A pattern is made of concentric rings of points. The outermost ring has each
 * edge's own points; the inner ones those of the inside factors, one segment less at either end from ring to ring,
 * until a triangle, a strip of quads, a row or a point is left. */
#include "raster/tessellate.h"
#include "raster/factors.h"
#include "raster/internal.h"

#include <stdlib.h>

#define ONE ((uint32_t)RASTER_FACTOR_ONE)
#define HALF (ONE / 2)

static factors_x lanes_of(const raster_factors *f)
{
    factors_x x;
    memcpy(&x, f, sizeof x); /* one lane */
    return x;
}

raster_factors raster_clamp_factors(amb_patch_shape shape, amb_partitioning partitioning, const float edge[4],
                                    const float inside[2])
{
    const factors_x x = clamp_factors(shape, partitioning, edge, inside);
    raster_factors f;
    memcpy(&f, &x, sizeof f);
    return f;
}

raster_pattern_size raster_size_pattern(amb_patch_shape shape, amb_partitioning partitioning,
                                        const raster_factors *factors)
{
    const factors_x f = lanes_of(factors);
    raster_pattern_size size;
    size_factors(shape, partitioning, &f, &size.points, &size.triangles);
    return size;
}

/* ---- points on a line ------------------------------------------------------------------------------------------- */

/* How a factor places points on 0…1: between where the next lower and the next higher whole factor of its parity would
 * have them. In between one point of each half splits in two. */
typedef struct spacing {
    uint32_t segments;
    uint32_t half; /* points below the middle */
    uint32_t split, fraction;
    uint32_t inverse_low, inverse_high; /* 1 / segments at the two whole factors */
    bool odd;
} spacing;

static uint32_t reciprocal(uint32_t n) { return (ONE + n / 2) / n; }
static uint32_t without_top_bit(uint32_t n) { return n & ~(1u << (31 - __builtin_clz(n))); }

static spacing spacing_of(uint32_t factor, bool odd)
{
    uint32_t half = (factor + 1) / 2;
    if (odd || half == HALF) /* the other case: an inside factor of one, placed like two */
        half += HALF;
    const uint32_t low = half / ONE
    , high = (half + ONE - 1) / ONE;
    spacing s = {.segments = 2 * high - odd, .half = high, .fraction = half % ONE, .odd = odd };
    if (s.fraction == 0)
        s.split = high + 1; /* none */
    else if (odd)
        s.split = low == 1 ? 0 : 2 * without_top_bit(low - 1) + 1;
    else
        s.split = 2 * without_top_bit(low) + 1;
    s.inverse_low = reciprocal(2 * low - odd);
    s.inverse_high = reciprocal(s.segments);
    return s;
}

/* Where point n of 0…segments is. */
static uint32_t place(const spacing *s, uint32_t n)
{
    const uint32_t mirrored = s->segments - n;
    const bool flip = n >= s->half;
    if (flip)
        n = mirrored;
    if (n == s->half)
        return HALF;
    uint32_t low = (n > s->split ? n - 1 : n) * s->inverse_low, high = n * s->inverse_high;
    uint32_t position = (low * (ONE - s->fraction) + high * s->fraction + HALF) / ONE;
    if (position > HALF) /* a reciprocal was rounded up; the pattern would fold over */
        position = HALF;
    if (flip)
        position = ONE
    -position;
    return position;
}

/* The segments of a patch. */
typedef struct layout {
    amb_patch_shape shape;
    amb_partitioning partitioning;
    int sides;
    bool least; /* all factors are one: no inside at all */
    uint32_t edge[4], inside[2];
} layout;

static layout layout_of(amb_patch_shape shape, amb_partitioning partitioning, const raster_factors *factors)
{
    const factors_x f = lanes_of(factors);
    layout l = {shape, partitioning, factor_edges(shape), factors_are_one(shape, &f) != 0, {0}, {0}};
    for (int i = 0; i < l.sides; i++)
        l.edge[i] = (uint32_t)factor_segments(f.edge[i], partitioning, false);
    for (int i = 0; i < factor_insides(shape); i++)
        l.inside[i] = (uint32_t)factor_segments(f.inside[i], partitioning, true);
    return l;
}

/* ---- points ----------------------------------------------------------------------------------------------------- */

/* The spacings of an inside or an edge that has so many segments. */
static spacing spacing_in(const layout *l, int32_t factor, uint32_t segments)
{
    return spacing_of((uint32_t)factor,
                      l->partitioning == AMB_INTEGER ? (segments & 1u) != 0 : l->partitioning == AMB_FRACTIONAL_ODD);
}

static void add_point(raster_pattern *p, uint32_t u, uint32_t v)
{
    p->u[p->size.points] = (float)u * (1.0f / (float)ONE);
    p->v[p->size.points++] = (float)v * (1.0f / (float)ONE);
}

/* The outer ring goes round with positive turn: down the edge u = 0, along v = 0, then back. Each edge leaves its last
 * point to the next. */
static void outer_points(raster_pattern *p, const layout *l, const raster_factors *f)
{
    for (int side = 0; side < l->sides; side++) {
        const spacing s = spacing_in(l, f->edge[side], l->edge[side]);
        for (uint32_t n = 0; n < s.segments; n++) {
            uint32_t at = place(&s, n);
            if (side == 0)
                add_point(p, 0, ONE - at);
            else if (side == 1)
                add_point(p, at, 0);
            else if (l->shape == AMB_TRIANGLE)
                add_point(p, ONE - at, at);
            else if (side == 2)
                add_point(p, ONE, at);
            else
                add_point(p, ONE - at, ONE);
        }
    }
}

static void quad_ring_points(raster_pattern *p, const spacing inside[2], uint32_t ring)
{
    uint32_t u[65], v[65];
    const uint32_t columns = inside[0].segments - 2 * ring, rows = inside[1].segments - 2 * ring;
    for (uint32_t n = 0; n <= columns; n++)
        u[n] = place(&inside[0], ring + n);
    for (uint32_t n = 0; n <= rows; n++)
        v[n] = place(&inside[1], ring + n);
    if (columns == 0 || rows == 0) { /* a row of points, or one */
        for (uint32_t n = 0; n <= columns && columns > 0; n++)
            add_point(p, u[n], v[0]);
        for (uint32_t n = 0; n <= rows && columns == 0; n++)
            add_point(p, u[0], v[rows - n]);
        return;
    }
    for (uint32_t n = 0; n < rows; n++)
        add_point(p, u[0], v[rows - n]);
    for (uint32_t n = 0; n < columns; n++)
        add_point(p, u[n], v[0]);
    for (uint32_t n = 0; n < rows; n++)
        add_point(p, u[columns], v[n]);
    for (uint32_t n = 0; n < columns; n++)
        add_point(p, u[columns - n], v[rows]);
}

static void triangle_ring_points(raster_pattern *p, const spacing *s, uint32_t ring)
{
    const uint32_t side = s->segments - 2 * ring;
    if (side == 0) {
        add_point(p, ONE / 3, ONE / 3);
        return;
    }
    /* Seen from an edge, the ring's height is two thirds of the way along an edge: at ½ it is the centre, ⅓. */
    const uint32_t height = (place(s, ring) * (2 * ONE / 3) + HALF) / ONE
    , shift = (height + 1) / 2;
    for (uint32_t n = 0; n < side; n++)
        add_point(p, height, place(s, s->segments - ring - n) - shift);
    for (uint32_t n = 0; n < side; n++)
        add_point(p, place(s, ring + n) - shift, height);
    for (uint32_t n = 0; n < side; n++) {
        uint32_t u = place(s, s->segments - ring - n) - shift;
        add_point(p, u, ONE - u - height);
    }
}

static uint32_t last_ring(const layout *l)
{
    uint32_t columns = l->inside[0], rows = l->shape == AMB_QUAD ? l->inside[1] : columns;
    return (columns < rows ? columns : rows) / 2;
}

static void make_points(raster_pattern *p, const layout *l, const raster_factors *f)
{
    spacing inside[2];
    p->size.points = 0;
    outer_points(p, l, f);
    if (l->least)
        return;
    for (int i = 0; i < factor_insides(l->shape); i++)
        inside[i] = spacing_in(l, f->inside[i], l->inside[i]);
    for (uint32_t ring = 1; ring <= last_ring(l); ring++)
        if (l->shape == AMB_QUAD)
            quad_ring_points(p, inside, ring);
        else
            triangle_ring_points(p, inside, ring);
}

/* ---- triangles -------------------------------------------------------------------------------------------------- */

/* Points base, base + 1, … once round; a row of points is walked there and back. */
typedef struct ring {
    uint32_t base, total; /* steps round */
    uint32_t first[4], segments[4];
    bool row;
} ring;

static ring ring_of(const layout *l, uint32_t number, uint32_t base)
{
    ring r = {.base = base};
    for (int side = 0; side < l->sides; side++) {
        const uint32_t inner = l->inside[l->shape == AMB_QUAD ? ~side & 1 : 0] - 2 * number;
        r.first[side] = r.total;
        r.segments[side] = number == 0 ? l->edge[side] : inner;
        r.total += r.segments[side];
    }
    r.row = r.segments[0] == 0 || r.segments[1] == 0;
    return r;
}

static uint32_t ring_points(const ring *r) { return r->row ? r->total / 2 + 1 : r->total; }

static uint16_t at(const ring *r, uint32_t step)
{
    if (r->row)
        return (uint16_t)(r->base + (step > r->total / 2 ? r->total - step : step));
    return (uint16_t)(r->base + (step == r->total ? 0 : step));
}

static void add_triangle(raster_pattern *p, uint16_t a, uint16_t b, uint16_t c)
{
    uint16_t *corner = p->corner + (size_t)3 * (size_t)p->size.triangles++;
    corner[0] = a, corner[1] = b, corner[2] = c;
}

/* As a factor grows, points of a half edge appear in the order of a ruler's marks: when does the one come that ends up
 * at place n of 0…32? */
static uint32_t appearance(uint32_t n) { return n == 0 ? 0 : n == 1 ? 32 : (n - 1 + 32) >> (__builtin_ctz(n - 1) + 1); }

/* Two rows of points facing each other, zipped by the order in which points appear: so triangles do not leap about when
 * factors change. */
typedef struct zip {
    raster_pattern *pattern;
    const ring *outer, *inner;
    uint32_t o, i;
} zip;

static void step_outer(zip *z)
{
    add_triangle(z->pattern, at(z->outer, z->o), at(z->outer, z->o + 1), at(z->inner, z->i));
    z->o++;
}

static void step_inner(zip *z)
{
    add_triangle(z->pattern, at(z->inner, z->i), at(z->outer, z->o), at(z->inner, z->i + 1));
    z->i++;
}

static void stitch(raster_pattern *pattern, const ring *outer, const ring *inner, int side)
{
    const uint32_t outer_segments = outer->segments[side], inner_segments = inner->segments[side];
    zip z = {pattern, outer, inner, outer->first[side], inner->first[side]};
    for (uint32_t n = 0; n <= 32; n++) {
        if (n > 0 && appearance(n) <= inner_segments / 2)
            step_inner(&z);
        if (appearance(n) < outer_segments / 2)
            step_outer(&z);
    }
    if (inner_segments & 1u)
        step_inner(&z);
    if (outer_segments & 1u)
        step_outer(&z);
    for (uint32_t n = 33; n-- > 0;) {
        if (appearance(n) < outer_segments / 2)
            step_outer(&z);
        if (n > 0 && appearance(n) <= inner_segments / 2)
            step_inner(&z);
    }
}

/* The strip of quads inside the last ring of a quad domain, where the smaller inside factor is odd. */
static void fill_strip(raster_pattern *p, const ring *r)
{
    const bool along_u = r->segments[1] > r->segments[0];
    const uint32_t quads = r->segments[along_u ? 1 : 0], near = along_u ? 1 : 0,
                   far = along_u ? r->total : r->total - 1;
    const uint32_t turned = !along_u && (quads & 1u) ? quads / 2 : quads; /* this one's diagonal runs the other way */
    for (uint32_t n = 0; n < quads; n++) {
        uint16_t a = at(r, near + n), b = at(r, near + n + 1), c = at(r, far - n - 1), d = at(r, far - n);
        if (n == turned)
            add_triangle(p, a, c, d);
        add_triangle(p, a, b, n == turned ? c : d);
        if (n != turned)
            add_triangle(p, b, c, d);
    }
}

static void make_triangles(raster_pattern *p, const layout *l)
{
    p->size.triangles = 0;
    if (l->least) { /* corners in ring order */
        if (l->shape == AMB_QUAD) {
            add_triangle(p, 1, 2, 0);
            add_triangle(p, 2, 3, 0);
        } else {
            add_triangle(p, 0, 1, 2);
        }
        return;
    }
    ring outer = ring_of(l, 0, 0);
    for (uint32_t number = 1; number <= last_ring(l); number++) {
        ring inner = ring_of(l, number, outer.base + ring_points(&outer));
        for (int side = 0; side < l->sides; side++)
            stitch(p, &outer, &inner, side);
        outer = inner;
    }
    if (outer.row)
        return;
    if (l->shape == AMB_QUAD)
        fill_strip(p, &outer);
    else
        add_triangle(p, at(&outer, 0), at(&outer, 1), at(&outer, 2));
}

/* ---- patterns --------------------------------------------------------------------------------------------------- */

static uint64_t pack_segments(const layout *l)
{
    uint64_t key = (uint64_t)l->shape << 4 | (uint64_t)l->partitioning << 2 | (uint64_t)l->least << 1 | 1u;
    for (int i = 0; i < l->sides; i++)
        key = key << 7 | l->edge[i];
    for (int i = 0; i < factor_insides(l->shape); i++)
        key = key << 7 | l->inside[i];
    return key;
}

static bool make_pattern(raster_pattern *p, const layout *l, uint64_t segments, const raster_factors *factors)
{
    if (p->segments != segments) {
        const raster_pattern_size size = raster_size_pattern(l->shape, l->partitioning, factors);
        p->segments = 0;
        if (!raster_grow(&p->u, &p->u_capacity, (size_t)size.points, sizeof *p->u) ||
            !raster_grow(&p->v, &p->v_capacity, (size_t)size.points, sizeof *p->v) ||
            !raster_grow(&p->corner, &p->corner_capacity, (size_t)3 * (size_t)size.triangles, sizeof *p->corner))
            return false;
        make_triangles(p, l);
        p->segments = segments;
        p->factors.edge[0] = 0;
    }
    if (memcmp(&p->factors, factors, sizeof *factors) != 0)
        make_points(p, l, factors);
    p->factors = *factors;
    return true;
}

bool raster_make_pattern(raster_pattern *pattern, amb_patch_shape shape, amb_partitioning partitioning,
                         const raster_factors *factors)
{
    const layout l = layout_of(shape, partitioning, factors);
    return make_pattern(pattern, &l, pack_segments(&l), factors);
}

void raster_free_pattern(raster_pattern *pattern)
{
    free(pattern->u);
    free(pattern->v);
    free(pattern->corner);
    *pattern = (raster_pattern){0};
}

const raster_pattern *raster_find_pattern(raster_pattern_cache *cache, amb_patch_shape shape,
                                          amb_partitioning partitioning, const raster_factors *factors)
{
    if (cache->last && cache->shape == shape && cache->partitioning == partitioning &&
        memcmp(&cache->last->factors, factors, sizeof *factors) == 0)
        return cache->last;
    const layout l = layout_of(shape, partitioning, factors);
    const uint64_t segments = pack_segments(&l);
    raster_pattern *p = &cache->slot[(segments * 0x9e3779b97f4a7c15u) >> 59];
    if (!make_pattern(p, &l, segments, factors))
        return NULL;
    cache->last = p;
    cache->shape = shape;
    cache->partitioning = partitioning;
    return p;
}
