#include "tests/raster_random.h"

#include "raster/internal.h"
#include "tests/raster_shaders.h"
#include "tests/truth_raster.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_DRAWS 6
#define MAX_VERTICES 24
#define MAX_INDICES 36

typedef struct random_draw {
    amb_draw state;
    raster_test_vertex vertex[MAX_VERTICES];
    uint32_t index[MAX_INDICES];
    raster_test_uniforms uniforms;
    bool flat; /* one depth for all vertices, w = 1: the truth knows the depth exactly */
} random_draw;

typedef struct random_pass {
    const uint8_t *byte, *end;
    int width, height, targets, draws, tile_size;
    int channels[2];
    amb_target target;
    random_draw draw[MAX_DRAWS];
    int samples;
    /* the truth's images: [target][channel][sample of a pixel], depth, stencil */
    float *color[2][4], *depth;
    int *stencil;
    /* while a primitive is drawn */
    const random_draw *now;
    int primitive;
    bool front;
    unsigned covered; /* samples of the pixel being drawn */
} random_pass;

/* ---- from bytes to a pass -----------------------------------------------------------------------------------------
 */

static int number(random_pass *p, int limit)
{
    int v = p->byte < p->end ? *p->byte++ : 0;
    if (limit > 256)
        v = v * 256 + (p->byte < p->end ? *p->byte++ : 0);
    return v % limit;
}

static float clip_component(random_pass *p, float plain)
{
    static const float hostile[] = {NAN, INFINITY, -INFINITY, 1e-40f, 3e38f, -3e38f, 0.0f, -0.0f};
    int n = number(p, 64);
    return n < 8 ? hostile[n] : plain;
}

static void random_vertices(random_pass *p, random_draw *d)
{
    int kind = number(p, 4);
    float z = (float)number(p, 33) * 0.03125f;
    d->flat = kind < 2;
    for (int i = 0; i < MAX_VERTICES; i++) {
        v4 *c = &d->vertex[i].clip;
        double reach = kind == 1 ? 2000.0 : 1.0;
        double x = (number(p, 1024) - 128) / 768.0 * p->width, y = (number(p, 1024) - 128) / 768.0 * p->height;
        double w = d->flat ? 1.0 : (number(p, 512) - 100) / 128.0;
        c->x = (float)((x * reach / (p->width * 0.5) - 1.0) * w);
        c->y = (float)((1.0 - y * reach / (p->height * 0.5)) * w);
        c->z = d->flat ? z : (float)(number(p, 300) - 20) / 256.0f * (float)w;
        c->w = (float)w;
        if (kind == 3)
            *c = (v4){clip_component(p, c->x), clip_component(p, c->y), clip_component(p, c->z),
                      clip_component(p, c->w)};
    }
}

static void random_output(random_pass *p, amb_draw *s)
{
    for (int i = 0; i < p->targets; i++) {
        s->blend[i] = (amb_blend)number(p, 5);
        amb_blend_equation *q = &s->equation[i];
        amb_factor *factor[4] = {&q->color_source, &q->color_target, &q->alpha_source, &q->alpha_target};
        for (int k = 0; k < 4; k++)
            *factor[k] = (amb_factor)number(p, p->targets == 1 ? 17 : 13);
        q->color_op = (amb_blend_op)number(p, 5), q->alpha_op = (amb_blend_op)number(p, 5);
        s->channels_off[i] = number(p, 4) == 0 ? (uint8_t)number(p, 16) : 0;
    }
    s->alpha_to_coverage = number(p, 6) == 0;
    s->blend_constant = (v4){0.5f, 0.25f, -1.0f, 0.75f};
    s->targets_off = number(p, 5) == 0 ? (uint32_t)number(p, 4) : 0;
    s->depth_compare = (amb_compare)number(p, 9);
    s->depth_write_off = number(p, 3) == 0;
    if (p->target.stencil && number(p, 2)) {
        amb_stencil *t = &s->stencil;
        amb_stencil_face *face[2] = {&t->front, &t->back};
        t->on = true;
        t->reference = (uint8_t)number(p, 256);
        t->read_mask_off = number(p, 2) ? (uint8_t)number(p, 256) : 0;
        t->write_mask_off = number(p, 2) ? (uint8_t)number(p, 256) : 0;
        for (int i = 0; i < 2; i++) {
            face[i]->compare = (amb_compare)number(p, 9);
            face[i]->fail = (amb_stencil_op)number(p, 8), face[i]->depth_fail = (amb_stencil_op)number(p, 8);
            face[i]->pass = (amb_stencil_op)number(p, 8);
        }
    }
    if (number(p, 3) == 0)
        s->scissor = (amb_rect){number(p, 256) - 30, number(p, 256) - 30, 1 + number(p, 128), 1 + number(p, 128)};
}

