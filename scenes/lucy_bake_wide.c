/* Ambient occlusion: every point looks along the same directions, evenly spread over the sphere, so that neighbours
 * agree and no noise shows. */
#include "scenes/lucy.h"

void lucy_bake_chunk(void *user, int chunk, int thread);

static v3x load_points(const v3 *from, i32x index) { return v3x_gather(from, index); }

/* Lanes whose ray meets the floor within reach. */
static maskx floor_blocks(const lucy_bake *bake, v3x p, v3 direction)
{
    if (!bake->above_floor || direction.y >= -1e-4f)
        return m_set(false);
    return p.y * (-1.0f / direction.y) < bake->reach;
}

void lucy_bake_chunk(void *user, int chunk, int thread)
{
    (void)thread;
    const lucy_bake *bake = user;
    uint32_t first = (uint32_t)chunk * LUCY_BAKE_CHUNK;
    uint32_t end = bake->count - first < LUCY_BAKE_CHUNK ? bake->count : first + LUCY_BAKE_CHUNK;
    for (uint32_t i = first; i < end; i += AMB_LANES) {
        i32x index = i_min(i_lane_index() + (int32_t)i, i_set((int32_t)end - 1));
        v3x p = load_points(bake->position, index), n = load_points(bake->normal, index);
        v3x open = v3x_splat((v3){0.0f, 0.0f, 0.0f});
        f32x seen = f_set(0.0f), all = f_set(0.0f);
        amb_rayx ray = {
            .origin = v3x_add(p, v3x_scale(n, f_set(2e-3f))), .t_near = f_set(1e-4f), .t_far = f_set(bake->reach)};
        for (int k = 0; k < LUCY_DIRECTIONS; k++) {
            ray.direction = v3x_splat(bake->direction[k]);
            f32x weight = f_max(v3x_dot(n, ray.direction), f_set(0.0f));
            all += weight;
            maskx free = (weight > 0.0f) & ~floor_blocks(bake, p, bake->direction[k]);
            if (m_any(free))
                free &= ~amb_rays_occluded(bake->rays, &ray, free);
            weight = f_sel(free, weight, f_set(0.0f));
            seen += weight;
            open = v3x_add(open, v3x_scale(ray.direction, weight));
        }
        f32x visibility = seen / f_max(all, f_set(1e-6f));
        open = v3x_sel(seen > 0.0f, open, n);
        for (int lane = 0; lane < AMB_LANES && i + (uint32_t)lane < end; lane++)
            bake->out[i + (uint32_t)lane] = (lucy_point){v3x_lane(open, lane), f_lane(visibility, lane)};
    }
}
