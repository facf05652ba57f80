#ifndef TESTS_JULIA_PROBE_H
#define TESTS_JULIA_PROBE_H

#include "scenes/julia.h"

typedef struct julia_probed {
    float distance, trap;
    v3 normal;
} julia_probed;

void probe_julia_x1(const julia_set *set, const v3 *point, int count, julia_probed *out);
void probe_julia_x4(const julia_set *set, const v3 *point, int count, julia_probed *out);
#if defined(__x86_64__)
void probe_julia_x8(const julia_set *set, const v3 *point, int count, julia_probed *out);
void probe_julia_x16(const julia_set *set, const v3 *point, int count, julia_probed *out);
#endif

#endif
