/* The intersectors that Embree calls back: closest and any hit over clusters of triangles and over balls.
 *
 * Triangles: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, without its double
 * precision step: the float edge functions never have the wrong sign (rounding is monotonic) and zero counts for both
 * sides, so no ray slips between triangles that share vertices.
 *
 * Every value is computed per (ray, primitive) by one order of IEEE operations, whether lanes run over rays or over the
 * triangles of a cluster. */
#include "march/rays_lanes.h"

/* ---- the arithmetic ---------------------------------------------------------------------------------------------- */

/* A ray ready for Woop's test with its axes already permuted: z is the direction's largest. */
typedef struct woop {
    f32x ox, oy, oz, sx, sy, sz;
} woop;
typedef struct woop_hit {
    f32x t, v, w, det;
} woop_hit; /* v/det and w/det weigh the 2nd and 3rd vertex */

AMB_INLINE maskx woop_test(const woop *r, v3x a, v3x b, v3x c, woop_hit *out)
{
    f32x az = a.z - r->oz, bz = b.z - r->oz, cz = c.z - r->oz;
    f32x ax = (a.x - r->ox) - r->sx * az, ay = (a.y - r->oy) - r->sy * az;
    f32x bx = (b.x - r->ox) - r->sx * bz, by = (b.y - r->oy) - r->sy * bz;
    f32x cx = (c.x - r->ox) - r->sx * cz, cy = (c.y - r->oy) - r->sy * cz;
    f32x u = cx * by - cy * bx;
    f32x v = ax * cy - ay * cx;
    f32x w = bx * ay - by * ax;
    maskx inside = ((u >= 0.0f) & (v >= 0.0f) & (w >= 0.0f)) | ((u <= 0.0f) & (v <= 0.0f) & (w <= 0.0f));
    f32x det = (u + v) + w;
    out->v = v;
    out->w = w;
    out->det = det;
    inside &= det != 0.0f;
    out->t = m_any(inside) ? (((u * az + v * bz) + w * cz) * r->sz) / det : az;
    return inside;
}

/* Interval of t inside a box; empty when enter > exit. inverse is finite. */
AMB_INLINE void slabs(const f32x origin[3], const f32x inverse[3], v3x lo, v3x hi, f32x *enter, f32x *exit)
{
    f32x ax = (lo.x - origin[0]) * inverse[0], bx = (hi.x - origin[0]) * inverse[0];
    f32x ay = (lo.y - origin[1]) * inverse[1], by = (hi.y - origin[1]) * inverse[1];
    f32x az = (lo.z - origin[2]) * inverse[2], bz = (hi.z - origin[2]) * inverse[2];
    *enter = f_max(f_max(f_min(ax, bx), f_min(ay, by)), f_min(az, bz));
    *exit = f_min(f_min(f_max(ax, bx), f_max(ay, by)), f_max(az, bz));
}

/* ---- packets as Embree hands them over --------------------------------------------------------------------------- */

typedef struct packet {
    maskx live;
    f32x origin[3], direction[3], inverse[3], shear[3];
    f32x t_near, t_far, u, v;
    u32x geometry, primitive, slot;
    i32x axis;
} packet;

/* Rays base … base+AMB_LANES-1 of an N-ray packet. The fields are read through float memory of whatever type. */
static void load_any(packet *p, const amb_query *q, const int *valid, const float *ray, uint32_t n, uint32_t base,
                     bool hits)
{
    float f[HIT_GEOMETRY + 1][AMB_LANES] = {{0}}, inverse[3][AMB_LANES] = {{0}}, shear[3][AMB_LANES] = {{0}};
    int32_t live[AMB_LANES] = {0}, axis[AMB_LANES] = {0};
    for (uint32_t i = 0; i < AMB_LANES && base + i < n; i++) {
        for (uint32_t k = 0; k < (hits ? HIT_GEOMETRY + 1u : RAY_FIELDS); k++)
            memcpy(&f[k][i], ray + k * n + base + i, 4);
        uint32_t id;
        memcpy(&id, &f[RAY_ID][i], 4);
        live[i] = valid[base + i];
        axis[i] = q->axis[id];
        for (int k = 0; k < 3; k++) {
            inverse[k][i] = q->inverse[k][id];
            shear[k][i] = q->shear[k][id];
        }
    }
    p->live = i_load(live) != 0;
    p->axis = i_load(axis);
    for (int k = 0; k < 3; k++) {
        p->origin[k] = f_load(f[RAY_ORIGIN + k]);
        p->direction[k] = f_load(f[RAY_DIRECTION + k]);
        p->inverse[k] = f_load(inverse[k]);
        p->shear[k] = f_load(shear[k]);
    }
    p->t_near = f_load(f[RAY_NEAR]);
    p->t_far = f_load(f[RAY_FAR]);
    p->u = f_load(f[HIT_U]);
    p->v = f_load(f[HIT_V]);
    p->primitive = u_load(f[HIT_PRIMITIVE]);
    p->geometry = u_load(f[HIT_GEOMETRY]);
    p->slot = u_load(f[HIT_NORMAL]);
}

