/* The peer's bloom, for the workloads that have one. */
#ifndef AMB_BENCH_POST_BLOOM_H
#define AMB_BENCH_POST_BLOOM_H

#include "bench/post.h"

typedef struct peer_bloom {
    GLuint bright, across, down;
    post_target *half[2]; /* at quarter size, in turn */
} peer_bloom;

amb_status peer_bloom_open(post_state *s, peer_bloom *b, amb_error *error);
/* The blurred excess of `source`, in the first target. */
void peer_bloom_draw(const peer_bloom *b, GLuint source);

#endif
