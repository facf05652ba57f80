/* Lattice noise with analytic derivatives.
 *
 * Value noise interpolates a random number in [-1, 1) at each lattice point; gradient noise (K. Perlin, "Improving
 * Noise", SIGGRAPH 2002) a random slope. Both with the quintic 6t⁵-15t⁴+10t³, so that value, first and second
 * derivative are continuous across cells. The lattice is hashed, not a table: it repeats only after 2³² cells.
 *
 * Units: one cell is 1. |p| below 2²³ per component (above, floats have no fraction; Inf and NaN give NaN). To travel
 * further than float precision allows, keep p small and move lattice.x … by whole cells.
 * Stated ranges hold to rounding (2·10⁻⁶). Derivatives that a caller does not use cost nothing: all is inlined. Pure;
 * any thread; same bits at every width. */
#ifndef AMBIANCE_NOISE_H
#define AMBIANCE_NOISE_H

#include <ambiance/random.h>

/* Which field: a seed, and a whole-cell offset added to the cell of every look-up. {0} is a good default. */
typedef struct amb_lattice {
    uint32_t seed;
    int32_t x, y, z, w;
} amb_lattice;

/* Second derivatives only of noise_value2. */
typedef struct noise2x {
    f32x value;
    v2x slope; /* ∂/∂x, ∂/∂y */
    f32x xx, xy, yy;
} noise2x;
typedef struct noise3x {
    f32x value;
    v3x slope;
} noise3x;
typedef struct noise4x {
    f32x value;
    v4x slope;
} noise4x;

/* ---- lattice ---------------------------------------------------------------------------------------------------- */

/* A coordinate's cell (offset included), its place t in [0, 1) in it, and the fade q(t) with derivatives. */
typedef struct noise_axis_ {
    u32x cell;
    f32x t, q, dq, ddq;
} noise_axis_;

AMB_INLINE noise_axis_ noise_axis_of_(f32x p, int32_t offset)
{
    noise_axis_ a;
    f32x base = f_floor(p);
    a.cell = i_as_u(f_to_i(base)) + (uint32_t)offset;
    f32x t = a.t = p - base;
    a.q = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
    f32x u = t * (t - 1.0f);
    a.dq = 30.0f * (u * u);
    a.ddq = 60.0f * (u * (2.0f * t - 1.0f));
    return a;
}
AMB_INLINE f32x noise_signed_(u32x hash)
{
    return i_to_f(u_as_i(hash >> 8)) * (1.0f / 8388608.0f) - 1.0f;
} /* [-1, 1) */
/* `bits` bits of the hash from bit `first` on, as odd multiples of 2⁻ᵇⁱᵗˢ in (-1, 1). */
AMB_INLINE f32x noise_component_(u32x hash, int first, int bits)
{
    int32_t steps = 1 << bits;
    i32x field = u_as_i(hash >> first) & i_set(steps - 1);
    return i_to_f(field * 2 + i_set(1 - steps)) * (1.0f / (float)steps);
}

/* ---- value noise ------------------------------------------------------------------------------------------------- */

/* The quintic surface over a cell with the values a, b (one cell along x), c (along y), d (both) at its corners:
 * a + (b-a)u + (c-a)v + (a-b-c+d)uv, u and v being the fades. */
AMB_INLINE noise2x noise_surface_(f32x a, f32x b, f32x c, f32x d, const noise_axis_ *x, const noise_axis_ *y)
{
    f32x along_x = b - a, along_y = c - a, both = (a - b) + (d - c);
    f32x rise_x = along_x + both * y->q, rise_y = along_y + both * x->q;
    noise2x n;
    n.value = a + along_x * x->q + rise_y * y->q;
    n.slope.x = x->dq * rise_x;
    n.slope.y = y->dq * rise_y;
    n.xx = x->ddq * rise_x;
    n.xy = x->dq * y->dq * both;
    n.yy = y->ddq * rise_y;
    return n;
}

/* In [-1, 1]. All derivatives, second ones too. */
AMB_INLINE noise2x noise_value2(v2x p, amb_lattice lattice)
{
    noise_axis_ x = noise_axis_of_(p.x, lattice.x), y = noise_axis_of_(p.y, lattice.y);
    u32x row0 = u_hash(y.cell + lattice.seed), row1 = u_hash(y.cell + 1u + lattice.seed);
    f32x a = noise_signed_(u_hash(x.cell + row0)), b = noise_signed_(u_hash(x.cell + 1u + row0));
    f32x c = noise_signed_(u_hash(x.cell + row1)), d = noise_signed_(u_hash(x.cell + 1u + row1));
    return noise_surface_(a, b, c, d, &x, &y);
}

