/* Loading of scene lucy: any statue is stood up and scaled, then its ambient occlusion is baked. */
#include "scenes/lucy.h"

#include "core/dispatch.h"

#include <ambiance/math.h>

#include <stdlib.h>
#include <string.h>

AMB_DECLARE_WIDE(void, lucy_bake_chunk, (void *user, int chunk, int thread));

/* ---- standing up ------------------------------------------------------------------------------------------------- */

static float component(v3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/* Area of the triangles whose first vertex lies within a twentieth of the extent from one end of the axis. */
static double end_area(const amb_mesh *mesh, int axis, float from, float to)
{
    double area = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        v3 a = mesh->position[mesh->index[t * 3]], b = mesh->position[mesh->index[t * 3 + 1]],
           c = mesh->position[mesh->index[t * 3 + 2]];
        float at = component(a, axis);
        if (at >= from && at <= to)
            area += 0.5 * (double)v3_length(v3_cross(v3_sub(b, a), v3_sub(c, a)));
    }
    return area;
}

/* A statue stands along its longest axis, on the end with more surface: the base. Returns the rotation to y up. */
static m4 standing(const amb_mesh *mesh)
{
    v3 lo, hi;
    amb_mesh_bounds(mesh, &lo, &hi);
    v3 size = v3_sub(hi, lo);
    int axis = size.y >= size.x && size.y >= size.z ? 1 : size.z >= size.x ? 2 : 0;
    float low = component(lo, axis), high = component(hi, axis), slab = (high - low) * 0.05f;
    bool upright = end_area(mesh, axis, low, low + slab) >= end_area(mesh, axis, high - slab, high);
    float quarter = upright ? AMB_HALF_PI : -AMB_HALF_PI;
    if (axis == 0)
        return m4_rotate((v3){0.0f, 0.0f, 1.0f}, quarter);
    if (axis == 2)
        return m4_rotate((v3){1.0f, 0.0f, 0.0f}, -quarter);
    return upright ? m4_identity() : m4_rotate((v3){0.0f, 0.0f, 1.0f}, 2.0f * AMB_HALF_PI);
}

/* Our copy of the mesh: standing, LUCY_HEIGHT high, its base's centre on the origin. */
static amb_status stand_up(const amb_mesh *source, amb_mesh **out, amb_error *error)
{
    amb_mesh *mesh = NULL;
    amb_status status = amb_mesh_create(source->vertex_count, source->triangle_count, &mesh, error);
    if (status != AMB_OK)
        return status;
    m4 turn = standing(source);
    memcpy(mesh->index, source->index, (size_t)source->triangle_count * 3 * sizeof *mesh->index);
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        mesh->position[i] = m4_point(turn, source->position[i]);
    v3 lo, hi;
    amb_mesh_bounds(mesh, &lo, &hi);
    float scale = LUCY_HEIGHT / amb_s_max(hi.y - lo.y, 1e-20f);
    v3 base_lo = hi, base_hi = lo; /* of the lowest twentieth: wings and torches do not move the axis */
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        if (mesh->position[i].y < lo.y + 0.05f * (hi.y - lo.y)) {
            base_lo = v3_min(base_lo, mesh->position[i]);
            base_hi = v3_max(base_hi, mesh->position[i]);
        }
    /* A hair below the floor, so that no slit shows under it. */
    v3 foot = {0.5f * (base_lo.x + base_hi.x), lo.y + 0.002f * (hi.y - lo.y), 0.5f * (base_lo.z + base_hi.z)};
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        mesh->position[i] = v3_scale(v3_sub(mesh->position[i], foot), scale);
    if (source->normal != NULL) {
        mesh->normal = malloc(((size_t)mesh->vertex_count + 1) * sizeof *mesh->normal);
        if (mesh->normal == NULL)
            status = amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: no memory for %u normals", mesh->vertex_count);
        for (uint32_t i = 0; i < mesh->vertex_count && status == AMB_OK; i++)
            mesh->normal[i] = v3_normalize(m4_direction(turn, source->normal[i]));
    } else {
        status = amb_mesh_smooth_normals(mesh, true, error);
    }
    if (status != AMB_OK)
        amb_mesh_close(&mesh);
    *out = mesh;
    return status;
}

/* ---- ambient occlusion ------------------------------------------------------------------------------------------- */

/* Even points on the sphere along a spiral (R. Swinbank and R. J. Purser, "Fibonacci grids", 2006). */
static void spread_directions(v3 direction[LUCY_DIRECTIONS])
{
    const float golden = 2.39996323f;
    for (int i = 0; i < LUCY_DIRECTIONS; i++) {
        float y = 1.0f - ((float)i + 0.5f) * (2.0f / LUCY_DIRECTIONS), r = __builtin_sqrtf(1.0f - y * y);
        float angle = golden * (float)i;
        direction[i] = (v3){r * amb_cos(angle), y, r * amb_sin(angle)};
    }
}

static void bake(const amb_context *context, lucy_bake *job)
{
    spread_directions(job->direction);
    int chunks = (int)((job->count + LUCY_BAKE_CHUNK - 1) / LUCY_BAKE_CHUNK);
    amb_parallel_for(context, chunks, AMB_DISPATCH(amb_context_isa(context), lucy_bake_chunk), job);
}

