#include "scenes/builtin/cube_paint.h"

#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"

#include <stdlib.h>

AMB_DECLARE_WIDE(void, amb_cube_paint_row, (const amb_cube_row *row));
AMB_DECLARE_WIDE(void, amb_irradiance_paint_row, (const amb_irradiance_row *row));
AMB_DECLARE_WIDE(v3x, amb_panorama_radiance, (v3x direction, const void *panorama));
AMB_DECLARE_WIDE(v3x, amb_cube_radiance, (v3x direction, const void *cube));

v3 amb_cube_direction(int face, float s, float t)
{
    const v3 direction[6] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
    return v3_normalize(direction[face]);
}

/* ---- six faces, row by row over the threads --------------------------------------------------------------------- */

typedef struct faces {
    amb_image *image[6];
} faces;

static void faces_close(faces *f)
{
    for (int i = 0; i < 6; i++)
        amb_image_close(&f->image[i]);
}

static amb_status faces_create(int size, faces *f, amb_error *error)
{
    *f = (faces){{NULL}};
    for (int i = 0; i < 6; i++) {
        amb_status status = amb_image_create(size, size, 4, &f->image[i], error);
        if (status != AMB_OK) {
            faces_close(f);
            return status;
        }
        for (int y = 0; y < size; y++)
            for (int x = 0; x < size; x++)
                amb_image_row(f->image[i], 3, y)[x] = 1.0f;
    }
    return AMB_OK;
}

typedef struct paint_job {
    const faces *faces;
    int size, samples;
    amb_radiance radiance;
    const void *user;
    void (*row)(const amb_cube_row *row);
} paint_job;

static void paint_row(void *user, int index, int thread)
{
    (void)thread;
    const paint_job *job = user;
    job->row(&(amb_cube_row){.face = job->faces->image[index / job->size],
                             .face_index = index / job->size,
                             .y = index % job->size,
                             .samples = job->samples,
                             .radiance = job->radiance,
                             .user = job->user});
}

static amb_status paint_faces(const amb_context *context, int size, int samples, amb_radiance radiance,
                              const void *user, faces *f, amb_error *error)
{
    amb_status status = faces_create(size, f, error);
    if (status != AMB_OK)
        return status;
    paint_job job = {.faces = f,
                     .size = size,
                     .samples = samples,
                     .radiance = radiance,
                     .user = user,
                     .row = AMB_DISPATCH(amb_context_isa(context), amb_cube_paint_row)};
    amb_parallel_for(context, 6 * size, paint_row, &job);
    return AMB_OK;
}

amb_status amb_cube_paint(const amb_context *context, int size, int samples, amb_radiance radiance, const void *user,
                          amb_texture **out, amb_error *error)
{
    faces f;
    *out = NULL;
    amb_status status = paint_faces(context, size, samples, radiance, user, &f, error);
    if (status == AMB_OK)
        status = amb_texture_cube_from_images(f.image, AMB_TEXEL_RGBA16F, true, out, error);
    faces_close(&f);
    return status;
}

amb_status amb_panorama_to_cube(const amb_context *context, const amb_texture *panorama, int size, amb_texture **out,
                                amb_error *error)
{
    return amb_cube_paint(context, size, 3, AMB_DISPATCH(amb_context_isa(context), amb_panorama_radiance), panorama,
                          out, error);
}

/* ---- irradiance ------------------------------------------------------------------------------------------------- */

enum { LIGHT_SIZE = 64, IRRADIANCE_SIZE = 32 };

/* Solid angle of each texel, scaled so that the whole sphere sums to 4π. */
static void weigh_lights(const faces *f, amb_cube_light *light)
{
    double total = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0, face = 0; face < 6; face++)
            for (int y = 0; y < LIGHT_SIZE; y++)
                for (int x = 0; x < LIGHT_SIZE; x++, i++) {
                    float s = (2.0f * (float)x + 1.0f) / LIGHT_SIZE - 1.0f;
                    float t = (2.0f * (float)y + 1.0f) / LIGHT_SIZE - 1.0f;
                    float d2 = 1.0f + s * s + t * t;
                    float angle = 1.0f / (d2 * __builtin_sqrtf(d2));
                    if (pass == 0) {
                        total += (double)angle;
                        continue;
                    }
                    const amb_image *image = f->image[face];
                    v3 radiance = {amb_image_row(image, 0, y)[x], amb_image_row(image, 1, y)[x],
                                   amb_image_row(image, 2, y)[x]};
                    light[i] = (amb_cube_light){amb_cube_direction(face, s, t),
                                                v3_scale(radiance, (float)(4.0 * (double)angle / total))};
                }
}

typedef struct irradiance_job {
    const faces *faces;
    const amb_cube_light *light;
    void (*row)(const amb_irradiance_row *row);
} irradiance_job;

static void irradiance_row(void *user, int index, int thread)
{
    (void)thread;
    const irradiance_job *job = user;
    job->row(&(amb_irradiance_row){.face = job->faces->image[index / IRRADIANCE_SIZE],
                                   .face_index = index / IRRADIANCE_SIZE,
                                   .y = index % IRRADIANCE_SIZE,
                                   .light_count = 6 * LIGHT_SIZE * LIGHT_SIZE,
                                   .light = job->light});
}

amb_status amb_irradiance_cube(const amb_context *context, const amb_texture *environment, amb_texture **out,
                               amb_error *error)
{
    faces lights = {{NULL}}, result = {{NULL}};
    *out = NULL;
    amb_cube_light *light = malloc(sizeof *light * 6 * LIGHT_SIZE * LIGHT_SIZE);
    amb_status status = light ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "out of memory for an irradiance map");
    if (status == AMB_OK)
        status = paint_faces(context, LIGHT_SIZE, 1, AMB_DISPATCH(amb_context_isa(context), amb_cube_radiance),
                             environment, &lights, error);
    if (status == AMB_OK)
        status = faces_create(IRRADIANCE_SIZE, &result, error);
    if (status == AMB_OK) {
        weigh_lights(&lights, light);
        irradiance_job job = {
            .faces = &result, .light = light, .row = AMB_DISPATCH(amb_context_isa(context), amb_irradiance_paint_row)};
        amb_parallel_for(context, 6 * IRRADIANCE_SIZE, irradiance_row, &job);
        status = amb_texture_cube_from_images(result.image, AMB_TEXEL_RGBA32F, false, out, error);
    }
    faces_close(&lights);
    faces_close(&result);
    free(light);
    return status;
}
