/* Noise against a double-precision one written from its definition; random numbers against statistics. */
#include "lanes.h"

#include <ambiance/noise.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

LANES_DECLARE(lanes_noise);
static const lanes_set noise_set = LANES_SET(lanes_noise);

/* ---- the definition, in double, any dimension ----------------------------------------------------------------------
 */

static const uint32_t seed = 7u;
static const int32_t cell_offset[4] = {3, -5, 1000000, -2000000000};

static uint32_t reference_hash(uint32_t a)
{
    a ^= a >> 16;
    a *= 0x7feb352du;
    a ^= a >> 15;
    a *= 0x846ca68bu;
    return a ^ (a >> 16);
}

typedef enum kind { VALUE, VALUE_LINEAR, GRADIENT } kind;

/* Σ over the 2ⁿ corners of weight × (value or slope · distance). */
static double reference(kind what, int dimensions, const double *p)
{
    double sum = 0.0;
    for (int corner = 0; corner < 1 << dimensions; corner++) {
        uint32_t hash = seed;
        double weight = 1.0, distance[4];
        for (int i = dimensions - 1; i >= 0; i--) {
            int bit = corner >> i & 1;
            double cell = floor(p[i]), t = p[i] - cell;
            double fade = what == VALUE_LINEAR ? t : ((6.0 * t - 15.0) * t + 10.0) * t * t * t;
            hash = reference_hash((uint32_t)((int64_t)cell + cell_offset[i] + bit) + hash);
            weight *= bit ? fade : 1.0 - fade;
            distance[i] = t - bit;
        }
        double at = (hash >> 8) / 8388608.0 - 1.0;
        if (what == GRADIENT) {
            int bits = dimensions == 2 ? 16 : 10;
            at = 0.0;
            for (int i = 0; i < dimensions; i++) {
                double field = (double)((hash >> (bits * i)) & ((1u << bits) - 1u));
                at += (2.0 * field + 1.0 - (1 << bits)) / (1 << bits) * distance[i];
            }
            at *= dimensions == 3 ? 2.0 / 3.0 : 1.0;
        }
        sum += weight * at;
    }
    return sum;
}

static const struct subject {
    const char *name;
    kind what;
    int dimensions;
} subjects[] = {{"value2", VALUE, 2},       {"gradient2", GRADIENT, 2}, {"value3", VALUE, 3},
                {"gradient3", GRADIENT, 3}, {"value4", VALUE, 4},       {"value4_linear", VALUE_LINEAR, 4}};
#define SUBJECTS (sizeof subjects / sizeof *subjects)

#define POINTS 4096
static float point[4][POINTS], result[6][POINTS];

static void evaluate(const struct subject *s, float lo, float hi)
{
    const float *in[4];
    float *out[6];
    for (int i = 0; i < 4; i++) {
        lanes_floats_in((uint64_t)i + 31u, lo, hi, point[i], POINTS);
        in[i] = point[i];
    }
    for (int i = 0; i < 6; i++)
        out[i] = result[i];
    const lanes_case *test = lanes_find(lanes_widest(&noise_set), s->name);
    assert_non_null(test);
    test->run(in, out, POINTS);
}

static double reference_at(const struct subject *s, int i, int axis, double step, int axis2, double step2)
{
    double p[4] = {(double)point[0][i], (double)point[1][i], (double)point[2][i], (double)point[3][i]};
    p[axis] += step;
    p[axis2] += step2;
    return reference(s->what, s->dimensions, p);
}

static void values_match_the_definition(void **state)
{
    (void)state;
    for (size_t n = 0; n < SUBJECTS; n++)
        for (int far = 0; far < 2; far++) {
            evaluate(&subjects[n], far ? 30000.0f : -40.0f, far ? 60000.0f : 40.0f);
            double least = 1.0, most = -1.0;
            for (int i = 0; i < POINTS; i++) {
                double want = reference_at(&subjects[n], i, 0, 0.0, 0, 0.0);
                assert_true(fabs((double)result[0][i] - want) < 1.5e-6);
                least = fmin(least, want);
                most = fmax(most, want);
            }
            assert_true(least >= -1.0 && most <= 1.0 && least < -0.25 && most > 0.25);
        }
}

