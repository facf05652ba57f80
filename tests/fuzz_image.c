/* libFuzzer target: any bytes as a PNG, JPEG or Radiance file, to an image and to a texture. */
#include "io/file.h"

/* stb_image compiled here, under AddressSanitizer and with coverage, takes the place of libstb's in this program. */
#pragma clang attribute push(__attribute__((no_sanitize("undefined"))), apply_to = function)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Weverything"
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>
#pragma clang diagnostic pop
#pragma clang attribute pop

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    amb_image *image;
    amb_texture *texture;
    amb_error error;
    bool is_linear;
    amb_status status = amb_read_image_memory(data, bytes, "fuzz", &image, &is_linear, &error);
    if ((status == AMB_OK) != (image != NULL))
        __builtin_trap();
    amb_image_close(&image);
    amb_file_kind kind = amb_file_kind_of(data, bytes);
    if (kind == AMB_FILE_PNG || kind == AMB_FILE_JPEG || kind == AMB_FILE_HDR) {
        amb_status again = amb_read_texture_memory(data, bytes, "fuzz", bytes & 1, &texture, &error);
        if ((again == AMB_OK) != (texture != NULL))
            __builtin_trap();
        amb_texture_close(&texture);
    }
    return 0;
}
