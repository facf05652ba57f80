/* Mountains as a function of the plane: the Ambiance report's Elevated (its chapter's formulas; the height function
 * after I. Quilez, "Elevated", Breakpoint 2009).
 *
 *   Z(p) = Σᵢ 2⁻ⁱ f(2ⁱp) / (1 + hᵢₓ² + hᵢᵧ²),  hᵢ = Σⱼ₌₀…ᵢ ∇f(2ʲp)
 *
 * f is noise_texture2. hᵢ, the slope of the plain fBm so far, flattens the finer octaves where the ground is steep:
 * smooth faces, rough crests and valleys, as erosion leaves them.
 *
 * f is twice continuously differentiable and Z, which holds its slope, once: at the cells' borders normals bend.
 *
 * p is in cells of octave 0, relative to a whole cell that amb_terrain_place chooses: near the eye, so that |p| is
 * small and a flight of any length loses no precision. The plane's second axis is called y here; a scene with y up uses
 * its z. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_TERRAIN_H
#define AMBIANCE_SHADE_TERRAIN_H

#include <ambiance/math.h>
#include <ambiance/noise_texture.h>

#define TERRAIN_OCTAVES 16

/* The argument of octave i: 2ⁱ R p + offset, in cells of its own after (x, y). R turns by the angle of cosine c and
 * sine s. */
typedef struct amb_terrain_octave {
    float frequency, along, across; /* 2ⁱ, 2ⁱc, 2ⁱs */
    float c, s, cc, ss, cs;         /* c, s, c², s², c·s */
    v2 offset;                      /* the part of the octave's origin below one cell, in [0, 1) */
    uint32_t x, y;                  /* its whole cells, and where in the texture the octave starts; modulo 2³² */
} amb_terrain_octave;

typedef struct amb_terrain {
    const amb_noise_texture *noise; /* borrowed */
    float erosion;                  /* factor on h² in the denominator: 1 as in the report, 0 plain fBm */
    amb_terrain_octave octave[TERRAIN_OCTAVES];
} amb_terrain;

/* Fills *terrain so that p = (0, 0) is the lattice point (x, y) of octave 0, |x| and |y| at most 2⁴⁰; origins of the
 * finer octaves are exact integer arithmetic. `turned`: octave i is turned by i · 36.87° (the 3-4-5 triangle's angle),
 * which hides that value noise's lattice has two axes; otherwise f(2ⁱp) as the report writes it. The ground repeats
 * after 256 cells along x and y if it is not turned, and after 256 · 5¹⁵ if it is. */
void amb_terrain_place(amb_terrain *terrain, const amb_noise_texture *noise, uint32_t seed, float erosion, bool turned,
                       int64_t x, int64_t y);

typedef struct terrain_surface {
    f32x height; /* Z: |Z| < 2, seldom above 1 */
    v2x slope;   /* ∂Z/∂x, ∂Z/∂y */
} terrain_surface;

/* What the functions below take p for: beyond 2²², and for NaN, that bound. So results are finite, and an octave that
 * a lane has not asked for adds nothing to it. */
AMB_INLINE v2x terrain_place_(v2x p)
{
    f32x far = f_set(4194304.0f);
    return (v2x){f_clamp(p.x, -far, far), f_clamp(p.y, -far, far)};
}

/* Where 2ⁱp is, in the octave's own, turned axes. */
AMB_INLINE noise_texture_cell_ terrain_octave_(const amb_terrain *t, int i, v2x p)
{
    const amb_terrain_octave *o = &t->octave[i];
    v2x at = {(p.x * o->along - p.y * o->across) + o->offset.x, (p.x * o->across + p.y * o->along) + o->offset.y};
    return noise_texture_cell_of_(t->noise, at, o->x, o->y);
}

