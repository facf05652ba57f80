/* Frames and chains for the post tests. Every helper fails the running test on an error. */
#ifndef AMB_TESTS_POST_FRAMES_H
#define AMB_TESTS_POST_FRAMES_H

#include <ambiance/post.h>
#include <stdint.h>

uint32_t post_random(uint32_t *state); /* 32 bits, repeatable */
float post_uniform(uint32_t *state, float lo, float hi);

/* HDR pictures: soft gradients with noise, and some discs and bars of light up to 20. */
amb_frame *post_picture(int width, int height, uint32_t seed);
amb_frame *post_copy(const amb_frame *frame); /* of layer "color" */
/* Applies a chain; isa 0 is the widest. */
void post_apply(amb_frame *frame, const char *chain, amb_isa isa, int threads, long frame_index, int intermediates);
/* Fails, naming the first differing pixel, unless all layers of both have the same bits (any NaN equals any NaN). */
void post_assert_same(const amb_frame *a, const amb_frame *b, const char *what);

#endif
