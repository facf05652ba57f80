/* Building ray scenes: clusters and balls into Embree user geometry. */
#include "core/dispatch.h"
#include "march/rays_internal.h"
#include <stdio.h>
#include <stdlib.h>

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

static bool usable_sphere(const amb_rays_sphere *s)
{
    return s->radius > 0 && s->radius <= FLT_MAX && amb_s_max(s->center.x, -s->center.x) <= FLT_MAX &&
           amb_s_max(s->center.y, -s->center.y) <= FLT_MAX && amb_s_max(s->center.z, -s->center.z) <= FLT_MAX;
}

static void include(v3 *lo, v3 *hi, v3 a, float radius)
{
    v3 r = {radius, radius, radius};
    *lo = v3_min(*lo, v3_sub(a, r));
    *hi = v3_max(*hi, v3_add(a, r));
}

typedef struct census {
    uint64_t triangles, largest_mesh, balls;
    v3 lo, hi;
} census;

static amb_status check_mesh(const amb_mesh *m, uint32_t number, census *c, amb_error *error)
{
    if (m->triangle_count > 0 && (m->index == NULL || m->position == NULL))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "ray geometry %u: the mesh has triangles but no index or positions",
                        number);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        v3 p = m->position[i];
        float large = amb_s_max(amb_s_max(__builtin_fabsf(p.x), __builtin_fabsf(p.y)), __builtin_fabsf(p.z));
        if (!(large <= FLT_MAX) || p.x != p.x || p.y != p.y || p.z != p.z)
            return amb_fail(error, AMB_ERROR_FORMAT, "ray geometry %u: vertex %u is (%g, %g, %g); must be finite",
                            number, i, (double)p.x, (double)p.y, (double)p.z);
        if (large > AMB_RAYS_LARGEST)
            return amb_fail(error, AMB_ERROR_LIMIT, "ray geometry %u: vertex %u has coordinate %g; at most %g", number,
                            i, (double)large, (double)AMB_RAYS_LARGEST);
        include(&c->lo, &c->hi, p, 0);
    }
    for (uint64_t i = 0; i < 3 * (uint64_t)m->triangle_count; i++)
        if (m->index[i] >= m->vertex_count)
            return amb_fail(error, AMB_ERROR_FORMAT, "ray geometry %u: triangle %llu uses vertex %u of %u", number,
                            (unsigned long long)(i / 3), m->index[i], m->vertex_count);
    c->triangles += m->triangle_count;
    c->largest_mesh = m->triangle_count > c->largest_mesh ? m->triangle_count : c->largest_mesh;
    return AMB_OK;
}

static amb_status check_geometry(const amb_rays_geometry *g, uint32_t number, census *c, amb_error *error)
{
    if ((g->mesh == NULL) == (g->spheres == NULL))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "ray geometry %u: give either a mesh or spheres", number);
    if (g->mesh)
        return check_mesh(g->mesh, number, c, error);
    for (uint32_t i = 0; i < g->sphere_count; i++) {
        const amb_rays_sphere *s = &g->spheres[i];
        if (!usable_sphere(s))
            continue;
        float large = amb_s_max(__builtin_fabsf(s->center.x), __builtin_fabsf(s->center.y));
        large = amb_s_max(amb_s_max(large, __builtin_fabsf(s->center.z)), s->radius);
        if (large > AMB_RAYS_LARGEST)
            return amb_fail(error, AMB_ERROR_LIMIT, "ray geometry %u: sphere %u reaches %g; at most %g", number, i,
                            (double)large, (double)AMB_RAYS_LARGEST);
        include(&c->lo, &c->hi, s->center, s->radius);
    }
    c->balls += g->sphere_count;
    return AMB_OK;
}

