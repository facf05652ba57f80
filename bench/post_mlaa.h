/* The peer's anti-aliasing, for the workloads that have one. */
#ifndef AMB_BENCH_POST_MLAA_H
#define AMB_BENCH_POST_MLAA_H

#include "bench/post.h"

typedef struct peer_mlaa {
    GLuint detect, weigh, blend;
    post_target *edges, *weights;
} peer_mlaa;

amb_status peer_mlaa_open(post_state *s, peer_mlaa *m, amb_error *error);
void peer_mlaa_draw(const peer_mlaa *m, GLuint source, const post_target *to);

#endif
