/* Making textures: checks, layout, levels. Texel formats: texture_texels.c; mips and padding: texture_mips.c. */
#include "core/texture_layout.h"

#include <ambiance/half.h>
#include <stdlib.h>

/* ---- checks ----------------------------------------------------------------------------------------------------- */

static const char *kind_name(amb_texture_kind kind)
{
    static const char *const name[] = {"2D", "cube", "3D", "2D array"};
    return name[kind];
}

static amb_status check_size(const char *name, int size, amb_error *error)
{
    if (size < 1)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s is %d; it must be at least 1", name, size);
    if (size > AMB_MAX_TEXTURE_SIZE)
        return amb_fail(error, AMB_ERROR_LIMIT, "texture: %s is %d; at most %d are allowed", name, size,
                        AMB_MAX_TEXTURE_SIZE);
    return AMB_OK;
}

static int full_chain(const amb_texture_info *info)
{
    int size = info->width > info->height ? info->width : info->height, levels = 1;
    if (info->kind == AMB_TEXTURE_3D && info->depth > size)
        size = info->depth;
    while (size >>= 1)
        levels++;
    return levels;
}

/* Fills what a texture made from the description will look like; levels is what the description itself gives. */
static amb_status check_desc(const amb_texture_desc *d, amb_texture_info *info, amb_error *error)
{
    if ((int)d->kind < 0 || d->kind > AMB_TEXTURE_2D_ARRAY)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: kind %d is unknown; allowed are 2D, cube, 3D and 2D array",
                        (int)d->kind);
    if (!texel_bytes(d->texel))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: texel format %d is unknown; allowed are 0 to %d",
                        (int)d->texel, (int)AMB_TEXEL_LAST);
    *info = (amb_texture_info){d->kind, d->texel, d->width, d->height, 1, 0};
    if (d->kind == AMB_TEXTURE_3D || d->kind == AMB_TEXTURE_2D_ARRAY)
        info->depth = d->depth;
    amb_status status = check_size("width", info->width, error);
    if (!status)
        status = check_size("height", info->height, error);
    if (!status)
        status = check_size("depth", info->depth, error);
    if (status)
        return status;
    if (d->kind == AMB_TEXTURE_CUBE && d->width != d->height)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: cube faces are %d x %d; they must be square", d->width,
                        d->height);
    int most = full_chain(info);
    info->levels = d->levels ? d->levels : 1;
    if (info->levels < 1 || info->levels > most)
        return amb_fail(error, AMB_ERROR_ARGUMENT,
                        "texture: levels is %d; a %s texture of this size has 1 to %d (0 means 1)", d->levels,
                        kind_name(d->kind), most);
    if (!d->data && d->data_bytes == 0)
        return AMB_OK;
    if (!d->data)
        return amb_fail(error, AMB_ERROR_ARGUMENT,
                        "texture: data is NULL; it must point to %zu bytes of texels, or data_bytes be 0",
                        d->data_bytes);

    size_t bytes = 0; /* at most 2^15 cubed · 16 · 2: no overflow */
    for (int l = 0; l < info->levels; l++)
        bytes += (size_t)level_size(info->width, l) * (size_t)level_size(info->height, l) *
                 (size_t)level_slices(info, l) * texel_bytes(d->texel);
    if (bytes != d->data_bytes)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: data_bytes is %zu; this description needs exactly %zu",
                        d->data_bytes, bytes);
    return AMB_OK;
}

/* ---- layout ----------------------------------------------------------------------------------------------------- */

/* Texels from a row to the next, of rows of at least `texels`: an odd number of cache lines. Rows then begin lines, and
 * lines above one another fall into different sets of the caches, where a power of two would have them share a few. */
static size_t row_pitch(size_t texels, size_t words)
{
    const size_t line = TEXTURE_LINE_WORDS / words;
    return ((texels + line - 1) / line | 1) * line;
}

/* Places every level; LIMIT when lanes could not index the words with 32 bits. */
static amb_status lay_out(amb_texture *t, amb_error *error)
{
    size_t texels = 0, words = (size_t)storage_words(t->storage);
    for (int l = 0; l < t->info.levels; l++) {
        size_t width = (size_t)level_size(t->info.width, l), height = (size_t)level_size(t->info.height, l);
        size_t slices = (size_t)level_slices(&t->info, l) + 2 * (size_t)slice_border(&t->info);
        size_t pitch = row_pitch(width + 2, words), slice = pitch * (height + 2);
        if ((texels + slice * slices) * words >= INT32_MAX)
            return amb_fail(error, AMB_ERROR_LIMIT,
                            "texture: %d x %d x %d texels take more than 8 GiB; use a smaller size or format",
                            t->info.width, t->info.height, level_slices(&t->info, 0));
        t->base[l] = (int32_t)texels;
        t->pitch[l] = (int32_t)pitch;
        t->slice[l] = (int32_t)slice;
        t->width[l] = (float)width;
        t->height[l] = (float)height;
        t->depth[l] = (float)(t->info.kind == AMB_TEXTURE_3D ? level_size(t->info.depth, l) : 1);
        texels += slice * slices;
    }
    t->words = texels * words;
    return AMB_OK;
}

