#include "scenes/builtin/mercury.h"
#include "shade/color.h"

#include <ambiance/math.h>
#include <ambiance/noise.h>

/* Directions of a row's texels, as the unit sphere mesh has them: u grows eastward from +x over -z. */
typedef struct row_frame {
    float sine, cosine, per_texel; /* of the polar angle; longitude a texel */
} row_frame;

AMB_INLINE v3x direction_at(const row_frame *row, int x)
{
    f32x longitude = (i_to_f(i_lane_index() + x) + 0.5f) * row->per_texel, s, c;
    f_sincos(longitude, &s, &c);
    return v3x_of(c * row->sine, f_set(row->cosine), -s * row->sine);
}

/* ---- plains ----------------------------------------------------------------------------------------------------- */

/* Old rolling highlands, smooth bright plains, dark patches; and rubble down to the texel. */
AMB_INLINE void plains(v3x p, f32x *relief, f32x *brightness)
{
    amb_fbm broad = {4, 2.0f, 0.55f}, rubble = {4, 2.0f, 0.62f};
    v3x q = v3x_scale(p, f_set(1.7f));
    f32x patches = fbm3(noise_gradient3, q, (amb_lattice){.seed = 11}, broad).value;
    f32x hills = fbm3(noise_gradient3, v3x_scale(p, f_set(24.0f)), (amb_lattice){.seed = 23}, rubble).value;
    f32x grit =
        fbm3(noise_gradient3, v3x_scale(p, f_set(340.0f)), (amb_lattice){.seed = 37}, (amb_fbm){2, 2.0f, 0.7f}).value;
    f32x smooth = f_smoothstep(f_set(0.02f), f_set(0.32f), patches); /* lava plains have little relief */
    *relief = (hills * 0.034f + grit * 0.024f) * (1.0f - 0.6f * smooth);
    *brightness = patches * 0.19f + smooth * 0.03f + hills * 0.016f;
}

/* ---- craters ---------------------------------------------------------------------------------------------------- */

/* Rays: streaks over azimuth, broken up along their length. t: distance in radii; (a, b): unit azimuth. */
AMB_INLINE f32x ray_pattern(const amb_crater *c, f32x t, f32x a, f32x b)
{
    v3x around = v3x_of(a * 3.4f, b * 3.4f, f_set(c->seed));
    f32x wide = noise_gradient3(around, (amb_lattice){.seed = 3}).value;
    v3x finer = v3x_of(a * 11.0f, b * 11.0f, t * 0.22f + c->seed);
    f32x fine = noise_gradient3(finer, (amb_lattice){.seed = 5}).value;
    f32x streak = f_smoothstep(f_set(-0.05f), f_set(0.62f), wide * 1.1f + fine * 0.75f);
    f32x fade = f_saturate((c->reach - t) * (1.0f / c->reach));
    return streak * fade * fade * f_saturate(t - 0.9f);
}

/* One crater over AMB_LANES texels. */
AMB_INLINE void crater_at(const amb_crater *c, v3x p, f32x *relief, f32x *brightness)
{
    v3x to = v3x_sub(p, v3x_splat(c->center));
    f32x t = v3x_length(to) * (1.0f / c->radius);
    maskx touched = t < c->reach;
    if (!m_any(touched))
        return;
    float near_reach = c->reach < 2.1f ? c->reach : 2.1f;
    /* Uneven outlines: the azimuth bends the distance a little. */
    f32x x = v3x_dot(to, v3x_splat(c->east)), y = v3x_dot(to, v3x_splat(c->north));
    f32x inverse = 1.0f / f_sqrt(f_max(x * x + y * y, f_set(1e-20f)));
    x = x * inverse;
    y = y * inverse;
    f32x bend = x * y * (c->seed * 0.004f - 0.12f) + (x * x - y * y) * 0.05f;
    f32x d = t * (1.0f + bend);

    f32x wall = f_smoothstep(f_set(c->floor), f_set(1.0f), d);
    f32x inside = wall * (c->rim + c->depth) - c->depth;
    f32x hill = f_saturate(1.0f - d * 5.0f);
    inside = inside + hill * hill * c->peak;
    f32x q = f_saturate((near_reach - d) * (1.0f / (near_reach - 1.0f)));
    f32x outside = q * q * q * c->rim;
    f32x shape = f_sel(d < 1.0f, inside, outside);
    f32x cover = 1.0f - f_smoothstep(f_set(0.85f), f_set(1.35f), d); /* what was there before is gone */
    float kept = c->floor > 0.3f ? 0.35f : 0.55f;
    *relief = f_sel(touched, *relief * (1.0f - cover * (1.0f - kept)) + shape, *relief);

    f32x glow = f_saturate(1.6f - d);
    f32x light = glow * glow * (0.39f * c->fresh) + q * q * (0.3f * c->fresh);
    if (c->rays > 0.0f)
        light = light + ray_pattern(c, t, x, y) * c->rays;
    *brightness = f_sel(touched, *brightness + light, *brightness);
}