static void random_draw_state(random_pass *p, const raster_test_shaders *shaders, random_draw *d)
{
    amb_draw *s = &d->state;
    random_vertices(p, d);
    *s = (amb_draw){.lanes = shaders->lanes, .vertex = shaders->vertex, .varying_floats = 4};
    s->topology = (amb_topology)number(p, 6);
    s->count = (uint32_t)number(p, MAX_VERTICES + 1);
    if (number(p, 2)) {
        s->indices = d->index;
        s->vertex_count = (uint32_t)(1 + number(p, MAX_VERTICES));
        s->count = (uint32_t)number(p, MAX_INDICES + 1);
        for (int i = 0; i < MAX_INDICES; i++)
            d->index[i] = number(p, 16) == 0 ? UINT32_MAX : (uint32_t)number(p, MAX_VERTICES);
    }
    s->instances = (uint32_t)number(p, 4);
    s->cull = (amb_cull)number(p, 3);
    s->front_clockwise = number(p, 2) != 0;
    s->wireframe = number(p, 6) == 0;
    s->point_size = number(p, 2) ? (float)number(p, 200) / 16.0f : 0.0f;
    s->depth_clamp = number(p, 4) == 0;
    s->depth_bias = number(p, 4) == 0 ? (float)(number(p, 512) - 256) * 4096.0f : 0.0f;
    s->depth_bias_clamp = number(p, 2) ? (float)(number(p, 64) - 32) / 256.0f : 0.0f;
    random_output(p, s);
    d->uniforms = (raster_test_uniforms){.vertex = d->vertex, .offset = {0.25f, -0.125f, 0, 0}};
    d->uniforms.holes = number(p, 2) ? number(p, 5) : 0;
    s->uniforms = &d->uniforms, s->uniforms_size = sizeof d->uniforms;
    s->writes_depth = !d->flat || number(p, 2);
    s->fragment = s->writes_depth ? shaders->coded_depth : number(p, 8) == 0 ? NULL : shaders->coded;
}

static bool random_target(random_pass *p)
{
    static const int tiles[] = {64, 16, 32, 128};
    p->width = 1 + number(p, 90), p->height = 1 + number(p, 70);
    p->targets = 1 + number(p, 2);
    p->tile_size = tiles[number(p, 4)];
    bool made = true;
    p->samples = number(p, 2) ? 1 << number(p, 4) : 1;
    p->target.samples = p->samples;
    size_t pixels = (size_t)p->width * (size_t)p->height * (size_t)p->samples;
    for (int i = 0; i < p->targets && made; i++) {
        p->channels[i] = 1 + number(p, 4);
        p->target.clear_color[i] = (v4){0.5f, -0.25f, (float)number(p, 9) / 4.0f, 0.125f};
        made = amb_image_create(p->width, p->height, p->channels[i], &p->target.color[i], NULL) == AMB_OK;
        for (int c = 0; c < p->channels[i] && made; c++)
            made = (p->color[i][c] = calloc(pixels, sizeof(float))) != NULL;
    }
    p->target.clear_depth = (float)number(p, 9) / 8.0f;
    p->target.clear_stencil = (uint8_t)number(p, 256);
    if (made && number(p, 4))
        made = amb_image_create(p->width, p->height, 1, &p->target.depth, NULL) == AMB_OK;
    if (made && number(p, 2))
        made = amb_image_create(p->width, p->height, 1, &p->target.stencil, NULL) == AMB_OK;
    p->depth = calloc(pixels, sizeof *p->depth);
    p->stencil = calloc(pixels, sizeof *p->stencil);
    return made && p->depth && p->stencil;
}

