/* Natural vignetting of a lens: light falls with the fourth power of the cosine of the angle off the axis. */
#include "post/scratch.h"

#include <ambiance/wide.h>

#include <stddef.h>

typedef struct vignette_params {
    float strength;
} vignette_params;

/* clang-format off */
static const amb_param vignette_table[] = {
    {"strength", AMB_PARAM_FLOAT, "", 0.0f, 4.0f, {0.5f}, NULL, offsetof(vignette_params, strength),
     "tangent of the angle off the axis in the picture's corners: 0 none, 1 a 90 degree lens"},
};
/* clang-format on */

static void vignette_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    (void)state;
    const vignette_params *p = job->params;
    float w = (float)job->color->width, h = (float)job->color->height;
    float scale = p->strength * p->strength / (w * w + h * h); /* corners are at twice these coordinates: below */
    float y = (float)(2 * span->y + 1) - h;
    for (int i = 0; i < span->count; i += AMB_LANES) {
        f32x x = i_to_f((i_lane_index() + (span->x + i)) * 2 + 1) - w;
        f32x one_over_cos2 = 1.0f + (x * x + y * y) * scale;
        f32x cos4 = 1.0f / (one_over_cos2 * one_over_cos2);
        for (int c = 0; c < 3; c++)
            f_store(span->rgb[c] + i, f_load(span->rgb[c] + i) * cos4);
    }
}

const amb_post_pass WIDE(amb_post_vignette) = {
    .name = "vignette",
    .about = "darker towards the corners, by the cosine-to-the-fourth law",
    .params = {vignette_table, sizeof vignette_table / sizeof *vignette_table, sizeof(vignette_params)},
    .span = vignette_span,
};
