/* The fill rules, written as plainly as they can be: every row or pixel against every edge, in 64-bit integers. */
#include "tests/truth_raster.h"

#include <math.h>
#include <string.h>

/* The guard band is 2^k times the window, at most 2^18 pixels from its centre. */
static double guard_band(int size) { return exp2(floor(log2(262144.0 / (size / 2.0)))); }

/* Distances to near, far, left, right, bottom and top. guard: of the width and the height. */
static double plane_distance(int plane, const double c[4], const double guards[2])
{
    double guard = guards[plane >= 4];
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

/* A vertex: clip x, y, z, w and the weights of the triangle's corners. */
#define PARTS 7

static int clip_polygon(double in[][PARTS], int count, double out[][PARTS], int plane, const double guard[2])
{
    int made = 0;
    for (int i = 0; i < count; i++) {
        double *a = in[i], *b = in[(i + 1) % count];
        double da = plane_distance(plane, a, guard), db = plane_distance(plane, b, guard);
        if (!(da < 0))
            memcpy(out[made++], a, sizeof out[0]);
        if ((da < 0) != (db < 0)) {
            double *p = da < 0 ? b : a, *q = da < 0 ? a : b; /* from the inner end */
            double dp = da < 0 ? db : da, dq = da < 0 ? da : db;
            for (int k = 0; k < PARTS; k++)
                out[made][k] = p[k] + (q[k] - p[k]) * (dp / (dp - dq));
            made++;
        }
    }
    return made;
}

#define NOWHERE INT64_MIN

static int64_t to_grid(float ndc, float scale, float offset)
{
    float scaled = ndc * scale;
    float window = scaled + offset;
    if (!(fabs((double)window) <= 524288.0))
        return NOWHERE;
    return (int64_t)rint((double)window * 256.0); /* ties to even */
}

int truth_clip(const float clip[3][4], int width, int height, int clip_depth, truth_triangle out[7])
{
    const double guard[2] = {guard_band(width), guard_band(height)};
    double polygon[2][16][PARTS];
    int count = 3;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < PARTS; k++) {
            if (k < 4 && !isfinite(clip[i][k]))
                return 0;
            polygon[0][i][k] = k < 4 ? (double)clip[i][k] : k == 4 + i;
        }
    for (int plane = clip_depth ? 0 : 2; plane < 6; plane++)
        count = clip_polygon(polygon[plane % 2], count, polygon[(plane + 1) % 2], plane, guard);
    int64_t x[16], y[16];
    for (int i = 0; i < count; i++) {
        float c[4];
        for (int k = 0; k < 4; k++)
            c[k] = (float)polygon[0][i][k];
        if (!(c[3] >= 0x1p-126f))
            return 0;
        x[i] = to_grid(c[0] / c[3], 0.5f * (float)width, 0.5f * (float)width);
        y[i] = to_grid(c[1] / c[3], -0.5f * (float)height, 0.5f * (float)height);
        if (x[i] == NOWHERE || y[i] == NOWHERE)
            return 0;
    }
    for (int i = 0; i + 2 < count; i++) {
        int corner[3] = {0, i + 1, i + 2};
        for (int k = 0; k < 3; k++) {
            out[i].x[k] = x[corner[k]], out[i].y[k] = y[corner[k]];
            memcpy(out[i].clip[k], polygon[0][corner[k]], sizeof out[i].clip[k]);
            memcpy(out[i].weight[k], polygon[0][corner[k]] + 4, sizeof out[i].weight[k]);
        }
    }
    return count > 2 ? count - 2 : 0;
}

int64_t truth_area(const truth_triangle *t)
{
    return (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
}

/* The weights of the corners at a sample, linear in the window. */
static void window_weights(const truth_triangle *t, int x, int y, int dx, int dy, double weight[3])
{
    int64_t px = 256 * (int64_t)x + 128 + 16 * dx, py = 256 * (int64_t)y + 128 + 16 * dy;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t cross = (t->x[k] - t->x[j]) * (py - t->y[j]) - (t->y[k] - t->y[j]) * (px - t->x[j]);
        weight[i] = (double)cross / (double)truth_area(t);
    }
}

double truth_value(const truth_triangle *t, const double corner[3], int x, int y, int dx, int dy, double *condition)
{
    double weight[3], sum = 0, size = 0, top = 0;
    window_weights(t, x, y, dx, dy, weight);
    for (int i = 0; i < 3; i++) {
        double p = weight[i] / t->clip[i][3];
        sum += p, size += fabs(p);
        top += p * corner[i];
    }
    if (condition)
        *condition = size / fabs(sum);
    return top / sum;
}