/* Central differences of the double reference must approach the analytic slope with h²: halving h quarters the error.
 */
static void slopes_are_derivatives(void **state)
{
    (void)state;
    for (size_t n = 0; n < SUBJECTS; n++) {
        const struct subject *s = &subjects[n];
        evaluate(s, -20.0f, 20.0f);
        for (int axis = 0; axis < s->dimensions; axis++) {
            double square[3] = {0.0, 0.0, 0.0};
            for (int i = 0; i < POINTS; i++) {
                double t = (double)point[axis][i] - floor((double)point[axis][i]);
                if (s->what == VALUE_LINEAR && (t < 0.07 || t > 0.93))
                    continue; /* the linear slope jumps at cell faces */
                for (int k = 0; k < 3; k++) {
                    double h = k == 0 ? 1.0 / 16.0 : k == 1 ? 1.0 / 32.0 : 1e-4;
                    double slope =
                        (reference_at(s, i, axis, h, 0, 0.0) - reference_at(s, i, axis, -h, 0, 0.0)) / (2.0 * h);
                    double error = slope - (double)result[1 + axis][i];
                    square[k] += error * error;
                }
            }
            double coarse = sqrt(square[0] / POINTS), fine = sqrt(square[1] / POINTS),
                   finest = sqrt(square[2] / POINTS);
            assert_true(finest < 2e-6);
            if (s->what != VALUE_LINEAR)
                assert_true(coarse / fine > 3.6 && coarse / fine < 4.4);
        }
    }
}

static void second_derivatives_of_value2(void **state)
{
    (void)state;
    const struct subject *s = &subjects[0];
    evaluate(s, -20.0f, 20.0f);
    double square[2][3] = {{0.0}};
    for (int i = 0; i < POINTS; i++) {
        double tx = (double)(point[0][i] - floorf(point[0][i])), ty = (double)(point[1][i] - floorf(point[1][i]));
        if (fmin(fmin(tx, 1.0 - tx), fmin(ty, 1.0 - ty)) < 1.0 / 32.0)
            continue; /* the third derivative jumps at cell faces */
        for (int k = 0; k < 2; k++) {
            double h = k == 0 ? 1.0 / 32.0 : 1.0 / 64.0, middle = 2.0 * reference_at(s, i, 0, 0.0, 0, 0.0);
            double xx = (reference_at(s, i, 0, h, 1, 0.0) - middle + reference_at(s, i, 0, -h, 1, 0.0)) / (h * h);
            double yy = (reference_at(s, i, 1, h, 0, 0.0) - middle + reference_at(s, i, 1, -h, 0, 0.0)) / (h * h);
            double xy = (reference_at(s, i, 0, h, 1, h) - reference_at(s, i, 0, h, 1, -h) -
                         reference_at(s, i, 0, -h, 1, h) + reference_at(s, i, 0, -h, 1, -h)) /
                        (4.0 * h * h);
            double error[3] = {xx - (double)result[3][i], xy - (double)result[4][i], yy - (double)result[5][i]};
            for (int d = 0; d < 3; d++)
                square[k][d] += error[d] * error[d];
        }
    }
    for (int d = 0; d < 3; d++) {
        double ratio = sqrt(square[0][d] / square[1][d]);
        assert_true(sqrt(square[1][d] / POINTS) < 0.1);
        assert_true(ratio > 3.6 && ratio < 4.4);
    }
}

