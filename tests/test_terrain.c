/* Noise out of a texture, the height function and its shading against double precision written from the definitions. */
#include "lanes.h"
#include "lanes_terrain.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

LANES_DECLARE(lanes_terrain);
static const lanes_set terrain_set = LANES_SET(lanes_terrain);

static void near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("got %.9g, want %.9g ± %g", got, want, tolerance);
}
static float random_in(uint64_t *state, float lo, float hi)
{
    return lo + (hi - lo) * (float)(lanes_random(state) >> 40) * 0x1p-24f;
}

/* ---- the definitions, in double -------------------------------------------------------------------------------- */

static double texel(const amb_noise_texture *noise, int64_t x, int64_t y)
{
    uint32_t word = noise->corners[(y & 255) * 256 + (x & 255)];
    return (2.0 * (double)(int8_t)(word & 255u) + 1.0) / 256.0;
}
static double fade(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }

static double fade_slope(double t) { return 30 * t * t * (t - 1) * (t - 1); }

/* A value and its slope. */
typedef struct slope2 {
    double f, x, y;
} slope2;

static slope2 noise_of(const amb_noise_texture *noise, double px, double py, int64_t cell_x, int64_t cell_y)
{
    double fx = floor(px), fy = floor(py), u = fade(px - fx), v = fade(py - fy);
    int64_t x = (int64_t)fx + cell_x, y = (int64_t)fy + cell_y;
    double a = texel(noise, x, y), b = texel(noise, x + 1, y), c = texel(noise, x, y + 1);
    double d = texel(noise, x + 1, y + 1);
    return (slope2){(1 - u) * (1 - v) * a + u * (1 - v) * b + (1 - u) * v * c + u * v * d,
                    fade_slope(px - fx) * ((1 - v) * (b - a) + v * (d - c)),
                    fade_slope(py - fy) * ((1 - u) * (c - a) + u * (d - b))};
}
static double noise_at(const amb_noise_texture *noise, double px, double py, int64_t cell_x, int64_t cell_y)
{
    return noise_of(noise, px, py, cell_x, cell_y).f;
}

/* f of octave i at p, and ∇f(2ⁱp) in p's axes. */
static slope2 octave_of(const amb_terrain *t, int i, double px, double py)
{
    const amb_terrain_octave *o = &t->octave[i];
    double angle = o->s == 0.0f ? 0.0 : i * atan2(3.0, 4.0), c = cos(angle), s = sin(angle), scale = ldexp(1.0, i);
    slope2 own = noise_of(t->noise, (px * c - py * s) * scale + (double)o->offset.x,
                          (px * s + py * c) * scale + (double)o->offset.y, o->x, o->y);
    return (slope2){own.f, own.x * c + own.y * s, own.y * c - own.x * s};
}
static double height_at(const amb_terrain *t, double px, double py, int octaves)
{
    double z = 0, hx = 0, hy = 0;
    for (int i = 0; i < octaves; i++) {
        slope2 v = octave_of(t, i, px, py);
        hx += v.x;
        hy += v.y;
        z += ldexp(v.f, -i) / (1 + (double)t->erosion * (hx * hx + hy * hy));
    }
    return z;
}

/* ---- noise ----------------------------------------------------------------------------------------------------- */

static void noise_is_the_texture_interpolated(void **state)
{
    (void)state;
    const amb_noise_texture *noise = lanes_terrain_data()->plain.noise;
    uint64_t seed = 1;
    const double h = 1e-4;
    for (int i = 0; i < 4000; i++) {
        float x = random_in(&seed, -300, 300), y = random_in(&seed, -300, 300);
        noise2x n = noise_texture2(noise, (v2x){x, y}, (amb_lattice){.x = 77, .y = -3000});
        double px = (double)x, py = (double)y;
        if (fmin(px - floor(px), py - floor(py)) < 2 * h || fmax(px - floor(px), py - floor(py)) > 1 - 2 * h)
            continue; /* second derivatives are continuous, third ones are not */
#define AT(dx, dy) noise_at(noise, px + (dx), py + (dy), 77, -3000)
        near((double)n.value, AT(0, 0), 1e-6);
        near((double)n.slope.x, (AT(h, 0) - AT(-h, 0)) / (2 * h), 3e-5);
        near((double)n.slope.y, (AT(0, h) - AT(0, -h)) / (2 * h), 3e-5);
        near((double)n.xx, (AT(h, 0) - 2 * AT(0, 0) + AT(-h, 0)) / (h * h), 2e-4);
        near((double)n.yy, (AT(0, h) - 2 * AT(0, 0) + AT(0, -h)) / (h * h), 2e-4);
        near((double)n.xy, (AT(h, h) - AT(h, -h) - AT(-h, h) + AT(-h, -h)) / (4 * h * h), 2e-4);
#undef AT
    }
}

