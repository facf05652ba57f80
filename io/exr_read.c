/* amb_read_exr: the first part of a flat OpenEXR file, scanline or tiled (level 0). */
#include "io/file.h"

#include <ambiance/half.h>
#include <openexr.h>

#include <stdio.h>
#include <stdlib.h>

/* No lossless coder of the library packs better: a header that promises more pixels than this allows is a lie. */
#define EXR_MAX_RATIO 4096

typedef struct exr_channel { /* a channel of the file, in file order */
    const char *name;        /* the library's */
    exr_pixel_type_t type;
    char layer[256];
    int rank;         /* place among its layer's channels by its letter; unknown letters come last */
    amb_image *image; /* where it goes */
    int channel;
} exr_channel;

typedef struct exr_reader {
    const uint8_t *data;
    size_t bytes;
    const char *name;
    exr_context_t context;
    exr_attr_box2i_t window; /* data window: of what is stored */
    exr_channel *channels;
    int channel_count;
    amb_frame *frame;
    char message[256]; /* the library's first */
    amb_error *error;
} exr_reader;

static int64_t stream_read(exr_const_context_t context, void *user, void *buffer, uint64_t bytes, uint64_t offset,
                           exr_stream_error_func_ptr_t fail)
{
    const exr_reader *reader = user;
    (void)context;
    (void)fail;
    if (offset >= reader->bytes)
        return 0;
    size_t count = reader->bytes - (size_t)offset;
    if (count > bytes)
        count = (size_t)bytes;
    memcpy(buffer, reader->data + offset, count);
    return (int64_t)count;
}

static int64_t stream_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const exr_reader *)user)->bytes;
}

static void stream_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    (void)code;
    if (exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user)
        return;
    exr_reader *reader = user;
    if (!reader->message[0])
        snprintf(reader->message, sizeof reader->message, "%s", message);
}

static amb_status check(exr_reader *reader, exr_result_t code)
{
    if (code == EXR_ERR_SUCCESS)
        return AMB_OK;
    return amb_fail(reader->error, code == EXR_ERR_OUT_OF_MEMORY ? AMB_ERROR_MEMORY : AMB_ERROR_FORMAT,
                    "%s: damaged or truncated EXR: %s", reader->name,
                    reader->message[0] ? reader->message : exr_get_default_error_message(code));
}

/* Refuses what cannot be read before memory is taken for it. */
static amb_status check_part(exr_reader *reader)
{
    exr_storage_t storage;
    exr_compression_t compression;
    amb_status status = check(reader, exr_get_storage(reader->context, 0, &storage));
    if (status == AMB_OK)
        status = check(reader, exr_get_compression(reader->context, 0, &compression));
    if (status == AMB_OK)
        status = check(reader, exr_get_data_window(reader->context, 0, &reader->window));
    if (status != AMB_OK)
        return status;
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return amb_fail(reader->error, AMB_ERROR_FORMAT, "%s: deep EXR; only flat images are read", reader->name);
    if (compression >= EXR_COMPRESSION_DWAA)
        return amb_fail(reader->error, AMB_ERROR_FORMAT,
                        "%s: EXR compressed with DWA; allowed are none, RLE, ZIPS, ZIP, PIZ, PXR24, B44 and B44A "
                        "(rewrite it: exrmaketiled -z zip in.exr out.exr)",
                        reader->name);
    const exr_attr_box2i_t *w = &reader->window;
    int64_t width = (int64_t)w->max.x - w->min.x + 1, height = (int64_t)w->max.y - w->min.y + 1;
    if (width < 1 || height < 1)
        return amb_fail(reader->error, AMB_ERROR_FORMAT, "%s: EXR of an empty data window", reader->name);
    if (width > AMB_MAX_IMAGE_SIZE || height > AMB_MAX_IMAGE_SIZE || width * height > AMB_MAX_IMAGE_PIXELS)
        return amb_fail(reader->error, AMB_ERROR_LIMIT,
                        "%s: EXR of %lldx%lld pixels; at most %d a side and %d in all are allowed", reader->name,
                        (long long)width, (long long)height, AMB_MAX_IMAGE_SIZE, AMB_MAX_IMAGE_PIXELS);
    return AMB_OK;
}

static int letter_rank(const char *letter)
{
    static const char ranks[] = "RGBAXYZW";
    const char *found = letter[0] && !letter[1] ? strchr(ranks, letter[0]) : NULL;
    return found ? (int)(found - ranks) % 4 : 4;
}

/* Splits "diffuse.left.R" into layer "diffuse.left" and rank 0. Without a dot: R G B A and a lone Y are "color", any
 * other name is its own layer. */
