/* From a signed distance field to an indexed triangle mesh. */
#ifndef AMBIANCE_ISOSURFACE_H
#define AMBIANCE_ISOSURFACE_H

#include <ambiance/context.h>
#include <ambiance/mesh.h>
#include <ambiance/vec.h>

/* Field value at one point a lane: world units, negative inside. Every lane is a valid point, called from any thread.
 */
typedef f32x (*amb_field)(const void *user, v3x p);

typedef struct amb_isosurface_desc {
    int lanes; /* AMB_LANES of the file `field` was compiled in: 1, or the context's instruction set */
    amb_field field;
    const void *user; /* handed to the field */
    v3 lo, hi;        /* box that holds the whole surface (enlarged at hi to whole blocks of 8 cells) */
    float cell;       /* edge of a grid cell, world units: details thinner than two cells may be lost */
    float lipschitz;  /* |field(p) - field(q)| ≤ lipschitz · |p - q|: lets empty space be skipped; 0 means 1 */
} amb_isosurface_desc;

#define AMB_MAX_ISOSURFACE_CELLS 4096 /* along an axis */

/* The zero set as a closed, oriented 2-manifold with unit normals: every edge joins exactly two triangles that run it
 * in opposite directions, front faces (counter-clockwise) look out of the solid.
 *
 * Dual marching cubes (G. M. Nielson, IEEE Visualization 2004): each grid cell has one vertex for every closed loop
 * that marching cubes would draw in it, so that thin walls and touching parts stay manifold; each crossed grid edge has
 * one polygon. Faces with diagonally opposite inside corners keep those apart; where two loops' vertices would be
 * joined twice through such a face, the two joints get a vertex each (compare R. Wenger, "Isosurfaces", 2013, ch. 3).
 * Vertices start at the mean of their loop's edge crossings and take two Newton steps along the gradient onto the
 * surface; normals are the field's gradient. Blocks of cells that the Lipschitz bound shows empty are never sampled.
 *
 * The mesh depends only on the description: not on threads, nor on lanes if the field's values do not. Errors: ARGUMENT
 * (bad description; surface touching the box; a field that breaks its Lipschitz bound, where seen), ISA, LIMIT, MEMORY.
 * An empty field gives an empty mesh. */
amb_status amb_isosurface(const amb_context *context, const amb_isosurface_desc *desc, amb_mesh **out,
                          amb_error *error);

#endif
