/* Exposure in stops, for use before bloom (display has its own, after it). */
#include "post/scratch.h"

#include <ambiance/math.h>

#include <stddef.h>

typedef struct exposure_params {
    float stops;
} exposure_params;

/* clang-format off */
static const amb_param exposure_table[] = {
    {"stops", AMB_PARAM_FLOAT, "stops", -20.0f, 20.0f, {0.0f}, NULL, offsetof(exposure_params, stops),
     "light is multiplied by 2 to this power"},
};
/* clang-format on */

static void exposure_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    (void)state;
    float gain = amb_exp2(((const exposure_params *)job->params)->stops);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < span->count; i += AMB_LANES)
            f_store(span->rgb[c] + i, f_load(span->rgb[c] + i) * gain);
}

const amb_post_pass WIDE(amb_post_exposure) = {
    .name = "exposure",
    .about = "light times a power of two",
    .params = {exposure_table, sizeof exposure_table / sizeof *exposure_table, sizeof(exposure_params)},
    .span = exposure_span,
};
