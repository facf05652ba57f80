/* Memory a chain keeps from frame to frame, so that a sequence allocates once. Not part of the public API.
 *
 * A scratch serves one frame at a time. Everything taken from it is given back together when that frame is done; the
 * next frame gets the same memory again, uncleared. */
#ifndef AMB_POST_SCRATCH_H
#define AMB_POST_SCRATCH_H

#include <ambiance/post.h>

/* count elements of `size` bytes, aligned to 64, uncleared; NULL when memory is out or count · size overflows. Called
 * from the thread that applies the chain only. */
void *amb_scratch_take(amb_scratch *scratch, size_t count, size_t size);

/* Gives the frame's layer another block of pixels of the same size, and hands out the old one, which stays readable
 * until the frame is done: how a whole-frame pass reads what it overwrites. The new pixels are unspecified. Layers of
 * the frame keep their amb_image. MEMORY on failure. */
amb_status amb_scratch_swap(amb_scratch *scratch, amb_image *image, amb_image *old, amb_error *error);

/* The job's layer of that name for an intermediate, made when the frame has none; ARGUMENT when it has one of another
 * number of channels. */
amb_status amb_post_layer(const amb_post_job *job, const char *name, int channels, amb_image **out, amb_error *error);

/* Used by the chain. */
amb_scratch *amb_scratch_create(void); /* NULL: out of memory */
void amb_scratch_reset(amb_scratch *scratch);
void amb_scratch_close(amb_scratch *scratch);

#endif
