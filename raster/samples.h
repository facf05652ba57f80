/* Samples of quads after coverage: tests, and what follows the shader. Part of tile_wide.c.
 *
 * A quad's samples lie side by side, so a lane is a sample here, and a quad goes by whole vectors. Depths of samples
 * are in the tile's order: tile->sample_groups vectors a quad. */
#ifndef AMBIANCE_RASTER_SAMPLES_H
#define AMBIANCE_RASTER_SAMPLES_H

#include "raster/output.h"

/* ---- sets of samples -------------------------------------------------------------------------------------------- */

/* Sample 0 of the pixels of one quad of the lanes, to all samples. */
static inline uint32_t all_of_pixels(uint32_t lanes, int quad) { return (lanes >> 4 * quad & 15u) * 0x11111111u; }

static inline void keep_pixels(raster_pixels *at, uint32_t lanes)
{
    for (int k = 0; k < RASTER_QUADS; k++)
        at->mask[k] &= all_of_pixels(lanes, k);
}

/* All samples of the pixels. */
static inline void take_pixels(const raster_tile *tile, raster_pixels *at, uint32_t lanes)
{
    for (int k = 0; k < RASTER_QUADS; k++)
        at->mask[k] = all_of_pixels(lanes, k) & tile->all_samples;
}

/* The pixels that have a sample in the mask, as lanes. */
static inline uint32_t pixels_of_samples(const raster_pixels *at)
{
    uint32_t lanes = 0;
    for (int k = 0; k < RASTER_QUADS; k++) {
        uint32_t m = at->mask[k] | at->mask[k] >> 16;
        m |= m >> 8;
        lanes |= ((m | m >> 4) & 15u) << 4 * k;
    }
    return lanes;
}

/* ---- places ----------------------------------------------------------------------------------------------------- */

/* The quads of a block. */
static inline void block_samples(const raster_tile *tile, int bx, int by, raster_pixels *at)
{
    at->stride = (size_t)tile->pass->samples * AMB_LANES;
    for (int k = 0; k < RASTER_QUADS; k++)
        at->quad[k] = block_at(tile, bx, by) + 4 * k * tile->pass->samples;
}

/* A depth a pixel to all samples. */
static inline void spread_depth(const raster_tile *tile, f32x depth, f32x *sample_depth)
{
    for (int k = 0; k < RASTER_QUADS; k++)
        for (int g = 0; g < tile->sample_groups; g++)
            sample_depth[k * tile->sample_groups + g] = spread_quad(depth, k);
}

/* ---- tests and stores ------------------------------------------------------------------------------------------- */

/* The samples in `mask` of one quad that pass the draw's tests. groups: tile->sample_groups, which callers may know. */
static inline uint32_t test_quad(const raster_tile *tile, int groups, const amb_draw *draw, const raster_pixels *at,
                                 int quad, uint32_t mask, maskx front, const f32x *depth)
{
    uint32_t passed = 0;
    for (int g = 0; g < groups; g++) {
        raster_pixels one = one_group(at, quad, g);
        passed |= m_bits(output_tests(tile, draw, &one, front, depth[g], RASTER_ONE_QUAD)) << g * AMB_LANES;
    }
    return mask & passed;
}

/* Removes the samples that fail an early test. All quads face one way. */
static inline void test_samples(const raster_tile *tile, const amb_draw *draw, raster_pixels *at, maskx front,
                                const f32x *depth)
{
    for (int k = 0; k < RASTER_QUADS; k++)
        at->mask[k] =
            test_quad(tile, tile->sample_groups, draw, at, k, at->mask[k], front, depth + k * tile->sample_groups);
}

/* Tests the samples of a quad for good and writes depth and stencil, without a shader. */
static inline void update_quad(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, int quad,
                               maskx front, const f32x *depth)
{
    for (int g = 0; g < tile->sample_groups; g++) {
        raster_pixels one = one_group(at, quad, g);
        update_depth_stencil(tile, draw, &one, front, depth[g], group_lanes(at->mask[quad], g), RASTER_ONE_QUAD);
    }
}

static inline void update_samples(const raster_tile *tile, const amb_draw *draw, const raster_pixels *at, maskx front,
                                  const f32x *depth)
{
    for (int k = 0; k < RASTER_QUADS; k++)
        update_quad(tile, draw, at, k, front, depth + k * tile->sample_groups);
}

/* The samples of which ⌊n·alpha + ½⌋ is above `sample`. */
static inline maskx alpha_covers(f32x alpha, int samples, int sample)
{
    return f_floor(f_saturate(alpha) * (float)samples + 0.5f) > (float)sample;
}

/* Depth and stencil of the samples in the mask, where tests come late; those that fail leave it. */
static __attribute__((noinline)) void update_late(const raster_tile *tile, const amb_draw *draw, raster_pixels *at,
                                                  maskx front, const amb_fs_out *out, const f32x *depth)
{
    for (int k = 0; k < RASTER_QUADS; k++) {
        uint32_t passed = 0;
        const maskx faces = m_set((m_bits(front) >> 4 * k & 1u) != 0);
        for (int g = 0; g < tile->sample_groups; g++) {
            raster_pixels one = one_group(at, k, g);
            f32x own = draw->writes_depth ? spread_quad(out->depth, k) : depth[k * tile->sample_groups + g];
            passed |=
                m_bits(update_depth_stencil(tile, draw, &one, faces, own, group_lanes(at->mask[k], g), RASTER_ONE_QUAD))
                << g * AMB_LANES;
        }
        at->mask[k] = passed;
    }
}

/* What follows the shader, on the samples in the mask. */
static inline void write_samples(const raster_tile *tile, const amb_draw *draw, raster_pixels *at, maskx front,
                                 const amb_fs_out *out, const f32x *depth)
{
    keep_pixels(at, m_bits(out->live));
    for (int n = 0; draw->alpha_to_coverage && n < tile->pass->samples; n++) {
        uint32_t lanes = m_bits(alpha_covers(out->color[0].w, tile->pass->samples, n));
        for (int k = 0; k < RASTER_QUADS; k++)
            at->mask[k] &= all_of_pixels(lanes, k) | ~(15u << 4 * n);
    }
    if (tests_late(draw) || draw->stencil.on)
        update_late(tile, draw, at, front, out, depth);
    else if (!draw->depth_write_off)
        for (int k = 0; k < RASTER_QUADS; k++)
            for (int g = 0; g < tile->sample_groups; g++)
                store_lanes(at->quad[k] + g * AMB_LANES, depth[k * tile->sample_groups + g],
                            group_lanes(at->mask[k], g));
    store_colors(tile, draw, at, out, out->live, RASTER_ALL_SAMPLES);
}

#endif
