/* The domain stage: a chunk's points are shaded AMB_LANES at a time. Lanes may hold points of several patches, so that
 * patches of few points do not waste them. */
#include "raster/vertex.h"

#define raster_domain WIDE(raster_domain)
void raster_domain(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);

/* Brings every lane its own patch's constants and index values. */
static void fetch_patches(const amb_pass *pass, const raster_draw *draw, raster_scratch *scratch, i32x patch,
                          amb_ds_in *in)
{
    const amb_tessellation *t = &draw->state.tessellation;
    const i32x group = u_as_i(i_as_u(patch) / AMB_LANES), lane = patch & (AMB_LANES - 1);
    i32x from = group * (t->patch_floats * AMB_LANES) + lane;
    for (int k = 0; k < t->patch_floats; k++)
        f_store(scratch->constants + k * AMB_LANES, f_gather(pass->patches.constants + k * AMB_LANES, from));
    from = group * (t->corners * AMB_LANES) + lane;
    for (int k = 0; k < t->corners; k++)
        i_store(scratch->corners + k * AMB_LANES, i_gather(pass->patches.corners + k * AMB_LANES, from));
    in->patch = patch + (int32_t)pass->patches.first;
    in->instance = i_set(0);
    if (draw->state.instances > 1)
        in->instance = u_as_i(i_as_u(in->patch) / draw->per_instance);
}

void raster_domain(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    const uint32_t count = scratch->unique_count;
    const size_t group_bytes = (size_t)shaded_floats(draw) * AMB_LANES * sizeof(float);
    const bool barycentric = draw->tessellation.shape == AMB_TRIANGLE;
    amb_ds_in in = {.uniforms = draw->uniforms,
                    .constants = scratch->constants,
                    .corner = (const i32x *)(const void *)scratch->corners};
    i32x fetched = i_set(-1);
    chunk->vertex_count = count;
    for (uint32_t i = count; i < count + AMB_LANES - 1 && count > 0; i++) { /* lanes past the end repeat the last */
        scratch->patch[i] = scratch->patch[count - 1];
        scratch->u[i] = scratch->u[count - 1];
        scratch->v[i] = scratch->v[count - 1];
    }
    for (uint32_t first = 0; first < count; first += AMB_LANES) {
        amb_vs_out out = {.varyings = scratch->group};
        const i32x patch = i_load(scratch->patch + first);
        if (m_any(patch != fetched))
            fetch_patches(pass, chunk->draw, scratch, patch, &in);
        fetched = patch;
        in.u = f_load(scratch->u + first);
        in.v = f_load(scratch->v + first);
        in.w = barycentric ? (1.0f - in.u) - in.v : f_set(0.0f);
        memset(scratch->group, 0, group_bytes);
        draw->tessellation.domain(&in, &out);
        finish_vertices(pass, chunk, scratch, first, out.clip);
    }
}
