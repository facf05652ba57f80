/* Mip chains and padding.
 *
 * A level is the area average of the one above, in linear light: 2 texels a dimension, or 3 with the exact coverage
 * weights where the size is odd (so that nothing shifts; Guthe & Heckbert, "Non-power-of-two mipmapping", 2005).
 * The chain is computed in float; only what is stored is rounded. */
#include "core/texture_layout.h"

#include <stdlib.h>

/* ---- box filter ------------------------------------------------------------------------------------------------- */

typedef struct {
    int first, count;
    float weight[3];
} box_taps;

/* The source texels that destination texel i of n/2 (at least 1) covers. */
static box_taps box_at(int i, int n)
{
    if (n == 1)
        return (box_taps){0, 1, {1.0f, 0.0f, 0.0f}};
    if (n % 2 == 0)
        return (box_taps){2 * i, 2, {0.5f, 0.5f, 0.0f}};
    int half = n / 2;
    float size = (float)n;
    return (box_taps){2 * i, 3, {(float)(half - i) / size, (float)half / size, (float)(i + 1) / size}};
}

/* A level as colours: floats when the chain has them, decoded from storage row by row otherwise. */
typedef struct {
    const amb_texture *texture;
    int level, width, height, slices;
    const v4 *colors; /* NULL: decode */
    v4 *scratch;      /* one row */
} level_source;

static const v4 *source_row(const level_source *s, int y, int z)
{
    if (s->colors)
        return s->colors + ((size_t)z * (size_t)s->height + (size_t)y) * (size_t)s->width;
    texels_decode(s->texture->storage, texel_at(s->texture, s->level, 0, y, z), s->width, s->scratch);
    return s->scratch;
}

/* row[i] += weight · box of the source row */
static void add_row(const v4 *source, int source_width, float weight, v4 *row, int width)
{
    for (int x = 0; x < width; x++) {
        box_taps b = box_at(x, source_width);
        v4 sum = v4_scale(source[b.first], b.weight[0]);
        for (int i = 1; i < b.count; i++)
            sum = v4_add(sum, v4_scale(source[b.first + i], b.weight[i]));
        row[x] = v4_add(row[x], v4_scale(sum, weight));
    }
}

/* Slices of a 3D level are averaged too; faces of a cube are not. */
static void reduce_level(const level_source *s, bool across_slices, int width, int height, int slices, v4 *to)
{
    for (int z = 0; z < slices; z++)
        for (int y = 0; y < height; y++) {
            v4 *row = to + ((size_t)z * (size_t)height + (size_t)y) * (size_t)width;
            memset(row, 0, (size_t)width * sizeof *row);
            box_taps by = box_at(y, s->height), bz = across_slices ? box_at(z, s->slices) : (box_taps){z, 1, {1, 0, 0}};
            for (int k = 0; k < bz.count; k++)
                for (int j = 0; j < by.count; j++)
                    add_row(source_row(s, by.first + j, bz.first + k), s->width, bz.weight[k] * by.weight[j], row,
                            width);
        }
}

amb_status texture_make_mips(amb_texture *t, int first, amb_error *error)
{
    if (first >= t->info.levels)
        return AMB_OK;
    amb_status status = AMB_OK;
    size_t top = (size_t)level_size(t->info.width, first) * (size_t)level_size(t->info.height, first) *
                 (size_t)level_slices(&t->info, first);
    v4 *buffer[2] = {malloc(top * sizeof(v4)), malloc(top * sizeof(v4))};
    v4 *scratch = malloc((size_t)t->info.width * sizeof *scratch);
    if (!buffer[0] || !buffer[1] || !scratch) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "texture: no memory for the mip levels of %d x %d texels",
                          t->info.width, t->info.height);
        goto error;
    }
    for (int level = first; level < t->info.levels; level++) {
        int above = level - 1;
        level_source source = {t,
                               above,
                               level_size(t->info.width, above),
                               level_size(t->info.height, above),
                               level_slices(&t->info, above),
                               level > first ? buffer[above & 1] : NULL,
                               scratch};
        int width = level_size(t->info.width, level), height = level_size(t->info.height, level);
        int slices = level_slices(&t->info, level);
        v4 *colors = buffer[level & 1];
        reduce_level(&source, t->info.kind == AMB_TEXTURE_3D, width, height, slices, colors);
        for (int z = 0; z < slices; z++)
            for (int y = 0; y < height; y++)
                texels_encode(t->storage, colors + ((size_t)z * (size_t)height + (size_t)y) * (size_t)width, width,
                              texel_at(t, level, 0, y, z));
    }
error:
    free(buffer[0]);
    free(buffer[1]);
    free(scratch);
    return status;
}

/* ---- padding ---------------------------------------------------------------------------------------------------- */

static void copy_texel(const amb_texture *t, uint32_t *to, const uint32_t *from)
{
    memcpy(to, from, (size_t)storage_words(t->storage) * sizeof *to);
}

