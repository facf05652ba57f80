/* The mesher's passes: blocks near the surface → their cells' patterns and vertices → joints of doubled faces →
 * triangles. Each pass runs over blocks in parallel and writes only what its block owns; numbers come from prefix sums
 * in block order. The topology (which vertices a polygon joins) is in isosurface_topology.c. */
#include <ambiance/isosurface.h>

#include "core/isosurface_blocks.h"

#include <math.h>
#include <stdlib.h>

#define SQRT3 1.7320509f

static v3 lattice_point(const iso_grid *grid, int x, int y, int z)
{
    const amb_isosurface_desc *d = grid->desc;
    return (v3){d->lo.x + (float)x * d->cell, d->lo.y + (float)y * d->cell, d->lo.z + (float)z * d->cell};
}

static void add_point(amb_iso_points *points, v3 p)
{
    int i = points->count++;
    points->x[i] = p.x;
    points->y[i] = p.y;
    points->z[i] = p.z;
}

/* Field values of the list, which is empty afterwards. */
static void evaluate(const iso_grid *grid, iso_scratch *scratch)
{
    amb_iso_points *points = &scratch->points;
    while (points->count & 15)
        add_point(points, (v3){points->x[0], points->y[0], points->z[0]});
    if (grid->desc->lanes == 1)
        amb_iso_values_x1(grid->desc, points, scratch->value);
    else
        AMB_DISPATCH((amb_isa)grid->desc->lanes, amb_iso_values)(grid->desc, points, scratch->value);
    points->count = 0;
}

/* ---- pass 1: which blocks may hold a piece of the surface -------------------------------------------------------- */

/* One row of blocks. A block is kept when its centre is nearer to the surface than its corners. */
static void find_blocks(void *user, int row, int thread)
{
    iso_grid *grid = user;
    iso_scratch *scratch = &grid->scratch[thread];
    int width = grid->blocks[0];
    float reach = 0.5f * ISO_BLOCK * SQRT3 * 1.001f * grid->desc->cell * grid->lipschitz;
    int half = ISO_BLOCK / 2, y = row % grid->blocks[1], z = row / grid->blocks[1];
    for (int x = 0; x < width; x++)
        add_point(&scratch->points,
                  lattice_point(grid, x * ISO_BLOCK + half, y * ISO_BLOCK + half, z * ISO_BLOCK + half));
    evaluate(grid, scratch);
    for (int x = 0; x < width; x++)
        grid->block_index[row * width + x] = fabsf(scratch->value[x]) <= reach ? 0 : -1;
}

static amb_status list_blocks(iso_grid *grid, amb_error *error)
{
    int total = grid->blocks[0] * grid->blocks[1] * grid->blocks[2];
    for (int i = 0; i < total; i++)
        if (grid->block_index[i] >= 0)
            grid->block_index[i] = grid->block_count++;
    grid->block = calloc((size_t)grid->block_count + 1, sizeof *grid->block);
    if (grid->block == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "isosurface: no memory for %d blocks of cells", grid->block_count);
    for (int i = 0; i < total; i++)
        if (grid->block_index[i] >= 0) {
            iso_block *block = &grid->block[grid->block_index[i]];
            block->origin[0] = i % grid->blocks[0] * ISO_BLOCK;
            block->origin[1] = i / grid->blocks[0] % grid->blocks[1] * ISO_BLOCK;
            block->origin[2] = i / (grid->blocks[0] * grid->blocks[1]) * ISO_BLOCK;
        }
    return AMB_OK;
}

/* ---- pass 2: patterns and vertices of a block's cells ------------------------------------------------------------ */

#define CORNERS (ISO_BLOCK + 1)
#define CORNER(x, y, z) (((z)*CORNERS + (y)) * CORNERS + (x))

static void part_origin(int part, int out[3])
{
    out[0] = (part & 3) * 2;
    out[1] = (part >> 2 & 3) * 2;
    out[2] = (part >> 4) * 2;
}

