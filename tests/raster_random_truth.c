/* The truth of a random pass: every primitive over every pixel and sample, one after the other. */
#include "tests/raster_random_pass.h"

#include "tests/format_truth.h"
#include "tests/truth_raster.h"

#include <math.h>
#include <string.h>

/* ---- tests -------------------------------------------------------------------------------------------------------
 */

static bool compare_truth(amb_compare compare, double a, double b)
{
    switch (compare) {
    case AMB_NEVER:
        return false;
    case AMB_LESS:
        return a < b;
    case AMB_EQUAL:
        return a == b;
    case AMB_LESS_EQUAL:
        return a <= b;
    case AMB_GREATER:
        return a > b;
    case AMB_NOT_EQUAL:
        return a != b;
    case AMB_GREATER_EQUAL:
        return a >= b;
    default:
        return true;
    }
}

static int stencil_truth(amb_stencil_op op, int stored, int reference)
{
    switch (op) {
    case AMB_STENCIL_ZERO:
        return 0;
    case AMB_STENCIL_REPLACE:
        return reference;
    case AMB_STENCIL_INCREMENT_CLAMP:
        return stored == 255 ? 255 : stored + 1;
    case AMB_STENCIL_DECREMENT_CLAMP:
        return stored == 0 ? 0 : stored - 1;
    case AMB_STENCIL_INVERT:
        return 255 - stored;
    case AMB_STENCIL_INCREMENT_WRAP:
        return stored == 255 ? 0 : stored + 1;
    case AMB_STENCIL_DECREMENT_WRAP:
        return stored == 0 ? 255 : stored - 1;
    default:
        return stored;
    }
}

/* ---- blending ----------------------------------------------------------------------------------------------------
 */

static float factor_truth(amb_factor factor, int c, const float s[4], const float second[4], const float d[4],
                          const float constant[4])
{
    float value = 0.0f;
    switch (factor) {
    case AMB_FACTOR_ZERO:
        return 0.0f;
    case AMB_FACTOR_ONE:
        return 1.0f;
    case AMB_FACTOR_SOURCE_ALPHA_SATURATE:
        return c == 3 ? 1.0f : s[3] < 1.0f - d[3] ? s[3] : 1.0f - d[3];
    case AMB_FACTOR_SOURCE:
    case AMB_FACTOR_ONE_MINUS_SOURCE:
        value = s[c];
        break;
    case AMB_FACTOR_SOURCE_ALPHA:
    case AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA:
        value = s[3];
        break;
    case AMB_FACTOR_TARGET:
    case AMB_FACTOR_ONE_MINUS_TARGET:
        value = d[c];
        break;
    case AMB_FACTOR_TARGET_ALPHA:
    case AMB_FACTOR_ONE_MINUS_TARGET_ALPHA:
        value = d[3];
        break;
    case AMB_FACTOR_CONSTANT:
    case AMB_FACTOR_ONE_MINUS_CONSTANT:
        value = constant[c];
        break;
    case AMB_FACTOR_SECOND:
    case AMB_FACTOR_ONE_MINUS_SECOND:
        value = second[c];
        break;
    default:
        value = second[3];
    }
    bool complement = factor >= AMB_FACTOR_CONSTANT ? (factor - AMB_FACTOR_CONSTANT) % 2 == 1 : factor % 2 == 1;
    return complement ? 1.0f - value : value;
}

static float blend_truth(const amb_draw *draw, int target, int c, const float s[4], const float second[4],
                         const float d[4], const float constant[4])
{
    float a = s[3];
    switch (draw->blend[target]) {
    case AMB_BLEND_OFF:
        return s[c];
    case AMB_BLEND_ALPHA:
        return (c == 3 ? a : s[c] * a) + d[c] * (1.0f - a);
    case AMB_BLEND_ADD:
        return s[c] + d[c];
    case AMB_BLEND_MULTIPLY:
        return s[c] * d[c];
    default:
        break;
    }
    const amb_blend_equation *q = &draw->equation[target];
    float fs = factor_truth(c == 3 ? q->alpha_source : q->color_source, c, s, second, d, constant);
    float fd = factor_truth(c == 3 ? q->alpha_target : q->color_target, c, s, second, d, constant);
    switch (c == 3 ? q->alpha_op : q->color_op) {
    case AMB_BLEND_SUM:
        return s[c] * fs + d[c] * fd;
    case AMB_BLEND_DIFFERENCE:
        return s[c] * fs - d[c] * fd;
    case AMB_BLEND_REVERSE:
        return d[c] * fd - s[c] * fs;
    case AMB_BLEND_MIN:
        return s[c] < d[c] ? s[c] : d[c];
    default:
        return s[c] > d[c] ? s[c] : d[c];
    }
}

