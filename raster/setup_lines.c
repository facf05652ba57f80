/* Set-up of lines, points and wireframe triangles, one at a time: drop, cull, clip and bound. They are kept like
 * triangles: a line as corners 0, 1, 1, a point as one corner three times. */
#include "raster/internal.h"

/* Appends a line or point with its box of pixels grown by `reach` (1/256 pixel). The arrays have room. */
static void add(raster_chunk *chunk, raster_scratch *scratch, uint32_t from, uint32_t to, uint32_t primitive_front,
                int32_t reach)
{
    const raster_draw *limits = chunk->draw;
    const raster_vertex *a = raster_vertex_at(chunk, from), *b = raster_vertex_at(chunk, to);
    int32_t ax = a->x, ay = a->y, bx = b->x, by = b->y;
    int32_t x0 = ((ax < bx ? ax : bx) - reach - 128) >> 8, x1 = ((ax < bx ? bx : ax) + reach + 128) >> 8;
    int32_t y0 = ((ay < by ? ay : by) - reach - 128) >> 8, y1 = ((ay < by ? by : ay) + reach + 128) >> 8;
    x0 = x0 > limits->x0 ? x0 : limits->x0, x1 = x1 < limits->x1 ? x1 : limits->x1 - 1;
    y0 = y0 > limits->y0 ? y0 : limits->y0, y1 = y1 < limits->y1 ? y1 : limits->y1 - 1;
    if (x0 > x1 || y0 > y1) {
        scratch->stats.triangles_culled++;
        return;
    }
    const uint32_t corner[3] = {from, to, to};
    chunk->triangle[chunk->triangle_count++] = raster_make_triangle(chunk, corner, primitive_front, x0, y0, x1, y1);
}

static raster_polygon_vertex corner_vertex(const raster_scratch *scratch, uint32_t v, int corner)
{
    raster_polygon_vertex p = {.corner = corner};
    p.clip[0] = (double)scratch->clip_x[v], p.clip[1] = (double)scratch->clip_y[v];
    p.clip[2] = (double)scratch->clip_z[v], p.clip[3] = (double)scratch->clip_w[v];
    p.weight[0] = corner == 1, p.weight[1] = corner == 2;
    return p;
}

static void setup_line(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t from, uint32_t to,
                       uint32_t primitive_front)
{
    unsigned code_from = (unsigned)scratch->code[from], code_to = (unsigned)scratch->code[to];
    uint32_t number[2] = {from, to};
    if (((code_from | code_to) & RASTER_INVALID) != 0 || (code_from & code_to) != 0) {
        scratch->stats.triangles_culled++;
        return;
    }
    if ((code_from | code_to) != 0) {
        raster_polygon line = {.count = 2};
        line.vertex[0] = corner_vertex(scratch, from, 0);
        line.vertex[1] = corner_vertex(scratch, to, 1);
        const uint32_t corner[3] = {from, to, to};
        bool left = raster_clip_line(&line, code_from | code_to, (double)pass->guard_x, (double)pass->guard_y);
        for (int i = 0; i < 2 && left; i++)
            if (line.vertex[i].corner < 0)
                left = raster_make_vertex(pass, chunk, corner, line.vertex[i].clip, line.vertex[i].weight, &number[i]);
        scratch->stats.triangles_clipped++;
        if (!left) {
            scratch->stats.triangles_culled++;
            return;
        }
    }
    add(chunk, scratch, number[0], number[1], primitive_front, 0);
}

/* Which face of a triangle is seen, clipped or not? The sign of det (x, y, w): Olano and Greer, "Triangle scan
 * conversion using 2D homogeneous coordinates", Graphics Hardware 1997. y points up here: positive is
 * counter-clockwise. 0: neither. */
static int facing(const raster_scratch *s, const uint32_t v[3])
{
    double x[3], y[3], w[3];
    for (int i = 0; i < 3; i++)
        x[i] = (double)s->clip_x[v[i]], y[i] = (double)s->clip_y[v[i]], w[i] = (double)s->clip_w[v[i]];
    double d =
        x[0] * (y[1] * w[2] - y[2] * w[1]) + x[1] * (y[2] * w[0] - y[0] * w[2]) + x[2] * (y[0] * w[1] - y[1] * w[0]);
    return d > 0.0 ? 1 : d < 0.0 ? -1 : 0;
}

static void setup_wireframe(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, const uint32_t v[3],
                            uint32_t primitive)
{
    const amb_draw *draw = &chunk->draw->state;
    int face = facing(scratch, v);
    bool front = (face < 0) == draw->front_clockwise;
    if (face == 0 || (draw->cull == AMB_CULL_BACK && !front) || (draw->cull == AMB_CULL_FRONT && front)) {
        scratch->stats.triangles_culled++;
        return;
    }
    for (int i = 0; i < 3; i++)
        setup_line(pass, chunk, scratch, v[i], v[(i + 1) % 3], primitive | (front ? 1u << 31 : 0u));
}

void raster_setup_lines(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const raster_draw *draw = chunk->draw;
    float size = draw->state.point_size > 0.0f ? draw->state.point_size : 1.0f;
    int32_t reach = (int32_t)(size * (0.5f * (float)RASTER_SUBPIXEL)) + 1;
    for (uint32_t n = 0; n < scratch->corner_count; n++) {
        const uint32_t v[3] = {scratch->corner[0][n], scratch->corner[1][n], scratch->corner[2][n]};
        uint32_t primitive = scratch->corner[3][n];
        if (!raster_reserve_vertices(chunk, scratch, (size_t)chunk->vertex_count + 6) ||
            !raster_reserve_triangles(chunk, scratch, (size_t)chunk->triangle_count + 3)) {
            scratch->failed = true;
            return;
        }
        if (draw->wireframe)
            setup_wireframe(pass, chunk, scratch, v, primitive);
        else if (draw->lines)
            setup_line(pass, chunk, scratch, v[0], v[1], primitive | 1u << 31);
        else if (scratch->code[v[0]] != 0)
            scratch->stats.triangles_culled++;
        else
            add(chunk, scratch, v[0], v[0], primitive | 1u << 31, reach);
    }
    scratch->stats.triangles_binned += chunk->triangle_count;
}
