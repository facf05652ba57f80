/* Tessellation factors, at one lane (tessellate.c) and at N (hull_wide.c): clamping, numbers of segments, sizes of
 * patterns. Direct3D 11's rules, in fixed point with 16 fraction bits. */
#ifndef AMBIANCE_RASTER_FACTORS_H
#define AMBIANCE_RASTER_FACTORS_H

#include "raster/tessellate.h"

/* As raster_factors, a patch a lane. */
typedef struct factors_x {
    i32x edge[4], inside[2];
} factors_x;

AMB_INLINE int factor_edges(amb_patch_shape shape) { return shape == AMB_QUAD ? 4 : 3; }
AMB_INLINE int factor_insides(amb_patch_shape shape) { return shape == AMB_QUAD ? 2 : 1; }

/* Rounded half to even, as Direct3D converts to fixed point. NaN gives the least. */
AMB_INLINE i32x fix_factor(f32x factor, f32x least, float most, bool integer)
{
    f32x f = f_min(f_max(factor, least), f_set(most));
    return f_to_i(f_round((integer ? f_ceil(f) : f) * (float)RASTER_FACTOR_ONE));
}

AMB_INLINE factors_x clamp_factors(amb_patch_shape shape, amb_partitioning partitioning, const f32x edge[4],
                                   const f32x inside[2])
{
    const bool integer = partitioning == AMB_INTEGER;
    const float most = partitioning == AMB_FRACTIONAL_ODD ? 63.0f : 64.0f;
    f32x least = f_set(partitioning == AMB_FRACTIONAL_EVEN ? 2.0f : 1.0f);
    factors_x f = {.edge = {i_set(0)}};
    maskx drawn = m_set(true), frame = m_set(false);
    for (int i = 0; i < factor_edges(shape); i++) {
        drawn &= edge[i] > 0.0f;
        f.edge[i] = fix_factor(edge[i], least, most, integer);
        frame |= f.edge[i] > RASTER_FACTOR_ONE;
    }
    for (int i = 0; i < factor_insides(shape); i++)
        frame |= fix_factor(inside[i], least, most, false) > RASTER_FACTOR_ONE;
    if (partitioning == AMB_FRACTIONAL_ODD) /* if any factor is above one, a ring must lie between edges and inside */
        least = f_sel(frame, least + 1.0f / (float)RASTER_FACTOR_ONE, least);
    for (int i = 0; i < factor_insides(shape); i++)
        f.inside[i] = fix_factor(inside[i], least, most, integer);
    f.edge[0] = i_sel(drawn, f.edge[0], i_set(0));
    return f;
}

/* Segments of an edge or, with at least one point between its ends, of an inside factor. */
AMB_INLINE i32x factor_segments(i32x factor, amb_partitioning partitioning, bool inside)
{
    const int32_t up = 2 * RASTER_FACTOR_ONE - 1;
    i32x segments;
    if (partitioning == AMB_INTEGER)
        segments = factor >> 16;
    else if (partitioning == AMB_FRACTIONAL_ODD)
        segments = ((((factor + 1) >> 1) + (RASTER_FACTOR_ONE / 2 + up / 2)) >> 16) * 2 - 1;
    else
        segments = ((((factor + 1) >> 1) + up / 2) >> 16) * 2;
    return inside ? i_max(segments, i_set(2)) : segments;
}

/* All factors are one: the patch is drawn as it is, with nothing inside. */
AMB_INLINE maskx factors_are_one(amb_patch_shape shape, const factors_x *f)
{
    maskx one = m_set(true);
    for (int i = 0; i < factor_edges(shape); i++)
        one &= f->edge[i] == RASTER_FACTOR_ONE;
    for (int i = 0; i < factor_insides(shape); i++)
        one &= f->inside[i] == RASTER_FACTOR_ONE;
    return one;
}

/* How many points and triangles make a pattern. */
AMB_INLINE void size_factors(amb_patch_shape shape, amb_partitioning partitioning, const factors_x *f, i32x *points,
                             i32x *triangles)
{
    const int edges = factor_edges(shape);
    i32x inner[2]; /* segments of the ring next to the edges */
    for (int i = 0; i < 2; i++)
        inner[i] = factor_segments(f->inside[i < factor_insides(shape) ? i : 0], partitioning, true) - 2;
    *points = *triangles = i_set(0);
    for (int i = 0; i < edges; i++) {
        i32x outer = factor_segments(f->edge[i], partitioning, false);
        *points += outer;
        *triangles += outer + inner[~i & 1];
    }
    if (shape == AMB_QUAD) {
        *points += (inner[0] + 1) * (inner[1] + 1);
        *triangles += inner[0] * inner[1] * 2;
    } else {
        i32x half = (inner[0] + 1) >> 1;
        *points += i_sel((inner[0] & 1) != 0, half * half * 3, half * (half + 1) * 3 + 1);
        *triangles += (inner[0] * inner[0] * 3) >> 1;
    }
    maskx one = factors_are_one(shape, f);
    *points = i_sel(one, i_set(edges), *points);
    *triangles = i_sel(one, i_set(edges - 2), *triangles);
}

#endif
