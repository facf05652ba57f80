/* Benchmarks: one workload a file, each ending in one const descriptor; workloads.c has a line for each.
 *
 * Every workload is timed over a grid of instruction sets and thread counts and, where it has one, against a peer: the
 * same work written in GLSL and run by Mesa's llvmpipe on the same cores in the same process. Rows alternate, round by
 * round, so that a change of the machine's clock or load meets them all. */
#ifndef AMB_BENCH_BENCH_H
#define AMB_BENCH_BENCH_H

#include "bench/gl.h"

#include <ambiance/context.h>
#include <ambiance/image.h>
#include <stdbool.h>

typedef struct bench_options {
    bool quick;        /* fewer rounds and a quarter of the pixels */
    int width, height; /* of pictures */
    int threads;       /* the larger thread count of the grid */
    gl *peer;          /* NULL: no peer is available */
} bench_options;

typedef struct bench_count {
    double flops; /* + − × ÷ √ of one run; 0: not counted */
    double bytes; /* moved to and from memory at least; 0: not counted */
    double items; /* what `unit` names, of one run; 0: none */
    const char *unit;
} bench_count;

/* Further figures of a workload: what its stages take, what it counts. */
enum { BENCH_MAX_FACTS = 24 };
typedef struct bench_facts {
    int count;
    struct {
        const char *name, *unit; /* static */
        double value;
    } fact[BENCH_MAX_FACTS];
} bench_facts;
void bench_fact(bench_facts *facts, const char *name, double value, const char *unit); /* appends */

typedef struct bench_workload {
    const char *name, *about;
    amb_status (*open)(const bench_options *options, void **state, amb_error *error);
    /* Before every run of ours, not timed: puts back what a run changes. May be NULL. */
    amb_status (*prepare)(void *state, amb_error *error);
    /* Once, start to finish. */
    amb_status (*run)(void *state, const amb_context *context, amb_error *error);
    /* The same work on the peer, finished when it returns. NULL: there is no such thing. */
    amb_status (*run_peer)(void *state, amb_error *error);
    /* Root mean square difference of the two last pictures, per channel: how far both did the same work. */
    amb_status (*difference)(void *state, double *rmse, amb_error *error);
    /* Of one run on a context; may be NULL. */
    bench_count (*count)(const void *state, const amb_context *context);
    /* Once, untimed, on the widest context with all threads; may be NULL. */
    amb_status (*facts)(void *state, const amb_context *context, bench_facts *facts, amb_error *error);
    void (*close)(void *state);     /* NULL is allowed */
    double peer_goal;               /* times the peer's speed that we aim at; 0: none */
    double threads_goal, wide_goal; /* all threads against one; v3 against v2; 0: none */
} bench_workload;

extern const bench_workload *const bench_workloads[]; /* NULL-ended; the first two measure the machine's peaks */
extern const bench_workload bench_flops, bench_copy, bench_julia, bench_earth;
extern const bench_workload bench_layers, bench_mesh, bench_mesh_million, bench_mesh_samples, bench_tiny, bench_shadow;
extern const bench_workload bench_draws, bench_memory, bench_elevated, bench_patches;
extern const bench_workload bench_post_bloom, bench_post_mlaa, bench_post_chain;

/* The table of scenes; not 0 when one failed. json: objects of a list that the caller opens and closes. */
int bench_scenes(const bench_options *options, int frames, bool json);

double bench_seconds(void); /* a clock that only goes forward */
/* Root mean square difference of the first three channels of a planar image and interleaved RGBA pixels, rows from the
 * bottom as GL reads them. */
double bench_rmse(const amb_image *image, const float *rgba);

#endif
