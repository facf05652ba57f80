/* Scene hillscape: its parameters and outputs. */
#include "scenes/hillscape.h"

#define AT(field) offsetof(hill_params, field)
/* clang-format off */
#define FLOAT(name, unit, low, high, value, doc) {#name, AMB_PARAM_FLOAT, unit, low, high, {value}, NULL, AT(name), doc}
#define INT(name, unit, low, high, value, doc) {#name, AMB_PARAM_INT, unit, low, high, {value}, NULL, AT(name), doc}
#define BOOL(name, value, doc) {#name, AMB_PARAM_BOOL, "", 0, 0, {value}, NULL, AT(name), doc}
#define VEC3(name, unit, low, high, x, y, z, doc) \
    {#name, AMB_PARAM_VEC3, unit, low, high, {x, y, z}, NULL, AT(name), doc}
#define COLOR(name, r, g, b, doc) {#name, AMB_PARAM_COLOR, "", 0, 100000, {r, g, b}, NULL, AT(name), doc}
#define CHOICE(name, value, names, doc) {#name, AMB_PARAM_CHOICE, "", 0, 0, {value}, names, AT(name), doc}

static const char *const partitionings[] = {"integer", "odd", "even", NULL};
static const char *const wave_kinds[] = {"sines", "noise", NULL};
static const char *const brdfs[] = {"blinn-phong", "cook-torrance", NULL};
static const char *const sample_counts[] = {"1", "2", "4", "8", NULL};

const amb_param hill_param_rows[HILL_PARAM_COUNT] = {
    BOOL(terrain, 1, "draw the hills"),
    BOOL(water, 1, "draw the water"),
    BOOL(sphere, 1, "draw the moving sphere"),
    BOOL(trees, 1, "draw the trees"),
    BOOL(grass, 1, "draw the grass near the eye"),
    BOOL(particles, 1, "draw the fire's flames, sparks and smoke"),
    FLOAT(relief, "m", 0, 2000, 300, "height of a height map value of 1"),
    FLOAT(snow_line, "m", -1000, 3000, 118, "height above which snow lies"),
    FLOAT(tess_min, "", 1, 64, 2, "least tessellation factor"),
    FLOAT(tess_max, "", 1, 64, 10, "most; the factor is 64 - distance/8 between them"),
    CHOICE(partitioning, 2, partitionings, "how patches are divided: whole steps, or continuous in odd or even ones"),
    FLOAT(wave_height, "m", 0, 20, 0.07f, "height of the main wave"),
    FLOAT(wave_frequency, "rad/m", 0.001f, 20, 0.55f, "of the main wave"),
    FLOAT(wave_speed, "rad/s", -100, 100, 1.1f, "of the main wave"),
    CHOICE(waves, WAVES_OF_SINES, wave_kinds, "what makes the water's height"),
    INT(wave_count, "", 1, WAVES_SINES, WAVES_SINES, "how many sines, or octaves of noise (up to 6); 1: the coursework's wave alone"),
    BOOL(mirror, 1, "let the water mirror the scene, not only the sky"),
    CHOICE(brdf, BRDF_COOK_TORRANCE, brdfs, "the model of highlights"),
    BOOL(sun, 1, "the sun, a directional light"),
    BOOL(sun_shadow, 1, "let it cast shadows"),
    FLOAT(sun_azimuth, "degrees", -360, 360, 228, "where the sun is: 0 north (-z), 90 east"),
    FLOAT(sun_elevation, "degrees", -90, 90, 28, "its height over the horizon"),
    FLOAT(day, "s", 0, 1.0e6f, 0, "time of one turn of the sun's azimuth; 0: it stands still"),
    FLOAT(turbidity, "", 1.7f, 10, 2.0f, "haziness of the sky: 1.7 pure air, 10 thick haze"),
    COLOR(sun_color, 1.08f, 1, 0.88f, "factor on its light"),
    BOOL(fill, 1, "a second directional light"),
    BOOL(fill_shadow, 1, "let it cast shadows"),
    VEC3(fill_direction, "", -1, 1, 0.5f, 0.55f, 0.67f, "towards it; any length above 0"),
    COLOR(fill_color, 0.012f, 0.015f, 0.022f, "radiance of a white surface that faces it"),
    BOOL(point, 1, "a point light: the camp fire"),
    BOOL(point_shadow, 1, "let it cast shadows"),
    VEC3(point_position, "m", -10000, 10000, 330, 1.6f, 210, "where it is, y above the ground"),
    COLOR(point_color, 14, 6.4f, 2, "radiance of a white surface that faces it, at 1 m"),
    FLOAT(point_reach, "m", 0.01f, 10000, 90, "its light ends there"),
    BOOL(spot, 1, "a spot light"),
    BOOL(spot_shadow, 1, "let it cast shadows"),
    VEC3(spot_position, "m", -10000, 10000, 268, 24, 4, "where it is, y above the ground"),
    VEC3(spot_target, "m", -10000, 10000, 334, 0, 190, "what it shines at, y above the ground"),
    COLOR(spot_color, 80, 90, 112, "radiance of a white surface that faces it, at 1 m"),
    FLOAT(spot_reach, "m", 0.01f, 10000, 420, "its light ends there"),
    FLOAT(spot_angle, "degrees", 1, 85, 14, "from its axis to where its light ends"),
    INT(shadow_size, "texels", 64, 8192, 2048, "side of the sun's shadow maps, at most; small pictures take smaller ones, other lights half"),
    INT(shadow_taps, "", 1, 7, 2, "comparisons along a side of the shadows' filter"),
    FLOAT(sphere_radius, "m", 0.01f, 1000, 9, "of the moving sphere"),
    FLOAT(sphere_speed, "degrees/s", -3600, 3600, 4, "around its circle over the fjord"),
    FLOAT(clouds, "", 0, 1, 0.6f, "cover of the sky"),
    FLOAT(haze, "", 0, 100, 1, "factor on the haze's density"),
    FLOAT(exposure, "", 0, 100, 1, "factor on all light but the colours given here"),
    BOOL(wireframe, 0, "draw triangles as lines"),
    CHOICE(samples, 2, sample_counts, "coverage samples a pixel; outputs besides color are at pixel centres"),
    BOOL(bloom, 1, "the coursework's bloom"),
    BOOL(brightpass, 0, "show what is bright enough for it, alone"),
    FLOAT(bloom_sensitivity, "", 0, 65504, 1.0f, "luminance from which light blooms"),
    FLOAT(bloom_intensity, "", 0, 100, 0.35f, "strength of the bloom"),
};
/* clang-format on */

const amb_aov hill_aovs[HILL_AOVS] = {
    {"depth", 1, "0 near plane ... 1 far plane"},
    {"position", 3, "world position, m"},
    {"normal", 3, "world normal, unit, relief of the ground included"},
    {"albedo", 3, "linear albedo"},
    {"id", 1, "1 ground, 2 water, 3 sphere, 4 tree, 5 grass, 0 sky"},
    {"shadow", 4, "what of sun, fill, point and spot light is not shadowed, 0 ... 1"},
    {"weights", 4, "share of sand, grass, rock and snow"},
    {"tessellation", 1, "edge factor of the patch, 1 ... 64"},
    {"roughness", 1, "RMS slope of microfacets, 0 ... 1"},
    {"ambient", 3, "light of the sky before the albedo"},
    {"haze", 1, "what the air leaves of the light behind it, 0 ... 1"},
    {"reflection", 3, "what water and sphere mirror, times its Fresnel term"},
};

/* From the meadow along the beach, over the fjord, up to the mountain and around the island's west. */
const amb_camera_key hill_flight[HILL_FLIGHT_KEYS] = {
    {0.0f, {337.0f, 9.0f, 238.0f}, {236.0f, 19.0f, 24.0f}, {0, 1, 0}},
    {15.0f, {312.0f, 4.0f, 190.0f}, {196.0f, 24.0f, -6.0f}, {0, 1, 0}},
    {30.0f, {225.0f, 7.0f, 110.0f}, {60.0f, 60.0f, -220.0f}, {0, 1, 0}},
    {45.0f, {20.0f, 90.0f, -60.0f}, {-330.0f, 110.0f, -330.0f}, {0, 1, 0}},
    {60.0f, {-190.0f, 165.0f, 0.0f}, {160.0f, 20.0f, 170.0f}, {0, 1, 0}},
    {75.0f, {60.0f, 60.0f, 420.0f}, {260.0f, 20.0f, 120.0f}, {0, 1, 0}},
    {90.0f, {337.0f, 9.0f, 238.0f}, {236.0f, 19.0f, 24.0f}, {0, 1, 0}},
};
