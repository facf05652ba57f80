#include "cli/cli.h"

#include "core/names.h"

#include <ambiance/image.h>

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int fail(int code, const char *format, ...)
{
    char line[1200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (char *c = line; *c; c++)
        if (iscntrl((unsigned char)*c))
            *c = '?';
    fflush(stdout);
    fprintf(stderr, "%sambiance: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", line); /* over a progress line */
    return code;
}

int fail_library(const amb_error *error)
{
    bool is_usage = error->status == AMB_ERROR_ARGUMENT || error->status == AMB_ERROR_ISA ||
                    error->status == AMB_ERROR_LIMIT || error->status == AMB_ERROR_NOT_FOUND;
    return fail(is_usage ? EXIT_USAGE : EXIT_FILES, "%s", error->detail);
}

int fail_file(const amb_error *error) { return fail(EXIT_FILES, "%s", error->detail); }

static const char *option_name(const void *user, int index) { return ((const struct option *)user)[index].name; }

/* getopt has just refused argv[optind - 1] (or a letter inside it). */
static void refuse(char **argv, const struct option *options, bool lacks_value)
{
    const char *text = argv[optind - 1];
    char name[80], hint[320];
    int count = 0;
    if (lacks_value) {
        fail(EXIT_USAGE, "%s: option without its value; see `ambiance %s --help`", text, argv[0]);
        return;
    }
    if (text[0] != '-' || text[1] != '-') {
        fail(EXIT_USAGE, "unknown option: -%c; see `ambiance %s --help`", optopt, argv[0]);
        return;
    }
    while (options[count].name)
        count++;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text + 2, "="), text + 2);
    for (int i = 0; i < count; i++)
        if (strcmp(options[i].name, name) == 0) {
            fail(EXIT_USAGE, "--%s: the option takes no value; see `ambiance %s --help`", name, argv[0]);
            return;
        }
    int nearest = amb_nearest_name(name, count, option_name, options);
    if (nearest >= 0)
        snprintf(hint, sizeof hint, "did you mean --%s?", options[nearest].name);
    else
        snprintf(hint, sizeof hint, "see `ambiance %s --help`", argv[0]);
    fail(EXIT_USAGE, "unknown option: --%s; %s", name, hint);
}

int next_option(int argc, char **argv, const char *letters, const struct option *options)
{
    opterr = 0;
    int option = getopt_long(argc, argv, letters, options, NULL);
    if (option == '?' || option == ':') {
        refuse(argv, options, option == ':');
        return '?';
    }
    return option;
}

int read_number(const char *option, const char *text, double low, double high, double *out)
{
    char *end;
    *out = strtod(text, &end);
    if (end == text || *end || !(*out >= low && *out <= high)) {
        char range[96] = "any finite number";
        if (isfinite(high) || low > (double)-FLT_MAX)
            snprintf(range, sizeof range, isfinite(high) ? "%.12g to %.12g" : "%.12g or more", low, high);
        return fail(EXIT_USAGE, "%s: %s; allowed: %s", option, text, range);
    }
    return 0;
}

int read_integer(const char *option, const char *text, long long low, long long high, long long *out)
{
    char *end;
    errno = 0;
    *out = strtoll(text, &end, 10);
    if (end == text || *end || errno || *out < low || *out > high)
        return fail(EXIT_USAGE, "%s: %s; allowed: whole numbers from %lld to %lld", option, text, low, high);
    return 0;
}

int read_size(const char *option, const char *text, int *width, int *height)
{
    char *end;
    errno = 0;
    long w = strtol(text, &end, 10), h = 0;
    bool is_good = isdigit((unsigned char)text[0]) && *end == 'x' && isdigit((unsigned char)end[1]);
    if (is_good) {
        h = strtol(end + 1, &end, 10);
        is_good = *end == '\0' && errno == 0 && w >= 1 && h >= 1 && w <= AMB_MAX_IMAGE_SIZE &&
                  h <= AMB_MAX_IMAGE_SIZE && w * h <= AMB_MAX_IMAGE_PIXELS;
    }
    if (!is_good)
        return fail(EXIT_USAGE, "%s: %s; allowed: WIDTHxHEIGHT, each 1 to %d, at most %d pixels", option, text,
                    AMB_MAX_IMAGE_SIZE, AMB_MAX_IMAGE_PIXELS);
    *width = (int)w;
    *height = (int)h;
    return 0;
}

int read_setup(setup *chosen, int option, const char *text)
{
    amb_error error;
    long long threads;
    int code = 0;
    switch (option) {
    case OPTION_THREADS:
        if ((code = read_integer("--threads", text, 0, 1024, &threads)) == 0)
            chosen->context.threads = (int)threads;
        return code;
    case OPTION_ISA:
        if (amb_isa_parse(text, &chosen->context.isa, &error) != AMB_OK)
            return fail(EXIT_USAGE, "--isa: %s; allowed: auto, v2, v3, v4", text);
        return 0;
    case OPTION_ASSETS:
        chosen->assets = text;
        return 0;
    case OPTION_PACK:
        chosen->pack = text;
        return 0;
    }
    return 0;
}

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* Where the pack lies relative to the program: in the build folder, or installed. */
static const char *find_pack(char *path, size_t size)
{
    static const char *const places[] = {"assets", "../assets", "../share/ambiance/pack"};
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0)
        return NULL;
    program[length] = '\0';
    char *slash = strrchr(program, '/');
    if (slash)
        *slash = '\0';
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        int used = snprintf(path, size, "%s/%s", program, places[i]);
        if (used > 0 && (size_t)used < size && is_folder(path))
            return path;
    }
    return NULL;
}

int open_setup(const setup *chosen, amb_context **context, amb_assets **assets)
{
    char found[PATH_MAX];
    amb_error error;
    amb_assets_options options = {.user_dir = chosen->assets, .pack_dir = chosen->pack, .keep_made = true};
    *context = NULL;
    *assets = NULL;
    if (chosen->assets && strcmp(chosen->assets, "builtin") == 0)
        options = (amb_assets_options){.builtin_only = true, .keep_made = true};
    if (options.user_dir && !is_folder(options.user_dir))
        return fail(EXIT_FILES, "--assets: %s; a folder, or `builtin`, is expected", options.user_dir);
    if (options.pack_dir && !is_folder(options.pack_dir))
        return fail(EXIT_FILES, "--pack: %s; a folder is expected", options.pack_dir);
    if (!options.builtin_only && !options.pack_dir && !getenv("AMBIANCE_PACK"))
        options.pack_dir = find_pack(found, sizeof found);

    if (amb_context_create(&chosen->context, context, &error) != AMB_OK)
        return fail_library(&error);
    if (amb_assets_create(*context, &options, assets, &error) != AMB_OK)
        return fail_file(&error);
    return 0;
}
