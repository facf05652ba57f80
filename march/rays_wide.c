/* Ray queries: readies a packet of rays, lets Embree walk its tree, and completes the hits. */
#include "march/rays_lanes.h"

#if AMB_LANES == 16
#define EMBREE_(name) name##16
#elif AMB_LANES == 8
#define EMBREE_(name) name##8
#else
#define EMBREE_(name) name##4
#endif
typedef struct EMBREE_(RTCRayHit) rayhit_packet;
typedef struct EMBREE_(RTCRay) ray_packet;
#define rtc_intersect EMBREE_(rtcIntersect)
#define rtc_occluded EMBREE_(rtcOccluded)

/* The ray as it is traced: direction scaled by a power of two to a largest component of 1…2, origin near the scene.
 * t of the caller = (moved + t of the traced ray) · scale. */
typedef struct traced {
    v3x origin, direction;
    f32x t_near, t_far, scale, moved;
    maskx live;
} traced;

AMB_INLINE f32x largest(v3x a) { return f_max(f_max(f_abs(a.x), f_abs(a.y)), f_abs(a.z)); }

AMB_INLINE maskx finite3(v3x a) { return f_is_finite(a.x) & f_is_finite(a.y) & f_is_finite(a.z); }

/* Moves one far origin along its ray to within the near range, in double. False: the ray passes the scene by. */
static bool approach(const amb_rays *rays, v3 direction, v3 *origin, float *moved)
{
    double fx = (double)rays->center.x - (double)origin->x, fy = (double)rays->center.y - (double)origin->y;
    double fz = (double)rays->center.z - (double)origin->z;
    double dx = (double)direction.x, dy = (double)direction.y, dz = (double)direction.z;
    double a = (dx * dx + dy * dy) + dz * dz, t = ((fx * dx + fy * dy) + fz * dz) / a;
    t -= 2.0 * (double)rays->radius / __builtin_sqrt(a); /* the bounds' corners are √3 radii from their centre */
    t = (double)(float)t;                                /* what the caller's t will be offset by, exactly */
    double x = (double)origin->x + t * dx, y = (double)origin->y + t * dy, z = (double)origin->z + t * dz;
    *moved = (float)t;
    *origin = (v3){(float)x, (float)y, (float)z};
    return t > 0;
}

static void approach_lanes(const amb_rays *rays, traced *ray, maskx far)
{
    for (uint32_t bits = m_bits(far); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        v3 origin = v3x_lane(ray->origin, i);
        float moved = 0;
        bool ahead = approach(rays, v3x_lane(ray->direction, i), &origin, &moved);
        ray->origin.x = f_with_lane(ray->origin.x, i, origin.x);
        ray->origin.y = f_with_lane(ray->origin.y, i, origin.y);
        ray->origin.z = f_with_lane(ray->origin.z, i, origin.z);
        ray->moved = f_with_lane(ray->moved, i, moved);
        if (!ahead)
            ray->live &= ~m_from_bits(1u << i);
    }
    v3x away = v3x_sub(ray->origin, v3x_splat(rays->center));
    ray->live &= ~far | (largest(away) <= rays->radius * (2.0f * AMB_RAYS_NEAR));
    ray->t_near = ray->t_near - ray->moved;
    ray->t_far = ray->t_far - ray->moved;
    ray->live &= ray->t_far > 0.0f;
}

AMB_INLINE traced make_traced(const amb_rays *rays, const amb_rayx *ray, maskx live)
{
    f32x big = largest(ray->direction);
    live &= finite3(ray->origin) & finite3(ray->direction) & (big >= FLT_MIN);
    live &= (ray->t_far > ray->t_near) & (ray->t_far >= 0.0f);
    i32x exponent = i_min(f_bits(big) & 0x7f800000, i_set(253 << 23));
    f32x scale = f_from_bits((254 << 23) - exponent), back = f_from_bits(exponent);
    traced r = {
        ray->origin, v3x_scale(ray->direction, scale), ray->t_near * back, ray->t_far * back, scale, f_set(0.0f), live};
    v3x away = v3x_sub(ray->origin, v3x_splat(rays->center));
    maskx far = live & ~(largest(away) <= rays->radius * AMB_RAYS_NEAR);
    if (m_any(far))
        approach_lanes(rays, &r, far);
    if (!m_all(r.live)) { /* Embree asserts that dead lanes, too, hold no NaN */
        v3 along_x = {1.0f, 0.0f, 0.0f};
        r.origin = v3x_sel(r.live, r.origin, v3x_splat(rays->center));
        r.direction = v3x_sel(r.live, r.direction, v3x_splat(along_x));
        r.t_near = f_sel(r.live, r.t_near, f_set(0.0f));
        r.t_far = f_sel(r.live, r.t_far, f_set(0.0f));
    }
    r.t_near = f_max(r.t_near, f_set(0.0f));
    return r;
}

