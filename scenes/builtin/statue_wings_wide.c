/* The wings: both are one, mirrored. In the wing's plane every feather is a blade with a sloping upper side; the wing
 * is their union, the same on its front and back. */
#include "scenes/builtin/statue.h"

/* Plane distance and height of one feather at (u, v, |w|). */
static f32x feather_distance(const statue_feather *f, f32x u, f32x v, f32x w)
{
    f32x du = u - f->u, dv = v - f->v;
    f32x along = du * f->along_u + dv * f->along_v, across = dv * f->along_u - du * f->along_v;
    f32x t = f_saturate(along * (1.0f / f->length));
    across = across - f->bend * (t * t);
    f32x half = f->root + (f->tip - f->root) * t + f->bulge * (t * (1.0f - t));
    f32x past = along - t * f->length;
    f32x outline = f_sqrt(across * across + past * past) - half;
    /* The shaft stands out as a ridge; the vane slopes to one side and thins towards the tip. */
    f32x shaft = f_max(1.0f - across * across * 90000.0f, f_set(0.0f));
    f32x ridge = 0.0016f * shaft * shaft * (1.0f - t);
    f32x rise = f_saturate(along * 40.0f + 0.3f);
    f32x top = f->height * (0.45f + 0.55f * rise - 0.3f * t) + f->tilt * across + ridge;
    top = f_max(top, f_set(0.0034f));
    const float round = 0.0022f;
    return sdf_corner(outline + round, w - top + round) - round;
}

f32x statue_wings(const statue_model *model, v3x p)
{
    /* Plane of the wing: turned back by 38 degrees about the vertical, cupped forward at its end. */
    f32x x = f_abs(p.x) - 0.022f, y = p.y - 0.775f + p.x * 0.06f, z = p.z + 0.052f;
    const float c = 0.788f, s = 0.616f;
    f32x u = x * c - z * s, w = x * s + z * c;
    w = w - 0.55f * u * u + 0.25f * y * f_abs(y);
    w = f_abs(w);
    /* The arm of the wing: shoulder, wrist, finger. */
    v3x q = {u, y, w};
    sdf_curve inner = sdf_bezier(q, (v3){-0.01f, -0.03f, 0.0f}, (v3){0.015f, 0.19f, 0.0f}, (v3){0.15f, 0.265f, 0.0f});
    sdf_curve outer = sdf_bezier(q, (v3){0.15f, 0.265f, 0.0f}, (v3){0.245f, 0.32f, 0.0f}, (v3){0.315f, 0.215f, 0.0f});
    f32x d = inner.distance - (0.021f - 0.004f * inner.t);
    d = sdf_smooth_union(d, outer.distance - (0.017f - 0.009f * outer.t), 0.02f);
    for (int i = 0; i < model->feather_count; i++) {
        const statue_feather *f = &model->feather[i];
        f32x du = u - f->center_u, dv = y - f->center_v, reach = f_max(d + f->reach, f_set(0.0f));
        maskx near = (du * du + dv * dv) + w * w < reach * reach;
        if (m_any(near))
            d = f_sel(near, sdf_smooth_union(d, feather_distance(f, u, y, w), 0.005f), d);
    }
    return d * 0.8f;
}
