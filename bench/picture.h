/* One picture of a raster workload, made twice: by a pass of ours and by the peer. */
#ifndef AMB_BENCH_PICTURE_H
#define AMB_BENCH_PICTURE_H

#include "bench/bench.h"

#include <ambiance/raster.h>

typedef struct picture {
    amb_image *color, *depth; /* ours; color NULL in a depth-only picture */
    int samples;              /* 1 or 4 */
    v4 clear_color;
    amb_pass_stats stats; /* of our last pass */
    bool has_peer;
    gl_target target;       /* the peer's */
    gl_target multisampled; /* with samples: what the peer draws to; `target` gets their average */
} picture;

/* RGBA and depth, samples 1 or 4. */
amb_status picture_open(const bench_options *options, int samples, picture *out, amb_error *error);
/* Depth alone, size² pixels. */
amb_status picture_open_depth(const bench_options *options, int size, picture *out, amb_error *error);
void picture_close(picture *p);

/* Ours: begins a pass, records `count` draws, finishes. */
amb_status picture_pass(picture *p, const amb_context *context, const amb_draw *draw, size_t count, amb_error *error);
/* The peer's: binds and clears the target; depth test LESS, back faces culled, no blending. */
void picture_peer_begin(const picture *p);
/* Averages samples, waits for the peer. */
amb_status picture_peer_end(const picture *p, amb_error *error);

/* RMSE of the colours, or of the depths where there are none. */
amb_status picture_difference(const picture *p, double *rmse, amb_error *error);
/* The pass again, with its stages timed: each stage's share, and counts of the pass. */
amb_status picture_facts(picture *p, const amb_context *context, const amb_draw *draw, size_t count, bench_facts *facts,
                         amb_error *error);
/* Bytes that a pass must write at least: every pixel of every image once. */
double picture_bytes(const picture *p);

#endif