/* Z and its slope by quotient and chain rule. octaves: 0…16 of each lane, a real number: the last one fades in, so that
 * detail can follow distance without steps. A slope that the caller does not use costs nothing.
 *
 * *coarse becomes what the first coarse_octaves of them alone give, at no cost.
 *
 * With u = 2⁻ⁱf, v = 1 + h²: ∇(u/v) = (v∇u - u∇v)/v², ∇v = 2 J h (the report's "1 + 2hₓ…" is a slip: the 1 has no
 * slope), J = Σⱼ 2ʲ f″(2ʲp). */
AMB_INLINE terrain_surface terrain_at_both(const amb_terrain *t, v2x p, f32x octaves, int coarse_octaves,
                                           terrain_surface *coarse)
{
    p = terrain_place_(p);
    f32x zero = f_set(0.0f);
    terrain_surface z = {zero, {zero, zero}};
    f32x hx = zero, hy = zero, jxx = zero, jxy = zero, jyy = zero;
    float amplitude = 1.0f;
    noise_texture_cell_ next = terrain_octave_(t, 0, p);
    *coarse = z;
    bool more = m_any(octaves > 0.0f);
    for (int i = 0; more; i++, amplitude *= 0.5f) {
        const amb_terrain_octave *o = &t->octave[i];
        f32x weight = f_saturate(octaves - (float)i);
        noise2x f = noise_texture_surface_(&next);
        more = i + 1 < TERRAIN_OCTAVES && m_any(octaves > (float)(i + 1));
        if (more) /* looked up early: the next octave's way to its texel is long */
            next = terrain_octave_(t, i + 1, p);
        f32x fx = f.slope.x * o->c + f.slope.y * o->s, fy = f.slope.y * o->c - f.slope.x * o->s;
        f32x curve = weight * o->frequency, twist = (f.xy + f.xy) * o->cs;
        hx += weight * fx;
        hy += weight * fy;
        jxx += curve * (f.xx * o->cc + f.yy * o->ss + twist);
        jxy += curve * ((f.yy - f.xx) * o->cs + f.xy * (o->cc - o->ss));
        jyy += curve * (f.xx * o->ss + f.yy * o->cc - twist);

        f32x inverse = 1.0f / (1.0f + t->erosion * (hx * hx + hy * hy));
        f32x term = weight * amplitude * f.value * inverse;
        f32x fall = term * inverse * (2.0f * t->erosion), share = weight * inverse;
        z.height += term;
        z.slope.x += share * fx - fall * (jxx * hx + jxy * hy);
        z.slope.y += share * fy - fall * (jxy * hx + jyy * hy);
        if (i < coarse_octaves)
            *coarse = z;
    }
    return z;
}
AMB_INLINE terrain_surface terrain_at(const amb_terrain *t, v2x p, f32x octaves)
{
    terrain_surface coarse;
    return terrain_at_both(t, p, octaves, 0, &coarse);
}

/* The same slope by central differences at distance `step` > 0: four more heights, an error of step²/6 · Z‴. */
AMB_INLINE terrain_surface terrain_at_central(const amb_terrain *t, v2x p, f32x octaves, f32x step)
{
    f32x right = terrain_at(t, (v2x){p.x + step, p.y}, octaves).height;
    f32x left = terrain_at(t, (v2x){p.x - step, p.y}, octaves).height;
    f32x up = terrain_at(t, (v2x){p.x, p.y + step}, octaves).height;
    f32x down = terrain_at(t, (v2x){p.x, p.y - step}, octaves).height;
    f32x per_cell = 0.5f / step;
    return (terrain_surface){terrain_at(t, p, octaves).height, {(right - left) * per_cell, (up - down) * per_cell}};
}

/* Unit normal, y up, of the surface y = scale · Z over the plane (x, z). */
AMB_INLINE v3x terrain_normal(v2x slope, float scale)
{
    return v3x_normalize((v3x){-slope.x * scale, f_set(1.0f), -slope.y * scale});
}

