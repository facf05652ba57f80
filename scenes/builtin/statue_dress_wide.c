#include "scenes/builtin/statue.h"

/* Value at y of a curve through `count` evenly spaced keys from y0 in steps of `step` (Catmull-Rom). */
static f32x keyed(const float *key, int count, float y0, float step, f32x y)
{
    f32x place = f_clamp((y - y0) * (1.0f / step), f_set(0.0f), f_set((float)(count - 1)));
    i32x i = i_min(f_to_i(place), i_set(count - 2));
    f32x t = place - i_to_f(i);
    f32x b = f_gather(key, i), c = f_gather(key, i + 1);
    f32x a = f_gather(key, i_max(i - 1, i_set(0))), e = f_gather(key, i_min(i + 2, i_set(count - 1)));
    f32x m0 = (c - a) * 0.5f, m1 = (e - b) * 0.5f;
    return b + t * (m0 + t * ((3.0f * (c - b) - 2.0f * m0 - m1) + t * (2.0f * (b - c) + m0 + m1)));
}

/* Half width, half depth and centre of the gown every 0.1 from the floor. */
static const float gown_width[] = {0.140f, 0.116f, 0.105f, 0.099f, 0.095f, 0.088f, 0.068f, 0.059f};
static const float gown_depth[] = {0.130f, 0.104f, 0.092f, 0.084f, 0.076f, 0.064f, 0.050f, 0.046f};
static const float gown_center_x[] = {0.0f, 0.0f, 0.002f, 0.006f, 0.012f, 0.014f, 0.010f, 0.003f};
static const float gown_center_z[] = {-0.012f, -0.010f, -0.004f, 0.002f, 0.004f, 0.0f, 0.0f, 0.002f};

/* Round pipes with deep creases between: 0 in the crease, 1 on the pipe; soft sets the crease's width. */
static f32x pipes(f32x phase, float soft) { return sdf_smooth_abs(f_sin(phase * 0.5f), soft); }

/* The upper part, pinned on the shoulders: the torso's own shape with hanging folds, open at the neck and arms, bloused
 * over the belt. */
static f32x bodice(v3x p)
{
    f32x y = p.y, x = p.x + 0.002f, out = f_abs(x);
    f32x hang = pipes((y + 9.0f * x * x) * 420.0f + 2.0f * f_sin(x * 60.0f), 0.2f) *
                f_smoothstep(f_set(0.735f), f_set(0.775f), y);
    f32x gather = pipes(x * 230.0f + p.z * 80.0f + 1.5f * f_sin(x * 90.0f), 0.2f) *
                  (1.0f - f_smoothstep(f_set(0.705f), f_set(0.735f), y));
    f32x cloth = statue_torso(p) - 0.004f - 0.0016f * hang - 0.0022f * gather;
    /* Neckline: a V in front, a shallower one behind; armholes beside the straps. */
    f32x neck = f_sel(p.z > 0.0f, f_set(0.775f), f_set(0.79f)) + out * 0.72f;
    f32x cut =
        sdf_smooth_intersect((y - neck) * 0.75f, (out - 0.079f - 0.12f * f_max(0.80f - y, f_set(0.0f))) * 0.9f, 0.01f);
    cloth = sdf_smooth_intersect(cloth, cut, 0.003f);
    f32x belt_body = statue_torso(p) - 0.0095f;
    f32x belt = sdf_smooth_intersect(belt_body, f_abs(y - 0.693f) - 0.0095f, 0.008f);
    return sdf_smooth_union(sdf_smooth_intersect(cloth, 0.69f - y, 0.006f), belt, 0.003f);
}

