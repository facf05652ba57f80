/* The way of c through the quaternions. */
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
