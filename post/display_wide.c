/* The display transform: linear HDR → exposure → tone curve → transfer function → optional dither to 8 bits. Leaves
 * display-encoded values 0…1 in "color": it stands last in a chain. */
#include "post/encode.h"
#include "post/scratch.h"

#include <ambiance/math.h>
#include <ambiance/vec.h>

#include <stddef.h>

enum { CURVE_CLAMP, CURVE_REINHARD, CURVE_FILMIC, CURVE_ACES };
enum { ENCODE_SRGB, ENCODE_REC709, ENCODE_LINEAR };
enum { DITHER_NONE, DITHER_ORDERED, DITHER_GRADIENT };

typedef struct display_params {
    float exposure, white;
    int curve, encode, dither;
} display_params;

static const char *const curves[] = {"clamp", "reinhard", "filmic", "aces", NULL};
static const char *const encodings[] = {"srgb", "rec709", "linear", NULL};
static const char *const dithers[] = {"none", "ordered", "gradient", NULL};

/* clang-format off */
static const amb_param display_table[] = {
    {"exposure", AMB_PARAM_FLOAT, "stops", -20.0f, 20.0f, {0.0f}, NULL, offsetof(display_params, exposure),
     "light is multiplied by 2 to this power"},
    {"curve", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {CURVE_CLAMP}, curves, offsetof(display_params, curve),
     "clamp; reinhard (2002, eq. 4); filmic (Hable 2010); aces (Narkowicz 2015)"},
    {"white", AMB_PARAM_FLOAT, "", 0.1f, 65504.0f, {11.2f}, NULL, offsetof(display_params, white),
     "light shown as full white by reinhard and filmic"},
    {"encode", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {ENCODE_SRGB}, encodings, offsetof(display_params, encode),
     "transfer function of the display"},
    {"dither", AMB_PARAM_CHOICE, "", 0.0f, 0.0f, {DITHER_NONE}, dithers, offsetof(display_params, dither),
     "rounding to 8 bits: none leaves it to the writer; ordered (Bayer 8x8); gradient (Jimenez 2014)"},
};
/* clang-format on */

typedef struct display_state {
    float gain, white, white_share;
} display_state;

/* ---- tone curves of light ≥ 0 ------------------------------------------------------------------------------------ */

/* J. Hable, "Filmic Tonemapping Operators" / Uncharted 2, GDC 2010. */
AMB_INLINE f32x hable(f32x a)
{
    return (a * (a * 0.15f + 0.05f) + 0.004f) / (a * (a * 0.15f + 0.5f) + 0.06f) - 0.02f / 0.3f;
}

/* K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. */
AMB_INLINE f32x aces(f32x a) { return a * (a * 2.51f + 0.03f) / (a * (a * 2.43f + 0.59f) + 0.14f); }

/* E. Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002, equation 4, by channel;
 * white_share = 1/white². */
AMB_INLINE f32x reinhard(f32x a, float white_share) { return a * (1.0f + a * white_share) / (1.0f + a); }

/* NaN and negative light give 0; light beyond 65504 counts as that. */
AMB_INLINE f32x tone(const display_params *p, const display_state *s, f32x a)
{
    a = f_clamp(a * s->gain, f_set(0.0f), f_set(65504.0f));
    if (p->curve == CURVE_REINHARD)
        a = reinhard(a, s->white_share);
    else if (p->curve == CURVE_FILMIC)
        a = hable(a) * s->white;
    else if (p->curve == CURVE_ACES)
        a = aces(a);
    return f_saturate(a);
}

/* ---- dither ------------------------------------------------------------------------------------------------------ */

/* (i + ½)/64 with i the 8×8 Bayer index of the pixel: bits of x ^ y and y, interleaved from the lowest up. */
AMB_INLINE f32x bayer(i32x x, i32x y)
{
    i32x d = x ^ y;
    i32x index = ((d & 1) << 5) | ((y & 1) << 4) | ((d & 2) << 2) | ((y & 2) << 1) | ((d & 4) >> 1) | ((y & 4) >> 2);
    return (i_to_f(index) + 0.5f) * 0.015625f;
}

/* Interleaved gradient noise: J. Jimenez, "Next Generation Post Processing in Call of Duty", SIGGRAPH 2014. */
AMB_INLINE f32x gradient_noise(i32x x, i32x y)
{
    return f_fract(52.9829189f * f_fract(0.06711056f * i_to_f(x) + 0.00583715f * i_to_f(y)));
}

AMB_INLINE f32x to_8_bits(f32x a, f32x threshold)
{
    return f_min(f_floor(a * 255.0f + threshold), f_set(255.0f)) * (1.0f / 255.0f);
}

/* ---- the pass ---------------------------------------------------------------------------------------------------- */

static amb_status display_begin(const amb_post_job *job, void *state, bool *collects, amb_error *error)
{
    (void)collects, (void)error;
    const display_params *p = job->params;
    display_state *s = state;
    float w = p->white;
    s->gain = amb_exp2(p->exposure);
    s->white_share = 1.0f / (w * w);
    s->white = 1.0f / ((w * (w * 0.15f + 0.05f) + 0.004f) / (w * (w * 0.15f + 0.5f) + 0.06f) - 0.02f / 0.3f);
    return AMB_OK;
}

static void dither_row(const display_params *p, const amb_post_span *span, float *row)
{
    i32x y = i_set(span->y);
    for (int i = 0; i < span->count; i += AMB_LANES) {
        i32x x = i_lane_index() + (span->x + i);
        f32x threshold = p->dither == DITHER_ORDERED ? bayer(x, y) : gradient_noise(x, y);
        f_store(row + i, to_8_bits(f_load(row + i), threshold));
    }
}

static void display_span(const amb_post_job *job, const void *state, const amb_post_span *span)
{
    const display_params *p = job->params;
    for (int c = 0; c < 3; c++) {
        float *row = span->rgb[c];
        for (int i = 0; i < span->count; i += AMB_LANES) {
            f32x a = tone(p, state, f_load(row + i));
            if (p->encode == ENCODE_SRGB)
                a = f_encode_srgb(a);
            else if (p->encode == ENCODE_REC709)
                a = f_encode_rec709(a);
            f_store(row + i, a);
        }
        if (p->dither != DITHER_NONE)
            dither_row(p, span, row);
    }
}

const amb_post_pass WIDE(amb_post_display) = {
    .name = "display",
    .about = "linear light to display values 0..1: exposure, tone curve, transfer function, dither",
    .params = {display_table, sizeof display_table / sizeof *display_table, sizeof(display_params)},
    .state_size = sizeof(display_state),
    .begin = display_begin,
    .span = display_span,
};
