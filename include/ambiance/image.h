/* Images: planar 32-bit float. Pixel (x, y) of channel c is data[(c·height + y)·stride + x], row 0 on top.
 * Colour is linear Rec.709 scene radiance unless a function says otherwise. */
#ifndef AMBIANCE_IMAGE_H
#define AMBIANCE_IMAGE_H

#include <ambiance/error.h>
#include <stddef.h>

#define AMB_MAX_IMAGE_SIZE 65536       /* width or height, pixels */
#define AMB_MAX_IMAGE_PIXELS (1 << 28) /* width × height */
#define AMB_MAX_CHANNELS 4

typedef struct amb_image {
    int width, height; /* pixels, 1…AMB_MAX_IMAGE_SIZE */
    int channels;      /* 1…AMB_MAX_CHANNELS */
    size_t stride;     /* floats a row: width rounded up to 16 */
    float *data;       /* 64-byte aligned; every row starts aligned; padding is zero and may be overwritten */
} amb_image;

/* All zero. Errors: ARGUMENT and LIMIT (names the size and the limit), MEMORY. */
amb_status amb_image_create(int width, int height, int channels, amb_image **out, amb_error *error);
void amb_image_close(amb_image **image); /* frees and nulls */
amb_status amb_image_copy(const amb_image *source, amb_image **out, amb_error *error);

static inline float *amb_image_row(const amb_image *image, int channel, int y)
{
    return image->data + ((size_t)channel * (size_t)image->height + (size_t)y) * image->stride;
}
/* SHA-256 over width, height, channels (int32 little-endian) and then every pixel's float bytes in channel, row, column
 * order without padding; 64 hex digits and a NUL. What the golden manifest publishes. */
void amb_image_sha256(const amb_image *image, char hex[65]);

#endif
