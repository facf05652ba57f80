/* The vertex stage: a chunk's unique vertices are shaded AMB_LANES at a time, classified against the clip planes and,
 * where they need no clipping, taken to the window and snapped to the fixed-point grid. */
#include "raster/internal.h"

#define raster_vertices WIDE(raster_vertices)
void raster_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);

static i32x clip_code(v4x clip, f32x guard_x, f32x guard_y, bool depth_clamp)
{
    f32x limit_x = guard_x * clip.w, limit_y = guard_y * clip.w;
    maskx finite = f_is_finite(clip.x) & f_is_finite(clip.y) & f_is_finite(clip.z) & f_is_finite(clip.w);
    i32x code = i_set(0);
    if (!depth_clamp)
        code = ((clip.z < 0.0f) & RASTER_NEAR) | ((clip.z > clip.w) & RASTER_FAR);
    code |= (clip.x < -limit_x) & RASTER_LEFT;
    code |= (clip.x > limit_x) & RASTER_RIGHT;
    code |= (clip.y < -limit_y) & RASTER_BOTTOM;
    code |= (clip.y > limit_y) & RASTER_TOP;
    maskx at_eye = (code == 0) & ~(clip.w >= FLT_MIN); /* inside every plane, and still nowhere */
    return i_sel(finite & ~at_eye, code, i_set(RASTER_INVALID));
}

/* Window coordinates, rounded half to even to 1/256 pixel. */
static i32x snap(f32x ndc, f32x scale, f32x offset)
{
    return f_to_i(f_round((ndc * scale + offset) * (float)RASTER_SUBPIXEL));
}

/* Depth, 1/w and varyings go to one record a vertex. */
static void write_records(raster_chunk *chunk, uint32_t first, v4x clip, const float *group)
{
    const uint32_t floats = (uint32_t)chunk->draw->state.varying_floats, stride = chunk->stride;
    float z[AMB_LANES], inverse_w[AMB_LANES];
    f_store(z, clip.z / clip.w);
    f_store(inverse_w, 1.0f / clip.w);
    float *record = (float *)(void *)(chunk->vertex + (size_t)first * stride);
    for (uint32_t lane = 0; lane < AMB_LANES; lane++, record += stride) {
        record[0] = z[lane];
        record[1] = inverse_w[lane];
        for (uint32_t k = 0; k < floats; k++)
            record[RASTER_VERTEX_WORDS + k] = group[k * AMB_LANES + lane];
    }
}

void raster_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_draw *draw = &chunk->draw->state;
    const uint32_t count = scratch->unique_count;
    const size_t group_bytes = (size_t)draw->varying_floats * AMB_LANES * sizeof(float);
    const f32x half_w = f_set(0.5f * (float)pass->width), half_h = f_set(0.5f * (float)pass->height);
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
        f_store(scratch->clip_x + first, out.clip.x);
        f_store(scratch->clip_y + first, out.clip.y);
        f_store(scratch->clip_z + first, out.clip.z);
        f_store(scratch->clip_w + first, out.clip.w);
        i32x code = clip_code(out.clip, f_set(pass->guard_x), f_set(pass->guard_y), draw->depth_clamp);
        i_store(scratch->code + first, code);
        i_store(chunk->x + first, snap(out.clip.x / out.clip.w, half_w, half_w));
        i_store(chunk->y + first, snap(out.clip.y / out.clip.w, -half_h, half_h));
        write_records(chunk, first, out.clip, scratch->group);
    }
}
