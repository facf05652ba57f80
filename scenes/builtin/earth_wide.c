/* A planet like the Earth: continents, ice, biomes, cities and weather, as maps of colour, height, water, night lights
 * and clouds. All follow from one height function. Colours are linear albedos. */
#include "scenes/builtin/planet_noise.h"

v4x WIDE(amb_earth_colour)(v3x direction, const void *user);
v4x WIDE(amb_earth_height)(v3x direction, const void *user);
v4x WIDE(amb_earth_water)(v3x direction, const void *user);
v4x WIDE(amb_earth_night)(v3x direction, const void *user);
v4x WIDE(amb_earth_clouds)(v3x direction, const void *user);

/* Height over the sea, about -1…1; a third of the sphere is land. */
static f32x land_height(v3x direction)
{
    v3x shaped = planet_swirl(direction, 1.6f, 0.16f, 21);
    f32x plates = noise_gradient3(v3x_scale(shaped, f_set(1.15f)), (amb_lattice){.seed = 4}).value;
    f32x detail = planet_fbm(v3x_scale(planet_swirl(shaped, 5.0f, 0.02f, 22), f_set(2.1f)), 9, 10);
    return plates * 1.15f + detail * 0.80f - 0.10f;
}

/* Ridged mountains where the continents are high: 0…1. */
static f32x mountains(v3x direction, f32x height)
{
    f32x folds = planet_fbm(v3x_scale(direction, f_set(7.0f)), 31, 7);
    f32x ridge = 1.0f - f_abs(folds) * 1.9f;
    return f_saturate(ridge * ridge * ridge) * f_smoothstep(f_set(0.08f), f_set(0.5f), height);
}

typedef struct climate {
    f32x warmth, moisture; /* 0…1 */
} climate;

static climate climate_at(v3x direction, f32x height)
{
    f32x latitude = f_abs(direction.y);
    f32x wander = planet_fbm(v3x_scale(direction, f_set(3.3f)), 41, 5);
    f32x warmth = 1.02f - latitude * latitude * 0.99f - f_max(height, f_set(0.0f)) * 0.35f + wander * 0.09f;
    f32x belts = planet_bump(latitude, 0.0f, 0.24f) * 0.42f - planet_bump(latitude, 0.38f, 0.15f) * 0.26f +
                 planet_bump(latitude, 0.78f, 0.2f) * 0.35f;
    f32x rain = planet_fbm(v3x_scale(planet_swirl(direction, 3.0f, 0.1f, 42), f_set(2.4f)), 43, 6);
    f32x moisture = 0.60f + belts + rain * 0.85f - height * 0.35f;
    return (climate){f_saturate(warmth), f_saturate(moisture)};
}

static v3x land_colour(v3x direction, f32x rocky, climate c)
{
    v3x dry = planet_mix(v3x_splat((v3){0.36f, 0.22f, 0.105f}), (v3){0.52f, 0.40f, 0.235f},
                         0.5f + 0.5f * planet_fbm(v3x_scale(direction, f_set(9.0f)), 51, 5));
    v3x green = planet_mix(v3x_splat((v3){0.12f, 0.15f, 0.045f}), (v3){0.020f, 0.060f, 0.016f},
                           f_smoothstep(f_set(0.45f), f_set(0.9f), c.moisture));
    v3x warm = v3x_lerp(dry, green, f_smoothstep(f_set(0.22f), f_set(0.55f), c.moisture));
    v3x cold = planet_mix(v3x_splat((v3){0.060f, 0.075f, 0.035f}), (v3){0.22f, 0.19f, 0.14f},
                          f_smoothstep(f_set(0.5f), f_set(0.2f), c.warmth));
    v3x colour = v3x_lerp(cold, warm, f_smoothstep(f_set(0.38f), f_set(0.62f), c.warmth));
    f32x grain = planet_fbm(v3x_scale(direction, f_set(34.0f)), 52, 5);
    colour = v3x_scale(colour, f_max(1.0f + 0.42f * grain, f_set(0.3f)));
    return planet_mix(colour, (v3){0.20f, 0.155f, 0.115f}, rocky * 0.7f);
}

/* How much of the ground is under snow or sea ice. */
static f32x ice_cover(v3x direction, f32x height, f32x rocky, climate c)
{
    f32x rough = planet_fbm(v3x_scale(direction, f_set(14.0f)), 61, 5);
    f32x high = rocky * 0.30f;
    f32x on_land = f_smoothstep(f_set(0.27f), f_set(0.13f), c.warmth - high + rough * 0.07f);
    f32x on_sea = f_smoothstep(f_set(0.10f), f_set(0.04f), c.warmth + rough * 0.06f);
    return f_sel(height > 0.0f, on_land, on_sea);
}

v4x WIDE(amb_earth_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x height = land_height(direction);
    f32x rocky = mountains(direction, height);
    climate c = climate_at(direction, height);
    f32x shelf = f_smoothstep(f_set(-0.22f), f_set(0.0f), height);
    v3x sea = planet_mix(v3x_splat((v3){0.0040f, 0.014f, 0.048f}), (v3){0.010f, 0.062f, 0.086f}, shelf * shelf * shelf);
    v3x colour = v3x_lerp(sea, land_colour(direction, rocky, c), f_smoothstep(f_set(-0.004f), f_set(0.006f), height));
    colour = planet_mix(colour, (v3){0.80f, 0.84f, 0.88f}, ice_cover(direction, height, rocky, c));
    return v4x_of3(colour, f_set(1.0f));
}

v4x WIDE(amb_earth_height)(v3x direction, const void *user)
{
    (void)user;
    f32x height = land_height(direction);
    f32x land = f_max(height, f_set(0.0f));
    f32x up = f_saturate(land * 0.30f + mountains(direction, height) * 0.62f);
    return (v4x){up, up, up, f_set(1.0f)};
}

