/* ambiance compare: two pictures, value by value. */
#include "cli/cli.h"

#include <ambiance/compare.h>
#include <ambiance/io.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char help[] =
    "usage: ambiance compare [OPTION…] A B\n\n"
    "Compares every value of every layer and channel of two pictures (EXR, PNG, JPEG, HDR): values that differ at\n"
    "all, greatest absolute difference, greatest difference in ULP (steps from one float to the next), RMSE, PSNR.\n"
    "Exit code 0 when they are the same within what is asked, 1 when not (also when sizes or layers differ).\n\n"
    "  --tolerance X      let values pass that differ by at most X\n"
    "  --max-ulp N        let values pass that are at most N floats apart; with both, either is enough\n"
    "  --layer NAME       this layer only\n"
    "  --peak X           peak value of the PSNR (default 1)\n"
    "  --diff FILE        write |A - B|: .exr as it is, .png scaled so that the greatest difference is white\n"
    "  --json             for programs\n"
    "  --quiet            say nothing: exit code only\n\n"
    "Without a tolerance, equal means the same bits: -0 is not 0, and a NaN equals only itself. A NaN against\n"
    "anything else is over every tolerance.\n";

typedef struct request {
    amb_compare_options options;
    const char *diff;
    bool json, quiet;
    const char *a, *b;
} request;

static int read_request(int argc, char **argv, request *r)
{
    enum { TOLERANCE = 1, MAX_ULP, LAYER, PEAK, DIFF, JSON, QUIET };
    static const struct option options[] = {
        {"tolerance", required_argument, NULL, TOLERANCE},
        {"max-ulp", required_argument, NULL, MAX_ULP},
        {"layer", required_argument, NULL, LAYER},
        {"peak", required_argument, NULL, PEAK},
        {"diff", required_argument, NULL, DIFF},
        {"json", no_argument, NULL, JSON},
        {"quiet", no_argument, NULL, QUIET},
        {0},
    };
    long long ulp;
    int option, code = 0;
    while (code == 0 && (option = next_option(argc, argv, ":", options)) != -1) {
        switch (option) {
        case TOLERANCE:
            r->options.use_tolerance = true;
            code = read_number("--tolerance", optarg, 0.0, (double)INFINITY, &r->options.tolerance);
            break;
        case MAX_ULP:
            r->options.use_ulp = true;
            code = read_integer("--max-ulp", optarg, 0, 1ll << 32, &ulp);
            r->options.max_ulp = (uint64_t)ulp;
            break;
        case PEAK:
            code = read_number("--peak", optarg, 1e-30, 1e30, &r->options.peak);
            break;
        case LAYER:
            r->options.layer = optarg;
            break;
        case DIFF:
            r->diff = optarg;
            break;
        case JSON:
            r->json = true;
            break;
        case QUIET:
            r->quiet = true;
            break;
        default:
            return EXIT_USAGE;
        }
    }
    if (code)
        return code;
    if (argc - optind != 2)
        return fail(EXIT_USAGE, "compare: %d files given; exactly two are expected", argc - optind);
    r->a = argv[optind];
    r->b = argv[optind + 1];
    return r->diff ? check_output(r->diff) : 0;
}

static json_t *json_difference(const amb_difference *d)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:o, s:I, s:o, s:o, s:[ii]}", "values", (json_int_t)d->values, "differing",
                     (json_int_t)d->differing, "over", (json_int_t)d->over, "nan", (json_int_t)d->nan, "max_abs",
                     json_number(d->max_abs), "max_ulp", (json_int_t)d->max_ulp, "rmse", json_number(d->rmse), "psnr",
                     json_number(d->psnr), "worst", d->worst_x, d->worst_y);
}

static const char *presence_text(amb_presence presence)
{
    return presence == AMB_ONLY_IN_A ? "only in A" : presence == AMB_ONLY_IN_B ? "only in B" : "both";
}

static int channels_of(const amb_frame *a, const amb_frame *b, const char *layer)
{
    const amb_image *image = amb_frame_layer(a, layer);
    return image ? image->channels : amb_frame_layer(b, layer)->channels;
}

static int report_json(const request *r, const amb_frame *a, const amb_frame *b, const amb_comparison *c)
{
    json_t *rows = json_array();
    for (int i = 0; i < c->row_count; i++) {
        const amb_compare_row *row = &c->row[i];
        json_array_append_new(rows,
                              json_pack("{s:s, s:s, s:s, s:o}", "layer", row->layer, "channel",
                                        channel_name(channels_of(a, b, row->layer), row->channel), "in",
                                        presence_text(row->presence), "difference", json_difference(&row->difference)));
    }
    return print_json(json_pack("{s:o, s:o, s:b, s:[ii], s:[ii], s:o, s:o}", "a", json_text(r->a), "b", json_text(r->b),
                                "same", (int)c->passed, "size_a", a->width, a->height, "size_b", b->width, b->height,
                                "total", json_difference(&c->total), "channels", rows));
}

