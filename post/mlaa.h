/* Morphological anti-aliasing: what its two files share. Not part of the public API.
 *
 * Names, for an image with rows downwards:
 *   right(x, y)  the discontinuity between pixels (x, y) and (x + 1, y); runs of them down a column are vertical lines
 *   down(x, y)   that between (x, y) and (x, y + 1); runs of them along a row are horizontal lines
 * A discontinuity is one bit; a row's (or column's) bits are words of 64, the lowest bit first. */
#ifndef AMB_POST_MLAA_H
#define AMB_POST_MLAA_H

#include "post/scratch.h"

#include <ambiance/wide.h>

#define MLAA_TILE 64   /* pixels a side; as many as a word has bits */
#define MLAA_REACH 255 /* steps a line's end is looked for */

typedef struct mlaa_change { /* a pixel's new colour, kept until every tile has read its neighbours */
    size_t at;
    float rgb[3];
} mlaa_change;

typedef struct mlaa_tile_memory {
    float weight[4][MLAA_TILE][MLAA_TILE]; /* up, down, left, right; zero between tiles */
    uint64_t dirty[MLAA_TILE];             /* a bit for each pixel with a weight */
} mlaa_tile_memory;

typedef struct mlaa_work {
    const amb_image *color;
    const amb_context *context;
    float gain, threshold; /* light is multiplied by gain for detection; threshold in CIE Lab distance */
    float corners;         /* weights are multiplied by this at the corners of long crossing lines */
    int tiles_x, tiles_y;
    size_t row_words, column_words;
    uint64_t *right, *down;               /* [y][row_words] */
    uint64_t *right_column, *down_column; /* the same transposed: [x][column_words] */
    size_t *first_change, *changes;       /* a tile: its part of `change` and how many it used */
    mlaa_change *change;
    mlaa_tile_memory *memory;                      /* one a thread */
    amb_image *edges, *distance, *shape, *weights; /* intermediates, or NULL */
} mlaa_work;

/* Finds the discontinuities of `color`. */
#define amb_mlaa_detect WIDE(amb_mlaa_detect)
void amb_mlaa_detect(mlaa_work *work);

/* From the discontinuities to the blended picture. Errors: MEMORY. */
#define amb_mlaa_blend WIDE(amb_mlaa_blend)
amb_status amb_mlaa_blend(mlaa_work *work, amb_scratch *scratch, amb_error *error);

/* Fills the layers edges, distance and shape; those of the work that are NULL are left out. */
#define amb_mlaa_show WIDE(amb_mlaa_show)
void amb_mlaa_show(const mlaa_work *work);

#endif
