#include <ambiance/error.h>

#include <stdarg.h>
#include <stdio.h>

const char *amb_status_text(amb_status status)
{
    switch (status) {
    case AMB_OK:
        return "no error";
    case AMB_ERROR_ARGUMENT:
        return "bad argument";
    case AMB_ERROR_MEMORY:
        return "out of memory";
    case AMB_ERROR_IO:
        return "input/output failed";
    case AMB_ERROR_FORMAT:
        return "malformed or unsupported file";
    case AMB_ERROR_LIMIT:
        return "over a documented limit";
    case AMB_ERROR_ISA:
        return "instruction set not available";
    case AMB_ERROR_NOT_FOUND:
        return "no such name";
    case AMB_ERROR_INTERRUPTED:
        return "interrupted";
    }
    return "unknown status";
}

amb_status amb_fail(amb_error *error, amb_status status, const char *format, ...)
{
    if (!error)
        return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->detail, sizeof error->detail, format, arguments);
    va_end(arguments);
    for (char *c = error->detail; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f) /* a hostile file name must not break the one line */
            *c = '?';
    return status;
}
