#include "post/scratch.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define ALIGNMENT 64

typedef struct block {
    struct block *next;
    unsigned char *bytes; /* ALIGNMENT-aligned, owned */
    size_t size, used;
} block;

struct amb_scratch {
    block *first;     /* newest first */
    amb_image *spare; /* swapped in for a layer's pixels; NULL until needed */
};

static block *block_create(size_t size)
{
    block *made = malloc(sizeof *made);
    if (!made)
        return NULL;
    *made = (block){.bytes = aligned_alloc(ALIGNMENT, size), .size = size};
    if (!made->bytes) {
        free(made);
        return NULL;
    }
    return made;
}

static void blocks_close(block *first)
{
    while (first) {
        block *next = first->next;
        free(first->bytes);
        free(first);
        first = next;
    }
}

amb_scratch *amb_scratch_create(void) { return calloc(1, sizeof(amb_scratch)); }

void amb_scratch_close(amb_scratch *scratch)
{
    if (!scratch)
        return;
    blocks_close(scratch->first);
    amb_image_close(&scratch->spare);
    free(scratch);
}

/* Several blocks become one of their joint size, so that the next frame's needs are met by one. */
void amb_scratch_reset(amb_scratch *scratch)
{
    if (scratch->first && scratch->first->next) {
        size_t total = 0;
        for (block *b = scratch->first; b; b = b->next)
            total += b->size;
        blocks_close(scratch->first);
        scratch->first = block_create(total); /* NULL is fine: taken again when needed */
    }
    if (scratch->first)
        scratch->first->used = 0;
}

void *amb_scratch_take(amb_scratch *scratch, size_t count, size_t size)
{
    if (size && count > (SIZE_MAX / 2 - ALIGNMENT) / size)
        return NULL;
    size_t bytes = (count * size + ALIGNMENT) / ALIGNMENT * ALIGNMENT; /* never 0 */
    block *b = scratch->first;
    if (!b || b->size - b->used < bytes) {
        size_t least = (size_t)1 << 16;
        b = block_create(bytes > least ? bytes : least);
        if (!b)
            return NULL;
        b->next = scratch->first;
        scratch->first = b;
    }
    void *taken = b->bytes + b->used;
    b->used += bytes;
    return taken;
}

amb_status amb_scratch_swap(amb_scratch *scratch, amb_image *image, amb_image *old, amb_error *error)
{
    amb_image *spare = scratch->spare;
    if (spare && (spare->width != image->width || spare->height != image->height || spare->channels != image->channels))
        amb_image_close(&scratch->spare);
    if (!scratch->spare) {
        amb_status status = amb_image_create(image->width, image->height, image->channels, &scratch->spare, error);
        if (status != AMB_OK)
            return status;
    }
    *old = *image;
    image->data = scratch->spare->data;
    scratch->spare->data = old->data;
    return AMB_OK;
}

amb_status amb_post_layer(const amb_post_job *job, const char *name, int channels, amb_image **out, amb_error *error)
{
    *out = amb_frame_layer(job->frame, name);
    if (!*out)
        return amb_frame_add_layer(job->frame, name, channels, out, error);
    if ((*out)->channels != channels)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "layer '%s': the frame has one of %d channels, post needs %d", name,
                        (*out)->channels, channels);
    return AMB_OK;
}
