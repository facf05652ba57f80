/* Film grain: noise of triangular distribution, drawn anew for each frame index, its strength growing with the square
 * root of the light, as photon noise does. */
#include "post/hash.h"
#include "post/scratch.h"

#include <ambiance/vec.h>

#include <stddef.h>

typedef struct grain_params {
    float amount;
    int size, colored;
} grain_params;

/* clang-format off */
static const amb_param grain_table[] = {
    {"amount", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.05f}, NULL, offsetof(grain_params, amount),
     "largest change of light 1; grows with its square root"},
    {"size", AMB_PARAM_INT, "pixels", 1.0f, 16.0f, {1.0f}, NULL, offsetof(grain_params, size),
     "width and height of a grain"},
    {"colored", AMB_PARAM_BOOL, "", 0.0f, 1.0f, {0.0f}, NULL, offsetof(grain_params, colored),
     "own noise for each channel"},
};
/* clang-format on */

/* In (-1, 1), triangular: the difference of two uniform numbers, 16 bits each. */
AMB_INLINE f32x triangular(u32x h)
{
    return (i_to_f(u_as_i(h >> 16)) - i_to_f(u_as_i(h & 0xffffu))) * 1.52587890625e-5f;
}

static void grain_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    (void)state;
    const grain_params *p = job->params;
    uint32_t key[3];
    for (uint32_t c = 0; c < 3; c++)
        key[c] = hash_key(job->frame_index, p->colored ? c : 0);
    i32x y = i_set(span->y / p->size);
    for (int i = 0; i < span->count; i += AMB_LANES) {
        i32x x = i_lane_index() + (span->x + i);
        if (p->size > 1)
            x = f_to_i((i_to_f(x) + 0.5f) / (float)p->size); /* exact: x is below 2²³ */
        v3x rgb = {f_load(span->rgb[0] + i), f_load(span->rgb[1] + i), f_load(span->rgb[2] + i)};
        f32x light = rgb.x * 0.2126f + rgb.y * 0.7152f + rgb.z * 0.0722f;
        f32x strength = f_sqrt(f_clamp(light, f_set(0.0f), f_set(65504.0f))) * p->amount;
        f32x noise = triangular(hash_point(x, y, key[0]));
        f_store(span->rgb[0] + i, rgb.x + strength * noise);
        if (p->colored)
            noise = triangular(hash_point(x, y, key[1]));
        f_store(span->rgb[1] + i, rgb.y + strength * noise);
        if (p->colored)
            noise = triangular(hash_point(x, y, key[2]));
        f_store(span->rgb[2] + i, rgb.z + strength * noise);
    }
}

const amb_post_pass WIDE(amb_post_grain) = {
    .name = "grain",
    .about = "film grain, new in every frame, repeatable by its index",
    .params = {grain_table, sizeof grain_table / sizeof *grain_table, sizeof(grain_params)},
    .span = grain_span,
};