double truth_depth(const truth_triangle *t, int x, int y, int dx, int dy)
{
    double weight[3], depth = 0;
    window_weights(t, x, y, dx, dy, weight);
    for (int i = 0; i < 3; i++)
        depth += weight[i] * t->clip[i][2] / t->clip[i][3];
    return depth;
}

/* Do samples on edge i, from corner i + 1 to i + 2, belong to the triangle? When it lies to the right of the edge, or
 * below it if the edge is level. */
static int owns_edge(const truth_triangle *t, int i)
{
    int j = (i + 1) % 3, k = (i + 2) % 3;
    if (t->y[j] == t->y[k])
        return t->y[i] > t->y[j];
    return ((t->x[i] - t->x[j]) * (t->y[k] - t->y[j]) > (t->x[k] - t->x[j]) * (t->y[i] - t->y[j])) ==
           (t->y[k] > t->y[j]);
}

int truth_covers(const truth_triangle *t, int x, int y) { return truth_covers_sample(t, x, y, 0, 0); }

int truth_covers_sample(const truth_triangle *t, int x, int y, int dx, int dy)
{
    int64_t px = 256 * (int64_t)x + 128 + 16 * dx, py = 256 * (int64_t)y + 128 + 16 * dy;
    int64_t turn = truth_area(t) > 0 ? 1 : -1;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t cross = (t->x[k] - t->x[j]) * (py - t->y[j]) - (t->y[k] - t->y[j]) * (px - t->x[j]);
        if (cross * turn < 0 || (cross == 0 && !owns_edge(t, i)))
            return 0;
    }
    return 1;
}

static int64_t clamp(int64_t a, int64_t lo, int64_t hi) { return a < lo ? lo : a > hi ? hi : a; }

static int64_t floor_divide(int64_t a, int64_t b) /* b > 0 */ { return a >= 0 ? a / b : -((b - 1 - a) / b); }

/* Narrows first…last to the pixels of a row whose sample is inside edge i: slope · x + offset ≥ least, solved for x. */
static void narrow_row(const truth_triangle *t, int i, int y, int dx, int dy, int64_t *first, int64_t *last)
{
    int j = (i + 1) % 3, k = (i + 2) % 3;
    int64_t turn = truth_area(t) > 0 ? 1 : -1, py = 256 * (int64_t)y + 128 + 16 * dy;
    int64_t slope = -turn * (t->y[k] - t->y[j]) * 256;
    int64_t offset = turn * ((t->x[k] - t->x[j]) * (py - t->y[j]) - (t->y[k] - t->y[j]) * (128 + 16 * dx - t->x[j]));
    int64_t least = owns_edge(t, i) ? 0 : 1;
    if (slope > 0) {
        int64_t x = -floor_divide(offset - least, slope);
        *first = x > *first ? x : *first;
    } else if (slope < 0) {
        int64_t x = floor_divide(offset - least, -slope);
        *last = x < *last ? x : *last;
    } else if (offset < least) {
        *last = *first - 1;
    }
}

void truth_fill_sample(const truth_triangle *t, int width, int height, int dx, int dy,
                       void (*pixel)(void *user, int x, int y), void *user)
{
    if (truth_area(t) == 0)
        return;
    int64_t y0 = t->y[0], y1 = y0;
    for (int k = 1; k < 3; k++)
        y0 = t->y[k] < y0 ? t->y[k] : y0, y1 = t->y[k] > y1 ? t->y[k] : y1;
    int top = (int)clamp(y0 / 256 - 2, 0, height), bottom = (int)clamp(y1 / 256 + 2, -1, height - 1);
    for (int y = top; y <= bottom; y++) {
        int64_t first = 0, last = width - 1;
        for (int i = 0; i < 3; i++)
            narrow_row(t, i, y, dx, dy, &first, &last);
        for (int64_t x = first; x <= last; x++)
            pixel(user, (int)x, y);
    }
}

void truth_fill(const truth_triangle *t, int width, int height, void (*pixel)(void *user, int x, int y), void *user)
{
    truth_fill_sample(t, width, height, 0, 0, pixel, user);
}

void truth_draw(const float clip[3][4], int width, int height, void (*pixel)(void *user, int x, int y), void *user)
{
    truth_triangle t[7];
    int count = truth_clip(clip, width, height, 1, t);
    for (int i = 0; i < count; i++)
        truth_fill(&t[i], width, height, pixel, user);
}

/* ---- lines and points ------------------------------------------------------------------------------------------- */

/* Is the point (x, y) / by, relative to a pixel's centre, in its diamond? */
static int in_diamond(__int128 x, __int128 y, __int128 by, int steep)
{
    __int128 half = 128 * by;
    if (steep && y == 0 && x == half)
        return 1;
    return x + y <= half && y - x <= half && x - y < half && -x - y < half;
}