/* In [-1, 1]. */
AMB_INLINE noise3x noise_value3(v3x p, amb_lattice lattice)
{
    noise_axis_ x = noise_axis_of_(p.x, lattice.x), y = noise_axis_of_(p.y, lattice.y),
                z = noise_axis_of_(p.z, lattice.z);
    f32x value[2], dx[2], dy[2]; /* of the two z layers */
    for (uint32_t k = 0; k < 2; k++) {
        u32x layer = u_hash(z.cell + k + lattice.seed);
        u32x row0 = u_hash(y.cell + layer), row1 = u_hash(y.cell + 1u + layer);
        f32x a = noise_signed_(u_hash(x.cell + row0)), b = noise_signed_(u_hash(x.cell + 1u + row0));
        f32x c = noise_signed_(u_hash(x.cell + row1)), d = noise_signed_(u_hash(x.cell + 1u + row1));
        f32x along_x = b - a, along_y = c - a, both = (a - b) + (d - c);
        value[k] = a + along_x * x.q + (along_y + both * x.q) * y.q;
        dx[k] = along_x + both * y.q;
        dy[k] = along_y + both * x.q;
    }
    noise3x n;
    n.value = f_lerp(value[0], value[1], z.q);
    n.slope = (v3x){x.dq * f_lerp(dx[0], dx[1], z.q), y.dq * f_lerp(dy[0], dy[1], z.q), z.dq * (value[1] - value[0])};
    return n;
}

/* In [-1, 1]. 16 lattice points; `linear`: plain linear interpolation (the cheap noise of a perturbed normal) instead
 * of the quintic; its slope jumps at cell faces. */
AMB_INLINE noise4x noise_value4(v4x p, amb_lattice lattice, bool linear)
{
    noise_axis_ axis[4] = {noise_axis_of_(p.x, lattice.x), noise_axis_of_(p.y, lattice.y),
                           noise_axis_of_(p.z, lattice.z), noise_axis_of_(p.w, lattice.w)};
    for (int i = 0; i < 4 && linear; i++) {
        axis[i].q = axis[i].t;
        axis[i].dq = f_set(1.0f);
    }
    f32x value[16], slope[4][16]; /* folded along x, then y, z, w: corner bit 0 is x */
    for (uint32_t w = 0; w < 2; w++) {
        u32x in_w = u_hash(axis[3].cell + w + lattice.seed);
        for (uint32_t z = 0; z < 2; z++) {
            u32x in_z = u_hash(axis[2].cell + z + in_w);
            for (uint32_t y = 0; y < 2; y++) {
                u32x in_y = u_hash(axis[1].cell + y + in_z);
                for (uint32_t x = 0; x < 2; x++)
                    value[8 * w + 4 * z + 2 * y + x] = noise_signed_(u_hash(axis[0].cell + x + in_y));
            }
        }
    }
    for (int i = 0, corners = 8; i < 4; i++, corners >>= 1)
        for (int k = 0; k < corners; k++) {
            f32x difference = value[2 * k + 1] - value[2 * k];
            value[k] = value[2 * k] + difference * axis[i].q;
            for (int j = 0; j < i; j++)
                slope[j][k] = f_lerp(slope[j][2 * k], slope[j][2 * k + 1], axis[i].q);
            slope[i][k] = difference * axis[i].dq;
        }
    return (noise4x){value[0], {slope[0][0], slope[1][0], slope[2][0], slope[3][0]}};
}

/* ---- gradient noise ---------------------------------------------------------------------------------------------- */

/* In [-1, 1], zero at lattice points. First derivatives; xx, xy, yy are 0. */
AMB_INLINE noise2x noise_gradient2(v2x p, amb_lattice lattice)
{
    noise_axis_ x = noise_axis_of_(p.x, lattice.x), y = noise_axis_of_(p.y, lattice.y);
    f32x value[2], dx[2], dy[2]; /* of the two rows */
    for (uint32_t j = 0; j < 2; j++) {
        u32x row = u_hash(y.cell + j + lattice.seed);
        f32x to_y = y.t - (float)j, at[2], gx[2], gy[2];
        for (uint32_t i = 0; i < 2; i++) {
            u32x hash = u_hash(x.cell + i + row);
            gx[i] = noise_component_(hash, 0, 16);
            gy[i] = noise_component_(hash, 16, 16);
            at[i] = gx[i] * (x.t - (float)i) + gy[i] * to_y;
        }
        value[j] = f_lerp(at[0], at[1], x.q);
        dx[j] = f_lerp(gx[0], gx[1], x.q) + (at[1] - at[0]) * x.dq;
        dy[j] = f_lerp(gy[0], gy[1], x.q);
    }
    f32x none = f_set(0.0f);
    return (noise2x){f_lerp(value[0], value[1], y.q),
                     {f_lerp(dx[0], dx[1], y.q), f_lerp(dy[0], dy[1], y.q) + (value[1] - value[0]) * y.dq},
                     none,
                     none,
                     none};
}

