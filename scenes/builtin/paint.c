#include "scenes/builtin/paint.h"

#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"

AMB_DECLARE_WIDE(void, amb_paint_row_lanes, (const amb_paint_row *row));
AMB_DECLARE_WIDE(v4x, amb_panorama_radiance, (v3x direction, const void *panorama));

v3 amb_cube_direction(int face, float s, float t)
{
    const v3 direction[6] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
    return v3_normalize(direction[face]);
}

/* Surfaces of one size, row by row over the threads. */
typedef struct paint_job {
    amb_image *const *image;
    int first_surface, height, samples;
    amb_field field;
    const void *user;
    void (*row)(const amb_paint_row *row);
} paint_job;

static void paint_row(void *user, int index, int thread)
{
    (void)thread;
    const paint_job *job = user;
    int surface = index / job->height;
    job->row(&(amb_paint_row){.image = job->image[surface],
                              .surface = job->first_surface + surface,
                              .y = index % job->height,
                              .samples = job->samples,
                              .field = job->field,
                              .user = job->user});
}

static void paint(const amb_context *context, amb_image *const *image, int first_surface, int surfaces, int samples,
                  amb_field field, const void *user)
{
    paint_job job = {.image = image,
                     .first_surface = first_surface,
                     .height = image[0]->height,
                     .samples = samples,
                     .field = field,
                     .user = user,
                     .row = AMB_DISPATCH(amb_context_isa(context), amb_paint_row_lanes)};
    amb_parallel_for(context, surfaces * job.height, paint_row, &job);
}

amb_status amb_cube_paint_faces(const amb_context *context, int size, int samples, amb_field field, const void *user,
                                amb_image *face[6], amb_error *error)
{
    amb_status status = AMB_OK;
    for (int i = 0; i < 6; i++)
        face[i] = NULL;
    for (int i = 0; i < 6 && status == AMB_OK; i++)
        status = amb_image_create(size, size, 4, &face[i], error);
    if (status == AMB_OK) {
        paint(context, face, 0, 6, samples, field, user);
        return AMB_OK;
    }
    for (int i = 0; i < 6; i++)
        amb_image_close(&face[i]);
    return status;
}

amb_status amb_cube_paint(const amb_context *context, int size, int samples, amb_field field, const void *user,
                          amb_texture **out, amb_error *error)
{
    amb_image *face[6];
    *out = NULL;
    amb_status status = amb_cube_paint_faces(context, size, samples, field, user, face, error);
    if (status != AMB_OK)
        return status;
    status = amb_texture_cube_from_images(face, AMB_TEXEL_RGBA16F, true, out, error);
    for (int i = 0; i < 6; i++)
        amb_image_close(&face[i]);
    return status;
}

amb_status amb_panorama_to_cube(const amb_context *context, const amb_texture *panorama, int size, amb_texture **out,
                                amb_error *error)
{
    return amb_cube_paint(context, size, 3, AMB_DISPATCH(amb_context_isa(context), amb_panorama_radiance), panorama,
                          out, error);
}

amb_status amb_map_paint_image(const amb_context *context, int width, int height, int samples, amb_field field,
                               const void *user, amb_image **out, amb_error *error)
{
    amb_status status = amb_image_create(width, height, 4, out, error);
    if (status == AMB_OK)
        paint(context, out, AMB_PAINT_MAP, 1, samples, field, user);
    return status;
}

amb_status amb_map_paint(const amb_context *context, int width, int height, int samples, amb_field field,
                         const void *user, amb_texel texel, amb_texture **out, amb_error *error)
{
    amb_image *image;
    *out = NULL;
    amb_status status = amb_map_paint_image(context, width, height, samples, field, user, &image, error);
    if (status == AMB_OK)
        status = amb_texture_from_image(image, texel, true, out, error);
    amb_image_close(&image);
    return status;
}