/* By hand: a step along x is the quintic itself. Its slope in the middle is 30/16 of the step, its bend 0; at the ends
 * both are 0; bends are largest, ±10/√3, at t = ½(1 ∓ 1/√3). */
static void noise_of_a_step_is_the_quintic(void **state)
{
    (void)state;
    amb_noise_texture *noise = malloc(sizeof *noise);
    assert_non_null(noise);
    for (int i = 0; i < 256 * 256; i++) { /* -127 in even columns, 63 in odd ones: -253/256 and 127/256 */
        uint32_t even = (uint32_t)(uint8_t)-127, odd = 63;
        noise->corners[i] = i & 1 ? odd | even << 8 | odd << 16 | even << 24 : even | odd << 8 | even << 16 | odd << 24;
    }
    const double step = 380.0 / 256.0, low = -253.0 / 256.0;
    const double tight = 1e-6;
    for (int row = 0; row < 16; row++) {
        float y = 0.4f * (float)row - 3.25f;
        noise2x middle = noise_texture2(noise, (v2x){4.5f, y}, (amb_lattice){0});
        near((double)middle.value, low + step / 2, tight);
        near((double)middle.slope.x, step * 30.0 / 16.0, tight);
        near((double)middle.xx, 0.0, tight);
        noise2x end = noise_texture2(noise, (v2x){4.0f, y}, (amb_lattice){0});
        near((double)end.value, low, tight);
        near((double)end.slope.x, 0.0, 0.0);
        near((double)end.xx, 0.0, 0.0);
        double steepest = 0.5 - 0.5 / sqrt(3.0);
        noise2x bend = noise_texture2(noise, (v2x){(float)(4.0 + steepest), y}, (amb_lattice){0});
        near((double)bend.xx, step * 10.0 / sqrt(3.0), 1e-5);
        near((double)bend.slope.y, 0.0, 0.0);
        near((double)bend.xy, 0.0, 0.0);
        near((double)bend.yy, 0.0, 0.0);
    }
    free(noise);
}

static void texture_is_white(void **state)
{
    (void)state;
    const amb_noise_texture *noise = &lanes_terrain_data()->noise;
    int count[256] = {0};
    double sum = 0, along = 0;
    for (int y = 0; y < 256; y++)
        for (int x = 0; x < 256; x++) {
            uint32_t word = noise->corners[y * 256 + x];
            count[word & 255u]++;
            sum += texel(noise, x, y);
            along += texel(noise, x, y) * texel(noise, x + 1, y);
            /* the other corners are the neighbours' own */
            assert_int_equal(word >> 8 & 255u, noise->corners[y * 256 + (x + 1) % 256] & 255u);
            assert_int_equal(word >> 16 & 255u, noise->corners[(y + 1) % 256 * 256 + x] & 255u);
            assert_int_equal(word >> 24, noise->corners[(y + 1) % 256 * 256 + (x + 1) % 256] & 255u);
        }
    double chi2 = 0;
    for (int i = 0; i < 256; i++)
        chi2 += (count[i] - 256.0) * (count[i] - 256.0) / 256.0;
    assert_true(chi2 > 255 - 5 * sqrt(510) && chi2 < 255 + 5 * sqrt(510));
    near(sum / 65536, 0, 5 * sqrt(1.0 / 3 / 65536)); /* of standard deviation 1/√3 */
    near(along / 65536, 0, 5.0 / 3 / 256);
}

/* ---- height ------------------------------------------------------------------------------------------------------ */

static void heights_match_the_formula(void **state)
{
    (void)state;
    const lanes_terrain_set *set = lanes_terrain_data();
    uint64_t seed = 2;
    for (int i = 0; i < 600; i++) {
        const amb_terrain *t = i & 1 ? &set->turned : &set->plain;
        int octaves = 1 + i % 12;
        float x = random_in(&seed, -2, 2), y = random_in(&seed, -2, 2);
        /* float rounding of 2ⁱp moves the finest octave by 2ⁱ·2⁻²³ of its cell; its share is 2⁻ⁱ */
        near((double)terrain_at(t, (v2x){x, y}, (float)octaves).height, height_at(t, (double)x, (double)y, octaves),
             6e-6);
        double fbm = 0;
        for (int k = 0; k < octaves; k++)
            fbm += ldexp(octave_of(t, k, (double)x, (double)y).f, -k);
        near((double)terrain_fbm(t, (v2x){x, y}, (float)octaves), fbm, 4e-6);
    }
}

