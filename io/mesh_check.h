/* Inside io/: refuses model files whose counts and indices cannot be true. */
#ifndef AMBIANCE_IO_MESH_CHECK_H
#define AMBIANCE_IO_MESH_CHECK_H

#include <ambiance/error.h>

#include <stddef.h>
#include <stdint.h>

/* extension: "obj", "ply", "gltf" or "glb". Errors: FORMAT, LIMIT. */
amb_status amb_check_mesh_file(const uint8_t *data, size_t bytes, const char *extension, const char *name,
                               amb_error *error);

#endif
