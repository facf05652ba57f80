/* The lanes part of amb_irradiance_cube (builtin.h). */
#ifndef AMB_SCENES_IRRADIANCE_H
#define AMB_SCENES_IRRADIANCE_H

#include <ambiance/image.h>
#include <ambiance/texture.h>

/* One texel of the environment. */
typedef struct amb_cube_light {
    v3 direction, flux; /* unit; radiance × solid angle / π */
} amb_cube_light;

/* One row of one face of the result. */
typedef struct amb_irradiance_row {
    amb_image *face;
    int face_index, y, light_count;
    const amb_cube_light *light;
} amb_irradiance_row;

#endif
