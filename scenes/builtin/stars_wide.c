#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <ambiance/vec.h>

v4x WIDE(amb_milky_way)(v3x direction, const void *user);

/* The Milky Way: a warped band, brighter and wider toward its centre, cut by dust. */
static v3x milky_way(v3x p)
{
    v3 pole = v3_normalize(v3_of(0.38f, 0.86f, -0.34f)), center = v3_normalize(v3_of(0.55f, -0.52f, -0.70f));
    v3x zero = v3x_splat(v3_of(0.0f, 0.0f, 0.0f));
    f32x latitude = v3x_dot(p, v3x_splat(pole));
    if (!m_any(f_abs(latitude) < 0.75f))
        return zero;
    amb_fbm cloudy = {5, 2.0f, 0.55f}, filaments = {6, 2.0f, 0.6f};
    f32x clouds = fbm3(noise_gradient3, v3x_scale(p, f_set(2.6f)), (amb_lattice){.seed = 71}, cloudy).value;
    f32x dust = fbm3(noise_gradient3, v3x_scale(p, f_set(5.0f)), (amb_lattice){.seed = 73}, filaments).value;
    f32x toward = 0.5f + 0.5f * v3x_dot(p, v3x_splat(center));
    f32x core = toward * toward * toward * toward;
    f32x b = (latitude + clouds * 0.06f) / (0.16f + 0.13f * core);
    f32x band = f_exp(-(b * b)) * (0.30f + 1.15f * core) * f_max(0.75f + 0.9f * clouds, f_set(0.0f));
    f32x lane = (latitude + dust * 0.10f - 0.01f) / 0.075f;
    f32x dark = f_exp(-(lane * lane)) * f_smoothstep(f_set(-0.35f), f_set(0.35f), dust + 0.12f);
    f32x through = 1.0f - 0.88f * dark;
    v3x tint =
        v3x_lerp(v3x_splat(v3_of(0.62f, 0.74f, 1.0f)), v3x_splat(v3_of(1.0f, 0.86f, 0.70f)), f_saturate(core * 1.3f));
    v3x reddened = v3x_of(through, through * (0.75f + 0.25f * through), through * (0.60f + 0.40f * through));
    f32x fades = f_saturate((0.75f - f_abs(latitude)) * 4.0f);
    return v3x_scale(v3x_mul(tint, reddened), band * fades * 0.035f);
}

v4x WIDE(amb_milky_way)(v3x direction, const void *user)
{
    (void)user;
    return v4x_of3(milky_way(direction), f_set(1.0f));
}
