/* Arms and what they hold: a torch, raised in her right hand; a laurel wreath in her left. */
#include "scenes/builtin/statue.h"

/* The frame of a closed hand: y along the held rod, z from the rod towards the wrist. */
static sdf_frame grip_frame(v3 grip, v3 rod, v3 wrist)
{
    v3 y = v3_normalize(rod), to = v3_sub(wrist, grip);
    v3 z = v3_normalize(v3_sub(to, v3_scale(y, v3_dot(to, y))));
    return (sdf_frame){grip, v3_cross(y, z), y, z};
}

/* Four fingers around the rod, the palm on its near side and the thumb across. `side` is ±1: where the thumb lies. */
static f32x closed_hand(v3x q, float side)
{
    f32x d = sdf_ellipsoid(v3x_sub(q, v3x_splat((v3){side * 0.004f, 0.0f, 0.0135f})), (v3){0.0135f, 0.0205f, 0.0105f});
    d = f_min(d,
              sdf_capsule(q, (v3){0.0f, -0.012f, 0.002f}, (v3){0.0f, 0.012f, 0.002f}, 0.0135f)); /* no hollow inside */
    for (int i = 0; i < 4; i++) {
        float height = 0.0135f - 0.0088f * (float)i, length = i == 3 ? 0.0048f : 0.0054f;
        v3x finger = {q.x, q.y - height, q.z};
        d = sdf_smooth_union(d, sdf_torus(finger, i == 0 || i == 3 ? 0.0132f : 0.0140f, length), 0.0022f);
    }
    f32x thumb = sdf_round_cone(q, (v3){side * -0.008f, 0.004f, 0.020f}, (v3){side * -0.0185f, 0.0185f, -0.002f},
                                0.0065f, 0.0052f);
    return sdf_smooth_union(d, thumb, 0.004f);
}

/* Shoulder to wrist with the muscles' swelling. */
static f32x arm(v3x p, v3 shoulder, v3 elbow, v3 wrist)
{
    v3 belly = v3_lerp(shoulder, elbow, 0.45f), fore = v3_lerp(elbow, wrist, 0.27f);
    f32x d = sdf_round_cone(p, shoulder, belly, 0.030f, 0.0255f);
    d = sdf_smooth_union(d, sdf_round_cone(p, belly, elbow, 0.0255f, 0.0195f), 0.012f);
    d = sdf_smooth_union(d, sdf_round_cone(p, elbow, fore, 0.0195f, 0.0225f), 0.012f);
    return sdf_smooth_union(d, sdf_round_cone(p, fore, wrist, 0.0225f, 0.0140f), 0.012f);
}

/* A ring of square section around the segment's direction at `center`. */
static f32x bangle(v3x p, v3 center, v3 axis, float radius, float half)
{
    v3 y = v3_normalize(axis);
    v3x q = v3x_sub(p, v3x_splat(center));
    f32x along = v3x_dot(q, v3x_splat(y));
    f32x radial = f_sqrt(f_max(v3x_dot(q, q) - along * along, f_set(0.0f)));
    return sdf_corner(radial - radius, f_abs(along) - half) - 0.003f;
}

/* Along y from the pommel at -0.075 to the bowl's rim at 0.105, then flames. */
static f32x torch(v3x q)
{
    f32x radial = f_sqrt(q.x * q.x + q.z * q.z), angle = f_atan2(q.x, q.z);
    f32x d = sdf_round_cone(q, (v3){0.0f, -0.07f, 0.0f}, (v3){0.0f, 0.075f, 0.0f}, 0.0072f, 0.0105f);
    d = d - 0.0008f * f_sin(angle * 8.0f);
    d = f_min(d, sdf_ellipsoid(v3x_sub(q, v3x_splat((v3){0.0f, -0.078f, 0.0f})), (v3){0.0105f, 0.0085f, 0.0105f}));
    d = f_min(d, sdf_torus(v3x_sub(q, v3x_splat((v3){0.0f, 0.048f, 0.0f})), 0.0105f, 0.004f));
    f32x t = f_saturate((q.y - 0.06f) * (1.0f / 0.045f));
    f32x bowl = sdf_corner(radial - (0.010f + 0.017f * t * (2.0f - t)), f_abs(q.y - 0.0825f) - 0.0225f) - 0.001f;
    d = sdf_smooth_union(d, bowl * 0.8f, 0.003f);
    d = f_min(d, sdf_torus(v3x_sub(q, v3x_splat((v3){0.0f, 0.106f, 0.0f})), 0.0265f, 0.0042f));
    static const v3 root[5] = {{0, 0.105f, 0},
                               {0.010f, 0.105f, 0.006f},
                               {-0.011f, 0.105f, 0.004f},
                               {0.002f, 0.105f, -0.012f},
                               {0.001f, 0.105f, 0.013f}};
    static const v3 lean[5] = {{0.022f, 0.15f, 0.008f},
                               {0.034f, 0.13f, 0.014f},
                               {-0.034f, 0.135f, 0.004f},
                               {0.0f, 0.14f, -0.034f},
                               {-0.008f, 0.13f, 0.034f}};
    static const v3 tip[5] = {{-0.004f, 0.222f, -0.004f},
                              {0.013f, 0.185f, 0.006f},
                              {-0.014f, 0.178f, 0.010f},
                              {0.010f, 0.172f, -0.014f},
                              {0.006f, 0.160f, 0.016f}};
    f32x flame = f_set(1.0f);
    for (int i = 0; i < 5; i++) {
        sdf_curve c = sdf_bezier(q, root[i], lean[i], tip[i]);
        f32x thick = (1.0f - c.t) * (0.0135f + 0.014f * c.t) + 0.0012f;
        flame = sdf_smooth_union(flame, c.distance - thick * (i == 0 ? 1.15f : 1.0f), 0.006f);
    }
    return sdf_smooth_union(d, flame * 0.9f, 0.003f);
}