/* Centre, radius and pad of everything. */
static void measure(amb_rays *rays, const census *c)
{
    if (!(c->lo.x <= c->hi.x))
        return;
    v3 half = v3_scale(v3_sub(c->hi, c->lo), 0.5f);
    rays->center = v3_add(v3_scale(c->lo, 0.5f), v3_scale(c->hi, 0.5f));
    rays->radius = amb_s_max(amb_s_max(amb_s_max(half.x, half.y), half.z), 0x1p-100f);
    /* Errors of the intersectors, of the slabs and of stored boxes: a few units in the last place of the largest
     * distance (about 6 radii) and of the largest coordinate. */
    float far = amb_s_max(amb_s_max(__builtin_fabsf(rays->center.x), __builtin_fabsf(rays->center.y)),
                          __builtin_fabsf(rays->center.z));
    rays->pad = 0x1p-16f * rays->radius + 0x1p-20f * far;
}

/* ---- primitives -------------------------------------------------------------------------------------------------- */

static void bounds_grown(const amb_rays *rays, v3 *lo, v3 *hi)
{
    v3 pad = {rays->pad, rays->pad, rays->pad};
    *lo = v3_sub(*lo, pad);
    *hi = v3_add(*hi, pad);
}

/* Zero area in double: such a triangle has no normal and is never hit. */
static bool degenerate(v3 a, v3 b, v3 c)
{
    double px = (double)b.x - (double)a.x, py = (double)b.y - (double)a.y, pz = (double)b.z - (double)a.z;
    double qx = (double)c.x - (double)a.x, qy = (double)c.y - (double)a.y, qz = (double)c.z - (double)a.z;
    return py * qz == pz * qy && pz * qx == px * qz && px * qy == py * qx;
}

typedef struct emitter {
    amb_rays *rays;
    const amb_mesh *mesh;
    uint32_t geometry;
    bool full;
} emitter;

static void emit_cluster(void *user, const amb_reference *first, uint32_t n)
{
    emitter *e = user;
    amb_rays *rays = e->rays;
    if (rays->cluster_count == rays->cluster_limit) {
        uint32_t limit = rays->cluster_limit ? rays->cluster_limit + rays->cluster_limit / 2 : 64;
        bool numbered = limit <= INT32_MAX / AMB_CLUSTER; /* hits name triangles by a non-negative int */
        size_t bytes = ((size_t)limit * sizeof(amb_cluster) + 63) / 64 * 64;
        amb_cluster *more = numbered ? aligned_alloc(64, bytes) : NULL;
        if (more == NULL) {
            e->full = true;
            return;
        }
        if (rays->cluster_count)
            memcpy(more, rays->cluster, (size_t)rays->cluster_count * sizeof *more);
        free(rays->cluster);
        rays->cluster = more;
        rays->cluster_limit = limit;
    }
    amb_cluster *c = &rays->cluster[rays->cluster_count++];
    *c = (amb_cluster){.geometry = e->geometry, .count = n, .lo = first[0].lo, .hi = first[0].hi};
    for (uint32_t k = 0; k < AMB_CLUSTER; k++)
        for (uint32_t corner = 0; corner < 3; corner++) {
            v3 p = {__builtin_nanf(""), __builtin_nanf(""), __builtin_nanf("")};
            if (k < n)
                p = e->mesh->position[e->mesh->index[3 * (size_t)first[k].primitive + corner]];
            c->vertex[corner][0][k] = p.x;
            c->vertex[corner][1][k] = p.y;
            c->vertex[corner][2][k] = p.z;
        }
    for (uint32_t k = 0; k < n; k++) {
        c->primitive[k] = first[k].primitive;
        c->lo = v3_min(c->lo, first[k].lo);
        c->hi = v3_max(c->hi, first[k].hi);
    }
    bounds_grown(rays, &c->lo, &c->hi);
}

