/* A glow: a reduced, blurred copy of a frame, shared by bloom, bright-pass bloom and the colour adjustment's blur.
 *
 *   collect: each pixel through the pass's own filter, averaged over reduce × reduce cells, blurred along rows;
 *   finish:  blurred along columns;   span: bilinearly up-sampled and put to use by the pass.
 *
 * The rows' blurs all run before the columns': they commute, so the result is that of row, column, row, column, …, and
 * a full-size pixel is read once, a reduced one written twice. Outside the image the nearest pixel counts. */
#ifndef AMB_POST_GLOW_H
#define AMB_POST_GLOW_H

#include "post/lanes.h"
#include "post/scratch.h"

#include <ambiance/vec.h>

#define GLOW_TAPS 8
#define GLOW_LEFT 16        /* cells kept left of a row: copies of its first */
#define GLOW_RIGHT 64       /* and right of it: copies of its last, and alignment */
#define GLOW_BLOCK 64       /* pixels that may be left out together where nothing glows */
#define GLOW_LIMIT 65504.0f /* the largest half float: what an RGBA16F target would hold */

typedef struct glow {
    int reduce;        /* 2, 4 or 8 pixels a cell, each way */
    int width, height; /* cells */
    size_t stride;     /* floats a row of cells, margins included */
    float *plane[3];   /* cell (0, 0); row y starts at y · stride */
    float tap[GLOW_TAPS];
    int taps, first, rounds; /* blurred(i) = Σ tap[k]·cell(i + first + k), `rounds` times each way */
    float *thread_memory;
    size_t thread_floats;
} glow;

static const char *const glow_reductions[] = {"half", "quarter", "eighth", NULL}; /* reduce = 2 << choice */

/* Fills *g but for the taps. reduce is 2, 4 or 8. */
#define amb_glow_begin WIDE(amb_glow_begin)
amb_status amb_glow_begin(const amb_post_job *job, int reduce, glow *g, amb_error *error);

/* Seven taps of a Gaussian of `sigma` cells (0 < sigma), which sum to 1 within 1 ULP; three rounds. */
#define amb_glow_gaussian WIDE(amb_glow_gaussian)
void amb_glow_gaussian(glow *g, float sigma);

/* One row of cells from its sums over `reduce` rows of pixels (three rows, one a channel, at `sums`). */
#define amb_glow_reduce_row WIDE(amb_glow_reduce_row)
void amb_glow_reduce_row(const glow *g, float *sums, int cell_y, int thread);

#define amb_glow_finish WIDE(amb_glow_finish)
void amb_glow_finish(const amb_post_job *job, const glow *g);

AMB_INLINE size_t glow_sum_floats(const glow *g) { return ((size_t)g->width + 15) / 16 * 16 * (size_t)g->reduce; }

/* The span's cells, from that left of its first pixel's on, blended between rows and multiplied by scale:
 * out[c][0 … count/reduce + 2), and then some more of the row. */
#define GLOW_SPAN_CELLS (AMB_POST_SPAN / 2 + 64)
#define amb_glow_rows WIDE(amb_glow_rows)
void amb_glow_rows(const glow *g, const amb_post_span *span, float scale, float (*out)[GLOW_SPAN_CELLS]);