AMB_INLINE void fill_query(amb_query *q, const traced *r, int *valid, float *ray)
{
    rtcInitIntersectContext(&q->embree);
    q->lanes = AMB_LANES;
    v3x d = r->direction;
    f32x ax = f_abs(d.x), ay = f_abs(d.y), az = f_abs(d.z);
    maskx is_x = (ax >= ay) & (ax >= az), is_y = ~is_x & (ay >= az);
    i_store(q->axis, i_sel(is_x, i_set(0), i_sel(is_y, i_set(1), i_set(2))));
    f32x z = f_sel(is_x, d.x, f_sel(is_y, d.y, d.z));
    f_store(q->shear[0], f_sel(is_x, d.y, f_sel(is_y, d.z, d.x)) / z);
    f_store(q->shear[1], f_sel(is_x, d.z, f_sel(is_y, d.x, d.y)) / z);
    f_store(q->shear[2], 1.0f / z);
    f_store(q->inverse[0], 1.0f / f_copysign(f_max(ax, f_set(0x1p-60f)), d.x));
    f_store(q->inverse[1], 1.0f / f_copysign(f_max(ay, f_set(0x1p-60f)), d.y));
    f_store(q->inverse[2], 1.0f / f_copysign(f_max(az, f_set(0x1p-60f)), d.z));
    i_store(valid, i_sel(r->live, i_set(-1), i_set(0)));
    const f32x fields[RAY_FIELDS] = {r->origin.x,
                                     r->origin.y,
                                     r->origin.z,
                                     r->t_near,
                                     d.x,
                                     d.y,
                                     d.z,
                                     f_set(0.0f),
                                     r->t_far,
                                     f_from_bits(i_set(-1)),
                                     f_from_bits(i_lane_index()),
                                     f_set(0.0f)};
    for (int k = 0; k < RAY_FIELDS; k++)
        f_store(ray + k * AMB_LANES, fields[k]);
}

/* The unit normal of a hit triangle; edges are scaled first so that tiny triangles keep theirs. */
AMB_INLINE v3x triangle_normal(v3x a, v3x b, v3x c)
{
    v3x p = v3x_sub(b, a), q = v3x_sub(c, a);
    p = v3x_scale(p, 1.0f / f_max(largest(p), f_set(FLT_MIN)));
    q = v3x_scale(q, 1.0f / f_max(largest(q), f_set(FLT_MIN)));
    v3x n = v3x_cross(p, q);
    return v3x_normalize(v3x_scale(n, 1.0f / f_max(largest(n), f_set(FLT_MIN))));
}