/* ---- the truth ----------------------------------------------------------------------------------------------------
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

static float factor_truth(amb_factor factor, int c, const float s[4], const float second[4], const float d[4], v4 k)
{
    float value = 0.0f;
    const float constant[4] = {k.x, k.y, k.z, k.w};
    switch (factor) {
    case AMB_FACTOR_ZERO:
        return 0.0f;
    case AMB_FACTOR_ONE:
        return 1.0f;
    case AMB_FACTOR_SOURCE_ALPHA_SATURATE:
        return c == 3 ? 1.0f : fminf(s[3], 1.0f - d[3]);
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
                         const float d[4])
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
    float fs = factor_truth(c == 3 ? q->alpha_source : q->color_source, c, s, second, d, draw->blend_constant);
    float fd = factor_truth(c == 3 ? q->alpha_target : q->color_target, c, s, second, d, draw->blend_constant);
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

static float depth_truth(const random_pass *p)
{
    const amb_draw *draw = &p->now->state;
    if (draw->writes_depth)
        return clamp01(RASTER_TEST_CODE(p->primitive, 9));
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

static void truth_sample(random_pass *p, int at)
{
    const amb_draw *draw = &p->now->state;
    float depth = depth_truth(p);
    amb_compare mode = draw->depth_compare == AMB_COMPARE_DEFAULT ? AMB_LESS : draw->depth_compare;
    bool near_enough = !p->target.depth || compare_truth(mode, (double)depth, (double)p->depth[at]);
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
    for (int i = 0; i < p->targets && draw->fragment; i++) {
        float source[4], second[4], stored[4] = {0, 0, 0, 1};
        if (draw->targets_off >> i & 1u)
            continue;
        for (int c = 0; c < 4; c++) {
            source[c] = RASTER_TEST_CODE(p->primitive, 4 * i + c);
            second[c] = RASTER_TEST_CODE(p->primitive, 4 + c);
            if (c < p->channels[i])
                stored[c] = p->color[i][c][at];
        }
        for (int c = 0; c < p->channels[i]; c++)
            if (!(draw->channels_off[i] >> c & 1))
                p->color[i][c][at] = blend_truth(draw, i, c, source, second, stored);
    }
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
        int kept = (int)floor((double)(clamp01(RASTER_TEST_CODE(p->primitive, 3)) * (float)p->samples + 0.5f));
        p->covered &= (1u << kept) - 1u;
    }
    for (int i = 0; i < p->samples; i++)
        if (p->covered >> i & 1u)
            truth_sample(p, (y * p->width + x) * p->samples + i);
}

static void truth_pixel(void *user, int x, int y)
{
    random_pass *p = user;
    p->covered = ~0u;
    truth_samples(p, x, y);
}

static void truth_fill_samples(random_pass *p, const truth_triangle *t)
{
    static const int8_t positions[4][16] = {
        {0, 0}, {4, 4, -4, -4}, {-2, -6, 6, -2, -6, 2, 2, 6}, {1, -3, -1, 3, 5, 1, -3, -5, -5, 5, -7, -1, 3, 7, 7, -7}};
    int level = p->samples == 1 ? 0 : p->samples == 2 ? 1 : p->samples == 4 ? 2 : 3;
    for (int y = 0; y < p->height && truth_area(t) != 0; y++)
        for (int x = 0; x < p->width; x++) {
            p->covered = 0;
            for (int i = 0; i < p->samples; i++)
                p->covered |=
                    (unsigned)truth_covers_sample(t, x, y, positions[level][2 * i], positions[level][2 * i + 1]) << i;
            if (p->covered)
                truth_samples(p, x, y);
        }
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
            truth_draw_line(clip[i], clip[(i + 1) % 3], p->width, p->height, !draw->depth_clamp, truth_pixel, p);
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

/* Positions of a primitive's corners, -1 in the first past the last primitive. */
static int corners_of(amb_topology topology, int n, int count, int at[3])
{
    static const int corners[] = {3, 3, 3, 2, 2, 1};
    int first = topology == AMB_TRIANGLES ? 3 * n : topology == AMB_LINES ? 2 * n : n;
    for (int k = 0; k < 3; k++)
        at[k] = topology == AMB_TRIANGLE_FAN && k == 0 ? 0 : first + k;
    if (topology == AMB_TRIANGLE_STRIP && n % 2)
        at[1] = first + 2, at[2] = first + 1;
    if (first + corners[topology] > count)
        return 0;
    return corners[topology];
}

