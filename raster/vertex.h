/* The end of every stage that makes vertices: they are classified against the clip planes and, where they need no
 * clipping, taken to the window and snapped to the fixed-point grid. Part of the *_wide.c files of those stages. */
#ifndef AMBIANCE_RASTER_VERTEX_H
#define AMBIANCE_RASTER_VERTEX_H

#include "raster/internal.h"

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

/* Lanes a, b, c, d (0…3 of v, 4…7 of w) of every four lanes. */
#define PICK(lane, four) ((lane) < 4 ? (lane) + 4 * (four) : (lane)-4 + AMB_LANES + 4 * (four))
#define PICKS(four, a, b, c, d) PICK(a, four), PICK(b, four), PICK(c, four), PICK(d, four)
#if AMB_LANES == 4
#define SHUFFLE(v, w, a, b, c, d) __builtin_shufflevector(v, w, PICKS(0, a, b, c, d))
#elif AMB_LANES == 8
#define SHUFFLE(v, w, a, b, c, d) __builtin_shufflevector(v, w, PICKS(0, a, b, c, d), PICKS(1, a, b, c, d))
#else
#define SHUFFLE(v, w, a, b, c, d)                                                                   \
    __builtin_shufflevector(v, w, PICKS(0, a, b, c, d), PICKS(1, a, b, c, d), PICKS(2, a, b, c, d), \
                            PICKS(3, a, b, c, d))
#endif

/* Lane by lane, four words to a record: `stride` words on is the next lane's. */
static inline void store_words(uint32_t *record, uint32_t stride, f32x a, f32x b, f32x c, f32x d)
{
    f32x ab = SHUFFLE(a, b, 0, 4, 1, 5), cd = SHUFFLE(c, d, 0, 4, 1, 5);
    f32x ab2 = SHUFFLE(a, b, 2, 6, 3, 7), cd2 = SHUFFLE(c, d, 2, 6, 3, 7);
    float words[4][AMB_LANES]; /* of lanes 0, 4, …; of 1, 5, …; and so on */
    f_store(words[0], SHUFFLE(ab, cd, 0, 1, 4, 5));
    f_store(words[1], SHUFFLE(ab, cd, 2, 3, 6, 7));
    f_store(words[2], SHUFFLE(ab2, cd2, 0, 1, 4, 5));
    f_store(words[3], SHUFFLE(ab2, cd2, 2, 3, 6, 7));
    for (uint32_t lane = 0; lane < AMB_LANES; lane++)
        memcpy(record + (size_t)lane * stride, &words[lane & 3][lane & ~3u], 4 * sizeof *record);
}
#undef SHUFFLE
#undef PICKS
#undef PICK

/* Depth, 1/w, window position and varyings go to one record a vertex; its padding gets what follows in `group`. */
static inline void write_records(raster_chunk *chunk, uint32_t first, v4x clip, const float *group)
{
    const uint32_t floats = (uint32_t)chunk->draw->state.varying_floats, stride = chunk->stride;
    uint32_t *record = chunk->vertex + (size_t)first * stride;
    store_words(record, stride, clip.z / clip.w, 1.0f / clip.w, f_from_bits(i_load(chunk->x + first)),
                f_from_bits(i_load(chunk->y + first)));
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
    i_store(chunk->x + first, snap(clip.x / clip.w, half_w, half_w));
    i_store(chunk->y + first, snap(clip.y / clip.w, -half_h, half_h));
    write_records(chunk, first, clip, group);
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
