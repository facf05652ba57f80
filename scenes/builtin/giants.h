/* What Jupiter's map generator, the maker of its key frames and its animation share. */
#ifndef AMB_SCENES_GIANTS_H
#define AMB_SCENES_GIANTS_H

#include <ambiance/texture.h>

#define JUPITER_KEYS 5           /* key frames of its map */
#define JUPITER_KEY_DRIFT 0.055f /* radians that the fastest jet moves between two keys */

/* The Great Red Spot's semi-axes. */
#define JUPITER_SPOT_WIDE 0.235f
#define JUPITER_SPOT_HIGH 0.125f

/* What key frames are made from. */
typedef struct jupiter_still {
    const amb_texture *map;   /* the still map: key frame 0 */
    const amb_texture *zonal; /* its mean along u, one texel wide */
    v3 spot;                  /* unit direction to the middle of the Great Red Spot */
    float key;                /* the number of the key frame, 0…JUPITER_KEYS - 1 */
} jupiter_still;

/* Finds the spot and makes the zonal means; free them with jupiter_still_close. Errors: MEMORY. */
amb_status jupiter_still_open(const amb_texture *map, jupiter_still *out, amb_texture **zonal, amb_error *error);

#endif
