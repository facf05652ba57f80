/* <ambiance/half.h> against values computed in double from the bit layouts: every half and every 11- and 10-bit float,
 * and the rounding between neighbours, on every instruction set. */
#include "tests/texture_probes.h"
#include "tests/texture_reference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { ALL_HALVES = 65536 };
static float floats[3 * ALL_HALVES];
static uint32_t words[ALL_HALVES];

static bool same_value(double a, double b) { return isnan(a) ? isnan(b) : a == b && signbit(a) == signbit(b); }

static void test_halves_exhaustively(void **unused)
{
    (void)unused;
    for (const int *lanes = probe_lanes(); *lanes; lanes++) {
        for (uint32_t i = 0; i < ALL_HALVES; i++)
            words[i] = i;
        probe_half(*lanes, HALF_DECODE, floats, words, ALL_HALVES);
        for (uint32_t i = 0; i < ALL_HALVES; i++)
            assert_true(same_value((double)floats[i], ref_half(i)));
        probe_half(*lanes, HALF_ENCODE, floats, words, ALL_HALVES);
        for (uint32_t i = 0; i < ALL_HALVES; i++) {
            bool nan = (i & 0x7fff) > 0x7c00;
            assert_int_equal(words[i], nan ? i | 0x200 : i); /* NaNs come back quiet, with their payload */
        }
    }
}

/* Between neighbouring halves: below, at and above the middle, where ties go to the even one. */
static void test_half_rounding(void **unused)
{
    (void)unused;
    enum { STEPS = 0x7c00 };
    for (const int *lanes = probe_lanes(); *lanes; lanes++)
        for (int side = -1; side <= 1; side++) {
            for (uint32_t i = 0; i < STEPS; i++) {
                double up = i + 1 < STEPS ? ref_half(i + 1) : 65536.0; /* what the next exponent would give */
                float middle = (float)((ref_half(i) + up) / 2.0);      /* exact in float */
                floats[i] = side ? nextafterf(middle, side < 0 ? 0.0f : 1e9f) : middle;
            }
            probe_half(*lanes, HALF_ENCODE, floats, words, STEPS);
            for (uint32_t i = 0; i < STEPS; i++)
                assert_int_equal(words[i], side < 0 ? i : side > 0 ? i + 1 : i + (i & 1));
        }
}

static void test_small_floats_exhaustively(void **unused)
{
    (void)unused;
    for (const int *lanes = probe_lanes(); *lanes; lanes++) {
        for (uint32_t i = 0; i < 2048; i++)
            words[i] = i | (2047 - i) << 11 | (i % 1024) << 22;
        probe_half(*lanes, SMALL_DECODE, floats, words, 2048);
        for (uint32_t i = 0; i < 2048; i++) {
            assert_true(same_value((double)floats[3 * i], ref_small(i, 6)));
            assert_true(same_value((double)floats[3 * i + 1], ref_small(2047 - i, 6)));
            assert_true(same_value((double)floats[3 * i + 2], ref_small(i % 1024, 5)));
        }
        probe_half(*lanes, SMALL_ENCODE, floats, words, 2048);
        for (uint32_t i = 0; i < 2048; i++) {
            uint32_t red = words[i] & 0x7ff, blue = words[i] >> 22;
            assert_int_equal(red, i > 31 << 6 ? 31 << 6 | 1 << 5 : i); /* every NaN is the quiet one */
            assert_int_equal(blue, i % 1024 > 31 << 5 ? 31 << 5 | 1 << 4 : i % 1024);
        }
    }
}

static void test_small_float_rounding(void **unused)
{
    (void)unused;
    enum { STEPS = (31 << 6) - 1 }; /* up to the last pair of finite values */
    for (const int *lanes = probe_lanes(); *lanes; lanes++) {
        for (int side = -1; side <= 1; side++) {
            int count = (STEPS + 15) / 16 * 16;
            for (int i = 0; i < count; i++) {
                unsigned bits = (unsigned)(i < STEPS ? i : 0);
                float middle = (float)((ref_small(bits, 6) + ref_small(bits + 1, 6)) / 2.0);
                floats[3 * i] = side ? nextafterf(middle, side < 0 ? 0.0f : 1e9f) : middle;
                floats[3 * i + 1] = -floats[3 * i];
                floats[3 * i + 2] = 1e9f;
            }
            probe_half(*lanes, SMALL_ENCODE, floats, words, count);
            for (uint32_t i = 0; i < STEPS; i++) {
                assert_int_equal(words[i] & 0x7ff, side < 0 ? i : side > 0 ? i + 1 : i + (i & 1));
                assert_int_equal(words[i] >> 11 & 0x7ff, 0);     /* negative: zero */
                assert_int_equal(words[i] >> 22, (31 << 5) - 1); /* too large: the largest */
            }
        }
        for (int i = 0; i < 16; i++)
            floats[3 * i] = INFINITY, floats[3 * i + 1] = -INFINITY, floats[3 * i + 2] = NAN;
        probe_half(*lanes, SMALL_ENCODE, floats, words, 16);
        assert_int_equal(words[0], 31 << 6 | (uint32_t)(31 << 5 | 16) << 22);
    }
}
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_halves_exhaustively),
        cmocka_unit_test(test_half_rounding),
        cmocka_unit_test(test_small_floats_exhaustively),
        cmocka_unit_test(test_small_float_rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
