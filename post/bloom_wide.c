/* Bloom: what is brighter than a threshold, blurred and added, all in HDR, so that the sun bleeds and white brick does
 * not. The blur is three rounds of a 7-tap separable Gaussian at reduced size. */
#include "post/glow.h"

#include <stddef.h>

typedef struct bloom_params {
    float threshold, intensity, sigma;
    int reduce;
} bloom_params;

/* clang-format off */
static const amb_param bloom_table[] = {
    {"threshold", AMB_PARAM_FLOAT, "", 0.0f, 65504.0f, {1.0f}, NULL, offsetof(bloom_params, threshold),
     "largest channel from which a colour blooms; 1 is paper white"},
    {"intensity", AMB_PARAM_FLOAT, "", 0.0f, 100.0f, {0.3f}, NULL, offsetof(bloom_params, intensity),
     "how much of the blurred excess is added"},
    {"sigma", AMB_PARAM_FLOAT, "cells", 0.3f, 4.0f, {1.7f}, NULL, offsetof(bloom_params, sigma),
     "standard deviation of one of the three 7-tap Gaussians, at reduced size"},
    {"reduce", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {1.0f}, glow_reductions, offsetof(bloom_params, reduce),
     "size the blur works at: smaller is wider and faster"},
};
/* clang-format on */

typedef struct bloom_state {
    glow glow;
    amb_image *bright, *blurred; /* intermediates, or NULL */
} bloom_state;

static amb_status bloom_begin(const amb_post_job *job, void *state, bool *collects, amb_error *error)
{
    const bloom_params *p = job->params;
    bloom_state *s = state;
    amb_status status = AMB_OK;
    if (job->intermediates) {
        status = amb_post_layer(job, "bloom.bright", 3, &s->bright, error);
        if (status == AMB_OK)
            status = amb_post_layer(job, "bloom.blurred", 3, &s->blurred, error);
    }
    *collects = p->intensity > 0.0f || job->intermediates;
    if (status == AMB_OK && *collects)
        status = amb_glow_begin(job, 2 << p->reduce, &s->glow, error);
    if (status == AMB_OK && *collects)
        amb_glow_gaussian(&s->glow, p->sigma);
    return status;
}

/* The colour scaled so that its largest channel loses the threshold: hue is kept. Negative light and NaN count as 0,
 * anything above GLOW_LIMIT as that, so that no pixel can spoil its neighbours. */
AMB_INLINE v3x bright(const void *user, v3x rgb)
{
    const bloom_params *p = user;
    f32x zero = f_set(0.0f), limit = f_set(GLOW_LIMIT);
    rgb = (v3x){f_clamp(rgb.x, zero, limit), f_clamp(rgb.y, zero, limit), f_clamp(rgb.z, zero, limit)};
    f32x largest = f_max(rgb.x, f_max(rgb.y, rgb.z));
    if (!m_any(largest > p->threshold))
        return (v3x){zero, zero, zero}; /* what the division would give */
    f32x excess = f_max(largest - p->threshold, zero) / f_max(largest, f_set(1e-20f));
    return v3x_scale(rgb, excess);
}

static void bloom_collect(const amb_post_job *job, void *state, int y0, int y1, int thread)
{
    const bloom_state *s = state;
    glow_collect(&s->glow, job->color, y0, y1, thread, bright, job->params, s->bright);
}

static void bloom_finish(const amb_post_job *job, void *state) { amb_glow_finish(job, &((bloom_state *)state)->glow); }

static void bloom_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    const bloom_params *p = job->params;
    const bloom_state *s = state;
    if (s->glow.reduce)
        glow_add(&s->glow, span, p->intensity, s->blurred);
}

const amb_post_pass WIDE(amb_post_bloom) = {
    .name = "bloom",
    .about = "light bleeding from what is brighter than a threshold, in HDR",
    .params = {bloom_table, sizeof bloom_table / sizeof *bloom_table, sizeof(bloom_params)},
    .state_size = sizeof(bloom_state),
    .begin = bloom_begin,
    .collect = bloom_collect,
    .finish = bloom_finish,
    .span = bloom_span,
};
