/* An evening sky over a calm sea as an HDR environment: a low sun with its glow, a warm horizon, high clouds lit from
 * below, and water that mirrors it all. Colours are tuned by eye to photographs of clear evenings with the sun about
 * seven degrees up; nothing here claims to be a sky model. */
#include "scenes/builtin/paint.h"

#include <ambiance/math.h>
#include <ambiance/noise.h>

v4x WIDE(amb_sky_radiance)(v3x direction, const void *user);

static const v3 to_sun = {-0.5906f, 0.1219f, -0.7977f}; /* unit: azimuth to the left of -z, 7° up */

/* Σ 2⁻ⁱ⁻¹ noise(2ⁱ p) over `count` octaves, about -1…1; *rough, when wanted, is the sum of the first `rough_count`. */
static f32x octaves(v2x p, int count, int rough_count, f32x *rough)
{
    f32x sum = f_set(0.0f);
    float weight = 0.5f;
    for (int i = 0; i < count; i++, weight *= 0.5f) {
        if (i == rough_count)
            *rough = sum;
        sum += weight * noise_gradient2(p, (amb_lattice){.seed = 7}).value;
        p = v2x_add(v2x_scale(p, f_set(2.03f)), v2x_splat((v2){17.1f, 31.7f}));
    }
    return sum;
}

/* The clear sky: deep blue overhead, warm toward the sun, rose against it. */
static v3x clear_sky(v3x direction, f32x sun_cosine)
{
    f32x up = f_max(direction.y, f_set(0.0f));
    f32x toward = 0.5f + 0.5f * sun_cosine;
    f32x horizon = f_exp(up * -7.0f), middle = f_exp(up * -2.4f);
    v3x zenith = v3x_splat((v3){0.055f, 0.13f, 0.34f});
    v3x pale = v3x_lerp(v3x_splat((v3){0.20f, 0.29f, 0.50f}), v3x_splat((v3){0.46f, 0.46f, 0.52f}), toward * toward);
    v3x low =
        v3x_lerp(v3x_splat((v3){0.36f, 0.28f, 0.36f}), v3x_splat((v3){1.45f, 0.72f, 0.27f}), toward * toward * toward);
    return v3x_lerp(v3x_lerp(zenith, pale, middle), low, horizon);
}

/* Light scattered around the sun, and its disc (softened over a degree so that half floats and mips hold it). */
static v3x sun_light(f32x sun_cosine, bool disc)
{
    f32x c = f_max(sun_cosine, f_set(0.0f));
    f32x wide = f_pow(c, f_set(6.0f)), narrow = f_pow(c, f_set(64.0f)), tight = f_pow(c, f_set(900.0f));
    v3x light = v3x_scale(v3x_splat((v3){0.55f, 0.27f, 0.09f}), wide);
    light = v3x_add(light, v3x_scale(v3x_splat((v3){1.9f, 1.05f, 0.42f}), narrow));
    light = v3x_add(light, v3x_scale(v3x_splat((v3){14.0f, 8.6f, 4.0f}), tight));
    if (!disc)
        return light;
    f32x inside = f_smoothstep(f_set(0.99978f), f_set(0.99992f), sun_cosine); /* radius about 1° */
    return v3x_add(light, v3x_scale(v3x_splat((v3){2600.0f, 1750.0f, 900.0f}), inside));
}

/* Cloud cover 0…1 of the layer seen along a direction, and how much thicker it is toward the sun. */
static f32x cloud_cover(v3x direction, f32x *shade)
{
    f32x reach = 1.0f / (f_max(direction.y, f_set(0.0f)) + 0.11f);
    v2x at = {direction.x * reach * 0.75f, direction.z * reach * 1.25f};
    v2x nearer = v2x_add(at, v2x_splat((v2){-0.13f, -0.17f}));
    f32x rough;
    f32x here = octaves(at, 6, 4, &rough);
    *shade = f_saturate(0.5f + 1.6f * (octaves(nearer, 4, -1, NULL) - rough));
    f32x banks = octaves(v2x_scale(at, f_set(0.31f)), 3, -1, NULL); /* where the clouds gather */
    f32x cover = f_smoothstep(f_set(-0.04f), f_set(0.38f), here + 0.45f * banks);
    return cover * f_smoothstep(f_set(0.015f), f_set(0.14f), direction.y);
}

