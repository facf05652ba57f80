/* Is a mesh a closed, oriented surface? */
#ifndef AMB_TESTS_MANIFOLD_H
#define AMB_TESTS_MANIFOLD_H

#include <ambiance/mesh.h>

/* Fails the test unless every directed edge is there once, its opposite too, and around each vertex the triangles form
 * one closed fan. Returns the Euler characteristic V - E + F. */
int check_manifold(const amb_mesh *mesh);

#endif
