/* Scene hillscape: the fire's particles, a closed form of time: any moment is had directly, without the ones before. */
#ifndef AMB_SCENES_HILLSCAPE_FIRE_H
#define AMB_SCENES_HILLSCAPE_FIRE_H

#include <ambiance/vec.h>

enum { FIRE_FLAMES = 90, FIRE_SPARKS = 70, FIRE_SMOKE = 60, FIRE_PARTICLES = FIRE_FLAMES + FIRE_SPARKS + FIRE_SMOKE };

typedef struct fire_particle {
    v3 offset;  /* from the fire's foot, m */
    float size; /* radius, m */
    float age;  /* 0 … 1 of its life */
    float kind; /* 0 flame, 1 spark, 2 smoke */
    float seed; /* 0 … 1, of this life */
    float unused;
} fire_particle;

/* Particle i at any finite time. Every life of it (they follow each other without a gap, all as long as its kind's) has
 * a number, from which its chances come. Times beyond 10¹² s count as that. */
fire_particle fire_particle_at(int i, double time);

#endif