/* In [-1, 1] (scaled by 2/3 to be so), zero at lattice points. */
AMB_INLINE noise3x noise_gradient3(v3x p, amb_lattice lattice)
{
    noise_axis_ axis[3] = {noise_axis_of_(p.x, lattice.x), noise_axis_of_(p.y, lattice.y),
                           noise_axis_of_(p.z, lattice.z)};
    f32x value[8], slope[3][8]; /* corner bit 0 is x */
    for (uint32_t z = 0; z < 2; z++) {
        u32x in_z = u_hash(axis[2].cell + z + lattice.seed);
        for (uint32_t y = 0; y < 2; y++) {
            u32x in_y = u_hash(axis[1].cell + y + in_z);
            for (uint32_t x = 0; x < 2; x++) {
                u32x hash = u_hash(axis[0].cell + x + in_y);
                uint32_t k = 4 * z + 2 * y + x;
                for (int i = 0; i < 3; i++)
                    slope[i][k] = noise_component_(hash, 10 * i, 10);
                value[k] = (slope[0][k] * (axis[0].t - (float)x) + slope[1][k] * (axis[1].t - (float)y)) +
                           slope[2][k] * (axis[2].t - (float)z);
            }
        }
    }
    for (int i = 0, corners = 4; i < 3; i++, corners >>= 1)
        for (int k = 0; k < corners; k++) {
            f32x difference = value[2 * k + 1] - value[2 * k];
            for (int j = 0; j < 3; j++)
                slope[j][k] = f_lerp(slope[j][2 * k], slope[j][2 * k + 1], axis[i].q);
            slope[i][k] += difference * axis[i].dq;
            value[k] = value[2 * k] + difference * axis[i].q;
        }
    const float scale = 2.0f / 3.0f;
    return (noise3x){value[0] * scale, {slope[0][0] * scale, slope[1][0] * scale, slope[2][0] * scale}};
}

/* ---- fractal sums (fBm) -------------------------------------------------------------------------------------------
 */

/* octaves ≥ 0; octave i has the frequency lacunarityⁱ and the amplitude gainⁱ, and a seed of its own. A lattice offset
 * scales with the frequency, so lacunarity must be whole where one is used (2 is usual). */
typedef struct amb_fbm {
    int octaves;
    float lacunarity, gain;
} amb_fbm;

AMB_INLINE amb_lattice amb_lattice_finer_(amb_lattice l, float lacunarity)
{
    uint32_t factor = (uint32_t)(int32_t)lacunarity;
    return (amb_lattice){amb_hash(l.seed + 1u), (int32_t)((uint32_t)l.x * factor), (int32_t)((uint32_t)l.y * factor),
                         (int32_t)((uint32_t)l.z * factor), (int32_t)((uint32_t)l.w * factor)};
}

/* Σ gainⁱ·noise(lacunarityⁱ·p) with its derivatives, e.g. fbm2(noise_value2, p, lattice, (amb_fbm){6, 2.0f, 0.5f}). Not
 * normalised: at most (1 - gainⁿ)/(1 - gain). */
AMB_INLINE noise2x fbm2(noise2x (*noise)(v2x, amb_lattice), v2x p, amb_lattice lattice, amb_fbm fbm)
{
    f32x zero = f_set(0.0f);
    noise2x sum = {zero, {zero, zero}, zero, zero, zero};
    float amplitude = 1.0f, frequency = 1.0f;
    for (int i = 0; i < fbm.octaves; i++) {
        noise2x n = noise((v2x){p.x * frequency, p.y * frequency}, lattice);
        float slope = amplitude * frequency, curve = slope * frequency;
        sum.value += n.value * amplitude;
        sum.slope.x += n.slope.x * slope;
        sum.slope.y += n.slope.y * slope;
        sum.xx += n.xx * curve;
        sum.xy += n.xy * curve;
        sum.yy += n.yy * curve;
        amplitude *= fbm.gain;
        frequency *= fbm.lacunarity;
        lattice = amb_lattice_finer_(lattice, fbm.lacunarity);
    }
    return sum;
}
AMB_INLINE noise3x fbm3(noise3x (*noise)(v3x, amb_lattice), v3x p, amb_lattice lattice, amb_fbm fbm)
{
    f32x zero = f_set(0.0f);
    noise3x sum = {zero, {zero, zero, zero}};
    float amplitude = 1.0f, frequency = 1.0f;
    for (int i = 0; i < fbm.octaves; i++) {
        noise3x n = noise((v3x){p.x * frequency, p.y * frequency, p.z * frequency}, lattice);
        float slope = amplitude * frequency;
        sum.value += n.value * amplitude;
        sum.slope.x += n.slope.x * slope;
        sum.slope.y += n.slope.y * slope;
        sum.slope.z += n.slope.z * slope;
        amplitude *= fbm.gain;
        frequency *= fbm.lacunarity;
        lattice = amb_lattice_finer_(lattice, fbm.lacunarity);
    }
    return sum;
}

#endif
