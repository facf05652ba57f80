/* PNG, JPEG and Radiance through stb_image, to images and textures; the texture reader for all formats. */
#include "io/file.h"

#include <stb_image.h>

#include <stdlib.h>

/* Nothing decodes to more bytes than this times the file's: DEFLATE tops at 1032, a JPEG of empty blocks below. */
#define IMAGE_MAX_RATIO 1100

typedef struct decoded {
    int width, height, channels;
    uint8_t *bytes;   /* one of the three */
    uint16_t *shorts; /* 16-bit PNG */
    float *floats;    /* Radiance, linear */
} decoded;

static void free_decoded(decoded *image)
{
    stbi_image_free(image->bytes);
    stbi_image_free(image->shorts);
    stbi_image_free(image->floats);
}

static amb_status check_whole(const uint8_t *data, size_t bytes, const char *name, amb_error *error)
{
    switch (amb_file_kind_of(data, bytes)) {
    case AMB_FILE_PNG:
        return amb_check_png(data, bytes, name, error);
    case AMB_FILE_JPEG:
        return amb_check_jpeg(data, bytes, name, error);
    case AMB_FILE_HDR:
        return amb_check_hdr(data, bytes, name, error);
    default:
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: not a PNG, JPEG or Radiance HDR file", name);
    }
}

/* Sizes are known and allowed before stb_image takes memory for pixels. */
static amb_status check_size(const uint8_t *data, size_t bytes, const char *name, decoded *image, amb_error *error)
{
    if (bytes > INT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "%s: %zu bytes; an image file may have at most %d", name, bytes,
                        INT32_MAX);
    if (!stbi_info_from_memory(data, (int)bytes, &image->width, &image->height, &image->channels))
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: damaged or unsupported image: %s", name, stbi_failure_reason());
    int64_t pixels = (int64_t)image->width * image->height;
    if (image->width < 1 || image->height < 1)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: image of %dx%d pixels", name, image->width, image->height);
    if (image->width > AMB_MAX_IMAGE_SIZE || image->height > AMB_MAX_IMAGE_SIZE || pixels > AMB_MAX_IMAGE_PIXELS)
        return amb_fail(error, AMB_ERROR_LIMIT,
                        "%s: image of %dx%d pixels; at most %d a side and %d in all are allowed", name, image->width,
                        image->height, AMB_MAX_IMAGE_SIZE, AMB_MAX_IMAGE_PIXELS);
    if ((uint64_t)pixels / IMAGE_MAX_RATIO > bytes)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: truncated image: %zu bytes cannot hold %dx%d pixels", name, bytes,
                        image->width, image->height);
    return AMB_OK;
}

/* channels: 1…4 to convert to, 0 for the file's own. */
static amb_status decode(const uint8_t *data, size_t bytes, const char *name, int channels, bool keep_16_bits,
                         decoded *image, amb_error *error)
{
    *image = (decoded){0};
    amb_status status = check_whole(data, bytes, name, error);
    if (status == AMB_OK)
        status = check_size(data, bytes, name, image, error);
    if (status != AMB_OK)
        return status;
    int width, height, own;
    amb_file_kind kind = amb_file_kind_of(data, bytes);
    if (kind == AMB_FILE_HDR)
        image->floats = stbi_loadf_from_memory(data, (int)bytes, &width, &height, &own, channels);
    else if (kind == AMB_FILE_PNG && keep_16_bits && stbi_is_16_bit_from_memory(data, (int)bytes))
        image->shorts = stbi_load_16_from_memory(data, (int)bytes, &width, &height, &own, channels);
    else
        image->bytes = stbi_load_from_memory(data, (int)bytes, &width, &height, &own, channels);
    if (!image->bytes && !image->shorts && !image->floats)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: damaged or unsupported image: %s", name, stbi_failure_reason());
    image->width = width;
    image->height = height;
    image->channels = channels ? channels : own;
    return AMB_OK;
}

static amb_status to_planar(const decoded *from, amb_image **out, amb_error *error)
{
    amb_status status = amb_image_create(from->width, from->height, from->channels, out, error);
    if (status != AMB_OK)
        return status;
    for (int c = 0; c < from->channels; c++)
        for (int y = 0; y < from->height; y++) {
            float *row = amb_image_row(*out, c, y);
            size_t at = (size_t)y * (size_t)from->width * (size_t)from->channels + (size_t)c;
            for (int x = 0; x < from->width; x++, at += (size_t)from->channels)
                row[x] = from->floats   ? from->floats[at]
                         : from->shorts ? (float)from->shorts[at] / 65535.0f
                                        : (float)from->bytes[at] / 255.0f;
        }
    return AMB_OK;
}

