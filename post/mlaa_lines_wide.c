/* Morphological anti-aliasing: from discontinuities to lines, shapes, blend weights and the blended picture.
 *
 * A line is a run of discontinuities. Each of its pixels knows its distance to both ends (at most MLAA_REACH); with
 * p the shorter one and L = both + 1, the line that the jagged edge stands for cuts off its pixel the trapezium of area
 * A = ½(1 - (2p + 1)/L), provided that at the nearer end exactly one line crosses: on the side that it crosses, the
 * pixel is blended with the one beyond the line. The halves of a line so make an L (one end crosses), a Z (both, on
 * opposite sides) or a U (both, on the same side). */
#include "post/mlaa.h"

/* ---- runs of bits ------------------------------------------------------------------------------------------------ */

/* Is discontinuity `at` of a line set? Before the first there is none. */
AMB_INLINE unsigned bit_at(const uint64_t *line, int at)
{
    return at < 0 ? 0 : (unsigned)(line[at >> 6] >> (at & 63)) & 1u;
}

/* The first and last of the run that `at` belongs to; a run is followed for a little more than MLAA_REACH from there,
 * which is all that can matter. */
static int run_first(const uint64_t *line, int at)
{
    for (int start = at; at >= 0 && start - at < 2 * MLAA_REACH;) {
        uint64_t gaps = ~line[at >> 6] << (63 - (at & 63));
        if (gaps)
            return at - __builtin_clzll(gaps) + 1;
        at = (at & ~63) - 1;
    }
    return at + 1;
}

static int run_last(const uint64_t *line, int at, int words)
{
    for (int start = at; at < words * 64 && at - start < 2 * MLAA_REACH;) {
        uint64_t gaps = ~line[at >> 6] >> (at & 63);
        if (gaps)
            return at + __builtin_ctzll(gaps) - 1;
        at = (at | 63) + 1;
    }
    return at - 1;
}

/* ---- weights ----------------------------------------------------------------------------------------------------- */

/* Lines along rows have sides above and below, lines along columns left and right; a is the first of each. */
typedef struct line_bits {
    const uint64_t *line, *cross_a, *cross_b; /* the discontinuities that cross it, on either side */
    const uint64_t *beyond_a, *beyond_b;      /* where those go on, one pixel further; NULL outside the image */
    int words;
} line_bits;

/* Which sides are crossed just before discontinuity `at`: 1 side a, 2 side b, 3 both. */
AMB_INLINE unsigned crossings(const line_bits *b, int at)
{
    return bit_at(b->cross_a, at) | bit_at(b->cross_b, at) << 1;
}

/* What the trapezium's area is multiplied by when side 1 or 2 is crossed there. */
AMB_INLINE float share_of(const line_bits *b, unsigned side, int at, float corners)
{
    const uint64_t *beyond = side == 1 ? b->beyond_a : b->beyond_b;
    return beyond && bit_at(beyond, at) ? corners : 1.0f;
}

typedef struct line_place { /* where a line lies in its tile */
    mlaa_tile_memory *memory;
    int side_a, side_b; /* row or column of the pixels at either side; outside 0…63: of another tile */
    int first;          /* the line's discontinuity at the tile's first column or row */
    float corners;
} line_place;

/* One pixel of a line gets its weight; `side` as of crossings, one alone. */
AMB_INLINE void put_weight(const line_place *place, bool vertical, unsigned side, int at, float area)
{
    int across = side == 1 ? place->side_a : place->side_b, along = at - place->first;
    if (across < 0 || across >= MLAA_TILE)
        return;
    int x = vertical ? across : along, y = vertical ? along : across;
    int direction = (vertical ? 2 : 0) + (side == 1 ? 1 : 0); /* up, down, left, right: towards the line */
    place->memory->weight[direction][y][x] = area;
    place->memory->dirty[y] |= UINT64_C(1) << x;
}

AMB_INLINE float trapezium(int p, int length) { return 0.5f * (1.0f - (float)(2 * p + 1) / (float)length); }

