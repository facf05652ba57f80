/* The end of every stage that makes vertices: they are classified against the clip planes and, where they need no
 * clipping, taken to the window and snapped to the fixed-point grid. Part of the *_wide.c files of those stages. */
#ifndef AMBIANCE_RASTER_VERTEX_H
#define AMBIANCE_RASTER_VERTEX_H

#include "raster/internal.h"
#include "raster/records.h"

static inline i32x clip_code(v4x clip, f32x guard_x, f32x guard_y, bool depth_clamp)
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
static inline i32x snap(f32x ndc, f32x scale, f32x offset)
{
    return f_to_i(f_round((ndc * scale + offset) * (float)RASTER_SUBPIXEL));
}

/* Depth, 1/w, window position and varyings go to one record a vertex; its padding gets what follows in `group`. */
static inline void write_records(raster_chunk *chunk, uint32_t first, v4x clip, i32x x, i32x y, const float *group)
{
    const uint32_t floats = (uint32_t)chunk->draw->state.varying_floats, stride = chunk->stride;
    uint32_t *record = chunk->vertex + (size_t)first * stride;
    store_words(record, stride, clip.z / clip.w, 1.0f / clip.w, f_from_bits(x), f_from_bits(y));
    for (uint32_t k = 0; k < floats; k += 4, group += 4 * AMB_LANES)
        store_words(record + RASTER_VERTEX_WORDS + k, stride, f_load(group), f_load(group + AMB_LANES),
                    f_load(group + 2 * AMB_LANES), f_load(group + 3 * AMB_LANES));
}

/* AMB_LANES vertices from number `first` on. group: their varyings, [float][lane]. */
static inline void window_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t first,
                                   v4x clip, const float *group)
{
    const f32x half_w = f_set(0.5f * (float)pass->width), half_h = f_set(0.5f * (float)pass->height);
    f_store(scratch->clip_x + first, clip.x);
    f_store(scratch->clip_y + first, clip.y);
    f_store(scratch->clip_z + first, clip.z);
    f_store(scratch->clip_w + first, clip.w);
    i32x code = clip_code(clip, f_set(pass->guard_x), f_set(pass->guard_y), chunk->draw->state.depth_clamp);
    i_store(scratch->code + first, code);
    i32x x = snap(clip.x / clip.w, half_w, half_w), y = snap(clip.y / clip.w, -half_h, half_h);
    write_records(chunk, first, clip, i_sel(code == 0, x, i_set(RASTER_NOWHERE)), y, group);
}

/* The floats of a vertex on its way to a geometry shader: clip position, varyings. */
static inline uint32_t primary_floats(const amb_draw *draw) { return 4 + (uint32_t)draw->geometry.input_floats; }

/* How many varyings the vertex or domain shader writes. */
static inline int shaded_floats(const amb_draw *draw)
{
    return draw->geometry.shader ? draw->geometry.input_floats : draw->varying_floats;
}

/* What the vertex or domain shader made goes to the geometry shader or to the window. */
static inline void finish_vertices(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t first,
                                   v4x clip)
{
    const amb_draw *draw = &chunk->draw->state;
    if (!draw->geometry.shader) {
        window_vertices(pass, chunk, scratch, first, clip, scratch->group);
        return;
    }
    const uint32_t floats = primary_floats(draw);
    float position[4][AMB_LANES];
    f_store(position[0], clip.x);
    f_store(position[1], clip.y);
    f_store(position[2], clip.z);
    f_store(position[3], clip.w);
    float *record = scratch->primary + (size_t)first * floats;
    for (uint32_t lane = 0; lane < AMB_LANES; lane++, record += floats) {
        for (uint32_t k = 0; k < 4; k++)
            record[k] = position[k][lane];
        for (uint32_t k = 4; k < floats; k++)
            record[k] = scratch->group[(k - 4) * AMB_LANES + lane];
    }
}

#endif
