/* What the post workloads share: a picture, a chain applied to it, and the peer's full-screen passes. */
#ifndef AMB_BENCH_POST_H
#define AMB_BENCH_POST_H

#include "bench/bench.h"

#include <ambiance/post.h>

#define POST_TARGETS 10

typedef struct post_target { /* the peer's picture: a texture to draw to and to read from */
    GLuint frame, texture;
    int width, height;
} post_target;

typedef struct post_state {
    amb_frame *frame;   /* what a run leaves */
    amb_image *picture; /* what a run starts from; every value is a half float's */
    const char *text;   /* the chain */
    const amb_context *context[2 * 3];
    amb_chain *chain[2 * 3]; /* one a context, made in its first run */
    bool has_peer;
    GLuint array, source; /* the picture as an RGBA16F texture */
    GLuint program[POST_TARGETS];
    post_target target[POST_TARGETS];
    int programs, targets;
    const post_target *result; /* what difference() reads */
} post_state;

/* The state and its picture; with a peer, the picture as a texture. */
amb_status post_open(const bench_options *options, const char *chain, post_state **out, amb_error *error);
void post_close(void *state);
/* Copies the picture into the frame. */
amb_status post_prepare(void *state, amb_error *error);
/* Applies the chain to the frame, in place; the peer draws to another target, as it must. */
amb_status post_run(void *state, const amb_context *context, amb_error *error);
amb_status post_difference(void *state, double *rmse, amb_error *error);

/* A full-screen fragment program: `out vec4 result`, uniform samplers t0 … t2 on units 0 … 2. */
amb_status post_program(post_state *s, const char *fragment, GLuint *out, amb_error *error);
/* RGBA16F, or RG8 for flags. */
amb_status post_target_add(post_state *s, int width, int height, bool flags, post_target **out, amb_error *error);
/* Draws the program over the whole target, reading these textures (0: none). */
void post_draw(const post_target *to, GLuint program, GLuint t0, GLuint t1, GLuint t2);

#endif
