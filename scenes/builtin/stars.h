/* The built-in sky: a longitude-latitude panorama of point stars over the Milky Way. Its centre looks along -z, +x to
 * the right, +y up. */
#ifndef AMB_SCENES_BUILTIN_STARS_H
#define AMB_SCENES_BUILTIN_STARS_H

#include <ambiance/vec.h>

typedef struct amb_star {
    v3 direction, rgb; /* unit; linear radiance at its middle */
} amb_star;

typedef struct amb_star_map {
    int width, height;
    float blur; /* radius where a star has fallen to 1/e, radians (chord) */
    const amb_star *star;
    const uint32_t *first; /* height + 1 entries into `list` */
    const uint32_t *list;  /* row by row: the stars that reach it */
    uint16_t *texels;      /* RGBA16F */
    float *scratch;        /* per thread: three rows of width + 32 floats */
} amb_star_map;

#endif
