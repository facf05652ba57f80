/* The machine's peaks: multiply-and-add throughput as our code may use it (two instructions, never fused), and copy
 * bandwidth. */
#include "bench/bench.h"
#include "core/dispatch.h"

#include <stdlib.h>
#include <string.h>

/* Returns a value so that nothing is optimised away; FLOPS_PER_ROUND in each lane and round. */
AMB_DECLARE_WIDE(float, peak_flops, (long rounds));
enum { CHAINS = 12, FLOPS_PER_ROUND = 2 * CHAINS, FLOPS_TASKS = 64 };

/* ---- flops --------------------------------------------------------------------------------------------------------
 */

typedef struct flops_state {
    long rounds; /* of one lane; lanes and tasks share them */
    long share;
    float (*kernel)(long rounds);
    volatile float sink[FLOPS_TASKS];
} flops_state;

static amb_status flops_open(const bench_options *options, void **state, amb_error *error)
{
    flops_state *s = calloc(1, sizeof *s);
    *state = s;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the flops workload");
    s->rounds = options->quick ? 16000000 : 64000000;
    return AMB_OK;
}
static void flops_task(void *user, int index, int thread)
{
    flops_state *s = user;
    (void)thread;
    s->sink[index] = s->kernel(s->share);
}
static amb_status flops_run(void *state, const amb_context *context, amb_error *error)
{
    flops_state *s = state;
    (void)error;
    s->share = s->rounds / ((long)amb_context_isa(context) * FLOPS_TASKS);
    s->kernel = AMB_DISPATCH(amb_context_isa(context), peak_flops);
    amb_parallel_for(context, FLOPS_TASKS, flops_task, s);
    return AMB_OK;
}
static bench_count flops_count(const void *state, const amb_context *context)
{
    const flops_state *s = state;
    (void)context;
    return (bench_count){.flops = (double)s->rounds * FLOPS_PER_ROUND};
}

const bench_workload bench_flops = {
    .name = "flops",
    .about = "multiply then add, 12 independent chains: the peak of code without fused multiply-add",
    .open = flops_open,
    .run = flops_run,
    .count = flops_count,
    .close = free,
};

/* ---- copy ---------------------------------------------------------------------------------------------------------
 */

enum { COPY_TASKS = 64 };
typedef struct copy_state {
    size_t bytes;
    char *from, *to;
} copy_state;

static void copy_close(void *state)
{
    copy_state *s = state;
    if (s) {
        free(s->from);
        free(s->to);
        free(s);
    }
}
static amb_status copy_open(const bench_options *options, void **state, amb_error *error)
{
    copy_state *s = calloc(1, sizeof *s);
    *state = s;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the copy workload");
    s->bytes = options->quick ? (size_t)64 << 20 : (size_t)256 << 20; /* well past any cache */
    s->from = malloc(s->bytes);
    s->to = malloc(s->bytes);
    if (!s->from || !s->to)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to copy %zu bytes", s->bytes);
    memset(s->from, 1, s->bytes);
    memset(s->to, 2, s->bytes);
    return AMB_OK;
}
static void copy_task(void *user, int index, int thread)
{
    const copy_state *s = user;
    size_t part = s->bytes / COPY_TASKS;
    (void)thread;
    memcpy(s->to + (size_t)index * part, s->from + (size_t)index * part, part);
}
static amb_status copy_run(void *state, const amb_context *context, amb_error *error)
{
    (void)error;
    amb_parallel_for(context, COPY_TASKS, copy_task, state);
    return AMB_OK;
}
static bench_count copy_count(const void *state, const amb_context *context)
{
    const copy_state *s = state;
    (void)context;
    return (bench_count){.bytes = 2.0 * (double)s->bytes};
}

const bench_workload bench_copy = {
    .name = "copy",
    .about = "memcpy of more than any cache holds; bytes read and written both count",
    .open = copy_open,
    .run = copy_run,
    .count = copy_count,
    .close = copy_close,
};