/* Whether p and all within `reach` of it lie in one cell of each octave. Across a cell's border f‴ jumps, so ∇f, h and
 * with them Z have a bend: there, differences converge with the step and not with its square. */
static bool inside_cells(const amb_terrain *t, double px, double py, int octaves, double reach)
{
    for (int i = 0; i < octaves; i++) {
        const amb_terrain_octave *o = &t->octave[i];
        double x = px * (double)o->along - py * (double)o->across + (double)o->offset.x;
        double y = px * (double)o->across + py * (double)o->along + (double)o->offset.y;
        double margin = reach * ldexp(1.0, i);
        x -= floor(x), y -= floor(y);
        if (fmin(x, y) < margin || fmax(x, y) > 1 - margin)
            return false;
    }
    return true;
}

/* Central differences of the double height must approach the analytic slope with h²: halving h quarters the error. */
static void slopes_converge_with_the_square(void **state)
{
    (void)state;
    const lanes_terrain_set *set = lanes_terrain_data();
    uint64_t seed = 3;
    const int octaves = 3;
    double error[3] = {0}, steepest = 0;
    int count = 0;
    for (int i = 0; i < 3000; i++) {
        const amb_terrain *t = i & 1 ? &set->turned : &set->plain;
        float x = random_in(&seed, -1, 1), y = random_in(&seed, -1, 1);
        double px = (double)x, py = (double)y, h = 1.0 / 256;
        if (!inside_cells(t, px, py, octaves, h))
            continue;
        count++;
        terrain_surface z = terrain_at(t, (v2x){x, y}, (float)octaves);
        for (int k = 0; k < 3; k++, h /= 2) {
            double sx = (height_at(t, px + h, py, octaves) - height_at(t, px - h, py, octaves)) / (2 * h);
            double sy = (height_at(t, px, py + h, octaves) - height_at(t, px, py - h, octaves)) / (2 * h);
            error[k] += pow(sx - (double)z.slope.x, 2) + pow(sy - (double)z.slope.y, 2);
            steepest = fmax(steepest, fabs(sx));
        }
    }
    assert_true(steepest > 0.5 && count > 1000);
    for (int k = 0; k < 2; k++) {
        double ratio = sqrt(error[k] / error[k + 1]);
        if (ratio < 3.7 || ratio > 4.3)
            fail_msg("halving the step divides the error by %g", ratio);
    }
    assert_true(sqrt(error[2] / (2 * count)) < 5e-4);
}

/* The option in floats: the same height, and a slope whose error falls with the square of the step until rounding. */
static void central_differences_agree(void **state)
{
    (void)state;
    const amb_terrain *t = &lanes_terrain_data()->turned;
    double error[3] = {0};
    for (int k = 0; k < 3; k++) {
        uint64_t seed = 4;
        int count = 0;
        for (int i = 0; i < 1500; i++) {
            v2x p = {random_in(&seed, -1, 1), random_in(&seed, -1, 1)};
            if (!inside_cells(t, (double)p.x, (double)p.y, 4, 1.0 / 128))
                continue;
            count++;
            terrain_surface analytic = terrain_at(t, p, 4.0f);
            terrain_surface central = terrain_at_central(t, p, 4.0f, ldexpf(1.0f, -7 - k));
            assert_true(analytic.height == central.height);
            error[k] += pow((double)(central.slope.x - analytic.slope.x), 2) +
                        pow((double)(central.slope.y - analytic.slope.y), 2);
        }
        assert_true(count > 300);
        error[k] = sqrt(error[k] / (2 * count));
    }
    for (int k = 0; k < 2; k++)
        if (error[k] / error[k + 1] < 3.5 || error[k] / error[k + 1] > 4.5)
            fail_msg("halving the step divides the error by %g", error[k] / error[k + 1]);
    assert_true(error[2] < 2e-2);
}

