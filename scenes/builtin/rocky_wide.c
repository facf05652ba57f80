/* Venus, its ground, Mars and Pluto in colour; Mars in height, Pluto's ice in gloss. Linear albedos. */
#include "scenes/builtin/planet_noise.h"

v4x WIDE(amb_venus_colour)(v3x direction, const void *user);
v4x WIDE(amb_venus_surface)(v3x direction, const void *user);
v4x WIDE(amb_mars_colour)(v3x direction, const void *user);
v4x WIDE(amb_mars_height)(v3x direction, const void *user);
v4x WIDE(amb_pluto_colour)(v3x direction, const void *user);
v4x WIDE(amb_pluto_gloss)(v3x direction, const void *user);

/* Cloud decks in chevrons: streaks swept back from the equator by a wind that is fastest there. */
v4x WIDE(amb_venus_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x latitude = direction.y;
    f32x sweep = latitude * latitude * 1.7f; /* radians that the clouds lag behind the equator's */
    f32x s, c;
    f_sincos(sweep, &s, &c);
    v3x swept = {direction.x * c - direction.z * s, latitude, direction.x * s + direction.z * c};
    swept = planet_swirl(planet_swirl(swept, 2.0f, 0.10f, 101), 6.0f, 0.02f, 102);
    f32x decks = planet_fbm((v3x){swept.x * 1.7f, swept.y * 6.5f, swept.z * 1.7f}, 103, 8);
    f32x fine = planet_fbm((v3x){swept.x * 6.0f, swept.y * 21.0f, swept.z * 6.0f}, 104, 6);
    f32x bright = f_saturate(0.55f + decks * 0.42f + fine * 0.10f + latitude * latitude * 0.18f);
    v3x colour = planet_mix(v3x_splat((v3){0.46f, 0.27f, 0.095f}), (v3){0.86f, 0.70f, 0.42f}, bright);
    return v4x_of3(colour, f_set(1.0f));
}

/* Highlands of bright ridges in dark plains of lava. */
v4x WIDE(amb_venus_surface)(v3x direction, const void *user)
{
    (void)user;
    v3x bent = planet_swirl(planet_swirl(direction, 2.0f, 0.10f, 105), 7.0f, 0.02f, 106);
    f32x high = f_smoothstep(f_set(-0.1f), f_set(0.6f), planet_fbm(v3x_scale(bent, f_set(1.7f)), 107, 8));
    f32x folds = 1.0f - f_abs(planet_fbm(v3x_scale(bent, f_set(8.0f)), 108, 7)) * 1.6f;
    f32x bright = f_saturate(0.22f + 0.35f * high + 0.45f * high * f_max(folds, f_set(0.0f)));
    v3x colour = planet_mix(v3x_splat((v3){0.16f, 0.055f, 0.010f}), (v3){0.80f, 0.52f, 0.20f}, bright);
    return v4x_of3(colour, f_set(1.0f));
}

/* Plains, highlands full of craters, clefts. */
static f32x mars_height(v3x direction)
{
    v3x bent = planet_swirl(direction, 1.8f, 0.12f, 111);
    f32x broad = planet_fbm(v3x_scale(bent, f_set(1.4f)), 112, 9);
    f32x folds = planet_fbm(v3x_scale(bent, f_set(3.4f)), 113, 8);
    f32x canyon = 1.0f - f_saturate(f_abs(folds + 0.12f) * 14.0f); /* long winding clefts near one contour */
    f32x cleft = canyon * f_smoothstep(f_set(0.05f), f_set(0.35f), broad) * planet_bump(direction.y, -0.1f, 0.3f);
    f32x rough = planet_fbm(v3x_scale(direction, f_set(16.0f)), 114, 7);
    f32x old = f_smoothstep(f_set(-0.2f), f_set(0.35f), broad - direction.y * 0.35f);
    f32x craters = 0.050f * planet_craters(v3x_scale(direction, f_set(7.0f)), 115) +
                   0.026f * planet_craters(v3x_scale(direction, f_set(19.0f)), 116);
    return f_saturate(0.5f + broad * 0.22f + folds * 0.06f + rough * 0.035f - cleft * 0.22f + craters * old);
}

