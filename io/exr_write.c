/* amb_write_exr: one scanline part, ZIP (16 lines a chunk), chunks from the top. */
#include "io/file.h"

#include <ambiance/half.h>
#include <openexr.h>

#include <stdio.h>
#include <stdlib.h>

#define EXR_CHUNK_LINES 16 /* of ZIP */

typedef struct exr_plane { /* a channel of the file */
    char name[48];
    const amb_image *image;
    int channel; /* of the image */
} exr_plane;

typedef struct exr_writer {
    const amb_frame *frame;
    const char *path;
    amb_pixel_type type;
    amb_output *output;
    exr_context_t context;
    exr_encode_pipeline_t pipeline;
    exr_plane *planes; /* sorted by name, as the file stores them */
    int plane_count;
    uint16_t *halves;  /* a chunk's worth; NULL for floats */
    amb_status status; /* of the last write; the library's own code says less */
    amb_error *error;
} exr_writer;

/* Reports by its return value only: during the header the library holds its lock, and its error function takes it. */
static int64_t stream_write(exr_const_context_t context, void *user, const void *buffer, uint64_t bytes,
                            uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    exr_writer *writer = user;
    (void)context;
    (void)fail;
    if (writer->status == AMB_OK)
        writer->status = amb_output_write_at(writer->output, buffer, (size_t)bytes, offset, writer->error);
    return writer->status == AMB_OK ? (int64_t)bytes : -1;
}

/* The library would print; its codes say enough. */
static void stream_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

static amb_status check(exr_writer *writer, exr_result_t code)
{
    if (writer->status == AMB_OK && code != EXR_ERR_SUCCESS)
        writer->status = amb_fail(writer->error, code == EXR_ERR_OUT_OF_MEMORY ? AMB_ERROR_MEMORY : AMB_ERROR_IO,
                                  "cannot write '%s': %s", writer->path, exr_get_default_error_message(code));
    return writer->status;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const exr_plane *)a)->name, ((const exr_plane *)b)->name);
}

/* "R" for color, "NAME.R" for other layers of 3 or 4 channels, "NAME.X" for those of 1 or 2. */
static amb_status list_planes(exr_writer *writer)
{
    const amb_frame *frame = writer->frame;
    for (int l = 0; l < frame->layer_count; l++)
        writer->plane_count += frame->layer[l].image->channels;
    writer->planes = calloc((size_t)writer->plane_count + 1, sizeof *writer->planes);
    if (!writer->planes)
        return amb_fail(writer->error, AMB_ERROR_MEMORY, "cannot write '%s': out of memory", writer->path);
    exr_plane *plane = writer->planes;
    for (int l = 0; l < frame->layer_count; l++) {
        const amb_layer *layer = &frame->layer[l];
        const char *letters = layer->image->channels > 2 ? "RGBA" : "XY";
        bool is_color = strcmp(layer->name, "color") == 0;
        for (int c = 0; c < layer->image->channels; c++, plane++) {
            snprintf(plane->name, sizeof plane->name, "%s%s%c", is_color ? "" : layer->name, is_color ? "" : ".",
                     letters[c]);
            plane->image = layer->image;
            plane->channel = c;
        }
    }
    qsort(writer->planes, (size_t)writer->plane_count, sizeof *writer->planes, by_name);
    return AMB_OK;
}

static void set_string(exr_writer *writer, const char *name, const char *value)
{
    if (value && *value)
        check(writer, exr_attr_set_string(writer->context, 0, name, value));
}