/* Fills scratch->corner where cells need it; returns a bit for each 2×2×2 part of the block that may hold surface. */
static uint64_t sample_corners(const iso_grid *grid, const iso_block *block, iso_scratch *scratch)
{
    const int *o = block->origin;
    for (int part = 0; part < 64; part++) {
        int at[3];
        part_origin(part, at);
        add_point(&scratch->points, lattice_point(grid, o[0] + at[0] + 1, o[1] + at[1] + 1, o[2] + at[2] + 1));
    }
    evaluate(grid, scratch);
    float reach = SQRT3 * 1.001f * grid->desc->cell * grid->lipschitz;
    uint64_t parts = 0;
    uint8_t needed[CORNERS * CORNERS * CORNERS] = {0};
    for (int part = 0; part < 64; part++) {
        int at[3];
        if (!(fabsf(scratch->value[part]) <= reach))
            continue;
        parts |= 1ull << part;
        part_origin(part, at);
        for (int i = 0; i < 27; i++)
            needed[CORNER(at[0] + i % 3, at[1] + i / 3 % 3, at[2] + i / 9)] = 1;
    }
    for (int z = 0; z < CORNERS; z++)
        for (int y = 0; y < CORNERS; y++)
            for (int x = 0; x < CORNERS; x++)
                if (needed[CORNER(x, y, z)])
                    add_point(&scratch->points, lattice_point(grid, o[0] + x, o[1] + y, o[2] + z));
    if (parts == 0)
        return 0;
    evaluate(grid, scratch);
    const float *value = scratch->value;
    for (int i = 0; i < CORNERS * CORNERS * CORNERS; i++)
        if (needed[i])
            scratch->corner[i] = *value++;
    return parts;
}

static bool touches_box(const iso_grid *grid, const iso_block *block, int x, int y, int z, int pattern)
{
    const int at[3] = {block->origin[0] + x, block->origin[1] + y, block->origin[2] + z};
    for (int axis = 0; axis < 3; axis++)
        for (int corner = 0; corner < 8; corner++) {
            int place = at[axis] + (corner >> axis & 1);
            if ((pattern >> corner & 1) && (place == 0 || place == grid->blocks[axis] * ISO_BLOCK))
                return true;
        }
    return false;
}

/* Patterns of all cells of the parts, and the block's counts. */
static void classify_cells(const iso_grid *grid, iso_block *block, const iso_scratch *scratch, uint64_t parts)
{
    for (int i = 0; i < ISO_CELLS; i++) {
        int x = i % ISO_BLOCK, y = i / ISO_BLOCK % ISO_BLOCK, z = i / (ISO_BLOCK * ISO_BLOCK), pattern = 0;
        block->first[i] = (uint16_t)block->vertex_count;
        if (!(parts >> ((z / 2 * 4 + y / 2) * 4 + x / 2) & 1))
            continue;
        for (int corner = 0; corner < 8; corner++) {
            float value = scratch->corner[CORNER(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2))];
            pattern |= (value < 0.0f) << corner;
        }
        if (pattern != 0 && touches_box(grid, block, x, y, z, pattern))
            block->touches_box = true;
        const amb_iso_case *c = &grid->table[pattern];
        block->pattern[i] = (uint8_t)pattern;
        block->vertex_count += c->loop_count;
        block->crossings += c->edge_count;
        block->polygons += (uint32_t)(c->loop[0] != AMB_ISO_NO_LOOP) + (c->loop[4] != AMB_ISO_NO_LOOP) +
                           (c->loop[8] != AMB_ISO_NO_LOOP);
    }
}

/* Every loop's vertex at the mean of its edge crossings. */
static void place_vertices(const iso_grid *grid, iso_block *block, const iso_scratch *scratch)
{
    for (int i = 0; i < ISO_CELLS; i++) {
        const amb_iso_case *c = &grid->table[block->pattern[i]];
        int x = i % ISO_BLOCK, y = i / ISO_BLOCK % ISO_BLOCK, z = i / (ISO_BLOCK * ISO_BLOCK);
        v3 sum[4] = {{0}};
        int count[4] = {0};
        for (int edge = 0; edge < 12 && c->loop_count > 0; edge++) {
            if (c->loop[edge] == AMB_ISO_NO_LOOP)
                continue;
            int a = amb_iso_edge_corner(edge), axis = edge >> 2, b = a | 1 << axis;
            float at_a = scratch->corner[CORNER(x + (a & 1), y + (a >> 1 & 1), z + (a >> 2))];
            float at_b = scratch->corner[CORNER(x + (b & 1), y + (b >> 1 & 1), z + (b >> 2))];
            float share = at_a / (at_a - at_b);
            v3 p = {(float)(a & 1), (float)(a >> 1 & 1), (float)(a >> 2)};
            if (axis == 0)
                p.x = share;
            else if (axis == 1)
                p.y = share;
            else
                p.z = share;
            sum[c->loop[edge]] = v3_add(sum[c->loop[edge]], p);
            count[c->loop[edge]]++;
        }
        v3 base = lattice_point(grid, block->origin[0] + x, block->origin[1] + y, block->origin[2] + z);
        for (int loop = 0; loop < c->loop_count; loop++)
            block->position[block->first[i] + loop] =
                v3_add(base, v3_scale(sum[loop], grid->desc->cell / (float)count[loop]));
    }
}

