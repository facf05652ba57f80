#include "post/glow.h"

#include <ambiance/math.h>

#define STRIP 64 /* columns blurred at a time: a cache line of every lane width */

amb_status amb_glow_begin(const amb_post_job *job, int reduce, glow *g, amb_error *error)
{
    size_t threads = (size_t)amb_context_threads(job->context);
    g->reduce = reduce;
    g->width = (job->color->width + reduce - 1) / reduce;
    g->height = (job->color->height + reduce - 1) / reduce;
    g->stride = (GLOW_LEFT + (size_t)g->width + GLOW_RIGHT + STRIP - 1) / STRIP * STRIP;
    size_t row = 3 * glow_sum_floats(g) + 2 * g->stride;
    size_t strip = 2 * ((size_t)g->height + 2 * GLOW_TAPS) * STRIP;
    g->thread_floats = (row > strip ? row : strip) + 16;
    g->thread_floats = (g->thread_floats + 15) / 16 * 16;
    g->thread_memory = amb_scratch_take(job->scratch, threads * g->thread_floats, sizeof(float));
    float *cells = amb_scratch_take(job->scratch, 3 * (size_t)g->height * g->stride, sizeof(float));
    if (!g->thread_memory || !cells)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a blur of %dx%d cells", g->width, g->height);
    for (int c = 0; c < 3; c++)
        g->plane[c] = cells + (size_t)c * (size_t)g->height * g->stride + GLOW_LEFT;
    return AMB_OK;
}

void amb_glow_gaussian(glow *g, float sigma)
{
    double weight[4], sum = 0.0;
    for (int i = 0; i < 4; i++) {
        weight[i] = (double)amb_exp(-0.5f * (float)(i * i) / (sigma * sigma));
        sum += i ? 2.0 * weight[i] : weight[i];
    }
    double rest = 1.0; /* what the side taps leave to the centre, after their rounding */
    for (int i = 1; i < 4; i++) {
        float side = (float)(weight[i] / sum);
        g->tap[3 - i] = g->tap[3 + i] = side;
        rest -= 2.0 * (double)side;
    }
    g->tap[3] = (float)rest;
    g->taps = 7;
    g->first = -3;
    g->rounds = 3;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

/* The sums of neighbours: a0+a1, a2+a3, …, b0+b1, … */
AMB_INLINE f32x add_pairs(f32x a, f32x b)
{
#if AMB_LANES == 4
    return __builtin_shufflevector(a, b, 0, 2, 4, 6) + __builtin_shufflevector(a, b, 1, 3, 5, 7);
#elif AMB_LANES == 8
    return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14) +
           __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#else
    return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30) +
           __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
#endif
}

/* Sums of 2, 4 or 8 neighbours, always as a balanced tree. */
AMB_INLINE f32x add_twos(const float *p) { return add_pairs(f_load(p), f_load(p + AMB_LANES)); }
AMB_INLINE f32x add_fours(const float *p) { return add_pairs(add_twos(p), add_twos(p + 2 * AMB_LANES)); }
AMB_INLINE f32x add_eights(const float *p) { return add_pairs(add_fours(p), add_fours(p + 4 * AMB_LANES)); }

static void reduce_sums(const glow *g, const float *sums, float *cells)
{
    f32x share = f_set(1.0f / (float)(g->reduce * g->reduce));
    for (int i = 0; i < g->width; i += AMB_LANES, sums += AMB_LANES * g->reduce) {
        f32x sum = g->reduce == 2 ? add_twos(sums) : g->reduce == 4 ? add_fours(sums) : add_eights(sums);
        f_store(cells + i, sum * share);
    }
}

static void extend_row(const glow *g, float *cells)
{
    for (int i = 1; i <= GLOW_LEFT; i++)
        cells[-i] = cells[0];
    for (float *p = cells + g->width, *end = cells - GLOW_LEFT + g->stride; p < end; p++)
        *p = cells[g->width - 1];
}

/* 64 bytes into the source, so that taps may reach before it. */
static void blur_row(const glow *g, const float *from, float *to)
{
    for (int i = 0; i < g->width; i += AMB_LANES) {
        const float *p = from + i + g->first;
        f32x sum = f_load(p) * g->tap[0];
        for (int k = 1; k < g->taps; k++)
            sum += f_load(p + k) * g->tap[k];
        f_store(to + i, sum);
    }
    extend_row(g, to);
}

