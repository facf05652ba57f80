/* Is a PNG, JPEG or Radiance file whole? stb_image decodes truncated files to grey or black without a word, and reads
 * no checksums; these walks read no pixels. */
#include "io/file.h"

#include <stdio.h>
#include <zlib.h>

static uint32_t big_endian(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

amb_status amb_check_png(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    for (size_t at = 8; bytes - at >= 12;) { /* length, type, data, CRC of type and data */
        uint32_t length = big_endian(data + at);
        const uint8_t *type = data + at + 4;
        if (length > bytes - at - 12)
            break;
        if (crc32(0, type, length + 4) != big_endian(type + 4 + length))
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: damaged PNG: checksum of the chunk at byte %zu is wrong",
                            name, at);
        if (memcmp(type, "IEND", 4) == 0)
            return AMB_OK;
        at += 12 + (size_t)length;
    }
    return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated PNG of %zu bytes", name, bytes);
}

/* What a JPEG has defined so far, by table number. */
typedef struct jpeg_tables {
    bool quantisation[4], huffman[2][4]; /* DC, AC */
    bool has_frame, is_progressive;
    int components;
    uint8_t id[4], table[4]; /* of the frame's components: name, quantisation table */
} jpeg_tables;

static bool read_quantisation(const uint8_t *at, size_t length, jpeg_tables *tables)
{
    while (length > 0) {
        size_t size = 1 + (at[0] >> 4 ? 128 : 64);
        if (at[0] >> 4 > 1 || (at[0] & 15) > 3 || size > length)
            return false;
        tables->quantisation[at[0] & 15] = true;
        at += size;
        length -= size;
    }
    return true;
}

/* The code lengths must leave room for each other (Kraft): stb_image trusts them. */
static bool read_huffman(const uint8_t *at, size_t length, jpeg_tables *tables)
{
    while (length > 0) {
        unsigned symbols = 0, used = 0;
        if (length < 17 || at[0] >> 4 > 1 || (at[0] & 15) > 3)
            return false;
        for (unsigned bits = 1; bits <= 16; bits++) {
            symbols += at[bits];
            used += (unsigned)at[bits] << (16 - bits);
        }
        if (symbols > 256 || used > 65536 || 17 + (size_t)symbols > length)
            return false;
        tables->huffman[at[0] >> 4][at[0] & 15] = true;
        at += 17 + symbols;
        length -= 17 + symbols;
    }
    return true;
}

static bool read_frame(const uint8_t *at, size_t length, jpeg_tables *tables)
{
    if (tables->has_frame || length < 6 || at[5] < 1 || at[5] > 4 || length != 6 + 3 * (size_t)at[5])
        return false;
    tables->has_frame = true;
    tables->components = at[5];
    for (int i = 0; i < tables->components; i++) {
        tables->id[i] = at[6 + 3 * i];
        tables->table[i] = at[8 + 3 * i];
        if (tables->table[i] > 3)
            return false;
    }
    return true;
}

/* A scan may only name components and tables that were defined: stb_image decodes with whatever memory held. */
static bool read_scan(const uint8_t *at, size_t length, const jpeg_tables *tables)
{
    if (!tables->has_frame || length < 1 || at[0] < 1 || at[0] > tables->components || length != 4 + 2 * (size_t)at[0])
        return false;
    const uint8_t *spectral = at + 1 + 2 * at[0]; /* first and last coefficient, bit position */
    bool needs_dc = !tables->is_progressive || (spectral[0] == 0 && spectral[2] >> 4 == 0);
    bool needs_ac = !tables->is_progressive || spectral[0] > 0;
    for (int i = 0; i < at[0]; i++) {
        uint8_t dc = at[2 + 2 * i] >> 4, ac = at[2 + 2 * i] & 15;
        int which = -1;
        for (int k = 0; k < tables->components; k++)
            if (tables->id[k] == at[1 + 2 * i])
                which = k;
        if (which < 0 || !tables->quantisation[tables->table[which]] || dc > 3 || ac > 3 ||
            (needs_dc && !tables->huffman[0][dc]) || (needs_ac && !tables->huffman[1][ac]))
            return false;
    }
    return true;
}

