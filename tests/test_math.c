/* The transcendental functions against double precision, and every width against one lane. */
#include "lanes.h"

#include <ambiance/context.h>
#include <ambiance/math.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

LANES_DECLARE(lanes_math);
LANES_DECLARE(lanes_primitives);
static const lanes_set math_set = LANES_SET(lanes_math);
static const lanes_set primitive_set = LANES_SET(lanes_primitives);

#define BATCH 4096

/* ---- one argument: over every exponent --------------------------------------------------------------------------- */

typedef struct truth {
    const char *name;
    double (*libm)(double);
    float (*twin)(float);
    double max_ulp; /* as math.h states it */
} truth;

static const truth truths[] = {
    {"exp", exp, amb_exp, 1.05},   {"exp2", exp2, amb_exp2, 1.05}, {"log", log, amb_log, 1.0},
    {"log2", log2, amb_log2, 1.0}, {"sin", sin, amb_sin, 1.0},     {"cos", cos, amb_cos, 1.0},
    {"tan", tan, amb_tan, 2.0},    {"asin", asin, amb_asin, 2.0},  {"acos", acos, amb_acos, 2.0},
    {"atan", atan, amb_atan, 2.0}, {"cbrt", cbrt, amb_cbrt, 1.0},
};
#define TRUTHS (sizeof truths / sizeof *truths)

typedef struct worst {
    double ulp;
    float a, b, got;
} worst;

static void measure(const truth *t, const lanes_case *test, const float *a, worst *w)
{
    float result[BATCH];
    test->run(&a, (float *const[]){result}, BATCH);
    for (int i = 0; i < BATCH; i++) {
        double ulp = lanes_ulp(result[i], t->libm((double)a[i]));
        if (ulp > w->ulp)
            *w = (worst){ulp, a[i], 0.0f, result[i]};
    }
}

/* Bit patterns first, first + stride, … up to and including last. */
static void sweep(const truth *t, const lanes_case *test, uint32_t first, uint32_t last, uint32_t stride, worst *w)
{
    float a[BATCH];
    for (uint64_t next = first; next <= last;) {
        for (int i = 0; i < BATCH; i++, next += stride) {
            uint32_t bits = next <= last ? (uint32_t)next : last;
            memcpy(&a[i], &bits, 4);
        }
        measure(t, test, a, w);
    }
}

static void stated_ulp_over_every_exponent(void **state)
{
    (void)state;
    for (size_t f = 0; f < TRUTHS; f++) {
        const truth *t = &truths[f];
        const lanes_case *test = lanes_find(lanes_widest(&math_set), t->name);
        assert_non_null(test);
        worst w = {0.0, 0.0f, 0.0f, 0.0f};
        sweep(t, test, 0u, 0x7fffffffu, 1511u, &w);          /* +0 … +NaN */
        sweep(t, test, 0x80000000u, 0xffffffffu, 1511u, &w); /* -0 … -NaN */
        sweep(t, test, 0x3c000000u, 0x46400000u, 173u, &w);  /* 2⁻⁷ … 12 288, denser */
        sweep(t, test, 0xbc000000u, 0xc6400000u, 173u, &w);
        sweep(t, test, 0x3f7ff000u, 0x3f801000u, 1u, &w); /* around 1, where logarithms cancel */
        printf("    %-5s %.3f ULP at %a\n", t->name, w.ulp, (double)w.a);
        if (w.ulp > t->max_ulp)
            fail_msg("f_%s(%a) = %a is %.3f ULP off, stated %.2f", t->name, (double)w.a, (double)w.got, w.ulp,
                     t->max_ulp);
    }
}

/* Floats next to multiples of π/2, where the reduction cancels most. */
static void trigonometry_next_to_quarter_turns(void **state)
{
    (void)state;
    for (size_t f = 4; f < 7; f++) {
        const truth *t = &truths[f];
        const lanes_case *test = lanes_find(lanes_widest(&math_set), t->name);
        worst w = {0.0, 0.0f, 0.0f, 0.0f};
        float a[BATCH];
        for (int start = 1; start < 60000; start += BATCH / 4) {
            for (int i = 0; i < BATCH; i++) {
                float near = (float)((start + i / 4) * 1.57079632679489661923);
                a[i] = i % 4 == 0   ? near
                       : i % 4 == 1 ? nextafterf(near, 0.0f)
                       : i % 4 == 2 ? nextafterf(near, 1e9f)
                                    : -near;
            }
            measure(t, test, a, &w);
        }
        assert_true(w.ulp <= t->max_ulp);
    }
    /* 16367173·2⁷², the double of W. Kahan's hardest cases, and the float nearest to a multiple of π/2 */
    assert_true(lanes_ulp(amb_cos(0x1.f37b0ap+95f), cos(0x1.f37b0ap+95)) <= 1.0);
    assert_true(lanes_ulp(amb_sin(16367173.0f * 0x1p72f), sin(16367173.0 * 0x1p72)) <= 1.0);
    assert_true(lanes_ulp(amb_cos(FLT_MAX), cos((double)FLT_MAX)) <= 1.0);
}

