/* ambiance-bench: runs the workloads, prints one table, says by how much goals are met or missed. */
#include "bench/bench.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { MAX_ROWS = 8, MAX_ROUNDS = 101, MAX_SECONDS = 12 };

typedef struct row {
    amb_isa isa; /* 0: the peer */
    int threads;
    amb_context *context;
    double seconds[MAX_ROUNDS];
    double median, best;
    bench_count count;
} row;

typedef struct report {
    const bench_workload *workload;
    int rows;
    row row[MAX_ROWS];
    double rmse; /* < 0: no peer */
    bench_facts facts;
    char failure[600];
} report;

typedef struct settings {
    bench_options options;
    int rounds;
    bool json, alone; /* alone: without the peer */
    amb_isa only;     /* AUTO: every one there is */
    int filters;
    char **filter;
} settings;

double bench_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void bench_fact(bench_facts *facts, const char *name, double value, const char *unit)
{
    if (facts->count == BENCH_MAX_FACTS)
        return;
    facts->fact[facts->count].name = name;
    facts->fact[facts->count].unit = unit;
    facts->fact[facts->count++].value = value;
}

double bench_rmse(const amb_image *image, const float *rgba)
{
    double sum = 0.0;
    int channels = image->channels < 3 ? image->channels : 3;
    for (int y = 0; y < image->height; y++)
        for (int c = 0; c < channels; c++) {
            const float *ours = amb_image_row(image, c, y);
            const float *peer = rgba + ((size_t)(image->height - 1 - y) * (size_t)image->width) * 4 + (size_t)c;
            for (int x = 0; x < image->width; x++) {
                double d = (double)ours[x] - (double)peer[(size_t)x * 4];
                sum += d * d;
            }
        }
    return sqrt(sum / ((double)image->width * image->height * channels));
}

/* ---- measuring -----------------------------------------------------------------------------------------------------
 */

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static amb_status add_rows(const settings *set, report *r, amb_error *error)
{
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    if (r->workload->run_peer && set->options.peer)
        r->row[r->rows++] = (row){.threads = set->options.threads};
    for (int t = 0; t < (set->options.threads > 1 ? 2 : 1); t++)
        for (size_t i = 0; i < sizeof isas / sizeof *isas; i++) {
            if (!amb_isa_available(isas[i]) || (set->only && set->only != isas[i]))
                continue;
            row *n = &r->row[r->rows++];
            *n = (row){.isa = isas[i], .threads = t ? set->options.threads : 1};
            amb_context_options options = {.isa = n->isa, .threads = n->threads};
            amb_status status = amb_context_create(&options, &n->context, error);
            if (status)
                return status;
        }
    return AMB_OK;
}

static amb_status run_once(const bench_workload *w, void *state, const row *r, double *seconds, amb_error *error)
{
    amb_status status = r->isa && w->prepare ? w->prepare(state, error) : AMB_OK;
    if (status)
        return status;
    double start = bench_seconds();
    status = r->isa ? w->run(state, r->context, error) : w->run_peer(state, error);
    *seconds = bench_seconds() - start;
    return status;
}

/* The second of two runs counts: a turn begins with the other's data in the caches and its own threads asleep. */
static amb_status run_row(const bench_workload *w, void *state, const row *r, double *seconds, amb_error *error)
{
    amb_status status = run_once(w, state, r, seconds, error);
    return status ? status : run_once(w, state, r, seconds, error);
}

/* All rows take turns, round by round; round -1 warms up. Slow workloads get fewer rounds, at least 3. */
static amb_status measure(const settings *set, report *r, void *state, amb_error *error)
{
    double start = bench_seconds();
    int rounds = 0;
    for (int round = -1; round < set->rounds; round++) {
        if (round >= 3 && bench_seconds() - start > MAX_SECONDS)
            break;
        rounds = round + 1;
        for (int i = 0; i < r->rows; i++) {
            double seconds;
            amb_status status = run_row(r->workload, state, &r->row[i], &seconds, error);
            if (status)
                return status;
            if (round >= 0)
                r->row[i].seconds[round] = seconds;
        }
    }
    for (int i = 0; i < r->rows; i++) {
        row *n = &r->row[i];
        qsort(n->seconds, (size_t)rounds, sizeof *n->seconds, by_value);
        n->best = n->seconds[0];
        n->median = 0.5 * (n->seconds[rounds / 2] + n->seconds[(rounds - 1) / 2]);
        if (n->isa && r->workload->count)
            n->count = r->workload->count(state, n->context);
    }
    if (r->row[0].isa == 0 && r->workload->difference)
        return r->workload->difference(state, &r->rmse, error);
    return AMB_OK;
}

static const row *widest(const report *r, int threads);