/* The usual case: the packet is one query's own. */
AMB_INLINE void load_own(packet *p, const amb_query *q, const int *valid, const float *ray, bool hits)
{
    p->live = i_load(valid) != 0;
    p->axis = i_load(q->axis);
    for (int k = 0; k < 3; k++) {
        p->origin[k] = f_load(ray + (RAY_ORIGIN + k) * AMB_LANES);
        p->direction[k] = f_load(ray + (RAY_DIRECTION + k) * AMB_LANES);
        p->inverse[k] = f_load(q->inverse[k]);
        p->shear[k] = f_load(q->shear[k]);
    }
    p->t_near = f_load(ray + RAY_NEAR * AMB_LANES);
    p->t_far = f_load(ray + RAY_FAR * AMB_LANES);
    if (!hits)
        return;
    p->u = f_load(ray + HIT_U * AMB_LANES);
    p->v = f_load(ray + HIT_V * AMB_LANES);
    p->primitive = u_load(ray + HIT_PRIMITIVE * AMB_LANES);
    p->geometry = u_load(ray + HIT_GEOMETRY * AMB_LANES);
    p->slot = u_load(ray + HIT_NORMAL * AMB_LANES);
}

static void store_any(const packet *p, maskx changed, float *ray, uint32_t n, uint32_t base, bool hits)
{
    uint32_t bits = m_bits(changed);
    for (int i = 0; i < AMB_LANES && base + (uint32_t)i < n; i++) {
        if (!(bits >> i & 1u))
            continue;
        float *r = ray + base + i;
        r[RAY_FAR * n] = f_lane(p->t_far, i);
        if (!hits)
            continue;
        uint32_t geometry = u_lane(p->geometry, i), primitive = u_lane(p->primitive, i), slot = u_lane(p->slot, i);
        r[HIT_U * n] = f_lane(p->u, i);
        r[HIT_V * n] = f_lane(p->v, i);
        memcpy(r + HIT_PRIMITIVE * n, &primitive, 4);
        memcpy(r + HIT_GEOMETRY * n, &geometry, 4);
        memcpy(r + HIT_NORMAL * n, &slot, 4);
    }
}

AMB_INLINE void store_own(const packet *p, float *ray, bool hits)
{
    f_store(ray + RAY_FAR * AMB_LANES, p->t_far);
    if (!hits)
        return;
    f_store(ray + HIT_U * AMB_LANES, p->u);
    f_store(ray + HIT_V * AMB_LANES, p->v);
    memcpy(ray + HIT_PRIMITIVE * AMB_LANES, &p->primitive, sizeof p->primitive);
    memcpy(ray + HIT_GEOMETRY * AMB_LANES, &p->geometry, sizeof p->geometry);
    memcpy(ray + HIT_NORMAL * AMB_LANES, &p->slot, sizeof p->slot);
}

/* ---- clusters ---------------------------------------------------------------------------------------------------- */

/* Nearer than the packet's hit so far, or as near and earlier in (geometry, primitive). */
AMB_INLINE maskx wins(const packet *p, f32x t, u32x geometry, u32x primitive)
{
    maskx earlier = (geometry < p->geometry) | ((geometry == p->geometry) & (primitive < p->primitive));
    return (t < p->t_far) | ((t == p->t_far) & earlier);
}

AMB_INLINE maskx in_range(const packet *p, maskx m, f32x t, f32x enter, f32x exit)
{
    return m & (t > p->t_near) & (t <= p->t_far) & (t >= enter) & (t <= exit);
}

