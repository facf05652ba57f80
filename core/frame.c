#include <ambiance/frame.h>

#include <stdlib.h>
#include <string.h>

amb_status amb_frame_create(int width, int height, amb_frame **out, amb_error *error)
{
    *out = NULL;
    amb_frame *frame = calloc(1, sizeof *frame);
    if (!frame)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a frame");
    frame->width = width;
    frame->height = height;
    amb_image *color;
    amb_status status = amb_frame_add_layer(frame, "color", 4, &color, error);
    if (status != AMB_OK) {
        amb_frame_close(&frame);
        return status;
    }
    *out = frame;
    return AMB_OK;
}

void amb_frame_close(amb_frame **frame)
{
    if (!frame || !*frame)
        return;
    for (int i = 0; i < (*frame)->layer_count; i++)
        amb_image_close(&(*frame)->layer[i].image);
    free((*frame)->meta.parameters);
    free((*frame)->meta.post);
    free(*frame);
    *frame = NULL;
}

amb_status amb_frame_add_layer(amb_frame *frame, const char *name, int channels, amb_image **out, amb_error *error)
{
    *out = NULL;
    size_t length = strlen(name);
    if (length == 0 || length >= sizeof frame->layer[0].name)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "layer name '%.64s': 1 to %zu characters", name,
                        sizeof frame->layer[0].name - 1);
    if (amb_frame_layer(frame, name))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "layer '%s': the frame already has it", name);
    if (frame->layer_count == AMB_MAX_LAYERS)
        return amb_fail(error, AMB_ERROR_LIMIT, "layer '%s': a frame holds at most %d layers", name, AMB_MAX_LAYERS);
    amb_layer *layer = &frame->layer[frame->layer_count];
    amb_status status = amb_image_create(frame->width, frame->height, channels, &layer->image, error);
    if (status != AMB_OK)
        return status;
    memcpy(layer->name, name, length + 1);
    frame->layer_count++;
    *out = layer->image;
    return AMB_OK;
}

amb_image *amb_frame_layer(const amb_frame *frame, const char *name)
{
    for (int i = 0; i < frame->layer_count; i++)
        if (strcmp(frame->layer[i].name, name) == 0)
            return frame->layer[i].image;
    return NULL;
}
