/* amb_read_mesh: OBJ, PLY and glTF through Assimp's C API, all meshes of a file in one. */
#include "io/file.h"
#include "io/mesh_check.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <stdio.h>
#include <stdlib.h>
#include <strings.h>

static const char *extension_of(const char *path)
{
    static const char *const known[] = {"obj", "ply", "gltf", "glb"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof known / sizeof *known; i++)
        if (strcasecmp(dot + 1, known[i]) == 0)
            return known[i];
    return NULL;
}

/* Which of a file's meshes are triangles, and their sums. */
typedef struct mesh_sums {
    uint64_t vertices, triangles;
    bool has_normals, has_uvs, has_materials;
} mesh_sums;

static bool is_used(const struct aiMesh *part)
{
    return part->mNumVertices > 0 && part->mNumFaces > 0 && (part->mPrimitiveTypes & 0xfu) == aiPrimitiveType_TRIANGLE;
}

static mesh_sums sum_parts(const struct aiScene *scene)
{
    mesh_sums sums = {.has_normals = true, .has_uvs = true};
    bool first = true;
    unsigned material = 0;
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        const struct aiMesh *part = scene->mMeshes[i];
        if (!is_used(part))
            continue;
        sums.vertices += part->mNumVertices;
        sums.triangles += part->mNumFaces;
        sums.has_normals &= part->mNormals != NULL;
        sums.has_uvs &= part->mTextureCoords[0] != NULL;
        sums.has_materials |= !first && part->mMaterialIndex != material;
        material = part->mMaterialIndex;
        first = false;
    }
    return sums;
}

static amb_status copy_vertices(const struct aiMesh *part, uint32_t base, const char *name, amb_mesh *mesh,
                                amb_error *error)
{
    for (uint32_t i = 0; i < part->mNumVertices; i++) {
        struct aiVector3D p = part->mVertices[i];
        mesh->position[base + i] = (v3){p.x, p.y, p.z};
        if (mesh->normal) {
            struct aiVector3D n = part->mNormals[i];
            if (!f_is_finite(n.x) || !f_is_finite(n.y) || !f_is_finite(n.z))
                return amb_fail(error, AMB_ERROR_FORMAT, "%s: normal of vertex %u is (%g, %g, %g); it must be finite",
                                name, base + i, (double)n.x, (double)n.y, (double)n.z);
            v3 unit = v3_normalize((v3){n.x, n.y, n.z});
            mesh->normal[base + i] = v3_dot(unit, unit) > 0.5f ? unit : (v3){0.0f, 1.0f, 0.0f};
        }
        if (mesh->uv) {
            struct aiVector3D t = part->mTextureCoords[0][i];
            if (!f_is_finite(t.x) || !f_is_finite(t.y))
                return amb_fail(error, AMB_ERROR_FORMAT, "%s: UV of vertex %u is (%g, %g); it must be finite", name,
                                base + i, (double)t.x, (double)t.y);
            mesh->uv[base + i] = (v2){t.x, t.y};
        }
    }
    return AMB_OK;
}

static amb_status copy_part(const struct aiMesh *part, uint32_t base, uint32_t triangle, const char *name,
                            amb_mesh *mesh, amb_error *error)
{
    amb_status status = copy_vertices(part, base, name, mesh, error);
    for (uint32_t f = 0; status == AMB_OK && f < part->mNumFaces; f++, triangle++) {
        const struct aiFace *face = &part->mFaces[f];
        for (unsigned k = 0; k < 3; k++) {
            if (face->mNumIndices != 3 || face->mIndices[k] >= part->mNumVertices)
                return amb_fail(error, AMB_ERROR_FORMAT, "%s: triangle %u names a vertex that is not there", name,
                                triangle);
            mesh->index[3 * (size_t)triangle + k] = base + face->mIndices[k];
        }
        if (mesh->material)
            mesh->material[triangle] = part->mMaterialIndex;
    }
    return status;
}