v4x WIDE(amb_mars_height)(v3x direction, const void *user)
{
    (void)user;
    f32x height = mars_height(direction);
    return (v4x){height, height, height, f_set(1.0f)};
}

v4x WIDE(amb_mars_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x height = mars_height(direction);
    v3x bent = planet_swirl(planet_swirl(direction, 2.3f, 0.14f, 121), 6.0f, 0.03f, 122);
    f32x basalt = planet_fbm((v3x){bent.x * 2.0f, bent.y * 3.2f, bent.z * 2.0f}, 123, 9);
    f32x streaks = planet_fbm((v3x){bent.x * 9.0f, bent.y * 13.0f, bent.z * 9.0f}, 124, 6);
    f32x dark = f_smoothstep(f_set(0.0f), f_set(0.42f), basalt + streaks * 0.22f - (height - 0.5f) * 0.9f);
    v3x dust = planet_mix(v3x_splat((v3){0.36f, 0.105f, 0.034f}), (v3){0.58f, 0.235f, 0.090f},
                          f_saturate(0.5f + streaks * 0.40f + (height - 0.5f) * 2.4f));
    v3x colour = planet_mix(dust, (v3){0.095f, 0.042f, 0.028f}, dark * 0.85f);
    f32x edge = planet_fbm(v3x_scale(direction, f_set(7.0f)), 125, 6) * 0.035f;
    f32x north = f_smoothstep(f_set(0.905f), f_set(0.93f), direction.y + edge);
    f32x south = f_smoothstep(f_set(0.945f), f_set(0.965f), -direction.y + edge);
    colour = planet_mix(colour, (v3){0.82f, 0.80f, 0.78f}, f_max(north, south));
    return v4x_of3(colour, f_set(1.0f));
}

/* A bright heart of nitrogen ice, dark tholin lowlands along the equator, tan highlands. */
static f32x pluto_ice(v3x direction)
{
    const v3 heart = {0.46f, 0.16f, -0.873f};
    f32x near = v3x_dot(direction, v3x_splat(heart));
    f32x edge = planet_fbm(v3x_scale(direction, f_set(3.5f)), 131, 7) * 0.10f;
    f32x lobe = f_smoothstep(f_set(0.80f), f_set(0.86f), near + edge);
    f32x frost = f_smoothstep(f_set(0.80f), f_set(0.93f), direction.y + edge);
    return f_max(lobe, frost * 0.8f);
}

v4x WIDE(amb_pluto_gloss)(v3x direction, const void *user)
{
    (void)user;
    f32x gloss = 0.10f + 0.75f * pluto_ice(direction);
    return (v4x){gloss, gloss, gloss, f_set(1.0f)};
}

v4x WIDE(amb_pluto_colour)(v3x direction, const void *user)
{
    (void)user;
    f32x broad = planet_fbm(v3x_scale(planet_swirl(direction, 2.0f, 0.1f, 132), f_set(1.9f)), 133, 9);
    f32x pits = planet_craters(v3x_scale(direction, f_set(8.0f)), 135) +
                0.6f * planet_craters(v3x_scale(direction, f_set(21.0f)), 136);
    f32x fine = planet_fbm(v3x_scale(direction, f_set(11.0f)), 134, 7) + pits * 0.32f * (1.0f - pluto_ice(direction));
    f32x tholin =
        f_smoothstep(f_set(0.05f), f_set(0.35f), broad + planet_bump(direction.y, -0.12f, 0.3f) * 0.34f - 0.10f);
    v3x high = planet_mix(v3x_splat((v3){0.40f, 0.30f, 0.21f}), (v3){0.62f, 0.54f, 0.44f},
                          f_saturate(0.5f + 0.5f * fine + broad * 0.3f));
    v3x colour = planet_mix(high, (v3){0.085f, 0.040f, 0.024f}, f_saturate(tholin * (0.80f + 0.25f * fine)));
    v3x ice = planet_mix(v3x_splat((v3){0.74f, 0.68f, 0.58f}), (v3){0.88f, 0.86f, 0.81f}, f_saturate(0.5f + fine));
    return v4x_of3(v3x_lerp(colour, ice, pluto_ice(direction)), f_set(1.0f));
}
