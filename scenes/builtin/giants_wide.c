/* Jupiter, Saturn, Uranus and Neptune: banded clouds drawn along latitudes, wound up by flows; and the sun's surface.
 * Linear albedos (the sun: relative radiance). */
#include "scenes/builtin/giants.h"
#include "scenes/builtin/planet_noise.h"

v4x WIDE(amb_jupiter_colour)(v3x direction, const void *user);
v4x WIDE(amb_saturn_colour)(v3x direction, const void *user);
v4x WIDE(amb_uranus_colour)(v3x direction, const void *user);
v4x WIDE(amb_neptune_colour)(v3x direction, const void *user);
v4x WIDE(amb_sun_colour)(v3x direction, const void *user);

/* A band table: colours at sines of latitude, joined by smooth steps. */
typedef struct band {
    float latitude;
    v3 colour;
} band;

static v3x bands(const band *table, int count, f32x latitude)
{
    v3x colour = v3x_splat(table[0].colour);
    for (int i = 1; i < count; i++) {
        float width = 0.30f * (table[i].latitude - table[i - 1].latitude);
        float middle = 0.5f * (table[i].latitude + table[i - 1].latitude);
        colour =
            planet_mix(colour, table[i].colour, f_smoothstep(f_set(middle - width), f_set(middle + width), latitude));
    }
    return colour;
}

static const band jupiter_bands[] = {
    {-1.00f, {0.33f, 0.30f, 0.28f}},  {-0.78f, {0.46f, 0.41f, 0.36f}},  {-0.66f, {0.36f, 0.28f, 0.22f}},
    {-0.55f, {0.60f, 0.53f, 0.45f}},  {-0.44f, {0.42f, 0.30f, 0.21f}},  {-0.34f, {0.74f, 0.67f, 0.57f}},
    {-0.20f, {0.40f, 0.20f, 0.105f}}, {-0.10f, {0.58f, 0.40f, 0.26f}},  {0.00f, {0.82f, 0.76f, 0.66f}},
    {0.10f, {0.76f, 0.66f, 0.53f}},   {0.21f, {0.36f, 0.165f, 0.080f}}, {0.31f, {0.72f, 0.62f, 0.50f}},
    {0.43f, {0.50f, 0.38f, 0.28f}},   {0.55f, {0.62f, 0.55f, 0.47f}},   {0.67f, {0.40f, 0.34f, 0.29f}},
    {0.82f, {0.44f, 0.40f, 0.37f}},   {1.00f, {0.30f, 0.28f, 0.27f}},
};

/* The Great Red Spot: place and semi-axes of its oval. */
static const v3 spot_centre = {-0.677f, -0.37f, -0.636f};
static const v2 spot_size = {JUPITER_SPOT_WIDE, JUPITER_SPOT_HIGH};

typedef struct spot_place {
    v3 east, north;
    f32x x, y, r2, front; /* in semi-axes; squared distance; 1 on its side of the planet, else 0 */
} spot_place;

static spot_place spot_at(v3x d)
{
    spot_place at = {.east = v3_normalize(v3_cross((v3){0, 1, 0}, spot_centre))};
    at.north = v3_cross(spot_centre, at.east);
    at.x = v3x_dot(d, v3x_splat(at.east)) * (1.0f / spot_size.x);
    at.y = v3x_dot(d, v3x_splat(at.north)) * (1.0f / spot_size.y);
    at.r2 = at.x * at.x + at.y * at.y;
    at.front = f_sel(v3x_dot(d, v3x_splat(spot_centre)) > 0.0f, f_set(1.0f), f_set(0.0f));
    return at;
}

/* Everything in the spot turns. */
static v3x spot_turn(v3x d, f32x *inside)
{
    spot_place at = spot_at(d);
    *inside = at.front * (1.0f - f_smoothstep(f_set(0.45f), f_set(1.0f), at.r2));
    f32x angle = at.front * f_exp(at.r2 * -1.1f) * 3.4f, s, c;
    f_sincos(angle, &s, &c);
    f32x new_x = (at.x * c - at.y * s) * spot_size.x, new_y = (at.x * s + at.y * c) * spot_size.y;
    v3x moved = v3x_add(v3x_scale(v3x_splat(at.east), new_x), v3x_scale(v3x_splat(at.north), new_y));
    f32x depth = f_sqrt(f_max(1.0f - v3x_dot(moved, moved), f_set(0.0f)));
    moved = v3x_add(moved, v3x_scale(v3x_splat(spot_centre), depth));
    return v3x_sel((at.r2 < 6.0f) & (at.front > 0.5f), moved, d);
}

