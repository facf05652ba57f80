/* Files that appear whole or not at all: written under ".NAME.PID-N.ambiance-tmp" in the target's folder, synced,
 * renamed over the target. */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

struct amb_output {
    char *path;      /* the target, symbolic links followed */
    char *temporary; /* NULL: a device or pipe, written in place */
    int descriptor;
    uint64_t end; /* bytes written so far, counted from the start of the file */
};

static amb_status output_error(const amb_output *output, const char *what, amb_error *error)
{
    int code = errno;
    return amb_fail(error, AMB_ERROR_IO, "cannot %s '%s': %s", what, output->path, strerror(code));
}

/* Opens a new file of an unused name beside the target: no other writer, here or elsewhere, can hold the same one. */
static int open_temporary(amb_output *output)
{
    const char *slash = strrchr(output->path, '/');
    int folder = slash ? (int)(slash - output->path) + 1 : 0;
    size_t size = strlen(output->path) + 64;
    output->temporary = malloc(size);
    if (!output->temporary)
        return -1;
    for (int attempt = 0; attempt < 10000; attempt++) {
        /* At most 200 bytes of the name: a file name may have 255. */
        snprintf(output->temporary, size, "%.*s.%.200s.%ld-%d.ambiance-tmp", folder, output->path,
                 output->path + folder, (long)getpid(), attempt);
        int descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST)
            return descriptor;
    }
    return -1;
}

static amb_status open_output(amb_output *output, amb_error *error)
{
    struct stat target;
    bool exists = stat(output->path, &target) == 0;
    if (exists && S_ISDIR(target.st_mode))
        return amb_fail(error, AMB_ERROR_IO, "cannot write '%s': it is a folder", output->path);
    if (exists && access(output->path, W_OK) != 0)
        return output_error(output, "write", error);
    if (exists && !S_ISREG(target.st_mode)) {
        output->descriptor = open(output->path, O_WRONLY | O_CLOEXEC);
        return output->descriptor >= 0 ? AMB_OK : output_error(output, "write", error);
    }
    output->descriptor = open_temporary(output);
    if (output->descriptor < 0) {
        amb_status status = output_error(output, "create a file for", error);
        free(output->temporary); /* not ours to remove */
        output->temporary = NULL;
        return status;
    }
    if (exists && fchmod(output->descriptor, target.st_mode & 07777) != 0)
        return output_error(output, "keep the permissions of", error);
    return AMB_OK;
}

amb_status amb_output_begin(const char *path, amb_output **out, amb_error *error)
{
    *out = NULL;
    if (!path || !*path)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "output name: it is empty");
    amb_output *output = calloc(1, sizeof *output);
    if (!output)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for writing '%s'", path);
    output->descriptor = -1;
    output->path = realpath(path, NULL); /* through links, so that the link stays and its target is replaced */
    if (!output->path)
        output->path = strdup(path);
    amb_status status = AMB_OK;
    if (output->path)
        status = open_output(output, error);
    else
        status = amb_fail(error, AMB_ERROR_MEMORY, "out of memory for writing '%s'", path);
    if (status != AMB_OK)
        amb_output_abort(&output);
    *out = output;
    return status;
}

amb_status amb_output_write_at(amb_output *output, const void *data, size_t bytes, uint64_t offset, amb_error *error)
{
    const uint8_t *from = data;
    if (offset > INT64_MAX || bytes > INT64_MAX - offset)
        return amb_fail(error, AMB_ERROR_LIMIT, "cannot write '%s': file too large", output->path);
    while (bytes > 0) {
        size_t some = bytes < SSIZE_MAX ? bytes : SSIZE_MAX;
        /* A pipe has no offsets, but takes bytes in order. */
        ssize_t count = output->temporary || offset != output->end
                            ? pwrite(output->descriptor, from, some, (off_t)offset)
                            : write(output->descriptor, from, some);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0) {
            if (count == 0)
                errno = ENOSPC;
            return output_error(output, "write", error);
        }
        from += count;
        bytes -= (size_t)count;
        offset += (uint64_t)count;
        output->end = offset > output->end ? offset : output->end;
    }
    return AMB_OK;
}

amb_status amb_output_write(amb_output *output, const void *data, size_t bytes, amb_error *error)
{
    return amb_output_write_at(output, data, bytes, output->end, error);
}

/* The rename itself must reach the disk too. A file system that cannot sync folders is not an error. */
static void sync_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = !slash ? strdup(".") : strndup(path, slash == path ? 1 : (size_t)(slash - path));
    int descriptor = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        close(descriptor);
    }
    free(folder);
}

amb_status amb_output_commit(amb_output **output, amb_error *error)
{
    amb_output *o = *output;
    amb_status status = AMB_OK;
    if (o->temporary && fsync(o->descriptor) != 0)
        status = output_error(o, "finish writing", error);
    int closed = close(o->descriptor);
    o->descriptor = -1;
    if (status == AMB_OK && closed != 0)
        status = output_error(o, "finish writing", error);
    if (status == AMB_OK && o->temporary) {
        if (rename(o->temporary, o->path) != 0) {
            status = output_error(o, "rename the finished file to", error);
        } else {
            free(o->temporary);
            o->temporary = NULL;
            sync_folder(o->path);
        }
    }
    amb_output_abort(output);
    return status;
}

void amb_output_abort(amb_output **output)
{
    if (!output || !*output)
        return;
    amb_output *o = *output;
    if (o->descriptor >= 0)
        close(o->descriptor);
    if (o->temporary)
        unlink(o->temporary);
    free(o->temporary);
    free(o->path);
    free(o);
    *output = NULL;
}