/* From either side of a cell face: value, slope and (value2) second derivatives meet. */
static void cells_meet_without_a_step(void **state)
{
    (void)state;
    amb_lattice field = {seed, cell_offset[0], cell_offset[1], cell_offset[2], cell_offset[3]};
    for (int cell = -50; cell < 50; cell++)
        for (int k = 0; k < 20; k++) {
            float on = (float)cell, below = nextafterf(on, -1e9f), y = (float)k * 0.37f, z = (float)k * -0.71f;
            noise2x a = noise_value2((v2x){on, y}, field), b = noise_value2((v2x){below, y}, field);
            assert_true(fabsf(a.value - b.value) < 3e-6f && fabsf(a.slope.x - b.slope.x) < 1e-4f);
            assert_true(fabsf(a.slope.y - b.slope.y) < 3e-5f && fabsf(a.xx - b.xx) < 2e-3f);
            assert_true(fabsf(a.xy - b.xy) < 1e-4f && fabsf(a.yy - b.yy) < 1e-4f);
            a = noise_gradient2((v2x){y, on}, field), b = noise_gradient2((v2x){y, below}, field);
            assert_true(fabsf(a.value - b.value) < 1e-5f && fabsf(a.slope.x - b.slope.x) < 1e-4f);
            assert_true(fabsf(a.slope.y - b.slope.y) < 1e-4f);
            noise3x c = noise_gradient3((v3x){y, z, on}, field), d = noise_gradient3((v3x){y, z, below}, field);
            assert_true(fabsf(c.value - d.value) < 1e-5f && fabsf(c.slope.z - d.slope.z) < 1e-4f);
            noise4x e = noise_value4((v4x){y, z, y, on}, field, true),
                    f = noise_value4((v4x){y, z, y, below}, field, true);
            assert_true(fabsf(e.value - f.value) < 2e-5f);
        }
    for (int i = -9; i < 9; i++)
        for (int j = -9; j < 9; j++)
            assert_true(noise_gradient2((v2x){(float)i, (float)j}, field).value == 0.0f);
}

/* Moving the lattice by whole cells is moving the point by as much, where the point can still say so. */
static void lattice_offset_is_a_move(void **state)
{
    (void)state;
    amb_lattice still = {5u, 0, 0, 0, 0}, moved = {5u, 4096, -512, 0, 0}, end = {5u, INT32_MAX, INT32_MIN, 0, 0};
    amb_fbm fbm = {6, 2.0f, 0.5f};
    for (int i = 0; i < 1000; i++) {
        v2x p = {(float)i * 0.125f, (float)i * -0.0625f}, q = {p.x + 4096.0f, p.y - 512.0f};
        assert_true(noise_value2(p, moved).value == noise_value2(q, still).value);
        assert_true(noise_gradient2(p, moved).slope.x == noise_gradient2(q, still).slope.x);
        assert_true(fbm2(noise_value2, p, moved, fbm).value == fbm2(noise_value2, q, still, fbm).value);
        assert_true(fabsf(noise_value2(p, end).value) <= 1.0f); /* cells wrap, silently */
    }
    float huge = 3e38f;
    assert_true(fabsf(noise_value2((v2x){huge, -huge}, still).value) <= 1.0f);
    assert_true(isnan(noise_value2((v2x){INFINITY, 0.0f}, still).value));
}

/* fBm is the sum it says, and its slope that sum's slope. */
static void fbm_sums_octaves(void **state)
{
    (void)state;
    amb_lattice field = {9u, 0, 0, 0, 0};
    amb_fbm fbm = {6, 2.0f, 0.5f};
    assert_true(fbm2(noise_value2, (v2x){0.3f, 0.4f}, field, (amb_fbm){0, 2.0f, 0.5f}).value == 0.0f);
    double square = 0.0;
    for (int i = 0; i < 2000; i++) {
        v2x p = {(float)i * 0.0371f, (float)i * 0.0213f};
        float one = noise_value2(p, field).value;
        assert_true(fbm2(noise_value2, p, field, (amb_fbm){1, 2.0f, 0.5f}).value == one);
        noise2x all = fbm2(noise_value2, p, field, fbm);
        assert_true(fabsf(all.value) <= 2.0f);
        float h = 1.0f / 2048.0f;
        float slope = (fbm2(noise_value2, (v2x){p.x + h, p.y}, field, fbm).value -
                       fbm2(noise_value2, (v2x){p.x - h, p.y}, field, fbm).value) /
                      (2.0f * h);
        double error = (double)(slope - all.slope.x);
        square += error * error;
    }
    assert_true(sqrt(square / 2000.0) < 0.02); /* the float differences are this coarse */
}

/* ---- random numbers ---------------------------------------------------------------------------------------------- */

#define SIDE 256
/* Four numbers of pixel (x, y), sample s, frame f. */
static v4 draw(int x, int y, uint32_t s, uint32_t f)
{
    v4x r = v4x_random(x, y, s, f);
    return (v4){r.x, r.y, r.z, r.w};
}

