/* Shared by the earth workload's files. */
#ifndef AMB_BENCH_EARTH_H
#define AMB_BENCH_EARTH_H

#include "bench/gl.h"
#include "scenes/planet_air_wide.h"

/* What one frame of the scene draws, for the peer to draw the same. */
typedef struct earth_twin {
    planet_view view;
    amb_atmosphere air;
    const amb_texture *ground, *relief, *night,
        *clouds; /* colour and water; normals and height; lights; normals, cover */
    float wrap, night_gain, gloss, gloss_exponent, bump, parallax, cover, cloud_shell, cloud_ring, cloud_shadow,
        cloud_bump, ground_gain, dome_gain;
} earth_twin;

typedef struct earth_peer {
    earth_twin twin;
    GLuint program[4], textures[4]; /* programs: ground, clouds, air before the ground, dome */
    GLuint fine, plain;             /* samplers */
    gl_mesh sphere;
    gl_target target;
} earth_peer;

amb_status earth_peer_open(const earth_twin *twin, int width, int height, earth_peer *out, amb_error *error);
amb_status earth_peer_run(const earth_peer *peer, amb_error *error);
void earth_peer_close(earth_peer *peer);

#endif
