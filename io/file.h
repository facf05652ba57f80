/* Inside io/: whole files into memory, readers over memory (what the fuzz targets call), and half floats.
 * `name` is only for messages. Readers over memory have the errors of their path forms, less IO. */
#ifndef AMBIANCE_IO_FILE_H
#define AMBIANCE_IO_FILE_H

#include <ambiance/io.h>

#define AMB_MAX_FILE_BYTES ((size_t)1 << 32)

/* Regular files only. *data is the caller's to free(); it is followed by one zero byte. Errors: IO, LIMIT, MEMORY. */
amb_status amb_read_file(const char *path, uint8_t **data, size_t *bytes, amb_error *error);

amb_status amb_read_exr_memory(const void *data, size_t bytes, const char *name, amb_frame **out, amb_error *error);
amb_status amb_read_image_memory(const void *data, size_t bytes, const char *name, amb_image **out, bool *is_linear,
                                 amb_error *error);
amb_status amb_read_texture_memory(const void *data, size_t bytes, const char *name, bool srgb, amb_texture **out,
                                   amb_error *error);
amb_status amb_read_ktx_memory(const void *data, size_t bytes, const char *name, amb_texture **out, amb_error *error);
/* extension: "obj", "ply", "gltf" or "glb". Files that the data refers to are not opened. */
amb_status amb_read_mesh_memory(const void *data, size_t bytes, const char *extension, const char *name, amb_mesh **out,
                                amb_error *error);

/* Writes at any offset of the temporary file; amb_output_write goes on after the furthest byte written so far. */
amb_status amb_output_write_at(amb_output *output, const void *data, size_t bytes, uint64_t offset, amb_error *error);

/* 8-bit kinds of amb_read_image, told apart by their first bytes. */
typedef enum amb_file_kind {
    AMB_FILE_UNKNOWN,
    AMB_FILE_PNG,
    AMB_FILE_JPEG,
    AMB_FILE_HDR,
    AMB_FILE_EXR,
    AMB_FILE_KTX,
} amb_file_kind;
amb_file_kind amb_file_kind_of(const uint8_t *data, size_t bytes);

/* PNG: chunk by chunk with their CRCs. JPEG: marker by marker to the end mark. HDR: run by run. FORMAT when the file
 * ends early or is damaged: stb_image itself fills what is missing with grey or black. */
amb_status amb_check_png(const uint8_t *data, size_t bytes, const char *name, amb_error *error);
amb_status amb_check_jpeg(const uint8_t *data, size_t bytes, const char *name, amb_error *error);
amb_status amb_check_hdr(const uint8_t *data, size_t bytes, const char *name, amb_error *error);

/* IEEE 754 binary16, round to nearest even, NaN stays NaN; exact back. */
static inline uint16_t amb_half_from_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000u;
    bits &= 0x7fffffffu;
    if (bits > 0x7f800000u) /* NaN: keep the top of its payload, never let it become infinity */
        return (uint16_t)(sign | 0x7e00u | (bits >> 13 & 0x3ffu));
    if (bits >= 0x477ff000u) /* 65520 and above round to infinity */
        return (uint16_t)(sign | 0x7c00u);
    if (bits < 0x38800000u) { /* below 2⁻¹⁴: adding ½ puts the last kept bit at the float's last bit */
        float magnitude;
        memcpy(&magnitude, &bits, sizeof magnitude);
        magnitude += 0.5f;
        memcpy(&bits, &magnitude, sizeof bits);
        return (uint16_t)(sign | (bits - 0x3f000000u));
    }
    return (uint16_t)(sign | (bits - 0x38000000u + 0xfffu + (bits >> 13 & 1u)) >> 13);
}

static inline float amb_float_from_half(uint16_t half)
{
    uint32_t sign = (uint32_t)(half & 0x8000u) << 16, magnitude = half & 0x7fffu, bits;
    float value;
    if (magnitude >= 0x7c00u)
        bits = sign | 0x7f800000u | (magnitude & 0x3ffu) << 13;
    else if (magnitude >= 0x400u)
        bits = sign | ((magnitude << 13) + 0x38000000u);
    else { /* zero and subnormals: exact as a multiple of 2⁻²⁴ */
        value = (float)magnitude * 5.9604644775390625e-8f;
        memcpy(&bits, &value, sizeof bits);
        bits |= sign;
    }
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
