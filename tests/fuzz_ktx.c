/* libFuzzer target: any bytes as a KTX file. */
#include "io/file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    amb_texture *texture;
    amb_error error;
    amb_status status = amb_read_ktx_memory(data, bytes, "fuzz.ktx", &texture, &error);
    if ((status == AMB_OK) != (texture != NULL))
        __builtin_trap();
    amb_texture_close(&texture);
    return 0;
}
