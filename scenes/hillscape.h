/* Scene hillscape: what its files share. World units are metres, y up, -z north; the sea's level is y = 0.
 *
 *   hillscape_wide.c          the frame: passes in their order
 *   hillscape_params.c        parameters, outputs
 *   hillscape_load.c          grids, bounds, slopes, places of plants
 *   hillscape_lights_wide.c   sun, fill, point and spot light; shadow maps
 *   hillscape_terrain_wide.c  hills       hillscape_water_wide.c  water
 *   hillscape_sky_wide.c      sky, sphere hillscape_plants_wide.c trees, grass    hillscape_fire_wide.c  particles */
#ifndef AMB_SCENES_HILLSCAPE_H
#define AMB_SCENES_HILLSCAPE_H

#include "scenes/hillscape_fire.h"
#include "scenes/material.h"
#include "shade/light.h"
#include "shade/shadow.h"
#include "shade/sky.h"
#include "shade/waves.h"

#include <ambiance/mesh.h>
#include <ambiance/raster.h>
#include <ambiance/scene.h>

#define HILL_SIZE 2048.0f            /* side of the height map */
#define HILL_SEA 0.25f               /* the height map's value at y = 0 */
#define HILL_PATCHES 128             /* along a side: 16 units each */
#define WATER_CELLS 64               /* along a side, the outer ones ever wider */
#define WATER_CELL 64.0f             /* of the inner ones */
#define HILL_SECONDS 90.0f           /* of the flight */
enum { HILL_PANORAMA_HEIGHT = 192 }; /* at most; four times as wide */

enum { BRDF_BLINN_PHONG, BRDF_COOK_TORRANCE };
enum { WAVES_OF_SINES, WAVES_OF_NOISE };
enum { LIGHT_SUN, LIGHT_FILL, LIGHT_POINT, LIGHT_SPOT, HILL_LIGHTS };
enum { GROUND_SAND, GROUND_GRASS, GROUND_ROCK, GROUND_SNOW, GROUND_COUNT };

typedef struct hill_params {
    int terrain, water, sphere, trees, grass, particles;
    float relief, snow_line;
    float tess_min, tess_max;
    int partitioning;
    float wave_height, wave_frequency, wave_speed;
    int waves, wave_count, mirror;
    int brdf;
    int sun, sun_shadow;
    float sun_azimuth, sun_elevation, day, turbidity;
    v3 sun_color;
    int fill, fill_shadow;
    v3 fill_direction, fill_color;
    int point, point_shadow;
    v3 point_position, point_color;
    float point_reach;
    int spot, spot_shadow;
    v3 spot_position, spot_target, spot_color;
    float spot_reach, spot_angle;
    int shadow_size, shadow_taps;
    float sphere_radius, sphere_speed;
    float clouds, haze, exposure;
    int wireframe, samples;
    int bloom, brightpass;
    float bloom_sensitivity, bloom_intensity;
} hill_params;

enum {
    HILL_DEPTH,
    HILL_POSITION,
    HILL_NORMAL,
    HILL_ALBEDO,
    HILL_ID,
    HILL_SHADOW,
    HILL_WEIGHTS,
    HILL_TESSELLATION,
    HILL_ROUGHNESS,
    HILL_AMBIENT,
    HILL_HAZE,
    HILL_REFLECTION,
    HILL_AOVS
};
enum { ID_TERRAIN = 1, ID_WATER, ID_SPHERE, ID_TREE, ID_GRASS, ID_PARTICLE };

extern const amb_aov hill_aovs[HILL_AOVS];
enum { HILL_FLIGHT_KEYS = 7 };
extern const amb_camera_key hill_flight[HILL_FLIGHT_KEYS];
enum { HILL_PARAM_COUNT = 54 };
extern const amb_param hill_param_rows[HILL_PARAM_COUNT];

typedef struct hill_plant {
    float x, z, size; /* units; size: height */
    float kind;       /* column of the atlas */
} hill_plant;

typedef struct hill_state {
    const amb_texture *height; /* 0…1 */
    amb_texture *slopes;       /* RG: ∂height/∂u, ∂height/∂v by central differences of two texels */
    amb_texture *noise;        /* RGBA8, tiles: four independent fBm */
    amb_material ground[GROUND_COUNT];
    const amb_texture *trees, *tree_normals, *blades; /* atlases */
    v2 *corner;                                       /* of the terrain's patches: (HILL_PATCHES + 1)² */
    uint32_t *patch;                                  /* 4 · HILL_PATCHES² */
    v2 *bounds; /* least and most height of the patch whose first corner it is, 0…1 */
    v2 *water_corner;
    uint32_t *water_patch;
    hill_plant *plant;
    uint32_t plants;
    amb_mesh *sphere;
} hill_state;

amb_status hill_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error);
void hill_unload(void *state);
/* The patches' corners, nearest patch first: less is shaded that something hides later. Room for 4 · HILL_PATCHES². */
void hill_sort_patches(const hill_state *state, v3 eye, uint32_t *near_to_far);

/* One frame: what every pass of it shares. */
typedef struct hill_frame {
    hill_params p;
    const hill_state *state;
    const uint32_t *patch; /* the state's, nearest first */
    amb_camera camera;
    double time;
    float seconds; /* the time folded to 4096 s: for motion that may start over */
    float pixel;   /* a pixel's width at distance 1 */
    amb_sky sky;
    float gain, sun_seen;        /* kcd/m² to picture units; share of the disc that is drawn */
    const amb_texture *panorama; /* the sky with its clouds, azimuth by height; NULL while it is painted */
    v3 sky_light[2];             /* picture units: on a white surface facing up, and facing down (from the ground) */
    v3 haze_rgb;
    amb_waves waves;
    amb_light light[HILL_LIGHTS];
    bool light_on[HILL_LIGHTS];
    amb_shadow shadow[HILL_LIGHTS];
    v3 sphere_at;
    fire_particle particle[FIRE_PARTICLES];
    const amb_texture *mirror; /* the scene upside down, as the water sees it; NULL: sky only */
} hill_frame;