/* Normals and sphere exits of the hits. */
static void finish_hits(const amb_rays *rays, const traced *r, maskx balls, const uint32_t *slot, amb_hitx *out)
{
    float corner[9][AMB_LANES] = {{0}}, ball[4][AMB_LANES] = {{0}};
    uint32_t spheres = m_bits(balls);
    for (uint32_t bits = m_bits(out->hit); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        if (spheres >> i & 1u) {
            const amb_ball *b = &rays->ball[~slot[i]];
            ball[0][i] = b->center.x;
            ball[1][i] = b->center.y;
            ball[2][i] = b->center.z;
            ball[3][i] = b->radius;
            continue;
        }
        const amb_cluster *c = &rays->cluster[slot[i] / AMB_CLUSTER];
        for (int k = 0; k < 9; k++)
            corner[k][i] = c->vertex[k / 3][k % 3][slot[i] % AMB_CLUSTER];
    }
    v3x a = {f_load(corner[0]), f_load(corner[1]), f_load(corner[2])};
    v3x b = {f_load(corner[3]), f_load(corner[4]), f_load(corner[5])};
    v3x c = {f_load(corner[6]), f_load(corner[7]), f_load(corner[8])};
    out->normal = triangle_normal(a, b, c);
    out->t_exit = out->t;
    if (m_any(balls)) {
        v3x center = {f_load(ball[0]), f_load(ball[1]), f_load(ball[2])};
        f32x radius = f_sel(balls, f_load(ball[3]), f_set(1.0f)), enter, exit;
        sphere_test(r->origin, r->direction, center, radius, &enter, &exit);
        f32x t = out->t; /* still the traced ray's */
        v3x at = v3x_add(v3x_sub(r->origin, center), v3x_scale(r->direction, t));
        out->normal = v3x_sel(balls, v3x_normalize(v3x_scale(at, 1.0f / radius)), out->normal);
        out->t_exit = f_sel(balls, exit, out->t_exit);
    }
    v3x none = v3x_splat((v3){0, 0, 0});
    out->normal = v3x_sel(out->hit, out->normal, none);
}

void amb_rays_closest(const amb_rays *rays, const amb_rayx *ray, maskx live, amb_hitx *out)
{
    traced r = make_traced(rays, ray, live);
    *out = (amb_hitx){m_set(false), ray->t_far, f_set(0.0f), f_set(0.0f),
                      i_set(-1),    i_set(-1),  ray->t_far,  v3x_splat((v3){0, 0, 0})};
    if (!m_any(r.live))
        return;
    amb_query q;
    _Alignas(64) int valid[AMB_LANES];
    _Alignas(64) rayhit_packet rayhit;
    float *field = (float *)(void *)&rayhit;
    fill_query(&q, &r, valid, field);
    for (int k = HIT_NORMAL; k <= HIT_GEOMETRY; k++)
        i_store((int32_t *)(void *)(field + k * AMB_LANES), i_set(-1));
    i_store((int32_t *)(void *)(field + (HIT_GEOMETRY + 1) * AMB_LANES), i_set(-1));
    rtc_intersect(valid, rays->scene, &q.embree, &rayhit);

    i32x geometry = (i32x)u_load(field + HIT_GEOMETRY * AMB_LANES);
    maskx hit = r.live & (geometry != -1);
    if (!m_any(hit))
        return;
    uint32_t slot[AMB_LANES];
    memcpy(slot, field + HIT_NORMAL * AMB_LANES, sizeof slot);
    out->hit = hit;
    out->t = f_sel(hit, f_load(field + RAY_FAR * AMB_LANES), f_set(0.0f));
    out->u = f_sel(hit, f_load(field + HIT_U * AMB_LANES), f_set(0.0f));
    out->v = f_sel(hit, f_load(field + HIT_V * AMB_LANES), f_set(0.0f));
    out->geometry = i_sel(hit, geometry, i_set(-1));
    out->primitive = i_sel(hit, (i32x)u_load(field + HIT_PRIMITIVE * AMB_LANES), i_set(-1));
    finish_hits(rays, &r, hit & ((i32x)u_load(slot) < 0), slot, out);
    f32x t = f_min((r.moved + out->t) * r.scale, ray->t_far);
    out->t = f_sel(hit, t, ray->t_far);
    out->t_exit = f_sel(hit, (r.moved + out->t_exit) * r.scale, ray->t_far);
}

maskx amb_rays_occluded(const amb_rays *rays, const amb_rayx *ray, maskx live)
{
    traced r = make_traced(rays, ray, live);
    if (!m_any(r.live))
        return m_set(false);
    amb_query q;
    _Alignas(64) int valid[AMB_LANES];
    _Alignas(64) ray_packet rays_only;
    float *field = (float *)(void *)&rays_only;
    fill_query(&q, &r, valid, field);
    rtc_occluded(valid, rays->scene, &q.embree, &rays_only);
    return r.live & (f_load(field + RAY_FAR * AMB_LANES) < -FLT_MAX);
}
