/* What the planets share: a spheroid at the origin of its own frame, drawn by the rasterizer in shells (ground, clouds,
 * air), the sky of stars behind, and their outputs. Lengths are in planet radii. planet_wide.h has the lanes part. */
#ifndef AMB_SCENES_PLANET_H
#define AMB_SCENES_PLANET_H

#include "scenes/canvas.h"

#include <ambiance/mesh.h>
#include <ambiance/normal_map.h>
#include <ambiance/texture.h>

/* Outputs of every planet; a scene's own follow from PLANET_AOVS on. */
enum { PLANET_POSITION, PLANET_NORMAL, PLANET_ALBEDO, PLANET_ID, PLANET_DEPTH, PLANET_LIGHT, PLANET_AOVS };
#define PLANET_AOV_ROWS                                                                                   \
    {"position", 3, "world position, planet radii"}, {"normal", 3, "world normal, unit, bumps included"}, \
        {"albedo", 3, "linear albedo"}, {"id", 1, "1 the planet, 2 its rings, 0 background"},             \
        {"depth", 1, "0 near plane ... 1 far plane"},                                                     \
    {                                                                                                     \
        "light", 3, "light on the surface before its albedo"                                              \
    }

/* Parameters of every planet; the first member of each planet's parameter struct. */
typedef struct planet_params {
    float sun_azimuth, sun_elevation; /* degrees, seen from the planet: 0 along +z, 90 along +x */
    float turn, day;                  /* degrees at time 0; seconds a turn, 0: still */
    float tilt;                       /* degrees, of the axis toward +x */
    float exposure, stars;
    int samples;
    int show; /* PLANET_SHOW_…; scenes without a PLANET_SHOW_ROW leave it 0 */
} planet_params;
#define PLANET_FIELD(type, name) offsetof(type, name)
/* Rows for the table of a struct `type` whose first member is `planet`; defaults as given. */
#define PLANET_PARAM_ROWS(type, azimuth, elevation, turn_at_0, seconds_a_turn, axis_tilt, exposed)                 \
    {"sun_azimuth",                                                                                                \
     AMB_PARAM_FLOAT,                                                                                              \
     "degrees",                                                                                                    \
     -360,                                                                                                         \
     360,                                                                                                          \
     {azimuth},                                                                                                    \
     NULL,                                                                                                         \
     offsetof(type, planet.sun_azimuth),                                                                           \
     "where the sun is: 0 along +z, 90 along +x"},                                                                 \
        {"sun_elevation",                                                                                          \
         AMB_PARAM_FLOAT,                                                                                          \
         "degrees",                                                                                                \
         -90,                                                                                                      \
         90,                                                                                                       \
         {elevation},                                                                                              \
         NULL,                                                                                                     \
         offsetof(type, planet.sun_elevation),                                                                     \
         "its height over the plane of y = 0"},                                                                    \
        {"turn",                                                                                                   \
         AMB_PARAM_FLOAT,                                                                                          \
         "degrees",                                                                                                \
         -360,                                                                                                     \
         360,                                                                                                      \
         {turn_at_0},                                                                                              \
         NULL,                                                                                                     \
         offsetof(type, planet.turn),                                                                              \
         "turn of the planet about its axis at time 0"},                                                           \
        {"day",                                                                                                    \
         AMB_PARAM_FLOAT,                                                                                          \
         "s",                                                                                                      \
         0,                                                                                                        \
         100000,                                                                                                   \
         {seconds_a_turn},                                                                                         \
         NULL,                                                                                                     \
         offsetof(type, planet.day),                                                                               \
         "time of one turn; 0: it stands still"},                                                                  \
        {"tilt",                                                                                                   \
         AMB_PARAM_FLOAT,                                                                                          \
         "degrees",                                                                                                \
         -180,                                                                                                     \
         180,                                                                                                      \
         {axis_tilt},                                                                                              \
         NULL,                                                                                                     \
         offsetof(type, planet.tilt),                                                                              \
         "of the axis toward +x"},                                                                                 \
        {"exposure",                                                                                               \
         AMB_PARAM_FLOAT,                                                                                          \
         "",                                                                                                       \
         0,                                                                                                        \
         100,                                                                                                      \
         {exposed},                                                                                                \
         NULL,                                                                                                     \
         offsetof(type, planet.exposure),                                                                          \
         "factor on the sun's light"},                                                                             \
        {"stars", AMB_PARAM_FLOAT, "", 0, 100, {0.4f}, NULL, offsetof(type, planet.stars), "factor on the stars"}, \
    {                                                                                                              \
        "samples", AMB_PARAM_INT, "", 1, CANVAS_MAX_FACTOR, {2}, NULL, offsetof(type, planet.samples),             \
            "samples along a pixel's side"                                                                         \
    }

/* What the picture shows: everything, or one part alone (without sky, clouds and, but for the last two, air). */
enum {
    PLANET_SHOW_BEAUTY,
    PLANET_SHOW_ALBEDO,
    PLANET_SHOW_NORMALS,
    PLANET_SHOW_LIGHT,
    PLANET_SHOW_ATTENUATION,
    PLANET_SHOW_SCATTERING
};
extern const char *const planet_show_names[];
#define PLANET_SHOW_ROW(type)                                                                                     \
    {                                                                                                             \
        "show", AMB_PARAM_CHOICE, "", 0, 0, {PLANET_SHOW_BEAUTY}, planet_show_names, offsetof(type, planet.show), \
            "what the picture shows: all, or one part; attenuation and scattering are the air's"                  \
    }