/* The tip of the right foot, from under the hem. */
static f32x foot(v3x p)
{
    f32x d = sdf_round_cone(p, (v3){-0.074f, 0.040f, 0.09f}, (v3){-0.087f, 0.019f, 0.163f}, 0.026f, 0.0155f);
    d = sdf_smooth_union(d, sdf_capsule(p, (v3){-0.076f, 0.0145f, 0.16f}, (v3){-0.098f, 0.013f, 0.155f}, 0.011f),
                         0.01f);
    for (int i = 0; i < 5; i++) {
        float x = -0.0735f - 0.0078f * (float)i, z = 0.196f - 0.0013f * (float)(i * i);
        float radius = i == 0 ? 0.0070f : 0.0052f;
        d = sdf_smooth_union(d, sdf_capsule(p, (v3){x, 0.0165f, z - 0.026f}, (v3){x, 0.0105f, z}, radius), 0.004f);
    }
    f32x sole = sdf_ellipsoid(v3x_sub(p, v3x_splat((v3){-0.087f, 0.0f, 0.150f})), (v3){0.028f, 0.0085f, 0.056f});
    return sdf_smooth_union(d, sole, 0.003f);
}

f32x statue_dress(v3x p)
{
    f32x y = p.y;
    f32x width = keyed(gown_width, 8, 0.0f, 0.1f, y), depth = keyed(gown_depth, 8, 0.0f, 0.1f, y);
    f32x x = p.x - keyed(gown_center_x, 8, 0.0f, 0.1f, y), z = p.z - keyed(gown_center_z, 8, 0.0f, 0.1f, y);
    f32x angle = f_atan2(x, z);
    f32x nx = x / width, nz = z / depth;
    f32x radius = f_sqrt(nx * nx + nz * nz), size = f_min(width, depth);
    f32x body = (radius - 1.0f) * size;
    /* The bent right leg shows through; the cloth is taut over it. */
    f32x thigh = sdf_round_cone(p, (v3){-0.040f, 0.50f, 0.016f}, (v3){-0.056f, 0.295f, 0.090f}, 0.055f, 0.037f);
    f32x shin = sdf_round_cone(p, (v3){-0.056f, 0.295f, 0.090f}, (v3){-0.076f, 0.03f, 0.070f}, 0.037f, 0.032f);
    f32x leg = sdf_smooth_union(thigh, shin, 0.02f);
    f32x taut = f_smoothstep(f_set(-0.012f), f_set(0.03f), leg);
    body = sdf_smooth_union(body, leg, 0.05f);
    /* Folds: fall from the waist, deepen to the hem, spread on the floor. */
    f32x fall = f_saturate((0.70f - y) * (1.0f / 0.70f));
    f32x floor = f_max(1.0f - y * 16.0f, f_set(0.0f));
    f32x drift = 0.6f * f_sin(2.0f * angle + 4.0f * y) + 0.4f * f_sin(6.0f * y + angle);
    f32x first = pipes(10.0f * angle + 2.2f * drift + 1.4f * f_sin(3.0f * angle + 1.0f), 0.2f);
    f32x second = pipes(21.0f * angle + 3.0f * drift + 2.2f * f_sin(2.0f * angle - 6.0f * y), 0.3f);
    f32x height = first * (0.005f + 0.033f * fall * fall) + second * (0.002f + 0.006f * fall);
    height = height + floor * floor * 0.022f * (0.4f + first);
    f32x gown = (body - (height - 0.012f * fall) * (0.12f + 0.88f * taut)) * 0.7f;
    gown = f_max(gown, y - 0.69f);
    /* Overfold: a second layer from the belt over the hips, with a falling zigzag edge. */
    f32x drop = f_saturate((0.70f - y) * 4.0f);
    f32x wander = 2.2f * f_sin(2.0f * angle + 5.0f * y) + 0.8f * f_sin(5.0f * angle + 9.0f * y);
    f32x over_pipes = pipes(12.0f * angle + wander + 1.0f, 0.2f);
    f32x over = body - (0.002f + 0.009f * drop + over_pipes * (0.004f + 0.013f * drop));
    f32x edge = 0.47f + 0.035f * f_cos(angle * 2.0f + 0.6f) + 0.025f * f_sin(angle) -
                (0.022f + 0.012f * f_sin(3.0f * angle + 0.5f)) * over_pipes;
    over = sdf_smooth_intersect(over * 0.75f, sdf_smooth_intersect(y - 0.69f, (edge - y) * 0.5f, 0.004f), 0.003f);
    f32x d = sdf_smooth_union(f_min(gown, over), bodice(p), 0.006f);
    return f_max(f_min(d, foot(p)), -y);
}
