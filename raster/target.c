/* A pass's target: checks, attachments, the layout of a tile's planes. */
#include "raster/internal.h"

#include <stdlib.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* ---- formats ---------------------------------------------------------------------------------------------------- */

static raster_format format_of(amb_texel texel)
{
    switch (texel) {
    case AMB_TEXEL_R16F:
    case AMB_TEXEL_RG16F:
    case AMB_TEXEL_RGBA16F:
        return RASTER_HALF;
    case AMB_TEXEL_R8:
    case AMB_TEXEL_RG8:
    case AMB_TEXEL_RGBA8:
        return RASTER_UNORM8;
    case AMB_TEXEL_SRGB8_A8:
        return RASTER_SRGB8;
    case AMB_TEXEL_R11G11B10F:
        return RASTER_SMALL_FLOAT;
    case AMB_TEXEL_R32F:
    case AMB_TEXEL_RG32F:
    case AMB_TEXEL_RGBA32F:
        break;
    }
    return RASTER_FLOAT;
}

static raster_srgb *make_srgb(void)
{
    raster_srgb *srgb = malloc(sizeof *srgb);
    if (!srgb)
        return NULL;
    srgb_tables(srgb->linear, srgb->edge);
    srgb->edge[255] = 2.0f;
    int32_t code = 0;
    for (int32_t i = 0; i < RASTER_SRGB_BUCKETS; i++) {
        float low = f_from_bits((RASTER_SRGB_FIRST + i) << 16);
        while (low >= srgb->edge[code])
            code++;
        srgb->start[i] = code;
    }
    return srgb;
}

/* ---- checks ----------------------------------------------------------------------------------------------------- */

/* Where an attachment's texture slice exists and fits. name: "colour", "depth" or "stencil"; number below 0: none. */
static amb_status check_texture(const raster_attachment *a, const char *name, int number, amb_error *error)
{
    const amb_texture_info *info = &a->texture->info;
    if (a->level < 0 || a->level >= info->levels)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s texture %d: level is %d; it has 0 to %d", name, number,
                        a->level, info->levels - 1);
    if (a->slice < 0 || a->slice >= level_slices(info, a->level))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s texture %d: slice is %d; its level %d has 0 to %d", name,
                        number, a->slice, a->level, level_slices(info, a->level) - 1);
    return AMB_OK;
}

static bool same_pixels(const raster_attachment *a, const raster_attachment *b)
{
    if (a->image || b->image)
        return a->image == b->image;
    return a->texture && a->texture == b->texture && a->level == b->level && a->slice == b->slice;
}

/* Completes an attachment of which the place, if any, is known: sizes must agree, no other may be at the same place. */
static amb_status check_attachment(amb_pass *pass, raster_attachment *a, const char *name, int number, amb_error *error)
{
    const amb_image *image = a->image;
    const amb_texture *texture = a->texture;
    const char *kind = image ? "image" : "texture";
    if (!image && !texture)
        return AMB_OK;
    if (image && !image->data)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s image %d has no pixels; data is NULL", name, number);
    if (image && (image->channels < 1 || image->channels > AMB_MAX_CHANNELS))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s image %d has %d channels; 1 to %d are allowed", name,
                        number, image->channels, AMB_MAX_CHANNELS);
    amb_status status = texture ? check_texture(a, name, number, error) : AMB_OK;
    if (status != AMB_OK)
        return status;
    int width = image ? image->width : level_size(texture->info.width, a->level);
    int height = image ? image->height : level_size(texture->info.height, a->level);
    if (width < 1 || height < 1 || width > AMB_MAX_IMAGE_SIZE || height > AMB_MAX_IMAGE_SIZE)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s %s %d is %d×%d; sizes of 1 to %d are allowed", name,
                        kind, number, width, height, AMB_MAX_IMAGE_SIZE);
    if (pass->width == 0)
        pass->width = width, pass->height = height;
    if (width != pass->width || height != pass->height)
        return amb_fail(error, AMB_ERROR_ARGUMENT,
                        "target: %s %s %d is %d×%d, the first attachment is %d×%d; all must agree", name, kind, number,
                        width, height, pass->width, pass->height);
    a->channels = image ? image->channels : texel_channels(texture->info.texel);
    a->format = texture ? format_of(texture->info.texel) : RASTER_FLOAT;
    if (image && a->channels != 1 && a->first < 1 + pass->stencil_plane)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: the %s image has %d channels; it must have 1", name,
                        a->channels);
    for (int k = 0; k < pass->target_count; k++)
        if (same_pixels(&pass->color[k], a))
            return amb_fail(error, AMB_ERROR_ARGUMENT, "target: colour %s %d is also %s %s %d", kind, k, name, kind,
                            number);
    return AMB_OK;
}

static amb_status check_color(amb_pass *pass, amb_error *error)
{
    const amb_target *t = &pass->target;
    for (; pass->target_count < AMB_MAX_TARGETS; pass->target_count++) {
        int i = pass->target_count;
        raster_attachment *a = &pass->color[i];
        *a = (raster_attachment){.image = t->color[i], .first = pass->planes};
        if (t->color_texture[i].texture) {
            a->texture = t->color_texture[i].texture;
            a->level = t->color_texture[i].level, a->slice = t->color_texture[i].slice;
        }
        if (!a->image && !a->texture)
            return AMB_OK;
        if (a->image && a->texture)
            return amb_fail(error, AMB_ERROR_ARGUMENT, "target: colour %d is both an image and a texture", i);
        amb_status status = check_attachment(pass, a, "colour", i, error);
        if (status != AMB_OK)
            return status;
        pass->planes += a->channels;
    }
    return AMB_OK;
}

