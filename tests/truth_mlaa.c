#include "truth_mlaa.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static void *zeroed(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (!memory)
        abort();
    return memory;
}

truth_mlaa truth_mlaa_new(int width, int height)
{
    size_t n = (size_t)width * (size_t)height;
    truth_mlaa m = {.width = width, .height = height, .corners = 1.0};
    m.right = zeroed(n, 1);
    m.down = zeroed(n, 1);
    m.right_margin = zeroed(n, sizeof(double));
    m.down_margin = zeroed(n, sizeof(double));
    for (int d = 0; d < 4; d++) {
        m.distance[d] = zeroed(n, sizeof(int));
        m.weight[d] = zeroed(n, sizeof(double));
    }
    return m;
}

void truth_mlaa_free(truth_mlaa *m)
{
    free(m->right);
    free(m->down);
    free(m->right_margin);
    free(m->down_margin);
    for (int d = 0; d < 4; d++) {
        free(m->distance[d]);
        free(m->weight[d]);
    }
    memset(m, 0, sizeof *m);
}

/* ---- detection --------------------------------------------------------------------------------------------------- */

static double lab_f(double t) { return t > 216.0 / 24389.0 ? cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; }

static void lab_of(const double rgb[3], double lab[3])
{
    double c[3];
    for (int i = 0; i < 3; i++)
        c[i] = !(rgb[i] > 0.0) ? 0.0 : rgb[i] > 1.0 ? 1.0 : rgb[i];
    double x = (0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.95047;
    double y = 0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2];
    double z = (0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.08883;
    lab[0] = 116.0 * lab_f(y) - 16.0;
    lab[1] = 500.0 * (lab_f(x) - lab_f(y));
    lab[2] = 200.0 * (lab_f(y) - lab_f(z));
}

double truth_lab_distance(const double a[3], const double b[3])
{
    double p[3], q[3];
    lab_of(a, p);
    lab_of(b, q);
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

truth_mlaa truth_mlaa_detect(const truth_image *image, double gain, double threshold)
{
    truth_mlaa m = truth_mlaa_new(image->width, image->height);
    for (int y = 0; y < m.height; y++)
        for (int x = 0; x < m.width; x++) {
            size_t i = (size_t)y * (size_t)m.width + (size_t)x;
            double here[3], there[3];
            for (int c = 0; c < 3; c++)
                here[c] = gain * truth_at(image, x, y)[c];
            m.right_margin[i] = m.down_margin[i] = HUGE_VAL;
            if (x + 1 < m.width) {
                for (int c = 0; c < 3; c++)
                    there[c] = gain * truth_at(image, x + 1, y)[c];
                double d = truth_lab_distance(here, there);
                m.right[i] = d > threshold;
                m.right_margin[i] = fabs(d - threshold);
            }
            if (y + 1 < m.height) {
                for (int c = 0; c < 3; c++)
                    there[c] = gain * truth_at(image, x, y + 1)[c];
                double d = truth_lab_distance(here, there);
                m.down[i] = d > threshold;
                m.down_margin[i] = fabs(d - threshold);
            }
        }
    return m;
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

static int sample(const truth_mlaa *m, const int *table, int x, int y)
{
    return x < 0 || y < 0 || x >= m->width || y >= m->height ? 0 : table[y * m->width + x];
}

/* After pass k a distance counts as far as 4^k: a pixel whose own count fills that reach goes on where it ends. */
void truth_mlaa_propagate(truth_mlaa *m)
{
    static const int step[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    size_t n = (size_t)m->width * (size_t)m->height;
    int *next = zeroed(n, sizeof(int));
    for (int d = 0; d < 4; d++) {
        for (size_t i = 0; i < n; i++)
            m->distance[d][i] = d < 2 ? m->down[i] : m->right[i];
        for (int reach = 1; reach < 256; reach *= 4) {
            for (int y = 0; y < m->height; y++)
                for (int x = 0; x < m->width; x++) {
                    int total = 0;
                    for (int s = 0; s < 4 && total == s * reach; s++)
                        total += sample(m, m->distance[d], x + step[d][0] * total, y + step[d][1] * total);
                    next[y * m->width + x] = total;
                }
            memcpy(m->distance[d], next, n * sizeof(int));
        }
    }
    free(next);
}

/* ---- weights ----------------------------------------------------------------------------------------------------- */

static int edge(const truth_mlaa *m, const unsigned char *table, int x, int y)
{
    return x < 0 || y < 0 || x >= m->width || y >= m->height ? 0 : table[y * m->width + x];
}

int truth_mlaa_crossed(const truth_mlaa *m, int vertical, int x, int y, int end, int steps)
{
    int at = end ? steps : -steps - 1;
    if (vertical)
        return edge(m, m->down, x, y + at) | edge(m, m->down, x + 1, y + at) << 1;
    return edge(m, m->right, x + at, y) | edge(m, m->right, x + at, y + 1) << 1;
}

/* Gives `area` to the pixel on one side of the discontinuity at (x, y). */
static void give(truth_mlaa *m, int vertical, int second_side, int x, int y, double area)
{
    int direction = vertical ? (second_side ? 2 : 3) : (second_side ? 0 : 1);
    if (second_side) {
        x += vertical;
        y += !vertical;
    }
    m->weight[direction][y * m->width + x] = area;
}

/* Is the line that crosses on side 1 or 2, `at` steps from (x, y), there one pixel further from this line too? */
static int goes_on(const truth_mlaa *m, int vertical, int x, int y, int at, int side)
{
    int further = side == 1 ? -1 : 2;
    return vertical ? edge(m, m->down, x + further, y + at) : edge(m, m->right, x + at, y + further);
}

void truth_mlaa_weigh(truth_mlaa *m)
{
    for (int vertical = 0; vertical < 2; vertical++)
        for (int y = 0; y < m->height; y++)
            for (int x = 0; x < m->width; x++) {
                int back = m->distance[vertical ? TRUTH_UP : TRUTH_LEFT][y * m->width + x] - 1;
                int ahead = m->distance[vertical ? TRUTH_DOWN : TRUTH_RIGHT][y * m->width + x] - 1;
                if (back < 0 || back == ahead)
                    continue;
                int crossed = truth_mlaa_crossed(m, vertical, x, y, ahead < back, back < ahead ? back : ahead);
                double length = back + ahead + 1, p = back < ahead ? back : ahead;
                double share = goes_on(m, vertical, x, y, back < ahead ? -back - 1 : ahead, crossed) ? m->corners : 1.0;
                if (crossed == 1 || crossed == 2)
                    give(m, vertical, crossed == 2, x, y, share * 0.5 * (1.0 - (2.0 * p + 1.0) / length));
            }
}

/* Area between the line of discontinuities and a straight line that starts `height` beside it and meets it `half` on,
 * within the unit pixel that starts at p: the integral, by the trapezium rule, which is exact for straight lines. */
static double area_under(double height, double half, double p)
{
    double h0 = height * (1.0 - p / half), h1 = height * (1.0 - (p + 1.0) / half);
    return 0.5 * (h0 + h1);
}

typedef struct run {
    int vertical, x, y, length;
} run;

static void weigh_run(truth_mlaa *m, run r)
{
    int start = truth_mlaa_crossed(m, r.vertical, r.x, r.y, 0, 0);
    int end = truth_mlaa_crossed(m, r.vertical, r.x, r.y, 1, r.length - 1);
    double at_start = start == 1 ? -0.5 : start == 2 ? 0.5 : 0.0; /* which side the new line starts and ends on */
    double at_end = end == 1 ? -0.5 : end == 2 ? 0.5 : 0.0;
    double half = 0.5 * r.length;
    for (int i = 0; i < r.length; i++) {
        double first = i + 1 <= half ? area_under(at_start, half, i) : 0.0; /* wholly in the first half */
        double second = r.length - i <= half ? area_under(at_end, half, r.length - 1 - i) : 0.0;
        double area = first + second;
        if (area != 0.0)
            give(m, r.vertical, area > 0.0, r.x + (r.vertical ? 0 : i), r.y + (r.vertical ? i : 0), fabs(area));
    }
}

void truth_mlaa_weigh_lines(truth_mlaa *m)
{
    for (int vertical = 0; vertical < 2; vertical++) {
        const unsigned char *table = vertical ? m->right : m->down;
        for (int y = 0; y < m->height; y++)
            for (int x = 0; x < m->width; x++) {
                bool starts = edge(m, table, x, y) && !edge(m, table, x - !vertical, y - vertical);
                run r = {vertical, x, y, 0};
                while (starts && edge(m, table, x + (vertical ? 0 : r.length), y + (vertical ? r.length : 0)))
                    r.length++;
                if (starts && r.length <= 256)
                    weigh_run(m, r);
            }
    }
}

void truth_mlaa_blend(const truth_mlaa *m, truth_image *image)
{
    static const int step[4][2] = {{0, -1}, {0, 1}, {-1, 0}, {1, 0}};
    size_t n = (size_t)m->width * (size_t)m->height;
    truth_image from = {m->width, m->height, zeroed(n * 3, sizeof(double))};
    memcpy(from.value, image->value, n * 3 * sizeof(double));
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++) {
            double w[4], sum = 0.0;
            for (int d = 0; d < 4; d++)
                sum += w[d] = m->weight[d][y * m->width + x];
            for (int d = 0; d < 4; d++)
                for (int c = 0; c < 3 && w[d] > 0.0; c++)
                    truth_at(image, x, y)[c] +=
                        w[d] / (sum > 1.0 ? sum : 1.0) *
                        (truth_at(&from, x + step[d][0], y + step[d][1])[c] - truth_at(&from, x, y)[c]);
        }
    truth_free(&from);
}