/* The part from…to (inside the tile) of a run first…last of at most MLAA_REACH + 1. */
AMB_INLINE void put_run(const line_bits *b, const line_place *place, bool vertical, int from, int to, int first,
                        int last)
{
    int length = last - first + 1, half = length / 2; /* the middle of an odd line has no area */
    unsigned before = crossings(b, first - 1), after = crossings(b, last);
    if (before == 1 || before == 2) {
        float share = share_of(b, before, first - 1, place->corners);
        for (int at = from; at <= to && at - first < half; at++)
            put_weight(place, vertical, before, at, trapezium(at - first, length) * share);
    }
    if (after == 1 || after == 2) {
        float share = share_of(b, after, last, place->corners);
        for (int at = to; at >= from && last - at < half; at--)
            put_weight(place, vertical, after, at, trapezium(last - at, length) * share);
    }
}

/* The same of a longer run, whose pixels do not all see both ends. */
AMB_INLINE void put_long_run(const line_bits *b, const line_place *place, bool vertical, int from, int to, int first,
                             int last)
{
    for (int at = from; at <= to; at++) {
        int back = at - first < MLAA_REACH ? at - first : MLAA_REACH;
        int ahead = last - at < MLAA_REACH ? last - at : MLAA_REACH;
        int end = back < ahead ? at - back - 1 : at + ahead, near = back < ahead ? back : ahead;
        unsigned side = back == ahead ? 0 : crossings(b, end);
        if (side == 1 || side == 2)
            put_weight(place, vertical, side, at,
                       trapezium(near, back + ahead + 1) * share_of(b, side, end, place->corners));
    }
}

/* Every run in one word of a line. */
AMB_INLINE void put_word(const line_bits *b, const line_place *place, bool vertical)
{
    uint64_t bits = b->line[place->first >> 6];
    while (bits) {
        int low = __builtin_ctzll(bits);
        uint64_t gaps = ~(bits >> low);
        int count = gaps ? __builtin_ctzll(gaps) : 64;
        if (low + count > 64)
            count = 64 - low;
        int from = place->first + low, to = from + count - 1;
        int first = low ? from : run_first(b->line, from);
        int last = low + count < 64 ? to : run_last(b->line, to, b->words);
        if (last - first <= MLAA_REACH)
            put_run(b, place, vertical, from, to, first, last);
        else
            put_long_run(b, place, vertical, from, to, first, last);
        bits = low + count < 64 ? bits & (~UINT64_C(0) << (low + count)) : 0;
    }
}

static void put_rows(const mlaa_work *work, mlaa_tile_memory *memory, int x0, int y0)
{
    size_t words = work->row_words;
    for (int side = -1; side < MLAA_TILE && y0 + side + 1 < work->color->height; side++) {
        int y = y0 + side;
        if (y < 0 || !work->down[(size_t)y * words + (size_t)(x0 >> 6)])
            continue;
        line_bits bits = {.line = work->down + (size_t)y * words,
                          .cross_a = work->right + (size_t)y * words,
                          .cross_b = work->right + (size_t)(y + 1) * words,
                          .beyond_a = y > 0 ? work->right + (size_t)(y - 1) * words : NULL,
                          .beyond_b = y + 2 < work->color->height ? work->right + (size_t)(y + 2) * words : NULL,
                          .words = (int)words};
        line_place place = {memory, side, side + 1, x0, work->corners};
        put_word(&bits, &place, false);
    }
}

static void put_columns(const mlaa_work *work, mlaa_tile_memory *memory, int x0, int y0)
{
    size_t words = work->column_words;
    for (int side = -1; side < MLAA_TILE && x0 + side + 1 < work->color->width; side++) {
        int x = x0 + side;
        if (x < 0 || !work->right_column[(size_t)x * words + (size_t)(y0 >> 6)])
            continue;
        line_bits bits = {.line = work->right_column + (size_t)x * words,
                          .cross_a = work->down_column + (size_t)x * words,
                          .cross_b = work->down_column + (size_t)(x + 1) * words,
                          .beyond_a = x > 0 ? work->down_column + (size_t)(x - 1) * words : NULL,
                          .beyond_b = x + 2 < work->color->width ? work->down_column + (size_t)(x + 2) * words : NULL,
                          .words = (int)words};
        line_place place = {memory, side, side + 1, y0, work->corners};
        put_word(&bits, &place, true);
    }
}

/* ---- blending ---------------------------------------------------------------------------------------------------- */

