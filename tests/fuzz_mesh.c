/* libFuzzer target: any bytes as a model, of the format that its first bytes suggest. */
#include "io/file.h"

static const char *guess_extension(const uint8_t *data, size_t bytes)
{
    if (bytes >= 3 && memcmp(data, "ply", 3) == 0)
        return "ply";
    if (bytes >= 4 && memcmp(data, "glTF", 4) == 0)
        return "glb";
    return bytes >= 1 && data[0] == '{' ? "gltf" : "obj";
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    amb_mesh *mesh;
    amb_error error;
    amb_status status = amb_read_mesh_memory(data, bytes, guess_extension(data, bytes), "fuzz", &mesh, &error);
    if ((status == AMB_OK) != (mesh != NULL) || (mesh && amb_mesh_check(mesh, &error) != AMB_OK))
        __builtin_trap();
    amb_mesh_close(&mesh);
    return 0;
}
