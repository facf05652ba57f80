/* What Jupiter's map generator and its animation share. */
#ifndef AMB_SCENES_GIANTS_H
#define AMB_SCENES_GIANTS_H

#define JUPITER_KEYS 5           /* key frames of its map */
#define JUPITER_KEY_DRIFT 0.055f /* radians that the fastest jet moves between two keys */

/* Which key frame is painted: its number, 0…JUPITER_KEYS-1. */
typedef struct giant_frame {
    float key;
} giant_frame;

#endif