static void store_levels(amb_texture *t, const char *from, int given)
{
    uint16_t linear_of_code[256] = {0};
    if (t->info.texel == AMB_TEXEL_SRGB8_A8) {
        float linear[256], edges[256];
        srgb_tables(linear, edges);
        for (int c = 0; c < 256; c++)
            linear_of_code[c] = (uint16_t)f_to_half(linear[c]);
    }
    for (int l = 0; l < given; l++) {
        int width = level_size(t->info.width, l), height = level_size(t->info.height, l);
        for (int z = 0; z < level_slices(&t->info, l); z++)
            for (int y = 0; y < height; y++) {
                texels_store(t->info.texel, linear_of_code, from, width, texel_at(t, l, 0, y, z));
                from += (size_t)width * texel_bytes(t->info.texel);
            }
    }
}

/* Every level as if its data were all zero: absent channels still read 0, absent alpha 1. */
static void store_zeros(amb_texture *t)
{
    const unsigned char zero[16] = {0};
    const uint16_t linear_of_code[256] = {0};
    uint32_t words[4];
    texels_store(t->info.texel, linear_of_code, zero, 1, words);
    const size_t texel_words = (size_t)storage_words(t->storage);
    for (size_t i = 0; i < t->words; i += texel_words)
        memcpy(t->data + i, words, texel_words * sizeof *words);
}

amb_status amb_texture_create(const amb_texture_desc *desc, amb_texture **out, amb_error *error)
{
    if (out)
        *out = NULL;
    if (!desc || !out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s is NULL", desc ? "out" : "desc");
    amb_texture_info info = {0};
    amb_status status = check_desc(desc, &info, error);
    if (status)
        return status;
    amb_texture *t = calloc(1, sizeof *t);
    if (!t)
        return amb_fail(error, AMB_ERROR_MEMORY, "texture: no memory");

    int given = info.levels;
    t->info = info;
    t->storage = texel_storage(info.texel);
    if (desc->make_mips)
        t->info.levels = full_chain(&info);
    status = lay_out(t, error);
    if (status)
        goto error;
    size_t bytes = ((t->words + TEXTURE_SLACK_WORDS) * sizeof(uint32_t) + 63) / 64 * 64;
    t->data = aligned_alloc(64, bytes);
    if (!t->data) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "texture: no memory for %zu bytes of texels", bytes);
        goto error;
    }
    memset(t->data, 0, bytes); /* what pads rows, too: two equal textures are equal byte by byte */
    if (desc->data) {
        store_levels(t, desc->data, given);
        status = texture_make_mips(t, given, error);
        if (status)
            goto error;
        for (int l = 0; l < t->info.levels; l++)
            texture_pad(t, l);
    } else {
        store_zeros(t);
    }
    *out = t;
    return AMB_OK;
error:
    amb_texture_close(&t);
    return status;
}

void amb_texture_close(amb_texture **texture)
{
    if (!texture || !*texture)
        return;
    free((*texture)->data);
    free(*texture);
    *texture = NULL;
}

amb_texture_info amb_texture_describe(const amb_texture *texture) { return texture->info; }

amb_status amb_texture_make_mips(amb_texture *texture, amb_error *error)
{
    if (!texture)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: none is given to make the levels of");
    amb_status status = texture_make_mips(texture, 1, error);
    for (int l = 1; l < texture->info.levels && status == AMB_OK; l++)
        texture_pad(texture, l);
    return status;
}

/* ---- from images ------------------------------------------------------------------------------------------------ */

static amb_status check_image(const amb_image *image, const char *what, amb_error *error)
{
    if (!image || !image->data)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s is NULL; it must be an image", what);
    if (image->channels < 1 || image->channels > AMB_MAX_CHANNELS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s has %d channels; allowed are 1 to %d", what,
                        image->channels, AMB_MAX_CHANNELS);
    amb_status status = check_size("width", image->width, error);
    return status ? status : check_size("height", image->height, error);
}

/* Packs images one after the other; absent channels are 0, absent alpha 1. */
static void pack_images(amb_image *const *images, int count, amb_texel texel, v4 *row, unsigned char *to)
{
    float linear[256], edges[256];
    srgb_tables(linear, edges);
    for (int i = 0; i < count; i++) {
        const amb_image *image = images[i];
        for (int y = 0; y < image->height; y++) {
            const float *plane[4] = {NULL};
            for (int c = 0; c < image->channels; c++)
                plane[c] = amb_image_row(image, c, y);
            for (int x = 0; x < image->width; x++)
                row[x] = v4_of(plane[0][x], plane[1] ? plane[1][x] : 0.0f, plane[2] ? plane[2][x] : 0.0f,
                               plane[3] ? plane[3][x] : 1.0f);
            texels_pack(texel, edges, row, image->width, to);
            to += (size_t)image->width * texel_bytes(texel);
        }
    }
}