static amb_status create_mesh(const mesh_sums *sums, const char *name, amb_mesh **out, amb_error *error)
{
    if (sums->triangles == 0)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: the file holds no triangles", name);
    if (sums->vertices > AMB_MAX_MESH_VERTICES || sums->triangles > AMB_MAX_MESH_TRIANGLES)
        return amb_fail(error, AMB_ERROR_LIMIT, "%s: %llu vertices, %llu triangles; at most %u of each are allowed",
                        name, (unsigned long long)sums->vertices, (unsigned long long)sums->triangles,
                        AMB_MAX_MESH_VERTICES);
    amb_status status = amb_mesh_create((uint32_t)sums->vertices, (uint32_t)sums->triangles, out, error);
    if (status != AMB_OK)
        return status;
    amb_mesh *mesh = *out;
    if (sums->has_normals)
        mesh->normal = malloc(sums->vertices * sizeof *mesh->normal);
    if (sums->has_uvs)
        mesh->uv = malloc(sums->vertices * sizeof *mesh->uv);
    if (sums->has_materials)
        mesh->material = malloc(sums->triangles * sizeof *mesh->material);
    if ((sums->has_normals && !mesh->normal) || (sums->has_uvs && !mesh->uv) ||
        (sums->has_materials && !mesh->material))
        return amb_fail(error, AMB_ERROR_MEMORY, "%s: out of memory for %llu vertices", name,
                        (unsigned long long)sums->vertices);
    return AMB_OK;
}

static amb_status convert(const struct aiScene *scene, const char *name, amb_mesh **out, amb_error *error)
{
    if (!scene) {
        const char *why = aiGetErrorString();
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: damaged or unsupported model%s%.200s", name,
                        why && *why ? ": " : "", why ? why : "");
    }
    mesh_sums sums = sum_parts(scene);
    amb_status status = create_mesh(&sums, name, out, error);
    uint32_t vertex = 0, triangle = 0;
    for (unsigned i = 0; status == AMB_OK && i < scene->mNumMeshes; i++) {
        const struct aiMesh *part = scene->mMeshes[i];
        if (!is_used(part))
            continue;
        status = copy_part(part, vertex, triangle, name, *out, error);
        vertex += part->mNumVertices;
        triangle += part->mNumFaces;
    }
    if (status == AMB_OK) {
        amb_error detail;
        status = amb_mesh_check(*out, &detail);
        if (status != AMB_OK)
            amb_fail(error, status, "%s: %s", name, detail.detail);
    }
    if (status != AMB_OK)
        amb_mesh_close(out);
    return status;
}

/* Validation comes first: the later steps index by what the file says. Points and lines are dropped; UVs turn v down.
 */
static const unsigned import_steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType |
                                     aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices |
                                     aiProcess_FlipUVs | aiProcess_RemoveComponent;

static struct aiPropertyStore *import_properties(void)
{
    struct aiPropertyStore *store = aiCreatePropertyStore();
    if (store) {
        aiSetImportPropertyInteger(store, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
        /* What amb_mesh does not keep must not keep vertices apart. */
        aiSetImportPropertyInteger(store, AI_CONFIG_PP_RVC_FLAGS,
                                   aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_BONEWEIGHTS |
                                       aiComponent_ANIMATIONS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                                       aiComponent_CAMERAS);
    }
    return store;
}

amb_status amb_read_mesh_memory(const void *data, size_t bytes, const char *extension, const char *name, amb_mesh **out,
                                amb_error *error)
{
    *out = NULL;
    amb_status status = amb_check_mesh_file(data, bytes, extension, name, error);
    if (status != AMB_OK)
        return status;
    if (bytes > UINT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "%s: %zu bytes; a model may have at most %u", name, bytes, UINT32_MAX);
    struct aiPropertyStore *store = import_properties();
    if (!store)
        return amb_fail(error, AMB_ERROR_MEMORY, "%s: out of memory", name);
    const struct aiScene *scene =
        aiImportFileFromMemoryWithProperties(data, (unsigned)bytes, import_steps, extension, store);
    status = convert(scene, name, out, error);
    aiReleaseImport(scene);
    aiReleasePropertyStore(store);
    return status;
}

amb_status amb_read_mesh(const char *path, amb_mesh **out, amb_error *error)
{
    uint8_t *data = NULL;
    size_t bytes;
    *out = NULL;
    amb_status status = amb_read_file(path, &data, &bytes, error);
    const char *extension = status == AMB_OK ? extension_of(path) : NULL;
    if (status == AMB_OK && !extension)
        status = amb_fail(error, AMB_ERROR_FORMAT, "%s: unknown kind of model; allowed are .obj .ply .gltf .glb", path);
    if (status == AMB_OK)
        status = amb_check_mesh_file(data, bytes, extension, path, error);
    free(data);
    if (status != AMB_OK)
        return status;
    struct aiPropertyStore *store = import_properties();
    if (!store)
        return amb_fail(error, AMB_ERROR_MEMORY, "%s: out of memory", path);
    const struct aiScene *scene = aiImportFileExWithProperties(path, import_steps, NULL, store);
    status = convert(scene, path, out, error);
    aiReleaseImport(scene);
    aiReleasePropertyStore(store);
    return status;
}
