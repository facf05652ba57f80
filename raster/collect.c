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

static void collect_indexed(const raster_chunk *chunk, raster_scratch *scratch)
{
    const raster_draw *draw = chunk->draw;
    const uint32_t limit = draw->state.vertex_count;
    uint32_t instance = (uint32_t)(chunk->first / draw->per_instance);
    uint32_t triangle = (uint32_t)(chunk->first % draw->per_instance);
    uint32_t corners = 0;
    forget(scratch);
    for (uint32_t i = 0; i < chunk->count; i++) {
        const uint32_t *index = draw->state.indices + (size_t)triangle * 3;
        if (index[0] < limit && index[1] < limit && index[2] < limit) {
            for (int k = 0; k < 3; k++)
                scratch->corner[k][corners] = local_vertex(scratch, index[k], instance);
            scratch->corner[3][corners++] = (uint32_t)chunk->first + i;
        } else {
            scratch->stats.triangles_culled++;
        }
        if (++triangle == draw->per_instance) {
            triangle = 0;
            instance++;
            forget(scratch);
        }
    }
    scratch->corner_count = corners;
}

static void collect_running(const raster_chunk *chunk, raster_scratch *scratch)
{
    const raster_draw *draw = chunk->draw;
    uint32_t instance = (uint32_t)(chunk->first / draw->per_instance);
    uint32_t triangle = (uint32_t)(chunk->first % draw->per_instance);
    for (uint32_t i = 0; i < chunk->count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t local = scratch->unique_count++;
            scratch->index[local] = (int32_t)(triangle * 3 + k);
            scratch->instance[local] = (int32_t)instance;
            scratch->corner[k][i] = local;
        }
        scratch->corner[3][i] = (uint32_t)chunk->first + i;
        if (++triangle == draw->per_instance) {
            triangle = 0;
            instance++;
        }
    }
    scratch->corner_count = chunk->count;
}

void raster_collect(const raster_chunk *chunk, raster_scratch *scratch)
{
    scratch->unique_count = 0;
    if (chunk->draw->state.indices)
        collect_indexed(chunk, scratch);
    else
        collect_running(chunk, scratch);
    scratch->stats.vertices += scratch->unique_count;
}
