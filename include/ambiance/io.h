/* Files in and out. Readers trust nothing: every size is checked before memory is taken. Writers write to a temporary
 * name beside the target, sync and rename: a killed run leaves the old file or the new one, never half of one. */
#ifndef AMBIANCE_IO_H
#define AMBIANCE_IO_H

#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/mesh.h>
#include <ambiance/texture.h>

typedef enum amb_pixel_type { AMB_HALF, AMB_FLOAT } amb_pixel_type;

/* OpenEXR, ZIP, one part: "color" as R G B A, other layers as NAME.R/G/B/A (3-4 channels), NAME.X/Y… for 1-2 (see
 * docs); metadata as attributes; no clock: equal frames are equal files. Errors: IO, MEMORY. */
amb_status amb_write_exr(const amb_frame *frame, const char *path, amb_pixel_type type, amb_error *error);
/* The first part, scanline or tiled (level 0), any compression but DWA, which is refused (FORMAT). Channels group into
 * layers by what stands before their last dot; R G B A (or Y alone, as grey) are "color", whose alpha is 1 when the
 * file has none; a file without them leaves "color" zero. Errors: IO, FORMAT, LIMIT, MEMORY. */
amb_status amb_read_exr(const char *path, amb_frame **out, amb_error *error);

/* 8-bit sRGB PNG of a 1…4-channel image whose values are display-encoded 0…1 (what post's display pass leaves). */
amb_status amb_write_png(const amb_image *image, const char *path, amb_error *error);
/* PNG, JPEG as coded values 0…1; Radiance HDR as linear floats (*is_linear, which may be NULL, says which). Files that
 * end early or fail their checksums are refused. Errors: IO, FORMAT, LIMIT, MEMORY. */
amb_status amb_read_image(const char *path, amb_image **out, bool *is_linear, amb_error *error);
/* A file straight to a texture: PNG/JPEG keep 8 bits (srgb: colour decode), HDR and EXR become half floats, KTX
 * R11G11B10F cube maps keep their levels. Panoramas stay 2D. */
amb_status amb_read_texture(const char *path, bool srgb, amb_texture **out, amb_error *error);
/* OBJ, PLY, glTF/GLB through Assimp: all meshes of the file, transformed to the root, in one; not normalised. Normals
 * and UVs only when every mesh has them; points and lines are dropped. Errors: IO, FORMAT, LIMIT, MEMORY. */
amb_status amb_read_mesh(const char *path, amb_mesh **out, amb_error *error);

/* Whole-file output used by every writer: begin gives a temporary file (".NAME.PID-N.ambiance-tmp", beside the target),
 * commit syncs and renames, abort removes. Links are followed, permissions kept; a device is written in place. A
 * process with a file-size limit should ignore SIGXFSZ to get the error instead of the signal. */
typedef struct amb_output amb_output;
amb_status amb_output_begin(const char *path, amb_output **out, amb_error *error);
amb_status amb_output_write(amb_output *output, const void *data, size_t bytes, amb_error *error);
amb_status amb_output_commit(amb_output **output, amb_error *error); /* frees and nulls, also on error */
void amb_output_abort(amb_output **output);

#endif
