/* Polygons of crossed grid edges: which vertices they join, and in which order. */
#include "core/isosurface_blocks.h"

#include <stdlib.h>

typedef struct cell_place {
    const iso_block *block; /* NULL: outside the kept blocks */
    int cell;
} cell_place;

static cell_place find_cell(const iso_grid *grid, const int at[3])
{
    int place = 0;
    for (int axis = 2; axis >= 0; axis--) {
        int b = at[axis] >> 3;
        if (at[axis] < 0 || b >= grid->blocks[axis])
            return (cell_place){NULL, 0};
        place = place * grid->blocks[axis] + b;
    }
    int32_t index = grid->block_index[place];
    if (index < 0)
        return (cell_place){NULL, 0};
    return (cell_place){&grid->block[index], ((at[2] & 7) * ISO_BLOCK + (at[1] & 7)) * ISO_BLOCK + (at[0] & 7)};
}

static void cell_at(const iso_block *block, int cell, int at[3])
{
    at[0] = block->origin[0] + cell % ISO_BLOCK;
    at[1] = block->origin[1] + cell / ISO_BLOCK % ISO_BLOCK;
    at[2] = block->origin[2] + cell / (ISO_BLOCK * ISO_BLOCK);
}

/* Is the face at the low side of `axis` doubled: both of its strokes join the same two loops? */
static bool face_doubled(const iso_grid *grid, const iso_block *block, int cell, int axis)
{
    if (!(grid->table[block->pattern[cell]].twice >> (2 * axis) & 1))
        return false;
    int at[3];
    cell_at(block, cell, at);
    at[axis]--;
    cell_place below = find_cell(grid, at);
    return below.block != NULL && (grid->table[below.block->pattern[below.cell]].twice >> (2 * axis + 1) & 1);
}

/* ---- pass 3: joints of doubled faces ----------------------------------------------------------------------------- */

static void find_joints(void *user, int index, int thread)
{
    (void)thread;
    iso_grid *grid = user;
    iso_block *block = &grid->block[index];
    uint32_t found[3 * ISO_CELLS];
    for (uint32_t key = 0; key < 3 * ISO_CELLS; key++)
        if (face_doubled(grid, block, (int)(key / 3), (int)(key % 3)))
            found[block->joint_count++] = key;
    if (block->joint_count == 0)
        return;
    block->joint = malloc(block->joint_count * sizeof *block->joint);
    if (block->joint == NULL)
        block->no_memory = true;
    else
        for (uint32_t i = 0; i < block->joint_count; i++)
            block->joint[i] = found[i];
}

/* Starts both joints of a face at the middle between the edges that their strokes join, then projects them. */
static void place_joints(void *user, int index, int thread)
{
    iso_grid *grid = user;
    const iso_block *block = &grid->block[index];
    const amb_isosurface_desc *d = grid->desc;
    for (uint32_t i = 0; i < block->joint_count; i++) {
        int cell = (int)(block->joint[i] / 3), axis = (int)(block->joint[i] % 3), at[3];
        uint32_t vertex = block->first_joint + 2 * i;
        cell_at(block, cell, at);
        for (int stroke = 0; stroke < 2; stroke++) {
            float sum[3] = {0.0f, 0.0f, 0.0f};
            for (int edge = 0; edge < 12; edge++) {
                int corner = amb_iso_edge_corner(edge), along = edge >> 2;
                if (along == axis || (corner >> axis & 1) || amb_iso_stroke(block->pattern[cell], axis, edge) != stroke)
                    continue;
                for (int k = 0; k < 3; k++)
                    sum[k] += 0.5f * ((float)(corner >> k & 1) + (k == along ? 0.5f : 0.0f));
            }
            grid->mesh->position[vertex + (uint32_t)stroke] =
                (v3){d->lo.x + ((float)at[0] + sum[0]) * d->cell, d->lo.y + ((float)at[1] + sum[1]) * d->cell,
                     d->lo.z + ((float)at[2] + sum[2]) * d->cell};
        }
        iso_project(grid, &grid->scratch[thread], grid->mesh->position + vertex, grid->mesh->normal + vertex, 2);
    }
}

/* ---- pass 4: triangles ------------------------------------------------------------------------------------------- */

/* The joint on a side of the polygon of `edge` (an edge of the cell's low face along `axis`), if that face is doubled.
 */
static bool side_joint(cell_place owner, int axis, int edge, uint32_t *vertex)
{
    const iso_block *block = owner.block;
    for (uint32_t i = 0; i < block->joint_count; i++)
        if (block->joint[i] == (uint32_t)(3 * owner.cell + axis)) {
            int stroke = amb_iso_stroke(block->pattern[owner.cell], axis, edge);
            *vertex = block->first_joint + 2 * i + (uint32_t)stroke;
            return true;
        }
    return false;
}

/* The polygon of the grid edge along `axis` at the first corner of a cell: its vertices counter-clockwise about the
 * axis, seen from its far end; *start is a joint, or 0. Returns how many (4…8), 0 when a cell around the edge was
 * skipped although the edge is crossed. The four cells are taken in the order of the quadrants of the next two axes. */
