/* Rendering with several samples a pixel: a scene renders larger images and resolves them. */
#ifndef AMB_SCENES_SUPERSAMPLE_H
#define AMB_SCENES_SUPERSAMPLE_H

#include <ambiance/context.h>
#include <ambiance/image.h>

#include <stdbool.h>

/* Fills `small` from `large`, which has factor × factor samples for each of its pixels and as many channels: their
 * mean, summed row by row, or, where values may not be mixed (depth, positions, numbers), the first sample. */
void amb_supersample_resolve(const amb_context *context, const amb_image *large, const amb_image *small, int factor,
                             bool mean);

#endif
