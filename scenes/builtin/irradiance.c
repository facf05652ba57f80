#include "scenes/builtin/irradiance.h"

#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/paint.h"

#include <stdlib.h>

AMB_DECLARE_WIDE(void, amb_irradiance_paint_row, (const amb_irradiance_row *row));
AMB_DECLARE_WIDE(v4x, amb_cube_radiance, (v3x direction, const void *cube));

enum { LIGHT_SIZE = 64, IRRADIANCE_SIZE = 32 };

/* Solid angle of each texel, scaled so that the whole sphere sums to 4π. */
static void weigh_lights(amb_image *const face_image[6], amb_cube_light *light)
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
                    const amb_image *image = face_image[face];
                    v3 radiance = {amb_image_row(image, 0, y)[x], amb_image_row(image, 1, y)[x],
                                   amb_image_row(image, 2, y)[x]};
                    light[i] = (amb_cube_light){amb_cube_direction(face, s, t),
                                                v3_scale(radiance, (float)(4.0 * (double)angle / total))};
                }
}

typedef struct irradiance_job {
    amb_image *const *face;
    const amb_cube_light *light;
    void (*row)(const amb_irradiance_row *row);
} irradiance_job;

static void irradiance_row(void *user, int index, int thread)
{
    (void)thread;
    const irradiance_job *job = user;
    job->row(&(amb_irradiance_row){.face = job->face[index / IRRADIANCE_SIZE],
                                   .face_index = index / IRRADIANCE_SIZE,
                                   .y = index % IRRADIANCE_SIZE,
                                   .light_count = 6 * LIGHT_SIZE * LIGHT_SIZE,
                                   .light = job->light});
}

amb_status amb_irradiance_cube(const amb_context *context, const amb_texture *environment, amb_texture **out,
                               amb_error *error)
{
    amb_image *source[6] = {NULL}, *result[6] = {NULL};
    *out = NULL;
    amb_cube_light *light = malloc(sizeof *light * 6 * LIGHT_SIZE * LIGHT_SIZE);
    amb_status status = light ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "out of memory for an irradiance map");
    if (status == AMB_OK)
        status = amb_cube_paint_faces(context, LIGHT_SIZE, 1, AMB_DISPATCH(amb_context_isa(context), amb_cube_radiance),
                                      environment, source, error);
    for (int i = 0; i < 6 && status == AMB_OK; i++)
        status = amb_image_create(IRRADIANCE_SIZE, IRRADIANCE_SIZE, 3, &result[i], error);
    if (status == AMB_OK) {
        weigh_lights(source, light);
        irradiance_job job = {
            .face = result, .light = light, .row = AMB_DISPATCH(amb_context_isa(context), amb_irradiance_paint_row)};
        amb_parallel_for(context, 6 * IRRADIANCE_SIZE, irradiance_row, &job);
        status = amb_texture_cube_from_images(result, AMB_TEXEL_RGBA32F, false, out, error);
    }
    for (int i = 0; i < 6; i++) {
        amb_image_close(&source[i]);
        amb_image_close(&result[i]);
    }
    free(light);
    return status;
}
