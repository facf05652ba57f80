/* Normals and tangents of meshes. Sums run in double and in triangle order, so that scale does not matter and equal
 * meshes give equal bits. */
#include <ambiance/math.h>
#include <ambiance/mesh.h>
#include <stdlib.h>

typedef struct {
    double x, y, z;
} d3;

static d3 d3_sub(v3 a, v3 b)
{
    return (d3){(double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z};
}
static double d3_dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static d3 d3_scale(d3 a, double s) { return (d3){a.x * s, a.y * s, a.z * s}; }
static d3 d3_add(d3 a, d3 b) { return (d3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static d3 d3_of(v3 a) { return (d3){(double)a.x, (double)a.y, (double)a.z}; }
static v3 d3_float(d3 a) { return v3_of((float)a.x, (float)a.y, (float)a.z); }
static d3 d3_cross(d3 a, d3 b) { return (d3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
/* False (and untouched) when there is no direction to speak of. */
static bool d3_unit(d3 *a)
{
    double square = d3_dot(*a, *a);
    if (!(square > 1e-290) || !(square < 1e290))
        return false;
    *a = d3_scale(*a, 1.0 / __builtin_sqrt(square));
    return true;
}

/* ---- welding ---------------------------------------------------------------------------------------------------- */

static uint32_t position_hash(v3 p)
{
    float f[3] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; /* -0 becomes +0: they compare equal */
    uint32_t word[3];
    memcpy(word, f, sizeof word);
    uint32_t h = word[0] * 0x9e3779b1u ^ (word[1] + 0x7f4a7c15u) * 0x85ebca6bu ^ (word[2] + 0x165667b1u) * 0xc2b2ae35u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    return h ^ h >> 13;
}

/* group[i] becomes the lowest vertex with vertex i's position. */
static amb_status weld_vertices(const amb_mesh *mesh, uint32_t *group, amb_error *error)
{
    size_t slots = 16;
    while (slots < 2 * (size_t)mesh->vertex_count)
        slots *= 2;
    uint32_t *table = calloc(slots, sizeof *table); /* vertex + 1; 0 is empty */
    if (!table)
        return amb_fail(error, AMB_ERROR_MEMORY, "mesh: no memory to weld %u vertices", mesh->vertex_count);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        v3 p = mesh->position[i];
        size_t slot = position_hash(p) & (slots - 1);
        group[i] = i;
        while (table[slot]) {
            v3 q = mesh->position[table[slot] - 1];
            if (p.x == q.x && p.y == q.y && p.z == q.z) {
                group[i] = table[slot] - 1;
                break;
            }
            slot = (slot + 1) & (slots - 1);
        }
        if (!table[slot])
            table[slot] = i + 1;
    }
    free(table);
    return AMB_OK;
}

/* ---- normals ---------------------------------------------------------------------------------------------------- */

/* Adds the face's unit normal to its corners, weighted by the corner's angle (Thürmer & Wüthrich 1998). */
static void add_face_normal(const amb_mesh *mesh, const uint32_t corner[3], const uint32_t *group, d3 *sum)
{
    v3 p[3];
    for (int i = 0; i < 3; i++)
        p[i] = mesh->position[corner[i]];
    d3 normal = d3_cross(d3_sub(p[1], p[0]), d3_sub(p[2], p[0]));
    if (!d3_unit(&normal))
        return;
    for (int i = 0; i < 3; i++) {
        d3 a = d3_sub(p[(i + 1) % 3], p[i]), b = d3_sub(p[(i + 2) % 3], p[i]);
        if (!d3_unit(&a) || !d3_unit(&b))
            continue;
        d3 sine = d3_cross(a, b);
        float angle = f_atan2((float)__builtin_sqrt(d3_dot(sine, sine)), (float)d3_dot(a, b));
        uint32_t to = group ? group[corner[i]] : corner[i];
        sum[to] = d3_add(sum[to], d3_scale(normal, (double)angle));
    }
}

amb_status amb_mesh_smooth_normals(amb_mesh *mesh, bool weld, amb_error *error)
{
    amb_status status = amb_mesh_check(mesh, error);
    if (status)
        return status;
    size_t count = mesh->vertex_count ? mesh->vertex_count : 1;
    v3 *normal = mesh->normal ? mesh->normal : calloc(count, sizeof *normal);
    d3 *sum = calloc(count, sizeof *sum);
    uint32_t *group = weld ? calloc(count, sizeof *group) : NULL;
    if (!normal || !sum || (weld && !group)) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "mesh: no memory for %u normals", mesh->vertex_count);
        goto error;
    }
    if (weld) {
        status = weld_vertices(mesh, group, error);
        if (status)
            goto error;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++)
        add_face_normal(mesh, mesh->index + 3 * t, group, sum);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        d3 n = sum[group ? group[i] : i];
        normal[i] = d3_unit(&n) ? d3_float(n) : v3_of(0.0f, 1.0f, 0.0f);
    }
    mesh->normal = normal;
    normal = NULL;
error:
    if (normal != mesh->normal)
        free(normal);
    free(sum);
    free(group);
    return status;
}

/* ---- tangents --------------------------------------------------------------------------------------------------- */

/* Adds dP/du and dP/dv of a triangle to its corners (Lengyel, "Computing Tangent Space Basis Vectors", 2001). */
static void add_face_tangent(const amb_mesh *mesh, const uint32_t corner[3], d3 *along_u, d3 *along_v)
{
    const v3 *p = mesh->position;
    const v2 *uv = mesh->uv;
    d3 e1 = d3_sub(p[corner[1]], p[corner[0]]), e2 = d3_sub(p[corner[2]], p[corner[0]]);
    double s1 = (double)uv[corner[1]].x - (double)uv[corner[0]].x,
           t1 = (double)uv[corner[1]].y - (double)uv[corner[0]].y;
    double s2 = (double)uv[corner[2]].x - (double)uv[corner[0]].x,
           t2 = (double)uv[corner[2]].y - (double)uv[corner[0]].y;
    double area = s1 * t2 - s2 * t1;
    if (!(area > 1e-60 || area < -1e-60))
        return;
    d3 u = d3_scale(d3_add(d3_scale(e1, t2), d3_scale(e2, -t1)), 1.0 / area);
    d3 v = d3_scale(d3_add(d3_scale(e2, s1), d3_scale(e1, -s2)), 1.0 / area);
    for (int i = 0; i < 3; i++) {
        along_u[corner[i]] = d3_add(along_u[corner[i]], u);
        along_v[corner[i]] = d3_add(along_v[corner[i]], v);
    }
}

/* Gram-Schmidt against the normal; without a usable dP/du any direction orthogonal to the normal. */
static v4 vertex_tangent(v3 normal, d3 along_u, d3 along_v)
{
    d3 n = d3_of(normal);
    double length_u = __builtin_sqrt(d3_dot(along_u, along_u));
    d3 t = d3_add(along_u, d3_scale(n, -d3_dot(n, along_u)));
    if (!(d3_dot(t, t) > 1e-12 * length_u * length_u) || !d3_unit(&t)) {
        bool x_smallest = f_abs(normal.x) <= f_abs(normal.y) && f_abs(normal.x) <= f_abs(normal.z);
        t = d3_cross(n, x_smallest ? (d3){1, 0, 0} : (d3){0, n.y * n.y <= n.z * n.z, n.y * n.y > n.z * n.z});
        if (!d3_unit(&t))
            t = (d3){1, 0, 0};
    }
    v3 unit = d3_float(t);
    return v4_of3(unit, d3_dot(d3_cross(n, t), along_v) < 0.0 ? -1.0f : 1.0f);
}

amb_status amb_mesh_tangents(amb_mesh *mesh, amb_error *error)
{
    amb_status status = amb_mesh_check(mesh, error);
    if (status)
        return status;
    if (!mesh->normal || !mesh->uv)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "mesh: tangents need normals and UVs; this mesh has no %s",
                        mesh->normal ? "UVs" : "normals");
    size_t count = mesh->vertex_count ? mesh->vertex_count : 1;
    v4 *tangent = mesh->tangent ? mesh->tangent : calloc(count, sizeof *tangent);
    d3 *along_u = calloc(count, sizeof *along_u), *along_v = calloc(count, sizeof *along_v);
    if (!tangent || !along_u || !along_v) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "mesh: no memory for %u tangents", mesh->vertex_count);
        goto error;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++)
        add_face_tangent(mesh, mesh->index + 3 * i, along_u, along_v);
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        tangent[i] = vertex_tangent(mesh->normal[i], along_u[i], along_v[i]);
    mesh->tangent = tangent;
    tangent = NULL;
error:
    if (tangent != mesh->tangent)
        free(tangent);
    free(along_u);
    free(along_v);
    return status;
}
