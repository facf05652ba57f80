/* The compare modes on lanes: depth tests and comparison sampling. */
#ifndef AMBIANCE_CORE_COMPARE_LANES_H
#define AMBIANCE_CORE_COMPARE_LANES_H

#include <ambiance/texture.h>

/* Where `a OP b`. DEFAULT must have been replaced; it never passes. */
AMB_INLINE maskx compare_lanes(amb_compare mode, f32x a, f32x b)
{
    switch (mode) {
    case AMB_LESS:
        return a < b;
    case AMB_EQUAL:
        return a == b;
    case AMB_LESS_EQUAL:
        return a <= b;
    case AMB_GREATER:
        return a > b;
    case AMB_NOT_EQUAL:
        return a != b;
    case AMB_GREATER_EQUAL:
        return a >= b;
    case AMB_ALWAYS:
        return m_set(true);
    case AMB_NEVER:
    case AMB_COMPARE_DEFAULT:
        break;
    }
    return m_set(false);
}

#endif
