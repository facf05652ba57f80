#include <ambiance/compare.h>

#include "core/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Floats in increasing order as increasing integers, both zeros at 0. */
static int64_t ordered(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    int64_t magnitude = bits & 0x7fffffffu;
    return bits >> 31 ? -magnitude : magnitude;
}

uint64_t amb_ulp_distance(float a, float b)
{
    if (isnan(a) || isnan(b))
        return UINT64_MAX;
    int64_t distance = ordered(a) - ordered(b);
    return (uint64_t)(distance < 0 ? -distance : distance);
}

/* Running sums of a channel; squares are summed by row first, so that long sums lose little. */
typedef struct tally {
    amb_difference d;
    double squares;
} tally;

static bool is_over(double distance, uint64_t ulp, const amb_compare_options *options)
{
    if (options->use_tolerance && distance <= options->tolerance)
        return false;
    return !(options->use_ulp && ulp <= options->max_ulp);
}

/* Adds a pair whose bits differ; returns the square of the difference. */
static double add_pair(amb_difference *d, float a, float b, int x, int y, const amb_compare_options *options)
{
    bool is_first = d->differing++ == 0;
    if (isnan(a) || isnan(b)) {
        d->nan++;
        d->over++;
        if (is_first)
            d->worst_x = x, d->worst_y = y;
        return 0.0;
    }
    double distance = fabs((double)a - (double)b);
    uint64_t ulp = amb_ulp_distance(a, b);
    if (is_first || distance > d->max_abs)
        d->worst_x = x, d->worst_y = y;
    d->max_abs = distance > d->max_abs ? distance : d->max_abs;
    d->max_ulp = ulp > d->max_ulp ? ulp : d->max_ulp;
    d->over += is_over(distance, ulp, options);
    return distance * distance;
}

static void finish(tally *t, const amb_compare_options *options)
{
    uint64_t counted = t->d.values - t->d.nan;
    double peak = options->peak > 0.0 ? options->peak : 1.0;
    t->d.rmse = counted ? sqrt(t->squares / (double)counted) : 0.0;
    t->d.psnr = t->d.rmse > 0.0 ? 20.0 * log10(peak / t->d.rmse) : (double)INFINITY;
}

static tally compare_channel(const amb_image *a, const amb_image *b, int channel, const amb_compare_options *options)
{
    tally t = {.d = {.values = (uint64_t)a->width * (uint64_t)a->height, .worst_x = -1, .worst_y = -1}};
    for (int y = 0; y < a->height; y++) {
        const float *row_a = amb_image_row(a, channel, y), *row_b = amb_image_row(b, channel, y);
        double squares = 0.0;
        if (memcmp(row_a, row_b, (size_t)a->width * sizeof *row_a) == 0)
            continue;
        for (int x = 0; x < a->width; x++)
            if (memcmp(&row_a[x], &row_b[x], sizeof row_a[x]) != 0)
                squares += add_pair(&t.d, row_a[x], row_b[x], x, y, options);
        t.squares += squares;
    }
    finish(&t, options);
    return t;
}

static const amb_compare_options exact;

amb_difference amb_compare_channel(const amb_image *a, const amb_image *b, int channel,
                                   const amb_compare_options *options)
{
    return compare_channel(a, b, channel, options ? options : &exact).d;
}

static void add_to_total(tally *total, const tally *t)
{
    if (total->d.worst_x < 0 || t->d.max_abs > total->d.max_abs)
        total->d.worst_x = t->d.worst_x, total->d.worst_y = t->d.worst_y;
    total->d.values += t->d.values;
    total->d.differing += t->d.differing;
    total->d.over += t->d.over;
    total->d.nan += t->d.nan;
    total->d.max_abs = t->d.max_abs > total->d.max_abs ? t->d.max_abs : total->d.max_abs;
    total->d.max_ulp = t->d.max_ulp > total->d.max_ulp ? t->d.max_ulp : total->d.max_ulp;
    total->squares += t->squares;
}

/* Appends the channels of one layer; image_b or image_a may be NULL. */
static void compare_layer(amb_comparison *c, tally *total, const char *name, const amb_image *image_a,
                          const amb_image *image_b, const amb_compare_options *options)
{
    int in_a = image_a ? image_a->channels : 0, in_b = image_b ? image_b->channels : 0;
    for (int channel = 0; channel < in_a || channel < in_b; channel++) {
        amb_compare_row *row = &c->row[c->row_count++];
        memcpy(row->layer, name, sizeof row->layer);
        row->channel = channel;
        row->presence = channel >= in_b ? AMB_ONLY_IN_A : channel >= in_a ? AMB_ONLY_IN_B : AMB_IN_BOTH;
        row->difference = (amb_difference){.worst_x = -1, .worst_y = -1};
        if (row->presence != AMB_IN_BOTH) {
            c->passed = false;
            continue;
        }
        tally t = compare_channel(image_a, image_b, channel, options);
        row->difference = t.d;
        add_to_total(total, &t);
    }
}

