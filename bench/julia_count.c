/* How many floating-point operations julia takes: one pixel in 64 is followed at one lane with the scene's own
 * functions, and every evaluation of the distance is counted. Lanes that wait for their neighbours count for nothing,
 * nor do the environment look-ups and what little arithmetic is outside the loops: a lower bound. */
#include "bench/julia.h"

#include <ambiance/march.h>

enum {
    EVALUATION = 31, /* operations of julia_distance outside its loop, */
    PAIR = 26,       /* in a turn of it, */
    STEP = 14,       /* and around it in a march */
    GRADIENT = 62,   /* in a turn of julia_surface_at */
    SPACING = 8,     /* pixels from one that is followed to the next */
};

typedef struct counter {
    const julia_set *set;
    double flops;
} counter;

/* Turns of the orbit before it escapes, in steps of `step`. */
static int turns(const julia_set *set, v3x p, int step)
{
    julia_orbit orbit = julia_orbit_from(p, set);
    int i = 0;
    while (i < set->iterations && julia_bounded(&orbit)) {
        for (int k = 0; k < step; k++)
            orbit.z = julia_step(orbit.z, set);
        i += step;
    }
    return i / step;
}

static float counted_distance(v3x p, const void *user)
{
    counter *c = (counter *)(uintptr_t)user;
    c->flops += EVALUATION + PAIR * turns(c->set, p, 2) + STEP;
    return julia_distance(p, c->set);
}

static v3x eye_ray(const amb_camera *c, float x, float y)
{
    v3 d = v3_normalize(v3_add(c->ray_origin, v3_add(v3_scale(c->ray_dx, x), v3_scale(c->ray_dy, y))));
    return (v3x){d.x, d.y, d.z};
}

/* Where the rays of the tile that holds pixel (x, y) start, given where its cone does. */
static float tile_start(counter *c, const amb_camera *camera, int x, int y, int tile, float t0, float t1)
{
    float left = (float)(x / tile * tile), top = (float)(y / tile * tile), size = (float)tile, radius = 0.0f;
    v3x center = eye_ray(camera, left + 0.5f * size, top + 0.5f * size);
    for (int k = 0; k < 4; k++)
        radius = f_max(
            radius,
            v3x_length(v3x_sub(eye_ray(camera, left + (float)(k & 1) * size, top + (float)(k >> 1) * size), center)));
    return amb_march_cone(counted_distance, c, v3x_splat(camera->position), center, t0, t1, radius, 1e-5f, 64, 1);
}

/* The light's march and the three samples of openness at a hit, and its normal. */
static void count_shading(counter *c, const julia_twin *twin, v3x position, float off, v3 to_light)
{
    static const float reach[3] = {0.04f, 0.12f, 0.3f};
    julia_surface s = julia_surface_at(position, c->set);
    c->flops += GRADIENT * turns(c->set, position, 1);
    for (int i = 0; i < 3; i++)
        counted_distance(v3x_add(position, v3x_scale(s.normal, reach[i])), c);
    if (v3x_dot(s.normal, v3x_splat(to_light)) <= 0.0f)
        return;
    v3x from = v3x_add(position, v3x_scale(s.normal, off));
    float t = off, clear = 1.0f;
    for (int i = 0; i < 16; i++) {
        v3x p = v3x_add(from, v3x_scale(v3x_splat(to_light), t));
        float d = counted_distance(p, c);
        clear = f_min(d * 16.0f / t, clear);
        t += f_clamp(d * AMB_MARCH_STRIDE, off, 0.25f);
        if (clear <= 0.02f || v3x_dot(p, p) >= twin->set.radius * twin->set.radius)
            break;
    }
}

double julia_count_flops(const julia_twin *twin, amb_march_limits limits, v3 to_light)
{
    const amb_camera *camera = &twin->camera;
    counter pixels = {&twin->set, 0.0}, cones = {&twin->set, 0.0};
    float far = v3_length(camera->position), near = f_max(far - twin->set.radius, 0.0f);
    for (int y = SPACING / 2; y < twin->height; y += SPACING)
        for (int x = SPACING / 2; x < twin->width; x += SPACING) {
            v3x eye = v3x_splat(camera->position), direction = eye_ray(camera, (float)x + 0.5f, (float)y + 0.5f);
            float half = v3x_dot(eye, direction), root = half * half - far * far + twin->set.radius * twin->set.radius;
            float start = tile_start(&cones, camera, x, y, JULIA_COARSE_TILE, near, far + twin->set.radius);
            double coarse = cones.flops;
            start = tile_start(&cones, camera, x, y, JULIA_TILE, start, far + twin->set.radius);
            /* a tile's cone serves all its pixels */
            pixels.flops +=
                coarse / (JULIA_COARSE_TILE * JULIA_COARSE_TILE) + (cones.flops - coarse) / (JULIA_TILE * JULIA_TILE);
            cones.flops = 0.0;
            if (root < 0.0f)
                continue;
            amb_marched m = amb_march(counted_distance, &pixels, eye, direction, f_max(-half - f_sqrt(root), start),
                                      -half + f_sqrt(root), &limits, 1);
            if (m.hit & 1)
                count_shading(&pixels, twin, v3x_add(eye, v3x_scale(direction, m.t)), m.t * (limits.footprint * 4.0f),
                              to_light);
        }
    return pixels.flops * SPACING * SPACING;
}
