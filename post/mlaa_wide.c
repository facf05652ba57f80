/* Morphological anti-aliasing after V. Biri, A. Herubel and S. Deverly, "Practical morphological antialiasing on the
 * GPU", SIGGRAPH 2010 talks, and A. Reshetov, "Morphological antialiasing", HPG 2009. This file: the pass and its first
 * step, detection. post/mlaa_lines_wide.c: lines, weights, blending.
 *
 * Detection compares CIE Lab of the light that a display would show: times `exposure`, clamped to 0…1 (so two pixels
 * that are both white on the screen have no edge between them). Blending mixes the HDR light itself. The pass therefore
 * stands before the display transform. NaN counts as black, and never enters a neighbour. */
#include "post/mlaa.h"

#include <ambiance/math.h>
#include <ambiance/vec.h>

#include <stddef.h>

#define BLOCK_W 512 /* pixels detected at a time; MLAA_TILE rows */
#define ROW_FLOATS (BLOCK_W + 16)
#define ROW_GROUPS (ROW_FLOATS / AMB_LANES)

typedef struct mlaa_params {
    float threshold, exposure, corners;
} mlaa_params;

/* clang-format off */
static const amb_param mlaa_table[] = {
    {"threshold", AMB_PARAM_FLOAT, "Lab units", 1.0f, 200.0f, {12.0f}, NULL, offsetof(mlaa_params, threshold),
     "CIE Lab distance above which two neighbours have an edge between them"},
    {"exposure", AMB_PARAM_FLOAT, "stops", -20.0f, 20.0f, {0.0f}, NULL, offsetof(mlaa_params, exposure),
     "that of the display to come: detection sees light times 2 to this power, clamped to 0..1"},
    {"corners", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.25f}, NULL, offsetof(mlaa_params, corners),
     "share of blending kept along lines that end at a square corner; 1 is plain MLAA, which rounds text"},
};
/* clang-format on */

/* ---- CIE Lab ----------------------------------------------------------------------------------------------------- */

/* Cube root for t in [0.008, 1], relative error below 1e-6: a rough inverse from the exponent, a step of third order
 * and one of second, without division. */
AMB_INLINE f32x lab_root(f32x t)
{
    f32x y = f_from_bits(0x54a22b4b - f_to_i(i_to_f(f_bits(t)) * 0.333333343f));
    f32x e = 1.0f - t * y * y * y;
    y = y + y * e * (e * 0.222222222f + 0.333333333f);
    e = 1.0f - t * y * y * y;
    y = y + y * e * 0.333333333f;
    return t * y * y;
}

/* CIE 15: t^⅓, and a straight line below (6/29)³. */
AMB_INLINE f32x lab_curve(f32x t)
{
    return f_sel(t > 0.00885645168f, lab_root(f_max(t, f_set(0.008f))), t * 7.78703704f + 0.137931034f);
}

/* L, a, b but for the constant part of L, of linear Rec.709 in 0…1; white is D65. */
AMB_INLINE v3x lab_of(v3x c)
{
    f32x x = lab_curve(c.x * 0.433953f + c.y * 0.376219f + c.z * 0.189828f);
    f32x y = lab_curve(c.x * 0.212673f + c.y * 0.715152f + c.z * 0.072175f);
    f32x z = lab_curve(c.x * 0.017757f + c.y * 0.109468f + c.z * 0.872775f);
    return (v3x){y * 116.0f, (x - y) * 500.0f, (y - z) * 200.0f};
}

/* ---- detection --------------------------------------------------------------------------------------------------- */

typedef struct row_cache { /* a piece of a row as the display shows it */
    float rgb[3][ROW_FLOATS];
    float lab[3][ROW_FLOATS];        /* filled by the group, when needed */
    unsigned char known[ROW_GROUPS]; /* groups of lab that are */
} row_cache;

/* Clamped light of count pixels from (x, y) and one more to the right of them. */
static void load_row(const mlaa_work *work, int x, int y, int count, row_cache *row)
{
    f32x zero = f_set(0.0f), one = f_set(1.0f);
    int here = count + 1 < work->color->width - x ? count + 1 : work->color->width - x;
    for (int c = 0; c < 3; c++) {
        const float *from = amb_image_row(work->color, c, y) + x;
        for (int i = 0; i < count; i += AMB_LANES) {
            __builtin_prefetch(from + work->color->stride + i); /* short pieces of rows escape the prefetcher */
            f_store(row->rgb[c] + i, f_clamp(f_load(from + i) * work->gain, zero, one));
        }
        if (here > count) { /* by lanes, so that the arithmetic is the same */
            f32x last = f_clamp(f_set(from[count]) * work->gain, zero, one);
            f_store(row->rgb[c] + count, last);
        } else {
            f_store(row->rgb[c] + count, zero);
        }
    }
    memset(row->known, 0, sizeof row->known);
}

AMB_INLINE v3x load3(float (*plane)[ROW_FLOATS], int i)
{
    return (v3x){f_load(plane[0] + i), f_load(plane[1] + i), f_load(plane[2] + i)};
}

