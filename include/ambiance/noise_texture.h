/* Value noise out of a texture, as the Ambiance report's Elevated has it: the random numbers at the lattice points are
 * texels instead of hashes (noise.h). Interpolation and derivatives are noise_value2's. The texture repeats after 256
 * cells; in return the four corners of a cell are one look-up, and where all lanes are in one cell (most octaves of a
 * pixel block) a single load.
 *
 * Immutable once made; any thread; same bits at every width. */
#ifndef AMBIANCE_NOISE_TEXTURE_H
#define AMBIANCE_NOISE_TEXTURE_H

#include <ambiance/noise.h>

#define AMB_NOISE_TEXTURE 256 /* texels a side; a power of two */

/* Texel (x, y) holds four signed bytes, lowest first: the random numbers at (x, y), (x+1, y), (x, y+1), (x+1, y+1),
 * wrapping around. A byte s stands for (2s + 1)/256, in (-1, 1). 256 KiB. */
typedef struct amb_noise_texture {
    uint32_t corners[AMB_NOISE_TEXTURE * AMB_NOISE_TEXTURE];
} amb_noise_texture;

/* White noise: the byte at (x, y) is the top one of amb_hash(x + amb_hash(y + seed)), each value equally likely. */
void amb_noise_texture_make(amb_noise_texture *texture, uint32_t seed);

/* The corners' words at texel indices; one load where all lanes want the same. */
AMB_INLINE u32x noise_texture_fetch_(const amb_noise_texture *texture, i32x index)
{
#if AMB_LANES > 1
    int32_t first = i_lane(index, 0);
    if (m_all(index == first))
        return u_set(texture->corners[first]);
#endif
    return u_gather(texture->corners, index);
}

/* A point's place in its cell, and the cell's corners. */
typedef struct noise_texture_cell_ {
    noise_axis_ x, y;
    u32x corners;
} noise_texture_cell_;

/* x, y: whole cells to add. */
AMB_INLINE noise_texture_cell_ noise_texture_cell_of_(const amb_noise_texture *texture, v2x p, uint32_t x, uint32_t y)
{
    noise_texture_cell_ cell;
    cell.x = noise_axis_of_(p.x, (int32_t)x);
    cell.y = noise_axis_of_(p.y, (int32_t)y);
    u32x mask = u_set(AMB_NOISE_TEXTURE - 1u);
    u32x index = (cell.x.cell & mask) | (cell.y.cell & mask) << 8;
    cell.corners = noise_texture_fetch_(texture, u_as_i(index));
    return cell;
}

AMB_INLINE noise2x noise_texture_surface_(const noise_texture_cell_ *cell)
{
    u32x bits = cell->corners;
    f32x a = i_to_f(u_as_i(bits << 24) >> 24), b = i_to_f(u_as_i(bits << 16) >> 24);
    f32x c = i_to_f(u_as_i(bits << 8) >> 24), d = i_to_f(u_as_i(bits) >> 24);
    const float scale = 1.0f / 128.0f; /* exact: a power of two */
    noise2x n = noise_surface_(a * scale, b * scale, c * scale, d * scale, &cell->x, &cell->y);
    n.value += 1.0f / 256.0f;
    return n;
}

/* In (-1, 1). All derivatives, second ones too. The lattice's seed moves the origin in the texture (0: not at all); its
 * x and y are whole cells, as in noise.h. */
AMB_INLINE noise2x noise_texture2(const amb_noise_texture *texture, v2x p, amb_lattice lattice)
{
    uint32_t shift = amb_hash(lattice.seed), x = (uint32_t)lattice.x + (shift & 255u),
             y = (uint32_t)lattice.y + (shift >> 24);
    noise_texture_cell_ cell = noise_texture_cell_of_(texture, p, x, y);
    return noise_texture_surface_(&cell);
}

#endif
