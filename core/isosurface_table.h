/* Loops of marching cubes in one cell, for every sign pattern of its corners.
 *
 * Corner i of a cell is at ((i & 1), (i >> 1 & 1), (i >> 2)); bit i of a pattern is set where that corner is inside.
 * Edge 4·axis + u + 2·v runs along `axis` from the corner whose coordinates along the next two axes (in the order
 * x y z x y) are u and v. */
#ifndef AMB_CORE_ISOSURFACE_TABLE_H
#define AMB_CORE_ISOSURFACE_TABLE_H

#include <stdint.h>

#define AMB_ISO_NO_LOOP 0xff

typedef struct amb_iso_case {
    uint8_t loop[12];   /* loop through each edge, AMB_ISO_NO_LOOP where the edge is not crossed */
    uint8_t loop_count; /* 0…4 */
    uint8_t edge_count; /* crossed edges */
    uint8_t twice;      /* bit 2·axis + side: both strokes over that face belong to one loop */
} amb_iso_case;

void amb_iso_cases(amb_iso_case table[256]);
/* First corner of an edge; the second has bit `edge / 4` set as well. */
int amb_iso_edge_corner(int edge);
/* Of the two strokes over the face with diagonal inside corners at the low side of `axis`: 0 or 1, the one that `edge`
 * (of that face) belongs to. */
int amb_iso_stroke(int pattern, int axis, int edge);

#endif