static void octaves_fade_in(void **state)
{
    (void)state;
    const amb_terrain *t = &lanes_terrain_data()->turned;
    v2x p = {0.31f, 0.77f};
    near((double)terrain_at(t, p, 0.0f).height, 0, 0);
    for (int count = 1; count < 12; count++) {
        float o = (float)count;
        double before = (double)terrain_at(t, p, o).height, after = (double)terrain_at(t, p, o + 0.001f).height;
        near(before, after, 0.004 * ldexp(1.0, -count));
    }
    near((double)terrain_at(t, p, 16.0f).height, (double)terrain_at(t, p, 99.0f).height, 0);
    terrain_surface coarse, fine = terrain_at_both(t, p, 9.5f, 4, &coarse);
    terrain_surface four = terrain_at(t, p, 4.0f), all = terrain_at(t, p, 9.5f);
    assert_memory_equal(&coarse, &four, sizeof four);
    assert_memory_equal(&fine, &all, sizeof all);
    fine = terrain_at_both(t, p, 2.5f, 4, &coarse);
    assert_memory_equal(&coarse, &fine, sizeof fine);
}

/* ---- endless flight ---------------------------------------------------------------------------------------------- */

/* The report's own, unturned: the same place reached from another base gives the same bits (p exact in both). */
static void another_base_same_bits(void **state)
{
    (void)state;
    amb_noise_texture *noise = malloc(sizeof *noise);
    assert_non_null(noise);
    amb_noise_texture_make(noise, 9);
    const int64_t bases[] = {0, 3600, 1000000007, -(1ll << 40)};
    uint64_t seed = 5;
    for (size_t b = 0; b < sizeof bases / sizeof *bases; b++) {
        amb_terrain near_base, far_base;
        amb_terrain_place(&near_base, noise, 3, 1.0f, false, bases[b], -bases[b]);
        amb_terrain_place(&far_base, noise, 3, 1.0f, false, bases[b] - 5, -bases[b] + 2);
        for (int i = 0; i < 500; i++) {
            v2x p = {floorf(random_in(&seed, 0, 4096)) / 4096, floorf(random_in(&seed, 0, 4096)) / 4096};
            v2x q = {p.x + 5.0f, p.y - 2.0f};
            terrain_surface a = terrain_at(&near_base, p, 12.0f), b2 = terrain_at(&far_base, q, 12.0f);
            assert_memory_equal(&a, &b2, sizeof a);
        }
    }
    free(noise);
}

/* Turned: rounding of 2ⁱR p only. */
static void another_base_same_place(void **state)
{
    (void)state;
    const amb_noise_texture *noise = &lanes_terrain_data()->noise;
    const int64_t bases[] = {0, 3600, 1000000007, -(1ll << 40)};
    uint64_t seed = 6;
    for (size_t b = 0; b < sizeof bases / sizeof *bases; b++) {
        amb_terrain one, other;
        amb_terrain_place(&one, noise, 3, 1.0f, true, bases[b], 17);
        amb_terrain_place(&other, noise, 3, 1.0f, true, bases[b] - 1, 18);
        for (int i = 0; i < 500; i++) {
            v2x p = {random_in(&seed, 0, 1), random_in(&seed, 0, 1)}, q = {p.x + 1.0f, p.y - 1.0f};
            near((double)terrain_at(&one, p, 12.0f).height, (double)terrain_at(&other, q, 12.0f).height, 1e-5);
        }
    }
}

/* Origins of the turned octaves: (2/5)ⁱ·[4 -3; 3 4]ⁱ·(x, y) by 128-bit integers. */
static void origins_are_exact(void **state)
{
    (void)state;
    const int64_t places[][2] = {{0, 0}, {1, 0}, {-1, 7}, {123456789, -987654321}, {1ll << 40, -(1ll << 40)}};
    for (size_t n = 0; n < sizeof places / sizeof *places; n++) {
        amb_terrain t;
        amb_terrain_place(&t, &lanes_terrain_data()->noise, 0, 1.0f, true, places[n][0], places[n][1]);
        __int128 x = places[n][0], y = places[n][1], power = 1;
        for (int i = 0; i < TERRAIN_OCTAVES; i++) {
            const __int128 at[2] = {x, y};
            const uint32_t cell[2] = {t.octave[i].x, t.octave[i].y};
            const float part[2] = {t.octave[i].offset.x, t.octave[i].offset.y};
            for (int k = 0; k < 2; k++) {
                __int128 rest = at[k] % power;
                rest += rest < 0 ? power : 0;
                assert_int_equal(cell[k], (uint32_t)((at[k] - rest) / power));
                near((double)part[k], (double)rest / (double)power, 3e-8);
            }
            __int128 next_x = 2 * (4 * x - 3 * y), next_y = 2 * (3 * x + 4 * y);
            x = next_x, y = next_y, power *= 5;
        }
    }
}

/* ---- shading ----------------------------------------------------------------------------------------------------- */