/* Texels x of [from, to) of the row; the last block may run over the end into padding. */
static void crater_span(const amb_crater *c, const row_frame *row, int from, int to, float *relief, float *brightness)
{
    for (int x = from; x < to; x += AMB_LANES) {
        f32x h = f_load(relief + x), b = f_load(brightness + x);
        crater_at(c, direction_at(row, x), &h, &b);
        f_store(relief + x, h);
        f_store(brightness + x, b);
    }
}

/* The columns that a crater can reach: |Δlongitude| ≤ acos((cos α - cos θ cos θc)/(sin θ sin θc)), over the date line.
 */
static void crater_row(const amb_crater *c, const row_frame *row, int width, float *relief, float *brightness)
{
    float chord = c->radius * c->reach, cos_reach = 1.0f - 0.5f * chord * chord;
    float sine_center = __builtin_sqrtf(amb_s_max(1.0f - c->center.y * c->center.y, 0.0f));
    float product = row->sine * sine_center, rest = cos_reach - row->cosine * c->center.y;
    if (rest > product)
        return; /* the row misses it */
    int half = width / 2;
    if (product > 0.02f && rest > -product) /* at the poles the quotient loses its digits: take the whole row */
        half = (int)(amb_acos(rest / product) / row->per_texel) + 2;
    int center = (int)(amb_atan2(-c->center.z, c->center.x) / row->per_texel);
    center = center < 0 ? center + width : center;
    if (2 * half + 1 >= width) {
        crater_span(c, row, 0, width, relief, brightness);
        return;
    }
    int from = center - half, to = center + half + 1;
    if (from < 0)
        crater_span(c, row, from + width, width, relief, brightness);
    if (to > width)
        crater_span(c, row, 0, to - width, relief, brightness);
    crater_span(c, row, from < 0 ? 0 : from, to > width ? width : to, relief, brightness);
}

/* ---- colour ----------------------------------------------------------------------------------------------------- */

/* Heights darken or brighten like the airless, dusty surface does: rims are fresh and bright, floors dark. */
AMB_INLINE void texels_at(f32x relief, f32x brightness, unsigned char *to)
{
    f32x light = f_clamp(0.25f + brightness + relief * 0.95f, f_set(0.03f), f_set(0.9f));
    /* Fresh ejecta and the dark, low-reflectance material are bluer than the plains between. */
    f32x fresh = f_smoothstep(f_set(0.06f), f_set(0.30f), brightness) +
                 0.6f * f_smoothstep(f_set(0.0f), f_set(-0.14f), brightness);
    v3x warm = v3x_splat(v3_of(1.12f, 0.985f, 0.865f)), cool = v3x_splat(v3_of(0.99f, 1.0f, 0.995f));
    v3x rgb = v3x_scale(v3x_lerp(warm, cool, fresh), light);
    f32x channel[3] = {rgb.x, rgb.y, rgb.z};
    for (int k = 0; k < 3; k++) {
        i32x code = f_to_i(color_srgb_encode(f_saturate(channel[k])) * 255.0f + 0.5f);
        for (int i = 0; i < AMB_LANES; i++)
            to[4 * i + k] = (unsigned char)i_lane(code, i);
    }
    for (int i = 0; i < AMB_LANES; i++)
        to[4 * i + 3] = 255;
}

#define amb_mercury_row WIDE(amb_mercury_row)
void amb_mercury_row(void *user, int y, int thread);
void amb_mercury_row(void *user, int y, int thread)
{
    const amb_mercury_map *map = user;
    float *relief = map->scratch + (size_t)thread * 2 * ((size_t)map->width + 32),
          *brightness = relief + map->width + 32;
    float polar = AMB_PI * (((float)y + 0.5f) / (float)map->height);
    row_frame row = {amb_sin(polar), amb_cos(polar), AMB_TWO_PI / (float)map->width};
    for (int x = 0; x < map->width; x += AMB_LANES) {
        f32x h, b;
        plains(direction_at(&row, x), &h, &b);
        f_store(relief + x, h);
        f_store(brightness + x, b);
    }
    for (uint32_t i = map->first[y]; i < map->first[y + 1]; i++)
        crater_row(&map->crater[map->list[i]], &row, map->width, relief, brightness);
    unsigned char *to = map->texels + (size_t)y * (size_t)map->width * 4;
    for (int x = 0; x < map->width; x += AMB_LANES)
        texels_at(f_load(relief + x), f_load(brightness + x), to + 4 * (size_t)x);
}
