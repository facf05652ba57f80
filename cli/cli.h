/* What the subcommands share: exit codes, one-line errors, option reading, JSON, files as frames.
 *
 * A function that returns int returns 0, or the exit code after having written its one line to standard error. */
#ifndef AMBIANCE_CLI_H
#define AMBIANCE_CLI_H

#include <ambiance/assets.h>
#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/param.h>

#include <getopt.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

enum { EXIT_OK = 0, EXIT_DIFFERENT = 1, EXIT_USAGE = 2, EXIT_FILES = 3 };

typedef struct command {
    const char *name, *about, *help;
    int (*run)(int argc, char **argv); /* argv[0] is the command's name; returns the exit code */
} command;

extern const command command_list, command_render, command_info, command_compare;

/* ---- errors (options.c) ------------------------------------------------------------------------------------------ */

/* "ambiance: " and the line, made one line whatever the values in it; returns `code`. */
int fail(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The library's line. Bad values and names are usage (2); everything else is 3. */
int fail_library(const amb_error *error);
/* The library's line about a file named on the command line: always 3. */
int fail_file(const amb_error *error);

/* ---- options (options.c) ----------------------------------------------------------------------------------------- */

/* The next option's letter or number; -1 at the end; '?' after an error line about a bad option (exit code 2). */
int next_option(int argc, char **argv, const char *letters, const struct option *options);

int read_number(const char *option, const char *text, double low, double high, double *out);
int read_integer(const char *option, const char *text, long long low, long long high, long long *out);
int read_size(const char *option, const char *text, int *width, int *height); /* WIDTHxHEIGHT */

/* Options of every command that computes. */
typedef struct setup {
    amb_context_options context;
    const char *assets; /* a folder, or "builtin"; NULL: the usual search */
    const char *pack;   /* a folder; NULL: the usual search */
} setup;

enum { OPTION_THREADS = 1000, OPTION_ISA, OPTION_ASSETS, OPTION_PACK };
#define SETUP_OPTIONS                                                                                   \
    {"threads", required_argument, NULL, OPTION_THREADS}, {"isa", required_argument, NULL, OPTION_ISA}, \
        {"assets", required_argument, NULL, OPTION_ASSETS},                                             \
    {                                                                                                   \
        "pack", required_argument, NULL, OPTION_PACK                                                    \
    }
#define SETUP_HELP                                                                                         \
    "  --threads N        worker threads, 0 (one per processor) to 1024; the pixels do not depend on it\n" \
    "  --isa NAME         instruction set: auto, v2 (SSE4), v3 (AVX2), v4 (AVX-512); nor on this\n"        \
    "  --assets DIR       your own asset folder; `builtin`: only what the program generates itself\n"      \
    "  --pack DIR         the downloaded asset pack\n"

int read_setup(setup *chosen, int option, const char *text);
/* Close both with amb_assets_close and amb_context_close, also after an error. */
int open_setup(const setup *chosen, amb_context **context, amb_assets **assets);

/* ---- output (output.c) ------------------------------------------------------------------------------------------- */

/* A number, or null when it is not finite. */
json_t *json_number(double value);
/* A float as the shortest decimal that reads back to it, or null. */
json_t *json_float(float value);
/* A text from outside (a file name) whose bytes may be anything: what is not UTF-8 becomes '?'. */
json_t *json_text(const char *text);
/* Prints, frees. */
int print_json(json_t *value);
/* Flushes standard output; an error there turns 0 into EXIT_FILES. */
int finish_output(int code);

/* One line of progress on standard error when it is a terminal and `wanted`: each stage overwrites the one before. */
typedef struct progress {
    bool is_shown;
    double started, stage_started; /* seconds, monotonic */
} progress;
progress progress_start(bool wanted);
/* Names the stage that begins; returns the seconds the one before took. */
double progress_stage(progress *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Clears the line; returns the seconds since progress_start. */
double progress_end(progress *p);

/* Between the two, SIGINT, SIGTERM and SIGHUP wait: an interrupted write would leave its temporary file behind. */
void hold_signals(void);
void release_signals(void); /* what came meanwhile now ends the program as it always would */

/* ---- files (files.c) --------------------------------------------------------------------------------------------- */

typedef enum file_kind { FILE_EXR, FILE_PNG, FILE_JPEG, FILE_HDR, FILE_KTX, FILE_MESH } file_kind;

/* Told from the first bytes, or from the name for models without a signature. */
int find_file_kind(const char *path, file_kind *kind);
const char *file_kind_name(file_kind kind);
/* An EXR with all its layers; a PNG, JPEG or HDR as a frame whose "color" layer has the file's channels. */
int read_frame(const char *path, amb_frame **out);
/* "R", "G", …: of channel `channel` of a layer of `channels`; "X", "Y" for one or two. */
const char *channel_name(int channels, int channel);

/* Can `path` be written: .exr or .png, in a folder that exists, not over a folder? Checked before hours of rendering,
 * not after. */
int check_output(const char *path);
bool is_png(const char *path);

#endif