static amb_status check_depth_stencil(amb_pass *pass, amb_error *error)
{
    const amb_target *t = &pass->target;
    raster_attachment *depth = &pass->depth, *stencil = &pass->stencil;
    *depth = (raster_attachment){.image = t->depth, .texture = t->depth_texture.texture};
    depth->level = t->depth_texture.level, depth->slice = t->depth_texture.slice;
    *stencil = (raster_attachment){.image = t->stencil, .first = 1};
    if (depth->image && depth->texture)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: depth is both an image and a texture");
    amb_status status = check_attachment(pass, depth, "depth", 0, error);
    if (status == AMB_OK)
        status = check_attachment(pass, stencil, "stencil", 0, error);
    if (status != AMB_OK)
        return status;
    if (depth->texture && depth->texture->info.texel != AMB_TEXEL_R32F)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: the depth texture's format is %d; it must be R32F",
                        (int)depth->texture->info.texel);
    if (depth->image && depth->image == stencil->image)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: the depth image is also the stencil image");
    return AMB_OK;
}

/* ---- clear values ----------------------------------------------------------------------------------------------- */

/* Rounds the clear value to the format, and encodes it. */
static void prepare_clear(const amb_pass *pass, raster_attachment *a, v4 clear)
{
    const float given[4] = {clear.x, clear.y, clear.z, clear.w}, absent[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    for (int c = 0; c < 4; c++)
        a->clear[c] = c < a->channels ? quantize(a->format, pass->srgb, c, given[c]) : absent[c];
    if (a->texture)
        encode_texel(a->texture->storage, a->clear, a->clear_words);
}

static amb_status prepare_attachments(amb_pass *pass, amb_error *error)
{
    const amb_target *t = &pass->target;
    for (int i = 0; i < pass->target_count && !pass->srgb; i++)
        if (pass->color[i].format == RASTER_SRGB8 && !(pass->srgb = make_srgb()))
            return amb_fail(error, AMB_ERROR_MEMORY, "pass: out of memory");
    for (int i = 0; i < pass->target_count; i++)
        prepare_clear(pass, &pass->color[i], t->clear_color[i]);
    prepare_clear(pass, &pass->depth, (v4){t->clear_depth, 0, 0, 0});
    prepare_clear(pass, &pass->stencil, (v4){(float)t->clear_stencil, 0, 0, 0});
    return AMB_OK;
}

amb_status raster_prepare_target(amb_pass *pass, amb_error *error)
{
    const amb_target *t = &pass->target;
    pass->stencil_plane = t->stencil ? 1 : 0;
    pass->planes = 1 + pass->stencil_plane;
    amb_status status = check_color(pass, error);
    if (status == AMB_OK)
        status = check_depth_stencil(pass, error);
    if (status != AMB_OK)
        return status;
    if (pass->width == 0)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: neither colour, depth nor stencil is given");
    if (t->samples != 0 && t->samples != 1 && t->samples != 2 && t->samples != 4 && t->samples != 8)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: samples is %d; 0, 1, 2, 4 and 8 are allowed", t->samples);
    pass->samples = t->samples > 1 ? t->samples : 1;
    pass->low_round = pass->samples > 1 ? 0 : RASTER_SUBPIXEL / 2 - 1;
    pass->high_round = pass->samples > 1 ? 0 : RASTER_SUBPIXEL / 2;
    return prepare_attachments(pass, error);
}

/* ---- untouched tiles, and the end ------------------------------------------------------------------------------- */

/* Fills count floats, past the caches where it can: nobody reads them soon. */
static void fill_floats(float *to, int count, float value)
{
    int i = 0;
#ifdef __SSE2__
    const __m128 four = _mm_set1_ps(value);
    for (; i < count && ((uintptr_t)(to + i) & 15u) != 0; i++)
        to[i] = value;
    for (; i + 4 <= count; i += 4)
        _mm_stream_ps(to + i, four);
#endif
    for (; i < count; i++)
        to[i] = value;
}

void raster_clear_pixels(const raster_attachment *a, int x0, int y0, int x1, int y1)
{
    for (int c = 0; a->image && c < a->channels; c++)
        for (int y = y0; y < y1; y++)
            fill_floats(amb_image_row(a->image, c, y) + x0, x1 - x0, a->clear[c]);
#ifdef __SSE2__
    _mm_sfence();
#endif
    for (int y = y0; a->texture && y < y1; y++) {
        const size_t words = (size_t)storage_words(a->texture->storage);
        uint32_t *to = texel_at(a->texture, a->level, x0, y, a->slice);
        for (int x = x0; x < x1; x++, to += words)
            memcpy(to, a->clear_words, words * sizeof *to);
    }
}

void raster_finish_textures(const amb_pass *pass)
{
    for (int i = 0; i < pass->target_count; i++)
        if (pass->color[i].texture)
            texture_pad(pass->color[i].texture, pass->color[i].level);
    if (pass->depth.texture)
        texture_pad(pass->depth.texture, pass->depth.level);
}