static amb_status tell_facts(const settings *set, report *r, void *state, amb_error *error)
{
    const row *best = widest(r, set->options.threads);
    return r->workload->facts && best ? r->workload->facts(state, best->context, &r->facts, error) : AMB_OK;
}

static void run_workload(const settings *set, report *r)
{
    amb_error error = {0};
    void *state = NULL;
    r->rmse = -1.0;
    amb_status status = r->workload->open(&set->options, &state, &error);
    if (!status)
        status = add_rows(set, r, &error);
    if (!status)
        status = measure(set, r, state, &error);
    if (!status)
        status = tell_facts(set, r, state, &error);
    if (status)
        snprintf(r->failure, sizeof r->failure, "%s: %s", amb_status_text(status), error.detail);
    r->workload->close(state);
    for (int i = 0; i < r->rows; i++)
        amb_context_close(&r->row[i].context);
}

/* ---- telling -------------------------------------------------------------------------------------------------------
 */

static const row *find(const report *r, amb_isa isa, int threads)
{
    for (int i = 0; i < r->rows; i++)
        if (r->row[i].isa == isa && r->row[i].threads == threads)
            return &r->row[i];
    return NULL;
}
static const row *widest(const report *r, int threads)
{
    const row *best = NULL;
    for (int i = 0; i < r->rows; i++)
        if (r->row[i].isa && r->row[i].threads == threads && (!best || r->row[i].isa > best->isa))
            best = &r->row[i];
    return best;
}

/* How much faster one row is than another. */
typedef struct ratio {
    char name[40];
    double median, best, goal; /* goal 0: none */
} ratio;
enum { MAX_RATIOS = 4 };

static int add_ratio(ratio *list, int count, const char *name, const row *slow, const row *fast, double goal)
{
    if (!slow || !fast)
        return count;
    ratio *r = &list[count];
    *r = (ratio){.median = slow->median / fast->median, .best = slow->best / fast->best, .goal = goal};
    snprintf(r->name, sizeof r->name, "%s", name);
    return count + 1;
}

static int make_ratios(const settings *set, const report *r, ratio *list)
{
    int all = set->options.threads, count = 0;
    const row *best = widest(r, all);
    count = add_ratio(list, count, "against llvmpipe", find(r, 0, all), best, r->workload->peer_goal);
    if (all > 1) {
        char name[40];
        snprintf(name, sizeof name, "1 to %d threads", all);
        count = add_ratio(list, count, name, widest(r, 1), best, r->workload->threads_goal);
    }
    const row *v2_row = find(r, AMB_ISA_V2, all), *v3_row = find(r, AMB_ISA_V3, all),
              *v4_row = find(r, AMB_ISA_V4, all);
    count = add_ratio(list, count, "v2 to v3", v2_row, v3_row, r->workload->wide_goal);
    return add_ratio(list, count, "v3 to v4", v3_row, v4_row, 0.0);
}

/* The row's rate against the peak of the same instruction set and threads; 0 when not counted. */
static double of_peak(const report *peaks, const row *n, bool bytes)
{
    const row *peak = find(&peaks[bytes ? 1 : 0], n->isa, n->threads);
    double have = bytes ? n->count.bytes : n->count.flops;
    if (!peak || have <= 0.0)
        return 0.0;
    return have / n->median / ((bytes ? peak->count.bytes : peak->count.flops) / peak->median);
}

static void name_row(const row *n, char *text, size_t size)
{
    snprintf(text, size, "%s, %d thread%s", n->isa ? amb_isa_name(n->isa) : "llvmpipe", n->threads,
             n->threads == 1 ? "" : "s");
}