/* ---- two arguments ----------------------------------------------------------------------------------------------- */

static void measure_two(double (*libm)(double, double), const lanes_case *test, const float *a, const float *b,
                        worst *w)
{
    float result[BATCH];
    test->run((const float *const[]){a, b}, (float *const[]){result}, BATCH);
    for (int i = 0; i < BATCH; i++) {
        double ulp = lanes_ulp(result[i], libm((double)a[i], (double)b[i]));
        if (ulp > w->ulp)
            *w = (worst){ulp, a[i], b[i], result[i]};
    }
}

/* Exponents that spread the result over the whole float range, denormals and the two limits included. */
static void exponents_in_range(uint64_t seed, const float *base, float *exponent)
{
    lanes_floats_in(seed, -151.0f, 129.0f, exponent, BATCH);
    for (int i = 0; i < BATCH; i++) {
        double log2_base = log2((double)base[i]);
        exponent[i] = log2_base != 0.0 ? (float)((double)exponent[i] / log2_base) : exponent[i];
    }
}

static void stated_ulp_of_pow(void **state)
{
    (void)state;
    const lanes_case *test = lanes_find(lanes_widest(&math_set), "pow");
    worst w = {0.0, 0.0f, 0.0f, 0.0f};
    float a[BATCH], b[BATCH];
    for (uint64_t k = 0; k < 400; k++) {
        lanes_any_floats(k * 2, a, BATCH);
        lanes_any_floats(k * 2 + 1, b, BATCH);
        measure_two(pow, test, a, b, &w);
        for (int i = 0; i < BATCH; i++)
            a[i] = fabsf(a[i]) > 0.0f && isfinite(a[i]) ? fabsf(a[i]) : 3.0f;
        exponents_in_range(k, a, b);
        measure_two(pow, test, a, b, &w);
        lanes_floats_in(k, 0.5f, 2.0f, a, BATCH);
        exponents_in_range(k + 1000, a, b);
        measure_two(pow, test, a, b, &w);
        for (int i = 0; i < BATCH; i++) { /* integer powers of either sign */
            a[i] = i & 1 ? -a[i] : a[i] + 1.0f;
            b[i] = (float)(i % 41 - 20);
        }
        measure_two(pow, test, a, b, &w);
    }
    printf("    pow   %.3f ULP at %a, %a\n", w.ulp, (double)w.a, (double)w.b);
    assert_true(w.ulp <= 1.5);
}

/* f_powi at one lane; the specular lobes' tests hold its lanes to that. */
static void stated_ulp_of_powi(void **state)
{
    (void)state;
    float a[BATCH];
    for (int n = 0; n <= 1024; n = n < 20 ? n + 1 : n * 9 / 8) {
        double worst_share = 0.0;
        lanes_floats_in((uint64_t)n, -2.0f, 2.0f, a, BATCH);
        for (int i = 0; i < BATCH; i++) {
            double exact = pow((double)a[i], n);
            if (fabs(exact) < (double)FLT_MIN || fabs(exact) > (double)FLT_MAX)
                continue;
            worst_share = fmax(worst_share, lanes_ulp(f_powi(a[i], n), exact) / (n > 1 ? n - 1 : 1));
        }
        assert_true(worst_share <= (n > 1 ? 1.0 : 0.0));
    }
}

static void stated_ulp_of_atan2(void **state)
{
    (void)state;
    const lanes_case *test = lanes_find(lanes_widest(&math_set), "atan2");
    worst w = {0.0, 0.0f, 0.0f, 0.0f};
    float y[BATCH], x[BATCH];
    for (uint64_t k = 0; k < 500; k++) {
        lanes_any_floats(k * 2, y, BATCH);
        lanes_any_floats(k * 2 + 1, x, BATCH);
        measure_two(atan2, test, y, x, &w);
        lanes_floats_in(k * 2, -1.0f, 1.0f, y, BATCH);
        lanes_floats_in(k * 2 + 1, -1.0f, 1.0f, x, BATCH);
        measure_two(atan2, test, y, x, &w);
    }
    printf("    atan2 %.3f ULP at %a, %a\n", w.ulp, (double)w.a, (double)w.b);
    assert_true(w.ulp <= 2.5);
}

