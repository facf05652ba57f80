/* 12 independent multiply-add chains: more than latency × ports on any processor so far, and they fit 16 registers. */
#include <ambiance/wide.h>

#define peak_flops WIDE(peak_flops)
float peak_flops(long rounds);

#define EVERY(statement)                                                                                    \
    statement(0) statement(1) statement(2) statement(3) statement(4) statement(5) statement(6) statement(7) \
        statement(8) statement(9) statement(10) statement(11)
#define DECLARE(i) f32x a##i = seed + (float)(i);
#define STEP(i) a##i = a##i * factor + term;
#define SUM(i) sum += a##i;

float peak_flops(long rounds)
{
    /* Opaque, so that the loop cannot be folded; the fixed point is 0.5, so that nothing becomes denormal. */
    volatile float opaque[3] = {0.5f, 0.875f, 0.0625f};
    f32x seed = f_set(opaque[0]), factor = f_set(opaque[1]), term = f_set(opaque[2]), sum = f_set(0.0f);
    EVERY(DECLARE)
    for (long i = 0; i < rounds; i++) {
        EVERY(STEP)
    }
    EVERY(SUM)
    return f_lane(sum, 0);
}