static void print_report(const settings *set, const report *peaks, const report *r)
{
    printf("\n%s: %s\n", r->workload->name, r->workload->about);
    if (r->failure[0]) {
        printf("  failed: %s\n", r->failure);
        return;
    }
    printf("  %-22s %10s %10s %10s %8s %10s %8s  %s\n", "", "median ms", "best ms", "GFLOP/s", "of peak", "GB/s",
           "of peak", r->row[r->rows - 1].count.unit ? r->row[r->rows - 1].count.unit : "");
    for (int i = 0; i < r->rows; i++) {
        const row *n = &r->row[i];
        char name[64], column[5][24] = {"", "", "", "", ""};
        name_row(n, name, sizeof name);
        if (n->count.flops > 0.0) {
            snprintf(column[0], sizeof column[0], "%.1f", n->count.flops / n->median * 1e-9);
            snprintf(column[1], sizeof column[1], "%.0f%%", 100.0 * of_peak(peaks, n, false));
        }
        if (n->count.bytes > 0.0) {
            snprintf(column[2], sizeof column[2], "%.2f", n->count.bytes / n->median * 1e-9);
            snprintf(column[3], sizeof column[3], "%.0f%%", 100.0 * of_peak(peaks, n, true));
        }
        if (n->count.unit)
            snprintf(column[4], sizeof column[4], "%.1f", n->count.items / n->median);
        printf("  %-22s %10.2f %10.2f %10s %8s %10s %8s  %s\n", name, n->median * 1e3, n->best * 1e3, column[0],
               column[1], column[2], column[3], column[4]);
    }
    ratio list[MAX_RATIOS];
    int ratios = make_ratios(set, r, list);
    for (int i = 0; i < ratios; i++) {
        printf("  %-22s %9.2fx %9.2fx", list[i].name, list[i].median, list[i].best);
        if (list[i].goal > 0.0)
            printf("  goal %.1fx: %s", list[i].goal, list[i].median >= list[i].goal ? "met" : "missed");
        printf("\n");
    }
    if (r->rmse >= 0.0)
        printf("  the two pictures differ by %.2g RMSE\n", r->rmse);
    for (int i = 0; i < r->facts.count; i++)
        printf("%s%s %.*f%s",
               i == 0       ? "  "
               : i % 7 == 0 ? ",\n  "
                            : ", ",
               r->facts.fact[i].name, r->facts.fact[i].value < 100.0 && r->facts.fact[i].unit[0] ? 1 : 0,
               r->facts.fact[i].value, r->facts.fact[i].unit);
    if (r->facts.count > 0)
        printf("\n");
}

static void print_json(const settings *set, const report *reports, int count)
{
    printf("{\n  \"version\": \"%s\", \"width\": %d, \"height\": %d, \"rounds\": %d, \"peer\": \"%s\",\n  "
           "\"workloads\": [",
           amb_version(), set->options.width, set->options.height, set->rounds,
           set->options.peer ? gl_renderer(set->options.peer) : "");
    for (int i = 0, first = 1; i < count; i++) {
        const report *r = &reports[i];
        if (!r->workload)
            continue;
        printf("%s\n    {\"name\": \"%s\", \"failed\": %s, ", first ? "" : ",", r->workload->name,
               r->failure[0] ? "true" : "false");
        first = 0;
        if (r->rmse >= 0.0)
            printf("\"rmse\": %.6g, ", r->rmse);
        printf("\"rows\": [");
        for (int k = 0; k < r->rows && !r->failure[0]; k++) {
            const row *n = &r->row[k];
            printf("%s\n      {\"isa\": \"%s\", \"threads\": %d, \"median_s\": %.6g, \"best_s\": %.6g", k ? "," : "",
                   n->isa ? amb_isa_name(n->isa) : "llvmpipe", n->threads, n->median, n->best);
            if (n->count.flops > 0.0)
                printf(", \"flops\": %.6g, \"of_peak\": %.4f", n->count.flops / n->median, of_peak(reports, n, false));
            if (n->count.bytes > 0.0)
                printf(", \"bytes_per_s\": %.6g, \"of_copy\": %.4f", n->count.bytes / n->median,
                       of_peak(reports, n, true));
            if (n->count.unit)
                printf(", \"%s\": %.6g", n->count.unit, n->count.items / n->median);
            printf("}");
        }
        printf("]");
        ratio list[MAX_RATIOS];
        int ratios = r->failure[0] ? 0 : make_ratios(set, r, list);
        for (int k = 0; k < ratios; k++)
            printf("%s{\"name\": \"%s\", \"median\": %.4f, \"best\": %.4f, \"goal\": %.2f}",
                   k ? ", " : ", \"ratios\": [", list[k].name, list[k].median, list[k].best, list[k].goal);
        if (ratios)
            printf("]");
        for (int k = 0; k < r->facts.count; k++)
            printf("%s\"%s\": %.6g", k ? ", " : ", \"facts\": {", r->facts.fact[k].name, r->facts.fact[k].value);
        printf(r->facts.count ? "}}" : "}");
    }
    printf("\n  ]");
}

/* ---- the program ---------------------------------------------------------------------------------------------------
 */

static void usage(FILE *to)
{
    fprintf(to, "usage: ambiance-bench [--quick] [--json] [--rounds N] [--size WxH] [--threads N] [--isa NAME] "
                "[--ours] [workload ...]"
                "\n\nworkloads:\n");
    for (int i = 0; bench_workloads[i]; i++)
        fprintf(to, "  %-10s %s\n", bench_workloads[i]->name, bench_workloads[i]->about);
    fprintf(to, "  %-10s %s\n", "scenes", "a table of all scenes: ms a frame, shares of the stages");
}

static bool chosen(const settings *set, const char *name)
{
    for (int i = 0; i < set->filters; i++)
        if (strstr(name, set->filter[i]))
            return true;
    return set->filters == 0;
}

