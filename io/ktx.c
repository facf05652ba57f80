/* KTX 1 (Khronos, "KTX File Format Specification", version 1): uncompressed 2D textures and cube maps with levels. */
#include "io/file.h"

#include <stdlib.h>

#define KTX_HEADER_BYTES 64

typedef struct ktx_format {
    uint32_t gl_internal_format;
    amb_texel texel;
    uint32_t bytes; /* a texel */
} ktx_format;

typedef struct ktx_file {
    const uint8_t *data;
    size_t bytes, at;
    const char *name;
    const ktx_format *format;
    uint32_t size, height; /* of level 0 */
    uint32_t faces, levels;
    amb_error *error;
} ktx_file;

static const ktx_format ktx_formats[] = {
    {0x8c3a, AMB_TEXEL_R11G11B10F, 4}, /* GL_R11F_G11F_B10F */
    {0x881a, AMB_TEXEL_RGBA16F, 8},    /* GL_RGBA16F */
    {0x8814, AMB_TEXEL_RGBA32F, 16},   /* GL_RGBA32F */
    {0x822e, AMB_TEXEL_R32F, 4},       /* GL_R32F */
    {0x8058, AMB_TEXEL_RGBA8, 4},      /* GL_RGBA8 */
    {0x8c43, AMB_TEXEL_SRGB8_A8, 4},   /* GL_SRGB8_ALPHA8 */
};                                     /* texels of whole 32-bit words: rows need no padding */

static amb_status truncated(const ktx_file *file)
{
    return amb_fail(file->error, AMB_ERROR_FORMAT, "%s: truncated KTX of %zu bytes", file->name, file->bytes);
}

static uint32_t word_at(const ktx_file *file, size_t at)
{
    const uint8_t *p = file->data + at;
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static amb_status parse_header(ktx_file *file)
{
    if (file->bytes < KTX_HEADER_BYTES)
        return truncated(file);
    if (word_at(file, 12) != 0x04030201)
        return amb_fail(file->error, AMB_ERROR_FORMAT, "%s: big-endian KTX; only little-endian is read", file->name);
    uint32_t internal = word_at(file, 28), depth = word_at(file, 44), elements = word_at(file, 48);
    file->size = word_at(file, 36);
    file->height = word_at(file, 40);
    file->faces = word_at(file, 52);
    file->levels = word_at(file, 56) ? word_at(file, 56) : 1;
    bool is_known = false;
    for (size_t i = 0; i < sizeof ktx_formats / sizeof *ktx_formats && !is_known; i++) {
        file->format = &ktx_formats[i];
        is_known = file->format->gl_internal_format == internal;
    }
    if (!is_known)
        return amb_fail(file->error, AMB_ERROR_FORMAT,
                        "%s: KTX of GL format 0x%04x; allowed are R11F_G11F_B10F, RGBA16F, RGBA32F, R32F, RGBA8 and "
                        "SRGB8_ALPHA8",
                        file->name, internal);
    if (depth > 1 || elements != 0 || (file->faces != 1 && file->faces != 6) ||
        (file->faces == 6 && file->size != file->height))
        return amb_fail(file->error, AMB_ERROR_FORMAT, "%s: KTX that is neither a 2D texture nor a cube map",
                        file->name);
    if (file->size < 1 || file->height < 1)
        return amb_fail(file->error, AMB_ERROR_FORMAT, "%s: KTX of %ux%u texels", file->name, file->size, file->height);
    if (file->size > AMB_MAX_TEXTURE_SIZE || file->height > AMB_MAX_TEXTURE_SIZE)
        return amb_fail(file->error, AMB_ERROR_LIMIT, "%s: KTX of %ux%u texels; at most %d a side are allowed",
                        file->name, file->size, file->height, AMB_MAX_TEXTURE_SIZE);
    uint32_t largest = file->size > file->height ? file->size : file->height, full = 1;
    while (largest >> full)
        full++;
    if (file->levels > full || file->levels > AMB_MAX_TEXTURE_LEVELS)
        return amb_fail(file->error, AMB_ERROR_FORMAT, "%s: KTX of %u levels; %ux%u texels have at most %u", file->name,
                        file->levels, file->size, file->height, full);
    size_t extra = word_at(file, 60); /* key and value data */
    if (extra > file->bytes - KTX_HEADER_BYTES)
        return truncated(file);
    file->at = KTX_HEADER_BYTES + extra;
    return AMB_OK;
}

static size_t face_bytes(const ktx_file *file, uint32_t level)
{
    size_t width = file->size >> level, height = file->height >> level;
    return (width ? width : 1) * (height ? height : 1) * file->format->bytes;
}

/* Walks the levels; copies them tightly packed when `to` is not NULL, else only checks that all are there. */
static amb_status walk_levels(ktx_file *file, uint8_t *to, size_t *total)
{
    size_t at = file->at;
    *total = 0;
    for (uint32_t level = 0; level < file->levels; level++) {
        size_t bytes = face_bytes(file, level) * file->faces;
        if (file->bytes - at < 4 || bytes > file->bytes - at - 4)
            return truncated(file);
        uint32_t said = word_at(file, at);
        if (said != face_bytes(file, level) && said != bytes) /* cube maps state one face; some writers all six */
            return amb_fail(file->error, AMB_ERROR_FORMAT,
                            "%s: damaged KTX: level %u states %u bytes, its size asks %zu", file->name, level, said,
                            face_bytes(file, level));
        if (to)
            memcpy(to + *total, file->data + at + 4, bytes);
        *total += bytes;
        at += 4 + bytes;
    }
    return AMB_OK;
}

amb_status amb_read_ktx_memory(const void *data, size_t bytes, const char *name, amb_texture **out, amb_error *error)
{
    ktx_file file = {.data = data, .bytes = bytes, .name = name, .format = ktx_formats, .error = error};
    size_t total = 0;
    uint8_t *texels = NULL;
    *out = NULL;
    if (amb_file_kind_of(data, bytes) != AMB_FILE_KTX)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: not a KTX 1 file", name);
    amb_status status = parse_header(&file);
    if (status == AMB_OK)
        status = walk_levels(&file, NULL, &total);
    if (status == AMB_OK && (total == 0 || !(texels = malloc(total))))
        status = amb_fail(error, AMB_ERROR_MEMORY, "%s: out of memory for %zu bytes of texels", name, total);
    if (status == AMB_OK)
        status = walk_levels(&file, texels, &total);
    if (status == AMB_OK)
        status = amb_texture_create(&(amb_texture_desc){.kind = file.faces == 6 ? AMB_TEXTURE_CUBE : AMB_TEXTURE_2D,
                                                        .texel = file.format->texel,
                                                        .width = (int)file.size,
                                                        .height = (int)file.height,
                                                        .levels = (int)file.levels,
                                                        .make_mips = true,
                                                        .data = texels,
                                                        .data_bytes = total},
                                    out, error);
    free(texels);
    return status;
}
