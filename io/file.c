#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static amb_status read_error(const char *path, amb_error *error)
{
    int code = errno;
    return amb_fail(error, AMB_ERROR_IO, "cannot read '%s': %s", path, strerror(code));
}

static amb_status read_all(int descriptor, const char *path, uint8_t *data, size_t bytes, amb_error *error)
{
    size_t done = 0;
    while (done < bytes) {
        ssize_t count = read(descriptor, data + done, bytes - done);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return read_error(path, error);
        if (count == 0)
            return amb_fail(error, AMB_ERROR_IO, "cannot read '%s': it shrank while it was read", path);
        done += (size_t)count;
    }
    return AMB_OK;
}

amb_status amb_read_file(const char *path, uint8_t **data, size_t *bytes, amb_error *error)
{
    *data = NULL;
    *bytes = 0;
    if (!path || !*path)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "input name: it is empty");
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe without a writer must not hang */
    if (descriptor < 0)
        return read_error(path, error);

    amb_status status = AMB_OK;
    uint8_t *buffer = NULL;
    struct stat file;
    if (fstat(descriptor, &file) != 0)
        status = read_error(path, error);
    else if (!S_ISREG(file.st_mode))
        status = amb_fail(error, AMB_ERROR_IO, "cannot read '%s': it is %s", path,
                          S_ISDIR(file.st_mode) ? "a folder" : "not a regular file");
    else if ((uint64_t)file.st_size > AMB_MAX_FILE_BYTES)
        status = amb_fail(error, AMB_ERROR_LIMIT, "cannot read '%s': %lld bytes; at most %zu are allowed", path,
                          (long long)file.st_size, AMB_MAX_FILE_BYTES);
    else if (!(buffer = malloc((size_t)file.st_size + 1)))
        status = amb_fail(error, AMB_ERROR_MEMORY, "cannot read '%s': out of memory for its %lld bytes", path,
                          (long long)file.st_size);
    else
        status = read_all(descriptor, path, buffer, (size_t)file.st_size, error);
    close(descriptor);
    if (status != AMB_OK || !buffer) {
        free(buffer);
        return status;
    }
    buffer[file.st_size] = 0;
    *data = buffer;
    *bytes = (size_t)file.st_size;
    return AMB_OK;
}

amb_file_kind amb_file_kind_of(const uint8_t *data, size_t bytes)
{
    static const struct {
        amb_file_kind kind;
        size_t length;
        const char *magic;
    } kinds[] = {
        {AMB_FILE_PNG, 8, "\x89PNG\r\n\x1a\n"}, {AMB_FILE_JPEG, 3, "\xff\xd8\xff"},
        {AMB_FILE_HDR, 11, "#?RADIANCE\n"},     {AMB_FILE_HDR, 7, "#?RGBE\n"},
        {AMB_FILE_EXR, 4, "\x76\x2f\x31\x01"},  {AMB_FILE_KTX, 12, "\xabKTX 11\xbb\r\n\x1a\n"},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (bytes >= kinds[i].length && memcmp(data, kinds[i].magic, kinds[i].length) == 0)
            return kinds[i].kind;
    return AMB_FILE_UNKNOWN;
}
