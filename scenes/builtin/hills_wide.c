/* The built-in height map: an island of hills and two mountains, cut by a fjord; sea level at 0.25. */
#include "scenes/builtin/tile.h"

v4x WIDE(amb_hills)(v2x uv);

/* Σ gainⁱ f(2ⁱp)/(1 + |Σ∇f|²): octaves fade where the sum is already steep, so that slopes are smooth and crests and
 * valley floors carry the detail, as water leaves them (Ambiance report, Elevated). Octaves are turned against each
 * other: no lattice shows. */
static f32x eroded(v2x p, uint32_t seed, int octaves, float gain)
{
    f32x sum = f_set(0.0f);
    v2x slope = {f_set(0.0f), f_set(0.0f)};
    float amplitude = 1.0f;
    for (int i = 0; i < octaves; i++) {
        noise2x n = noise_gradient2(p, (amb_lattice){.seed = seed + (uint32_t)i});
        slope = v2x_add(slope, v2x_scale(n.slope, f_set(0.8f)));
        sum += n.value * amplitude / (1.0f + v2x_dot(slope, slope));
        amplitude *= gain;
        p = (v2x){(p.x * 0.8f - p.y * 0.6f) * 2.0f, (p.x * 0.6f + p.y * 0.8f) * 2.0f};
    }
    return sum;
}

/* Ridged noise: 1 - |n|, squared, each octave heard where the one before has a ridge (F. K. Musgrave, "Texturing and
 * Modeling", ch. 16). 0…1. */
static f32x ridges(v2x p, uint32_t seed, int octaves)
{
    f32x sum = f_set(0.0f), weight = f_set(1.0f);
    float amplitude = 0.5f;
    for (int i = 0; i < octaves; i++) {
        f32x n = noise_gradient2(p, (amb_lattice){.seed = seed + (uint32_t)i}).value;
        f32x ridge = 1.0f - f_abs(n) * 1.6f;
        ridge = f_max(ridge, f_set(0.0f));
        ridge = ridge * ridge * weight;
        weight = f_saturate(ridge * 1.8f);
        sum += ridge * amplitude;
        amplitude *= 0.5f;
        p = (v2x){(p.x * 0.8f - p.y * 0.6f) * 2.0f, (p.x * 0.6f + p.y * 0.8f) * 2.0f};
    }
    return sum;
}

static f32x bump(v2x p, float x, float y, float width)
{
    f32x dx = (p.x - x) * (1.0f / width), dy = (p.y - y) * (1.0f / width);
    return f_exp(-(dx * dx + dy * dy));
}

/* p in -1…1, x to the right (east), y toward the viewer (south). */
v4x WIDE(amb_hills)(v2x uv)
{
    v2x p = {uv.x * 2.0f - 1.0f, uv.y * 2.0f - 1.0f};
    noise2x bend =
        fbm2(noise_gradient2, v2x_scale(p, f_set(2.3f)), (amb_lattice){.seed = 71}, (amb_fbm){3, 2.0f, 0.5f});
    v2x q = {p.x + bend.value * 0.10f, p.y + bend.slope.x * 0.03f};

    f32x away = f_sqrt(q.x * q.x + q.y * q.y);
    f32x coast =
        fbm2(noise_gradient2, v2x_scale(p, f_set(3.1f)), (amb_lattice){.seed = 72}, (amb_fbm){6, 2.0f, 0.5f}).value;
    f32x land = 1.0f - f_smoothstep(f_set(0.42f), f_set(0.98f), away + coast * 0.22f);

    f32x hills = eroded((v2x){q.x * 4.2f + 11.3f, q.y * 4.2f - 3.7f}, 73, 10, 0.50f);
    f32x crest = ridges((v2x){q.x * 2.6f + 5.1f, q.y * 2.6f + 8.4f}, 83, 10);
    f32x gullies = ridges((v2x){q.x * 9.0f - 2.7f, q.y * 9.0f + 1.9f}, 95, 7);
    f32x mountain = f_saturate(bump(q, -0.30f, -0.42f, 0.30f) + 0.85f * bump(q, 0.42f, -0.30f, 0.26f) +
                               0.45f * bump(q, 0.05f, 0.62f, 0.20f));
    f32x raised = 0.17f + 0.17f * hills + 0.075f * gullies + mountain * (0.02f + 0.70f * crest + 0.10f * gullies);
    f32x height = land * raised - 0.16f * (1.0f - land);

    /* A fjord from the south into the island's middle; its shores rise slowly at first. */
    f32x middle = 0.10f * f_sin(q.y * 5.0f + 0.6f) + 0.04f * coast;
    f32x across = f_abs(q.x - middle - 0.02f) * (1.0f / 0.16f);
    f32x open = f_smoothstep(f_set(-0.45f), f_set(-0.05f), q.y);
    f32x bank = f_saturate((across + coast * 0.55f + hills * 0.35f - 0.20f) * (1.0f / 2.2f));
    f32x fjord = open * (1.0f - bank * (0.45f + 0.55f * bank));
    height = f_lerp(height, f_set(-0.11f) + 0.06f * hills, fjord);
    height = height + 0.25f; /* the sea's level */

    /* Beaches: just above the water the land is flat, more so where the coast noise says sand. */
    f32x above = height - 0.25f, flat = f_set(0.004f) + 0.03f * f_saturate(0.5f + coast * 1.2f);
    f32x beach = above * (above + 0.15f * flat) / (f_max(above, f_set(0.0f)) + flat);
    height = 0.25f + f_sel(above > 0.0f, beach, above * 0.9f);
    return (v4x){f_saturate(height), f_set(0.0f), f_set(0.0f), f_set(1.0f)};
}
