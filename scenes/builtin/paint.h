/* Painting textures from functions of direction: cube maps and latitude-longitude maps. Used at load time, over all
 * threads of a context; the lanes parts are in paint_wide.c. */
#ifndef AMB_SCENES_PAINT_H
#define AMB_SCENES_PAINT_H

#include <ambiance/context.h>
#include <ambiance/texture.h>

/* Four linear channels at unit directions; pure. Compiled at the lanes of the context that paints with it. */
typedef v4x (*amb_field)(v3x direction, const void *user);

/* An RGBA16F cube map of size² faces with mips: each texel the mean of samples² directions spread over it. size is a
 * multiple of 16. Values above half's 65504 are clamped to it. Errors: MEMORY. */
amb_status amb_cube_paint(const amb_context *context, int size, int samples, amb_field field, const void *user,
                          amb_texture **out, amb_error *error);

/* A latitude-longitude map with mips: the left edge looks along +z, u = ¼ along -x, the centre along -z, v = 0 is +y.
 * Fields of a direction are seamless at the poles and at ±180° by construction. Errors: ARGUMENT, LIMIT, MEMORY. */
amb_status amb_map_paint(const amb_context *context, int width, int height, int samples, amb_field field,
                         const void *user, amb_texel texel, amb_texture **out, amb_error *error);
/* The same before it becomes a texture, for generators that go on with the pixels: 4 channels. */
amb_status amb_map_paint_image(const amb_context *context, int width, int height, int samples, amb_field field,
                               const void *user, amb_image **out, amb_error *error);

/* Six square images, faces +x -x +y -y +z -z, painted alike; all NULL on error. */
amb_status amb_cube_paint_faces(const amb_context *context, int size, int samples, amb_field field, const void *user,
                                amb_image *face[6], amb_error *error);

/* Unit direction through (s, t) of a cube's face, both -1…1 with t down: D3D's faces. */
v3 amb_cube_direction(int face, float s, float t);

enum { AMB_PAINT_MAP = 6 }; /* a surface that is not a cube's face 0…5 */

/* One row of one surface. */
typedef struct amb_paint_row {
    amb_image *image;
    int surface, y, samples;
    amb_field field;
    const void *user;
} amb_paint_row;

#endif
