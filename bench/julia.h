/* Shared by the julia workload's files: the scene's numbers, as its parameter table and camera give them. */
#ifndef AMB_BENCH_JULIA_H
#define AMB_BENCH_JULIA_H

#include "bench/bench.h"
#include "scenes/julia.h"

#include <ambiance/camera.h>
#include <ambiance/march.h>
#include <ambiance/scene.h>
#include <ambiance/texture.h>

typedef struct julia_peer {
    gl_target target, coarse, starts; /* the last two: one pixel a tile of the picture */
    GLuint cone, march, array, environment, irradiance;
} julia_peer;

/* Everything the twin needs; params is the scene's struct, read through its table. */
typedef struct julia_twin {
    const amb_params *table;
    const void *params;
    julia_set set;
    amb_camera camera;
    const amb_texture *environment, *irradiance;
    int width, height;
} julia_twin;

/* A parameter of the scene by name; zeros when there is none. */
float julia_parameter(const julia_twin *twin, const char *name);
v3 julia_parameter3(const julia_twin *twin, const char *name);
int julia_parameter_int(const julia_twin *twin, const char *name);
/* Operations of one picture, about. */
double julia_count_flops(const julia_twin *twin, amb_march_limits limits, v3 to_light);

amb_status julia_peer_open(julia_peer *peer, const julia_twin *twin, amb_error *error);
amb_status julia_peer_run(const julia_peer *peer, amb_error *error);
void julia_peer_close(julia_peer *peer);

#endif
