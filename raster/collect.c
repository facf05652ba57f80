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

/* ---- indices that lie close together, as most meshes' do: a table instead -----------------------------------------
 */

typedef struct index_range {
    uint32_t low, high;
} index_range;

static index_range range_of(const uint32_t *index, uint32_t count)
{
    index_range r = {UINT32_MAX, 0};
    for (uint32_t i = 0; i < count; i++) {
        r.low = index[i] < r.low ? index[i] : r.low;
        r.high = index[i] > r.high ? index[i] : r.high;
    }
    return r;
}

/* Triangles of one instance whose indices are all valid and span less than RASTER_INDEX_SPAN. False when they are not.
 */
static bool collect_near(const raster_chunk *chunk, raster_scratch *scratch)
{
    const raster_draw *draw = chunk->draw;
    const uint32_t primitive = (uint32_t)(chunk->first % draw->per_instance), count = chunk->count;
    if (count > draw->per_instance - primitive)
        return false;
    const uint32_t *index = draw->state.indices + 3 * (size_t)primitive;
    const index_range r = range_of(index, 3 * count);
    if (r.high >= draw->state.vertex_count || r.high - r.low >= RASTER_INDEX_SPAN)
        return false;
    const int32_t instance = (int32_t)(chunk->first / draw->per_instance);
    uint16_t *local_of = scratch->local_of; /* 0: not met yet */
    memset(local_of, 0, (size_t)(r.high - r.low + 1) * sizeof *local_of);
    uint32_t unique = 0;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            uint16_t *local = &local_of[*index - r.low];
            if (*local == 0) {
                scratch->index[unique] = (int32_t)*index;
                scratch->instance[unique] = instance;
                *local = (uint16_t)++unique;
            }
            scratch->corner[k][i] = *local - 1u;
            index++;
        }
        scratch->corner[3][i] = (uint32_t)chunk->first + i;
    }
    scratch->unique_count = unique;
    scratch->corner_count = count;
    return true;
}

void raster_collect(const raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    const bool indexed_triangles = draw->topology == AMB_TRIANGLES && draw->indices;
    scratch->unique_count = 0;
    if (indexed_triangles && collect_near(chunk, scratch)) {
        scratch->stats.vertices += scratch->unique_count;
        return;
    }
    if (indexed_triangles) /* with its constants known */
        collect(chunk, scratch, AMB_TRIANGLES, true);
    else
        collect(chunk, scratch, draw->topology, draw->indices != NULL);
    scratch->stats.vertices += scratch->unique_count;
}
