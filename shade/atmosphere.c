#include "shade/atmosphere.h"

/* ∫ e^(-h/H0) ds from distance r at a zenith cosine to the top of the air, relative to H0·e^(-h/H0) of the start.
 * Midpoint rule with the segments growing from the start, where a descending ray is densest last: 512 are enough for
 * 10⁻⁴. */
static double relative_depth(const amb_atmosphere *air, double r, double cosine)
{
    double sine2 = 1.0 - cosine * cosine, rise = r * cosine;
    double top = (double)air->top;
    double length = (double)__builtin_sqrtf((float)(rise * rise + top * top - r * r)) - rise;
    double sum = 0.0;
    const int steps = 512;
    for (int i = 0; i < steps; i++) {
        double s = length * ((double)i + 0.5) / steps;
        double along = rise + s;
        float height = __builtin_sqrtf((float)(along * along + r * r * sine2)) - (float)r;
        sum += (double)amb_exp(-height / air->scale_height);
    }
    return sum * length / steps / (double)air->scale_height;
}

void amb_atmosphere_fit(amb_atmosphere *air)
{
    /* At a representative height: a third of a scale height up, where most of the light comes from. From there the
     * lowest ray that misses the ground leaves this far below the horizontal; from higher up, further. */
    double r = (double)air->radius + (double)air->scale_height / 3.0;
    double lowest = (double)air->radius / ((double)air->radius + 2.0 * (double)air->scale_height);
    double end = 1.0 + (double)__builtin_sqrtf((float)(1.0 - lowest * lowest));
    double node[ATMOSPHERE_FIT], table[ATMOSPHERE_FIT];
    for (int i = 0; i < ATMOSPHERE_FIT; i++) {
        float angle = AMB_PI * (2.0f * (float)i + 1.0f) / (2.0f * ATMOSPHERE_FIT);
        node[i] = 0.5 * end * (1.0 - (double)amb_cos(angle));
        table[i] = (double)amb_log((float)relative_depth(air, r, 1.0 - node[i]));
    }
    /* Newton's divided differences, then expanded to powers of x. */
    for (int level = 1; level < ATMOSPHERE_FIT; level++)
        for (int i = ATMOSPHERE_FIT - 1; i >= level; i--)
            table[i] = (table[i] - table[i - 1]) / (node[i] - node[i - level]);
    double power[ATMOSPHERE_FIT] = {table[ATMOSPHERE_FIT - 1]};
    for (int i = ATMOSPHERE_FIT - 2; i >= 0; i--) {
        for (int k = ATMOSPHERE_FIT - 1; k > 0; k--)
            power[k] = power[k - 1] - node[i] * power[k];
        power[0] = table[i] - node[i] * power[0];
    }
    for (int i = 0; i < ATMOSPHERE_FIT; i++)
        air->fit[i] = (float)power[i];
    air->fit_end = (float)end;
}