void amb_glow_reduce_row(const glow *g, float *sums, int cell_y, int thread)
{
    size_t row = glow_sum_floats(g);
    float *spare = g->thread_memory + (size_t)thread * g->thread_floats + 3 * row;
    for (int c = 0; c < 3; c++) {
        float *out = g->plane[c] + (size_t)cell_y * g->stride;
        float *from = spare + GLOW_LEFT, *to = spare + g->stride + GLOW_LEFT;
        reduce_sums(g, sums + (size_t)c * row, from);
        extend_row(g, from);
        for (int round = 0; round < g->rounds; round++) {
            blur_row(g, from, round + 1 < g->rounds ? to : out);
            float *swap = from;
            from = to;
            to = swap;
        }
    }
}

/* ---- columns ----------------------------------------------------------------------------------------------------- */

typedef struct columns_job {
    const glow *g;
} columns_job;

static void extend_column(const glow *g, float *strip)
{
    for (int i = 1; i <= GLOW_TAPS; i++) {
        memcpy(strip - i * STRIP, strip, STRIP * sizeof *strip);
        memcpy(strip + ((ptrdiff_t)g->height - 1 + i) * STRIP, strip + ((ptrdiff_t)g->height - 1) * STRIP,
               STRIP * sizeof *strip);
    }
}

static void blur_columns(const glow *g, const float *from, float *to, size_t to_stride)
{
    for (int y = 0; y < g->height; y++)
        for (int x = 0; x < STRIP; x += AMB_LANES) {
            const float *p = from + ((ptrdiff_t)y + g->first) * STRIP + x;
            f32x sum = f_load(p) * g->tap[0];
            for (int k = 1; k < g->taps; k++)
                sum += f_load(p + k * STRIP) * g->tap[k];
            f_store(to + (size_t)y * to_stride + x, sum);
        }
}

/* All rounds of one channel's strip of columns, in a thread's own memory. */
static void blur_strip(void *user, int index, int thread)
{
    const glow *g = ((const columns_job *)user)->g;
    int strips = (int)(g->stride / STRIP);
    float *cells = g->plane[index / strips] - GLOW_LEFT + (size_t)(index % strips) * STRIP;
    float *from = g->thread_memory + (size_t)thread * g->thread_floats + GLOW_TAPS * STRIP;
    float *to = from + ((size_t)g->height + 2 * GLOW_TAPS) * STRIP;
    for (int y = 0; y < g->height; y++)
        memcpy(from + (size_t)y * STRIP, cells + (size_t)y * g->stride, STRIP * sizeof *from);
    for (int round = 0; round < g->rounds; round++) {
        extend_column(g, from);
        bool last = round + 1 == g->rounds;
        blur_columns(g, from, last ? cells : to, last ? g->stride : STRIP);
        float *swap = from;
        from = to;
        to = swap;
    }
}

void amb_glow_finish(const amb_post_job *job, const glow *g)
{
    columns_job columns = {g};
    amb_parallel_for(job->context, 3 * (int)(g->stride / STRIP), blur_strip, &columns);
}

/* ---- back to full size ------------------------------------------------------------------------------------------- */

void amb_glow_rows(const glow *g, const amb_post_span *span, float scale, float (*out)[GLOW_SPAN_CELLS])
{
    int twice = 2 * span->y + 1 - g->reduce; /* 2·reduce · (y of the pixel's centre among the cells' centres) */
    int above = twice < 0 ? -1 : twice / (2 * g->reduce);
    float t = (float)(twice - above * 2 * g->reduce) / (float)(2 * g->reduce);
    int below = above + 1 < g->height ? above + 1 : g->height - 1;
    above = above < 0 ? 0 : above;
    ptrdiff_t first = span->x / g->reduce - 1;
    int count = (span->count / g->reduce + 2 + 31) / 16 * 16; /* see glow_is_dark */
    for (int c = 0; c < 3; c++) {
        const float *a = g->plane[c] + (size_t)above * g->stride + first;
        const float *b = g->plane[c] + (size_t)below * g->stride + first;
        for (int i = 0; i < count; i += AMB_LANES)
            f_store(out[c] + i, f_lerp(f_load(a + i), f_load(b + i), f_set(t)) * scale);
    }
}