static amb_status write_header(exr_writer *writer)
{
    const amb_frame *frame = writer->frame;
    const amb_metadata *meta = &frame->meta;
    exr_pixel_type_t type = writer->type == AMB_HALF ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    exr_context_t context = writer->context;
    int part;
    check(writer, exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part));
    check(writer, exr_initialize_required_attr_simple(context, 0, frame->width, frame->height, EXR_COMPRESSION_ZIP));
    for (int i = 0; i < writer->plane_count && writer->status == AMB_OK; i++)
        check(writer, exr_add_channel(context, 0, writer->planes[i].name, type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    set_string(writer, "ambiance.scene", meta->scene);
    if (meta->scene[0])
        check(writer, exr_attr_set_double(context, 0, "ambiance.time", meta->time));
    set_string(writer, "ambiance.parameters", meta->parameters);
    set_string(writer, "ambiance.post", meta->post);
    set_string(writer, "ambiance.assets", meta->assets_sha256);
    set_string(writer, "ambiance.version", meta->version);
    return check(writer, exr_write_header(context));
}

/* Points the pipeline at the floats themselves, or at halves made of them. */
static void set_chunk_source(exr_writer *writer, int y, int lines)
{
    int width = writer->frame->width;
    for (int i = 0; i < writer->plane_count; i++) {
        const exr_plane *plane = &writer->planes[i];
        exr_coding_channel_info_t *channel = &writer->pipeline.channels[i];
        if (writer->type == AMB_FLOAT) {
            channel->user_pixel_stride = sizeof(float);
            channel->user_line_stride = (int32_t)(plane->image->stride * sizeof(float));
            channel->encode_from_ptr = (const uint8_t *)amb_image_row(plane->image, plane->channel, y);
            continue;
        }
        uint16_t *to = writer->halves + (size_t)i * EXR_CHUNK_LINES * (size_t)width;
        channel->user_pixel_stride = sizeof(uint16_t);
        channel->user_line_stride = width * (int32_t)sizeof(uint16_t);
        channel->encode_from_ptr = (const uint8_t *)to;
        for (int line = 0; line < lines; line++) {
            const float *from = amb_image_row(plane->image, plane->channel, y + line);
            for (int x = 0; x < width; x++)
                *to++ = (uint16_t)f_to_half(from[x]);
        }
    }
}

static amb_status write_chunks(exr_writer *writer)
{
    int height = writer->frame->height;
    exr_chunk_info_t chunk;
    if (writer->type == AMB_HALF) {
        writer->halves = malloc((size_t)writer->plane_count * EXR_CHUNK_LINES * (size_t)writer->frame->width *
                                sizeof *writer->halves);
        if (!writer->halves)
            return writer->status =
                       amb_fail(writer->error, AMB_ERROR_MEMORY, "cannot write '%s': out of memory", writer->path);
    }
    for (int y = 0; y < height && writer->status == AMB_OK; y += EXR_CHUNK_LINES) {
        check(writer, exr_write_scanline_chunk_info(writer->context, 0, y, &chunk));
        if (writer->status != AMB_OK)
            break;
        if (y == 0)
            check(writer, exr_encoding_initialize(writer->context, 0, &chunk, &writer->pipeline));
        else
            check(writer, exr_encoding_update(writer->context, 0, &chunk, &writer->pipeline));
        if (writer->status != AMB_OK)
            break;
        set_chunk_source(writer, y, height - y < EXR_CHUNK_LINES ? height - y : EXR_CHUNK_LINES);
        if (y == 0)
            check(writer, exr_encoding_choose_default_routines(writer->context, 0, &writer->pipeline));
        if (writer->status == AMB_OK)
            check(writer, exr_encoding_run(writer->context, 0, &writer->pipeline));
    }
    exr_encoding_destroy(writer->context, &writer->pipeline);
    return writer->status;
}

amb_status amb_write_exr(const amb_frame *frame, const char *path, amb_pixel_type type, amb_error *error)
{
    exr_writer writer = {.frame = frame, .path = path, .type = type, .error = error};
    writer.status = amb_output_begin(path, &writer.output, error);
    if (writer.status == AMB_OK)
        writer.status = list_planes(&writer);
    if (writer.status == AMB_OK) {
        exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
        setup.error_handler_fn = stream_message;
        setup.user_data = &writer;
        setup.write_fn = stream_write;
        setup.zip_level = 4;
        check(&writer, exr_start_write(&writer.context, path, EXR_WRITE_FILE_DIRECTLY, &setup));
        if (writer.status == AMB_OK && write_header(&writer) == AMB_OK)
            write_chunks(&writer);
        check(&writer, exr_finish(&writer.context)); /* writes the chunk table */
    }
    if (writer.status == AMB_OK)
        writer.status = amb_output_commit(&writer.output, error);
    amb_output_abort(&writer.output);
    free(writer.halves);
    free(writer.planes);
    return writer.status;
}
