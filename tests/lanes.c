#include "lanes.h"

#include <ambiance/context.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const lanes_case *lanes_widest(const lanes_set *set)
{
    if (set->x16 && amb_isa_available(AMB_ISA_V4))
        return set->x16;
    if (set->x8 && amb_isa_available(AMB_ISA_V3))
        return set->x8;
    return amb_isa_available(AMB_ISA_V2) ? set->x4 : set->x1;
}

const lanes_case *lanes_find(const lanes_case *table, const char *name)
{
    for (; table->name; table++)
        if (!strcmp(table->name, name))
            return table;
    return NULL;
}

/* splitmix64 (G. Steele, D. Lea, C. Flood, OOPSLA 2014) */
uint64_t lanes_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

void lanes_any_floats(uint64_t seed, float *out, size_t count)
{
    static const float edges[] = {0.0f,         -0.0f,         1.0f,      -1.0f,  0.5f,      -0.5f,       2.0f,
                                  -2.0f,        INFINITY,      -INFINITY, NAN,    FLT_MIN,   -FLT_MIN,    FLT_MAX,
                                  -FLT_MAX,     1e-45f,        -1e-45f,   1e-39f, 8388608.f, 8388607.5f,  16777216.0f,
                                  2147483648.f, -2147483648.f, 2.5f,      -2.5f,  1.5f,      0.49999997f, -3.0f};
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = lanes_random(&seed);
        uint32_t low = (uint32_t)bits;
        if ((bits >> 32) % 5 == 0)
            out[i] = edges[(bits >> 40) % (sizeof edges / sizeof *edges)];
        else
            memcpy(&out[i], &low, 4);
    }
}

void lanes_floats_in(uint64_t seed, float lo, float hi, float *out, size_t count)
{
    for (size_t i = 0; i < count; i++)
        out[i] = lo + (hi - lo) * ((float)(lanes_random(&seed) >> 40) * 0x1p-24f);
}

static size_t compare(const lanes_case *test, const char *isa, float *const *in, float *const *want, float *const *got,
                      size_t count)
{
    size_t wrong = 0;
    for (int k = 0; k < test->outputs; k++)
        for (size_t i = 0; i < count; i++) {
            if (!memcmp(&want[k][i], &got[k][i], 4) || (isnan(want[k][i]) && isnan(got[k][i])))
                continue;
            if (!wrong++) {
                fprintf(stderr, "%s at %s, output %d: %a, at one lane %a, of", test->name, isa, k, (double)got[k][i],
                        (double)want[k][i]);
                for (int j = 0; j < test->inputs; j++)
                    fprintf(stderr, " %a", (double)in[j][i]);
                fprintf(stderr, "\n");
            }
        }
    return wrong;
}

size_t lanes_mismatches(const lanes_set *set, size_t count,
                        void (*fill)(const lanes_case *test, int input, float *out, size_t count), size_t *compared)
{
    const lanes_case *const wide[3] = {set->x4, set->x8, set->x16};
    static const amb_isa isa[3] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    float *block = malloc(3 * LANES_MAX * count * sizeof *block);
    if (!block)
        abort();
    float *in[LANES_MAX], *want[LANES_MAX], *got[LANES_MAX];
    for (size_t k = 0; k < LANES_MAX; k++) {
        in[k] = block + k * count;
        want[k] = block + (LANES_MAX + k) * count;
        got[k] = block + (2 * LANES_MAX + k) * count;
    }
    size_t wrong = 0;
    *compared = 0;
    for (size_t c = 0; set->x1[c].name; c++) {
        const lanes_case *test = &set->x1[c];
        for (int k = 0; k < test->inputs; k++)
            fill(test, k, in[k], count);
        test->run((const float *const *)in, want, count);
        for (int w = 0; w < 3; w++)
            if (wide[w] && amb_isa_available(isa[w])) {
                wide[w][c].run((const float *const *)in, got, count);
                wrong += compare(test, amb_isa_name(isa[w]), in, want, got, count);
                *compared += count * (size_t)test->outputs;
            }
    }
    free(block);
    return wrong;
}

double lanes_ulp(float got, double want)
{
    float nearest = (float)want;
    if (isnan(want) || isnan(got))
        return isnan(want) && isnan(got) ? 0.0 : 1e9;
    if (isinf(want) || isinf(got)) {
        if (got == nearest)
            return 0.0;
        /* a finite truth beyond FLT_MAX may round either way */
        return !isinf(want) && fabs(want) > 0x1.fffffcp127 && fabsf(got) >= FLT_MAX && (got > 0) == (want > 0) ? 1.0
                                                                                                               : 1e9;
    }
    int exponent;
    frexp(want, &exponent);
    return fabs((double)got - want) / ldexp(1.0, (exponent < -125 ? -125 : exponent) - 24);
}