/* Two rounds of averaging with the vertices that share a triangle take out what is left of the directions' steps. */
static amb_status soften(const amb_mesh *mesh, lucy_point *point, amb_error *error)
{
    v4 *sum = malloc(((size_t)mesh->vertex_count + 1) * sizeof *sum);
    if (sum == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: no memory for %u vertices", mesh->vertex_count);
    for (int round = 0; round < 2; round++) {
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
            sum[i] = (v4){point[i].open.x, point[i].open.y, point[i].open.z, point[i].visibility};
        float *weight = calloc((size_t)mesh->vertex_count + 1, sizeof *weight);
        if (weight == NULL) {
            free(sum);
            return amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: no memory for %u weights", mesh->vertex_count);
        }
        for (uint32_t i = 0; i < mesh->triangle_count * 3; i++) {
            uint32_t a = mesh->index[i], b = mesh->index[i % 3 == 2 ? i - 2 : i + 1];
            const lucy_point *q = &point[b];
            sum[a] = v4_add(sum[a], v4_scale((v4){q->open.x, q->open.y, q->open.z, q->visibility}, 0.25f));
            weight[a] += 0.25f;
        }
        for (uint32_t i = 0; i < mesh->vertex_count; i++) {
            v4 mean = v4_scale(sum[i], 1.0f / (1.0f + weight[i]));
            point[i] = (lucy_point){v4_xyz(mean), mean.w};
        }
        free(weight);
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        point[i].open = v3_normalize(point[i].open);
    free(sum);
    return AMB_OK;
}

static amb_status bake_statue(const amb_context *context, lucy_state *state, amb_error *error)
{
    const amb_mesh *mesh = state->mesh;
    state->point = malloc(((size_t)mesh->vertex_count + 1) * sizeof *state->point);
    if (state->point == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: no memory for %u vertices", mesh->vertex_count);
    lucy_bake job = {.rays = state->rays,
                     .position = mesh->position,
                     .normal = mesh->normal,
                     .count = mesh->vertex_count,
                     .above_floor = true,
                     .reach = 0.8f,
                     .out = state->point};
    bake(context, &job);
    return soften(mesh, state->point, error);
}

/* The shade that the statue leaves on the floor, as a texture. */
static amb_status bake_floor(const amb_context *context, lucy_state *state, amb_error *error)
{
    enum { COUNT = LUCY_FLOOR_TEXELS * LUCY_FLOOR_TEXELS };
    v3 *position = malloc(2 * COUNT * sizeof *position);
    lucy_point *point = malloc(COUNT * sizeof *point);
    float *texel = malloc(COUNT * sizeof *texel);
    amb_status status = AMB_OK;
    if (position == NULL || point == NULL || texel == NULL) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: no memory for the floor");
        goto done;
    }
    for (int i = 0; i < COUNT; i++) {
        float u = ((float)(i % LUCY_FLOOR_TEXELS) + 0.5f) / LUCY_FLOOR_TEXELS - 0.5f;
        float v = ((float)(i / LUCY_FLOOR_TEXELS) + 0.5f) / LUCY_FLOOR_TEXELS - 0.5f;
        position[i] = (v3){u * LUCY_FLOOR_SIZE, 0.0f, v * LUCY_FLOOR_SIZE};
        position[COUNT + i] = (v3){0.0f, 1.0f, 0.0f};
    }
    lucy_bake job = {.rays = state->rays,
                     .position = position,
                     .normal = position + COUNT,
                     .count = COUNT,
                     .reach = 4.0f,
                     .out = point};
    bake(context, &job);
    for (int i = 0; i < COUNT; i++)
        texel[i] = point[i].visibility;
    amb_texture_desc desc = {.kind = AMB_TEXTURE_2D,
                             .texel = AMB_TEXEL_R32F,
                             .width = LUCY_FLOOR_TEXELS,
                             .height = LUCY_FLOOR_TEXELS,
                             .data = texel,
                             .data_bytes = COUNT * sizeof *texel};
    status = amb_texture_create(&desc, &state->floor, error);
done:
    free(texel);
    free(point);
    free(position);
    return status;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static amb_status load_all(const amb_context *context, amb_assets *assets, lucy_state *state, amb_error *error)
{
    static const char *const names[2] = {"env/studio", "env/outdoor"};
    static const char *const irradiances[2] = {"env/studio/irradiance", "env/outdoor/irradiance"};
    const amb_mesh *source = NULL;
    amb_status status = amb_assets_mesh(assets, "lucy/mesh", &source, error);
    for (int i = 0; i < 2 && status == AMB_OK; i++) {
        status = amb_assets_texture(assets, names[i], &state->environment[i], error);
        if (status == AMB_OK)
            status = amb_assets_texture(assets, irradiances[i], &state->irradiance[i], error);
    }
    if (status == AMB_OK && source->triangle_count == 0)
        status = amb_fail(error, AMB_ERROR_FORMAT, "scene lucy: the mesh lucy/mesh has no triangles");
    if (status == AMB_OK)
        status = stand_up(source, &state->mesh, error);
    if (status != AMB_OK)
        return status;
    amb_rays_geometry geometry = {.mesh = state->mesh};
    status = amb_rays_create(context, &geometry, 1, &state->rays, error);
    if (status == AMB_OK)
        status = bake_statue(context, state, error);
    if (status == AMB_OK)
        status = bake_floor(context, state, error);
    return status;
}

amb_status lucy_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    lucy_state *lucy = calloc(1, sizeof *lucy);
    if (lucy == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "scene lucy: out of memory");
    amb_status status = load_all(context, assets, lucy, error);
    if (status != AMB_OK) {
        lucy_unload(lucy);
        return status;
    }
    *state = lucy;
    return AMB_OK;
}

void lucy_unload(void *state)
{
    lucy_state *lucy = state;
    amb_texture_close(&lucy->floor);
    amb_rays_close(&lucy->rays);
    amb_mesh_close(&lucy->mesh);
    free(lucy->point);
    free(lucy);
}
