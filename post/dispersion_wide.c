/* Chromatic dispersion: red, green and blue are each looked up at their own noise-displaced place, bilinearly. The
 * noise is quintic value noise on a lattice of `scale` pixels; its lattice values are drawn anew every `hold` frames.
 */
#include "post/hash.h"
#include "post/lanes.h"
#include "post/scratch.h"

#include <stddef.h>

#define LIGHT_LIMIT 65504.0f /* look-ups see light within ±this, and NaN as 0: one bad pixel stays one */

typedef struct dispersion_params {
    float amount, scale;
    int hold;
} dispersion_params;

/* clang-format off */
static const amb_param dispersion_table[] = {
    {"amount", AMB_PARAM_FLOAT, "pixels", 0.0f, 256.0f, {4.0f}, NULL, offsetof(dispersion_params, amount),
     "largest displacement along either axis"},
    {"scale", AMB_PARAM_FLOAT, "pixels", 1.0f, 4096.0f, {96.0f}, NULL, offsetof(dispersion_params, scale),
     "spacing of the noise lattice"},
    {"hold", AMB_PARAM_INT, "frames", 1.0f, 1000000.0f, {1.0f}, NULL, offsetof(dispersion_params, hold),
     "frames for which the noise stands still"},
};
/* clang-format on */

typedef struct dispersion_work {
    const amb_post_job *job;
    amb_image from;  /* the picture as it was */
    uint32_t key[6]; /* x and y of red, of green, of blue */
    float *noise;    /* a thread's: six rows of `cells` lattice values */
    size_t cells;
} dispersion_work;

AMB_INLINE f32x quintic(f32x t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

/* Value noise in [-1, 1] along the row at y (in lattice steps): what is left to do for a pixel is to blend two values.
 */
static void noise_row(const dispersion_work *w, float y, float *noise)
{
    float floor_y = f_lane(f_floor(f_set(y)), 0);
    i32x iy = i_set((int)floor_y);
    f32x v = quintic(f_set(y - floor_y));
    for (int k = 0; k < 6; k++)
        for (size_t i = 0; i < w->cells; i += AMB_LANES) {
            i32x ix = i_lane_index() + (int)i;
            f32x top = hash_unit(hash_point(ix, iy, w->key[k])), bottom = hash_unit(hash_point(ix, iy + 1, w->key[k]));
            f_store(noise + (size_t)k * w->cells + i, f_lerp(top, bottom, v) * 2.0f - 1.0f);
        }
}

AMB_INLINE f32x texel(const float *plane, i32x at)
{
    f32x a = f_gather(plane, at);
    return f_sel(f_is_nan(a), f_set(0.0f), f_clamp(a, f_set(-LIGHT_LIMIT), f_set(LIGHT_LIMIT)));
}

/* Bilinear look-up at pixel coordinates (centres are whole numbers), clamped to the image. */
AMB_INLINE f32x look_up(const amb_image *from, int channel, f32x x, f32x y)
{
    f32x zero = f_set(0.0f);
    x = f_clamp(x, zero, f_set((float)(from->width - 1)));
    y = f_clamp(y, zero, f_set((float)(from->height - 1)));
    f32x fx = f_floor(x), fy = f_floor(y);
    i32x x0 = f_to_i(fx), y0 = f_to_i(fy);
    i32x x1 = i_min(x0 + 1, i_set(from->width - 1)), y1 = i_min(y0 + 1, i_set(from->height - 1));
    const float *plane = amb_image_row(from, channel, 0);
    i32x row0 = y0 * (int)from->stride, row1 = y1 * (int)from->stride;
    f32x top = f_lerp(texel(plane, row0 + x0), texel(plane, row0 + x1), x - fx);
    f32x bottom = f_lerp(texel(plane, row1 + x0), texel(plane, row1 + x1), x - fx);
    return f_lerp(top, bottom, y - fy);
}

static void dispersion_row(void *user, int y, int thread)
{
    const dispersion_work *w = user;
    const dispersion_params *p = w->job->params;
    const amb_image *color = w->job->color;
    float *noise = w->noise + (size_t)thread * 6 * w->cells;
    float step = 1.0f / p->scale;
    f32x py = f_set((float)y);
    noise_row(w, (float)y * step, noise);
    for (int x = 0; x < color->width; x += AMB_LANES) {
        f32x px = i_to_f(i_lane_index() + x), cell = f_floor(px * step), t = quintic(px * step - cell);
        i32x at = f_to_i(cell);
        f32x offset[6];
        int first = i_lane(at, 0);
        for (int k = 0; k < 6; k++) {
            const float *row = noise + (size_t)k * w->cells;
            f32x left, right;
            if (p->scale >= 2.0f) { /* the group's cells are within as many lanes */
                left = f_permute(f_load(row + first), at - first);
                right = f_permute(f_load(row + first + 1), at - first);
            } else {
                left = f_gather(row, at);
                right = f_gather(row, at + 1);
            }
            offset[k] = f_lerp(left, right, t) * p->amount;
        }
        for (int c = 0; c < 3; c++)
            f_store(amb_image_row(color, c, y) + x, look_up(&w->from, c, px + offset[2 * c], py + offset[2 * c + 1]));
    }
    if (color->channels == 4)
        memcpy(amb_image_row(color, 3, y), amb_image_row(&w->from, 3, y), color->stride * sizeof(float));
}

static amb_status dispersion_apply(const amb_post_job *job, amb_error *error)
{
    const dispersion_params *p = job->params;
    if (p->amount <= 0.0f)
        return AMB_OK;
    dispersion_work work = {.job = job};
    long still = job->frame_index >= 0 ? job->frame_index / p->hold : -((-1 - job->frame_index) / p->hold) - 1;
    for (uint32_t i = 0; i < 6; i++)
        work.key[i] = hash_key(still, 16 + i);
    /* Lanes past the last pixel look a little further; a column's lattice cell is below column/scale + 1. */
    work.cells = ((size_t)((float)(job->color->width + 16) / p->scale) + 4 + 31) / 16 * 16;
    size_t threads = (size_t)amb_context_threads(job->context);
    work.noise = amb_scratch_take(job->scratch, 6 * threads * work.cells, sizeof(float));
    if (!work.noise)
        return amb_fail(error, AMB_ERROR_MEMORY, "post pass dispersion: out of memory");
    amb_status status = amb_scratch_swap(job->scratch, job->color, &work.from, error);
    if (status == AMB_OK)
        amb_parallel_for(job->context, job->color->height, dispersion_row, &work);
    return status;
}

const amb_post_pass WIDE(amb_post_dispersion) = {
    .name = "dispersion",
    .about = "red, green and blue each displaced by noise of their own",
    .params = {dispersion_table, sizeof dispersion_table / sizeof *dispersion_table, sizeof(dispersion_params)},
    .apply = dispersion_apply,
};
