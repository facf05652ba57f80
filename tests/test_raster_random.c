/* Random passes against the pixel-by-pixel truth: every state, topology and hostile vertex, bit for bit. */
#include "tests/raster_random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define BYTES 4096

#ifdef __has_feature
#if __has_feature(thread_sanitizer)
#define FEWER 4 /* twenty times slower */
#endif
#endif
#ifndef FEWER
#define FEWER 1
#endif

static void random_passes_match_the_truth(void **state)
{
    (void)state;
    const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    const int passes = getenv("AMBIANCE_TEST_LONG") ? 30000 : 500 / FEWER;
    uint64_t random = 11;
    for (int i = 0; i < 3; i++) {
        amb_context *context = NULL;
        amb_context_options options = {isas[i], 1 + i * 2};
        if (!amb_isa_available(isas[i]))
            continue;
        assert_int_equal(amb_context_create(&options, &context, NULL), AMB_OK);
        for (int n = 0; n < passes; n++) {
            uint8_t bytes[BYTES];
            char what[64] = "";
            uint64_t seed = random;
            for (int k = 0; k < BYTES; k++) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                bytes[k] = (uint8_t)(random >> 56);
            }
            long differences = raster_random_differences(context, bytes, BYTES, what);
            if (differences != 0)
                fail_msg("%s, pass %d (seed %llu): %ld pixels differ, first %s", amb_isa_name(isas[i]), n,
                         (unsigned long long)seed, differences, what);
        }
        amb_context_close(&context);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_passes_match_the_truth)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
