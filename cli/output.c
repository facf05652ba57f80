#include "cli/cli.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

json_t *json_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

json_t *json_float(float value)
{
    char text[32];
    for (int digits = 1; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            break;
    }
    return json_number(strtod(text, NULL));
}

json_t *json_text(const char *text)
{
    json_t *string = json_string(text);
    char *copy = string ? NULL : strdup(text);
    if (!copy)
        return string;
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    string = json_string(copy);
    free(copy);
    return string;
}

int print_json(json_t *value)
{
    if (!value)
        return fail(EXIT_FILES, "JSON: out of memory");
    int written = json_dumpf(value, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
    json_decref(value);
    if (written == 0)
        putchar('\n');
    else if (!ferror(stdout))
        return fail(EXIT_FILES, "JSON: a text is not UTF-8");
    return 0; /* a failed write is found by finish_output */
}

int finish_output(int code)
{
    errno = 0;
    bool failed = ferror(stdout) != 0;
    if (fflush(stdout) != 0 || failed) {
        const char *why = errno ? strerror(errno) : "write failed";
        return code ? code : fail(EXIT_FILES, "standard output: %s", why);
    }
    return code;
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

progress progress_start(bool wanted)
{
    double time = now();
    return (progress){.is_shown = wanted && isatty(STDERR_FILENO), .started = time, .stage_started = time};
}

double progress_stage(progress *p, const char *format, ...)
{
    double time = now(), seconds = time - p->stage_started;
    p->stage_started = time;
    if (p->is_shown) {
        va_list arguments;
        va_start(arguments, format);
        fputs("\r\033[K", stderr);
        vfprintf(stderr, format, arguments);
        va_end(arguments);
        fflush(stderr);
    }
    return seconds;
}

double progress_end(progress *p)
{
    if (p->is_shown)
        fputs("\r\033[K", stderr);
    p->is_shown = false;
    return now() - p->started;
}

static const int held[] = {SIGINT, SIGTERM, SIGHUP};
enum { HELD_COUNT = sizeof held / sizeof *held };
static struct sigaction before[HELD_COUNT];
static volatile sig_atomic_t came;

static void note_signal(int signal) { came = signal; }

void hold_signals(void)
{
    struct sigaction wait = {.sa_handler = note_signal, .sa_flags = SA_RESTART};
    came = 0;
    for (int i = 0; i < HELD_COUNT; i++) {
        sigaction(held[i], NULL, &before[i]);
        if (before[i].sa_handler != SIG_IGN)
            sigaction(held[i], &wait, NULL);
    }
}

void release_signals(void)
{
    for (int i = 0; i < HELD_COUNT; i++)
        sigaction(held[i], &before[i], NULL);
    if (came)
        raise(came);
}
