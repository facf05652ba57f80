/* Mesh memory, checks, bounds and the unit sphere. Normals and tangents: mesh_frames.c. */
#include <ambiance/math.h>
#include <ambiance/mesh.h>
#include <stdlib.h>

/* Never asks for zero bytes, so that NULL always means that memory ran out. */
static void *mesh_array(uint32_t count, size_t size) { return calloc(count ? count : 1u, size); }

amb_status amb_mesh_create(uint32_t vertex_count, uint32_t triangle_count, amb_mesh **out, amb_error *error)
{
    if (!out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "mesh: out is NULL; it must point to a mesh handle");
    *out = NULL;
    if (vertex_count > AMB_MAX_MESH_VERTICES)
        return amb_fail(error, AMB_ERROR_LIMIT, "mesh: %u vertices; at most %u are allowed", vertex_count,
                        AMB_MAX_MESH_VERTICES);
    if (triangle_count > AMB_MAX_MESH_TRIANGLES)
        return amb_fail(error, AMB_ERROR_LIMIT, "mesh: %u triangles; at most %u are allowed", triangle_count,
                        AMB_MAX_MESH_TRIANGLES);

    amb_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh)
        goto error;
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    mesh->position = mesh_array(vertex_count, sizeof *mesh->position);
    mesh->index = mesh_array(triangle_count, 3 * sizeof *mesh->index);
    if (!mesh->position || !mesh->index)
        goto error;
    *out = mesh;
    return AMB_OK;
error:
    amb_mesh_close(&mesh);
    return amb_fail(error, AMB_ERROR_MEMORY, "mesh: no memory for %u vertices and %u triangles", vertex_count,
                    triangle_count);
}

void amb_mesh_close(amb_mesh **mesh)
{
    if (!mesh || !*mesh)
        return;
    amb_mesh *m = *mesh;
    free(m->position);
    free(m->normal);
    free(m->uv);
    free(m->tangent);
    free(m->index);
    free(m->material);
    free(m);
    *mesh = NULL;
}

amb_status amb_mesh_check(const amb_mesh *mesh, amb_error *error)
{
    if (!mesh)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "mesh: NULL; a mesh is needed");
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        v3 p = mesh->position[i];
        if (!f_is_finite(p.x) || !f_is_finite(p.y) || !f_is_finite(p.z))
            return amb_fail(error, AMB_ERROR_FORMAT,
                            "mesh: position of vertex %u is (%g, %g, %g); positions must be finite", i, (double)p.x,
                            (double)p.y, (double)p.z);
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        if (mesh->index[i] >= mesh->vertex_count)
            return amb_fail(error, AMB_ERROR_FORMAT,
                            "mesh: corner %zu of triangle %zu is vertex %u; the mesh has %u vertices", i % 3, i / 3,
                            mesh->index[i], mesh->vertex_count);
    return AMB_OK;
}

void amb_mesh_bounds(const amb_mesh *mesh, v3 *lo, v3 *hi)
{
    *lo = *hi = mesh->vertex_count ? mesh->position[0] : (v3){0};
    for (uint32_t i = 1; i < mesh->vertex_count; i++) {
        *lo = v3_min(mesh->position[i], *lo);
        *hi = v3_max(mesh->position[i], *hi);
    }
}

/* One vertex of the sphere. Poles and the seam are set exactly, so that doubled vertices are equal bit by bit. */
static void sphere_vertex(amb_mesh *mesh, uint32_t at, int ring, int segment, int rings, int segments)
{
    float v = (float)ring / (float)rings, u = (float)segment / (float)segments;
    float longitude = 2.0f * AMB_PI * ((float)(segment % segments) / (float)segments);
    bool pole = ring == 0 || ring == rings;
    float radius = pole ? 0.0f : f_sin(AMB_PI * v);
    float height = ring == 0 ? 1.0f : ring == rings ? -1.0f : f_cos(AMB_PI * v);
    /* u grows eastward: seen from outside with north up, the texture is not mirrored. */
    v3 p = v3_of(radius * f_cos(longitude), height, -radius * f_sin(longitude));
    mesh->position[at] = p;
    mesh->normal[at] = v3_normalize(p);
    mesh->uv[at] = v2_of(u, v);
    mesh->tangent[at] = v4_of(-f_sin(longitude), 0.0f, -f_cos(longitude), -1.0f);
}

amb_status amb_mesh_sphere(int rings, int segments, amb_mesh **out, amb_error *error)
{
    if (!out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "sphere: out is NULL; it must point to a mesh handle");
    *out = NULL;
    if (rings < 2 || rings > 8192)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "sphere: rings is %d; allowed are 2 to 8192", rings);
    if (segments < 3 || segments > 8192)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "sphere: segments is %d; allowed are 3 to 8192", segments);

    uint32_t columns = (uint32_t)segments + 1, rows = (uint32_t)rings + 1;
    amb_mesh *mesh = NULL;
    amb_status status = amb_mesh_create(columns * rows, 2 * (uint32_t)segments * ((uint32_t)rings - 1), &mesh, error);
    if (status)
        return status;
    mesh->normal = mesh_array(mesh->vertex_count, sizeof *mesh->normal);
    mesh->uv = mesh_array(mesh->vertex_count, sizeof *mesh->uv);
    mesh->tangent = mesh_array(mesh->vertex_count, sizeof *mesh->tangent);
    if (!mesh->normal || !mesh->uv || !mesh->tangent) {
        amb_mesh_close(&mesh);
        return amb_fail(error, AMB_ERROR_MEMORY, "sphere: no memory for %d by %d quads", rings, segments);
    }
    for (int r = 0; r <= rings; r++)
        for (int s = 0; s <= segments; s++)
            sphere_vertex(mesh, (uint32_t)r * columns + (uint32_t)s, r, s, rings, segments);

    uint32_t *corner = mesh->index;
    for (uint32_t r = 0; r < (uint32_t)rings; r++)
        for (uint32_t s = 0; s < (uint32_t)segments; s++) {
            uint32_t a = r * columns + s, b = a + 1, c = a + columns, d = c + 1; /* a b above c d, seen from outside */
            if (r > 0) { /* at the north pole a and b are one point */
                *corner++ = a;
                *corner++ = c;
                *corner++ = b;
            }
            if (r + 1 < (uint32_t)rings) {
                *corner++ = b;
                *corner++ = c;
                *corner++ = d;
            }
        }
    *out = mesh;
    return AMB_OK;
}