/* ---- vertices onto the surface ----------------------------------------------------------------------------------- */

#define POINTS_A_TIME (AMB_ISO_POINTS / 8)

/* Gradients for Newton's steps, and the field, from the corners of a tetrahedron: four values a point. Its error is
 * about step · curvature, which does not matter here. */
static void sample_slopes(const iso_grid *grid, iso_scratch *scratch, const v3 *position, int count)
{
    static const v3 corner[4] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    float step = 0.25f * grid->desc->cell;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 4; k++)
            add_point(&scratch->points, v3_add(position[i], v3_scale(corner[k], step)));
    evaluate(grid, scratch);
    for (int i = 0; i < count; i++) {
        const float *value = scratch->value + (size_t)i * 4;
        v3 g = {(value[0] - value[1]) + (value[3] - value[2]), (value[0] - value[1]) + (value[2] - value[3]),
                (value[0] - value[2]) + (value[1] - value[3])};
        scratch->gradient[i] = v3_scale(g, 0.25f / step);
        scratch->mean[i] = ((value[0] + value[1]) + (value[2] + value[3])) * 0.25f;
    }
}

/* Directions of the gradients, by central differences: what reflections show needs their second order. */
static void sample_normals(const iso_grid *grid, iso_scratch *scratch, const v3 *position, v3 *normal, int count)
{
    float step = 0.25f * grid->desc->cell;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 6; k++) {
            float side = k & 1 ? -step : step;
            add_point(&scratch->points,
                      v3_add(position[i], (v3){k < 2 ? side : 0.0f, k / 2 == 1 ? side : 0.0f, k > 3 ? side : 0.0f}));
        }
    evaluate(grid, scratch);
    for (int i = 0; i < count; i++) {
        const float *value = scratch->value + (size_t)i * 6;
        v3 g = v3_scale((v3){value[0] - value[1], value[2] - value[3], value[4] - value[5]}, 1.0f / step);
        bool usable = isfinite(g.x + g.y + g.z) && v3_dot(g, g) > 1e-12f;
        normal[i] = usable ? v3_normalize(g) : (v3){0.0f, 1.0f, 0.0f};
    }
}

/* p - value · g/|g|², never farther than half a cell. */
static v3 newton_step(const iso_grid *grid, v3 p, v3 gradient, float value)
{
    float limit = 0.5f * grid->desc->cell, squared = v3_dot(gradient, gradient);
    v3 move = v3_scale(gradient, -value / amb_s_max(squared, 1e-6f));
    float length = v3_length(move);
    if (!(length <= limit))
        move = v3_scale(move, limit / length);
    return isfinite(move.x + move.y + move.z) ? v3_add(p, move) : p;
}

void iso_project(const iso_grid *grid, iso_scratch *scratch, v3 *position, v3 *normal, uint32_t total)
{
    for (uint32_t start = 0; start < total; start += POINTS_A_TIME) {
        int count = total - start < POINTS_A_TIME ? (int)(total - start) : POINTS_A_TIME;
        v3 *p = position + start;
        sample_slopes(grid, scratch, p, count);
        for (int i = 0; i < count; i++) {
            p[i] = newton_step(grid, p[i], scratch->gradient[i], scratch->mean[i]);
            add_point(&scratch->points, p[i]);
        }
        evaluate(grid, scratch);
        for (int i = 0; i < count; i++)
            p[i] = newton_step(grid, p[i], scratch->gradient[i], scratch->value[i]);
        sample_normals(grid, scratch, p, normal + start, count);
    }
}

