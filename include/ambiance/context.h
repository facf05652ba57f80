/* The context: what every job shares and nobody changes after creation: instruction set, threads. There is no global
 * state; make as many contexts as you like. A context may be used from several threads at once. It keeps a pass's
 * working memory for the next one, some 12 MiB a thread. */
#ifndef AMBIANCE_CONTEXT_H
#define AMBIANCE_CONTEXT_H

#include <ambiance/error.h>

typedef enum amb_isa {
    AMB_ISA_AUTO = 0, /* the widest this processor has */
    AMB_ISA_V2 = 4,   /* x86-64-v2 (SSE4.2), or the baseline of another architecture: 4 lanes */
    AMB_ISA_V3 = 8,   /* x86-64-v3 (AVX2): 8 lanes */
    AMB_ISA_V4 = 16,  /* x86-64-v4 (AVX-512): 16 lanes */
} amb_isa;            /* the value is the number of lanes */

typedef struct amb_context amb_context;

typedef struct amb_context_options {
    amb_isa isa; /* 0: the widest available */
    int threads; /* 0: one per processor this process may run on; 1…1024 */
} amb_context_options;

/* options may be NULL: all defaults. *out is NULL on error. Errors: ISA, ARGUMENT, MEMORY. */
amb_status amb_context_create(const amb_context_options *options, amb_context **out, amb_error *error);
/* Frees and nulls *context; NULL and a NULL handle are allowed. No job of it may be running. */
void amb_context_close(amb_context **context);

amb_isa amb_context_isa(const amb_context *context);
int amb_context_threads(const amb_context *context);
/* "v2", "v3", "v4"; "auto" for AUTO. */
const char *amb_isa_name(amb_isa isa);
/* Parses those names; ARGUMENT names the bad value and the allowed ones. */
amb_status amb_isa_parse(const char *name, amb_isa *out, amb_error *error);
/* Does this processor (and operating system) run it? */
int amb_isa_available(amb_isa isa);

/* Calls body(user, index, thread) for index 0…count-1 over the context's threads and returns when all are done.
 * thread is 0…threads-1, for per-thread scratch. Order is unspecified: a body writes only what its index owns. Each
 * call runs with the IEEE defaults (round to nearest, denormals kept), whatever the caller's thread had set. */
void amb_parallel_for(const amb_context *context, int count, void (*body)(void *user, int index, int thread),
                      void *user);

/* MAJOR.MINOR.PATCH of the library: part of every file's metadata. */
const char *amb_version(void);

#endif
