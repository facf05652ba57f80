/* Indexed triangle meshes. */
#ifndef AMBIANCE_MESH_H
#define AMBIANCE_MESH_H

#include <ambiance/error.h>
#include <ambiance/vec.h>

#define AMB_MAX_MESH_VERTICES (1u << 28)
#define AMB_MAX_MESH_TRIANGLES (1u << 28)

typedef struct amb_mesh {
    uint32_t vertex_count, triangle_count;
    v3 *position;       /* vertex_count; never NULL when vertex_count > 0 */
    v3 *normal;         /* unit; NULL when the mesh has none */
    v2 *uv;             /* v down; NULL when none */
    v4 *tangent;        /* xyz unit, w = ±1: bitangent = w · normal × tangent; NULL when none */
    uint32_t *index;    /* 3 · triangle_count; front faces counter-clockwise */
    uint32_t *material; /* triangle_count, index into the file's materials; NULL: all 0 */
} amb_mesh;

/* Allocates position and index (zeroed); the optional arrays are NULL. Errors: ARGUMENT, LIMIT, MEMORY. */
amb_status amb_mesh_create(uint32_t vertex_count, uint32_t triangle_count, amb_mesh **out, amb_error *error);
void amb_mesh_close(amb_mesh **mesh); /* frees and nulls */
/* FORMAT when an index is out of range or a position is not finite, naming the first. Readers call this. */
amb_status amb_mesh_check(const amb_mesh *mesh, amb_error *error);
/* (Re)makes smooth unit normals: angle-weighted face normals, summed in triangle order; equal positions are welded
 * first when `weld` (so that UV seams do not show). Vertices of no or degenerate faces get (0, 1, 0). */
amb_status amb_mesh_smooth_normals(amb_mesh *mesh, bool weld, amb_error *error);
/* (Re)makes tangents from positions, normals and UVs (Lengyel's method). ARGUMENT without normals or UVs. */
amb_status amb_mesh_tangents(amb_mesh *mesh, amb_error *error);
/* Unit sphere of `rings` × `segments` quads, poles on ±y, u along longitude, v = 0 at the north pole, seam at u = 0/1
 * with doubled vertices; with normals, UVs and tangents. rings ≥ 2, segments ≥ 3. */
amb_status amb_mesh_sphere(int rings, int segments, amb_mesh **out, amb_error *error);
/* Axis-aligned bounds; an empty mesh gives lo = hi = 0. */
void amb_mesh_bounds(const amb_mesh *mesh, v3 *lo, v3 *hi);

#endif
