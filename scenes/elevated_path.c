#include "scenes/elevated.h"

/* The flight heads for -z, swaying from side to side on two sines; its height follows the largest ground of its
 * surroundings, smoothed over the way ahead and behind. Everything is a function of the distance flown. */

typedef struct sway {
    double length; /* cells a period */
    float width;
} sway;
static const sway sways[] = {{17.0, 1.1f}, {7.3, 0.32f}};

/* 2π · the part of distance/length below a whole number: exact however far. */
static float phase_of(double distance, double length)
{
    double turns = distance / length;
    turns -= (double)(int64_t)turns;
    return (float)(turns * 6.283185307179586);
}

static float lateral(double distance, float *slope)
{
    float x = 0.0f;
    *slope = 0.0f;
    for (size_t i = 0; i < sizeof sways / sizeof *sways; i++) {
        float phase = phase_of(distance, sways[i].length);
        x += sways[i].width * amb_sin(phase);
        *slope += sways[i].width * amb_cos(phase) * (AMB_TWO_PI / (float)sways[i].length);
    }
    return x;
}

/* A place of the plane as whole cells and the rest. */
static int64_t whole_cell(double a)
{
    int64_t cell = (int64_t)a;
    return (double)cell > a ? cell - 1 : cell;
}

/* ln(Σ w·e^(k·h)/Σ w)/k: a smooth maximum of the ground's four coarsest octaves, from `reach` cells behind to as many
 * ahead and 0.08 to either side. */
static float highest_ground(const amb_terrain *t, double x0, double z0, double distance, float scale)
{
    enum { ALONG = 25, ACROSS = 3 };
    const float k = 90.0f, reach = 0.8f;
    float sum = 0.0f, weights = 0.0f;
    for (int i = 0; i < ALONG; i++) {
        float u = (float)i * (2.0f / (ALONG - 1)) - 1.0f, slope;
        double along = distance + (double)(reach * u);
        float x = (float)((double)lateral(along, &slope) - x0), z = (float)(-along - z0);
        float bell = (1.0f - u * u) * (1.0f - u * u);
        for (int j = 0; j < ACROSS; j++) {
            v2x at = {x + 0.08f * (float)(j - 1), z};
            sum += bell * amb_exp(k * scale * terrain_at(t, at, 4.0f).height);
            weights += bell;
        }
    }
    return amb_log(sum / weights) / k;
}

/* The mean of that over the way around, so that the flight climbs and falls gently. */
static float smooth_ground(const amb_terrain *t, double x0, double z0, double distance, float scale)
{
    enum { TAPS = 11 };
    float sum = 0.0f, weights = 0.0f;
    for (int i = 0; i < TAPS; i++) {
        float u = (float)(i + 1) * (2.0f / (TAPS + 1)) - 1.0f, bell = (1.0f - u * u) * (1.0f - u * u);
        sum += bell * highest_ground(t, x0, z0, distance + (double)(0.65f * u), scale);
        weights += bell;
    }
    return sum / weights;
}

elevated_place elevated_place_at(const amb_noise_texture *noise, const elevated_params *params, double time)
{
    const double ahead = 1.2;
    double distance = time > -1e12 && time < 1e12 ? time * (double)params->speed : 0.0;
    float slope, slope_ahead;
    double x = (double)lateral(distance, &slope), z = -distance;
    double target_x = (double)lateral(distance + ahead, &slope_ahead);
    elevated_place place = {.x = whole_cell(x), .z = whole_cell(z)};
    double x0 = (double)place.x, z0 = (double)place.z;

    amb_terrain ground;
    amb_terrain_place(&ground, noise, (uint32_t)params->seed, params->erosion, params->turned != 0, place.x, place.z);
    float here = smooth_ground(&ground, x0, z0, distance, params->height);
    float there = smooth_ground(&ground, x0, z0, distance + ahead, params->height);
    place.eye = (v3){(float)(x - x0), here + params->clearance, (float)(z - z0)};
    place.target =
        (v3){(float)(target_x - x0), 0.35f * here + 0.65f * there + 0.45f * params->clearance, (float)(z - ahead - z0)};
    place.up = v3_normalize((v3){0.5f * (slope_ahead - slope), 1.0f, 0.0f}); /* leans into its turns */
    return place;
}