/* 1 on open water, a little on ice, 0 on land. */
v4x WIDE(amb_earth_water)(v3x direction, const void *user)
{
    (void)user;
    f32x height = land_height(direction);
    f32x water = 1.0f - f_smoothstep(f_set(-0.004f), f_set(0.006f), height);
    water = water *
            (1.0f - 0.85f * ice_cover(direction, height, mountains(direction, height), climate_at(direction, height)));
    return (v4x){water, water, water, f_set(1.0f)};
}

/* Cities: bright grains where people would live: low, temperate, not too dry, near coasts. */
v4x WIDE(amb_earth_night)(v3x direction, const void *user)
{
    (void)user;
    f32x height = land_height(direction);
    climate c = climate_at(direction, height);
    f32x land = f_smoothstep(f_set(0.0f), f_set(0.012f), height);
    f32x coast = f_exp(f_max(height, f_set(0.0f)) * -9.0f);
    f32x mild =
        f_smoothstep(f_set(0.30f), f_set(0.55f), c.warmth) * f_smoothstep(f_set(0.12f), f_set(0.4f), c.moisture);
    f32x settled = f_smoothstep(f_set(-0.25f), f_set(0.75f), planet_fbm(v3x_scale(direction, f_set(5.0f)), 71, 4));
    f32x people = land * mild * (0.12f + 0.88f * coast) * settled;
    f32x towns = noise_value3(v3x_scale(direction, f_set(95.0f)), (amb_lattice){.seed = 72}).value;
    f32x grains = noise_value3(v3x_scale(direction, f_set(260.0f)), (amb_lattice){.seed = 73}).value;
    f32x bright = f_smoothstep(1.0f - people * 1.25f, f_set(1.05f), towns * 0.5f + 0.5f);
    f32x fine = f_smoothstep(1.0f - people * 0.95f, f_set(1.0f), grains * 0.5f + 0.5f);
    f32x light = bright * (0.55f + 0.45f * grains) + fine * 0.35f;
    v3x colour = v3x_scale(v3x_splat((v3){1.0f, 0.66f, 0.30f}), f_max(light, f_set(0.0f)));
    return v4x_of3(colour, f_set(1.0f));
}

/* Storms wind up what is around them, counter-clockwise in the north as seen from above. */
static v3x cyclones(v3x d)
{
    enum { STORMS = 16 };
    for (uint32_t i = 0; i < STORMS; i++) {
        float turn = amb_unit(amb_hash(i * 4u + 801u)) * AMB_TWO_PI, north = i & 1u ? 1.0f : -1.0f;
        float sine = north * (0.42f + 0.42f * amb_unit(amb_hash(i * 4u + 802u)));
        float cosine = __builtin_sqrtf(1.0f - sine * sine), size = 0.07f + 0.11f * amb_unit(amb_hash(i * 4u + 803u));
        v3 eye = {cosine * amb_sin(turn), sine, cosine * amb_cos(turn)};
        f32x apart = 1.0f - v3x_dot(d, v3x_splat(eye)); /* half the squared chord */
        maskx near = apart < 5.0f * size * size;        /* elsewhere it would turn by under a thousandth of a radian */
        if (!m_any(near))
            continue;
        f32x angle = f_sel(near, f_exp(apart * (-2.0f / (size * size))) * (north * 3.0f), f_set(0.0f)), s, c;
        f_sincos(angle, &s, &c);
        v3x across = v3x_cross(v3x_splat(eye), d);
        v3x along = v3x_scale(v3x_splat(eye), v3x_dot(d, v3x_splat(eye)) * (1.0f - c));
        d = v3x_add(v3x_add(v3x_scale(d, c), v3x_scale(across, s)), along);
    }
    return d;
}

/* Cover 0…1 in every channel: fronts wound up by storms, ragged at their edges; thin cirrus; fair-weather cumulus. */
v4x WIDE(amb_earth_clouds)(v3x direction, const void *user)
{
    (void)user;
    f32x latitude = f_abs(direction.y);
    v3x wound = planet_swirl(planet_swirl(cyclones(direction), 2.4f, 0.11f, 81), 5.5f, 0.035f, 82);
    wound = planet_swirl(planet_swirl(wound, 13.0f, 0.010f, 83), 31.0f, 0.0032f, 86);
    f32x fronts = planet_fbm((v3x){wound.x * 3.0f, wound.y * 5.0f, wound.z * 3.0f}, 84, 7);
    f32x belts = planet_bump(direction.y, 0.06f, 0.10f) * 0.24f - planet_bump(latitude, 0.36f, 0.14f) * 0.26f +
                 planet_bump(latitude, 0.74f, 0.20f) * 0.20f;
    f32x weather = fronts + belts;
    f32x ragged = planet_fbm(v3x_scale(wound, f_set(19.0f)), 85, 7);
    f32x puffs = planet_fbm(v3x_scale(planet_swirl(direction, 9.0f, 0.02f, 88), f_set(58.0f)), 87, 4);
    f32x thick = f_smoothstep(f_set(0.08f), f_set(0.66f), weather + 0.34f * ragged + 0.10f * puffs);
    f32x cirrus = f_smoothstep(f_set(-0.25f), f_set(0.45f), weather) * f_smoothstep(f_set(-0.3f), f_set(1.1f), ragged);
    f32x cumulus = f_smoothstep(f_set(0.30f), f_set(1.0f), puffs + 0.7f * ragged + 0.45f * weather);
    f32x all = f_saturate(thick + 0.42f * cirrus * (1.0f - thick) + 0.55f * cumulus * (1.0f - thick));
    return (v4x){all, all, all, all};
}
