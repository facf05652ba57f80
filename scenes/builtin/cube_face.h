/* Cube map faces in D3D's order and orientation, lanes forms. */
#ifndef AMB_SCENES_CUBE_FACE_H
#define AMB_SCENES_CUBE_FACE_H

#include <ambiance/vec.h>

/* Unit direction through (s, t) of a face, both -1…1 with t down. */
AMB_INLINE v3x cube_face_direction(int face, f32x s, f32x t)
{
    f32x one = f_set(1.0f);
    v3x direction = face == 0   ? (v3x){one, -t, -s}
                    : face == 1 ? (v3x){-one, -t, s}
                    : face == 2 ? (v3x){s, one, t}
                    : face == 3 ? (v3x){s, -one, -t}
                    : face == 4 ? (v3x){s, -t, one}
                                : (v3x){-s, -t, -one};
    return v3x_normalize(direction);
}

/* Pixels (texel centres at .5) as a face coordinate -1…1. */
AMB_INLINE f32x cube_face_coordinate(f32x x, int size) { return x * (2.0f / (float)size) - 1.0f; }

#endif