#define WREATH_LEAVES 17

/* Two rows of leaves along a ring of radius 0.05 in the xy plane, open at the bottom where the tips meet. */
static f32x wreath(v3x q)
{
    const float sector = AMB_TWO_PI / WREATH_LEAVES;
    f32x d = sdf_torus((v3x){q.x, q.z, q.y}, 0.05f, 0.0042f);
    f32x angle = f_atan2(q.x, q.y), nearest = f_round(angle * (1.0f / sector));
    for (int neighbour = -1; neighbour <= 1; neighbour++) {
        f32x turn = (nearest + (float)neighbour) * sector;
        f32x s = f_sin(turn), c = f_cos(turn);
        f32x radial = q.x * s + q.y * c - 0.05f, tangent = q.x * c - q.y * s;
        for (int row = -1; row <= 1; row += 2) {
            /* A leaf points along the ring and leans out of it. */
            f32x lean = radial * (float)row - 0.0075f, along = tangent - 0.006f;
            v3x leaf = {along * 0.87f + lean * 0.5f, lean * 0.87f - along * 0.5f, q.z - 0.0025f * (float)row};
            d = f_min(d, sdf_ellipsoid(leaf, (v3){0.0150f, 0.0062f, 0.0036f}));
        }
    }
    return d * 0.8f;
}

f32x statue_right_arm(v3x p)
{
    const v3 shoulder = {-0.089f, 0.814f, -0.010f}, elbow = {-0.196f, 0.905f, 0.026f},
             wrist = {-0.174f, 1.034f, 0.056f};
    const v3 grip = {-0.171f, 1.062f, 0.080f}, rod = {-0.16f, 0.96f, 0.02f};
    f32x d =
        sdf_smooth_union(arm(p, shoulder, elbow, wrist), sdf_sphere(v3x_sub(p, v3x_splat(shoulder)), 0.031f), 0.015f);
    sdf_frame frame = grip_frame(grip, rod, wrist);
    v3x q = sdf_to_frame(p, &frame);
    d = sdf_smooth_union(d, sdf_round_cone(p, wrist, v3_add(grip, v3_scale(frame.z, 0.012f)), 0.0140f, 0.0135f), 0.01f);
    d = sdf_smooth_union(d, closed_hand(q, 1.0f), 0.004f);
    d = f_min(d, bangle(p, v3_lerp(elbow, wrist, 0.82f), v3_sub(wrist, elbow), 0.0165f, 0.003f));
    return f_min(d, torch(q));
}

f32x statue_left_arm(v3x p)
{
    const v3 shoulder = {0.087f, 0.803f, -0.010f}, elbow = {0.143f, 0.668f, -0.034f}, wrist = {0.176f, 0.566f, 0.044f};
    const v3 grip = {0.186f, 0.535f, 0.062f}, rod = {0.90f, 0.10f, -0.42f};
    f32x d =
        sdf_smooth_union(arm(p, shoulder, elbow, wrist), sdf_sphere(v3x_sub(p, v3x_splat(shoulder)), 0.030f), 0.015f);
    sdf_frame frame = grip_frame(grip, rod, wrist);
    v3x q = sdf_to_frame(p, &frame);
    d = sdf_smooth_union(d, sdf_round_cone(p, wrist, v3_add(grip, v3_scale(frame.z, 0.012f)), 0.0140f, 0.0135f), 0.01f);
    d = sdf_smooth_union(d, closed_hand(q, -1.0f), 0.004f);
    d = f_min(d, bangle(p, v3_lerp(shoulder, elbow, 0.52f), v3_sub(elbow, shoulder), 0.0255f, 0.003f));
    /* The wreath hangs from the hand: its top lies in the grip. */
    return f_min(d, wreath((v3x){q.y, q.z + 0.05f, q.x}));
}