static void print_row(const char *layer, const char *channel, const amb_difference *d)
{
    printf("%-18s %-3s %10llu %10llu  %-12.6g %-10llu %-12.6g %8.2f", layer, channel, (unsigned long long)d->differing,
           (unsigned long long)d->over, d->max_abs, (unsigned long long)d->max_ulp, d->rmse, d->psnr);
    if (d->worst_x >= 0)
        printf("  %d,%d", d->worst_x, d->worst_y);
    if (d->nan)
        printf("  (%llu NaN)", (unsigned long long)d->nan);
    putchar('\n');
}

static void report_text(const amb_frame *a, const amb_frame *b, const amb_comparison *c)
{
    if (c->sizes_differ) {
        printf("different: sizes: %dx%d and %dx%d\n", a->width, a->height, b->width, b->height);
        return;
    }
    printf("%-18s %-3s %10s %10s  %-12s %-10s %-12s %8s  %s\n", "layer", "", "differing", "over", "max abs", "max ULP",
           "RMSE", "PSNR dB", "worst at");
    for (int i = 0; i < c->row_count; i++) {
        const amb_compare_row *row = &c->row[i];
        const char *channel = channel_name(channels_of(a, b, row->layer), row->channel);
        if (row->presence == AMB_IN_BOTH)
            print_row(row->layer, channel, &row->difference);
        else
            printf("%-18s %-3s %s\n", row->layer, channel, presence_text(row->presence));
    }
    print_row("total", "", &c->total);
    if (c->passed)
        printf(c->total.differing ? "same within the tolerance\n" : "same\n");
    else if (c->total.over == 0)
        printf("different: layers or channels\n");
    else
        printf("different: %llu of %llu values over\n", (unsigned long long)c->total.over,
               (unsigned long long)c->total.values);
}

/* Scales the color layer so that its greatest finite value is 1; infinities stay above. */
static void scale_to_white(amb_image *image)
{
    float greatest = 0.0f;
    for (int pass = 0; pass < 2; pass++)
        for (int channel = 0; channel < image->channels; channel++)
            for (int y = 0; y < image->height; y++) {
                float *row = amb_image_row(image, channel, y);
                for (int x = 0; x < image->width; x++) {
                    if (pass == 1 && greatest > 0.0f)
                        row[x] /= greatest;
                    else if (isfinite(row[x]) && row[x] > greatest)
                        greatest = row[x];
                }
            }
}

static int write_difference(const request *r, const amb_frame *a, const amb_frame *b)
{
    amb_error error;
    amb_frame *frame = NULL;
    const char *layer = r->options.layer ? r->options.layer : "color";
    if (amb_compare_difference(a, b, r->options.layer, &frame, &error) != AMB_OK)
        return fail_file(&error);
    amb_status status;
    hold_signals();
    if (is_png(r->diff)) {
        amb_image picture = *amb_frame_layer(frame, layer);
        picture.channels = picture.channels == 4 ? 3 : picture.channels == 2 ? 1 : picture.channels; /* no alpha */
        scale_to_white(&picture);
        status = amb_write_png(&picture, r->diff, &error);
    } else {
        status = amb_write_exr(frame, r->diff, AMB_FLOAT, &error);
    }
    release_signals();
    amb_frame_close(&frame);
    return status == AMB_OK ? 0 : fail_file(&error);
}

static int run(int argc, char **argv)
{
    request r = {0};
    amb_frame *a = NULL, *b = NULL;
    amb_comparison *c = NULL;
    amb_error error;
    int code = read_request(argc, argv, &r);
    if (code || (code = read_frame(r.a, &a)) || (code = read_frame(r.b, &b)))
        goto done;
    if (amb_compare_frames(a, b, &r.options, &c, &error) != AMB_OK) {
        code = fail_library(&error);
        goto done;
    }
    if (r.json)
        code = report_json(&r, a, b, c);
    else if (!r.quiet)
        report_text(a, b, c);
    if (code == 0 && r.diff && !c->sizes_differ)
        code = write_difference(&r, a, b);
    if (code == 0 && !c->passed)
        code = EXIT_DIFFERENT;
done:
    free(c);
    amb_frame_close(&a);
    amb_frame_close(&b);
    return code;
}

const command command_compare = {"compare", "compares two pictures: bits, absolute difference, ULP, RMSE, PSNR", help,
                                 run};
