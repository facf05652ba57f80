/* Painting square textures from functions of (u, v), and noise that repeats over the square, so that ground textures
 * tile. Used at load time, over all threads of a context; lanes parts in tile_wide.c. */
#ifndef AMB_SCENES_TILE_H
#define AMB_SCENES_TILE_H

#include <ambiance/context.h>
#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <ambiance/texture.h>

/* Four linear channels at (u, v), both 0…1; pure. Compiled at the lanes of the context that paints with it. */
typedef v4x (*amb_tile_field)(v2x uv);

/* size²: a multiple of 16. The value at every texel's centre. Errors: MEMORY. */
amb_status amb_tile_paint(const amb_context *context, int size, amb_tile_field field, amb_texel texel,
                          amb_texture **out, amb_error *error);

/* Gradient noise of p, in cells, that repeats after `period` cells each way (a power of two). In [-1, 1]. */
AMB_INLINE f32x tile_noise(v2x p, int32_t period, uint32_t seed)
{
    noise_axis_ x = noise_axis_of_(p.x, 0), y = noise_axis_of_(p.y, 0);
    uint32_t wrap = (uint32_t)period - 1u;
    f32x value[2];
    for (uint32_t j = 0; j < 2; j++) {
        u32x row = u_hash(((y.cell + j) & wrap) + seed);
        f32x at[2];
        for (uint32_t i = 0; i < 2; i++) {
            u32x hash = u_hash(((x.cell + i) & wrap) + row);
            at[i] =
                noise_component_(hash, 0, 16) * (x.t - (float)i) + noise_component_(hash, 16, 16) * (y.t - (float)j);
        }
        value[j] = f_lerp(at[0], at[1], x.q);
    }
    return f_lerp(value[0], value[1], y.q);
}

/* Its fBm from `cells` cells a side on; cells a power of two. About -1…1. */
AMB_INLINE f32x tile_fbm(v2x uv, int cells, uint32_t seed, int octaves, float gain)
{
    f32x sum = f_set(0.0f);
    float amplitude = 1.3f;
    for (int i = 0; i < octaves; i++, cells *= 2, amplitude *= gain)
        sum += tile_noise((v2x){uv.x * (float)cells, uv.y * (float)cells}, cells, seed + (uint32_t)i) * amplitude;
    return sum;
}

/* Turned by a whole-number rotation (and enlarged √(a² + b²) times), so that what repeats still does. */
AMB_INLINE v2x tile_turned(v2x uv, float a, float b) { return (v2x){uv.x * a + uv.y * b, uv.y * a - uv.x * b}; }

/* Cellular noise (S. Worley, SIGGRAPH 1996): distances to the nearest and second nearest of one random point a cell, in
 * cells, and a random number of the nearest. `cells` a side, a power of two. */
typedef struct tile_cells_ {
    f32x nearest, second, random;
} tile_cells_;
AMB_INLINE tile_cells_ tile_cells(v2x uv, int cells, uint32_t seed)
{
    f32x px = uv.x * (float)cells, py = uv.y * (float)cells, cx = f_floor(px), cy = f_floor(py);
    u32x x = i_as_u(f_to_i(cx)), y = i_as_u(f_to_i(cy));
    uint32_t wrap = (uint32_t)cells - 1u;
    f32x far = f_set(9.0f);
    tile_cells_ c = {far, far, far};
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            u32x hash = u_hash(((x + (uint32_t)i) & wrap) + u_hash(((y + (uint32_t)j) & wrap) + seed));
            f32x dx = cx + (float)i + f_unit(hash << 16) - px, dy = cy + (float)j + f_unit(hash & 0xffff0000u) - py;
            f32x squared = dx * dx + dy * dy;
            maskx nearer = squared < c.nearest;
            c.second = f_sel(nearer, c.nearest, f_min(squared, c.second));
            c.random = f_sel(nearer, f_unit(u_hash(hash)), c.random);
            c.nearest = f_min(squared, c.nearest);
        }
    c.nearest = f_sqrt(c.nearest);
    c.second = f_sqrt(c.second);
    return c;
}

/* One row of a square. */
typedef struct amb_tile_row {
    amb_image *image;
    int y;
    amb_tile_field field;
} amb_tile_row;

#endif
