/* amb_write_png: 8 bits a channel, sRGB chunk, fixed zlib level and filters: equal images are equal files. */
#include "io/file.h"

#include <png.h>

#include <setjmp.h>
#include <stdlib.h>

typedef struct png_writer {
    const amb_image *image;
    const char *path;
    amb_output *output;
    uint8_t *row;
    amb_status status;
    amb_error *error;
} png_writer;

static void write_bytes(png_structp png, png_bytep data, size_t bytes)
{
    png_writer *writer = png_get_io_ptr(png);
    writer->status = amb_output_write(writer->output, data, bytes, writer->error);
    if (writer->status != AMB_OK)
        png_error(png, "write failed");
}

static void flush_bytes(png_structp png) { (void)png; }

static void on_error(png_structp png, png_const_charp message)
{
    png_writer *writer = png_get_error_ptr(png);
    if (writer->status == AMB_OK)
        writer->status = amb_fail(writer->error, AMB_ERROR_IO, "cannot write '%s': %s", writer->path, message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* Nearest of 256; NaN gives 0. */
static uint8_t quantise(float value) { return (uint8_t)f_to_i(f_round(f_saturate(value) * 255.0f)); }

static void write_rows(png_writer *writer, png_structp png, png_infop info)
{
    static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    const amb_image *image = writer->image;
    png_set_compression_level(png, 6);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height, 8, types[image->channels - 1],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (int y = 0; y < image->height; y++) {
        for (int c = 0; c < image->channels; c++) {
            const float *from = amb_image_row(image, c, y);
            for (int x = 0; x < image->width; x++)
                writer->row[x * image->channels + c] = quantise(from[x]);
        }
        png_write_row(png, writer->row);
    }
    png_write_end(png, info);
}

/* The only function that libpng's longjmp returns to: it keeps no locals of its own across the jump. */
static void run_encoder(png_writer *writer, png_structp png, png_infop info)
{
    if (setjmp(png_jmpbuf(png)) == 0)
        write_rows(writer, png, info);
}

amb_status amb_write_png(const amb_image *image, const char *path, amb_error *error)
{
    png_writer writer = {.image = image, .path = path, .error = error};
    png_structp png = NULL;
    png_infop info = NULL;
    writer.status = amb_output_begin(path, &writer.output, error);
    if (writer.status != AMB_OK)
        return writer.status;
    writer.row = malloc((size_t)image->width * (size_t)image->channels);
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_error, on_warning);
    info = png ? png_create_info_struct(png) : NULL;
    if (!writer.row || !info) {
        writer.status = amb_fail(error, AMB_ERROR_MEMORY, "cannot write '%s': out of memory", path);
    } else {
        png_set_user_limits(png, AMB_MAX_IMAGE_SIZE, AMB_MAX_IMAGE_SIZE);
        png_set_write_fn(png, &writer, write_bytes, flush_bytes);
        run_encoder(&writer, png, info);
    }
    if (png)
        png_destroy_write_struct(&png, &info);
    free(writer.row);
    if (writer.status == AMB_OK)
        writer.status = amb_output_commit(&writer.output, error);
    amb_output_abort(&writer.output);
    return writer.status;
}
