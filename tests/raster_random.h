/* A random pass (targets, states, meshes, hostile vertices and indices) made from bytes, rendered by the library and by
 * a plain pixel-by-pixel truth, and compared bit for bit. Used by a test with random bytes and by the fuzzer. */
#ifndef TESTS_RASTER_RANDOM_H
#define TESTS_RASTER_RANDOM_H

#include <ambiance/context.h>

#include <stddef.h>
#include <stdint.h>

/* Values that differ over all images; `what` (64 bytes) names the first. */
long raster_random_differences(const amb_context *context, const uint8_t *bytes, size_t count, char what[64]);

#endif
