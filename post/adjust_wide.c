/* Colour adjustment in linear HDR light, in this order: blur, saturation, contrast, brightness, fade to black, fade to
 * white. Because a fade scales light before the display clips it, a sun that clips to white shows its yellow again on
 * its way to black. NaN and Inf stay in their own pixels. */
#include "post/glow.h"

#include <stddef.h>

typedef struct adjust_params {
    float blur, saturation, contrast, pivot, brightness, black, white, sigma;
    int reduce;
} adjust_params;

/* clang-format off */
static const amb_param adjust_table[] = {
    {"blur", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.0f}, NULL, offsetof(adjust_params, blur),
     "mix with the blurred picture: 0 sharp, 1 blurred"},
    {"saturation", AMB_PARAM_FLOAT, "", 0.0f, 8.0f, {1.0f}, NULL, offsetof(adjust_params, saturation),
     "0 grey of equal luminance, 1 unchanged"},
    {"contrast", AMB_PARAM_FLOAT, "", 0.0f, 8.0f, {1.0f}, NULL, offsetof(adjust_params, contrast),
     "distance from the pivot is multiplied by this"},
    {"pivot", AMB_PARAM_FLOAT, "", 0.0f, 100.0f, {0.18f}, NULL, offsetof(adjust_params, pivot),
     "light that contrast leaves as it is"},
    {"brightness", AMB_PARAM_FLOAT, "", 0.0f, 1000.0f, {1.0f}, NULL, offsetof(adjust_params, brightness),
     "light is multiplied by this"},
    {"black", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.0f}, NULL, offsetof(adjust_params, black),
     "fade to black: 1 is all black"},
    {"white", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.0f}, NULL, offsetof(adjust_params, white),
     "fade to white (light 1): 1 is all white"},
    {"sigma", AMB_PARAM_FLOAT, "cells", 0.3f, 4.0f, {1.7f}, NULL, offsetof(adjust_params, sigma),
     "blur: standard deviation of one of the three 7-tap Gaussians, as bloom's"},
    {"reduce", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {1.0f}, glow_reductions, offsetof(adjust_params, reduce),
     "blur: size it works at, as bloom's"},
};
/* clang-format on */

typedef struct adjust_state {
    glow glow;
} adjust_state;

static amb_status adjust_begin(const amb_post_job *job, void *state, bool *collects, amb_error *error)
{
    const adjust_params *p = job->params;
    adjust_state *s = state;
    if (p->blur <= 0.0f)
        return AMB_OK;
    *collects = true;
    amb_status status = amb_glow_begin(job, 2 << p->reduce, &s->glow, error);
    if (status == AMB_OK)
        amb_glow_gaussian(&s->glow, p->sigma);
    return status;
}

/* What the blur sees: NaN as 0, light within ±GLOW_LIMIT. */
AMB_INLINE f32x contained(f32x a)
{
    f32x sane = f_clamp(a, f_set(-GLOW_LIMIT), f_set(GLOW_LIMIT));
    return f_sel(f_is_nan(a), f_set(0.0f), sane);
}

AMB_INLINE v3x all_light(const void *user, v3x rgb)
{
    (void)user;
    return (v3x){contained(rgb.x), contained(rgb.y), contained(rgb.z)};
}

static void adjust_collect(const amb_post_job *job, void *state, int y0, int y1, int thread)
{
    const adjust_state *s = state;
    glow_collect(&s->glow, job->color, y0, y1, thread, all_light, NULL, NULL);
}

static void adjust_finish(const amb_post_job *job, void *state)
{
    amb_glow_finish(job, &((adjust_state *)state)->glow);
}

static void mix_blur(const adjust_params *p, const glow *g, const amb_post_span *span)
{
    float cells[3][GLOW_SPAN_CELLS];
    amb_glow_rows(g, span, 1.0f, cells);
    glow_lanes lanes[2] = {glow_lanes_at(g, 0), glow_lanes_at(g, AMB_LANES)};
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < span->count; i += AMB_LANES) {
            f32x blurred = glow_at(g, cells[c], i, lanes[i / AMB_LANES & 1]);
            f_store(span->rgb[c] + i, f_lerp(contained(f_load(span->rgb[c] + i)), blurred, f_set(p->blur)));
        }
}

static void adjust_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    const adjust_params *p = job->params;
    const adjust_state *s = state;
    if (s->glow.reduce)
        mix_blur(p, &s->glow, span);
    float gain = p->contrast * p->brightness * (1.0f - p->black) * (1.0f - p->white);
    float lift = (p->pivot - p->pivot * p->contrast) * p->brightness * (1.0f - p->black) * (1.0f - p->white) + p->white;
    for (int i = 0; i < span->count; i += AMB_LANES) {
        f32x r = f_load(span->rgb[0] + i), g = f_load(span->rgb[1] + i), b = f_load(span->rgb[2] + i);
        f32x grey = r * 0.2126f + g * 0.7152f + b * 0.0722f;
        f32x base = grey * (1.0f - p->saturation);
        f_store(span->rgb[0] + i, (base + r * p->saturation) * gain + lift);
        f_store(span->rgb[1] + i, (base + g * p->saturation) * gain + lift);
        f_store(span->rgb[2] + i, (base + b * p->saturation) * gain + lift);
    }
}

const amb_post_pass WIDE(amb_post_adjust) = {
    .name = "adjust",
    .about = "blur, saturation, contrast, brightness, fades to black and white",
    .params = {adjust_table, sizeof adjust_table / sizeof *adjust_table, sizeof(adjust_params)},
    .state_size = sizeof(adjust_state),
    .begin = adjust_begin,
    .collect = adjust_collect,
    .finish = adjust_finish,
    .span = adjust_span,
};
