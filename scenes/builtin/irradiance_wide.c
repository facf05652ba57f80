#include "scenes/builtin/irradiance.h"

#include "core/dispatch.h"
#include "scenes/builtin/cube_face.h"

AMB_DECLARE_WIDE(void, amb_irradiance_paint_row, (const amb_irradiance_row *row));
AMB_DECLARE_WIDE(v4x, amb_cube_radiance, (v3x direction, const void *cube));

/* Lanes are texels; every lane sums all lights in the same order. */
void WIDE(amb_irradiance_paint_row)(const amb_irradiance_row *row)
{
    int size = row->face->width;
    for (int x = 0; x < size; x += AMB_LANES) {
        f32x s = cube_face_coordinate(i_to_f(i_lane_index() + x) + 0.5f, size);
        f32x t = cube_face_coordinate(f_set((float)row->y + 0.5f), size);
        v3x normal = cube_face_direction(row->face_index, s, t);
        v3x sum = v3x_splat((v3){0, 0, 0});
        for (int i = 0; i < row->light_count; i++) {
            const amb_cube_light *light = &row->light[i];
            f32x cosine = f_max(v3x_dot(normal, v3x_splat(light->direction)), f_set(0.0f));
            sum = v3x_add(sum, v3x_scale(v3x_splat(light->flux), cosine));
        }
        f_store(amb_image_row(row->face, 0, row->y) + x, sum.x);
        f_store(amb_image_row(row->face, 1, row->y) + x, sum.y);
        f_store(amb_image_row(row->face, 2, row->y) + x, sum.z);
    }
}

/* The nearest texel of the level that has 64² faces. */
v4x WIDE(amb_cube_radiance)(v3x direction, const void *cube)
{
    static const amb_sampler sampler = {.filter = AMB_NEAREST};
    const amb_texture *texture = cube;
    int level = 0;
    for (int size = amb_texture_describe(texture).width; size > 64; size /= 2)
        level++;
    return amb_sample_cube_lod(texture, &sampler, direction, f_set((float)level));
}
