/* Holds a lane function to its one-lane, plain-C self, bit by bit, at every instruction set of this processor.
 *
 * A case is a function of some floats to some floats. lanes_*_wide.c files list cases in a table per variant:
 *
 *     LANES_CASE(saturate, 1, 1, { out[0] = f_saturate(in[0]); })
 *     const lanes_case WIDE(lanes_math)[] = {LANES_ENTRY(saturate, 1, 1), {0}};
 */
#ifndef AMB_TESTS_LANES_H
#define AMB_TESTS_LANES_H

#include <stddef.h>
#include <stdint.h>

#define LANES_MAX 16 /* inputs or outputs of a case, and lanes */

typedef struct lanes_case {
    const char *name;
    int inputs, outputs;
    void (*run)(const float *const *in, float *const *out, size_t count); /* count: a multiple of LANES_MAX */
} lanes_case;

#define LANES_CASE(NAME, INPUTS, OUTPUTS, ...)                                       \
    static void NAME##_run(const float *const *from, float *const *to, size_t count) \
    {                                                                                \
        for (size_t i = 0; i < count; i += AMB_LANES) {                              \
            f32x in[INPUTS], out[OUTPUTS];                                           \
            for (int k = 0; k < (INPUTS); k++)                                       \
                in[k] = f_load(from[k] + i);                                         \
            __VA_ARGS__                                                              \
            for (int k = 0; k < (OUTPUTS); k++)                                      \
                f_store(to[k] + i, out[k]);                                          \
        }                                                                            \
    }
#define LANES_ENTRY(NAME, INPUTS, OUTPUTS) \
    {                                      \
#NAME, INPUTS, OUTPUTS, NAME##_run \
    }

#if defined(__x86_64__)
#define LANES_DECLARE(table) extern const lanes_case table##_x1[], table##_x4[], table##_x8[], table##_x16[]
#define LANES_SET(table)                                \
    {                                                   \
        table##_x1, table##_x4, table##_x8, table##_x16 \
    }
#else
#define LANES_DECLARE(table) extern const lanes_case table##_x1[], table##_x4[]
#define LANES_SET(table)                   \
    {                                      \
        table##_x1, table##_x4, NULL, NULL \
    }
#endif

typedef struct lanes_set {
    const lanes_case *x1, *x4, *x8, *x16;
} lanes_set;

/* The table of the widest instruction set of this processor. */
const lanes_case *lanes_widest(const lanes_set *set);
const lanes_case *lanes_find(const lanes_case *table, const char *name);

/* Floats of any bit pattern, an edge case (zeros, infinities, NaN, denormals, limits) every few. */
void lanes_any_floats(uint64_t seed, float *out, size_t count);
/* Uniform in [lo, hi). */
void lanes_floats_in(uint64_t seed, float lo, float hi, float *out, size_t count);
uint64_t lanes_random(uint64_t *state);

/* Runs every case of the set on `count` inputs from fill (which gets the case and the input's index), at one lane and
 * at every available width. Returns the number of outputs whose bits differ (two NaN are equal), naming the first on
 * stderr. *compared counts outputs. */
size_t lanes_mismatches(const lanes_set *set, size_t count,
                        void (*fill)(const lanes_case *test, int input, float *out, size_t count), size_t *compared);

/* |got - want| in units of the last place of the float nearest `want`; NaN for NaN and Inf for Inf are 0 apart, any
 * other disagreement about them is 10⁹. */
double lanes_ulp(float got, double want);

#endif
