/* Lists of rays through the lanes queries, for test_rays.c: packet by packet, the last one with dead lanes. */
#include "tests/rays_lists.h"

#if AMB_LANES > 1
static void load(const listed_ray *ray, int count, int first, amb_rayx *out, maskx *live)
{
    float f[8][AMB_LANES] = {{0}};
    uint32_t bits = 0;
    for (int i = 0; i < AMB_LANES && first + i < count; i++) {
        const listed_ray *r = &ray[first + i];
        const float values[8] = {r->origin.x,    r->origin.y,    r->origin.z, r->direction.x,
                                 r->direction.y, r->direction.z, r->t_near,   r->t_far};
        for (int k = 0; k < 8; k++)
            f[k][i] = values[k];
        bits |= r->dead ? 0u : 1u << i;
    }
    *out = (amb_rayx){{f_load(f[0]), f_load(f[1]), f_load(f[2])},
                      {f_load(f[3]), f_load(f[4]), f_load(f[5])},
                      f_load(f[6]),
                      f_load(f[7])};
    *live = m_from_bits(bits);
}

void WIDE(trace_list)(const amb_rays *rays, const listed_ray *ray, int count, listed_hit *hit)
{
    for (int first = 0; first < count; first += AMB_LANES) {
        amb_rayx packet;
        maskx live;
        amb_hitx h;
        load(ray, count, first, &packet, &live);
        amb_rays_closest(rays, &packet, live, &h);
        maskx occluded = amb_rays_occluded(rays, &packet, live);
        for (int i = 0; i < AMB_LANES && first + i < count; i++)
            hit[first + i] = (listed_hit){m_lane(h.hit, i),      m_lane(occluded, i),   f_lane(h.t, i),
                                          f_lane(h.u, i),        f_lane(h.v, i),        f_lane(h.t_exit, i),
                                          v3x_lane(h.normal, i), i_lane(h.geometry, i), i_lane(h.primitive, i)};
    }
}
#endif