static amb_status create_from_images(amb_image *const *images, int count, amb_texture_kind kind, amb_texel texel,
                                     bool make_mips, amb_texture **out, amb_error *error)
{
    if (!texel_bytes(texel))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: texel format %d is unknown; allowed are 0 to %d",
                        (int)texel, (int)AMB_TEXEL_LAST);
    amb_status status = AMB_OK;
    int width = images[0]->width, height = images[0]->height;
    size_t bytes = (size_t)width * (size_t)height * (size_t)count * texel_bytes(texel);
    unsigned char *data = malloc(bytes);
    v4 *row = malloc((size_t)width * sizeof *row);
    if (!data || !row) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "texture: no memory for %zu bytes of texels", bytes);
        goto error;
    }
    pack_images(images, count, texel, row, data);
    amb_texture_desc desc = {.kind = kind,
                             .texel = texel,
                             .width = width,
                             .height = height,
                             .make_mips = make_mips,
                             .data = data,
                             .data_bytes = bytes};
    status = amb_texture_create(&desc, out, error);
error:
    free(data);
    free(row);
    return status;
}

amb_status amb_texture_from_image(const amb_image *image, amb_texel texel, bool make_mips, amb_texture **out,
                                  amb_error *error)
{
    if (!out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: out is NULL");
    *out = NULL;
    amb_status status = check_image(image, "image", error);
    if (status)
        return status;
    amb_image copy = *image; /* pixels are shared, only read */
    amb_image *const list[1] = {&copy};
    return create_from_images(list, 1, AMB_TEXTURE_2D, texel, make_mips, out, error);
}

amb_status amb_texture_cube_from_images(amb_image *const faces[6], amb_texel texel, bool make_mips, amb_texture **out,
                                        amb_error *error)
{
    static const char *const name[6] = {"face +x", "face -x", "face +y", "face -y", "face +z", "face -z"};
    if (!out || !faces)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s is NULL", out ? "faces" : "out");
    *out = NULL;
    for (int i = 0; i < 6; i++) {
        amb_status status = check_image(faces[i], name[i], error);
        if (status)
            return status;
        if (faces[i]->width != faces[0]->width || faces[i]->height != faces[0]->width)
            return amb_fail(error, AMB_ERROR_ARGUMENT,
                            "texture: %s is %d x %d; all faces must be %d x %d, as face +x is wide", name[i],
                            faces[i]->width, faces[i]->height, faces[0]->width, faces[0]->width);
    }
    return create_from_images(faces, 6, AMB_TEXTURE_CUBE, texel, make_mips, out, error);
}

/* ---- to images -------------------------------------------------------------------------------------------------- */

/* n/255 of the code n that a value is nearest to. */
static float nearest_unorm8(float value) { return f_floor(value * 255.0f + 0.5f) / 255.0f; }

static void unpack_row(const amb_texture *t, const float *linear, const float *edges, const uint32_t *from, v4 *row,
                       int width)
{
    texels_decode(t->storage, from, width, row);
    for (int x = 0; x < width; x++) {
        v4 c = row[x];
        if (t->info.texel == AMB_TEXEL_SRGB8_A8) /* storage is a little off the codes */
            row[x] = v4_of(linear[srgb_code(edges, c.x)], linear[srgb_code(edges, c.y)], linear[srgb_code(edges, c.z)],
                           nearest_unorm8(c.w));
        else if (t->storage == STORE_UNORM8)
            row[x] = v4_of(nearest_unorm8(c.x), nearest_unorm8(c.y), nearest_unorm8(c.z), nearest_unorm8(c.w));
    }
}

amb_status amb_texture_to_image(const amb_texture *t, int level, int slice, amb_image **out, amb_error *error)
{
    if (!t || !out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: %s is NULL", t ? "out" : "the texture to copy");
    *out = NULL;
    if (level < 0 || level >= t->info.levels)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: level is %d; this one has 0 to %d", level,
                        t->info.levels - 1);
    if (slice < 0 || slice >= level_slices(&t->info, level))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "texture: slice is %d; level %d of this one has 0 to %d", slice,
                        level, level_slices(&t->info, level) - 1);
    int width = level_size(t->info.width, level), height = level_size(t->info.height, level);
    v4 *row = malloc((size_t)width * sizeof *row);
    if (!row)
        return amb_fail(error, AMB_ERROR_MEMORY, "texture: no memory");
    amb_image *image = NULL;
    amb_status status = amb_image_create(width, height, texel_channels(t->info.texel), &image, error);
    float linear[256], edges[256];
    srgb_tables(linear, edges);
    for (int y = 0; image && y < height; y++) {
        unpack_row(t, linear, edges, texel_at(t, level, 0, y, slice), row, width);
        for (int c = 0; c < image->channels; c++)
            for (int x = 0; x < width; x++)
                amb_image_row(image, c, y)[x] = (&row[x].x)[c];
    }
    free(row);
    *out = image;
    return status;
}