AMB_INLINE bool finite(float a) { return a - a == 0.0f; }

/* A neighbour's light, made harmless: NaN is 0, Inf a bright light. */
AMB_INLINE float harmless(float a)
{
    if (a != a)
        return 0.0f;
    return a > 65504.0f ? 65504.0f : a < -65504.0f ? -65504.0f : a;
}

/* c + Σ weight·(neighbour - c); where corners claim more than the whole pixel, their shares are scaled to sum to 1. */
static void blend_pixel(const mlaa_work *work, size_t at, const float weight[4], mlaa_change *change)
{
    const amb_image *color = work->color;
    ptrdiff_t stride = (ptrdiff_t)color->stride, towards[4] = {-stride, stride, -1, 1};
    float sum = (weight[0] + weight[1]) + (weight[2] + weight[3]);
    float share = sum > 1.0f ? 1.0f / sum : 1.0f;
    change->at = at;
    for (int c = 0; c < 3; c++) {
        const float *here = amb_image_row(color, c, 0) + at;
        float value = here[0];
        for (int d = 0; d < 4 && finite(here[0]); d++)
            if (weight[d] > 0.0f)
                value += weight[d] * share * (harmless(here[towards[d]]) - here[0]);
        change->rgb[c] = value;
    }
}

/* The pixels that row y of the tile at (x0, y0) will need soon. */
static void fetch_row(const mlaa_work *work, const mlaa_tile_memory *memory, int x0, int y0, int y)
{
    for (int x = 0; x < MLAA_TILE && y < MLAA_TILE; x += 16)
        if (memory->dirty[y] >> x & 0xffff)
            for (int c = 0; c < 3; c++)
                __builtin_prefetch(amb_image_row(work->color, c, y0 + y) + x0 + x);
}

static void blend_tile(void *user, int index, int thread)
{
    const mlaa_work *work = user;
    mlaa_tile_memory *memory = &work->memory[thread];
    int x0 = index % work->tiles_x * MLAA_TILE, y0 = index / work->tiles_x * MLAA_TILE;
    mlaa_change *change = work->change + work->first_change[index];
    if (work->first_change[index + 1] > work->first_change[index]) {
        put_rows(work, memory, x0, y0);
        put_columns(work, memory, x0, y0);
    }
    for (int y = 0; y < MLAA_TILE; y++) {
        fetch_row(work, memory, x0, y0, y + 4);
        for (uint64_t bits = memory->dirty[y]; bits; bits &= bits - 1) {
            int x = __builtin_ctzll(bits);
            float weight[4];
            for (int d = 0; d < 4; d++) {
                weight[d] = memory->weight[d][y][x];
                memory->weight[d][y][x] = 0.0f;
                if (work->weights)
                    amb_image_row(work->weights, d, y0 + y)[x0 + x] = weight[d];
            }
            blend_pixel(work, (size_t)(y0 + y) * work->color->stride + (size_t)(x0 + x), weight, change++);
        }
        memory->dirty[y] = 0;
    }
    work->changes[index] = (size_t)(change - (work->change + work->first_change[index]));
}

/* At most how many pixels of a tile change: those with a discontinuity at any side. */
static void count_tile(void *user, int index, int thread)
{
    (void)thread;
    const mlaa_work *work = user;
    int tile_x = index % work->tiles_x, y0 = index / work->tiles_x * MLAA_TILE;
    size_t words = work->row_words, count = 0;
    for (int y = y0; y < y0 + MLAA_TILE && y < work->color->height; y++) {
        const uint64_t *right = work->right + (size_t)y * words + tile_x;
        const uint64_t *down = work->down + (size_t)y * words + tile_x;
        uint64_t left = right[0] << 1 | (tile_x ? right[-1] >> 63 : 0);
        uint64_t up = y ? *(down - words) : 0;
        count += (size_t)__builtin_popcountll(right[0] | left | down[0] | up);
    }
    work->first_change[index + 1] = count;
}

static void write_tile(void *user, int index, int thread)
{
    (void)thread;
    const mlaa_work *work = user;
    const mlaa_change *change = work->change + work->first_change[index];
    for (size_t i = 0; i < work->changes[index]; i++)
        for (int c = 0; c < 3; c++)
            amb_image_row(work->color, c, 0)[change[i].at] = change[i].rgb[c];
}

