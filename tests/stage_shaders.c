#include "tests/stage_shaders.h"
#include "core/dispatch.h"

AMB_DECLARE_WIDE(const stage_test_shaders *, stage_test_shaders_get, (void));

const stage_test_shaders *stage_test_shaders_of(amb_isa isa) { return AMB_DISPATCH(isa, stage_test_shaders_get)(); }
