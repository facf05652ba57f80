/* The built-in map of Mercury: longitude-latitude, cratered. Craters are painted in order, so that later ones cut into
 * earlier ones; everything is a function of the point on the sphere, so that poles and date line do not show. */
#ifndef AMB_SCENES_BUILTIN_MERCURY_H
#define AMB_SCENES_BUILTIN_MERCURY_H

#include <ambiance/vec.h>

typedef struct amb_crater {
    v3 center, east, north; /* unit; the last two tangent at the centre */
    float radius;           /* of the rim, radians (chord) */
    float reach;            /* where its ejecta end, in radii */
    float depth, rim;       /* of the floor below and the rim above the plain, in units of brightness */
    float floor;            /* flat part of the radius, 0…0.7; large craters fill their floor */
    float peak;             /* height of the central peak over the floor */
    float fresh;            /* brightness of floor and near ejecta */
    float rays;             /* brightness of its rays; 0: none */
    float seed;             /* where its noise is taken */
} amb_crater;

typedef struct amb_mercury_map {
    int width, height;
    const amb_crater *crater;
    const uint32_t *first; /* height + 1 entries into `list` */
    const uint32_t *list;  /* row by row: the craters that reach it, in painting order */
    unsigned char *texels; /* sRGB8_A8 */
    float *scratch;        /* per thread: relief and brightness rows of width + 32 floats each */
} amb_mercury_map;

#endif