/* Every side's border is the opposite side. */
static void pad_repeat(amb_texture *t, int level)
{
    int width = level_size(t->info.width, level), height = level_size(t->info.height, level);
    int slices = level_slices(&t->info, level);
    size_t row_bytes = (size_t)t->pitch[level] * (size_t)storage_words(t->storage) * sizeof(uint32_t);
    for (int z = 0; z < slices; z++) {
        for (int y = 0; y < height; y++) {
            copy_texel(t, texel_at(t, level, -1, y, z), texel_at(t, level, width - 1, y, z));
            copy_texel(t, texel_at(t, level, width, y, z), texel_at(t, level, 0, y, z));
        }
        memcpy(texel_at(t, level, -1, -1, z), texel_at(t, level, -1, height - 1, z), row_bytes);
        memcpy(texel_at(t, level, -1, height, z), texel_at(t, level, -1, 0, z), row_bytes);
    }
    if (t->info.kind != AMB_TEXTURE_3D)
        return;
    size_t slice_bytes = row_bytes * (size_t)(height + 2);
    memcpy(texel_at(t, level, -1, -1, -1), texel_at(t, level, -1, -1, slices - 1), slice_bytes);
    memcpy(texel_at(t, level, -1, -1, slices), texel_at(t, level, -1, -1, 0), slice_bytes);
}

/* Face axes in D3D order: where s (right), t (down) and the face's own axis point. */
static const int face_axis[6][3][3] = {
    {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
};

/* The texel of another face next to border texel (x, y) of `face`, one step over exactly one edge. In units of half
 * texels from the cube's centre, texel centres are the odd offsets 2x + 1 - n and the face lies at n: a step over the
 * edge lands at n sideways and n - 1 up. */
static const uint32_t *neighbour_texel(const amb_texture *t, int level, int face, int x, int y)
{
    int n = level_size(t->info.width, level), s = 2 * x + 1 - n, v = 2 * y + 1 - n;
    const int up = n - 1;
    if (x < 0 || x >= n)
        s = x < 0 ? -n : n;
    else
        v = y < 0 ? -n : n;
    int point[3];
    for (int k = 0; k < 3; k++)
        point[k] = s * face_axis[face][0][k] + v * face_axis[face][1][k] + up * face_axis[face][2][k];
    for (int other = 0; other < 6; other++) {
        const int(*axis)[3] = face_axis[other];
        int along[3];
        for (int a = 0; a < 3; a++)
            along[a] = point[0] * axis[a][0] + point[1] * axis[a][1] + point[2] * axis[a][2];
        if (along[2] == n)
            return texel_at(t, level, (along[0] + n - 1) / 2, (along[1] + n - 1) / 2, other);
    }
    return texel_at(t, level, 0, 0, face);
}

/* Corner (x, y) of the border, ±1 beyond the face both ways: the average of the three texels that meet there. */
static void pad_corner(amb_texture *t, int level, int face, int x, int y)
{
    int n = level_size(t->info.width, level), inner_x = x < 0 ? 0 : n - 1, inner_y = y < 0 ? 0 : n - 1;
    v4 color[3];
    texels_decode(t->storage, texel_at(t, level, inner_x, inner_y, face), 1, &color[0]);
    texels_decode(t->storage, neighbour_texel(t, level, face, x, inner_y), 1, &color[1]);
    texels_decode(t->storage, neighbour_texel(t, level, face, inner_x, y), 1, &color[2]);
    v4 average = v4_scale(v4_add(v4_add(color[0], color[1]), color[2]), 1.0f / 3.0f);
    texels_encode(t->storage, &average, 1, texel_at(t, level, x, y, face));
}

/* The border texels along one edge of a face, n from (x, y) in direction (dx, dy): their neighbours lie in a row too.
 */
static void pad_edge(amb_texture *t, int level, int face, int x, int y, int dx, int dy)
{
    int n = level_size(t->info.width, level);
    uint32_t *to = texel_at(t, level, x, y, face);
    const uint32_t *from = neighbour_texel(t, level, face, x, y);
    copy_texel(t, to, from);
    if (n < 2)
        return;
    ptrdiff_t step_to = texel_at(t, level, x + dx, y + dy, face) - to;
    ptrdiff_t step_from = neighbour_texel(t, level, face, x + dx, y + dy) - from;
    for (int i = 1; i < n; i++)
        copy_texel(t, to + i * step_to, from + i * step_from);
}

static void pad_cube(amb_texture *t, int level)
{
    int n = level_size(t->info.width, level);
    for (int face = 0; face < 6; face++) {
        pad_edge(t, level, face, -1, 0, 0, 1);
        pad_edge(t, level, face, n, 0, 0, 1);
        pad_edge(t, level, face, 0, -1, 1, 0);
        pad_edge(t, level, face, 0, n, 1, 0);
        pad_corner(t, level, face, -1, -1);
        pad_corner(t, level, face, n, -1);
        pad_corner(t, level, face, -1, n);
        pad_corner(t, level, face, n, n);
    }
}

void texture_pad(amb_texture *t, int level)
{
    if (t->info.kind == AMB_TEXTURE_CUBE)
        pad_cube(t, level);
    else
        pad_repeat(t, level);
}
