/* What the mesher's passes share. A block is ISO_BLOCK³ cells; only blocks near the surface are kept. */
#ifndef AMB_CORE_ISOSURFACE_BLOCKS_H
#define AMB_CORE_ISOSURFACE_BLOCKS_H

#include "core/isosurface_table.h"
#include "core/isosurface_wide.h"

#include <ambiance/isosurface.h>

#define ISO_BLOCK 8
#define ISO_CELLS (ISO_BLOCK * ISO_BLOCK * ISO_BLOCK)

typedef struct iso_block {
    int origin[3];              /* of its first cell, in cells */
    uint8_t pattern[ISO_CELLS]; /* corner signs of each cell, x fastest */
    uint16_t first[ISO_CELLS];  /* each cell's first vertex in `position` */
    v3 *position, *normal;      /* vertex_count each; NULL when none */
    uint32_t vertex_count, first_vertex;
    uint32_t crossings, polygons; /* crossed edges over all cells; polygons of the edges at the cells' first corners */
    uint32_t *joint;              /* 3 · cell + axis of each doubled face at a cell's low side; NULL when none */
    uint32_t joint_count, first_joint; /* two vertices for each, numbered from first_joint */
    uint32_t triangle_count, first_triangle;
    bool touches_box, no_memory, incomplete;
} iso_block;

typedef struct iso_scratch { /* one a thread */
    amb_iso_points points;
    float value[AMB_ISO_POINTS];
    float corner[(ISO_BLOCK + 1) * (ISO_BLOCK + 1) * (ISO_BLOCK + 1)];
    v3 gradient[AMB_ISO_POINTS / 8];
    float mean[AMB_ISO_POINTS / 8];
} iso_scratch;

typedef struct iso_grid {
    const amb_isosurface_desc *desc;
    float lipschitz;
    int blocks[3];
    int32_t *block_index; /* by place, -1 for a block without surface */
    iso_block *block;
    int block_count;
    uint32_t vertex_count;
    iso_scratch *scratch;
    amb_mesh *mesh;
    amb_iso_case table[256];
} iso_grid;

/* Moves `total` points onto the surface and gives the normals there. */
void iso_project(const iso_grid *grid, iso_scratch *scratch, v3 *position, v3 *normal, uint32_t total);
/* Fails with the line for a field that changes faster than it says. */
amb_status iso_bound_broken(const iso_grid *grid, amb_error *error);
/* The last passes: joints, triangles, the mesh. */
amb_status iso_connect(const amb_context *context, iso_grid *grid, amb_mesh **out, amb_error *error);

#endif
