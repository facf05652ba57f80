#include "scenes/builtin/statue.h"

#include <ambiance/isosurface.h>

#define JOIN(d, part, center, radius, k)                        \
    do {                                                        \
        maskx near = statue_near(d, p, center, (radius) + (k)); \
        if (m_any(near))                                        \
            d = f_sel(near, sdf_smooth_union(d, part, k), d);   \
    } while (0)

f32x statue_field(const void *user, v3x p)
{
    const statue_model *model = user;
    f32x d = statue_base(p);
    JOIN(d, statue_dress(p), ((v3){0.0f, 0.40f, 0.0f}), 0.52f, 0.004f);
    JOIN(d, statue_torso(p), ((v3){0.0f, 0.77f, 0.0f}), 0.15f, 0.003f);
    JOIN(d, statue_head(p), ((v3){0.0f, 0.93f, 0.0f}), 0.13f, 0.006f);
    JOIN(d, statue_right_arm(p), ((v3){-0.15f, 1.02f, 0.03f}), 0.30f, 0.006f);
    JOIN(d, statue_left_arm(p), ((v3){0.14f, 0.65f, 0.0f}), 0.25f, 0.006f);
    JOIN(d, statue_wings(model, p), ((v3){0.0f, 0.66f, -0.20f}), 0.70f, 0.006f);
    return d;
}

void WIDE(amb_statue_desc)(amb_isosurface_desc *desc);
void WIDE(amb_statue_desc)(amb_isosurface_desc *desc)
{
    desc->lanes = AMB_LANES;
    desc->field = statue_field;
}