/* Lanes are rays; triangles one after another. `group`: rays whose largest axis is z. Returns the lanes with a hit. */
AMB_INLINE maskx rays_by_triangle(packet *p, const amb_cluster *c, int slot, int z, maskx group, f32x enter, f32x exit,
                                  bool any)
{
    int x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    woop ray = {p->origin[x], p->origin[y], p->origin[z], p->shear[0], p->shear[1], p->shear[2]};
    u32x geometry = u_set(c->geometry);
    maskx found = m_set(false);
    for (uint32_t k = 0; k < c->count; k++) {
        v3x corner[3];
        for (int i = 0; i < 3; i++)
            corner[i] = v3x_of(f_set(c->vertex[i][x][k]), f_set(c->vertex[i][y][k]), f_set(c->vertex[i][z][k]));
        woop_hit h;
        maskx hit = woop_test(&ray, corner[0], corner[1], corner[2], &h) & group;
        if (!m_any(hit))
            continue;
        hit = in_range(p, hit, h.t, enter, exit);
        if (any) {
            found |= hit;
            continue;
        }
        u32x primitive = u_set(c->primitive[k]);
        hit &= wins(p, h.t, geometry, primitive);
        if (!m_any(hit))
            continue;
        p->t_far = f_sel(hit, h.t, p->t_far);
        p->u = f_sel(hit, h.v / h.det, p->u);
        p->v = f_sel(hit, h.w / h.det, p->v);
        p->geometry = u_sel(hit, geometry, p->geometry);
        p->primitive = u_sel(hit, primitive, p->primitive);
        p->slot = u_sel(hit, u_set((uint32_t)slot + k), p->slot);
        found |= hit;
    }
    return found;
}

#define CHUNK (AMB_LANES < AMB_CLUSTER ? AMB_LANES : AMB_CLUSTER) /* triangles of a cluster tested at once */

/* AMB_LANES values from one row of a cluster; lanes past the row repeat its last value. */
AMB_INLINE f32x load_row(const float *row)
{
#if AMB_LANES > AMB_CLUSTER
    float wide[AMB_LANES];
    memcpy(wide, row, sizeof(float) * AMB_CLUSTER);
    memcpy(wide + AMB_CLUSTER, row, sizeof(float) * AMB_CLUSTER);
    return f_load(wide);
#else
    return f_load(row);
#endif
}

/* Lanes are triangles; for ray `lane` of the packet. True when it was hit. */
AMB_INLINE bool triangles_by_ray(packet *p, const amb_cluster *c, int slot, int lane, f32x enter, f32x exit, bool any)
{
    int z = i_lane(p->axis, lane), x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    woop ray = {f_set(f_lane(p->origin[x], lane)), f_set(f_lane(p->origin[y], lane)), f_set(f_lane(p->origin[z], lane)),
                f_set(f_lane(p->shear[0], lane)),  f_set(f_lane(p->shear[1], lane)),  f_set(f_lane(p->shear[2], lane))};
    float t_near = f_lane(p->t_near, lane), first = f_lane(enter, lane), last = f_lane(exit, lane);
    bool found = false;
    for (uint32_t base = 0; base < c->count; base += CHUNK) {
        v3x corner[3];
        for (int i = 0; i < 3; i++)
            corner[i] = v3x_of(load_row(c->vertex[i][x] + base), load_row(c->vertex[i][y] + base),
                               load_row(c->vertex[i][z] + base));
        woop_hit h;
        maskx hit = woop_test(&ray, corner[0], corner[1], corner[2], &h);
        uint32_t bits = m_bits(hit) & ((1u << CHUNK) - 1u);
        if (bits == 0)
            continue;
        float t_far = f_lane(p->t_far, lane);
        bits &= m_bits((h.t > t_near) & (h.t <= t_far) & (h.t >= first) & (h.t <= last));
        if (any && bits)
            return true;
        for (; bits; bits &= bits - 1) {
            int k = __builtin_ctz(bits);
            float t = f_lane(h.t, k);
            uint32_t g = u_lane(p->geometry, lane), id = c->primitive[base + (uint32_t)k];
            bool earlier = c->geometry < g || (c->geometry == g && id < u_lane(p->primitive, lane));
            if (!(t < t_far || (t == t_far && earlier)))
                continue;
            t_far = t;
            p->t_far = f_with_lane(p->t_far, lane, t);
            p->u = f_with_lane(p->u, lane, f_lane(h.v, k) / f_lane(h.det, k));
            p->v = f_with_lane(p->v, lane, f_lane(h.w, k) / f_lane(h.det, k));
            p->geometry = (u32x)i_with_lane((i32x)p->geometry, lane, (int32_t)c->geometry);
            p->primitive = (u32x)i_with_lane((i32x)p->primitive, lane, (int32_t)id);
            p->slot = (u32x)i_with_lane((i32x)p->slot, lane, slot + (int32_t)base + k);
            found = true;
        }
    }
    return found;
}

