#include "lanes_terrain.h"

const lanes_terrain_set *lanes_terrain_data(void)
{
    static lanes_terrain_set set;
    if (!set.plain.noise) {
        amb_noise_texture_make(&set.noise, 5);
        amb_terrain_place(&set.plain, &set.noise, 0, 1.0f, false, 0, 0);
        amb_terrain_place(&set.turned, &set.noise, 11, 1.0f, true, -1234567, 89);
        set.sky = amb_sky_make((v3){0.36f, 0.48f, -0.8f}, 3.0f);
    }
    return &set;
}