static bool read_segment(uint8_t marker, const uint8_t *at, size_t length, jpeg_tables *tables)
{
    switch (marker) {
    case 0xdb:
        return read_quantisation(at, length, tables);
    case 0xc4:
        return read_huffman(at, length, tables);
    case 0xda:
        return read_scan(at, length, tables);
    case 0xc2:
        tables->is_progressive = true;
        return read_frame(at, length, tables);
    case 0xc0:
    case 0xc1:
        return read_frame(at, length, tables);
    default:
        return true;
    }
}

amb_status amb_check_jpeg(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    jpeg_tables tables = {0};
    for (size_t at = 2; bytes - at >= 2;) {
        uint8_t marker = data[at + 1];
        bool is_data = marker == 0x00 || (marker >= 0xd0 && marker <= 0xd8) || marker == 0x01;
        if (data[at] != 0xff || marker == 0xff) { /* entropy-coded data after a scan header; fill bytes */
            at++;
        } else if (marker == 0xd9) {
            return AMB_OK;
        } else if (is_data) {
            at += 2;
        } else {
            size_t left = bytes - at - 2;
            size_t length = left < 2 ? SIZE_MAX : (size_t)(data[at + 2] << 8 | data[at + 3]);
            if (length > left)
                break;
            if (length < 2 || !read_segment(marker, data + at + 4, length - 2, &tables))
                return amb_fail(error, AMB_ERROR_FORMAT, "%s: damaged JPEG: segment 0x%02x at byte %zu", name, marker,
                                at);
            at += 2 + length;
        }
    }
    return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated JPEG of %zu bytes", name, bytes);
}

/* The byte after the header's blank line and size line; 0 when there is none. */
static size_t hdr_header(const uint8_t *data, size_t bytes, unsigned *width, unsigned *height)
{
    size_t at = 0;
    while (at < bytes) {
        const uint8_t *end = memchr(data + at, '\n', bytes - at);
        if (!end)
            return 0;
        bool is_blank = data + at == end;
        at = (size_t)(end - data) + 1;
        if (!is_blank)
            continue;
        char line[64];
        end = memchr(data + at, '\n', bytes - at);
        size_t length = end ? (size_t)(end - data) - at : sizeof line;
        if (length >= sizeof line)
            return 0;
        memcpy(line, data + at, length);
        line[length] = '\0';
        return sscanf(line, "-Y %9u +X %9u", height, width) == 2 ? at + length + 1 : 0;
    }
    return 0;
}

/* The byte after a scanline's four run-length coded planes; 0 when it runs out or a run leaves the line. */
static size_t hdr_scanline(const uint8_t *data, size_t bytes, size_t at, unsigned width)
{
    if (bytes - at < 4 || (unsigned)(data[at + 2] << 8 | data[at + 3]) != width)
        return 0;
    at += 4;
    for (unsigned done = 0; done < 4 * width;) {
        if (bytes - at < 2)
            return 0;
        unsigned count = data[at] > 128 ? data[at] - 128u : data[at];
        size_t size = data[at] > 128 ? 2 : 1 + (size_t)count;
        if (count == 0 || count > width - done % width || size > bytes - at)
            return 0;
        done += count;
        at += size;
    }
    return at;
}

amb_status amb_check_hdr(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    unsigned width, height;
    size_t at = hdr_header(data, bytes, &width, &height);
    if (at == 0 || width == 0 || height == 0)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated or unsupported Radiance header", name);
    if (width > AMB_MAX_IMAGE_SIZE || height > AMB_MAX_IMAGE_SIZE)
        return amb_fail(error, AMB_ERROR_LIMIT, "%s: Radiance image of %ux%u pixels; at most %d a side are allowed",
                        name, width, height, AMB_MAX_IMAGE_SIZE);
    bool is_coded =
        width >= 8 && width < 32768 && bytes - at >= 4 && data[at] == 2 && data[at + 1] == 2 && !(data[at + 2] & 0x80);
    if (!is_coded) {
        if ((uint64_t)width * height > (bytes - at) / 4)
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated Radiance image of %zu bytes", name, bytes);
        return AMB_OK;
    }
    for (unsigned y = 0; y < height; y++) {
        at = hdr_scanline(data, bytes, at, width);
        if (at == 0)
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated or damaged Radiance image: scanline %u of %u", name,
                            y, height);
    }
    return AMB_OK;
}
