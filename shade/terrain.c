#include "shade/terrain.h"

/* Floor division by 5 with a remainder of 0…4. */
static int64_t fifth(int64_t a, int64_t *rest)
{
    int64_t q = a / 5, r = a % 5;
    if (r < 0)
        r += 5, q--;
    *rest = r;
    return q;
}

/* A number cell + part/5ⁱ, 0 ≤ part < 5ⁱ. */
typedef struct fraction {
    int64_t cell, part;
} fraction;

/* (2/5)·(cell + part/5ⁱ) for whole `cell` and any `part`, as a fraction over 5ⁱ⁺¹. power = 5ⁱ. */
static fraction two_fifths(int64_t cell, int64_t part, int64_t power)
{
    int64_t rest, carry;
    int64_t whole = fifth(2 * cell, &rest);
    int64_t numerator = 2 * part + rest * power, over = power * 5;
    carry = numerator / over;
    numerator %= over;
    if (numerator < 0)
        numerator += over, carry--;
    return (fraction){whole + carry, numerator};
}

void amb_terrain_place(amb_terrain *terrain, const amb_noise_texture *noise, uint32_t seed, float erosion, bool turned,
                       int64_t x, int64_t y)
{
    *terrain = (amb_terrain){.noise = noise, .erosion = erosion};
    fraction at_x = {x, 0}, at_y = {y, 0};
    int64_t power = 1; /* 5ⁱ */
    float frequency = 1.0f;
    double c = 1.0, s = 0.0;
    for (int i = 0; i < TERRAIN_OCTAVES; i++) {
        uint32_t start = seed == 0 ? 0u : amb_hash(seed + (uint32_t)i); /* two of its bytes */
        terrain->octave[i] = (amb_terrain_octave){
            .frequency = frequency,
            .along = (float)c * frequency,
            .across = (float)s * frequency,
            .c = (float)c,
            .s = (float)s,
            .cc = (float)(c * c),
            .ss = (float)(s * s),
            .cs = (float)(c * s),
            .offset = {(float)((double)at_x.part / (double)power), (float)((double)at_y.part / (double)power)},
            .x = (uint32_t)at_x.cell + (start & 255u),
            .y = (uint32_t)at_y.cell + (start >> 24)};
        frequency *= 2.0f;
        if (!turned) {
            at_x.cell *= 2, at_y.cell *= 2;
            continue;
        }
        fraction next_x = two_fifths(4 * at_x.cell - 3 * at_y.cell, 4 * at_x.part - 3 * at_y.part, power);
        fraction next_y = two_fifths(3 * at_x.cell + 4 * at_y.cell, 3 * at_x.part + 4 * at_y.part, power);
        at_x = next_x, at_y = next_y;
        power *= 5;
        double turn_c = c * 0.8 - s * 0.6, turn_s = c * 0.6 + s * 0.8;
        c = turn_c, s = turn_s;
    }
}