/* 0, or the exit code plus 1. */
static int read_options(int argc, char **argv, settings *set)
{
    static const struct option names[] = {{"quick", no_argument, 0, 'q'},
                                          {"json", no_argument, 0, 'j'},
                                          {"rounds", required_argument, 0, 'r'},
                                          {"size", required_argument, 0, 's'},
                                          {"threads", required_argument, 0, 't'},
                                          {"help", no_argument, 0, 'h'},
                                          {"isa", required_argument, 0, 'i'},
                                          {"ours", no_argument, 0, 'o'},
                                          {0, 0, 0, 0}};
    int rounds = 0, width = 0, height = 0;
    char rest;
    for (int c; (c = getopt_long(argc, argv, "h", names, NULL)) != -1;) {
        bool good = true;
        switch (c) {
        case 'q':
            set->options.quick = true;
            break;
        case 'j':
            set->json = true;
            break;
        case 'r':
            good = sscanf(optarg, "%d%c", &rounds, &rest) == 1 && rounds >= 1 && rounds <= MAX_ROUNDS;
            break;
        case 's':
            good = sscanf(optarg, "%dx%d%c", &width, &height, &rest) == 2 && width >= 16 && height >= 16 &&
                   width <= 8192 && height <= 8192;
            break;
        case 't':
            good = sscanf(optarg, "%d%c", &set->options.threads, &rest) == 1 && set->options.threads >= 1 &&
                   set->options.threads <= 1024;
            break;
        case 'i':
            good = amb_isa_parse(optarg, &set->only, NULL) == AMB_OK;
            break;
        case 'o':
            set->alone = true;
            break;
        case 'h':
            usage(stdout);
            return 1;
        default:
            usage(stderr);
            return 3;
        }
        if (!good) {
            fprintf(stderr, "ambiance-bench: bad value '%s' for --%s\n", optarg,
                    c == 'r'   ? "rounds (1 to 101)"
                    : c == 's' ? "size (16x16 to 8192x8192)"
                    : c == 'i' ? "isa (v2, v3, v4, auto)"
                               : "threads (1 to 1024)");
            return 3;
        }
    }
    set->rounds = rounds ? rounds : set->options.quick ? 3 : 9;
    set->options.width = width ? width : set->options.quick ? 720 : 1440;
    set->options.height = height ? height : set->options.quick ? 540 : 1080;
    set->filters = argc - optind;
    set->filter = argv + optind;
    for (int i = 0; i < set->filters; i++) {
        bool known = strstr("scenes", set->filter[i]) != NULL;
        for (int k = 0; bench_workloads[k]; k++)
            known |= strstr(bench_workloads[k]->name, set->filter[i]) != NULL;
        if (!known) {
            fprintf(stderr, "ambiance-bench: no workload is named like '%s'; see --help\n", set->filter[i]);
            return 3;
        }
    }
    return 0;
}

int main(int argc, char **argv)
{
    /* Threads that wait may spin a moment, as between the parallel parts of a frame, but not into the peer's turn:
     * LLVM's OpenMP would for 200 ms. It reads this before main. */
    if (!getenv("KMP_BLOCKTIME")) {
        setenv("KMP_BLOCKTIME", "1", 1);
        execv("/proc/self/exe", argv);
    }
    settings set = {.options.threads = (int)sysconf(_SC_NPROCESSORS_ONLN)};
    int stop = read_options(argc, argv, &set);
    if (stop)
        return stop - 1;

    amb_error error = {0};
    bool missing = set.alone || gl_open(set.options.threads, &set.options.peer, &error) != AMB_OK;
    if (missing && !set.alone)
        fprintf(stderr, "ambiance-bench: %s; measuring without it\n", error.detail);
    if (!set.json)
        printf("ambiance %s, %dx%d, %d threads, median of %d\npeer: %s\n", amb_version(), set.options.width,
               set.options.height, set.options.threads, set.rounds, missing ? "none" : gl_renderer(set.options.peer));

    static report reports[32];
    int count = 0, failed = 0;
    for (; bench_workloads[count] && count < 32; count++) {
        if (count >= 2 && !chosen(&set, bench_workloads[count]->name))
            continue;
        report *r = &reports[count];
        r->workload = bench_workloads[count];
        run_workload(&set, r);
        failed |= r->failure[0] != 0;
        if (!set.json)
            print_report(&set, reports, r);
        fflush(stdout);
    }
    bool scenes = chosen(&set, "scenes");
    if (set.json) {
        print_json(&set, reports, count);
        printf(scenes ? ",\n  \"scenes\": [" : "\n}\n");
    }
    if (scenes)
        failed |= bench_scenes(&set.options, set.options.quick ? 1 : 3, set.json);
    if (scenes && set.json)
        printf("\n  ]\n}\n");
    gl_close(&set.options.peer);
    return failed;
}