static void sample_block(void *user, int index, int thread)
{
    iso_grid *grid = user;
    iso_block *block = &grid->block[index];
    iso_scratch *scratch = &grid->scratch[thread];
    classify_cells(grid, block, scratch, sample_corners(grid, block, scratch));
    if (block->vertex_count == 0 || block->touches_box)
        return;
    block->position = malloc(block->vertex_count * sizeof *block->position);
    block->normal = malloc(block->vertex_count * sizeof *block->normal);
    if (block->position == NULL || block->normal == NULL) {
        block->no_memory = true;
        return;
    }
    place_vertices(grid, block, scratch);
    iso_project(grid, scratch, block->position, block->normal, block->vertex_count);
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

amb_status iso_bound_broken(const iso_grid *grid, amb_error *error)
{
    return amb_fail(error, AMB_ERROR_ARGUMENT,
                    "isosurface: the field changes faster than lipschitz = %g allows; surface was missed",
                    (double)grid->lipschitz);
}

/* Blocks' failures, in block order, and the sums that show a broken bound: every crossed edge lies in four cells. */
static amb_status check_blocks(iso_grid *grid, amb_error *error)
{
    uint64_t crossings = 0, polygons = 0, vertices = 0;
    for (int i = 0; i < grid->block_count; i++) {
        iso_block *block = &grid->block[i];
        v3 at = lattice_point(grid, block->origin[0], block->origin[1], block->origin[2]);
        if (block->no_memory)
            return amb_fail(error, AMB_ERROR_MEMORY, "isosurface: no memory for a block's vertices");
        if (block->touches_box)
            return amb_fail(error, AMB_ERROR_ARGUMENT,
                            "isosurface: the surface touches the box near (%g, %g, %g); enlarge the box", (double)at.x,
                            (double)at.y, (double)at.z);
        block->first_vertex = (uint32_t)vertices;
        vertices += block->vertex_count;
        crossings += block->crossings;
        polygons += block->polygons;
    }
    if (crossings != 4 * polygons)
        return iso_bound_broken(grid, error);
    if (vertices > AMB_MAX_MESH_VERTICES / 2 || polygons > AMB_MAX_MESH_TRIANGLES / 4)
        return amb_fail(error, AMB_ERROR_LIMIT, "isosurface: %llu vertices; use larger cells",
                        (unsigned long long)vertices);
    grid->vertex_count = (uint32_t)vertices;
    return AMB_OK;
}

static amb_status check_desc(const amb_context *context, const amb_isosurface_desc *d, iso_grid *grid, amb_error *error)
{
    const float size[3] = {d->hi.x - d->lo.x, d->hi.y - d->lo.y, d->hi.z - d->lo.z};
    if (d->field == NULL)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "isosurface: no field given");
    if (d->lanes != 1 && d->lanes != (int)amb_context_isa(context))
        return amb_fail(error, AMB_ERROR_ISA, "isosurface: the field has %d lanes, the context %d", d->lanes,
                        (int)amb_context_isa(context));
    if (!(d->cell > 0.0f) || !isfinite(d->cell) || !(d->lipschitz >= 0.0f) || !isfinite(d->lipschitz))
        return amb_fail(error, AMB_ERROR_ARGUMENT,
                        "isosurface: cell %g and lipschitz %g must be finite, above 0 and not below 0", (double)d->cell,
                        (double)d->lipschitz);
    grid->lipschitz = d->lipschitz > 0.0f ? d->lipschitz : 1.0f;
    for (int axis = 0; axis < 3; axis++) {
        float cells = size[axis] / d->cell;
        if (!(cells > 0.0f) || !(cells <= (float)AMB_MAX_ISOSURFACE_CELLS))
            return amb_fail(error, AMB_ERROR_LIMIT, "isosurface: %g cells along axis %d; 1 to %d are allowed",
                            (double)cells, axis, AMB_MAX_ISOSURFACE_CELLS);
        grid->blocks[axis] = (int)(cells * (1.0f / ISO_BLOCK)) + 1;
    }
    return AMB_OK;
}

static void close_grid(iso_grid *grid)
{
    for (int i = 0; i < grid->block_count && grid->block != NULL; i++) {
        free(grid->block[i].position);
        free(grid->block[i].normal);
        free(grid->block[i].joint);
    }
    free(grid->block);
    free(grid->block_index);
    free(grid->scratch);
}

amb_status amb_isosurface(const amb_context *context, const amb_isosurface_desc *desc, amb_mesh **out, amb_error *error)
{
    iso_grid grid = {.desc = desc};
    *out = NULL;
    amb_status status = check_desc(context, desc, &grid, error);
    if (status != AMB_OK)
        return status;
    amb_iso_cases(grid.table);
    int rows = grid.blocks[1] * grid.blocks[2];
    grid.block_index = malloc((size_t)rows * (size_t)grid.blocks[0] * sizeof *grid.block_index);
    grid.scratch = calloc((size_t)amb_context_threads(context), sizeof *grid.scratch);
    if (grid.block_index == NULL || grid.scratch == NULL) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "isosurface: no memory for %d x %d x %d blocks", grid.blocks[0],
                          grid.blocks[1], grid.blocks[2]);
        goto done;
    }
    amb_parallel_for(context, rows, find_blocks, &grid);
    status = list_blocks(&grid, error);
    if (status != AMB_OK)
        goto done;
    amb_parallel_for(context, grid.block_count, sample_block, &grid);
    status = check_blocks(&grid, error);
    if (status == AMB_OK)
        status = iso_connect(context, &grid, out, error);
done:
    close_grid(&grid);
    return status;
}