/* How one frame sees a planet: the first member of every planet shader's uniforms. */
typedef struct planet_view {
    m4 world_to_clip;
    v3 eye, ray_origin, ray_dx, ray_dy; /* primary rays of window coordinates */
    v3 axis[3];                         /* the planet's own x, y (pole) and z axes in the world */
    v3 scale;                           /* semi-axes along them */
    float shell;                        /* factor on `scale` for this draw: 1 the ground, more for clouds and air */
    v3 to_sun, sun_rgb;                 /* unit; radiance of white that faces the sun */
    float sun_size, sun_glow;           /* of the disc: cosine of its radius (1: none), radiance relative to sun_rgb */
    float star_gain;
    int show;
    const amb_mesh *sphere;
    const amb_texture *stars;
    const amb_mesh *points; /* stars that are not in `stars`: directions, light as normals; NULL: none */
    v2 size;                /* of the picture, samples */
    float sample_angle;     /* radians from one sample to the next in the middle of the picture */
    float star_radius;      /* samples at which a point has fallen to 1/e */
    int slot[CANVAS_MAX_AOVS];
    int attachments; /* colour and wanted AOVs */
} planet_view;

/* A flight around one body. */
typedef struct planet_flight {
    const amb_camera_key *keys;
    size_t key_count;
    float vertical_fov; /* degrees */
} planet_flight;
extern const planet_flight planet_flight_ball, planet_flight_rings; /* around a planet; around one with rings */

/* What every planet's state starts with. */
typedef struct planet_state {
    const struct planet_body *body;
    amb_mesh *sphere;
    const amb_texture *stars;
    const amb_mesh *points;
} planet_state;

/* Draws of the sky, whose uniforms are a planet_view: a full-screen one, and points over it. */
typedef struct planet_sky {
    amb_draw background, points;
} planet_sky;

/* An asset and where the state keeps it: a const amb_texture *. */
typedef struct planet_map_row {
    const char *asset;
    size_t offset;
} planet_map_row;
/* A map that is made when a planet is loaded and belongs to its state: an amb_texture *, from other members of it. */
typedef struct planet_made_row {
    size_t offset, from;
    size_t alpha;                  /* not 0: colours of `from`, with the first channel of this map in alpha */
    amb_normal_map_options relief; /* alpha 0: a normal map of `from` with these options */
    float slope;                   /* > 0: its strength is such that slopes' root mean square is this */
} planet_made_row;
enum { PLANET_MAX_MAPS = 8, PLANET_MAX_MADE = 3 };

/* A body that scenes draw: its own scene, and the tour. State and parameter structs start with planet_state and
 * planet_params. Everything but `draw` has a default: 0. */
typedef struct planet_body {
    const char *name;
    size_t state_bytes;
    planet_map_row map[PLANET_MAX_MAPS];   /* ends at the first without a name */
    planet_made_row made[PLANET_MAX_MADE]; /* in this order; ends at the first without an offset */
    /* Records everything but the background; `view` is the body's own: it is at the origin, its radius 1. */
    amb_status (*draw)(const void *state, const void *params, const planet_view *view, double time, amb_pass *pass,
                       amb_error *error);
    /* Of its own scene: how to draw the sky, outputs, flight. */
    const planet_sky *sky;
    const amb_aov *aovs;
    size_t aov_count;
    const planet_flight *flight;
} planet_body;

/* Errors: those of assets, MEMORY. */
amb_status planet_load(const planet_body *body, const amb_context *context, amb_assets *assets, void **state,
                       amb_error *error);
void planet_unload(void *state); /* NULL is allowed */

/* Records the sky of a view. */
amb_status planet_sky_draw(amb_pass *pass, const planet_sky *sky, const planet_view *view, amb_error *error);

/* The whole of a one-body scene's frame: canvas, background, the body. */
amb_status planet_frame(const void *state, const amb_scene_job *job, amb_error *error);

/* A normal map (RGBA16F, coded, z out) from level 0 of a texture; alpha holds the height: the first channel, or
 * luminance times alpha. green_up: y is coded northward, as most normal maps in files are; else southward, along v. */
amb_status planet_normal_texture(const amb_context *context, const amb_texture *height,
                                 const amb_normal_map_options *options, bool green_up, amb_texture **out,
                                 amb_error *error);

/* Colours (sRGB8_A8) of one texture, the first channel of another in alpha: one look-up for both. */
amb_status planet_colour_texture(const amb_context *context, const amb_texture *colour, const amb_texture *alpha,
                                 amb_texture **out, amb_error *error);

/* The view of one frame; the camera flies `keys`, over and over from their last time on. */
planet_view planet_view_at(const planet_state *state, const planet_params *params, const amb_scene_job *job,
                           const amb_canvas *canvas, const planet_flight *flight);

/* The same through any camera of the planet's frame. */
planet_view planet_view_of(const planet_state *state, const planet_params *params, double time,
                           const amb_canvas *canvas, const amb_camera *camera);

/* `time` folded into [0, period). */
float planet_loop_time(double time, float period);

#endif