/* `scratch` holds mesh->triangle_count references. False: out of memory. */
static bool add_mesh(amb_rays *rays, const amb_mesh *mesh, uint32_t geometry, amb_reference *scratch)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->index + 3 * (size_t)i;
        v3 a = mesh->position[t[0]], b = mesh->position[t[1]], c = mesh->position[t[2]];
        if (!degenerate(a, b, c))
            scratch[n++] = (amb_reference){v3_min(v3_min(a, b), c), v3_max(v3_max(a, b), c), i};
    }
    emitter e = {rays, mesh, geometry, false};
    amb_cluster_build(scratch, n, emit_cluster, &e);
    return !e.full;
}

static void add_balls(amb_rays *rays, const amb_rays_geometry *g, uint32_t geometry)
{
    for (uint32_t i = 0; i < g->sphere_count; i++) {
        const amb_rays_sphere *s = &g->spheres[i];
        if (!usable_sphere(s))
            continue;
        v3 r = {s->radius, s->radius, s->radius};
        amb_ball *b = &rays->ball[rays->ball_count++];
        *b = (amb_ball){s->center, s->radius, geometry, i, v3_sub(s->center, r), v3_add(s->center, r)};
        bounds_grown(rays, &b->lo, &b->hi);
    }
}

static amb_status add_primitives(amb_rays *rays, const amb_rays_geometry *geometry, uint32_t geometry_count,
                                 const census *c, amb_error *error)
{
    amb_status status = AMB_ERROR_MEMORY;
    amb_reference *scratch = malloc((size_t)(c->largest_mesh ? c->largest_mesh : 1) * sizeof *scratch);
    rays->ball = malloc((size_t)(c->balls ? c->balls : 1) * sizeof *rays->ball);
    if (scratch == NULL || rays->ball == NULL)
        goto done;
    for (uint32_t g = 0; g < geometry_count; g++)
        if (geometry[g].spheres)
            add_balls(rays, &geometry[g], g);
        else if (!add_mesh(rays, geometry[g].mesh, g, scratch))
            goto done;
    status = AMB_OK;
done:
    free(scratch);
    return status == AMB_OK
               ? AMB_OK
               : amb_fail(error, status, "out of memory for %llu triangles and %llu spheres of a ray scene",
                          (unsigned long long)c->triangles, (unsigned long long)c->balls);
}

/* ---- Embree ------------------------------------------------------------------------------------------------------ */

static void on_error(void *user, enum RTCError code, const char *text)
{
    amb_rays *rays = user;
    if (rays->failure.code != RTC_ERROR_NONE)
        return;
    rays->failure.code = code;
    snprintf(rays->failure.text, sizeof rays->failure.text, "%s", text ? text : "");
}

static amb_status embree_failure(const amb_rays *rays, const char *doing, amb_error *error)
{
    bool memory = rays->failure.code == RTC_ERROR_OUT_OF_MEMORY;
    return amb_fail(error, memory ? AMB_ERROR_MEMORY : AMB_ERROR_ARGUMENT, "Embree failed %s: error %d %s", doing,
                    (int)rays->failure.code, rays->failure.text);
}

/* Grown once more (see rays_internal.h). */
static void write_bounds(const amb_rays *rays, v3 lo, v3 hi, struct RTCBounds *out)
{
    bounds_grown(rays, &lo, &hi);
    *out = (struct RTCBounds){lo.x, lo.y, lo.z, 0, hi.x, hi.y, hi.z, 0};
}

static void cluster_bounds(const struct RTCBoundsFunctionArguments *a)
{
    const amb_rays *rays = a->geometryUserPtr;
    write_bounds(rays, rays->cluster[a->primID].lo, rays->cluster[a->primID].hi, a->bounds_o);
}

static void ball_bounds(const struct RTCBoundsFunctionArguments *a)
{
    const amb_rays *rays = a->geometryUserPtr;
    write_bounds(rays, rays->ball[a->primID].lo, rays->ball[a->primID].hi, a->bounds_o);
}