amb_status amb_mlaa_blend(mlaa_work *work, amb_scratch *scratch, amb_error *error)
{
    int tiles = work->tiles_x * work->tiles_y;
    size_t threads = (size_t)amb_context_threads(work->context);
    work->first_change = amb_scratch_take(scratch, (size_t)tiles + 1, sizeof(size_t));
    work->changes = amb_scratch_take(scratch, (size_t)tiles, sizeof(size_t));
    work->memory = amb_scratch_take(scratch, threads, sizeof(mlaa_tile_memory));
    if (!work->first_change || !work->changes || !work->memory)
        return amb_fail(error, AMB_ERROR_MEMORY, "post pass mlaa: out of memory");
    memset(work->memory, 0, threads * sizeof(mlaa_tile_memory));
    work->first_change[0] = 0;
    amb_parallel_for(work->context, tiles, count_tile, work);
    for (int i = 0; i < tiles; i++)
        work->first_change[i + 1] += work->first_change[i];
    work->change = amb_scratch_take(scratch, work->first_change[tiles], sizeof(mlaa_change));
    if (!work->change)
        return amb_fail(error, AMB_ERROR_MEMORY, "post pass mlaa: out of memory for %zu edge pixels",
                        work->first_change[tiles]);
    amb_parallel_for(work->context, tiles, blend_tile, work);
    amb_parallel_for(work->context, tiles, write_tile, work);
    return AMB_OK;
}

/* ---- intermediates ----------------------------------------------------------------------------------------------- */

/* The line through `at`: distances 1…256 to its ends in *back and *ahead (0: no line), and its 16 end patterns as
 * 1 + 4·(crossings at its start) + crossings at its end. */
static void show_line(const line_bits *b, int at, float *back, float *ahead, float *shape)
{
    if (!bit_at(b->line, at))
        return;
    int first = run_first(b->line, at), last = run_last(b->line, at, b->words);
    int to_first = at - first < MLAA_REACH ? at - first : MLAA_REACH;
    int to_last = last - at < MLAA_REACH ? last - at : MLAA_REACH;
    *back = (float)(to_first + 1);
    *ahead = (float)(to_last + 1);
    *shape = (float)(1 + 4 * crossings(b, at - to_first - 1) + crossings(b, at + to_last));
}

static void show_row(void *user, int y, int thread)
{
    (void)thread;
    const mlaa_work *work = user;
    size_t rows = work->row_words, columns = work->column_words;
    size_t below = y + 1 < work->color->height ? (size_t)y + 1 : (size_t)y;
    line_bits row = {.line = work->down + (size_t)y * rows,
                     .cross_a = work->right + (size_t)y * rows,
                     .cross_b = work->right + below * rows,
                     .words = (int)rows};
    for (int x = 0; x < work->color->width; x++) {
        size_t beside = x + 1 < work->color->width ? (size_t)x + 1 : (size_t)x;
        line_bits column = {.line = work->right_column + (size_t)x * columns,
                            .cross_a = work->down_column + (size_t)x * columns,
                            .cross_b = work->down_column + beside * columns,
                            .words = (int)columns};
        float value[6] = {0.0f};
        show_line(&row, x, &value[0], &value[1], &value[4]);
        show_line(&column, y, &value[2], &value[3], &value[5]);
        for (int c = 0; c < 4; c++)
            amb_image_row(work->distance, c, y)[x] = value[c];
        for (int c = 0; c < 2; c++)
            amb_image_row(work->shape, c, y)[x] = value[4 + c];
        amb_image_row(work->edges, 0, y)[x] = (float)bit_at(column.line, y);
        amb_image_row(work->edges, 1, y)[x] = (float)bit_at(row.line, x);
    }
}

void amb_mlaa_show(const mlaa_work *work)
{
    if (!work->edges)
        return;
    for (int d = 0; d < 4; d++)
        memset(amb_image_row(work->weights, d, 0), 0,
               work->weights->stride * (size_t)work->color->height * sizeof(float));
    amb_parallel_for(work->context, work->color->height, show_row, (void *)(uintptr_t)work);
}