/* A group's Lab, computed when first asked for. */
AMB_INLINE v3x know_lab(row_cache *row, int group)
{
    int i = group * AMB_LANES;
    if (row->known[group])
        return load3(row->lab, i);
    v3x lab = lab_of(load3(row->rgb, i));
    f_store(row->lab[0] + i, lab.x);
    f_store(row->lab[1] + i, lab.y);
    f_store(row->lab[2] + i, lab.z);
    row->known[group] = 1;
    return lab;
}

/* Lanes 1… of a, then lane 0 of b: the right neighbours. In registers, as the stores are still under way. */
AMB_INLINE f32x shifted(f32x a, f32x b)
{
#if AMB_LANES == 4
    return __builtin_shufflevector(a, b, 1, 2, 3, 4);
#elif AMB_LANES == 8
    return __builtin_shufflevector(a, b, 1, 2, 3, 4, 5, 6, 7, 8);
#else
    return __builtin_shufflevector(a, b, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
#endif
}

/* Can these neighbours be further apart than the threshold? With d the largest change of a channel and s the slope of
 * lab_curve at the darkest channel, none of its three values changes by more than s·d. Two that change the same way
 * differ in their change by no more than that; X and Y can change by at most 0.68·d when they go opposite ways,
 * together, Y and Z by 1.61·d. So |ΔL| ≤ 116·s·d, |Δa| ≤ 500·s·d, |Δb| ≤ 322·s·d, in all 606·s·d. The inverse slope,
 * 3·t^⅔, is concave: its chord from (0.00886, 0.1284) to (1, 3) lies below it. A hundredth is left for rounding. */
AMB_INLINE maskx may_differ(v3x a, v3x b, f32x a_darkest, float scale)
{
    f32x move = f_max(f_abs(a.x - b.x), f_max(f_abs(a.y - b.y), f_abs(a.z - b.z)));
    f32x darkest = f_min(a_darkest, f_min(b.x, f_min(b.y, b.z)));
    f32x inverse_slope = f_max(darkest - 0.00886f, f_set(0.0f)) * 2.897f + 0.1284f;
    return move * scale > inverse_slope;
}

AMB_INLINE maskx is_far(v3x a, v3x b, float threshold)
{
    v3x d = v3x_sub(a, b);
    return d.x * d.x + d.y * d.y + d.z * d.z > threshold * threshold;
}

/* The bits of one group of lanes: right in *r, down in *d. */
AMB_INLINE void detect_group(row_cache *row, row_cache *next, int group, float threshold, uint64_t *r, uint64_t *d)
{
    int i = group * AMB_LANES;
    float scale = 606.0f / (0.99f * threshold);
    v3x here = load3(row->rgb, i);
    f32x darkest = f_min(here.x, f_min(here.y, here.z));
    maskx right = may_differ(here, load3(row->rgb, i + 1), darkest, scale);
    maskx down = may_differ(here, load3(next->rgb, i), darkest, scale);
    *r = *d = 0;
    if (!m_any(right | down))
        return;
    here = know_lab(row, group);
    if (m_any(right)) {
        v3x after = know_lab(row, group + 1);
        after = (v3x){shifted(here.x, after.x), shifted(here.y, after.y), shifted(here.z, after.z)};
        *r = m_bits(is_far(here, after, threshold));
    }
    if (m_any(down))
        *d = m_bits(is_far(here, know_lab(next, group), threshold));
}

static void detect_row(const mlaa_work *work, int x, int y, int count, row_cache *row, row_cache *next)
{
    uint64_t *right = work->right + (size_t)y * work->row_words + (size_t)x / 64;
    uint64_t *down = work->down + (size_t)y * work->row_words + (size_t)x / 64;
    for (int word = 0; word * 64 < count; word++) {
        uint64_t r = 0, d = 0;
        for (int i = word * 64; i < word * 64 + 64 && i < count; i += AMB_LANES) {
            uint64_t group_r, group_d;
            detect_group(row, next, i / AMB_LANES, work->threshold, &group_r, &group_d);
            r |= group_r << (i & 63);
            d |= group_d << (i & 63);
        }
        int pixels = work->color->width - x - word * 64; /* of the image, from this word on */
        uint64_t inside = pixels >= 64 ? ~UINT64_C(0) : (UINT64_C(1) << pixels) - 1;
        right[word] = r & (pixels > 64 ? inside : inside >> 1);
        down[word] = y + 1 < work->color->height ? d & inside : 0;
    }
}

/* Transposes 64 words of 64 bits: swaps ever smaller off-diagonal blocks (H. S. Warren, Hacker's Delight, 7-3). */
static void transpose(uint64_t word[64])
{
    uint64_t mask = 0x00000000ffffffffu;
    for (int size = 32; size; size >>= 1, mask ^= mask << size)
        for (int i = 0; i < 64; i = ((i | size) + 1) & ~size) {
            uint64_t swap = ((word[i] >> size) ^ word[i | size]) & mask;
            word[i] ^= swap << size;
            word[i | size] ^= swap;
        }
}

static void transpose_tile(const mlaa_work *work, const uint64_t *rows, uint64_t *columns, int tile_x, int tile_y)
{
    uint64_t word[64], any = 0;
    int height = work->color->height - tile_y * MLAA_TILE, width = work->color->width - tile_x * MLAA_TILE;
    for (int y = 0; y < 64; y++) {
        word[y] = y < height ? rows[(size_t)(tile_y * MLAA_TILE + y) * work->row_words + (size_t)tile_x] : 0;
        any |= word[y];
    }
    if (any)
        transpose(word);
    for (int x = 0; x < 64 && x < width; x++)
        columns[(size_t)(tile_x * MLAA_TILE + x) * work->column_words + (size_t)tile_y] = word[x];
}

/* A block of BLOCK_W × MLAA_TILE pixels: its bits, row by row and column by column. */
static void detect_block(void *user, int index, int thread)
{
    (void)thread;
    mlaa_work *work = user;
    const amb_image *color = work->color;
    int blocks_x = (color->width + BLOCK_W - 1) / BLOCK_W;
    int x = index % blocks_x * BLOCK_W, y0 = index / blocks_x * MLAA_TILE;
    int columns = (int)color->stride - x < BLOCK_W ? (int)color->stride - x : BLOCK_W;
    int y1 = y0 + MLAA_TILE < color->height ? y0 + MLAA_TILE : color->height;
    row_cache rows[2];
    load_row(work, x, y0, columns, &rows[y0 & 1]);
    for (int y = y0; y < y1; y++) {
        load_row(work, x, y + 1 < color->height ? y + 1 : y, columns, &rows[(y + 1) & 1]);
        detect_row(work, x, y, columns, &rows[y & 1], &rows[(y + 1) & 1]);
    }
    for (int tile_x = x / MLAA_TILE; tile_x * MLAA_TILE < x + columns && tile_x < work->tiles_x; tile_x++) {
        transpose_tile(work, work->right, work->right_column, tile_x, y0 / MLAA_TILE);
        transpose_tile(work, work->down, work->down_column, tile_x, y0 / MLAA_TILE);
    }
}

void amb_mlaa_detect(mlaa_work *work)
{
    int blocks_x = (work->color->width + BLOCK_W - 1) / BLOCK_W;
    amb_parallel_for(work->context, blocks_x * work->tiles_y, detect_block, work);
}

/* ---- the pass ---------------------------------------------------------------------------------------------------- */

static amb_status mlaa_layers(const amb_post_job *job, mlaa_work *work, amb_error *error)
{
    amb_status status = amb_post_layer(job, "mlaa.edges", 2, &work->edges, error);
    if (status == AMB_OK)
        status = amb_post_layer(job, "mlaa.distance", 4, &work->distance, error);
    if (status == AMB_OK)
        status = amb_post_layer(job, "mlaa.shape", 2, &work->shape, error);
    if (status == AMB_OK)
        status = amb_post_layer(job, "mlaa.weights", 4, &work->weights, error);
    return status;
}

static amb_status mlaa_apply(const amb_post_job *job, amb_error *error)
{
    const mlaa_params *p = job->params;
    mlaa_work work = {.color = job->color, .context = job->context, .threshold = p->threshold, .corners = p->corners};
    work.gain = amb_exp2(p->exposure);
    work.tiles_x = (job->color->width + MLAA_TILE - 1) / MLAA_TILE;
    work.tiles_y = (job->color->height + MLAA_TILE - 1) / MLAA_TILE;
    work.row_words = (size_t)work.tiles_x;
    work.column_words = (size_t)work.tiles_y;
    size_t row_total = (size_t)job->color->height * work.row_words;
    size_t column_total = (size_t)job->color->width * work.column_words;
    work.right = amb_scratch_take(job->scratch, row_total, sizeof(uint64_t));
    work.down = amb_scratch_take(job->scratch, row_total, sizeof(uint64_t));
    work.right_column = amb_scratch_take(job->scratch, column_total, sizeof(uint64_t));
    work.down_column = amb_scratch_take(job->scratch, column_total, sizeof(uint64_t));
    if (!work.right || !work.down || !work.right_column || !work.down_column)
        return amb_fail(error, AMB_ERROR_MEMORY, "post pass mlaa: out of memory");
    if (job->intermediates) {
        amb_status status = mlaa_layers(job, &work, error);
        if (status != AMB_OK)
            return status;
    }
    amb_mlaa_detect(&work);
    amb_mlaa_show(&work);
    return amb_mlaa_blend(&work, job->scratch, error);
}

const amb_post_pass WIDE(amb_post_mlaa) = {
    .name = "mlaa",
    .about = "morphological anti-aliasing: smooths jagged edges of the finished picture",
    .params = {mlaa_table, sizeof mlaa_table / sizeof *mlaa_table, sizeof(mlaa_params)},
    .apply = mlaa_apply,
};
