/* Inside io/: whole files into memory, and readers over memory (what the fuzz targets call).
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

#endif
