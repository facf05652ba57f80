/* The hull stage: patches are shaded AMB_LANES at a time; their factors are clamped, and what each patch will come to
 * is counted, so that patches.c can cut chunks of bounded size. */
#include "raster/factors.h"
#include "raster/internal.h"

#define raster_hull WIDE(raster_hull)
void raster_hull(amb_pass *pass, const raster_draw *draw, uint32_t first, uint32_t count, raster_scratch *scratch);

/* Index values of the patches from `first` of the window on; returns the lanes with valid ones. Lanes from `live` on
 * repeat the last. */
static uint32_t gather_corners(const amb_pass *pass, const raster_draw *draw, uint32_t first, uint32_t live,
                               int32_t *corner, int32_t patch[AMB_LANES], int32_t instance[AMB_LANES])
{
    const amb_draw *state = &draw->state;
    const uint32_t corners = (uint32_t)state->tessellation.corners;
    uint32_t valid = 0;
    for (uint32_t lane = 0; lane < AMB_LANES; lane++) {
        const uint64_t number = pass->patches.first + first + (lane < live ? lane : live - 1);
        const uint32_t base = (uint32_t)(number % draw->per_instance) * corners;
        bool inside = lane < live;
        for (uint32_t k = 0; k < corners; k++) {
            uint32_t index = state->indices ? state->indices[base + k] : base + k;
            bool known = !state->indices || index < state->vertex_count;
            corner[k * AMB_LANES + lane] = known ? (int32_t)index : 0;
            inside &= known;
        }
        patch[lane] = (int32_t)number;
        instance[lane] = (int32_t)(number / draw->per_instance);
        valid |= (uint32_t)inside << lane;
    }
    return valid;
}

static void keep_factors(amb_pass *pass, const amb_tessellation *t, uint32_t first, const amb_hs_out *out,
                         uint32_t valid, uint32_t live, raster_scratch *scratch)
{
    const factors_x f = clamp_factors(t->shape, t->partitioning, out->edge, out->inside);
    int32_t edge[4][AMB_LANES], inside[2][AMB_LANES], made[2][AMB_LANES];
    i32x points, triangles;
    size_factors(t->shape, t->partitioning, &f, &points, &triangles);
    const maskx drawn = (f.edge[0] != 0) & m_from_bits(valid);
    i_store(made[0], points);
    i_store(made[1], i_sel(drawn, t->points ? points : triangles, i_set(0)));
    for (int i = 0; i < 4; i++)
        i_store(edge[i], f.edge[i]);
    for (int i = 0; i < 2; i++)
        i_store(inside[i], f.inside[i]);
    for (uint32_t lane = 0; lane < live; lane++) {
        pass->patches.factors[first + lane] = (raster_factors){
            {edge[0][lane], edge[1][lane], edge[2][lane], edge[3][lane]}, {inside[0][lane], inside[1][lane]}};
        pass->patches.points[first + lane] = (uint32_t)made[0][lane];
        pass->patches.primitives[first + lane] = (uint32_t)made[1][lane];
    }
    scratch->stats.patches_culled += live - (uint64_t)__builtin_popcount(m_bits(drawn));
}

/* `count` patches from `first` of the window on, a multiple of the lanes. */
void raster_hull(amb_pass *pass, const raster_draw *draw, uint32_t first, uint32_t count, raster_scratch *scratch)
{
    const amb_tessellation *t = &draw->state.tessellation;
    const size_t corner_words = (size_t)t->corners * AMB_LANES, floats = (size_t)t->patch_floats * AMB_LANES;
    for (uint32_t end = first + count; first < end; first += AMB_LANES) {
        const uint32_t live = end - first < AMB_LANES ? end - first : AMB_LANES, group = first / AMB_LANES;
        int32_t *corner = pass->patches.corners + group * corner_words;
        float *constants = pass->patches.constants + group * floats;
        int32_t patch[AMB_LANES], instance[AMB_LANES];
        uint32_t valid = gather_corners(pass, draw, first, live, corner, patch, instance);
        amb_hs_in in = {draw->state.uniforms, (const i32x *)(const void *)corner, i_load(patch), i_load(instance)};
        amb_hs_out out = {.constants = constants};
        memset(constants, 0, floats * sizeof *constants);
        for (int i = 0; i < 4; i++)
            out.edge[i] = f_set(1.0f);
        out.inside[0] = out.inside[1] = f_set(1.0f);
        t->hull(&in, &out);
        keep_factors(pass, t, first, &out, valid, live, scratch);
    }
}
