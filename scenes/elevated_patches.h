/* The ground's patches: squares of the plane, fixed to the world, larger with distance in rings. */
#ifndef AMB_SCENES_ELEVATED_PATCHES_H
#define AMB_SCENES_ELEVATED_PATCHES_H

#include <ambiance/error.h>
#include <ambiance/vec.h>

/* A patch is one index. From the lowest bit: 12 bits x and 12 bits z (its lower corner in sides of its level, plus
 * PATCH_ORIGIN), 4 bits for its edges u = 0, v = 0, u = 1, v = 1 (set: the neighbour is twice as large, so the edge is
 * half of the neighbour's), 3 bits level. */
#define PATCH_SIDE 0.125f /* of level 0; doubles from level to level */
enum { PATCH_ORIGIN = 2048, PATCH_LEVELS = 6, PATCH_REACH = 8 /* sides of its own level that a ring reaches */ };
#define PATCH_INDICES 0x7fffffffu /* above every index */

AMB_INLINE i32x patch_x(i32x patch) { return (patch & 4095) - PATCH_ORIGIN; }
AMB_INLINE i32x patch_z(i32x patch) { return ((patch >> 12) & 4095) - PATCH_ORIGIN; }
AMB_INLINE maskx patch_half_edge(i32x patch, int edge) { return ((patch >> (24 + edge)) & 1) != 0; }
/* Side of the patch, in cells. */
AMB_INLINE f32x patch_side(i32x patch) { return f_from_bits(f_bits(f_set(PATCH_SIDE)) + (((patch >> 28) & 7) << 23)); }

/* The patches within `sight` (at most 120) cells of the eye that may be in the picture, given that the ground's heights
 * are in low … high. *index is the caller's to free. Errors: MEMORY. */
amb_status elevated_patches(v3 eye, m4 world_to_clip, float sight, float low, float high, uint32_t **index,
                            uint32_t *count, amb_error *error);

#endif