static void attach(amb_rays *rays, uint32_t count, RTCBoundsFunction bounds, RTCIntersectFunctionN closest,
                   RTCOccludedFunctionN any)
{
    if (count == 0)
        return;
    RTCGeometry g = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_USER);
    if (g == NULL)
        return; /* on_error knows */
    rtcSetGeometryUserPrimitiveCount(g, count);
    rtcSetGeometryUserData(g, rays);
    rtcSetGeometryBoundsFunction(g, bounds, NULL);
    rtcSetGeometryIntersectFunction(g, closest);
    rtcSetGeometryOccludedFunction(g, any);
    rtcCommitGeometry(g);
    rtcAttachGeometry(rays->scene, g);
    rtcReleaseGeometry(g);
}

static amb_status build_tree(amb_rays *rays, const char *embree, const amb_context *context, amb_error *error)
{
    char config[128];
    snprintf(config, sizeof config, "threads=%d,set_affinity=0,start_threads=0%s%s", amb_context_threads(context),
             embree ? "," : "", embree ? embree : "");
    rays->device = rtcNewDevice(config);
    if (rays->device == NULL) {
        rays->failure.code = rtcGetDeviceError(NULL);
        return embree_failure(rays, "starting", error);
    }
    rtcSetDeviceErrorFunction(rays->device, on_error, rays);
    rays->scene = rtcNewScene(rays->device);
    if (rays->scene) {
        amb_ray_callbacks call = AMB_DISPATCH(amb_context_isa(context), amb_ray_callbacks);
        rtcSetSceneFlags(rays->scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(rays->scene, RTC_BUILD_QUALITY_MEDIUM);
        attach(rays, rays->cluster_count, cluster_bounds, call.closest_triangle, call.any_triangle);
        attach(rays, rays->ball_count, ball_bounds, call.closest_ball, call.any_ball);
        rtcCommitScene(rays->scene);
    }
    if (rays->failure.code != RTC_ERROR_NONE || rays->scene == NULL)
        return embree_failure(rays, "building the tree of a ray scene", error);
    return AMB_OK;
}

amb_status amb_rays_create_on(const char *embree, const amb_context *context, const amb_rays_geometry *geometry,
                              uint32_t geometry_count, amb_rays **out, amb_error *error)
{
    *out = NULL;
    if (geometry == NULL && geometry_count > 0)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "ray scene: %u geometries announced, none given", geometry_count);
    census c = {.lo = {FLT_MAX, FLT_MAX, FLT_MAX}, .hi = {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (uint32_t g = 0; g < geometry_count; g++) {
        amb_status status = check_geometry(&geometry[g], g, &c, error);
        if (status != AMB_OK)
            return status;
    }
    if (c.triangles > AMB_MAX_MESH_TRIANGLES || c.balls > AMB_MAX_MESH_TRIANGLES)
        return amb_fail(error, AMB_ERROR_LIMIT, "ray scene: %llu triangles and %llu spheres; at most %u of each",
                        (unsigned long long)c.triangles, (unsigned long long)c.balls, AMB_MAX_MESH_TRIANGLES);
    amb_rays *rays = calloc(1, sizeof *rays);
    if (rays == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a ray scene");
    measure(rays, &c);
    amb_status status = add_primitives(rays, geometry, geometry_count, &c, error);
    if (status == AMB_OK)
        status = build_tree(rays, embree, context, error);
    if (status != AMB_OK)
        amb_rays_close(&rays);
    *out = rays;
    return status;
}

amb_status amb_rays_create(const amb_context *context, const amb_rays_geometry *geometry, uint32_t geometry_count,
                           amb_rays **out, amb_error *error)
{
    return amb_rays_create_on(NULL, context, geometry, geometry_count, out, error);
}

void amb_rays_close(amb_rays **rays)
{
    if (rays == NULL || *rays == NULL)
        return;
    if ((*rays)->scene)
        rtcReleaseScene((*rays)->scene);
    if ((*rays)->device)
        rtcReleaseDevice((*rays)->device);
    free((*rays)->cluster);
    free((*rays)->ball);
    free(*rays);
    *rays = NULL;
}