/* collect's whole body. `keep` (or NULL) gets the filtered pixels at full size. */
AMB_INLINE void glow_collect(const glow *g, const amb_image *color, int y0, int y1, int thread,
                             v3x (*filter)(const void *user, v3x rgb), const void *user, const amb_image *keep)
{
    size_t row = glow_sum_floats(g);
    float *sums = g->thread_memory + (size_t)thread * g->thread_floats;
    int columns = (int)color->stride;
    for (int cell_y = y0 / g->reduce; cell_y * g->reduce < y1; cell_y++) {
        for (int j = 0; j < g->reduce; j++) {
            int y = cell_y * g->reduce + j;
            y = y < color->height ? y : color->height - 1;
            const float *r = amb_image_row(color, 0, y), *gr = amb_image_row(color, 1, y),
                        *b = amb_image_row(color, 2, y);
            for (int x = 0; x < columns; x += AMB_LANES) {
                v3x f = filter(user, (v3x){f_load(r + x), f_load(gr + x), f_load(b + x)});
                if (keep) {
                    f_store(amb_image_row(keep, 0, y) + x, f.x);
                    f_store(amb_image_row(keep, 1, y) + x, f.y);
                    f_store(amb_image_row(keep, 2, y) + x, f.z);
                }
                float *s = sums + x;
                f_store(s, j ? f_load(s) + f.x : f.x);
                f_store(s + row, j ? f_load(s + row) + f.y : f.y);
                f_store(s + 2 * row, j ? f_load(s + 2 * row) + f.z : f.z);
            }
        }
        for (int c = 0; c < 3; c++) /* the last pixel counts beyond the edge */
            for (size_t x = (size_t)color->width; x < (size_t)g->width * (size_t)g->reduce; x++)
                sums[(size_t)c * row + x] = sums[(size_t)c * row + (size_t)color->width - 1];
        amb_glow_reduce_row(g, sums, cell_y, thread);
    }
}

/* ---- bilinear up-sampling ---------------------------------------------------------------------------------------- */

/* Where the pixels of a group of lanes lie among the cells: constant along a row, but alternating when a group is
 * narrower than a cell. */
typedef struct glow_lanes {
    i32x index; /* of the cell left of the pixel, from the group's first */
    f32x t;     /* weight of the cell right of it */
} glow_lanes;

AMB_INLINE glow_lanes glow_lanes_at(const glow *g, int pixel)
{
    int half = g->reduce / 2, shift = g->reduce == 2 ? 1 : g->reduce == 4 ? 2 : 3;
    i32x x = i_lane_index() + (pixel & 7) + half;
    i32x cell = x >> shift;
    f32x step = f_set(1.0f / (float)g->reduce);
    return (glow_lanes){cell - (((pixel & 7) + half) >> shift), (i_to_f(x - (cell << shift)) + 0.5f) * step};
}

/* Is there no light at all near the block that begins at the span's `pixel`? A whole number of every group of lanes is
 * looked at, the same cells at any width. */
AMB_INLINE bool glow_is_dark(const glow *g, float (*cells)[GLOW_SPAN_CELLS], int pixel)
{
    int first = pixel / g->reduce, count = (GLOW_BLOCK / g->reduce + 2 + 15) / 16 * 16;
    maskx lit = m_set(false);
    for (int c = 0; c < 3; c++)
        for (int i = first; i < first + count; i += AMB_LANES)
            lit |= f_load(cells[c] + i) != 0.0f;
    return !m_any(lit);
}

/* The glow at the span's pixels from `pixel` (a multiple of the lanes) on; cells: a channel of amb_glow_rows. */
AMB_INLINE f32x glow_at(const glow *g, const float *cells, int pixel, glow_lanes lanes)
{
    const float *first = cells + (pixel + g->reduce / 2) / g->reduce;
    f32x left = f_permute(f_load(first), lanes.index), right = f_permute(f_load(first + 1), lanes.index);
    return f_lerp(left, right, lanes.t);
}

/* Adds the glow (already times its intensity) to the span. `keep` (or NULL) gets what is added. */
AMB_INLINE void glow_add(const glow *g, const amb_post_span *span, float scale, const amb_image *keep)
{
    float cells[3][GLOW_SPAN_CELLS];
    amb_glow_rows(g, span, scale, cells);
    glow_lanes lanes[2] = {glow_lanes_at(g, 0), glow_lanes_at(g, AMB_LANES)};
    for (int block = 0; block < span->count; block += GLOW_BLOCK) {
        if (!keep && glow_is_dark(g, cells, block))
            continue; /* most of most pictures: neither read nor written */
        int end = block + GLOW_BLOCK < span->count ? block + GLOW_BLOCK : span->count;
        for (int c = 0; c < 3; c++)
            for (int i = block; i < end; i += AMB_LANES) {
                f32x add = glow_at(g, cells[c], i, lanes[i / AMB_LANES & 1]);
                f_store(span->rgb[c] + i, f_load(span->rgb[c] + i) + add);
                if (keep)
                    f_store(amb_image_row(keep, c, span->y) + span->x + i, add);
            }
    }
}

#endif
