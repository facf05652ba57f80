/* The ways of c through the quaternions and of the camera around the set.
 *
 * The orbit of 0 stays in the plane of 1 and the axis of c, so the set is connected exactly when Re c + |Im c|·i lies
 * in the Mandelbrot set. The way goes round inside it: the bulb of period 3, its neck, the main cardioid and back,
 * while the axis swings. The axis decides how our three-dimensional space cuts the four-dimensional set. */
#include "scenes/julia.h"

#include <ambiance/camera.h>

#include <math.h>

typedef struct station {
    v3 c;    /* real part, length of the imaginary part, 0 */
    v3 axis; /* i, j, k; any length */
} station;

static const station stations[] = {
    /* equal times apart */
    {{-0.1950f, 0.7900f, 0}, {1.00f, 0.00f, 0.00f}},   {{-0.1300f, 0.7450f, 0}, {0.86f, 0.50f, 0.10f}},
    {{-0.1250f, 0.6496f, 0}, {0.75f, 0.65f, 0.10f}},   {{-0.2400f, 0.6000f, 0}, {0.58f, 0.74f, 0.34f}},
    {{-0.3800f, 0.5750f, 0}, {0.40f, 0.90f, 0.16f}},   {{-0.4800f, 0.5250f, 0}, {-0.10f, 0.98f, -0.10f}},
    {{-0.2900f, 0.5800f, 0}, {-0.07f, 0.75f, -0.66f}}, {{-0.1250f, 0.6496f, 0}, {-0.30f, 0.90f, -0.30f}},
    {{-0.1180f, 0.7650f, 0}, {-0.29f, 0.95f, 0.10f}},  {{-0.1550f, 0.8280f, 0}, {0.40f, 0.90f, 0.12f}},
};
#define STATIONS ((int)(sizeof stations / sizeof *stations))

static v3 c_of(const station *s) { return s->c; }
static v3 axis_of(const station *s) { return s->axis; }

/* A closed curve as an open one: the stations around the wanted segment, at times -1 … 2. */
static v3 around(int segment, float t, v3 (*part)(const station *))
{
    amb_spline_key key[4];
    for (int i = 0; i < 4; i++)
        key[i] = (amb_spline_key){(float)(i - 1), part(&stations[(segment + i - 1 + STATIONS) % STATIONS])};
    return amb_spline_at(key, 4, t);
}

v4 amb_julia_path(double time, double period)
{
    double turn = time / period, way = (turn - floor(turn)) * STATIONS;
    int segment = (int)way;
    segment = segment >= STATIONS ? STATIONS - 1 : segment;
    float t = (float)(way - segment);
    v3 c = around(segment, t, c_of), imaginary = v3_scale(v3_normalize(around(segment, t, axis_of)), c.y);
    return (v4){c.x, imaginary.x, imaginary.y, imaginary.z};
}

/* Once around the set, now near, now far; one key more at either end closes the loop. */
static const amb_camera_key camera_keys[] = {
    {-10, {-0.972f, 0.54f, 2.59f}, {0, 0, 0}, {0, 1, 0}},   {0, {0.324f, 0.972f, 2.86f}, {0, 0, 0}, {0, 1, 0}},
    {10, {2.05f, 0.756f, 1.84f}, {0, 0, 0}, {0.05f, 1, 0}}, {20, {2.38f, 0.108f, -0.648f}, {0, 0, 0}, {0.1f, 1, 0}},
    {30, {0.972f, -0.54f, -2.27f}, {0, 0, 0}, {0, 1, 0}},   {40, {-1.3f, 0.324f, -2.38f}, {0, 0, 0}, {0, 1, 0.1f}},
    {50, {-2.48f, 1.19f, -0.216f}, {0, 0, 0}, {0, 1, 0}},   {60, {-1.62f, 0.864f, 1.94f}, {0, 0, 0}, {0, 1, 0}},
    {70, {-0.972f, 0.54f, 2.59f}, {0, 0, 0}, {0, 1, 0}},    {80, {0.324f, 0.972f, 2.86f}, {0, 0, 0}, {0, 1, 0}},
    {90, {2.05f, 0.756f, 1.84f}, {0, 0, 0}, {0.05f, 1, 0}},
};

amb_camera amb_julia_camera(double time, int width, int height)
{
    double turn = time / (double)JULIA_SECONDS;
    float now = (float)((turn - floor(turn)) * (double)JULIA_SECONDS);
    return amb_camera_at(camera_keys, sizeof camera_keys / sizeof *camera_keys, now, 0.8f, 0.05f, 20, width, height);
}
