/* The post chain: passes as descriptors, applied in order to a frame's "color" layer.
 *
 * A pass is one of two kinds. A whole-frame pass (`apply`) does as it likes. A streaming pass works on short pieces of
 * rows (`span`), after an optional look at the whole frame (`collect`); the chain fuses neighbouring streaming passes
 * into one sweep over memory, so that a pixel is read and written once for all of them. */
#ifndef AMBIANCE_POST_H
#define AMBIANCE_POST_H

#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/param.h>
#include <stdbool.h>

typedef struct amb_scratch amb_scratch; /* memory that a chain keeps from frame to frame; see post/scratch.h */

typedef struct amb_post_job {
    const amb_context *context;
    const void *params;   /* the pass's parameter struct */
    amb_frame *frame;     /* reads any layer, changes "color"; may add layers when `intermediates` */
    long frame_index;     /* for grain and noise: repeats exactly per index */
    int intermediates;    /* add "pass.step" layers for every intermediate */
    amb_image *color;     /* the frame's "color": 3 channels or more */
    amb_scratch *scratch; /* the chain's reusable memory */
} amb_post_job;

#define AMB_POST_BAND 8    /* rows a collect call gets, aligned; the last band may be shorter */
#define AMB_POST_SPAN 1024 /* most pixels of a span */

/* A piece of one row of "color", changed in place. Pointers are 64-byte aligned; whole lanes may be loaded and stored:
 * pixels past the image's width are row padding. */
typedef struct amb_post_span {
    float *rgb[3];
    int x, y;  /* of the first pixel; x is a multiple of 16 */
    int count; /* pixels, a multiple of 16 */
} amb_post_span;

typedef struct amb_post_pass {
    const char *name, *about;
    amb_params params;
    size_t state_size; /* bytes of the state below: zeroed for every frame */

    /* Whole frame at once; NULL for a streaming pass, which has the others instead. */
    amb_status (*apply)(const amb_post_job *job, amb_error *error);

    /* Streaming, in this order. begin (may be NULL) fills the state and reads no pixel; it sets *collects when the
     * pass must see the whole frame first. collect is called for each band of rows, from many threads (thread is
     * 0…threads-1), and only reads; finish (may be NULL) runs once after it; then span changes the pixels. */
    amb_status (*begin)(const amb_post_job *job, void *state, bool *collects, amb_error *error);
    void (*collect)(const amb_post_job *job, void *state, int y0, int y1, int thread);
    void (*finish)(const amb_post_job *job, void *state);
    void (*span)(const amb_post_job *job, const void *state, const amb_post_span *span);
} amb_post_pass;

/* The registry, in listing order, for an instruction set. NULL when there is none such. */
int amb_post_count(void);
const amb_post_pass *amb_post_by_index(amb_isa isa, int index);
const amb_post_pass *amb_post_by_name(amb_isa isa, const char *name);

/* A chain: "bloom:threshold=1,intensity=0.3;display:curve=filmic". Passes are separated by ';', parameters by
 * ','; blanks around either are ignored; a vector's commas belong to it. "" and "none" are the empty chain. The same
 * pass may stand more than once; at most AMB_MAX_CHAIN of them. Errors: NOT_FOUND (pass, parameter), ARGUMENT, LIMIT,
 * MEMORY; one line each. `context` must outlive the chain. */
#define AMB_MAX_CHAIN 32
typedef struct amb_chain amb_chain;
amb_status amb_chain_create(const amb_context *context, const char *text, amb_chain **out, amb_error *error);
void amb_chain_close(amb_chain **chain); /* frees and nulls */

/* Applies every pass in order to frame's "color" (3 or 4 channels; alpha is left as it is). frame_index seeds grain and
 * displacement. Equal inputs give equal bits whatever the context's threads and instruction set. One chain may be
 * applied to several frames at once, from several threads. Errors: ARGUMENT, LIMIT (too many layers), MEMORY; the
 * frame's colour is then unspecified. */
amb_status amb_chain_apply(const amb_chain *chain, amb_frame *frame, long frame_index, int intermediates,
                           amb_error *error);

/* The chain as text with every parameter written out: what a file's metadata keeps. amb_chain_create reads it back to
 * the same bits. Returns the length as snprintf does. */
int amb_chain_print(const amb_chain *chain, char *text, size_t size);

#endif
