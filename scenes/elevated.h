/* What the files of scene elevated share. Lengths are in cells of the terrain's first octave (think of 3 km); y is up;
 * the world's origin is the lattice point under the eye, so that floats near the eye stay small however far the flight
 * has gone. */
#ifndef AMB_SCENES_ELEVATED_H
#define AMB_SCENES_ELEVATED_H

#include "scenes/canvas.h"
#include "shade/sky.h"
#include "shade/terrain.h"

#include <ambiance/texture.h>

typedef enum elevated_normals { NORMALS_ANALYTIC, NORMALS_CENTRAL } elevated_normals;
typedef enum elevated_shadows { SHADOWS_MARCH, SHADOWS_ESTIMATE, SHADOWS_OFF } elevated_shadows;

typedef struct elevated_params {
    float sun_azimuth, sun_elevation, turbidity, sun_size, exposure, adaptation, balance; /* light */
    float fog_density, fog_falloff;
    v3 fog_color;
    float height, erosion; /* ground */
    int turned, seed;
    int geometry_octaves, octaves;
    float triangle, detail;
    int normals;
    float normal_step;
    int shadows, shadow_octaves, shadow_steps;
    float shadow_reach, shadow_size;
    float occlusion_power, occlusion_floor, ambient, ambient_noise, back;
    v3 back_color;
    terrain_snow_edges snow;
    float snow_height, snow_scale;
    v3 snow_color, land_color, strata_color, valley_color;
    float texture, roughness, crags;
    int tiles;
    float speed, clearance, sight, fov; /* flight */
    int wireframe, samples;
} elevated_params;

enum {
    OUT_POSITION,
    OUT_NORMAL,
    OUT_ALBEDO,
    OUT_ID,
    OUT_DEPTH,
    OUT_AO,
    OUT_SHADOW,
    OUT_SNOW,
    OUT_FOG,
    OUT_HEIGHT,
    OUT_LIGHT,
    OUT_COUNT
};

/* A tile of albedo. */
typedef struct elevated_texture {
    const amb_texture *map; /* borrowed */
    v3 per_mean;            /* 1 / its mean colour */
    float tiles;            /* a cell's side; whole, so that every lattice point sees the same corner */
} elevated_texture;

typedef struct elevated_uniforms {
    m4 world_to_clip;
    v3 eye, ray_origin, ray_dx, ray_dy;
    float pixels; /* a length of 1 at distance 1 is this many samples on the screen */
    const elevated_params *params;
    amb_terrain ground, speckle; /* speckle: the noise of snow and ambient light, snow_scale times as fine */
    amb_sky sky;
    elevated_texture rock, snow;
    v3 sun_rgb, ambient_rgb, back_rgb, haze_rgb; /* light on white, times exposure */
    v3 to_back;
    float sun_cosine; /* of the disc's radius */
    v3 gain;          /* exposure and white balance */
    float ceiling;    /* no ground is above this height */
    int slot[CANVAS_MAX_AOVS];
} elevated_uniforms;

typedef struct elevated_state {
    amb_noise_texture noise;
    elevated_texture rock, snow;
} elevated_state;

/* Where the flight is: the lattice point under it, and the camera relative to that. Any time, directly. */
typedef struct elevated_place {
    int64_t x, z;
    v3 eye, target, up;
} elevated_place;
elevated_place elevated_place_at(const amb_noise_texture *noise, const elevated_params *params, double time);

#endif
