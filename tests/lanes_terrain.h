/* What the terrain's and the sky's cases and tests share: made once. */
#ifndef AMB_TESTS_LANES_TERRAIN_H
#define AMB_TESTS_LANES_TERRAIN_H

#include <shade/sky.h>
#include <shade/terrain.h>

typedef struct lanes_terrain {
    amb_noise_texture noise;
    amb_terrain plain, turned; /* at different places; plain has seed 0 */
    amb_sky sky;
} lanes_terrain_set;

const lanes_terrain_set *lanes_terrain_data(void);

#endif