static void split_name(exr_channel *channel, bool has_rgb)
{
    const char *dot = strrchr(channel->name, '.');
    if (dot) {
        snprintf(channel->layer, sizeof channel->layer, "%.*s", (int)(dot - channel->name), channel->name);
        channel->rank = letter_rank(dot + 1);
    } else if ((channel->name[0] && !channel->name[1] && strchr("RGBA", channel->name[0])) ||
               (!has_rgb && strcmp(channel->name, "Y") == 0)) {
        snprintf(channel->layer, sizeof channel->layer, "color");
        channel->rank = strcmp(channel->name, "Y") == 0 ? 0 : letter_rank(channel->name);
    } else {
        snprintf(channel->layer, sizeof channel->layer, "%s", channel->name);
        channel->rank = 0;
    }
}

static amb_status list_channels(exr_reader *reader)
{
    const exr_attr_chlist_t *list;
    amb_status status = check(reader, exr_get_channels(reader->context, 0, &list));
    if (status != AMB_OK)
        return status;
    if (list->num_channels < 1 || list->num_channels > AMB_MAX_LAYERS * AMB_MAX_CHANNELS)
        return amb_fail(reader->error, list->num_channels < 1 ? AMB_ERROR_FORMAT : AMB_ERROR_LIMIT,
                        "%s: EXR of %d channels; allowed are 1 to %d", reader->name, list->num_channels,
                        AMB_MAX_LAYERS * AMB_MAX_CHANNELS);
    reader->channel_count = list->num_channels;
    reader->channels = calloc((size_t)list->num_channels, sizeof *reader->channels);
    if (!reader->channels)
        return amb_fail(reader->error, AMB_ERROR_MEMORY, "%s: out of memory", reader->name);
    bool has_rgb = false;
    uint64_t pixel_bytes = 0;
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            return amb_fail(reader->error, AMB_ERROR_FORMAT,
                            "%s: EXR channel '%.64s' is sampled every %dx%d pixels; only 1x1 is read", reader->name,
                            entry->name.str, entry->x_sampling, entry->y_sampling);
        reader->channels[i].name = entry->name.str;
        reader->channels[i].type = entry->pixel_type;
        has_rgb |= strcmp(entry->name.str, "R") == 0;
        pixel_bytes += entry->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    for (int i = 0; i < list->num_channels; i++)
        split_name(&reader->channels[i], has_rgb);
    uint64_t width = (uint64_t)(reader->window.max.x - reader->window.min.x) + 1;
    uint64_t height = (uint64_t)(reader->window.max.y - reader->window.min.y) + 1;
    if (width * height * pixel_bytes / EXR_MAX_RATIO > reader->bytes)
        return amb_fail(reader->error, AMB_ERROR_FORMAT,
                        "%s: truncated EXR: %zu bytes cannot hold %llux%llu pixels of %d channels", reader->name,
                        reader->bytes, (unsigned long long)width, (unsigned long long)height, reader->channel_count);
    return AMB_OK;
}

/* Makes a layer of every group of channels with one prefix (of every channel, when a prefix has more than four) and
 * tells each channel its place in it. */
static amb_status make_layers(exr_reader *reader)
{
    for (int i = 0; i < reader->channel_count; i++) {
        exr_channel *first = &reader->channels[i];
        if (first->image)
            continue;
        int group[AMB_MAX_LAYERS * AMB_MAX_CHANNELS], count = 0;
        for (int rank = 0; rank <= 4; rank++)
            for (int k = i; k < reader->channel_count; k++)
                if (reader->channels[k].rank == rank && strcmp(reader->channels[k].layer, first->layer) == 0)
                    group[count++] = k;
        if (count > AMB_MAX_CHANNELS) {
            for (int k = 0; k < count; k++)
                snprintf(reader->channels[group[k]].layer, sizeof first->layer, "%s", reader->channels[group[k]].name);
            group[0] = i;
            count = 1;
        }
        bool is_color = strcmp(first->layer, "color") == 0;
        amb_image *image = is_color ? amb_frame_layer(reader->frame, "color") : NULL;
        amb_error detail;
        amb_status status = AMB_OK;
        if (!image)
            status = amb_frame_add_layer(reader->frame, first->layer, count, &image, &detail);
        if (status != AMB_OK)
            return amb_fail(reader->error, status == AMB_ERROR_MEMORY ? status : AMB_ERROR_LIMIT, "%s: EXR %s",
                            reader->name, detail.detail);
        for (int k = 0; k < count; k++) {
            exr_channel *channel = &reader->channels[group[k]];
            channel->image = image;
            channel->channel = is_color && channel->rank < 4 ? channel->rank : k;
        }
    }
    return AMB_OK;
}