static float clamp01(float a) { return a > 0.0f ? a < 1.0f ? a : 1.0f : 0.0f; }

/* What the shader gives for a channel: an exact small number, or now and then something hostile. */
static float source_truth(const random_pass *p, int salt)
{
    static const float hostile[8] = RASTER_TEST_HOSTILE;
    if (((p->primitive * 7 + salt * 3) & 7) < p->now->uniforms.hostile)
        return hostile[(p->primitive + salt) & 7];
    return RASTER_TEST_CODE(p->primitive, salt);
}

static float depth_truth(const random_pass *p)
{
    const amb_draw *draw = &p->now->state;
    if (draw->writes_depth)
        return clamp01(source_truth(p, 9));
    if (random_is_screen(draw))
        return 1.0f;
    float z = p->now->vertex[0].clip.z;
    int exponent;
    frexpf(z, &exponent); /* z = m · 2^exponent, m in [½, 1) */
    float bias = z == 0.0f ? 0.0f : draw->depth_bias * ldexpf(1.0f, exponent - 1 - 23);
    if (draw->depth_bias_clamp > 0.0f)
        bias = fminf(bias, draw->depth_bias_clamp);
    if (draw->depth_bias_clamp < 0.0f)
        bias = fmaxf(bias, draw->depth_bias_clamp);
    return clamp01(z + bias);
}

float random_stored(const random_pass *p, int i, int channel, float value)
{
    return p->color[i].textured ? format_truth(p->color[i].texel, channel, value) : value;
}

static void truth_color(random_pass *p, int i, int at)
{
    const amb_draw *draw = &p->now->state;
    const random_color *color = &p->color[i];
    const bool clamped = color->textured && format_is_unorm(color->texel);
    float source[4], second[4], stored[4] = {0, 0, 0, 1}, constant[4];
    for (int c = 0; c < 4; c++) {
        source[c] = source_truth(p, 4 * i + c);
        second[c] = source_truth(p, 4 + c);
        constant[c] = (&draw->blend_constant.x)[c];
        if (c < color->channels)
            stored[c] = color->truth[c][at];
        if (clamped)
            source[c] = clamp01(source[c]), second[c] = clamp01(second[c]), constant[c] = clamp01(constant[c]);
    }
    for (int c = 0; c < color->channels; c++)
        if (!(draw->channels_off[i] >> c & 1))
            color->truth[c][at] = random_stored(p, i, c, blend_truth(draw, i, c, source, second, stored, constant));
}

static void truth_sample(random_pass *p, int at)
{
    const amb_draw *draw = &p->now->state;
    float depth = depth_truth(p);
    amb_compare mode = draw->depth_compare;
    if (mode == AMB_COMPARE_DEFAULT)
        mode = random_is_screen(draw) ? AMB_LESS_EQUAL : AMB_LESS;
    bool near_enough = !random_has_depth(p) || compare_truth(mode, (double)depth, (double)p->depth[at]);
    if (draw->stencil.on) {
        const amb_stencil *s = &draw->stencil;
        const amb_stencil_face *face = p->front ? &s->front : &s->back;
        int old = p->stencil[at], read = 255 ^ s->read_mask_off, write = 255 ^ s->write_mask_off;
        bool match = compare_truth(face->compare, s->reference & read, old & read);
        amb_stencil_op op = !match ? face->fail : near_enough ? face->pass : face->depth_fail;
        p->stencil[at] = (stencil_truth(op, old, s->reference) & write) | (old & ~write);
        if (!match)
            return;
    }
    if (!near_enough)
        return;
    if (!draw->depth_write_off)
        p->depth[at] = depth;
    for (int i = 0; i < p->targets && draw->fragment; i++)
        if (!(draw->targets_off >> i & 1u))
            truth_color(p, i, at);
}

/* All covered samples of a pixel. */
static void truth_samples(random_pass *p, int x, int y)
{
    const amb_draw *draw = &p->now->state;
    const amb_rect *r = &draw->scissor;
    if ((r->width || r->height) && (x < r->x || y < r->y || x >= r->x + r->width || y >= r->y + r->height))
        return;
    if (draw->fragment && ((x + 2 * y + p->primitive) & 3) < p->now->uniforms.holes)
        return;
    if (draw->alpha_to_coverage && draw->fragment) {
        int kept = (int)floor((double)(clamp01(source_truth(p, 3)) * (float)p->samples + 0.5f));
        p->covered &= (1u << kept) - 1u;
    }
    for (int i = 0; i < p->samples; i++)
        if (p->covered >> i & 1u)
            truth_sample(p, (y * p->width + x) * p->samples + i);
}

void random_truth_pixel(void *user, int x, int y)
{
    random_pass *p = user;
    p->covered = ~0u;
    truth_samples(p, x, y);
}