/* Σ 2⁻ⁱ f(2ⁱp) of the same octaves, not divided: the report's noiseFBM. |result| < 2. */
AMB_INLINE f32x terrain_fbm(const amb_terrain *t, v2x p, f32x octaves)
{
    p = terrain_place_(p);
    f32x sum = f_set(0.0f);
    float amplitude = 1.0f;
    for (int i = 0; i < TERRAIN_OCTAVES && m_any(octaves > (float)i); i++, amplitude *= 0.5f) {
        noise_texture_cell_ cell = terrain_octave_(t, i, p);
        sum += f_saturate(octaves - (float)i) * amplitude * noise_texture_surface_(&cell).value;
    }
    return sum;
}

/* Ambient occlusion from the normal alone: n_yᵏ + a, k > 0; n_y below 0 counts as 0. Report, fig. 32. */
AMB_INLINE f32x terrain_occlusion(f32x normal_y, float k, float a)
{
    return f_pow(f_max(normal_y, f_set(0.0f)), f_set(k)) + a;
}

/* How much of the ground is snow, 0…1: smoothstep(A - B·n_y, C - D·n_y, noise · E). Flat ground (n_y near 1) has the
 * lower edges, so snow lies there and slides off cliffs. An upper edge that is not above the lower one is a hard step.
 * Report, fig. 34. */
typedef struct terrain_snow_edges {
    float a, b, c, d, e;
} terrain_snow_edges;
AMB_INLINE f32x terrain_snow(f32x normal_y, f32x noise, terrain_snow_edges s)
{
    f32x low = s.a - s.b * normal_y, high = f_max(s.c - s.d * normal_y, low + 1.0e-6f);
    return f_smoothstep(low, high, noise * s.e);
}

/* A shadow's march over y = scale · Z. */
typedef struct terrain_march {
    float scale;   /* of Z: heights and p in cells */
    float ceiling; /* no ground is above this height */
    float reach;   /* how far a shadow falls, cells along the ray, > 0 */
    float spread;  /* tangent of the sun's apparent radius: 0.0047 for ours; more is softer */
    int steps;     /* at most */
} terrain_march;

/* How much of the sun is seen from height y over p along the unit vector to_light (y up): 0…1. Steps grow with the
 * clearance and with the distance gone. The smallest ratio of clearance to distance, between the steps by the parabola
 * through three of them, against the sun's spread makes the penumbra. Stops at the ceiling or at `reach`. Lights below
 * the horizon are not seen. */
AMB_INLINE f32x terrain_sunlight(const amb_terrain *t, const terrain_march *m, v2x p, f32x y, v3 to_light, f32x octaves)
{
    f32x none = f_set(1.0e9f), before = none, last = none, least = none;
    f32x along = f_set(m->reach * (1.0f / 1024.0f));
    maskx going = m_set(to_light.y > 0.0f);
    least = f_sel(going, least, -none);
    for (int i = 0; i < m->steps && m_any(going); i++) {
        v2x at = {p.x + along * to_light.x, p.y + along * to_light.z};
        f32x height = y + along * to_light.y;
        f32x clearance = height - m->scale * terrain_at(t, at, f_sel(going, octaves, f_set(0.0f))).height;
        f32x ratio = clearance / along;
        f32x bend = (before - last) + (ratio - last), lean = ratio - before;
        f32x valley = last - lean * lean / f_max(8.0f * bend, f_set(1.0e-9f));
        f32x lowest = f_sel((last < before) & (last < ratio) & (before < none), f_min(valley, ratio), ratio);
        least = f_sel(going, f_min(lowest, least), least);
        before = f_sel(going, last, before);
        last = f_sel(going, ratio, last);
        along += f_max(0.5f * clearance, along * 0.02f);
        going &= (ratio > -m->spread) & (height < m->ceiling) & (along < m->reach);
    }
    return f_smoothstep(f_set(-m->spread), f_set(m->spread), least);
}

#endif
