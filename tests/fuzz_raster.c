/* Random pipelines, meshes, targets and states against the truth rasterizer. */
#include "tests/raster_random.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static amb_context *context[3];
    const amb_isa isas[3] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    char what[64];
    int i = size > 0 ? data[0] % 3 : 0;
    amb_context_options options = {amb_isa_available(isas[i]) ? isas[i] : AMB_ISA_AUTO, 1};
    if (!context[i] && amb_context_create(&options, &context[i], NULL) != AMB_OK)
        return 0;
    if (size > 0 && raster_random_differences(context[i], data + 1, size - 1, what) > 0)
        abort();
    return 0;
}
