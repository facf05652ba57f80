/* The head, in units of half its height: chin at y = -1, crown at +1, face towards +z. */
#include "scenes/builtin/statue.h"

#define HEAD_UNIT 0.0668f

static sdf_frame head_frame(void)
{
    v3 forward = v3_normalize((v3){-0.24f, -0.07f, 0.97f});
    v3 side = v3_normalize(v3_cross((v3){0.05f, 1.0f, 0.0f}, forward));
    return (sdf_frame){{-0.004f, 0.933f, 0.014f}, side, v3_cross(forward, side), forward};
}

static v3x at(v3x q, float x, float y, float z) { return v3x_sub(q, v3x_splat((v3){x, y, z})); }

/* One half serves both: m is q with |x|. */
static f32x face(v3x q, v3x m)
{
    f32x d = sdf_ellipsoid(at(q, 0.0f, 0.25f, -0.13f), (v3){0.69f, 0.74f, 0.85f});
    d = sdf_smooth_union(d, sdf_ellipsoid(at(q, 0.0f, -0.22f, 0.15f), (v3){0.53f, 0.77f, 0.60f}), 0.15f);
    f32x jaw = sdf_round_cone(m, (v3){0.06f, -0.83f, 0.50f}, (v3){0.44f, -0.42f, -0.02f}, 0.155f, 0.14f);
    d = sdf_smooth_union(d, jaw, 0.16f);
    d = sdf_smooth_union(d, sdf_sphere(at(m, 0.33f, -0.16f, 0.46f), 0.20f), 0.15f); /* cheekbone */
    d = sdf_smooth_union(d, sdf_sphere(at(q, 0.0f, -0.56f, 0.52f), 0.27f), 0.12f);  /* mouth's mound */
    d = sdf_smooth_union(d, sdf_round_cone(m, (v3){0.06f, 0.17f, 0.71f}, (v3){0.42f, 0.21f, 0.50f}, 0.09f, 0.08f),
                         0.09f); /* brow */
    d = sdf_smooth_subtract(d, sdf_ellipsoid(at(m, 0.285f, 0.01f, 0.80f), (v3){0.20f, 0.125f, 0.17f}), 0.13f);
    /* Eyeball between lids. */
    v3x eye = at(m, 0.275f, -0.005f, 0.535f);
    d = f_min(d, sdf_sphere(eye, 0.15f));
    f32x upper = sdf_smooth_intersect(sdf_sphere(eye, 0.178f), 0.045f - eye.y + 0.10f * f_abs(eye.x), 0.02f);
    f32x lower = sdf_smooth_intersect(sdf_sphere(eye, 0.168f), eye.y + 0.075f, 0.02f);
    d = sdf_smooth_union(d, f_min(upper, lower), 0.02f);
    /* Nose: a straight bridge from the brow, as the Greeks liked it. */
    f32x nose = sdf_round_cone(q, (v3){0.0f, 0.20f, 0.725f}, (v3){0.0f, -0.31f, 0.895f}, 0.065f, 0.075f);
    nose = sdf_smooth_union(nose, sdf_sphere(at(m, 0.075f, -0.35f, 0.795f), 0.058f), 0.05f);
    d = sdf_smooth_union(d, nose, 0.07f);
    /* Lips. */
    f32x lips = sdf_round_cone(m, (v3){0.03f, -0.565f, 0.765f}, (v3){0.20f, -0.60f, 0.665f}, 0.052f, 0.025f);
    lips = sdf_smooth_union(
        lips, sdf_round_cone(m, (v3){0.0f, -0.672f, 0.745f}, (v3){0.15f, -0.64f, 0.68f}, 0.062f, 0.03f), 0.012f);
    d = sdf_smooth_union(d, lips, 0.035f);
    d = sdf_smooth_subtract(d, sdf_capsule(m, (v3){0.0f, -0.615f, 0.83f}, (v3){0.20f, -0.61f, 0.715f}, 0.018f), 0.03f);
    return d;
}

/* Waved hair from a middle parting, drawn back over the ears to a knot, with a rolled edge round the face and a band.
 */
static f32x hair(v3x q)
{
    f32x edge = q.y * 0.74f - q.z * 0.67f; /* above 0.02: hair; the plane runs from the forehead to below the ears */
    f32x strand = f_atan2(q.x, q.y + 0.05f);
    f32x wave = 0.5f * f_sin(q.z * 8.0f + 1.5f * f_abs(strand)) + 0.25f * f_sin(q.y * 9.0f);
    f32x locks = sdf_smooth_abs(f_sin(f_abs(strand) * 7.5f + wave + 0.2f), 0.15f);
    f32x roll = f_max(1.0f - f_abs(edge - 0.10f) * 7.0f, f_set(0.0f));
    f32x curls = 0.5f + 0.5f * f_sin(f_abs(strand) * 13.0f + q.z * 3.0f);
    f32x d = sdf_ellipsoid(at(q, 0.0f, 0.31f, -0.17f), (v3){0.755f, 0.765f, 0.90f});
    d = sdf_smooth_union(d, sdf_ellipsoid(at(q, 0.0f, -0.22f, -0.42f), (v3){0.47f, 0.40f, 0.42f}), 0.15f);
    d = d - 0.055f * locks * f_smoothstep(f_set(0.02f), f_set(0.22f), edge) - roll * roll * (0.05f + 0.06f * curls);
    d = sdf_smooth_intersect(d, 0.02f - edge, 0.16f);
    f32x band = sdf_smooth_intersect(sdf_ellipsoid(at(q, 0.0f, 0.31f, -0.17f), (v3){0.755f, 0.765f, 0.90f}) - 0.085f,
                                     f_abs(edge - 0.34f) - 0.055f, 0.05f);
    d = f_min(d, band);
    v3x k = at(q, 0.0f, 0.02f, -1.10f);
    f32x turn = f_atan2(k.x, k.y);
    f32x around = f_sqrt(k.x * k.x + k.y * k.y);
    f32x knot = sdf_ellipsoid(k, (v3){0.37f, 0.37f, 0.33f}) -
                0.045f * sdf_smooth_abs(f_sin(1.5f * turn + around * 12.0f), 0.15f);
    return sdf_smooth_union(d, knot, 0.05f);
}

f32x statue_head(v3x p)
{
    sdf_frame frame = head_frame();
    v3x q = v3x_scale(sdf_to_frame(p, &frame), f_set(1.0f / HEAD_UNIT));
    v3x m = {f_abs(q.x), q.y, q.z};
    f32x d = sdf_smooth_union(face(q, m), hair(q) * 0.8f, 0.03f);
    return d * (0.85f * HEAD_UNIT);
}