static v3x sky_above(v3x direction, bool disc)
{
    f32x sun_cosine = v3x_dot(direction, v3x_splat(to_sun));
    f32x shade;
    f32x cover = cloud_cover(direction, &shade);
    f32x toward = 0.5f + 0.5f * sun_cosine;
    v3x lit = v3x_lerp(v3x_splat((v3){0.62f, 0.48f, 0.50f}), v3x_splat((v3){1.75f, 1.05f, 0.60f}), toward * toward);
    v3x dark = v3x_lerp(v3x_splat((v3){0.14f, 0.16f, 0.25f}), v3x_splat((v3){0.36f, 0.25f, 0.26f}), toward);
    v3x cloud = v3x_lerp(lit, dark, shade * (0.35f + 0.65f * cover));
    f32x lining = f_pow(f_max(sun_cosine, f_set(0.0f)), f_set(40.0f)) * (1.0f - cover) * 3.0f;
    cloud = v3x_add(cloud, v3x_scale(v3x_splat((v3){1.6f, 1.0f, 0.55f}), lining));
    f32x veil = cover * 0.88f;
    v3x behind = v3x_add(clear_sky(direction, sun_cosine), sun_light(sun_cosine, disc));
    return v3x_lerp(behind, cloud, veil);
}

/* Water: the sky mirrored in a surface of small waves, over a dark body, fading into haze at the horizon. */
static v3x sea_below(v3x direction)
{
    f32x down = f_max(-direction.y, f_set(1.0e-3f));
    f32x distance = 1.0f / down;
    v2x at = {direction.x * distance * 2.6f, direction.z * distance * 2.6f};
    f32x calm = 0.16f / (1.0f + 0.035f * distance * distance); /* far waves are smaller than a texel */
    v2x elsewhere = v2x_add(at, v2x_splat((v2){41.0f, 13.0f}));
    v3x normal = {calm * octaves(at, 4, -1, NULL), f_set(1.0f), calm * octaves(elsewhere, 4, -1, NULL)};
    normal = v3x_normalize(normal);
    v3x mirrored = v3x_reflect(direction, normal);
    mirrored.y = f_abs(mirrored.y);
    mirrored = v3x_normalize(mirrored);
    f32x facing = f_saturate(-v3x_dot(direction, normal));
    f32x away = 1.0f - facing, away2 = away * away;
    f32x fresnel = 0.02f + 0.98f * away2 * away2 * away; /* Schlick 1994, water */
    v3x deep = v3x_splat((v3){0.012f, 0.030f, 0.040f});
    v3x water = v3x_lerp(deep, sky_above(mirrored, false), fresnel);
    f32x sparkle = f_pow(f_max(v3x_dot(mirrored, v3x_splat(to_sun)), f_set(0.0f)), f_set(420.0f));
    water = v3x_add(water, v3x_scale(v3x_splat((v3){42.0f, 26.0f, 12.0f}), sparkle * fresnel));
    v3x level = v3x_normalize((v3x){direction.x, f_set(0.004f), direction.z});
    f32x haze = f_exp(down * -26.0f);
    f32x level_cosine = v3x_dot(level, v3x_splat(to_sun));
    v3x horizon = v3x_add(clear_sky(level, level_cosine), sun_light(level_cosine, false));
    return v3x_lerp(water, horizon, haze);
}

v4x WIDE(amb_sky_radiance)(v3x direction, const void *user)
{
    (void)user;
    maskx above = direction.y > 0.0f;
    v3x radiance = v3x_splat((v3){0, 0, 0});
    if (m_any(above))
        radiance = sky_above(direction, true);
    if (!m_all(above))
        radiance = v3x_sel(above, radiance, sea_below(direction));
    return v4x_of3(radiance, f_set(1.0f));
}
