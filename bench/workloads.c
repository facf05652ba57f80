/* The registry: one line a workload. The machine's peaks come first, as others are told against them. */
#include "bench/bench.h"

const bench_workload *const bench_workloads[] = {
    &bench_flops,        &bench_copy,   &bench_julia,      &bench_layers,    &bench_mesh,       &bench_mesh_million,
    &bench_mesh_samples, &bench_tiny,   &bench_shadow,     &bench_draws,     &bench_patches,    &bench_elevated,
    &bench_earth,        &bench_memory, &bench_post_bloom, &bench_post_mlaa, &bench_post_chain, NULL,
};
