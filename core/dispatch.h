/* Choosing the variant of a *_wide.c function from code that is compiled once.
 *
 *   AMB_DECLARE_WIDE(void, amb_tile_play, (tile *t));           // declares every variant of this build
 *   AMB_DISPATCH(amb_context_isa(context), amb_tile_play)(&t);  // the variant of that instruction set */
#ifndef AMB_CORE_DISPATCH_H
#define AMB_CORE_DISPATCH_H

#include <ambiance/context.h>

#if defined(__x86_64__)
#define AMB_DECLARE_WIDE(result, name, arguments) \
    result name##_x4 arguments;                   \
    result name##_x8 arguments;                   \
    result name##_x16 arguments
#define AMB_DISPATCH(isa, name) ((isa) == AMB_ISA_V4 ? name##_x16 : (isa) == AMB_ISA_V3 ? name##_x8 : name##_x4)
#else
#define AMB_DECLARE_WIDE(result, name, arguments) result name##_x4 arguments
#define AMB_DISPATCH(isa, name) ((void)(isa), name##_x4)
#endif

#endif
