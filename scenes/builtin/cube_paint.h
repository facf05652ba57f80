/* Making cube maps from functions of direction: painting, panoramas, cosine convolution. Compiled once and used at
 * load time; the lanes parts are in cube_paint_wide.c. */
#ifndef AMB_SCENES_CUBE_PAINT_H
#define AMB_SCENES_CUBE_PAINT_H

#include <ambiance/context.h>
#include <ambiance/texture.h>

/* Linear radiance arriving from unit directions; pure. Compiled at the lanes of the context that paints with it. */
typedef v3x (*amb_radiance)(v3x direction, const void *user);

/* An RGBA16F cube map of size² faces with mips: each texel the mean of samples² directions spread over it. size is a
 * multiple of 16. Radiance above half's 65504 is clamped to it. Errors: MEMORY. */
amb_status amb_cube_paint(const amb_context *context, int size, int samples, amb_radiance radiance, const void *user,
                          amb_texture **out, amb_error *error);

/* One row of one face. */
typedef struct amb_cube_row {
    amb_image *face;
    int face_index, y, samples;
    amb_radiance radiance;
    const void *user;
} amb_cube_row;

/* One light texel of an irradiance convolution. */
typedef struct amb_cube_light {
    v3 direction, flux; /* unit; radiance × solid angle / π */
} amb_cube_light;

typedef struct amb_irradiance_row {
    amb_image *face;
    int face_index, y, light_count;
    const amb_cube_light *light;
} amb_irradiance_row;

/* Unit direction through (s, t) of a face, both -1…1 with t down: D3D's faces +x -x +y -y +z -z. */
v3 amb_cube_direction(int face, float s, float t);

#endif
