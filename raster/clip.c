/* Clipping a triangle in homogeneous coordinates: Sutherland and Hodgman, "Reentrant polygon clipping", CACM 17(1),
 * 1974, in double precision. An edge is always cut from its inner towards its outer end, so two triangles that share
 * the edge get the same point. */
#include "raster/internal.h"

typedef struct plane {
    int axis;    /* of clip: 0 x, 1 y, 2 z */
    double sign; /* distance = sign · clip[axis] + scale · w */
    double scale;
} plane;

static double distance(const plane *p, const double clip[4]) { return p->sign * clip[p->axis] + p->scale * clip[3]; }

/* The point at t of the way from vertex `inner` to vertex `outer`. */
static raster_polygon_vertex cut(const raster_polygon *polygon, int inner, int outer, double t)
{
    const raster_polygon_vertex *a = &polygon->vertex[inner], *b = &polygon->vertex[outer];
    raster_polygon_vertex p = {.corner = -1};
    for (int k = 0; k < 4; k++)
        p.clip[k] = a->clip[k] + (b->clip[k] - a->clip[k]) * t;
    for (int k = 0; k < 2; k++)
        p.weight[k] = a->weight[k] + (b->weight[k] - a->weight[k]) * t;
    return p;
}

static void clip_plane(raster_polygon *polygon, const plane *p)
{
    raster_polygon in = *polygon;
    polygon->count = 0;
    for (int i = 0; i < in.count; i++) {
        int j = i + 1 == in.count ? 0 : i + 1;
        double di = distance(p, in.vertex[i].clip), dj = distance(p, in.vertex[j].clip);
        if (di >= 0.0 && polygon->count < RASTER_POLYGON)
            polygon->vertex[polygon->count++] = in.vertex[i];
        if ((di >= 0.0) == (dj >= 0.0) || polygon->count == RASTER_POLYGON)
            continue;
        int inner = di >= 0.0 ? i : j, outer = di >= 0.0 ? j : i;
        double d_in = di >= 0.0 ? di : dj, d_out = di >= 0.0 ? dj : di;
        polygon->vertex[polygon->count++] = cut(&in, inner, outer, d_in / (d_in - d_out));
    }
}

static void make_planes(double guard_x, double guard_y, plane planes[6])
{
    planes[0] = (plane){2, 1.0, 0.0}, planes[1] = (plane){2, -1.0, 1.0};         /* near: z ≥ 0; far: w - z ≥ 0 */
    planes[2] = (plane){0, 1.0, guard_x}, planes[3] = (plane){0, -1.0, guard_x}; /* left, right */
    planes[4] = (plane){1, 1.0, guard_y}, planes[5] = (plane){1, -1.0, guard_y}; /* bottom, top */
}

void raster_clip(raster_polygon *polygon, unsigned codes, double guard_x, double guard_y)
{
    plane planes[6];
    make_planes(guard_x, guard_y, planes);
    for (int i = 0; i < 6; i++)
        if (codes >> i & 1u)
            clip_plane(polygon, &planes[i]);
}

bool raster_clip_line(raster_polygon *line, unsigned codes, double guard_x, double guard_y)
{
    plane planes[6];
    make_planes(guard_x, guard_y, planes);
    for (int i = 0; i < 6; i++) {
        if (!(codes >> i & 1u))
            continue;
        double d0 = distance(&planes[i], line->vertex[0].clip), d1 = distance(&planes[i], line->vertex[1].clip);
        if (d0 < 0.0 && d1 < 0.0)
            return false;
        if (d0 < 0.0)
            line->vertex[0] = cut(line, 1, 0, d1 / (d1 - d0));
        else if (d1 < 0.0)
            line->vertex[1] = cut(line, 0, 1, d0 / (d0 - d1));
    }
    return true;
}