static bool is_chosen(const char *name, const char *layer) { return !layer || strcmp(name, layer) == 0; }

static const char *layer_name(const void *user, int index) { return ((const amb_frame *)user)->layer[index].name; }

amb_status amb_compare_frames(const amb_frame *a, const amb_frame *b, const amb_compare_options *options,
                              amb_comparison **out, amb_error *error)
{
    *out = NULL;
    options = options ? options : &exact;
    if (!(options->tolerance >= 0.0))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "tolerance: %g; 0 or more is allowed", options->tolerance);
    if (!(options->peak >= 0.0) || isinf(options->peak))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "peak: %g; a finite value above 0 is allowed", options->peak);
    char hint[320];
    if (options->layer && !amb_frame_layer(a, options->layer) && !amb_frame_layer(b, options->layer))
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "unknown layer: %s; %s", options->layer,
                        amb_names_hint(options->layer, a->layer_count, layer_name, a, hint, sizeof hint));

    size_t rows = (size_t)(a->layer_count + b->layer_count) * AMB_MAX_CHANNELS;
    amb_comparison *c = calloc(1, sizeof *c + rows * sizeof c->row[0]);
    if (!c)
        return amb_fail(error, AMB_ERROR_MEMORY, "compare: out of memory");
    tally total = {.d = {.worst_x = -1, .worst_y = -1}};
    c->passed = true;
    if (a->width != b->width || a->height != b->height) {
        c->sizes_differ = true;
        c->passed = false;
    }
    for (int i = 0; !c->sizes_differ && i < a->layer_count; i++)
        if (is_chosen(a->layer[i].name, options->layer))
            compare_layer(c, &total, a->layer[i].name, a->layer[i].image, amb_frame_layer(b, a->layer[i].name),
                          options);
    for (int i = 0; !c->sizes_differ && i < b->layer_count; i++)
        if (is_chosen(b->layer[i].name, options->layer) && !amb_frame_layer(a, b->layer[i].name))
            compare_layer(c, &total, b->layer[i].name, NULL, b->layer[i].image, options);
    finish(&total, options);
    c->total = total.d;
    c->passed = c->passed && c->total.over == 0;
    *out = c;
    return AMB_OK;
}

static void subtract(const amb_image *a, const amb_image *b, amb_image *out)
{
    for (int channel = 0; channel < out->channels; channel++)
        for (int y = 0; y < out->height; y++) {
            const float *row_a = amb_image_row(a, channel, y), *row_b = amb_image_row(b, channel, y);
            float *row = amb_image_row(out, channel, y);
            for (int x = 0; x < out->width; x++) {
                bool is_same = memcmp(&row_a[x], &row_b[x], sizeof row_a[x]) == 0;
                float distance = fabsf(row_a[x] - row_b[x]);
                row[x] = is_same ? 0.0f : isnan(distance) ? INFINITY : distance;
            }
        }
}

amb_status amb_compare_difference(const amb_frame *a, const amb_frame *b, const char *layer, amb_frame **out,
                                  amb_error *error)
{
    *out = NULL;
    if (a->width != b->width || a->height != b->height)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "difference: sizes differ: %dx%d and %dx%d", a->width, a->height,
                        b->width, b->height);
    amb_frame *frame = NULL;
    int common = 0;
    amb_status status = amb_frame_create(a->width, a->height, &frame, error);
    for (int i = 0; status == AMB_OK && i < a->layer_count; i++) {
        const amb_image *image_a = a->layer[i].image, *image_b = amb_frame_layer(b, a->layer[i].name);
        if (!image_b || !is_chosen(a->layer[i].name, layer))
            continue;
        int channels = image_a->channels < image_b->channels ? image_a->channels : image_b->channels;
        amb_image *image = amb_frame_layer(frame, a->layer[i].name);
        if (image && image->channels > channels)
            image->channels = channels; /* "color" may have fewer; planar, so the rest is simply not used */
        else if (!image)
            status = amb_frame_add_layer(frame, a->layer[i].name, channels, &image, error);
        if (status == AMB_OK)
            subtract(image_a, image_b, image);
        common++;
    }
    if (status == AMB_OK && common == 0)
        status = amb_fail(error, AMB_ERROR_ARGUMENT, "difference: the files have no layer in common");
    if (status != AMB_OK) {
        amb_frame_close(&frame);
        return status;
    }
    *out = frame;
    return AMB_OK;
}