/* χ² of 256 bins over an image; with 255 degrees of freedom, 99.99 % lie in [176, 348]. */
static void random_is_uniform(void **state)
{
    (void)state;
    for (uint32_t frame = 0; frame < 4; frame++) {
        int bins[4][256] = {{0}};
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                v4 r = draw(x - 100, y, 3u, frame);
                float v[4] = {r.x, r.y, r.z, r.w};
                for (int k = 0; k < 4; k++) {
                    assert_true(v[k] >= 0.0f && v[k] < 1.0f);
                    bins[k][(int)(v[k] * 256.0f)]++;
                }
            }
        for (int k = 0; k < 4; k++) {
            double chi2 = 0.0, expected = SIDE * SIDE / 256.0;
            for (int i = 0; i < 256; i++)
                chi2 += (bins[k][i] - expected) * (bins[k][i] - expected) / expected;
            if (chi2 < 176.0 || chi2 > 348.0)
                fail_msg("frame %u, number %d: chi² %.1f", frame, k, chi2);
        }
    }
}

/* Correlation with the next pixel, row, sample, frame, and between the four numbers: within 4.5 σ of none. */
static void neighbours_are_independent(void **state)
{
    (void)state;
    double sum[8] = {0.0};
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            v4 a = draw(x, y, 0u, 0u);
            double c = (double)a.x - 0.5;
            float other[8] = {draw(x + 1, y, 0u, 0u).x,
                              draw(x, y + 1, 0u, 0u).x,
                              draw(x, y, 1u, 0u).x,
                              draw(x, y, 0u, 1u).x,
                              a.y,
                              a.z,
                              a.w,
                              draw(y, x, 0u, 0u).y};
            for (int k = 0; k < 8; k++)
                sum[k] += c * ((double)other[k] - 0.5);
        }
    for (int k = 0; k < 8; k++) {
        double correlation = 12.0 * sum[k] / (SIDE * SIDE);
        if (fabs(correlation) > 4.5 / SIDE)
            fail_msg("neighbour %d: correlation %.5f", k, correlation);
    }
}

/* u_hash: flipping any input bit flips each output bit half the time (lowbias32's promise), and lattice sums stay so.
 */
static void hash_mixes_every_bit(void **state)
{
    (void)state;
    uint64_t source = 1;
    for (int in = 0; in < 32; in++) {
        int flips[32] = {0};
        for (int n = 0; n < 4000; n++) {
            uint32_t a = (uint32_t)lanes_random(&source), d = u_hash(a) ^ u_hash(a ^ 1u << in);
            for (int out = 0; out < 32; out++)
                flips[out] += (int)(d >> out & 1u);
        }
        for (int out = 0; out < 32; out++)
            assert_in_range(flips[out], 1800, 2200); /* 2000 ± 6.3 σ */
    }
    for (uint32_t a = 0; a < 1000; a++)
        assert_true(u_hash(a * 77777u) == reference_hash(a * 77777u) && amb_hash(a) == reference_hash(a));
    assert_true(f_unit(0xffffffffu) == 1.0f - 1.0f / 16777216.0f && amb_unit(0xffu) == 0.0f);
}

/* ---- widths -------------------------------------------------------------------------------------------------------
 */

static void fill(const lanes_case *test, int input, float *out, size_t count)
{
    lanes_floats_in((uint64_t)input + (uint64_t)test->name[0], -300.0f, 300.0f, out, count);
    lanes_any_floats((uint64_t)input, out, count / 4);
}
static void every_width_gives_the_same_bits(void **state)
{
    (void)state;
    size_t compared;
    assert_int_equal(lanes_mismatches(&noise_set, 1u << 14, fill, &compared), 0);
    assert_true(compared > 500000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_match_the_definition),
        cmocka_unit_test(slopes_are_derivatives),
        cmocka_unit_test(second_derivatives_of_value2),
        cmocka_unit_test(cells_meet_without_a_step),
        cmocka_unit_test(lattice_offset_is_a_move),
        cmocka_unit_test(fbm_sums_octaves),
        cmocka_unit_test(random_is_uniform),
        cmocka_unit_test(neighbours_are_independent),
        cmocka_unit_test(hash_mixes_every_bit),
        cmocka_unit_test(every_width_gives_the_same_bits),
    };
    return cmocka_run_group_tests_name("noise", tests, NULL, NULL);
}