/* ---- edges ------------------------------------------------------------------------------------------------------ */

static bool same(float a, float b) { return (isnan(a) && isnan(b)) || (a == b && signbit(a) == signbit(b)); }

/* C17 Annex F.10, and the sign of zero. */
static void edges_follow_annex_f(void **state)
{
    (void)state;
    static const float special[] = {0.0f,    -0.0f, 1.0f,   -1.0f,       2.0f,         -2.0f,      3.0f,
                                    -3.0f,   0.5f,  -0.5f,  INFINITY,    -INFINITY,    NAN,        1e-40f,
                                    -1e-40f, 3e38f, -3e38f, 16777215.0f, -16777215.0f, 16777216.0f};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++) {
        float a = special[i];
        for (size_t f = 0; f < TRUTHS; f++) {
            float want = (float)truths[f].libm((double)a), got = truths[f].twin(a);
            bool exact = want == 0.0f || !isfinite(want);
            if (exact ? !same(got, want) : lanes_ulp(got, (double)want) > 2.0)
                fail_msg("%s(%g) = %g, not %g", truths[f].name, (double)a, (double)got, (double)want);
            if (signbit(got) != signbit(want) && !isnan(want))
                fail_msg("%s(%g) = %g has the wrong sign", truths[f].name, (double)a, (double)got);
        }
        for (size_t j = 0; j < sizeof special / sizeof *special; j++) {
            float b = special[j];
            float power = powf(a, b), angle = atan2f(a, b);
            if (lanes_ulp(amb_pow(a, b), (double)power) > 2.0 ||
                (!isnan(power) && signbit(power) != signbit(amb_pow(a, b))))
                fail_msg("pow(%g, %g) = %g, not %g", (double)a, (double)b, (double)amb_pow(a, b), (double)power);
            if (lanes_ulp(amb_atan2(a, b), (double)angle) > 2.5 ||
                (!isnan(angle) && signbit(angle) != signbit(amb_atan2(a, b))))
                fail_msg("atan2(%g, %g) = %g, not %g", (double)a, (double)b, (double)amb_atan2(a, b), (double)angle);
        }
    }
}

/* Values that are exact in any decent library. */
static void exact_values(void **state)
{
    (void)state;
    for (int n = -149; n < 128; n++) {
        assert_true(amb_exp2((float)n) == ldexpf(1.0f, n));
        assert_true(amb_log2(ldexpf(1.0f, n)) == (float)n);
        assert_true(amb_pow(2.0f, (float)n) == ldexpf(1.0f, n));
    }
    for (int n = -200; n <= 200; n++)
        assert_true(amb_cbrt((float)n * (float)n * (float)n) == (float)n);
    assert_true(amb_exp(0.0f) == 1.0f && amb_exp(1.0f) == 2.71828175f && amb_log(1.0f) == 0.0f);
    assert_true(amb_sin(AMB_PI) == -8.74227766e-08f && amb_cos(AMB_PI) == -1.0f && amb_cos(0.0f) == 1.0f);
    assert_true(amb_acos(-1.0f) == AMB_PI && amb_asin(1.0f) == AMB_HALF_PI && amb_acos(1.0f) == 0.0f);
    assert_true(amb_atan2(0.0f, -1.0f) == AMB_PI && amb_atan(INFINITY) == AMB_HALF_PI);
    for (int n = 0; n < 12; n++)
        assert_true(amb_pow(3.0f, (float)n) == (float)pow(3.0, n));
}

/* ---- widths ------------------------------------------------------------------------------------------------------ */

static void fill_any(const lanes_case *test, int input, float *out, size_t count)
{
    lanes_any_floats((uint64_t)(input * 77) + (uint64_t)test->name[0] * 1000003u, out, count);
    for (size_t i = 0; i < count; i += 3) /* a third in the everyday range */
        lanes_floats_in(i + (uint64_t)input, -20.0f, 20.0f, out + i, 1);
}