static void ground_shading_follows_the_report(void **state)
{
    (void)state;
    near((double)terrain_occlusion(0.5f, 2.0f, 0.25f), 0.5, 1e-7);
    near((double)terrain_occlusion(-0.5f, 2.0f, 0.25f), 0.25, 0);
    terrain_snow_edges e = {1.0f, 0.5f, 1.4f, 0.6f, 2.0f};
    for (int i = 0; i <= 8; i++)
        for (int k = -16; k <= 16; k++) {
            float ny = 0.125f * (float)i, noise = 0.0625f * (float)k;
            double low = 1.0 - 0.5 * (double)ny, high = 1.4 - 0.6 * (double)ny;
            double s = fmin(fmax((2.0 * (double)noise - low) / (high - low), 0), 1);
            near((double)terrain_snow(ny, noise, e), s * s * (3 - 2 * s), 2e-6);
        }
    v3x n = terrain_normal((v2x){0.5f, -1.0f}, 2.0f);
    near((double)n.x, -1 / sqrt(6), 1e-7);
    near((double)n.y, 1 / sqrt(6), 1e-7);
    near((double)n.z, 2 / sqrt(6), 1e-7);
}

/* Against a walk in small even steps: whether anything is in the way, and by how much the ray clears it. */
static void shadows_agree_with_a_dense_march(void **state)
{
    (void)state;
    const amb_terrain *t = &lanes_terrain_data()->turned;
    terrain_march m = {.scale = 0.4f, .ceiling = 0.6f, .reach = 4.0f, .spread = 0.0047f, .steps = 96};
    v3 light = v3_normalize((v3){0.8f, 0.22f, 0.5f});
    uint64_t seed = 7;
    int wrong = 0, shadowed = 0, clear = 0;
    for (int i = 0; i < 400; i++) {
        v2x p = {random_in(&seed, -8, 8), random_in(&seed, -8, 8)};
        float y = m.scale * terrain_at(t, p, 5.0f).height + 0.004f;
        double least = 1e9; /* of clearance over distance */
        for (int k = 2; k < 2000; k++) {
            float s = 0.002f * (float)k;
            if (y + s * light.y > m.ceiling)
                break;
            v2x at = {p.x + s * light.x, p.y + s * light.z};
            float clearance = y + s * light.y - m.scale * terrain_at(t, at, 5.0f).height;
            least = fmin(least, (double)(clearance / s));
        }
        float lit = terrain_sunlight(t, &m, p, y, light, 5.0f);
        assert_true(lit >= 0.0f && lit <= 1.0f);
        if (least < -2 * 0.0047) {
            shadowed++;
            wrong += lit > 0.02f;
        } else if (least > 2 * 0.0047) {
            clear++;
            wrong += lit < 0.98f;
        }
    }
    assert_true(shadowed > 60 && clear > 60);
    assert_true(wrong <= 4); /* crests thinner than a step */
    assert_true(terrain_sunlight(t, &m, (v2x){0, 0}, 0.9f, (v3){0.8f, -0.6f, 0.0f}, 5.0f) == 0.0f);
}

/* ---- widths ------------------------------------------------------------------------------------------------------ */

static void fill(const lanes_case *test, int input, float *out, size_t count)
{
    lanes_floats_in((uint64_t)input * 7u + (uint64_t)test->name[0], input < 2 ? -9.0f : 0.0f, 9.0f, out, count);
    lanes_any_floats((uint64_t)input, out, count / 8);
}
static void every_width_gives_the_same_bits(void **state)
{
    (void)state;
    size_t compared;
    assert_int_equal(lanes_mismatches(&terrain_set, 1u << 12, fill, &compared), 0);
    assert_true(compared > 100000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_the_texture_interpolated),
        cmocka_unit_test(noise_of_a_step_is_the_quintic),
        cmocka_unit_test(texture_is_white),
        cmocka_unit_test(heights_match_the_formula),
        cmocka_unit_test(slopes_converge_with_the_square),
        cmocka_unit_test(central_differences_agree),
        cmocka_unit_test(octaves_fade_in),
        cmocka_unit_test(another_base_same_bits),
        cmocka_unit_test(another_base_same_place),
        cmocka_unit_test(origins_are_exact),
        cmocka_unit_test(ground_shading_follows_the_report),
        cmocka_unit_test(shadows_agree_with_a_dense_march),
        cmocka_unit_test(every_width_gives_the_same_bits),
    };
    return cmocka_run_group_tests_name("terrain", tests, NULL, NULL);
}