/* Colour that lacks channels: grey in all three from a lone one, alpha 1. */
static void complete_color(exr_reader *reader)
{
    bool present[4] = {false};
    amb_image *color = amb_frame_layer(reader->frame, "color");
    for (int i = 0; i < reader->channel_count; i++)
        if (reader->channels[i].image == color)
            present[reader->channels[i].channel] = true;
    for (int y = 0; y < color->height; y++) {
        float *row[4];
        for (int c = 0; c < 4; c++)
            row[c] = amb_image_row(color, c, y);
        size_t bytes = (size_t)color->width * sizeof(float);
        if (present[0] && !present[1] && !present[2]) {
            memcpy(row[1], row[0], bytes);
            memcpy(row[2], row[0], bytes);
        }
        if (present[0] && !present[3])
            for (int x = 0; x < color->width; x++)
                row[3][x] = 1.0f;
    }
}

/* A decoded chunk holds lines; each line the channels in file order; each channel the chunk's pixels. */
static amb_status unpack_chunk(exr_reader *reader, const exr_decode_pipeline_t *pipeline, int x, int y)
{
    const exr_chunk_info_t *chunk = &pipeline->chunk;
    const uint8_t *from = pipeline->unpacked_buffer;
    uint64_t needed = 0;
    for (int i = 0; i < reader->channel_count; i++)
        needed +=
            (uint64_t)chunk->width * (uint64_t)chunk->height * (reader->channels[i].type == EXR_PIXEL_HALF ? 2u : 4u);
    if (!from || chunk->unpacked_size < needed || chunk->width > reader->frame->width - x ||
        chunk->height > reader->frame->height - y)
        return check(reader, EXR_ERR_CORRUPT_CHUNK);
    for (int line = 0; line < chunk->height; line++)
        for (int i = 0; i < reader->channel_count; i++) {
            const exr_channel *channel = &reader->channels[i];
            float *to = amb_image_row(channel->image, channel->channel, y + line) + x;
            if (channel->type == EXR_PIXEL_HALF) {
                for (int k = 0; k < chunk->width; k++, from += 2) {
                    uint16_t half;
                    memcpy(&half, from, sizeof half);
                    to[k] = half_to_f(half);
                }
            } else if (channel->type == EXR_PIXEL_FLOAT) {
                memcpy(to, from, (size_t)chunk->width * sizeof *to);
                from += (size_t)chunk->width * sizeof *to;
            } else {
                for (int k = 0; k < chunk->width; k++, from += 4) {
                    uint32_t integer;
                    memcpy(&integer, from, sizeof integer);
                    to[k] = (float)integer;
                }
            }
        }
    return AMB_OK;
}

static amb_status read_chunk(exr_reader *reader, exr_decode_pipeline_t *pipeline, const exr_chunk_info_t *chunk, int x,
                             int y)
{
    bool is_first = !pipeline->channels;
    amb_status status = check(reader, is_first ? exr_decoding_initialize(reader->context, 0, chunk, pipeline)
                                               : exr_decoding_update(reader->context, 0, chunk, pipeline));
    if (status == AMB_OK && is_first) {
        status = check(reader, exr_decoding_choose_default_routines(reader->context, 0, pipeline));
        pipeline->unpack_and_convert_fn = NULL; /* unpack_chunk does it */
    }
    if (status == AMB_OK)
        status = check(reader, exr_decoding_run(reader->context, 0, pipeline));
    return status == AMB_OK ? unpack_chunk(reader, pipeline, x, y) : status;
}

static amb_status read_scanlines(exr_reader *reader, exr_decode_pipeline_t *pipeline)
{
    int32_t lines;
    amb_status status = check(reader, exr_get_scanlines_per_chunk(reader->context, 0, &lines));
    for (int y = 0; status == AMB_OK && y < reader->frame->height; y += lines) {
        exr_chunk_info_t chunk;
        status = check(reader, exr_read_scanline_chunk_info(reader->context, 0, reader->window.min.y + y, &chunk));
        if (status == AMB_OK)
            status = read_chunk(reader, pipeline, &chunk, 0, y);
    }
    return status;
}

