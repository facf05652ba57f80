/* Stage times, for those who ask: ticks of the processor's time stamp counter. They never touch a pixel. */
#ifndef AMBIANCE_RASTER_CLOCK_H
#define AMBIANCE_RASTER_CLOCK_H

#include <ambiance/raster.h>

/* 0 on a processor that has no such counter for us. */
static inline uint64_t raster_ticks(void)
{
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return 0;
#endif
}

/* Adds the ticks since `from` to a stage and gives the time now. Does nothing when `timed` is false. */
static inline uint64_t raster_lap(bool timed, amb_pass_stats *stats, amb_stage stage, uint64_t from)
{
    if (!timed)
        return 0;
    uint64_t now = raster_ticks();
    stats->ticks[stage] += now - from;
    return now;
}

static inline uint64_t raster_start(bool timed) { return timed ? raster_ticks() : 0; }

#endif
