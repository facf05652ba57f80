/* Cameras on three Catmull-Rom splines (position, target, up): pass through every key, continuous tangents. */
#ifndef AMBIANCE_CAMERA_H
#define AMBIANCE_CAMERA_H

#include <ambiance/vec.h>
#include <stddef.h>

typedef struct amb_spline_key {
    float time;
    v3 value;
} amb_spline_key; /* seconds, increasing */

/* Non-uniform Catmull-Rom through the keys; constant before the first and after the last. count ≥ 1. Pure. */
v3 amb_spline_at(const amb_spline_key *key, size_t count, float time);
v3 amb_spline_tangent(const amb_spline_key *key, size_t count, float time); /* d value / d second */

typedef struct amb_camera_key {
    float time;
    v3 position, target, up;
} amb_camera_key;

typedef struct amb_camera {
    v3 position, target, up; /* up orthonormal to the view */
    float vertical_fov;      /* radians */
    float near, far;         /* world units */
    m4 world_to_view, view_to_clip, world_to_clip;
    /* Primary ray of window coordinates (x, y): direction = ray_origin + x·ray_dx + y·ray_dy (not unit: view depth 1).
     */
    v3 ray_origin, ray_dx, ray_dy;
} amb_camera;

/* The camera at `time` for a width × height window. Position, target and up come from three splines. */
amb_camera amb_camera_at(const amb_camera_key *key, size_t count, float time, float vertical_fov, float near, float far,
                         int width, int height);
amb_camera amb_camera_look(v3 position, v3 target, v3 up, float vertical_fov, float near, float far, int width,
                           int height);
/* Depth 0…1 of a point at view distance z (along the view axis): what the rasterizer's depth buffer holds. */
AMB_INLINE f32x amb_camera_depth_x(const amb_camera *c, f32x z)
{
    return (c->view_to_clip.row[2].z * -z + c->view_to_clip.row[2].w) / z;
}

#endif
