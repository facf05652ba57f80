/* The hillscape coursework's bloom: bright pass by luminance, down-sample, one blur each way with its own eight taps,
 * up-sample, add.
 *
 * Its shader sums taps -4…3 with weights[|i|] of {0.4, 0.2, 0.2, 0.1, 0.1}: they reach one pixel further to the left
 * than to the right and sum to 1.5, so both directions together amplify by 2.25. `weights=coursework` keeps that;
 * `weights=normalized` divides by 1.5. */
#include "post/glow.h"

#include <stddef.h>

enum { VIEW_SCENE, VIEW_BRIGHTPASS };
enum { WEIGHTS_COURSEWORK, WEIGHTS_NORMALIZED };

typedef struct brightpass_params {
    float cutoff, glare;
    int reduce, weights, view;
} brightpass_params;

static const char *const views[] = {"scene", "brightpass", NULL};
static const char *const weightings[] = {"coursework", "normalized", NULL};

/* clang-format off */
static const amb_param brightpass_table[] = {
    {"cutoff", AMB_PARAM_FLOAT, "", 0.0f, 65504.0f, {0.6f}, NULL, offsetof(brightpass_params, cutoff),
     "luminance from which a pixel passes"},
    {"glare", AMB_PARAM_FLOAT, "", 0.0f, 100.0f, {1.0f}, NULL, offsetof(brightpass_params, glare),
     "strength of what passes"},
    {"reduce", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {0.0f}, glow_reductions, offsetof(brightpass_params, reduce),
     "size the blur works at"},
    {"weights", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {WEIGHTS_COURSEWORK}, weightings, offsetof(brightpass_params, weights),
     "the coursework's taps, which sum to 1.5, or the same divided by that"},
    {"view", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {VIEW_SCENE}, views, offsetof(brightpass_params, view),
     "the picture with its bloom, or the bright pass alone"},
};
/* clang-format on */

typedef struct brightpass_state {
    glow glow;
    amb_image *bright, *blurred; /* intermediates, or NULL */
} brightpass_state;

static amb_status brightpass_begin(const amb_post_job *job, void *state, bool *collects, amb_error *error)
{
    static const float taps[8] = {0.1f, 0.1f, 0.2f, 0.2f, 0.4f, 0.2f, 0.2f, 0.1f};
    const brightpass_params *p = job->params;
    brightpass_state *s = state;
    amb_status status = AMB_OK;
    if (p->view == VIEW_BRIGHTPASS)
        return AMB_OK;
    *collects = true;
    if (job->intermediates) {
        status = amb_post_layer(job, "brightpass.bright", 3, &s->bright, error);
        if (status == AMB_OK)
            status = amb_post_layer(job, "brightpass.blurred", 3, &s->blurred, error);
    }
    if (status == AMB_OK)
        status = amb_glow_begin(job, 2 << p->reduce, &s->glow, error);
    for (int k = 0; k < 8; k++)
        s->glow.tap[k] = p->weights == WEIGHTS_COURSEWORK ? taps[k] : taps[k] / 1.5f;
    s->glow.taps = 8;
    s->glow.first = -4;
    s->glow.rounds = 1;
    return status;
}

/* The coursework's bright pass, saturated to 0…1. NaN passes as 0; light beyond GLOW_LIMIT counts as that. */
AMB_INLINE v3x bright(const void *user, v3x rgb)
{
    const brightpass_params *p = user;
    f32x zero = f_set(0.0f), limit = f_set(GLOW_LIMIT);
    rgb = (v3x){f_clamp(rgb.x, zero, limit), f_clamp(rgb.y, zero, limit), f_clamp(rgb.z, zero, limit)};
    f32x luminance = rgb.x * 0.2125f + rgb.y * 0.7154f + rgb.z * 0.0721f;
    if (!m_any(luminance > p->cutoff))
        return (v3x){zero, zero, zero}; /* what the division would give */
    f32x passed = f_max(luminance - p->cutoff, zero) * p->glare;
    f32x factor = passed / (luminance + 0.00001f);
    return (v3x){f_saturate(rgb.x * factor), f_saturate(rgb.y * factor), f_saturate(rgb.z * factor)};
}

static void brightpass_collect(const amb_post_job *job, void *state, int y0, int y1, int thread)
{
    const brightpass_state *s = state;
    glow_collect(&s->glow, job->color, y0, y1, thread, bright, job->params, s->bright);
}

static void brightpass_finish(const amb_post_job *job, void *state)
{
    amb_glow_finish(job, &((brightpass_state *)state)->glow);
}

static void show_bright(const brightpass_params *p, const amb_post_span *span)
{
    for (int i = 0; i < span->count; i += AMB_LANES) {
        v3x f = bright(p, (v3x){f_load(span->rgb[0] + i), f_load(span->rgb[1] + i), f_load(span->rgb[2] + i)});
        f_store(span->rgb[0] + i, f.x);
        f_store(span->rgb[1] + i, f.y);
        f_store(span->rgb[2] + i, f.z);
    }
}

static void brightpass_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    const brightpass_params *p = job->params;
    const brightpass_state *s = state;
    if (s->glow.reduce)
        glow_add(&s->glow, span, 1.0f, s->blurred);
    if (p->view == VIEW_BRIGHTPASS)
        show_bright(p, span);
}

const amb_post_pass WIDE(amb_post_brightpass) = {
    .name = "brightpass",
    .about = "the coursework's bloom: bright pass by luminance, one blur each way, added",
    .params = {brightpass_table, sizeof brightpass_table / sizeof *brightpass_table, sizeof(brightpass_params)},
    .state_size = sizeof(brightpass_state),
    .begin = brightpass_begin,
    .collect = brightpass_collect,
    .finish = brightpass_finish,
    .span = brightpass_span,
};
