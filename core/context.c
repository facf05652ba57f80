#include "core/spare.h"

#include <fenv.h>
#include <omp.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define MAX_THREADS 1024

typedef struct spare {
    _Atomic(void *) block;
    void (*_Atomic release)(void *block);
} spare;

struct amb_context {
    amb_isa isa;
    int threads;
    spare *spare; /* the only part that changes */
};

int amb_isa_available(amb_isa isa)
{
#if defined(__x86_64__)
    __builtin_cpu_init();
    int v2 = __builtin_cpu_supports("ssse3") && __builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("sse4.2") &&
             __builtin_cpu_supports("popcnt");
    int v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
             __builtin_cpu_supports("bmi2");
    int v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl");
#else
    int v2 = 1, v3 = 0, v4 = 0;
#endif
    switch (isa) {
    case AMB_ISA_AUTO:
    case AMB_ISA_V2:
        return v2;
    case AMB_ISA_V3:
        return v3;
    case AMB_ISA_V4:
        return v4;
    }
    return 0;
}

const char *amb_isa_name(amb_isa isa)
{
    return isa == AMB_ISA_V2 ? "v2" : isa == AMB_ISA_V3 ? "v3" : isa == AMB_ISA_V4 ? "v4" : "auto";
}

amb_status amb_isa_parse(const char *name, amb_isa *out, amb_error *error)
{
    static const amb_isa all[] = {AMB_ISA_AUTO, AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(name, amb_isa_name(all[i])) == 0) {
            *out = all[i];
            return AMB_OK;
        }
    return amb_fail(error, AMB_ERROR_ARGUMENT, "instruction set '%s': allowed are auto, v2, v3, v4", name);
}

static amb_isa widest_isa(void)
{
    return amb_isa_available(AMB_ISA_V4) ? AMB_ISA_V4 : amb_isa_available(AMB_ISA_V3) ? AMB_ISA_V3 : AMB_ISA_V2;
}

amb_status amb_context_create(const amb_context_options *options, amb_context **out, amb_error *error)
{
    amb_context_options use = options ? *options : (amb_context_options){0};
    *out = NULL;
    if (use.isa == AMB_ISA_AUTO)
        use.isa = widest_isa();
    if (!amb_isa_available(use.isa))
        return amb_fail(error, AMB_ERROR_ISA, "instruction set %s: this processor has %s at most",
                        amb_isa_name(use.isa),
                        amb_isa_available(AMB_ISA_V2) ? amb_isa_name(widest_isa()) : "less than v2");
    if (use.threads < 0 || use.threads > MAX_THREADS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "threads %d: allowed are 0 (one per processor) to %d", use.threads,
                        MAX_THREADS);
    if (use.threads == 0)
        use.threads = omp_get_num_procs() < MAX_THREADS ? omp_get_num_procs() : MAX_THREADS;
    amb_context *context = malloc(sizeof *context);
    spare *kept = calloc(1, sizeof *kept);
    if (!context || !kept) {
        free(context);
        free(kept);
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a context");
    }
    *context = (amb_context){.isa = use.isa, .threads = use.threads, .spare = kept};
    *out = context;
    return AMB_OK;
}

void *amb_spare_take(const amb_context *context) { return atomic_exchange(&context->spare->block, NULL); }

void amb_spare_keep(const amb_context *context, void *block, void (*release)(void *block))
{
    atomic_store(&context->spare->release, release);
    void *old = atomic_exchange(&context->spare->block, block);
    if (old)
        release(old);
}

void amb_context_close(amb_context **context)
{
    if (!context || !*context)
        return;
    spare *kept = (*context)->spare;
    if (kept->block)
        kept->release(kept->block);
    free(kept);
    free(*context);
    *context = NULL;
}

amb_isa amb_context_isa(const amb_context *context) { return context->isa; }
int amb_context_threads(const amb_context *context) { return context->threads; }
const char *amb_version(void) { return AMB_VERSION; }

/* A host program may have set flush-to-zero or another rounding mode; frames must not notice. */
static void float_mode_default(fenv_t *saved)
{
    fegetenv(saved);
    fesetenv(FE_DFL_ENV);
}

/* The indices one thread begins with; when they are done it helps with the others'. Neighbours mostly share data: this
 * way they mostly meet in one processor's caches. */
typedef struct share {
    _Alignas(64) atomic_int next;
    int end;
} share;

void amb_parallel_for(const amb_context *context, int count, void (*body)(void *user, int index, int thread),
                      void *user)
{
    int threads = context->threads < count ? context->threads : count;
    if (threads <= 1) {
        fenv_t saved;
        float_mode_default(&saved);
        for (int i = 0; i < count; i++)
            body(user, i, 0);
        fesetenv(&saved);
        return;
    }
    share shares[MAX_THREADS];
    for (int t = 0; t < threads; t++) {
        shares[t].next = (int)((int64_t)count * t / threads);
        shares[t].end = (int)((int64_t)count * (t + 1) / threads);
    }
#pragma omp parallel num_threads(threads)
    {
        fenv_t saved;
        float_mode_default(&saved);
        const int thread = omp_get_thread_num();
        for (int k = 0; k < threads; k++) {
            share *s = &shares[(thread + k) % threads];
            for (int i; (i = atomic_fetch_add(&s->next, 1)) < s->end;)
                body(user, i, thread);
        }
        fesetenv(&saved);
    }
}
