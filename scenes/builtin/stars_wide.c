#include "scenes/builtin/stars.h"

#include <ambiance/half.h>
#include <ambiance/math.h>
#include <ambiance/noise.h>

typedef struct row_frame {
    float sine, cosine, per_texel; /* of the polar angle; longitude a texel */
} row_frame;

/* The panorama's middle is -z, its right quarter +x. */
AMB_INLINE v3x direction_at(const row_frame *row, int x)
{
    f32x longitude = (i_to_f(i_lane_index() + x) + 0.5f) * row->per_texel, s, c;
    f_sincos(longitude, &s, &c);
    return v3x_of(-s * row->sine, f_set(row->cosine), c * row->sine);
}

/* The Milky Way: a warped band, brighter and wider toward its centre, cut by dust. */
AMB_INLINE v3x milky_way(v3x p)
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
        v3x_lerp(v3x_splat(v3_of(0.62f, 0.74f, 1.0f)), v3x_splat(v3_of(1.0f, 0.80f, 0.56f)), f_saturate(core * 1.3f));
    v3x reddened = v3x_of(through, through * (0.55f + 0.45f * through), through * (0.30f + 0.70f * through));
    f32x fades = f_saturate((0.75f - f_abs(latitude)) * 4.0f);
    return v3x_scale(v3x_mul(tint, reddened), band * fades * 0.10f);
}

/* Adds a Gaussian spot where it is above 1e-4 of its middle. */
static void star_span(const amb_star_map *map, const amb_star *s, const row_frame *row, int from, int to, float *rgb)
{
    int apart = map->width + 32;
    float scale = -1.0f / (map->blur * map->blur);
    for (int x = from; x < to; x += AMB_LANES) {
        v3x d = v3x_sub(direction_at(row, x), v3x_splat(s->direction));
        f32x exponent = v3x_dot(d, d) * scale;
        f32x spot = f_sel(exponent > -9.0f, f_exp(exponent), f_set(0.0f));
        float light[3] = {s->rgb.x, s->rgb.y, s->rgb.z};
        for (int k = 0; k < 3; k++)
            f_store(rgb + k * apart + x, f_load(rgb + k * apart + x) + spot * light[k]);
    }
}

static void star_row(const amb_star_map *map, const amb_star *s, const row_frame *row, float *rgb)
{
    int width = map->width, half = width;
    if (row->sine > 0.02f) /* near the poles: the whole row */
        half = (int)(3.2f * map->blur / (row->sine * row->per_texel)) + 2;
    if (2 * half + 1 >= width) {
        star_span(map, s, row, 0, width, rgb);
        return;
    }
    int center = (int)(amb_atan2(-s->direction.x, s->direction.z) / row->per_texel);
    center = center < 0 ? center + width : center;
    int from = center - half, to = center + half + 1;
    if (from < 0)
        star_span(map, s, row, from + width, width, rgb);
    if (to > width)
        star_span(map, s, row, 0, to - width, rgb);
    star_span(map, s, row, from < 0 ? 0 : from, to > width ? width : to, rgb);
}

#define amb_stars_row WIDE(amb_stars_row)
void amb_stars_row(void *user, int y, int thread);
void amb_stars_row(void *user, int y, int thread)
{
    const amb_star_map *map = user;
    int apart = map->width + 32;
    float *rgb = map->scratch + (size_t)thread * 3 * (size_t)apart;
    float polar = AMB_PI * (((float)y + 0.5f) / (float)map->height);
    row_frame row = {amb_sin(polar), amb_cos(polar), AMB_TWO_PI / (float)map->width};
    for (int x = 0; x < map->width; x += AMB_LANES) {
        v3x glow = milky_way(direction_at(&row, x));
        f_store(rgb + x, glow.x);
        f_store(rgb + apart + x, glow.y);
        f_store(rgb + 2 * apart + x, glow.z);
    }
    for (uint32_t i = map->first[y]; i < map->first[y + 1]; i++)
        star_row(map, &map->star[map->list[i]], &row, rgb);
    uint16_t *to = map->texels + (size_t)y * (size_t)map->width * 4;
    for (int x = 0; x < map->width; x += AMB_LANES)
        for (int k = 0; k < 4; k++) {
            u32x half = f_to_half(k < 3 ? f_load(rgb + k * apart + x) : f_set(1.0f));
            for (int i = 0; i < AMB_LANES; i++)
                to[4 * (x + i) + k] = (uint16_t)u_lane(half, i);
        }
}
