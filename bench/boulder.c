#include "bench/boulder.h"

#include <ambiance/noise.h>

amb_status boulder_create(int rings, int segments, amb_mesh **out, amb_error *error)
{
    amb_status status = amb_mesh_sphere(rings, segments, out, error);
    if (status)
        return status;
    for (uint32_t i = 0; i < (*out)->vertex_count; i++) {
        v3 p = (*out)->position[i];
        float bump =
            fbm3(noise_gradient3, (v3x){p.x * 2.0f, p.y * 2.0f, p.z * 2.0f}, (amb_lattice){0}, (amb_fbm){4, 2.0f, 0.5f})
                .value;
        (*out)->position[i] = v3_scale(p, 1.0f + 0.2f * bump);
    }
    status = amb_mesh_smooth_normals(*out, true, error);
    return status ? status : amb_mesh_tangents(*out, error);
}
