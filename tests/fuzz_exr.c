/* libFuzzer target: any bytes as an OpenEXR file give a frame or an error, nothing else. */
#include "io/file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    amb_frame *frame;
    amb_error error;
    amb_status status = amb_read_exr_memory(data, bytes, "fuzz.exr", &frame, &error);
    if ((status == AMB_OK) != (frame != NULL))
        __builtin_trap();
    amb_frame_close(&frame);
    return 0;
}
