#include "tests/raster_shaders.h"
#include "core/dispatch.h"

AMB_DECLARE_WIDE(const raster_test_shaders *, raster_test_shaders_get, (void));

const raster_test_shaders *raster_test_shaders_of(amb_isa isa) { return AMB_DISPATCH(isa, raster_test_shaders_get)(); }
