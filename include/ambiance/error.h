/* Errors: every function that can fail returns an amb_status and, when given one, fills an amb_error with one line a
 * person can act on: what, which value, what is allowed. The library never prints and never exits. */
#ifndef AMBIANCE_ERROR_H
#define AMBIANCE_ERROR_H

typedef enum amb_status {
    AMB_OK = 0,
    AMB_ERROR_ARGUMENT = -1,    /* a value outside what the function's comment allows */
    AMB_ERROR_MEMORY = -2,      /* allocation failed */
    AMB_ERROR_IO = -3,          /* a file could not be opened, read, written, synced or renamed */
    AMB_ERROR_FORMAT = -4,      /* a file's content is truncated, malformed or of an unsupported kind */
    AMB_ERROR_LIMIT = -5,       /* well-formed, but larger than a documented limit */
    AMB_ERROR_ISA = -6,         /* this processor or build lacks the instruction set asked for */
    AMB_ERROR_NOT_FOUND = -7,   /* no scene, parameter, layer, pass or asset of that name */
    AMB_ERROR_INTERRUPTED = -8, /* the caller's progress callback asked to stop */
} amb_status;

typedef struct amb_error {
    amb_status status;
    char detail[512]; /* one line, no newline at the end */
} amb_error;

/* The code's fixed text; never NULL. */
const char *amb_status_text(amb_status status);

/* Fills *error (when not NULL) with the status and the formatted line; control characters become '?'. Returns status.
 */
amb_status amb_fail(amb_error *error, amb_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
