/* The ways of c through the quaternions and of the camera around the set. */
#include "scenes/julia.h"

#include <ambiance/camera.h>

#include <math.h>

/* Real, i, j, k; equal times apart. */
static const v4 station[] = {
    {-0.200f, 0.800f, 0.000f, 0.000f},  {-0.125f, 0.640f, 0.380f, 0.060f},   {-0.291f, 0.339f, 0.437f, 0.200f},
    {-0.450f, 0.340f, 0.447f, 0.090f},  {-0.450f, -0.100f, 0.600f, -0.050f}, {-0.213f, -0.041f, 0.563f, -0.560f},
    {-0.125f, -0.256f, 0.847f, 0.090f}, {-0.100f, 0.200f, 0.800f, 0.150f},
};
#define STATIONS ((int)(sizeof station / sizeof *station))

/* A closed curve as an open one: the stations around the wanted segment, at times -1 … 2. */
static v3 around(int segment, float t, v3 (*part)(v4))
{
    amb_spline_key key[4];
    for (int i = 0; i < 4; i++)
        key[i] = (amb_spline_key){(float)(i - 1), part(station[(segment + i - 1 + STATIONS) % STATIONS])};
    return amb_spline_at(key, 4, t);
}

static v3 last_part(v4 c) { return (v3){c.w, 0.0f, 0.0f}; }

v4 amb_julia_path(double time, double period)
{
    double turn = time / period, way = (turn - floor(turn)) * STATIONS;
    int segment = (int)way;
    segment = segment >= STATIONS ? STATIONS - 1 : segment;
    float t = (float)(way - segment);
    return v4_of3(around(segment, t, v4_xyz), around(segment, t, last_part).x);
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
