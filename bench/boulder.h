/* A boulder: a sphere moved along its normals by noise, with normals, tangents and UVs. */
#ifndef AMB_BENCH_BOULDER_H
#define AMB_BENCH_BOULDER_H

#include <ambiance/mesh.h>

/* About 2 · rings · segments triangles. */
amb_status boulder_create(int rings, int segments, amb_mesh **out, amb_error *error);

#endif
