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
        double t = d_in / (d_in - d_out);
        int n = polygon->count++;
        for (int k = 0; k < 4; k++) {
            double from = in.vertex[inner].clip[k], to = in.vertex[outer].clip[k];
            polygon->vertex[n].clip[k] = from + (to - from) * t;
        }
        for (int k = 0; k < 2; k++) {
            double from = in.vertex[inner].weight[k], to = in.vertex[outer].weight[k];
            polygon->vertex[n].weight[k] = from + (to - from) * t;
        }
        polygon->vertex[n].corner = -1;
    }
}

void raster_clip(raster_polygon *polygon, unsigned codes, double guard_x, double guard_y)
{
    const plane planes[6] = {
        {2, 1.0, 0.0},     {2, -1.0, 1.0},     /* near: z ≥ 0; far: w - z ≥ 0 */
        {0, 1.0, guard_x}, {0, -1.0, guard_x}, /* left, right */
        {1, 1.0, guard_y}, {1, -1.0, guard_y}, /* bottom, top */
    };
    for (int i = 0; i < 6; i++)
        if (codes >> i & 1u)
            clip_plane(polygon, &planes[i]);
}
