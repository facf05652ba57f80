#include "tests/truth_rays.h"

#include <math.h>

typedef struct d3 {
    double x, y, z;
} d3;
static d3 d3_of(v3 a) { return (d3){(double)a.x, (double)a.y, (double)a.z}; }
static d3 d3_sub(d3 a, d3 b) { return (d3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static d3 d3_cross(d3 a, d3 b) { return (d3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static double d3_dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

truth true_hit(const amb_mesh *m, const listed_ray *r)
{
    const double margin = 2e-5;
    truth best = {.clear = 1, .primitive = -1, .t = HUGE_VAL};
    double second = HUGE_VAL;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        d3 a = d3_of(m->position[m->index[3 * i]]), b = d3_of(m->position[m->index[3 * i + 1]]);
        d3 c = d3_of(m->position[m->index[3 * i + 2]]), d = d3_of(r->direction);
        d3 e = d3_sub(b, a), f = d3_sub(c, a), s = d3_sub(d3_of(r->origin), a), p = d3_cross(d, f), q = d3_cross(s, e);
        double det = d3_dot(e, p), u = d3_dot(s, p) / det, v = d3_dot(d, q) / det, t = d3_dot(f, q) / det;
        double inner = fmin(fmin(u, v), 1 - u - v);
        double steep = fabs(det) / sqrt(d3_dot(p, p) * d3_dot(e, e));
        if (!(inner > -margin) || t < -margin)
            continue;
        if (!(inner > margin) || !(steep > 1e-3) || t < margin) {
            best.clear = 0;
            continue;
        }
        if (t < best.t) {
            second = best.t;
            d3 n = d3_cross(e, f);
            double length = sqrt(d3_dot(n, n));
            best = (truth){best.clear, 1, (int)i, t, u, v, {n.x / length, n.y / length, n.z / length}};
        } else if (t < second) {
            second = t;
        }
    }
    if (second - best.t < 1e-5 * (1 + best.t))
        best.clear = 0;
    return best;
}

static float component(v3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

listed_hit scan(const amb_mesh *m, const listed_ray *r)
{
    listed_hit best = {.t = r->t_far, .primitive = -1};
    float ax = fabsf(r->direction.x), ay = fabsf(r->direction.y), az = fabsf(r->direction.z);
    int z = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2, x = (z + 1) % 3, y = (z + 2) % 3;
    float dz = component(r->direction, z), sx = component(r->direction, x) / dz, sy = component(r->direction, y) / dz;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        float px[3], py[3], pz[3];
        for (int k = 0; k < 3; k++) {
            v3 p = m->position[m->index[3 * i + (uint32_t)k]];
            pz[k] = component(p, z) - component(r->origin, z);
            px[k] = (component(p, x) - component(r->origin, x)) - sx * pz[k];
            py[k] = (component(p, y) - component(r->origin, y)) - sy * pz[k];
        }
        float u = px[2] * py[1] - py[2] * px[1], v = px[0] * py[2] - py[0] * px[2], w = px[1] * py[0] - py[1] * px[0];
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
            continue;
        float det = u + v + w;
        if (det == 0)
            continue;
        float t = ((u * pz[0] + v * pz[1] + w * pz[2]) * (1 / dz)) / det;
        if (t > r->t_near && t < best.t) {
            best = (listed_hit){.hit = 1, .t = t, .u = v / det, .v = w / det, .primitive = (int)i};
        }
    }
    return best;
}

ball_truth true_ball_hit(const amb_rays_sphere *ball, int count, const listed_ray *r)
{
    ball_truth best = {1, -1, (double)r->t_far, (double)r->t_far};
    d3 d = d3_of(r->direction);
    for (int k = 0; k < count; k++) {
        d3 f = d3_sub(d3_of(r->origin), d3_of(ball[k].center));
        double a = d3_dot(d, d), b = d3_dot(f, d), radius = (double)ball[k].radius, c = d3_dot(f, f) - radius * radius;
        double disc = b * b - a * c;
        if (fabs(disc) < 1e-4 * a || fabs(c) < 1e-4)
            best.clear = 0;
        if (disc < 0)
            continue;
        double t0 = (-b - sqrt(disc)) / a, t1 = (-b + sqrt(disc)) / a, t = t0 > 0 ? t0 : t1;
        if (t > 0 && fabs(t - best.t) < 1e-4)
            best.clear = 0;
        if (t > 0 && t <= best.t)
            best.t = t, best.t_exit = t1, best.ball = k;
    }
    return best;
}
