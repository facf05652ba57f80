/* The geometry stage: AMB_LANES of a chunk's primitives go through the geometry shader at a time. What they emit is
 * kept vertex by vertex, lanes side by side, so it is taken to the window lanes-wide as well; strips then become
 * primitives, in the order of the input and, of one input, of emission. */
#include "raster/vertex.h"

#define raster_geometry WIDE(raster_geometry)
void raster_geometry(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);

/* What a shader emits. Its first member is what the shader sees. */
typedef struct emission {
    amb_gs_out out;
    int most, floats;                            /* vertices, varyings */
    float *vertex;                               /* [vertex][4 + floats][lane] */
    uint32_t cut[AMB_MAX_GEOMETRY_VERTICES + 1]; /* bit of a lane: a strip of its ends before this vertex */
} emission;

static void store_lanes(float *at, f32x value, maskx live)
{
    f_store(at, m_all(live) ? value : f_sel(live, value, f_load(at)));
}

static void emit_vertex(amb_gs_out *out, maskx live)
{
    emission *e = (emission *)(void *)out;
    const f32x *varying = out->varyings;
    live &= out->count < e->most;
    for (uint32_t left = m_bits(live); left != 0;) { /* lanes that have emitted equally many, together */
        const int32_t slot = i_lane(out->count, __builtin_ctz(left));
        const maskx here = live & (out->count == slot);
        float *vertex = e->vertex + (size_t)slot * (size_t)(4 + e->floats) * AMB_LANES;
        store_lanes(vertex, out->clip.x, here);
        store_lanes(vertex + AMB_LANES, out->clip.y, here);
        store_lanes(vertex + 2 * AMB_LANES, out->clip.z, here);
        store_lanes(vertex + 3 * AMB_LANES, out->clip.w, here);
        for (int k = 0; k < e->floats; k++)
            store_lanes(vertex + (4 + k) * AMB_LANES, varying[k], here);
        left &= ~m_bits(here);
    }
    out->count += i_sel(live, i_set(1), i_set(0));
}

static void cut_strip(amb_gs_out *out, maskx live)
{
    emission *e = (emission *)(void *)out;
    for (uint32_t left = m_bits(live); left != 0; left &= left - 1) {
        int lane = __builtin_ctz(left);
        e->cut[i_lane(out->count, lane)] |= 1u << lane;
    }
}

/* The corners of AMB_LANES primitives. */
static void gather_primitives(const raster_chunk *chunk, const raster_scratch *scratch, uint32_t first, f32x *varyings,
                              amb_gs_in *in)
{
    const amb_draw *draw = &chunk->draw->state;
    const int32_t floats = (int32_t)primary_floats(draw);
    for (int i = 0; i < 3; i++) {
        i32x from = i_load((const int32_t *)(const void *)(scratch->corner[i] + first)) * floats;
        in->clip[i] = (v4x){f_gather(scratch->primary, from), f_gather(scratch->primary + 1, from),
                            f_gather(scratch->primary + 2, from), f_gather(scratch->primary + 3, from)};
        f32x *varying = varyings + i * draw->geometry.input_floats;
        for (int k = 4; k < floats; k++)
            varying[k - 4] = f_gather(scratch->primary + k, from);
        in->varyings[i] = varying;
    }
    in->primitive = i_load((const int32_t *)(const void *)(scratch->corner[3] + first));
}

static void add_primitive(raster_scratch *scratch, uint32_t *count, uint32_t a, uint32_t b, uint32_t c,
                          uint32_t primitive)
{
    const uint32_t n = (*count)++;
    scratch->other_corner[0][n] = a;
    scratch->other_corner[1][n] = b;
    scratch->other_corner[2][n] = c;
    scratch->other_corner[3][n] = primitive;
}

/* The strips of one lane; vertex n of it has the number base + n · AMB_LANES. */
static void assemble(const amb_draw *draw, const emission *e, int lane, uint32_t base, raster_scratch *scratch,
                     uint32_t primitive, uint32_t *count)
{
    const uint32_t vertices = (uint32_t)i_lane(e->out.count, lane);
    for (uint32_t n = 0, length = 0; n < vertices; n++) {
        const uint32_t number = base + n * AMB_LANES;
        length = e->cut[n] >> lane & 1u ? 1 : length + 1;
        if (draw->geometry.output == AMB_POINTS)
            add_primitive(scratch, count, number, number, number, primitive);
        else if (draw->geometry.output == AMB_LINES && length >= 2)
            add_primitive(scratch, count, number - AMB_LANES, number, number, primitive);
        else if (draw->geometry.output == AMB_TRIANGLES && length >= 3) { /* even ones as they come, odd ones turned */
            uint32_t odd = length & 1u ? 0 : AMB_LANES;
            add_primitive(scratch, count, number - 2 * AMB_LANES, number - AMB_LANES + odd, number - odd, primitive);
        }
    }
}

void raster_geometry(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    const uint32_t in_count = scratch->corner_count;
    uint32_t out_count = 0, vertices = 0;
    f32x in_varyings[3 * AMB_MAX_VARYINGS];
    emission e = {.most = draw->geometry.vertices, .floats = draw->varying_floats, .vertex = scratch->emitted};
    const size_t vertex_floats = (size_t)(4 + e.floats) * AMB_LANES;
    for (uint32_t i = in_count; i < in_count + AMB_LANES - 1 && in_count > 0; i++)
        for (int k = 0; k < 4; k++)
            scratch->corner[k][i] = scratch->corner[k][in_count - 1];
    for (uint32_t first = 0; first < in_count; first += AMB_LANES) {
        const uint32_t left = in_count - first, lanes = left < AMB_LANES ? left : AMB_LANES;
        amb_gs_in in = {.uniforms = draw->uniforms};
        in.live = i_lane_index() < (int32_t)lanes;
        gather_primitives(chunk, scratch, first, in_varyings, &in);
        memset(scratch->group, 0, (size_t)e.floats * AMB_LANES * sizeof *scratch->group);
        memset(e.cut, 0, sizeof e.cut);
        e.out = (amb_gs_out){.varyings = scratch->group, .count = i_set(0), .emit = emit_vertex, .cut = cut_strip};
        draw->geometry.shader(&in, &e.out);
        int32_t most = 0;
        for (uint32_t lane = 0; lane < lanes; lane++) {
            const int32_t emitted = i_lane(e.out.count, (int)lane);
            most = emitted > most ? emitted : most;
            scratch->stats.geometry_vertices += (uint64_t)emitted;
            assemble(draw, &e, (int)lane, vertices + lane, scratch, scratch->corner[3][first + lane], &out_count);
        }
        for (int32_t n = 0; n < most; n++, vertices += AMB_LANES) {
            const float *vertex = e.vertex + (size_t)n * vertex_floats;
            v4x clip = {f_load(vertex), f_load(vertex + AMB_LANES), f_load(vertex + 2 * AMB_LANES),
                        f_load(vertex + 3 * AMB_LANES)};
            window_vertices(pass, chunk, scratch, vertices, clip, vertex + 4 * AMB_LANES);
        }
    }
    for (int k = 0; k < 4; k++) {
        uint32_t *swap = scratch->corner[k];
        scratch->corner[k] = scratch->other_corner[k];
        scratch->other_corner[k] = swap;
    }
    chunk->vertex_count = vertices;
    scratch->corner_count = out_count;
    scratch->stats.geometry_in += in_count;
    scratch->stats.triangles_in += out_count;
}