static void every_width_gives_the_same_bits(void **state)
{
    (void)state;
    size_t compared, wrong = lanes_mismatches(&math_set, 1u << 17, fill_any, &compared);
    assert_int_equal(wrong, 0);
    assert_true(compared >= (1u << 17) * 15u);
    wrong = lanes_mismatches(&primitive_set, 1u << 17, fill_any, &compared);
    assert_int_equal(wrong, 0);
}

static void twins_are_the_lanes(void **state)
{
    (void)state;
    float a[BATCH], b[BATCH], want[BATCH];
    lanes_any_floats(5, a, BATCH);
    lanes_any_floats(6, b, BATCH);
    for (size_t f = 0; f < TRUTHS; f++) {
        lanes_find(lanes_widest(&math_set), truths[f].name)
            ->run((const float *const[]){a}, (float *const[]){want}, BATCH);
        for (int i = 0; i < BATCH; i++)
            assert_true(same(truths[f].twin(a[i]), want[i]));
    }
    lanes_find(lanes_widest(&math_set), "pow")->run((const float *const[]){a, b}, (float *const[]){want}, BATCH);
    for (int i = 0; i < BATCH; i++)
        assert_true(same(amb_pow(a[i], b[i]), want[i]));
    lanes_find(lanes_widest(&math_set), "atan2")->run((const float *const[]){a, b}, (float *const[]){want}, BATCH);
    for (int i = 0; i < BATCH; i++)
        assert_true(same(amb_atan2(a[i], b[i]), want[i]));
}

/* wide.h's rounding, conversion and minimum against their definitions. */
static void primitives_are_what_they_say(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < 2000000; i++) {
        float v[2];
        lanes_any_floats(lanes_random(&seed), v, 2);
        if (i & 1)
            v[0] = (float)((int)(lanes_random(&seed) % 4000001) - 2000000) * 0.25f;
        float a = v[0], b = v[1];
        assert_true(same(f_floor(a), floorf(a)) && same(f_ceil(a), ceilf(a)));
        assert_true(same(f_trunc(a), truncf(a)) && same(f_round(a), rintf(a)));
        assert_true(same(f_min(a, b), a < b ? a : b) && same(f_max(a, b), a > b ? a : b));
        assert_true(same(f_sqrt(a), sqrtf(a)) && same(f_copysign(a, b), copysignf(a, b)));
        double clamped = isnan(a) ? -2147483648.0 : fmin(fmax((double)a, -2147483648.0), 2147483520.0);
        assert_true(f_to_i(a) == (int32_t)clamped);
        assert_true((f_is_finite(a) & 1) == (isfinite(a) != 0) && (f_is_nan(a) & 1) == (isnan(a) != 0));
        float s = f_saturate(a);
        assert_true(s >= 0.0f && s <= 1.0f && (isnan(a) ? s == 0.0f : (a <= 0.0f || a >= 1.0f || s == a)));
    }
    assert_true(f_smoothstep(2.0f, 4.0f, 3.0f) == 0.5f && f_smoothstep(2.0f, 4.0f, 9.0f) == 1.0f);
    assert_true(f_smoothstep(2.0f, 4.0f, 2.5f) == 0.15625f && f_fract(-0.25f) == 0.75f);
}

int lanes_structure_x1(void);
int lanes_structure_x4(void);
int lanes_structure_x8(void);
int lanes_structure_x16(void);

static void lanes_masks_blocks_and_quads(void **state)
{
    (void)state;
    assert_int_equal(lanes_structure_x1(), 0);
    if (amb_isa_available(AMB_ISA_V2))
        assert_int_equal(lanes_structure_x4(), 0);
#if defined(__x86_64__)
    if (amb_isa_available(AMB_ISA_V3))
        assert_int_equal(lanes_structure_x8(), 0);
    if (amb_isa_available(AMB_ISA_V4))
        assert_int_equal(lanes_structure_x16(), 0);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stated_ulp_over_every_exponent),
        cmocka_unit_test(trigonometry_next_to_quarter_turns),
        cmocka_unit_test(stated_ulp_of_pow),
        cmocka_unit_test(stated_ulp_of_powi),
        cmocka_unit_test(stated_ulp_of_atan2),
        cmocka_unit_test(edges_follow_annex_f),
        cmocka_unit_test(exact_values),
        cmocka_unit_test(every_width_gives_the_same_bits),
        cmocka_unit_test(twins_are_the_lanes),
        cmocka_unit_test(primitives_are_what_they_say),
        cmocka_unit_test(lanes_masks_blocks_and_quads),
    };
    return cmocka_run_group_tests_name("math", tests, NULL, NULL);
}
