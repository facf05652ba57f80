/* The fill rules, written as plainly as they can be: every pixel against every edge, in 64-bit integers. */
#include "tests/truth_raster.h"

#include <math.h>
#include <string.h>

/* Distances to near, far, left, right, bottom and top; the guard band is 2^k times the window, at most 2^18 pixels
 * from its centre. */
static double plane_distance(int plane, const double c[4], int width, int height)
{
    double half = plane < 4 ? width / 2.0 : height / 2.0;
    double guard = exp2(floor(log2(262144.0 / half)));
    switch (plane) {
    case 0:
        return c[2];
    case 1:
        return c[3] - c[2];
    case 2:
        return guard * c[3] + c[0];
    case 3:
        return guard * c[3] - c[0];
    case 4:
        return guard * c[3] + c[1];
    default:
        return guard * c[3] - c[1];
    }
}

static int clip_polygon(double in[][4], int count, double out[][4], int plane, int width, int height)
{
    int made = 0;
    for (int i = 0; i < count; i++) {
        double *a = in[i], *b = in[(i + 1) % count];
        double da = plane_distance(plane, a, width, height), db = plane_distance(plane, b, width, height);
        if (!(da < 0))
            memcpy(out[made++], a, sizeof(double[4]));
        if ((da < 0) != (db < 0)) {
            double *p = da < 0 ? b : a, *q = da < 0 ? a : b; /* from the inner end */
            double dp = da < 0 ? db : da, dq = da < 0 ? da : db;
            for (int k = 0; k < 4; k++)
                out[made][k] = p[k] + (q[k] - p[k]) * (dp / (dp - dq));
            made++;
        }
    }
    return made;
}

static int64_t to_grid(float ndc, float scale, float offset)
{
    float scaled = ndc * scale;
    float window = scaled + offset;
    return (int64_t)rint((double)window * 256.0); /* ties to even */
}

int truth_clip(const float clip[3][4], int width, int height, truth_triangle out[7])
{
    double polygon[2][16][4];
    int count = 3;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) {
            if (!isfinite(clip[i][k]))
                return 0;
            polygon[0][i][k] = (double)clip[i][k];
        }
    for (int plane = 0; plane < 6; plane++)
        count = clip_polygon(polygon[plane % 2], count, polygon[(plane + 1) % 2], plane, width, height);
    int64_t x[16], y[16];
    for (int i = 0; i < count; i++) {
        float c[4];
        for (int k = 0; k < 4; k++)
            c[k] = (float)polygon[0][i][k];
        if (!(c[3] >= 0x1p-126f))
            return 0;
        x[i] = to_grid(c[0] / c[3], 0.5f * (float)width, 0.5f * (float)width);
        y[i] = to_grid(c[1] / c[3], -0.5f * (float)height, 0.5f * (float)height);
    }
    for (int i = 0; i + 2 < count; i++) {
        int corner[3] = {0, i + 1, i + 2};
        for (int k = 0; k < 3; k++) {
            out[i].x[k] = x[corner[k]], out[i].y[k] = y[corner[k]];
            memcpy(out[i].clip[k], polygon[0][corner[k]], sizeof(double[4]));
        }
    }
    return count > 2 ? count - 2 : 0;
}

int64_t truth_area(const truth_triangle *t)
{
    return (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
}

int truth_covers(const truth_triangle *t, int x, int y)
{
    int64_t px = 256 * (int64_t)x + 128, py = 256 * (int64_t)y + 128;
    int64_t turn = truth_area(t) > 0 ? 1 : -1;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t cross = (t->x[k] - t->x[j]) * (py - t->y[j]) - (t->y[k] - t->y[j]) * (px - t->x[j]);
        if (cross * turn < 0)
            return 0;
        if (cross == 0) {
            /* On the edge: owned when the triangle lies to the right of it, or below it if it is level. */
            int level = t->y[j] == t->y[k];
            int right = (t->y[j] != t->y[k]) && ((t->x[i] - t->x[j]) * (t->y[k] - t->y[j]) >
                                                 (t->x[k] - t->x[j]) * (t->y[i] - t->y[j])) == (t->y[k] > t->y[j]);
            int below = level && t->y[i] > t->y[j];
            if (!right && !below)
                return 0;
        }
    }
    return 1;
}

static int64_t clamp(int64_t a, int64_t lo, int64_t hi) { return a < lo ? lo : a > hi ? hi : a; }

void truth_draw(const float clip[3][4], int width, int height, void (*pixel)(void *user, int x, int y), void *user)
{
    truth_triangle t[7];
    int count = truth_clip(clip, width, height, t);
    for (int i = 0; i < count; i++) {
        if (truth_area(&t[i]) == 0)
            continue;
        int64_t x0 = t[i].x[0], x1 = x0, y0 = t[i].y[0], y1 = y0;
        for (int k = 1; k < 3; k++) {
            x0 = t[i].x[k] < x0 ? t[i].x[k] : x0, x1 = t[i].x[k] > x1 ? t[i].x[k] : x1;
            y0 = t[i].y[k] < y0 ? t[i].y[k] : y0, y1 = t[i].y[k] > y1 ? t[i].y[k] : y1;
        }
        int first_x = (int)clamp(x0 / 256 - 1, 0, width), last_x = (int)clamp(x1 / 256 + 1, -1, width - 1);
        int first_y = (int)clamp(y0 / 256 - 1, 0, height), last_y = (int)clamp(y1 / 256 + 1, -1, height - 1);
        for (int y = first_y; y <= last_y; y++)
            for (int x = first_x; x <= last_x; x++)
                if (truth_covers(&t[i], x, y))
                    pixel(user, x, y);
    }
}