static amb_status read_tiles(exr_reader *reader, exr_decode_pipeline_t *pipeline)
{
    int32_t width, height;
    amb_status status = check(reader, exr_get_tile_sizes(reader->context, 0, 0, 0, &width, &height));
    if (status == AMB_OK && (width < 1 || height < 1))
        status = check(reader, EXR_ERR_INVALID_ATTR);
    for (int64_t y = 0; status == AMB_OK && y < reader->frame->height; y += height)
        for (int64_t x = 0; status == AMB_OK && x < reader->frame->width; x += width) {
            exr_chunk_info_t chunk;
            status = check(reader, exr_read_tile_chunk_info(reader->context, 0, (int)(x / width), (int)(y / height), 0,
                                                            0, &chunk));
            if (status == AMB_OK)
                status = read_chunk(reader, pipeline, &chunk, (int)x, (int)y);
        }
    return status;
}

static amb_status read_pixels(exr_reader *reader)
{
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    amb_status status = check(reader, exr_get_storage(reader->context, 0, &storage));
    if (status == AMB_OK)
        status = storage == EXR_STORAGE_TILED ? read_tiles(reader, &pipeline) : read_scanlines(reader, &pipeline);
    exr_decoding_destroy(reader->context, &pipeline);
    return status;
}

/* NULL when absent or of another type. */
static const char *find_string(const exr_reader *reader, const char *name)
{
    const exr_attribute_t *attribute;
    if (exr_get_attribute_by_name(reader->context, 0, name, &attribute) != EXR_ERR_SUCCESS ||
        attribute->type != EXR_ATTR_STRING)
        return NULL;
    return attribute->string->str;
}

static amb_status read_metadata(exr_reader *reader)
{
    amb_metadata *meta = &reader->frame->meta;
    const struct {
        const char *name;
        char *to;
        size_t size;
    } fixed[] = {{"ambiance.scene", meta->scene, sizeof meta->scene},
                 {"ambiance.assets", meta->assets_sha256, sizeof meta->assets_sha256},
                 {"ambiance.version", meta->version, sizeof meta->version}};
    const struct {
        const char *name;
        char **to;
    } grown[] = {{"ambiance.parameters", &meta->parameters}, {"ambiance.post", &meta->post}};
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) {
        const char *value = find_string(reader, fixed[i].name);
        if (value)
            snprintf(fixed[i].to, fixed[i].size, "%s", value);
    }
    for (size_t i = 0; i < sizeof grown / sizeof *grown; i++) {
        const char *value = find_string(reader, grown[i].name);
        if (value && !(*grown[i].to = strdup(value)))
            return amb_fail(reader->error, AMB_ERROR_MEMORY, "%s: out of memory", reader->name);
    }
    const exr_attribute_t *time;
    if (exr_get_attribute_by_name(reader->context, 0, "ambiance.time", &time) == EXR_ERR_SUCCESS &&
        time->type == EXR_ATTR_DOUBLE)
        meta->time = time->d;
    return AMB_OK;
}

amb_status amb_read_exr_memory(const void *data, size_t bytes, const char *name, amb_frame **out, amb_error *error)
{
    exr_reader reader = {.data = data, .bytes = bytes, .name = name, .error = error};
    *out = NULL;
    if (amb_file_kind_of(data, bytes) != AMB_FILE_EXR)
        return amb_fail(error, AMB_ERROR_FORMAT, "%s: not an OpenEXR file", name);
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = stream_message;
    setup.user_data = &reader;
    setup.read_fn = stream_read;
    setup.size_fn = stream_size;
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* a lost chunk table is an error, not a guess */
    amb_status status = check(&reader, exr_start_read(&reader.context, name, &setup));
    if (status == AMB_OK)
        status = check_part(&reader);
    if (status == AMB_OK)
        status = list_channels(&reader);
    if (status == AMB_OK)
        status = amb_frame_create(reader.window.max.x - reader.window.min.x + 1,
                                  reader.window.max.y - reader.window.min.y + 1, &reader.frame, error);
    if (status == AMB_OK)
        status = make_layers(&reader);
    if (status == AMB_OK)
        status = read_metadata(&reader);
    if (status == AMB_OK)
        status = read_pixels(&reader);
    if (status == AMB_OK)
        complete_color(&reader);
    else
        amb_frame_close(&reader.frame);
    if (reader.context)
        exr_finish(&reader.context);
    free(reader.channels);
    *out = reader.frame;
    return status;
}

amb_status amb_read_exr(const char *path, amb_frame **out, amb_error *error)
{
    uint8_t *data;
    size_t bytes;
    *out = NULL;
    amb_status status = amb_read_file(path, &data, &bytes, error);
    if (status == AMB_OK)
        status = amb_read_exr_memory(data, bytes, path, out, error);
    free(data);
    return status;
}
