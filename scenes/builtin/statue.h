/* The built-in statue: a winged Victory of our own design, as a signed distance field in parts.
 *
 * World units: the figure is about 1 tall from the plinth's top at y = 0, y up, facing +z; her right side is -x. */
#ifndef AMB_SCENES_BUILTIN_STATUE_H
#define AMB_SCENES_BUILTIN_STATUE_H

#include <ambiance/sdf.h>

#define STATUE_MAX_FEATHERS 200

/* In the wing's plane (u outwards, v up), the quill at (u, v), the blade along (along_u, along_v). */
typedef struct statue_feather {
    float u, v, along_u, along_v;
    float length, root, tip, bulge;  /* half widths at both ends; how much wider the middle is */
    float bend;                      /* sideways drift of the tip */
    float height, tilt;              /* of the upper side over the wing's middle plane, and its slope across */
    float center_u, center_v, reach; /* bounding circle */
} statue_feather;

typedef struct statue_model {
    statue_feather feather[STATUE_MAX_FEATHERS]; /* longest rows first */
    int feather_count;
} statue_model;

void statue_model_make(statue_model *model);

/* The whole, and its parts; user is a statue_model. */
#define statue_field WIDE(amb_statue_field)
f32x statue_field(const void *user, v3x p);
#define statue_wings WIDE(amb_statue_wings)
f32x statue_wings(const statue_model *model, v3x p);
#define statue_dress WIDE(amb_statue_dress)
f32x statue_dress(v3x p);
#define statue_torso WIDE(amb_statue_torso)
f32x statue_torso(v3x p);
#define statue_head WIDE(amb_statue_head)
f32x statue_head(v3x p);
#define statue_right_arm WIDE(amb_statue_right_arm)
f32x statue_right_arm(v3x p);
#define statue_left_arm WIDE(amb_statue_left_arm)
f32x statue_left_arm(v3x p);
#define statue_base WIDE(amb_statue_base)
f32x statue_base(v3x p);

/* Lanes where something inside the ball (center, radius) can change d, when blended over k. Parts are left out lane by
 * lane with this mask, so that a lane's value never depends on its neighbours. */
AMB_INLINE maskx statue_near(f32x d, v3x p, v3 center, float radius)
{
    v3x q = v3x_sub(p, v3x_splat(center));
    f32x reach = f_max(d + radius, f_set(0.0f));
    return v3x_dot(q, q) < reach * reach;
}

#endif