amb_status amb_read_image_memory(const void *data, size_t bytes, const char *name, amb_image **out, bool *is_linear,
                                 amb_error *error)
{
    decoded image;
    *out = NULL;
    amb_status status = decode(data, bytes, name, 0, true, &image, error);
    if (status == AMB_OK)
        status = to_planar(&image, out, error);
    if (status == AMB_OK && is_linear)
        *is_linear = image.floats != NULL;
    free_decoded(&image);
    return status;
}

amb_status amb_read_image(const char *path, amb_image **out, bool *is_linear, amb_error *error)
{
    uint8_t *data;
    size_t bytes;
    *out = NULL;
    amb_status status = amb_read_file(path, &data, &bytes, error);
    if (status == AMB_OK)
        status = amb_read_image_memory(data, bytes, path, out, is_linear, error);
    free(data);
    return status;
}

/* Linear radiance to a half-float texture. Halves end at 65504: brighter suns are cut there, NaN becomes black, so that
 * no infinity reaches a filter. */
static amb_status linear_to_texture(amb_image *image, amb_texture **out, amb_error *error)
{
    for (int c = 0; c < image->channels; c++)
        for (int y = 0; y < image->height; y++) {
            float *row = amb_image_row(image, c, y);
            for (int x = 0; x < image->width; x++) {
                float value = row[x] < 65504.0f ? row[x] : 65504.0f;
                row[x] = row[x] != row[x] ? 0.0f : value > -65504.0f ? value : -65504.0f;
            }
        }
    return amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, out, error);
}

static amb_status bytes_to_texture(const decoded *image, bool srgb, amb_texture **out, amb_error *error)
{
    static const amb_texel texels[] = {AMB_TEXEL_R8, AMB_TEXEL_RG8, AMB_TEXEL_RGBA8, AMB_TEXEL_RGBA8};
    return amb_texture_create(
        &(amb_texture_desc){.kind = AMB_TEXTURE_2D,
                            .texel = srgb ? AMB_TEXEL_SRGB8_A8 : texels[image->channels - 1],
                            .width = image->width,
                            .height = image->height,
                            .make_mips = true,
                            .data = image->bytes,
                            .data_bytes = (size_t)image->width * (size_t)image->height * (size_t)image->channels},
        out, error);
}

/* One or two channels stay as they are unless they are colour; 16 bits become floats. */
static amb_status image_to_texture(const uint8_t *data, size_t bytes, const char *name, bool srgb, amb_texture **out,
                                   amb_error *error)
{
    decoded image = {0};
    amb_image *planar = NULL;
    amb_status status = check_whole(data, bytes, name, error);
    if (status == AMB_OK)
        status = check_size(data, bytes, name, &image, error);
    bool is_color = srgb || image.channels > 2 || amb_file_kind_of(data, bytes) == AMB_FILE_HDR;
    if (status == AMB_OK)
        status = decode(data, bytes, name, is_color ? 4 : image.channels, !srgb, &image, error);
    if (status == AMB_OK && image.bytes)
        status = bytes_to_texture(&image, srgb, out, error);
    else if (status == AMB_OK && (status = to_planar(&image, &planar, error)) == AMB_OK)
        status = image.floats ? linear_to_texture(planar, out, error)
                              : amb_texture_from_image(planar, image.channels > 1 ? AMB_TEXEL_RGBA32F : AMB_TEXEL_R32F,
                                                       true, out, error);
    amb_image_close(&planar);
    free_decoded(&image);
    return status;
}

static amb_status exr_to_texture(const uint8_t *data, size_t bytes, const char *name, amb_texture **out,
                                 amb_error *error)
{
    amb_frame *frame;
    amb_status status = amb_read_exr_memory(data, bytes, name, &frame, error);
    if (status == AMB_OK)
        status = linear_to_texture(amb_frame_layer(frame, "color"), out, error);
    amb_frame_close(&frame);
    return status;
}

amb_status amb_read_texture_memory(const void *data, size_t bytes, const char *name, bool srgb, amb_texture **out,
                                   amb_error *error)
{
    *out = NULL;
    switch (amb_file_kind_of(data, bytes)) {
    case AMB_FILE_PNG:
    case AMB_FILE_JPEG:
    case AMB_FILE_HDR:
        return image_to_texture(data, bytes, name, srgb, out, error);
    case AMB_FILE_EXR:
        return exr_to_texture(data, bytes, name, out, error);
    case AMB_FILE_KTX:
        return amb_read_ktx_memory(data, bytes, name, out, error);
    case AMB_FILE_UNKNOWN:
        break;
    }
    return amb_fail(error, AMB_ERROR_FORMAT, "%s: not a PNG, JPEG, Radiance HDR, OpenEXR or KTX file", name);
}

amb_status amb_read_texture(const char *path, bool srgb, amb_texture **out, amb_error *error)
{
    uint8_t *data;
    size_t bytes;
    *out = NULL;
    amb_status status = amb_read_file(path, &data, &bytes, error);
    if (status == AMB_OK)
        status = amb_read_texture_memory(data, bytes, path, srgb, out, error);
    free(data);
    return status;
}
