/* What a model file claims, checked before Assimp sees it: Assimp 5.2 reserves memory for counts unseen, loops for ever
 * on some PLY headers and leaks on OBJ faces that name missing vertices. */
#include "io/mesh_check.h"

#include "io/file.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct text { /* a cursor over lines and words of bytes that need not end in a zero */
    const uint8_t *at, *end;
} text;

typedef struct word {
    const uint8_t *at;
    size_t length; /* 0: there was none */
} word;

static bool is_blank(uint8_t c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/* Takes the next line off `from`; a backslash before the line's end joins the next one when `joins`. */
static text next_line(text *from, bool joins)
{
    text line = {from->at, from->at};
    while (line.end < from->end && (*line.end != '\n' || (joins && line.end > line.at && line.end[-1] == '\\')))
        line.end++;
    from->at = line.end < from->end ? line.end + 1 : line.end;
    return line;
}

static word next_word(text *line)
{
    while (line->at < line->end && (is_blank(*line->at) || *line->at == '\\' || *line->at == '\n'))
        line->at++;
    word w = {line->at, 0};
    while (line->at < line->end && !is_blank(*line->at) && *line->at != '\\' && *line->at != '\n') {
        line->at++;
        w.length++;
    }
    return w;
}

static bool word_is(word w, const char *what) { return strlen(what) == w.length && memcmp(w.at, what, w.length) == 0; }

static bool parse_integer(word *w, int64_t *value)
{
    bool is_negative = w->length && *w->at == '-';
    size_t i = w->length && (*w->at == '-' || *w->at == '+') ? 1 : 0, first = i;
    *value = 0;
    for (; i < w->length && isdigit(w->at[i]); i++) {
        *value = *value * 10 + (w->at[i] - '0');
        if (*value > UINT32_MAX)
            return false;
    }
    bool is_number = i > first;
    w->at += i;
    w->length -= i;
    *value = is_negative ? -*value : *value;
    return is_number;
}

static size_t skip_digits(word w, size_t i)
{
    while (i < w.length && isdigit(w.at[i]))
        i++;
    return i;
}

/* Decimal, with or without fraction and exponent; not nan or inf. */
static bool is_number(word w)
{
    size_t sign = w.length && (w.at[0] == '-' || w.at[0] == '+') ? 1 : 0;
    size_t i = skip_digits(w, sign), digits = i - sign;
    if (i < w.length && w.at[i] == '.') {
        size_t fraction = skip_digits(w, i + 1);
        digits += fraction - i - 1;
        i = fraction;
    }
    if (digits && i < w.length && (w.at[i] == 'e' || w.at[i] == 'E')) {
        i += i + 1 < w.length && (w.at[i + 1] == '-' || w.at[i + 1] == '+') ? 2 : 1;
        size_t end = skip_digits(w, i);
        digits = end - i;
        i = end;
    }
    return digits && i == w.length;
}

/* ---- PLY -------------------------------------------------------------------------------------------------------- */

#define PLY_MAX_ELEMENTS 16
#define PLY_MAX_PROPERTIES 128

typedef struct ply_property {
    uint8_t bytes, count_bytes; /* of a value; of a list's length, 0 for a single value */
    uint8_t least;              /* values a list must have: 3 for a face's vertices */
} ply_property;

enum { PLY_NO_FORMAT, PLY_ASCII, PLY_LITTLE, PLY_BIG };

typedef struct ply_header {
    int format;
    int elements, properties;
    struct {
        uint64_t count;
        int first, end; /* of its properties */
    } element[PLY_MAX_ELEMENTS];
    ply_property property[PLY_MAX_PROPERTIES];
} ply_header;

/* 0 for no type of PLY. */
static uint8_t ply_type_bytes(word w)
{
    static const struct {
        const char *name;
        uint8_t bytes;
    } types[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
                 {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
                 {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (word_is(w, types[i].name))
            return types[i].bytes;
    return 0;
}

static bool parse_format(text *line, ply_header *header)
{
    static const char *const names[] = {"", "ascii", "binary_little_endian", "binary_big_endian"};
    word format = next_word(line);
    for (int i = PLY_ASCII; i <= PLY_BIG; i++)
        if (word_is(format, names[i]))
            header->format = i;
    return header->format != PLY_NO_FORMAT && word_is(next_word(line), "1.0");
}

static bool parse_element(text *line, ply_header *header)
{
    word name = next_word(line), count = next_word(line);
    int64_t value;
    if (header->elements == PLY_MAX_ELEMENTS || !name.length || !parse_integer(&count, &value) || count.length ||
        value < 0)
        return false;
    header->element[header->elements].count = (uint64_t)value;
    header->element[header->elements].first = header->element[header->elements].end = header->properties;
    header->elements++;
    return true;
}

static bool parse_property(text *line, ply_header *header)
{
    if (header->elements == 0 || header->properties == PLY_MAX_PROPERTIES)
        return false;
    ply_property property = {0};
    word type = next_word(line);
    if (word_is(type, "list")) {
        property.count_bytes = ply_type_bytes(next_word(line));
        property.bytes = ply_type_bytes(next_word(line));
        if (property.count_bytes == 0 || property.count_bytes > 4)
            return false;
    } else {
        property.bytes = ply_type_bytes(type);
    }
    word name = next_word(line);
    if (property.bytes == 0 || !name.length)
        return false;
    property.least = word_is(name, "vertex_indices") || word_is(name, "vertex_index") ? 3 : 0;
    header->property[header->properties++] = property;
    header->element[header->elements - 1].end = header->properties;
    return true;
}

/* Leaves *file after the header. */
static amb_status parse_ply_header(text *file, ply_header *header, const char *name, amb_error *error)
{
    bool is_good = true;
    for (int number = 1; is_good; number++) {
        if (file->at == file->end)
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated PLY header", name);
        text line = next_line(file, false);
        word first = next_word(&line);
        if (word_is(first, "end_header") && header->format != PLY_NO_FORMAT)
            return AMB_OK;
        if (number == 1)
            is_good = word_is(first, "ply");
        else if (word_is(first, "format"))
            is_good = parse_format(&line, header);
        else if (word_is(first, "element"))
            is_good = parse_element(&line, header);
        else if (word_is(first, "property"))
            is_good = parse_property(&line, header);
        else
            is_good = word_is(first, "comment") || word_is(first, "obj_info");
        if (!is_good)
            amb_fail(error, AMB_ERROR_FORMAT, "%s: line %d of the PLY header is not understood", name, number);
    }
    return AMB_ERROR_FORMAT;
}

/* Bytes of the element's next instance of a binary body, or 0 when the body ends first. */
static size_t ply_instance_bytes(const ply_header *header, int element, const uint8_t *at, size_t left)
{
    size_t used = 0;
    for (int p = header->element[element].first; p < header->element[element].end; p++) {
        ply_property property = header->property[p];
        uint64_t count = property.count_bytes ? 0 : 1;
        if (property.count_bytes > left - used)
            return 0;
        for (int i = 0; i < property.count_bytes; i++)
            count |= (uint64_t)at[used + (size_t)i]
                     << 8 * (header->format == PLY_BIG ? property.count_bytes - 1 - i : i);
        used += property.count_bytes;
        if (count < property.least || count * property.bytes > left - used)
            return 0;
        used += count * property.bytes;
    }
    return used;
}

/* Does the next line of a text body hold one instance of the element, no less and no more? */
static bool ply_line_fits(const ply_header *header, int element, text *file)
{
    text line = next_line(file, false);
    for (int p = header->element[element].first; p < header->element[element].end; p++) {
        int64_t values = 1;
        word count = header->property[p].count_bytes ? next_word(&line) : (word){0};
        if (header->property[p].count_bytes &&
            (!parse_integer(&count, &values) || count.length || values < header->property[p].least))
            return false;
        for (int64_t i = 0; i < values; i++)
            if (!is_number(next_word(&line)))
                return false;
    }
    return !next_word(&line).length;
}

static amb_status check_ply(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    text file = {data, data + bytes};
    ply_header header = {0};
    amb_status status = parse_ply_header(&file, &header, name, error);
    for (int e = 0; e < header.elements && status == AMB_OK; e++) {
        uint64_t count = header.element[e].count, i = 0;
        if (count > 0 && header.element[e].end == header.element[e].first)
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: PLY element without properties", name);
        for (bool fits = true; i < count && fits; i += fits) {
            if (header.format == PLY_ASCII) {
                fits = ply_line_fits(&header, e, &file);
            } else {
                size_t used = ply_instance_bytes(&header, e, file.at, (size_t)(file.end - file.at));
                fits = used > 0;
                file.at += used;
            }
        }
        if (i < count)
            status = amb_fail(
                error, AMB_ERROR_FORMAT,
                "%s: truncated or damaged PLY: element %d, instance %llu of %llu; numbers must be complete and "
                "finite",
                name, e + 1, (unsigned long long)i + 1, (unsigned long long)count);
    }
    return status;
}

/* ---- OBJ -------------------------------------------------------------------------------------------------------- */

typedef struct obj_counts {
    int64_t count[3]; /* v, vt, vn */
} obj_counts;

static int obj_vertex_kind(word w) { return word_is(w, "v") ? 0 : word_is(w, "vt") ? 1 : word_is(w, "vn") ? 2 : -1; }

static obj_counts count_obj(text file)
{
    obj_counts counts = {{0}};
    while (file.at < file.end) {
        text line = next_line(&file, true);
        int kind = obj_vertex_kind(next_word(&line));
        if (kind >= 0)
            counts.count[kind]++;
    }
    return counts;
}

/* "7", "7/2", "7//3", "7/2/3"; negative ones count back from the last so far. */
static bool check_corner(word w, const obj_counts *all, const obj_counts *so_far)
{
    for (int kind = 0; kind < 3; kind++) {
        int64_t value;
        bool is_given = parse_integer(&w, &value);
        if (is_given ? value == 0 || value > all->count[kind] || value < -so_far->count[kind] : kind != 1)
            return false;
        if (!w.length)
            return true;
        if (*w.at != '/')
            return false;
        w.at++;
        w.length--;
    }
    return false;
}

static amb_status check_obj(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    text file = {data, data + bytes};
    obj_counts all = count_obj(file), so_far = {{0}};
    while (file.at < file.end) {
        const uint8_t *start = file.at;
        text line = next_line(&file, true);
        word first = next_word(&line);
        int kind = obj_vertex_kind(first), numbers = 0;
        bool is_good = true;
        if (kind >= 0) {
            for (word w = next_word(&line); w.length && w.at[0] != '#'; w = next_word(&line), numbers++)
                is_good &= is_number(w);
            is_good &= kind == 0   ? numbers == 3 || numbers == 4 || numbers == 6
                       : kind == 1 ? numbers == 2 || numbers == 3
                                   : numbers == 3;
            so_far.count[kind]++;
        } else if (word_is(first, "f") || word_is(first, "l") || word_is(first, "p")) {
            for (word w = next_word(&line); w.length && w.at[0] != '#' && is_good; w = next_word(&line), numbers++)
                is_good = check_corner(w, &all, &so_far);
            is_good &= numbers > 0;
        }
        if (!is_good)
            return amb_fail(
                error, AMB_ERROR_FORMAT,
                "%s: bad OBJ line '%.*s': its numbers must be complete and finite, its indices must name vertices",
                name, (int)(line.end - start < 40 ? line.end - start : 40), (const char *)start);
    }
    return AMB_OK;
}

/* ---- glTF ------------------------------------------------------------------------------------------------------- */

static uint32_t little_endian(const uint8_t *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* GLB: a header of magic, version 2 and length, then chunks of length, type and data. */
static amb_status check_glb(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    if (bytes < 20 || memcmp(data, "glTF", 4) != 0 || little_endian(data + 4) != 2)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: not a GLB file of version 2, or truncated", name);
    bool is_whole = little_endian(data + 8) <= bytes;
    for (size_t at = 12; is_whole && at < bytes;) {
        is_whole = bytes - at >= 8 && little_endian(data + at) <= bytes - at - 8;
        at += is_whole ? 8 + (size_t)little_endian(data + at) : 0;
    }
    return is_whole ? AMB_OK : amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated GLB of %zu bytes", name, bytes);
}

/* Every `"key": N` of the JSON, wherever it stands, must be a whole number of at most `limit`. */
static amb_status check_json_numbers(const uint8_t *data, size_t bytes, const char *key, uint64_t limit,
                                     const char *name, amb_error *error)
{
    const uint8_t *end = data + bytes, *at = data;
    while ((at = memmem(at, (size_t)(end - at), key, strlen(key)))) {
        at += strlen(key);
        while (at < end && (is_blank(*at) || *at == ':' || *at == '\n'))
            at++;
        word number = {at, (size_t)(end - at) < 20 ? (size_t)(end - at) : 20};
        int64_t value;
        if (!parse_integer(&number, &value) || value < 0 || (uint64_t)value > limit ||
            (number.length && strchr(".eE", number.at[0])))
            return amb_fail(error, AMB_ERROR_FORMAT, "%s: glTF %s must be a whole number, here from 0 to %llu", name,
                            key, (unsigned long long)limit);
    }
    return AMB_OK;
}

/* Does the JSON name a file beside it? Then counts may exceed this file's own size. */
static bool has_outside_data(const uint8_t *data, size_t bytes)
{
    const uint8_t *end = data + bytes, *at = data;
    while ((at = memmem(at, (size_t)(end - at), "\"uri\"", 5))) {
        at += 5;
        while (at < end && (is_blank(*at) || *at == ':' || *at == '\n' || *at == '"'))
            at++;
        if ((size_t)(end - at) < 5 || memcmp(at, "data:", 5) != 0)
            return true;
    }
    return false;
}

static amb_status check_gltf(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    static const char *const keys[] = {"\"count\"", "\"byteLength\"", "\"byteOffset\"", "\"byteStride\""};
    uint64_t limit = has_outside_data(data, bytes) ? AMB_MAX_MESH_VERTICES : bytes;
    amb_status status = AMB_OK;
    for (size_t i = 0; i < sizeof keys / sizeof *keys && status == AMB_OK; i++)
        status = check_json_numbers(data, bytes, keys[i], limit, name, error);
    return status;
}

amb_status amb_check_mesh_file(const uint8_t *data, size_t bytes, const char *extension, const char *name,
                               amb_error *error)
{
    if (bytes == 0)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: the file is empty", name);
    if (strcmp(extension, "ply") == 0)
        return check_ply(data, bytes, name, error);
    if (strcmp(extension, "obj") == 0)
        return check_obj(data, bytes, name, error);
    amb_status status = strcmp(extension, "glb") == 0 ? check_glb(data, bytes, name, error) : AMB_OK;
    return status == AMB_OK ? check_gltf(data, bytes, name, error) : status;
}
