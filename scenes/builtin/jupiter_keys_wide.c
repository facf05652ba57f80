/* Jupiter's key frames: the still map carried along by its jets. */
#include "scenes/builtin/giants.h"
#include "scenes/builtin/planet_noise.h"

v4x WIDE(amb_jupiter_key)(v3x direction, const void *user);
v4x WIDE(amb_jupiter_velocity)(v3x direction, const void *user);

/* How much of a place belongs to the Great Red Spot and its hollow, which rest: 1 inside, 0 outside. */
static f32x rests(v3x direction, v3 spot)
{
    v3 east = v3_normalize(v3_cross((v3){0, 1, 0}, spot)), north = v3_cross(spot, east);
    f32x x = v3x_dot(direction, v3x_splat(east)) * (1.0f / JUPITER_SPOT_WIDE);
    f32x y = v3x_dot(direction, v3x_splat(north)) * (1.0f / JUPITER_SPOT_HIGH);
    f32x near = 1.0f - f_smoothstep(f_set(1.0f), f_set(3.5f), x * x + y * y);
    return f_sel(v3x_dot(direction, v3x_splat(spot)) > 0.0f, near, f_set(0.0f));
}

/* Angular speed of the jets, radians a key frame, eastward: belts and zones shear past each other, and come to rest
 * around the spot. */
static f32x jet_speed(v3x direction, v3 spot)
{
    f32x latitude = direction.y, sine, cosine;
    f_sincos(latitude * 15.0f, &sine, &cosine);
    f32x jets = planet_bump(latitude, 0.0f, 0.12f) + 0.5f * cosine * (1.0f - f_abs(latitude));
    return JUPITER_KEY_DRIFT * jets * (1.0f - rests(direction, spot));
}

/* 128 of 255 is still, and 127 steps are twice the drift: what the scene reads it with. */
v4x WIDE(amb_jupiter_velocity)(v3x direction, const void *user)
{
    const jupiter_still *still = user;
    f32x speed = jet_speed(direction, still->spot) * (1.0f / (2.0f * JUPITER_KEY_DRIFT));
    f32x v = (128.0f + 127.0f * speed) * (1.0f / 255.0f);
    return (v4x){v, v, v, f_set(1.0f)};
}

/* The map without its zonal mean. */
static v3x details_at(const jupiter_still *still, v3x direction)
{
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    v2x uv = {0.5f + f_atan2(direction.x, -direction.z) * (0.5f * AMB_INV_PI),
              f_acos(f_clamp(direction.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI};
    v2x at_mean = {f_set(0.5f), uv.y};
    return v3x_sub(v4x_xyz(amb_sample_2d_lod(still->map, &sampler, uv, f_set(0.0f))),
                   v4x_xyz(amb_sample_2d_lod(still->zonal, &sampler, at_mean, f_set(0.0f))));
}

/* Turned about the poles: what lies west by an angle. */
static v3x west_of(v3x d, f32x radians)
{
    f32x s, c;
    f_sincos(radians, &s, &c);
    return (v3x){d.x * c + d.z * s, d.y, d.z * c - d.x * s};
}

/* Two sets of details, from here and from the other side of the planet, each carried along by the jets over
 * JUPITER_KEYS key frames and then begun anew while it is not seen: the last key leads on to the first without a step
 * back (N. Max and B. Becker, "Flow Visualization Using Moving Textures", 1995). The squares of their weights sum to 1,
 * so that contrast stays. The spot is left out of both and stays where it is. Key 0 is the still map. */
v4x WIDE(amb_jupiter_key)(v3x direction, const void *user)
{
    const jupiter_still *still = user;
    f32x speed = jet_speed(direction, still->spot);
    v3x details = v3x_scale(details_at(still, direction), rests(direction, still->spot));
    float weight[2], age[2];
    for (int i = 0; i < 2; i++) {
        age[i] = still->key + 0.5f * JUPITER_KEYS * (float)(1 - i);
        age[i] -= age[i] >= JUPITER_KEYS ? (float)JUPITER_KEYS : 0.0f;
        weight[i] = age[i] < 0.5f * JUPITER_KEYS ? age[i] : JUPITER_KEYS - age[i];
    }
    float length = __builtin_sqrtf(weight[0] * weight[0] + weight[1] * weight[1]);
    for (int i = 0; i < 2; i++) {
        v3x from = west_of(direction, speed * (age[i] - 0.5f * JUPITER_KEYS) + (float)i * AMB_PI);
        f32x share = (1.0f - rests(from, still->spot)) * (weight[i] / length);
        details = v3x_add(details, v3x_scale(details_at(still, from), share));
    }
    v2x here = {f_set(0.5f), f_acos(f_clamp(direction.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI};
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    v3x mean = v4x_xyz(amb_sample_2d_lod(still->zonal, &sampler, here, f_set(0.0f)));
    return v4x_of3(v3x_max(v3x_add(mean, details), v3x_splat((v3){0, 0, 0})), f_set(1.0f));
}
