/* The normal-map maker: colour → height filter → overlay with successively blurred copies of itself → renormalise.
 *
 * A normal map taken from a photograph has only the finest relief. Overlaying ever more blurred copies of it, as noise
 * octaves are summed in fBm, brings back mountains and basins (Ambiance report, Mercury, figs. 4 to 6). In detail, with
 * luminance as height h and texels as lengths:
 *
 *   slopes   s = strength · Sobel(h)                                   (u wraps or clamps, v clamps)
 *   normals  n = (-s_u, -s_v, 1) / |…|
 *   copies   b₀ = n_xy, bᵢ = bᵢ₋₁ blurred by [1 4 6 4 1]/16 at steps of 2ⁱ⁻¹ texels, both ways
 *   overlay  c₀ = n_xy, cᵢ = cᵢ₋₁ + y (1 - |cᵢ₋₁|) with y = clamp(gainⁱ bᵢ, -1, 1)
 *   result   (c, n_z) / |…|
 *
 * The third line is Photoshop's "overlay" of (c + 1)/2 by (y + 1)/2, written for signed values. */
#ifndef AMBIANCE_NORMAL_MAP_H
#define AMBIANCE_NORMAL_MAP_H

#include <ambiance/context.h>
#include <ambiance/image.h>
#include <stdbool.h>

#define AMB_MAX_NORMAL_MAP_OCTAVES 10

typedef struct amb_normal_map_options {
    float strength; /* height of a luminance difference of 1, in texels; finite, negative turns the relief over */
    int octaves;    /* blurred copies, 0…AMB_MAX_NORMAL_MAP_OCTAVES; copy i is blurred over about 2ⁱ⁺¹ texels */
    float gain;     /* copy i counts gainⁱ times; 0…8; 2 makes up for what blurring takes from fractal relief */
    bool wrap_u;    /* the left edge continues at the right one */
    bool longitude_latitude; /* the map covers a sphere: slopes along u are divided by the cosine of latitude, up to 4×,
                              * because there a texel is that much narrower */
} amb_normal_map_options;

/* color: 1 channel (taken as height) or 3 or 4 (Rec. 709 luminance of whatever values it holds). The result has 3
 * channels: unit normals, x along +u, y along +v (down the image), z out of the surface; signed, not coded to 0…1.
 * Rows run on the context's threads; the same bits whatever their number. Errors: ARGUMENT, MEMORY. */
amb_status amb_normal_map_make(const amb_context *context, const amb_image *color,
                               const amb_normal_map_options *options, amb_image **out, amb_error *error);

#endif
