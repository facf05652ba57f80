#include "cli/cli.h"

#include <ambiance/io.h>

#include <errno.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct signature {
    file_kind kind;
    const char *name;
    const char *bytes; /* at the start of the file; NULL: told by the extension only */
    size_t length;
    const char *extension; /* NULL: told by the bytes only */
} signature;

static const signature signatures[] = {
    {FILE_EXR, "OpenEXR", "\x76\x2f\x31\x01", 4, NULL},
    {FILE_PNG, "PNG", "\x89PNG\r\n\x1a\n", 8, NULL},
    {FILE_JPEG, "JPEG", "\xff\xd8\xff", 3, NULL},
    {FILE_HDR, "Radiance HDR", "#?RADIANCE", 10, NULL},
    {FILE_HDR, "Radiance HDR", "#?RGBE", 6, NULL},
    {FILE_KTX, "KTX", "\xabKTX 11\xbb\r\n\x1a\n", 12, NULL},
    {FILE_MESH, "mesh", "ply\n", 4, NULL},
    {FILE_MESH, "mesh", "ply\r", 4, NULL},
    {FILE_MESH, "mesh", "glTF", 4, NULL},
    {FILE_MESH, "mesh", NULL, 0, ".obj"},
    {FILE_MESH, "mesh", NULL, 0, ".gltf"},
};

static bool has_extension(const char *path, const char *extension)
{
    size_t length = strlen(path), tail = strlen(extension);
    return length > tail && strcasecmp(path + length - tail, extension) == 0;
}

int find_file_kind(const char *path, file_kind *kind)
{
    char head[16] = {0};
    errno = 0;
    FILE *file = fopen(path, "rb");
    if (!file)
        return fail(EXIT_FILES, "%s: %s", path, strerror(errno));
    size_t length = fread(head, 1, sizeof head, file);
    bool failed = ferror(file) != 0;
    int why = errno;
    fclose(file);
    if (failed)
        return fail(EXIT_FILES, "%s: %s", path, strerror(why));
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++) {
        const signature *s = &signatures[i];
        bool is_this = s->bytes ? length >= s->length && memcmp(head, s->bytes, s->length) == 0
                                : has_extension(path, s->extension);
        if (is_this) {
            *kind = s->kind;
            return 0;
        }
    }
    return fail(EXIT_FILES, "%s: unknown kind of file; known: EXR, PNG, JPEG, HDR, KTX, OBJ, PLY, glTF", path);
}

const char *file_kind_name(file_kind kind)
{
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++)
        if (signatures[i].kind == kind)
            return signatures[i].name;
    return "file";
}

static int read_plain_image(const char *path, amb_frame **out)
{
    amb_error error;
    amb_image *image = NULL;
    amb_frame *frame = NULL;
    bool is_linear;
    if (amb_read_image(path, &image, &is_linear, &error) != AMB_OK)
        return fail_file(&error);
    if (amb_frame_create(image->width, image->height, &frame, &error) != AMB_OK) {
        amb_image_close(&image);
        return fail_file(&error);
    }
    amb_image_close(&frame->layer[0].image);
    frame->layer[0].image = image;
    *out = frame;
    return 0;
}

int read_frame(const char *path, amb_frame **out)
{
    file_kind kind;
    amb_error error;
    *out = NULL;
    int code = find_file_kind(path, &kind);
    if (code)
        return code;
    if (kind == FILE_KTX || kind == FILE_MESH)
        return fail(EXIT_FILES, "%s: a %s file; a picture (EXR, PNG, JPEG, HDR) is expected", path,
                    file_kind_name(kind));
    if (kind != FILE_EXR)
        return read_plain_image(path, out);
    return amb_read_exr(path, out, &error) == AMB_OK ? 0 : fail_file(&error);
}

const char *channel_name(int channels, int channel)
{
    static const char *const colors[] = {"R", "G", "B", "A"}, *const axes[] = {"X", "Y"};
    return channels <= 2 ? axes[channel & 1] : colors[channel & 3];
}

bool is_png(const char *path) { return has_extension(path, ".png"); }

int check_output(const char *path)
{
    struct stat info;
    if (!is_png(path) && !has_extension(path, ".exr"))
        return fail(EXIT_USAGE, "output: %s; allowed: names that end in .exr or .png", path);
    if (stat(path, &info) == 0) {
        if (S_ISDIR(info.st_mode))
            return fail(EXIT_FILES, "output: %s; it is a folder, a file is expected", path);
        if (access(path, W_OK) != 0)
            return fail(EXIT_FILES, "output: %s; %s", path, strerror(errno));
    }
    char *copy = strdup(path);
    if (!copy)
        return fail(EXIT_FILES, "out of memory");
    const char *folder = dirname(copy);
    int code = 0;
    if (stat(folder, &info) != 0)
        code = fail(EXIT_FILES, "output: %s; its folder: %s", path, strerror(errno));
    else if (!S_ISDIR(info.st_mode))
        code = fail(EXIT_FILES, "output: %s; %s is not a folder", path, folder);
    else if (access(folder, W_OK) != 0)
        code = fail(EXIT_FILES, "output: %s; its folder: %s", path, strerror(errno));
    free(copy);
    return code;
}
