/* Set-up of the triangles that the lanes of setup_wide.c leave alone: those to be clipped and those too large for
 * 32-bit areas. Same rules, one at a time. */
#include "raster/internal.h"

static int32_t min2(int32_t a, int32_t b) { return a < b ? a : b; }
static int32_t max2(int32_t a, int32_t b) { return a > b ? a : b; }
static int32_t min3(int32_t a, int32_t b, int32_t c) { return a < b ? (a < c ? a : c) : (b < c ? b : c); }
static int32_t max3(int32_t a, int32_t b, int32_t c) { return a > b ? (a > c ? a : c) : (b > c ? b : c); }

/* Culls and bounds the window triangle and appends what remains. The array has room. */
static void add_triangle(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, const uint32_t v[3],
                         uint32_t primitive)
{
    const amb_draw *draw = &chunk->draw->state;
    const raster_vertex *a = raster_vertex_at(chunk, v[0]), *b = raster_vertex_at(chunk, v[1]),
                        *c = raster_vertex_at(chunk, v[2]);
    int64_t area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
    bool front = (area > 0) == draw->front_clockwise; /* y points down: positive is clockwise on the screen */
    int32_t x0 = (min3(a->x, b->x, c->x) + pass->low_round) >> 8, x1 = (max3(a->x, b->x, c->x) - pass->high_round) >> 8;
    int32_t y0 = (min3(a->y, b->y, c->y) + pass->low_round) >> 8, y1 = (max3(a->y, b->y, c->y) - pass->high_round) >> 8;
    const raster_draw *limits = chunk->draw;
    x0 = max2(x0, limits->x0), x1 = min2(x1, limits->x1 - 1), y0 = max2(y0, limits->y0), y1 = min2(y1, limits->y1 - 1);
    if (area == 0 || x0 > x1 || y0 > y1 || (draw->cull == AMB_CULL_BACK && !front) ||
        (draw->cull == AMB_CULL_FRONT && front)) {
        scratch->stats.triangles_culled++;
        return;
    }
    const uint32_t turned[3] = {v[0], area > 0 ? v[1] : v[2], area > 0 ? v[2] : v[1]};
    chunk->triangle[chunk->triangle_count++] =
        raster_make_triangle(chunk, turned, primitive | (front ? 1u << 31 : 0u), x0, y0, x1, y1);
}

/* ---- the clipped ones ------------------------------------------------------------------------------------------- */

/* Window coordinates rounded half to even, as the vertex stage does; false when they are off the grid, which only
 * cancellation between huge and tiny clip coordinates can bring about. */
static bool snap(float ndc, float scale, float offset, int32_t *fixed)
{
    float window = ndc * scale + offset;
    if (!(window >= -RASTER_GRID_PIXELS && window <= RASTER_GRID_PIXELS))
        return false;
    *fixed = (int32_t)f_round(window * (float)RASTER_SUBPIXEL);
    return true;
}

bool raster_make_vertex(const amb_pass *pass, raster_chunk *chunk, const uint32_t corner[3], const double clip[4],
                        const double weight[2], uint32_t *number)
{
    float x = (float)clip[0], y = (float)clip[1], z = (float)clip[2], w = (float)clip[3];
    if (!(w >= FLT_MIN) || !f_is_finite(x) || !f_is_finite(y) || !f_is_finite(z) || !f_is_finite(w))
        return false;
    float half_w = 0.5f * (float)pass->width, half_h = 0.5f * (float)pass->height;
    int32_t fixed_x, fixed_y;
    if (!snap(x / w, half_w, half_w, &fixed_x) || !snap(y / w, -half_h, half_h, &fixed_y))
        return false;
    *number = chunk->vertex_count++;
    raster_vertex *v = raster_vertex_at(chunk, *number);
    v->z = z / w;
    v->inverse_w = 1.0f / w;
    v->x = fixed_x, v->y = fixed_y;
    const raster_vertex *a = raster_vertex_at(chunk, corner[0]), *b = raster_vertex_at(chunk, corner[1]),
                        *c = raster_vertex_at(chunk, corner[2]);
    for (int k = 0; k < chunk->draw->state.varying_floats; k++) {
        double base = (double)a->varying[k];
        v->varying[k] =
            (float)(base + ((double)b->varying[k] - base) * weight[0] + ((double)c->varying[k] - base) * weight[1]);
    }
    return true;
}

static bool clip_triangle(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, const uint32_t corner[4],
                          unsigned codes)
{
    raster_polygon polygon = {.count = 3};
    for (int i = 0; i < 3; i++) {
        uint32_t v = corner[i];
        polygon.vertex[i].clip[0] = (double)scratch->clip_x[v];
        polygon.vertex[i].clip[1] = (double)scratch->clip_y[v];
        polygon.vertex[i].clip[2] = (double)scratch->clip_z[v];
        polygon.vertex[i].clip[3] = (double)scratch->clip_w[v];
        polygon.vertex[i].weight[0] = i == 1, polygon.vertex[i].weight[1] = i == 2;
        polygon.vertex[i].corner = i;
    }
    raster_clip(&polygon, codes, (double)pass->guard_x, (double)pass->guard_y);
    scratch->stats.triangles_clipped++;
    if (!raster_reserve_vertices(chunk, scratch, (size_t)chunk->vertex_count + RASTER_POLYGON) ||
        !raster_reserve_triangles(chunk, scratch, (size_t)chunk->triangle_count + RASTER_POLYGON))
        return false;
    uint32_t number[RASTER_POLYGON];
    for (int i = 0; i < polygon.count; i++) {
        if (polygon.vertex[i].corner >= 0)
            number[i] = corner[polygon.vertex[i].corner];
        else if (!raster_make_vertex(pass, chunk, corner, polygon.vertex[i].clip, polygon.vertex[i].weight,
                                     &number[i])) {
            scratch->stats.triangles_culled++;
            return true;
        }
    }
    for (int i = 2; i < polygon.count; i++)
        add_triangle(pass, chunk, scratch, (uint32_t[3]){number[0], number[i - 1], number[i]}, corner[3]);
    return true;
}

void raster_setup_one(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t n)
{
    const uint32_t corner[4] = {scratch->corner[0][n], scratch->corner[1][n], scratch->corner[2][n],
                                scratch->corner[3][n]};
    unsigned c0 = (unsigned)scratch->code[corner[0]], c1 = (unsigned)scratch->code[corner[1]],
             c2 = (unsigned)scratch->code[corner[2]];
    unsigned any = c0 | c1 | c2;
    if ((any & RASTER_INVALID) != 0 || (c0 & c1 & c2) != 0)
        scratch->stats.triangles_culled++;
    else if (any != 0)
        scratch->failed |= !clip_triangle(pass, chunk, scratch, corner, any);
    else if (raster_reserve_triangles(chunk, scratch, (size_t)chunk->triangle_count + 1))
        add_triangle(pass, chunk, scratch, corner, corner[3]);
    else
        scratch->failed = true;
}