typedef struct sample_mask {
    uint8_t *covered; /* samples of every pixel */
    int width, sample;
} sample_mask;

static void add_sample(void *user, int x, int y)
{
    sample_mask *m = user;
    m->covered[y * m->width + x] |= (uint8_t)(1u << m->sample);
}

static void truth_fill_samples(random_pass *p, const truth_triangle *t)
{
    static const int8_t positions[4][16] = {
        {0, 0}, {4, 4, -4, -4}, {-2, -6, 6, -2, -6, 2, 2, 6}, {1, -3, -1, 3, 5, 1, -3, -5, -5, 5, -7, -1, 3, 7, 7, -7}};
    const int8_t *at = positions[p->samples == 1 ? 0 : p->samples == 2 ? 1 : p->samples == 4 ? 2 : 3];
    sample_mask m = {p->mask, p->width, 0};
    memset(p->mask, 0, (size_t)p->width * (size_t)p->height);
    for (; m.sample < p->samples; m.sample++)
        truth_fill_sample(t, p->width, p->height, at[2 * m.sample], at[2 * m.sample + 1], add_sample, &m);
    for (int i = 0; i < p->width * p->height; i++)
        if ((p->covered = p->mask[i]) != 0)
            truth_samples(p, i % p->width, i / p->width);
}

static bool culled(const random_pass *p)
{
    amb_cull cull = p->now->state.cull;
    return (cull == AMB_CULL_BACK && !p->front) || (cull == AMB_CULL_FRONT && p->front);
}

static void truth_triangle_of(random_pass *p, const float clip[3][4])
{
    const amb_draw *draw = &p->now->state;
    if (draw->wireframe) {
        double d = 0;
        for (int i = 0; i < 3; i++) {
            const float *b = clip[(i + 1) % 3], *c = clip[(i + 2) % 3];
            d += (double)clip[i][0] * ((double)b[1] * (double)c[3] - (double)c[1] * (double)b[3]);
        }
        p->front = (d < 0) == draw->front_clockwise;
        if (!(d > 0 || d < 0) || culled(p))
            return;
        for (int i = 0; i < 3; i++)
            truth_draw_line(clip[i], clip[(i + 1) % 3], p->width, p->height, !draw->depth_clamp, random_truth_pixel, p);
        return;
    }
    truth_triangle piece[7];
    int pieces = truth_clip(clip, p->width, p->height, !draw->depth_clamp, piece);
    for (int i = 0; i < pieces; i++) {
        p->front = (truth_area(&piece[i]) > 0) == draw->front_clockwise;
        if (!culled(p))
            truth_fill_samples(p, &piece[i]);
    }
}

void random_truth_primitive(random_pass *p, const float clip[3][4], int corners)
{
    const amb_draw *s = &p->now->state;
    float size = s->point_size > 0.0f ? s->point_size : 1.0f;
    p->front = true;
    if (corners == 3)
        truth_triangle_of(p, clip);
    else if (corners == 2)
        truth_draw_line(clip[0], clip[1], p->width, p->height, !s->depth_clamp, random_truth_pixel, p);
    else
        truth_draw_point(clip[0], size, p->width, p->height, !s->depth_clamp, random_truth_pixel, p);
}

/* ---- begin and end ------------------------------------------------------------------------------------------------
 */

void random_truth_clear(random_pass *p)
{
    for (int i = 0; i < p->width * p->height * p->samples; i++) {
        for (int t = 0; t < p->targets; t++)
            for (int c = 0; c < p->color[t].channels; c++)
                p->color[t].truth[c][i] = random_stored(p, t, c, (&p->target.clear_color[t].x)[c]);
        p->depth[i] = p->target.clear_depth;
        p->stencil[i] = p->target.clear_stencil;
    }
}

void random_truth_resolve(random_pass *p)
{
    for (int pixel = 0; p->samples > 1 && pixel < p->width * p->height; pixel++) {
        int first = pixel * p->samples;
        for (int t = 0; t < p->targets; t++)
            for (int c = 0; c < p->color[t].channels; c++) {
                float *sample = p->color[t].truth[c] + first, v[8];
                memcpy(v, sample, sizeof(float) * (size_t)p->samples);
                for (int n = p->samples; n > 1; n /= 2) /* in pairs */
                    for (int i = 0; i < n / 2; i++)
                        v[i] = v[2 * i] + v[2 * i + 1];
                for (int i = 0; i < p->samples; i++)
                    sample[i] = random_stored(p, t, c, v[0] / (float)p->samples);
            }
        for (int i = 1; i < p->samples; i++) {
            p->depth[first + i] = p->depth[first];
            p->stencil[first + i] = p->stencil[first];
        }
    }
}