static int edge_polygon(const iso_grid *grid, const iso_block *block, int cell, int axis, uint32_t vertex[8],
                        int *start)
{
    static const int back_u[4] = {0, 1, 1, 0}, back_v[4] = {0, 0, 1, 1};
    int u = (axis + 1) % 3, v = (axis + 2) % 3, count = 0;
    cell_place around[4];
    for (int i = 0; i < 4; i++) {
        int at[3];
        cell_at(block, cell, at);
        at[u] -= back_u[i];
        at[v] -= back_v[i];
        around[i] = find_cell(grid, at);
        if (around[i].block == NULL || around[i].block->pattern[around[i].cell] == 0)
            return 0;
    }
    *start = 0;
    for (int i = 0; i < 4; i++) {
        const iso_block *b = around[i].block;
        int edge = 4 * axis + back_u[i] + 2 * back_v[i];
        const amb_iso_case *c = &grid->table[b->pattern[around[i].cell]];
        vertex[count++] = b->first_vertex + b->first[around[i].cell] + c->loop[edge];
        /* The face to the next cell: at the low side of the higher of the two cells. */
        static const int owner[4] = {0, 1, 3, 0};
        int o = owner[i];
        if (around[o].block->joint_count > 0 &&
            side_joint(around[o], i & 1 ? v : u, 4 * axis + back_u[o] + 2 * back_v[o], &vertex[count]))
            *start = count++;
    }
    return count;
}

static float squared_distance(const v3 *position, uint32_t a, uint32_t b)
{
    v3 d = v3_sub(position[a], position[b]);
    return v3_dot(d, d);
}

/* Triangles of one block; counts them only when out is NULL. A plain quad is cut along its shorter diagonal; a polygon
 * with joints is a fan from one of them, so that no diagonal can coincide with another polygon's. */
static uint32_t block_triangles(const iso_grid *grid, const iso_block *block, uint32_t *out, bool *complete)
{
    uint32_t triangles = 0;
    *complete = true;
    for (int cell = 0; cell < ISO_CELLS && block->vertex_count > 0; cell++)
        for (int axis = 0; axis < 3; axis++) {
            if (grid->table[block->pattern[cell]].loop[4 * axis] == AMB_ISO_NO_LOOP)
                continue;
            uint32_t vertex[8];
            int start, count = edge_polygon(grid, block, cell, axis, vertex, &start);
            if (count == 0) {
                *complete = false;
                continue;
            }
            if (out != NULL) {
                const v3 *p = grid->mesh->position;
                if (count == 4 && squared_distance(p, vertex[1], vertex[3]) < squared_distance(p, vertex[0], vertex[2]))
                    start = 1;
                int inside_first = block->pattern[cell] & 1; /* then the surface looks along the axis */
                for (int i = 1; i + 1 < count; i++) {
                    uint32_t b = vertex[(start + i) % count], c = vertex[(start + i + 1) % count];
                    *out++ = vertex[start];
                    *out++ = inside_first ? b : c;
                    *out++ = inside_first ? c : b;
                }
            }
            triangles += (uint32_t)count - 2;
        }
    return triangles;
}

static void count_triangles(void *user, int index, int thread)
{
    (void)thread;
    iso_grid *grid = user;
    iso_block *block = &grid->block[index];
    bool complete;
    block->triangle_count = block_triangles(grid, block, NULL, &complete);
    block->incomplete = !complete;
}

static void write_block(void *user, int index, int thread)
{
    (void)thread;
    iso_grid *grid = user;
    const iso_block *block = &grid->block[index];
    for (uint32_t i = 0; i < block->vertex_count; i++) {
        grid->mesh->position[block->first_vertex + i] = block->position[i];
        grid->mesh->normal[block->first_vertex + i] = block->normal[i];
    }
}

static void write_triangles(void *user, int index, int thread)
{
    (void)thread;
    iso_grid *grid = user;
    const iso_block *block = &grid->block[index];
    bool complete;
    block_triangles(grid, block, grid->mesh->index + (size_t)block->first_triangle * 3, &complete);
}

amb_status iso_connect(const amb_context *context, iso_grid *grid, amb_mesh **out, amb_error *error)
{
    uint32_t vertices = grid->vertex_count, triangles = 0;
    amb_parallel_for(context, grid->block_count, find_joints, grid);
    for (int i = 0; i < grid->block_count; i++) {
        if (grid->block[i].no_memory)
            return amb_fail(error, AMB_ERROR_MEMORY, "isosurface: no memory for a block's joints");
        grid->block[i].first_joint = vertices;
        vertices += 2 * grid->block[i].joint_count;
    }
    amb_parallel_for(context, grid->block_count, count_triangles, grid);
    for (int i = 0; i < grid->block_count; i++) {
        if (grid->block[i].incomplete)
            return iso_bound_broken(grid, error);
        grid->block[i].first_triangle = triangles;
        triangles += grid->block[i].triangle_count;
    }
    amb_status status = amb_mesh_create(vertices, triangles, &grid->mesh, error);
    if (status != AMB_OK)
        return status;
    grid->mesh->normal = calloc((size_t)vertices + 1, sizeof *grid->mesh->normal);
    if (grid->mesh->normal == NULL) {
        amb_mesh_close(&grid->mesh);
        return amb_fail(error, AMB_ERROR_MEMORY, "isosurface: no memory for %u normals", vertices);
    }
    amb_parallel_for(context, grid->block_count, write_block, grid);
    amb_parallel_for(context, grid->block_count, place_joints, grid);
    amb_parallel_for(context, grid->block_count, write_triangles, grid);
    *out = grid->mesh;
    return AMB_OK;
}