static void truth_draw_all(random_pass *p, const random_draw *d)
{
    const amb_draw *s = &d->state;
    p->now = d;
    p->primitive = 0;
    int instances = s->instances ? (int)s->instances : 1;
    for (int instance = 0; instance < instances; instance++) {
        int at[3], corners;
        for (int n = 0; (corners = corners_of(s->topology, n, (int)s->count, at)) > 0; n++, p->primitive++) {
            float clip[3][4];
            bool valid = true;
            for (int k = 0; k < corners && valid; k++) {
                uint32_t v = s->indices ? d->index[at[k]] : (uint32_t)at[k];
                valid = !s->indices || v < s->vertex_count;
                if (!valid)
                    break;
                const float *offset = &d->uniforms.offset.x;
                memcpy(clip[k], &d->vertex[v].clip, sizeof clip[k]);
                for (int c = 0; c < 4; c++)
                    clip[k][c] += offset[c] * (float)instance;
            }
            if (!valid)
                continue;
            p->front = true;
            float size = s->point_size > 0.0f ? s->point_size : 1.0f;
            if (corners == 3)
                truth_triangle_of(p, (const float(*)[4])clip);
            else if (corners == 2)
                truth_draw_line(clip[0], clip[1], p->width, p->height, !s->depth_clamp, truth_pixel, p);
            else
                truth_draw_point(clip[0], size, p->width, p->height, !s->depth_clamp, truth_pixel, p);
        }
    }
}

/* ---- both, compared -----------------------------------------------------------------------------------------------
 */

static void clear_truth(random_pass *p)
{
    for (int i = 0; i < p->width * p->height * p->samples; i++) {
        for (int t = 0; t < p->targets; t++)
            for (int c = 0; c < p->channels[t]; c++)
                p->color[t][c][i] = (&p->target.clear_color[t].x)[c];
        p->depth[i] = p->target.clear_depth;
        p->stencil[i] = p->target.clear_stencil;
    }
}

/* The average of a pixel's samples, added in pairs. */
static float resolved(const random_pass *p, int target, int channel, int pixel)
{
    float v[8];
    for (int i = 0; i < p->samples; i++)
        v[i] = p->color[target][channel][pixel * p->samples + i];
    for (int n = p->samples; n > 1; n /= 2)
        for (int i = 0; i < n / 2; i++)
            v[i] = v[2 * i] + v[2 * i + 1];
    return v[0] / (float)p->samples;
}

static long compare_images(const random_pass *p, char what[64])
{
    long differences = 0;
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            int at = y * p->width + x;
            const char *name = NULL;
            for (int t = 0; t < p->targets; t++)
                for (int c = 0; c < p->channels[t]; c++) {
                    float a = amb_image_row(p->target.color[t], c, y)[x], b = resolved(p, t, c, at);
                    if (!(a == b || (isnan(a) && isnan(b))))
                        name = "colour";
                }
            if (p->target.depth && amb_image_row(p->target.depth, 0, y)[x] != p->depth[at * p->samples])
                name = "depth";
            if (p->target.stencil && amb_image_row(p->target.stencil, 0, y)[x] != (float)p->stencil[at * p->samples])
                name = "stencil";
            if (name && differences++ == 0)
                snprintf(what, 64, "%s at (%d, %d) of %d×%d", name, x, y, p->width, p->height);
        }
    return differences;
}

static void free_pass(random_pass *p)
{
    for (int i = 0; i < 2; i++) {
        amb_image_close(&p->target.color[i]);
        for (int c = 0; c < 4; c++)
            free(p->color[i][c]);
    }
    amb_image_close(&p->target.depth);
    amb_image_close(&p->target.stencil);
    free(p->depth);
    free(p->stencil);
    free(p);
}

long raster_random_differences(const amb_context *context, const uint8_t *bytes, size_t count, char what[64])
{
    random_pass *p = calloc(1, sizeof *p);
    if (!p)
        return -1;
    p->byte = bytes, p->end = bytes + count;
    long differences = -1;
    amb_pass *pass = NULL;
    amb_error error = {0};
    if (!random_target(p))
        goto done;
    clear_truth(p);
    p->draws = 1 + number(p, MAX_DRAWS);
    snprintf(what, 64, "a call failed");
    if (raster_pass_begin(context, &p->target, p->tile_size, (size_t)number(p, 2) << 24, &pass, &error) != AMB_OK)
        goto done;
    for (int i = 0; i < p->draws; i++) {
        random_draw_state(p, raster_test_shaders_of(amb_context_isa(context)), &p->draw[i]);
        if (amb_pass_draw(pass, &p->draw[i].state, &error) != AMB_OK) {
            snprintf(what, 64, "%.63s", error.detail);
            goto done;
        }
        truth_draw_all(p, &p->draw[i]);
    }
    if (amb_pass_finish(&pass, NULL, &error) == AMB_OK)
        differences = compare_images(p, what);
done:
    amb_pass_close(&pass);
    free_pass(p);
    return differences;
}
