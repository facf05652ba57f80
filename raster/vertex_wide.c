/* The vertex stage: a chunk's unique vertices are shaded AMB_LANES at a time. */
#include "raster/vertex.h"

#define raster_vertices WIDE(raster_vertices)
void raster_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);

void raster_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    const uint32_t count = scratch->unique_count;
    const size_t group_bytes = (size_t)shaded_floats(draw) * AMB_LANES * sizeof(float);
    chunk->vertex_count = count;
    for (uint32_t i = count; i < count + AMB_LANES - 1 && count > 0; i++) { /* lanes past the end repeat the last */
        scratch->index[i] = scratch->index[count - 1];
        scratch->instance[i] = scratch->instance[count - 1];
    }
    for (uint32_t first = 0; first < count; first += AMB_LANES) {
        amb_vs_in in = {draw->uniforms, i_load(scratch->index + first), i_load(scratch->instance + first)};
        amb_vs_out out = {.varyings = scratch->group};
        memset(scratch->group, 0, group_bytes);
        draw->vertex(&in, &out);
        finish_vertices(pass, chunk, scratch, first, out.clip);
    }
}
