/* What the tests of the tessellation and geometry stages share: random numbers, contexts, one draw to one image. */
#ifndef TESTS_STAGE_DRAWS_H
#define TESTS_STAGE_DRAWS_H

#include "tests/stage_shaders.h"

extern uint64_t random_state; /* of the functions below; tests set it to repeat themselves */
uint32_t random_bits(void);
float uniform(float lo, float hi);
int pick(int count);       /* 0…count-1 */
float random_factor(void); /* of tessellation: mostly small ones, whole ones, almost whole ones, ones out of range */

/* These fail the test instead of returning an error. */
amb_context *make_context(amb_isa isa, int threads);
amb_image *draw_image(const amb_context *context, const amb_draw *draw, int width, int height, int tile_size,
                      size_t batch_bytes, amb_pass_stats *stats);
void assert_same_pixels(const amb_image *a, const amb_image *b);
void refuse(amb_pass *pass, const amb_draw *draw, const char *text); /* ARGUMENT, in a line that holds the text */

#endif