AMB_INLINE maskx packet_cluster(packet *p, const amb_rays *rays, uint32_t number, bool any)
{
    const amb_cluster *c = &rays->cluster[number];
    int slot = (int)(number * AMB_CLUSTER);
    f32x enter, exit;
    slabs(p->origin, p->inverse, v3x_splat(c->lo), v3x_splat(c->hi), &enter, &exit);
    maskx live = p->live & (enter <= exit) & (enter <= p->t_far) & (exit >= p->t_near);
    uint32_t bits = m_bits(live), found = 0;
    /* A pass over the triangles costs `count` tests, one over the rays count/CHUNK tests a ray. */
    if ((uint32_t)__builtin_popcount(bits) * ((c->count + CHUNK - 1) / CHUNK) * 3 < c->count * 2) {
        for (; bits; bits &= bits - 1) {
            int lane = __builtin_ctz(bits);
            found |= (uint32_t)triangles_by_ray(p, c, slot, lane, enter, exit, any) << lane;
        }
        return m_from_bits(found);
    }
    maskx hit = m_set(false);
    for (int z = 0; z < 3; z++) {
        maskx group = live & (p->axis == z);
        if (m_any(group))
            hit |= rays_by_triangle(p, c, slot, z, group, enter, exit, any);
    }
    return hit;
}

AMB_INLINE maskx packet_ball(packet *p, const amb_rays *rays, uint32_t number, bool any)
{
    const amb_ball *b = &rays->ball[number];
    f32x enter, exit, t0, t1;
    slabs(p->origin, p->inverse, v3x_splat(b->lo), v3x_splat(b->hi), &enter, &exit);
    v3x origin = {p->origin[0], p->origin[1], p->origin[2]};
    v3x direction = {p->direction[0], p->direction[1], p->direction[2]};
    maskx hit = sphere_test(origin, direction, v3x_splat(b->center), f_set(b->radius), &t0, &t1) & p->live;
    f32x t = f_sel(t0 > p->t_near, t0, t1);
    hit = in_range(p, hit, t, enter, exit);
    if (any)
        return hit;
    u32x geometry = u_set(b->geometry), primitive = u_set(b->primitive);
    hit &= wins(p, t, geometry, primitive);
    p->t_far = f_sel(hit, t, p->t_far);
    p->u = f_sel(hit, f_set(0.0f), p->u);
    p->v = f_sel(hit, f_set(0.0f), p->v);
    p->geometry = u_sel(hit, geometry, p->geometry);
    p->primitive = u_sel(hit, primitive, p->primitive);
    p->slot = u_sel(hit, u_set(~number), p->slot);
    return hit;
}

/* ---- callbacks --------------------------------------------------------------------------------------------------- */

AMB_INLINE void on_packet(const void *user, struct RTCIntersectContext *context, int *valid, float *ray, uint32_t n,
                          uint32_t number, bool ball, bool any)
{
    const amb_query *q = (const amb_query *)(const void *)context;
    bool own = n == AMB_LANES && q->lanes == AMB_LANES;
    for (uint32_t base = 0; base < n; base += AMB_LANES) {
        packet p;
        if (own)
            load_own(&p, q, valid, ray, !any);
        else
            load_any(&p, q, valid, ray, n, base, !any);
        maskx hit = ball ? packet_ball(&p, user, number, any) : packet_cluster(&p, user, number, any);
        if (!m_any(hit))
            continue;
        if (any)
            p.t_far = f_sel(hit, f_set(-__builtin_inff()), p.t_far); /* Embree's sign for "occluded" */
        if (own)
            store_own(&p, ray, !any);
        else
            store_any(&p, hit, ray, n, base, !any);
    }
}

static void closest_triangle(const struct RTCIntersectFunctionNArguments *a)
{
    on_packet(a->geometryUserPtr, a->context, a->valid, (float *)(void *)a->rayhit, a->N, a->primID, false, false);
}
static void closest_ball(const struct RTCIntersectFunctionNArguments *a)
{
    on_packet(a->geometryUserPtr, a->context, a->valid, (float *)(void *)a->rayhit, a->N, a->primID, true, false);
}
static void any_triangle(const struct RTCOccludedFunctionNArguments *a)
{
    on_packet(a->geometryUserPtr, a->context, a->valid, (float *)(void *)a->ray, a->N, a->primID, false, true);
}
static void any_ball(const struct RTCOccludedFunctionNArguments *a)
{
    on_packet(a->geometryUserPtr, a->context, a->valid, (float *)(void *)a->ray, a->N, a->primID, true, true);
}

const amb_ray_callbacks WIDE(amb_ray_callbacks) = {closest_triangle, closest_ball, any_triangle, any_ball};
