/* The post chain: passes as descriptors, applied in order to a frame's "color" layer. */
#ifndef AMBIANCE_POST_H
#define AMBIANCE_POST_H

#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/param.h>

typedef struct amb_post_job {
    const amb_context *context;
    const void *params;   /* the pass's parameter struct */
    amb_frame *frame;     /* reads any layer, changes "color"; may add layers when `intermediates` */
    long frame_index;     /* for grain and noise: repeats exactly per index */
    int intermediates;    /* add "pass.step" layers for every intermediate */
} amb_post_job;

typedef struct amb_post_pass {
    const char *name, *about;
    amb_params params;
    amb_status (*apply)(const amb_post_job *job, amb_error *error);
} amb_post_pass;

int amb_post_count(void);
const amb_post_pass *amb_post_by_index(amb_isa isa, int index);
const amb_post_pass *amb_post_by_name(amb_isa isa, const char *name);

/* A chain: "bloom:threshold=1,intensity=0.3;display:curve=filmic"; "" or "none" is the empty chain. */
typedef struct amb_chain amb_chain;
amb_status amb_chain_create(const amb_context *context, const char *text, amb_chain **out, amb_error *error);
amb_status amb_chain_apply(const amb_chain *chain, amb_frame *frame, long frame_index, int intermediates,
                           amb_error *error);
void amb_chain_close(amb_chain **chain);

#endif