/* Does the way from a to b (relative to the centre) lead out of the diamond? The part inside is convex, so it is found
 * at an end, at a crossing of a boundary line, or between two neighbouring ones of those. */
static int leaves_diamond(int64_t ax, int64_t ay, int64_t bx, int64_t by)
{
    int64_t dx = bx - ax, dy = by - ay;
    int steep = (dy < 0 ? -dy : dy) > (dx < 0 ? -dx : dx);
    if (in_diamond(bx, by, 1, steep))
        return 0;
    const int signs[4][2] = {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
    int64_t top[6] = {0, 1}, bottom[6] = {1, 1};
    int count = 2;
    for (int i = 0; i < 4; i++) {
        int64_t change = signs[i][0] * dx + signs[i][1] * dy, start = signs[i][0] * ax + signs[i][1] * ay;
        int64_t need = 128 - start;
        if (change < 0)
            change = -change, need = -need;
        if (change != 0 && need > 0 && need < change)
            top[count] = need, bottom[count++] = change;
    }
    for (int i = 0; i < count; i++)
        for (int k = i; k < count; k++) { /* the middle of any two; i = k: the crossing itself */
            __int128 t = (__int128)top[i] * bottom[k] + (__int128)top[k] * bottom[i];
            __int128 whole = (__int128)2 * bottom[i] * bottom[k];
            if (in_diamond(ax * whole + dx * t, ay * whole + dy * t, whole, steep))
                return 1;
        }
    return 0;
}

void truth_draw_line(const float from[4], const float to[4], int width, int height, int clip_depth,
                     void (*pixel)(void *user, int x, int y), void *user)
{
    const double guard[2] = {guard_band(width), guard_band(height)};
    double end[2][4];
    for (int k = 0; k < 4; k++) {
        if (!isfinite(from[k]) || !isfinite(to[k]))
            return;
        end[0][k] = (double)from[k], end[1][k] = (double)to[k];
    }
    for (int plane = clip_depth ? 0 : 2; plane < 6; plane++) {
        double d[2] = {plane_distance(plane, end[0], guard), plane_distance(plane, end[1], guard)};
        if (d[0] < 0 && d[1] < 0)
            return;
        for (int i = 0; i < 2; i++)
            if (d[i] < 0)
                for (int k = 0; k < 4; k++)
                    end[i][k] = end[1 - i][k] + (end[i][k] - end[1 - i][k]) * (d[1 - i] / (d[1 - i] - d[i]));
    }
    int64_t x[2], y[2];
    for (int i = 0; i < 2; i++) {
        float c[4];
        for (int k = 0; k < 4; k++)
            c[k] = (float)end[i][k];
        if (!(c[3] >= 0x1p-126f))
            return;
        x[i] = to_grid(c[0] / c[3], 0.5f * (float)width, 0.5f * (float)width);
        y[i] = to_grid(c[1] / c[3], -0.5f * (float)height, 0.5f * (float)height);
        if (x[i] == NOWHERE || y[i] == NOWHERE)
            return;
    }
    for (int py = 0; py < height; py++)
        for (int px = 0; px < width; px++) {
            int64_t cx = 256 * (int64_t)px + 128, cy = 256 * (int64_t)py + 128;
            if (leaves_diamond(x[0] - cx, y[0] - cy, x[1] - cx, y[1] - cy))
                pixel(user, px, py);
        }
}

void truth_draw_point(const float clip[4], float size, int width, int height, int clip_depth,
                      void (*pixel)(void *user, int x, int y), void *user)
{
    const double guard[2] = {guard_band(width), guard_band(height)};
    double c[4];
    for (int k = 0; k < 4; k++) {
        if (!isfinite(clip[k]))
            return;
        c[k] = (double)clip[k];
    }
    for (int plane = clip_depth ? 0 : 2; plane < 6; plane++)
        if (plane_distance(plane, c, guard) < 0)
            return;
    if (!(clip[3] >= 0x1p-126f))
        return;
    int64_t x = to_grid(clip[0] / clip[3], 0.5f * (float)width, 0.5f * (float)width);
    int64_t y = to_grid(clip[1] / clip[3], -0.5f * (float)height, 0.5f * (float)height);
    int64_t half = (int64_t)rint((double)size * 128.0);
    for (int py = 0; py < height; py++)
        for (int px = 0; px < width; px++) {
            int64_t cx = 256 * (int64_t)px + 128, cy = 256 * (int64_t)py + 128;
            if (cx >= x - half && cx < x + half && cy >= y - half && cy < y + half)
                pixel(user, px, py);
        }
}
