/* Fields for the mesher's tests, one variant an instruction set. */
#ifndef AMB_TESTS_ISOSURFACE_FIELDS_WIDE_H
#define AMB_TESTS_ISOSURFACE_FIELDS_WIDE_H

#include <ambiance/isosurface.h>

typedef enum test_field {
    FIELD_SPHERE, /* radius 0.7 */
    FIELD_TORUS,  /* 0.6, 0.2 */
    FIELD_TANGLE, /* many thin, touching and crossing parts, ambiguous in most cells */
    FIELD_NOISE,  /* a hash of the grid corner: every sign pattern, every ambiguous face */
    FIELD_STEEP,  /* a sphere whose values are twice the distance */
    FIELD_EMPTY,
    FIELD_COUNT
} test_field;

amb_field test_field_at_x1(test_field which);
amb_field test_field_at_x4(test_field which);
amb_field test_field_at_x8(test_field which);
amb_field test_field_at_x16(test_field which);

#endif
