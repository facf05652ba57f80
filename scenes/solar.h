/* The tour's bodies and its path: where they are, and how the camera flies past them. */
#ifndef AMB_SCENES_SOLAR_H
#define AMB_SCENES_SOLAR_H

#include <ambiance/camera.h>

enum { SOLAR_BODIES = 10, SOLAR_KEYS = 40 };
#define SOLAR_SECONDS 120.0f
#define SOLAR_FOV 42.0f /* vertical, degrees */

/* In the order of their distance, the sun first and at the origin. Distances and sizes are the tour's own. */
typedef struct solar_place {
    v3 centre;
    float radius, reach; /* reach: of all that is drawn, air and rings included, in radii */
} solar_place;
void solar_places(solar_place place[SOLAR_BODIES]);

/* Writes at most SOLAR_KEYS keys, from 0 to SOLAR_SECONDS; returns how many. */
size_t solar_path(const solar_place place[SOLAR_BODIES], amb_camera_key *key);

#endif
