/* Shaders of the elevated tests, one set per instruction set. */
#ifndef TESTS_ELEVATED_PROBE_H
#define TESTS_ELEVATED_PROBE_H

#include "scenes/elevated.h"

#include <ambiance/raster.h>

typedef struct elevated_probe {
    int lanes, varying_floats;
    amb_hull_shader hull, careless_hull; /* the scene's; one whose patches do not agree about their edges */
    amb_domain_shader domain;
    amb_fragment_shader signed_cover; /* 1 where a front faces, -1 where a back does */
    /* Heights that the domain shader gives `count` points of the plane, a multiple of 16. */
    void (*heights)(const elevated_uniforms *uniforms, const float *x, const float *z, float *y, int count);
} elevated_probe;

#endif
