/* Gathering a chunk's corners: indices become numbers of the chunk's own vertices, each vertex once. */
#include "raster/internal.h"

#define SLOT_BITS 15
#define LOCAL_BITS 14 /* RASTER_CHUNK_VERTICES fits */
#define GENERATIONS (1u << (32 - LOCAL_BITS))

_Static_assert(RASTER_CHUNK_VERTICES <= 1 << LOCAL_BITS, "local vertex numbers must fit their bits");

/* Forgets all vertices: entries of an older generation no longer count. */
static void forget(raster_scratch *scratch)
{
    if (++scratch->generation == GENERATIONS) {
        memset(scratch->lookup, 0, sizeof *scratch->lookup << SLOT_BITS);
        scratch->generation = 1;
    }
}

/* The local number of vertex `index` of `instance`. Open addressing; a mesh's neighbours hit neighbouring slots. */
static inline uint32_t local_vertex(raster_scratch *scratch, uint32_t index, uint32_t instance)
{
    const uint32_t mask = (1u << SLOT_BITS) - 1u;
    uint64_t key = (uint64_t)index << 32 | (uint64_t)scratch->generation << LOCAL_BITS;
    uint32_t slot = index & mask;
    for (;; slot = (slot + 1) & mask) {
        uint64_t entry = scratch->lookup[slot];
        if ((entry ^ key) >> LOCAL_BITS == 0)
            return (uint32_t)entry & ((1u << LOCAL_BITS) - 1u);
        if (((uint32_t)entry >> LOCAL_BITS) != scratch->generation)
            break;
    }
    uint32_t local = scratch->unique_count++;
    scratch->lookup[slot] = key | local;
    scratch->index[local] = (int32_t)index;
    scratch->instance[local] = (int32_t)instance;
    return local;
}

/* Positions, in the draw's list of corners, of primitive n; returns how many. */
static inline int positions(amb_topology topology, uint32_t n, uint32_t position[3])
{
    switch (topology) {
    case AMB_TRIANGLE_STRIP:
        position[0] = n, position[1] = n + 1 + (n & 1), position[2] = n + 2 - (n & 1);
        return 3;
    case AMB_TRIANGLE_FAN:
        position[0] = 0, position[1] = n + 1, position[2] = n + 2;
        return 3;
    case AMB_LINES:
        position[0] = 2 * n, position[1] = 2 * n + 1;
        return 2;
    case AMB_LINE_STRIP:
        position[0] = n, position[1] = n + 1;
        return 2;
    case AMB_POINTS:
        position[0] = n;
        return 1;
    default:
        position[0] = 3 * n, position[1] = 3 * n + 1, position[2] = 3 * n + 2;
        return 3;
    }
}

static inline void collect(const raster_chunk *chunk, raster_scratch *scratch, amb_topology topology, bool indexed)
{
    const raster_draw *draw = chunk->draw;
    const uint32_t *indices = draw->state.indices;
    const uint32_t limit = indexed ? draw->state.vertex_count : draw->state.count;
    uint32_t instance = (uint32_t)(chunk->first / draw->per_instance);
    uint32_t primitive = (uint32_t)(chunk->first % draw->per_instance), corners = 0;
    forget(scratch);
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t index[3];
        int count = positions(topology, primitive, index);
        bool valid = true;
        for (int k = 0; k < count; k++) {
            index[k] = indexed ? indices[index[k]] : index[k];
            valid &= index[k] < limit;
        }
        if (valid) {
            for (int k = 0; k < 3; k++) /* lines and points repeat their last corner */
                scratch->corner[k][corners] =
                    k < count ? local_vertex(scratch, index[k], instance) : scratch->corner[k - 1][corners];
            scratch->corner[3][corners++] = (uint32_t)chunk->first + i;
        } else if (!draw->state.geometry.shader) { /* whose primitives count when they come out */
            scratch->stats.triangles_culled++;
        }
        if (++primitive == draw->per_instance) {
            primitive = 0;
            instance++;
            forget(scratch);
        }
    }
    scratch->corner_count = corners;
}

void raster_collect(const raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    scratch->unique_count = 0;
    if (draw->topology == AMB_TRIANGLES && draw->indices) /* the hot one, with its constants known */
        collect(chunk, scratch, AMB_TRIANGLES, true);
    else
        collect(chunk, scratch, draw->topology, draw->indices != NULL);
    scratch->stats.vertices += scratch->unique_count;
}
