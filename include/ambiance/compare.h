/* Comparing frames value by value: per layer and channel, exactly, by absolute difference and by ULP.
 *
 * A value differs when its bits do: NaN equals only a NaN of the same bits, -0 and +0 differ. Without a tolerance every
 * differing value is over. With one (or both) a differing value is over unless |a - b| ≤ tolerance or the two are at
 * most max_ulp representable floats apart; a differing value of which either is NaN is always over. Pure functions; any
 * thread. */
#ifndef AMBIANCE_COMPARE_H
#define AMBIANCE_COMPARE_H

#include <ambiance/frame.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct amb_compare_options {
    bool use_tolerance, use_ulp;
    double tolerance; /* absolute, in the values' own units, 0 or more */
    uint64_t max_ulp;
    double peak;       /* of the PSNR; 0 means 1, display white */
    const char *layer; /* compare this layer only; NULL: all */
} amb_compare_options;

typedef struct amb_difference {
    uint64_t values;      /* pairs looked at */
    uint64_t differing;   /* pairs whose bits differ */
    uint64_t over;        /* pairs over the tolerance */
    uint64_t nan;         /* differing pairs of which either is NaN; they count in nothing below */
    double max_abs;       /* greatest |a - b|; infinite when an infinity met anything else */
    uint64_t max_ulp;     /* greatest number of steps from float to float between a and b; 0 from -0 to +0 */
    double rmse;          /* √(mean (a - b)²) */
    double psnr;          /* 20·log10(peak / rmse), decibels; infinite when rmse is 0 */
    int worst_x, worst_y; /* pixel of the first greatest |a - b|, or else of the first differing value; -1 if none */
} amb_difference;

typedef enum amb_presence { AMB_IN_BOTH, AMB_ONLY_IN_A, AMB_ONLY_IN_B } amb_presence;

typedef struct amb_compare_row { /* one channel of one layer */
    char layer[32];
    int channel;           /* 0…3: R G B A (X of a single one) */
    amb_presence presence; /* what only one frame has is not compared, and fails */
    amb_difference difference;
} amb_compare_row;

typedef struct amb_comparison {
    bool passed;          /* same size, same layers and channels, no value over */
    bool sizes_differ;    /* then nothing was compared and there are no rows */
    amb_difference total; /* over all rows in both */
    int row_count;
    amb_compare_row row[]; /* in A's order, then what only B has */
} amb_comparison;

/* Floats between a and b, counting every representable value once and both zeros as one; UINT64_MAX if either is NaN.
 */
uint64_t amb_ulp_distance(float a, float b);

/* One channel of two images of the same size. */
amb_difference amb_compare_channel(const amb_image *a, const amb_image *b, int channel,
                                   const amb_compare_options *options);

/* options may be NULL: exact. Free *out with free(). Errors: ARGUMENT (tolerance or peak out of range), NOT_FOUND
 * (options->layer is in neither frame), MEMORY. A failed comparison is not an error. */
amb_status amb_compare_frames(const amb_frame *a, const amb_frame *b, const amb_compare_options *options,
                              amb_comparison **out, amb_error *error);

/* |a - b| of every layer and channel in both: 0 where the bits are equal, infinite where either is NaN. Errors:
 * ARGUMENT (sizes differ, nothing in common), MEMORY. */
amb_status amb_compare_difference(const amb_frame *a, const amb_frame *b, const char *layer, amb_frame **out,
                                  amb_error *error);

#endif
