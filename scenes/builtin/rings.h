/* What Saturn's ring maps and the scene share: u = 0…1 runs from RINGS_INNER to RINGS_OUTER planet radii. */
#ifndef AMB_SCENES_RINGS_H
#define AMB_SCENES_RINGS_H

#define RINGS_INNER 1.11f
#define RINGS_OUTER 2.34f

#endif