/* One pass of it: the uniforms of every draw. */
typedef struct hill_pass {
    const hill_frame *frame;
    m4 world_to_clip;
    v4 plane[6];      /* of the view, pointing inwards, over (x, y, z, 1) */
    v3 from;          /* what is shaded is seen from here: the camera, or its mirror image */
    v3 eye;           /* what billboards turn to: the camera, or far along the light */
    float tess_limit; /* most subdivisions here */
    bool upside_down; /* the mirror image: nothing under water */
    bool depth_only, depth_clamp;
    int height;          /* pixels of this pass */
    float pixels;        /* of the camera's window a pixel of this pass */
    int slot[HILL_AOVS]; /* attachment of an output; 0: none; colour is 0 … */
    bool color_off;      /* … unless only outputs are drawn */
} hill_pass;

static const amb_sampler hill_height_sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}};

/* Height map coordinates of (x, z). */
AMB_INLINE v2x hill_uv(v2x place)
{
    return (v2x){place.x * (1.0f / HILL_SIZE) + 0.5f, place.y * (1.0f / HILL_SIZE) + 0.5f};
}
/* The ground's y. */
AMB_INLINE f32x hill_ground(const hill_frame *f, v2x place, f32x lod)
{
    f32x height = amb_sample_2d_lod(f->state->height, &hill_height_sampler, hill_uv(place), lod).x;
    return (height - HILL_SEA) * f->p.relief;
}

/* The report's factor: clamp(64 - |eye - place|/8, least, most). */
AMB_INLINE f32x hill_tessellation(v3 eye, v3x place, float least, float most)
{
    f32x distance = v3x_length(v3x_sub(place, v3x_splat(eye)));
    return f_clamp(64.0f - distance * 0.125f, f_set(least), f_set(most));
}

/* False lanes: the box is wholly outside one of the pass's planes. */
AMB_INLINE maskx hill_box_seen(const hill_pass *pass, v3x low, v3x high)
{
    maskx seen = m_set(true);
    for (int i = 0; i < 6; i++) {
        v4 p = pass->plane[i];
        f32x x = p.x > 0.0f ? high.x : low.x, y = p.y > 0.0f ? high.y : low.y, z = p.z > 0.0f ? high.z : low.z;
        seen = seen & (x * p.x + y * p.y + z * p.z + p.w >= 0.0f);
    }
    return seen;
}

/* ---- draws of one pass; each does nothing where its object is off -------------------------------------------------
 */

#define hill_terrain_draw WIDE(hill_terrain_draw)
#define hill_draw_terrain WIDE(hill_draw_terrain)
#define hill_draw_water WIDE(hill_draw_water)
#define hill_draw_sky WIDE(hill_draw_sky)
#define hill_draw_sphere WIDE(hill_draw_sphere)
#define hill_draw_trees WIDE(hill_draw_trees)
#define hill_draw_grass WIDE(hill_draw_grass)
#define hill_draw_fire WIDE(hill_draw_fire)
#define hill_draw_panorama WIDE(hill_draw_panorama)
#define hill_lights_make WIDE(hill_lights_make)
#define hill_shadows_make WIDE(hill_shadows_make)
#define hill_pass_make WIDE(hill_pass_make)
#define hill_pass_finish WIDE(hill_pass_finish)
amb_draw hill_terrain_draw(const hill_pass *pass); /* what hill_draw_terrain records; uniforms are *pass itself */
amb_status hill_draw_terrain(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_water(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_sky(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_sphere(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_trees(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_grass(const hill_pass *pass, amb_pass *out, amb_error *error);
amb_status hill_draw_fire(const hill_pass *pass, amb_pass *out, amb_error *error);
/* The sky over every direction: u the azimuth from -z by +x, v = (1 - y)/1.0625 down to a little below the horizon. */
amb_status hill_draw_panorama(const hill_pass *pass, amb_pass *out, amb_error *error);

/* x folded to [0, period); far out, where a double no longer tells the turns apart, 0. */
AMB_INLINE float hill_folded(double x, double period)
{
    double turns = x / period, whole = turns > -9.0e15 && turns < 9.0e15 ? (double)(int64_t)turns : turns;
    double rest = turns - whole;
    return (float)((rest < 0.0 ? rest + 1.0 : rest) * period);
}

/* The textures that a frame makes for itself, in the order they must be closed in. */
typedef struct hill_textures {
    amb_texture *made[16];
    int count;
} hill_textures;

/* Fills the frame's light[], light_on[], waves and sky from its parameters and time. */
void hill_lights_make(hill_frame *frame);
/* Draws every shadow map that is wanted for the job's picture and fills shadow[]. */
amb_status hill_shadows_make(const amb_scene_job *job, hill_frame *frame, hill_textures *textures, amb_error *error);
/* Finishes a pass and adds what it cost to the job's statistics. */
amb_status hill_pass_finish(const amb_scene_job *job, amb_pass **pass, amb_error *error);

/* A pass of `height` pixels that looks through a matrix; all outputs off. */
hill_pass hill_pass_make(const hill_frame *frame, m4 world_to_clip, v3 eye, int height);

#endif
