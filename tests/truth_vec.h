/* Vectors in double precision and random numbers, for the truths that planets are tested against. */
#ifndef AMB_TESTS_TRUTH_VEC_H
#define AMB_TESTS_TRUTH_VEC_H

#include <ambiance/vec.h>
#include <math.h>

#define PI 3.14159265358979323846

static uint64_t random_state = 12345;
/* In [lo, hi): a linear congruential generator (D. E. Knuth's MMIX constants). */
static inline double uniform(double lo, double hi)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(random_state >> 11) * 0x1p-53;
}

typedef struct vec {
    double x, y, z;
} vec;
static inline vec vec_of(v3 a) { return (vec){(double)a.x, (double)a.y, (double)a.z}; }
static inline v3x v3x_from(vec a) { return (v3x){(float)a.x, (float)a.y, (float)a.z}; }
static inline vec vec_ofx(v3x a) { return (vec){(double)a.x, (double)a.y, (double)a.z}; }
static inline v3 v3_from(vec a) { return (v3){(float)a.x, (float)a.y, (float)a.z}; }
static inline double vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec vec_add(vec a, vec b, double k) { return (vec){a.x + b.x * k, a.y + b.y * k, a.z + b.z * k}; }
static inline vec vec_unit(vec a) { return vec_add((vec){0, 0, 0}, a, 1.0 / sqrt(vec_dot(a, a))); }
static inline vec vec_cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec random_direction(void)
{
    double z = uniform(-1, 1), a = uniform(0, 2 * PI), r = sqrt(1 - z * z);
    return (vec){r * cos(a), r * sin(a), z};
}

#endif