/* What the clouds' colour is made of. */
typedef struct jupiter_flow {
    f32x north, festoons, threads; /* how far latitudes are wound, as a sine; two noises */
} jupiter_flow;

static jupiter_flow flow_of(v3x d, uint32_t seed)
{
    v3x wound = planet_swirl(planet_swirl(d, 4.5f, 0.030f, seed + 1), 10.0f, 0.014f, seed + 2);
    wound = planet_swirl(planet_swirl(wound, 22.0f, 0.0050f, seed + 3), 45.0f, 0.0018f, seed + 4);
    return (jupiter_flow){
        .north = wound.y - d.y,
        .festoons = planet_fbm((v3x){wound.x * 5.0f, wound.y * 22.0f, wound.z * 5.0f}, seed + 5, 7),
        .threads = planet_fbm((v3x){wound.x * 9.0f, wound.y * 75.0f, wound.z * 9.0f}, seed + 6, 5),
    };
}

v4x WIDE(amb_jupiter_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x inside;
    v3x d = spot_turn(direction, &inside);
    jupiter_flow flow = flow_of(d, 200u);
    f32x y = d.y + flow.north, calm = f_smoothstep(f_set(0.95f), f_set(0.55f), f_abs(y));
    v3x colour =
        bands(jupiter_bands, (int)(sizeof jupiter_bands / sizeof *jupiter_bands), y + flow.festoons * 0.018f * calm);
    colour = v3x_scale(colour, 1.0f + 0.20f * flow.threads + 0.12f * flow.festoons);
    v3x spot = planet_mix(v3x_splat((v3){0.50f, 0.155f, 0.065f}), (v3){0.66f, 0.34f, 0.19f},
                          f_saturate(0.5f + flow.festoons * 1.1f));
    colour = v3x_lerp(colour, spot, inside * 0.9f);
    return v4x_of3(v3x_max(colour, v3x_splat((v3){0, 0, 0})), f_set(1.0f));
}

static const band saturn_bands[] = {
    {-1.00f, {0.36f, 0.33f, 0.26f}}, {-0.80f, {0.52f, 0.44f, 0.30f}}, {-0.60f, {0.60f, 0.49f, 0.32f}},
    {-0.42f, {0.66f, 0.55f, 0.37f}}, {-0.26f, {0.58f, 0.45f, 0.28f}}, {-0.12f, {0.74f, 0.63f, 0.44f}},
    {0.00f, {0.82f, 0.72f, 0.52f}},  {0.14f, {0.70f, 0.57f, 0.38f}},  {0.28f, {0.62f, 0.50f, 0.32f}},
    {0.44f, {0.68f, 0.57f, 0.39f}},  {0.60f, {0.54f, 0.46f, 0.33f}},  {0.78f, {0.46f, 0.42f, 0.33f}},
    {0.90f, {0.34f, 0.34f, 0.29f}},  {1.00f, {0.26f, 0.29f, 0.28f}},
};

v4x WIDE(amb_saturn_colour)(v3x direction, const void *user)
{
    (void)user;
    v3x wound = planet_swirl(planet_swirl(direction, 5.0f, 0.006f, 211), 16.0f, 0.0016f, 212);
    f32x threads = planet_fbm((v3x){wound.x * 1.5f, wound.y * 46.0f, wound.z * 1.5f}, 213, 6);
    f32x haze = planet_fbm((v3x){wound.x * 4.0f, wound.y * 15.0f, wound.z * 4.0f}, 214, 5);
    v3x colour = bands(saturn_bands, (int)(sizeof saturn_bands / sizeof *saturn_bands), wound.y + haze * 0.006f);
    return v4x_of3(v3x_scale(colour, 1.0f + 0.075f * threads + 0.02f * haze), f_set(1.0f));
}

