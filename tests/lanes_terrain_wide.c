/* Noise out of a texture, terrain and sky as cases. */
#include "lanes.h"
#include "lanes_terrain.h"

#include <shade/sky.h>
#include <shade/terrain.h>

#define POINT2 ((v2x){in[0], in[1]})
#define V3(i) ((v3x){in[i], in[(i) + 1], in[(i) + 2]})
AMB_INLINE void write3(v3x v, f32x *out) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

LANES_CASE(texture2, 2, 6, {
    noise2x n = noise_texture2(lanes_terrain_data()->plain.noise, POINT2, (amb_lattice){.seed = 3, .x = -7, .y = 1000});
    out[0] = n.value, out[1] = n.slope.x, out[2] = n.slope.y, out[3] = n.xx, out[4] = n.xy, out[5] = n.yy;
})
LANES_CASE(plain, 3, 3, {
    terrain_surface z = terrain_at(&lanes_terrain_data()->plain, POINT2, in[2]);
    out[0] = z.height, out[1] = z.slope.x, out[2] = z.slope.y;
})
LANES_CASE(turned, 3, 3, {
    terrain_surface z = terrain_at(&lanes_terrain_data()->turned, POINT2, in[2]);
    out[0] = z.height, out[1] = z.slope.x, out[2] = z.slope.y;
})
LANES_CASE(central, 4, 3, {
    terrain_surface z = terrain_at_central(&lanes_terrain_data()->turned, POINT2, in[2], in[3]);
    out[0] = z.height, out[1] = z.slope.x, out[2] = z.slope.y;
})
LANES_CASE(fbm, 3, 1, { out[0] = terrain_fbm(&lanes_terrain_data()->turned, POINT2, in[2]); })
LANES_CASE(normal, 2, 3, { write3(terrain_normal(POINT2, 0.4f), out); })
LANES_CASE(occlusion, 1, 1, { out[0] = terrain_occlusion(in[0], 1.7f, 0.2f); })
LANES_CASE(snow, 2, 1, { out[0] = terrain_snow(in[0], in[1], (terrain_snow_edges){0.9f, 0.7f, 1.3f, 0.8f, 1.1f}); })
LANES_CASE(sunlight, 3, 1, {
    terrain_march m = {.scale = 0.4f, .ceiling = 0.6f, .reach = 8.0f, .spread = 0.0047f, .steps = 24};
    v3 to_light = {0.8f, 0.28f, 0.53f};
    out[0] = terrain_sunlight(&lanes_terrain_data()->turned, &m, POINT2, in[2], to_light, f_set(5.0f));
})
LANES_CASE(sky, 3, 9, {
    const amb_sky *sky = &lanes_terrain_data()->sky;
    write3(sky_rgb(sky, V3(0)), out);
    write3(sky_horizon_rgb(sky, V3(0)), out + 3);
    write3(sky_sun_disc(sky, V3(0), 0.9f), out + 6);
})
LANES_CASE(clip, 3, 3, { write3(color_clip_negative(V3(0)), out); })

const lanes_case WIDE(lanes_terrain)[] = {
    LANES_ENTRY(texture2, 2, 6), LANES_ENTRY(plain, 3, 3),  LANES_ENTRY(turned, 3, 3),    LANES_ENTRY(central, 4, 3),
    LANES_ENTRY(fbm, 3, 1),      LANES_ENTRY(normal, 2, 3), LANES_ENTRY(occlusion, 1, 1), LANES_ENTRY(snow, 2, 1),
    LANES_ENTRY(sunlight, 3, 1), LANES_ENTRY(sky, 3, 9),    LANES_ENTRY(clip, 3, 3),      {0}};
