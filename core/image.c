#include <ambiance/image.h>

#include <sha2.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static size_t image_floats(const amb_image *image)
{
    return image->stride * (size_t)image->height * (size_t)image->channels;
}

/* Zeroed memory. Large images are mapped: their pages come zeroed, huge where the system has huge ones, and are touched
 * first by the thread that draws on them. That halves the cost of a large frame's images against malloc and memset. */
enum { MAPPED_BYTES = 1 << 22 };
static float *take_pixels(size_t bytes)
{
    if (bytes < MAPPED_BYTES) {
        float *data = aligned_alloc(64, bytes);
        return data ? memset(data, 0, bytes) : NULL;
    }
    void *data = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data == MAP_FAILED)
        return NULL;
#ifdef MADV_HUGEPAGE
    madvise(data, bytes, MADV_HUGEPAGE); /* where it fails, pages are small */
#endif
    return data;
}
static void give_pixels(float *data, size_t bytes)
{
    if (bytes < MAPPED_BYTES)
        free(data);
    else
        munmap(data, bytes);
}

amb_status amb_image_create(int width, int height, int channels, amb_image **out, amb_error *error)
{
    *out = NULL;
    if (width < 1 || height < 1 || width > AMB_MAX_IMAGE_SIZE || height > AMB_MAX_IMAGE_SIZE)
        return amb_fail(error, width < 1 || height < 1 ? AMB_ERROR_ARGUMENT : AMB_ERROR_LIMIT,
                        "image size %dx%d: width and height must be 1 to %d", width, height, AMB_MAX_IMAGE_SIZE);
    if ((int64_t)width * height > AMB_MAX_IMAGE_PIXELS)
        return amb_fail(error, AMB_ERROR_LIMIT, "image size %dx%d: at most %d pixels in all", width, height,
                        AMB_MAX_IMAGE_PIXELS);
    if (channels < 1 || channels > AMB_MAX_CHANNELS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "image channels %d: allowed are 1 to %d", channels,
                        AMB_MAX_CHANNELS);
    amb_image *image = malloc(sizeof *image);
    if (!image)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for an image");
    *image =
        (amb_image){.width = width, .height = height, .channels = channels, .stride = ((size_t)width + 15) / 16 * 16};
    size_t bytes = image_floats(image) * sizeof(float); /* a multiple of 64 by the stride */
    image->data = take_pixels(bytes);
    if (!image->data) {
        free(image);
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for an image of %dx%d, %d channels (%zu bytes)", width,
                        height, channels, bytes);
    }
    *out = image;
    return AMB_OK;
}

void amb_image_close(amb_image **image)
{
    if (!image || !*image)
        return;
    give_pixels((*image)->data, image_floats(*image) * sizeof(float));
    free(*image);
    *image = NULL;
}

amb_status amb_image_copy(const amb_image *source, amb_image **out, amb_error *error)
{
    amb_status status = amb_image_create(source->width, source->height, source->channels, out, error);
    if (status == AMB_OK && *out)
        memcpy((*out)->data, source->data, image_floats(source) * sizeof(float));
    return status;
}

void amb_image_sha256(const amb_image *image, char hex[65])
{
    SHA2_CTX sha;
    SHA256Init(&sha);
    const int size[3] = {image->width, image->height, image->channels};
    for (int i = 0; i < 3; i++) {
        uint32_t n = (uint32_t)size[i];
        uint8_t little[4] = {(uint8_t)n, (uint8_t)(n >> 8), (uint8_t)(n >> 16), (uint8_t)(n >> 24)};
        SHA256Update(&sha, little, sizeof little);
    }
    for (int c = 0; c < image->channels; c++)
        for (int y = 0; y < image->height; y++)
            SHA256Update(&sha, (const uint8_t *)amb_image_row(image, c, y), (size_t)image->width * sizeof(float));
    SHA256End(&sha, hex);
}