v4x WIDE(amb_uranus_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x threads = planet_fbm((v3x){direction.x * 1.2f, direction.y * 18.0f, direction.z * 1.2f}, 221, 4);
    f32x cap = f_smoothstep(f_set(0.35f), f_set(0.95f), direction.y);
    v3x colour = planet_mix(v3x_splat((v3){0.30f, 0.62f, 0.68f}), (v3){0.56f, 0.78f, 0.78f}, cap);
    return v4x_of3(v3x_scale(colour, 1.0f + 0.018f * threads), f_set(1.0f));
}

v4x WIDE(amb_neptune_colour)(v3x direction, const void *user)
{
    (void)user;
    const v3 spot = {0.42f, -0.36f, -0.833f};
    v3x wound = planet_swirl(planet_swirl(direction, 3.0f, 0.035f, 231), 8.0f, 0.012f, 232);
    f32x broad = planet_fbm((v3x){wound.x * 1.4f, wound.y * 7.0f, wound.z * 1.4f}, 233, 6);
    f32x wisps = planet_fbm((v3x){wound.x * 5.0f, wound.y * 38.0f, wound.z * 5.0f}, 234, 6);
    v3x colour = planet_mix(v3x_splat((v3){0.030f, 0.095f, 0.36f}), (v3){0.085f, 0.24f, 0.62f},
                            f_saturate(0.5f + 0.55f * broad));
    v3 east = v3_normalize(v3_cross((v3){0, 1, 0}, spot)), north = v3_cross(spot, east);
    f32x x = v3x_dot(direction, v3x_splat(east)) * (1.0f / 0.19f);
    f32x y = v3x_dot(direction, v3x_splat(north)) * (1.0f / 0.085f);
    f32x front = f_sel(v3x_dot(direction, v3x_splat(spot)) > 0.0f, f_set(1.0f), f_set(0.0f));
    colour = v3x_scale(colour, 1.0f - 0.55f * front * f_exp(-(x * x + y * y)));
    f32x rim = front * planet_bump(y, -1.25f, 0.30f) * planet_bump(x, 0.2f, 0.9f);
    f32x cirrus = f_smoothstep(f_set(0.42f), f_set(0.95f), wisps) *
                  (planet_bump(direction.y, -0.5f, 0.1f) + planet_bump(direction.y, 0.32f, 0.08f));
    colour = planet_mix(colour, (v3){0.80f, 0.88f, 0.95f}, f_saturate(cirrus * 0.8f + rim * (0.35f + wisps)));
    return v4x_of3(colour, f_set(1.0f));
}

/* Granules over large dim and bright areas, spots with umbra and penumbra in two belts. */
v4x WIDE(amb_sun_colour)(v3x direction, const void *user)
{
    (void)user;
    v3x wound = planet_swirl(planet_swirl(direction, 14.0f, 0.006f, 241), 30.0f, 0.003f, 242);
    f32x cells = planet_fbm(v3x_scale(wound, f_set(42.0f)), 243, 4);
    f32x granules = 1.0f - f_abs(cells) * 1.3f;
    f32x broad = planet_fbm(v3x_scale(planet_swirl(direction, 3.0f, 0.06f, 244), f_set(4.0f)), 245, 6);
    f32x belt = planet_bump(f_abs(direction.y), 0.32f, 0.16f);
    f32x knots = planet_fbm(v3x_scale(planet_swirl(direction, 9.0f, 0.015f, 246), f_set(5.5f)), 247, 5) * belt;
    f32x penumbra = f_smoothstep(f_set(0.34f), f_set(0.42f), knots),
         umbra = f_smoothstep(f_set(0.43f), f_set(0.50f), knots);
    f32x faculae = f_smoothstep(f_set(0.12f), f_set(0.34f), knots) * (1.0f - penumbra);
    f32x heat = 0.62f + 0.22f * granules + 0.22f * broad + 0.30f * faculae;
    heat = f_saturate(heat * (1.0f - 0.45f * penumbra) * (1.0f - 0.75f * umbra));
    v3x colour = planet_mix(v3x_splat((v3){0.55f, 0.085f, 0.006f}), (v3){1.0f, 0.42f, 0.075f},
                            f_smoothstep(f_set(0.1f), f_set(0.6f), heat));
    colour = planet_mix(colour, (v3){1.0f, 0.78f, 0.36f}, f_smoothstep(f_set(0.6f), f_set(1.0f), heat));
    return v4x_of3(v3x_scale(colour, 0.35f + 0.65f * heat), f_set(1.0f));
}
