#include "scenes/builtin/cube_paint.h"

#include "core/dispatch.h"
#include <ambiance/math.h>

AMB_DECLARE_WIDE(void, amb_cube_paint_row, (const amb_cube_row *row));
AMB_DECLARE_WIDE(void, amb_irradiance_paint_row, (const amb_irradiance_row *row));
AMB_DECLARE_WIDE(v3x, amb_panorama_radiance, (v3x direction, const void *panorama));
AMB_DECLARE_WIDE(v3x, amb_cube_radiance, (v3x direction, const void *cube_at_lod));

static v3x face_direction(int face, f32x s, f32x t)
{
    f32x one = f_set(1.0f);
    v3x direction = face == 0   ? (v3x){one, -t, -s}
                    : face == 1 ? (v3x){-one, -t, s}
                    : face == 2 ? (v3x){s, one, t}
                    : face == 3 ? (v3x){s, -one, -t}
                    : face == 4 ? (v3x){s, -t, one}
                                : (v3x){-s, -t, -one};
    return v3x_normalize(direction);
}

/* (x + offset) pixels as a face coordinate -1…1. */
static f32x face_coordinate(f32x x, int size) { return x * (2.0f / (float)size) - 1.0f; }

void WIDE(amb_cube_paint_row)(const amb_cube_row *row)
{
    int size = row->face->width;
    float step = 1.0f / (float)row->samples;
    float weight = step * step;
    for (int x = 0; x < size; x += AMB_LANES) {
        f32x column = i_to_f(i_lane_index() + x);
        v3x sum = v3x_splat((v3){0, 0, 0});
        for (int j = 0; j < row->samples; j++)
            for (int i = 0; i < row->samples; i++) {
                f32x s = face_coordinate(column + ((float)i + 0.5f) * step, size);
                f32x t = face_coordinate(f_set((float)row->y + ((float)j + 0.5f) * step), size);
                sum = v3x_add(sum, row->radiance(face_direction(row->face_index, s, t), row->user));
            }
        f32x most = f_set(65504.0f);
        f_store(amb_image_row(row->face, 0, row->y) + x, f_min(sum.x * weight, most));
        f_store(amb_image_row(row->face, 1, row->y) + x, f_min(sum.y * weight, most));
        f_store(amb_image_row(row->face, 2, row->y) + x, f_min(sum.z * weight, most));
    }
}

/* Lanes are texels; every lane sums all lights in the same order. */
void WIDE(amb_irradiance_paint_row)(const amb_irradiance_row *row)
{
    int size = row->face->width;
    for (int x = 0; x < size; x += AMB_LANES) {
        f32x s = face_coordinate(i_to_f(i_lane_index() + x) + 0.5f, size);
        f32x t = face_coordinate(f_set((float)row->y + 0.5f), size);
        v3x normal = face_direction(row->face_index, s, t);
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

/* The centre of the panorama looks along -z, +x is to its right, the top row is +y. */
v3x WIDE(amb_panorama_radiance)(v3x direction, const void *panorama)
{
    static const amb_sampler sampler = {.filter = AMB_BILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};
    v2x uv = {f_atan2(direction.x, -direction.z) * (0.5f * AMB_INV_PI) + 0.5f,
              f_acos(f_clamp(direction.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI};
    return v4x_xyz(amb_sample_2d_lod(panorama, &sampler, uv, f_set(0.0f)));
}

/* The nearest texel of the level that has 64² faces. */
v3x WIDE(amb_cube_radiance)(v3x direction, const void *cube)
{
    static const amb_sampler sampler = {.filter = AMB_NEAREST};
    const amb_texture *texture = cube;
    int level = 0;
    for (int size = amb_texture_describe(texture).width; size > 64; size /= 2)
        level++;
    return v4x_xyz(amb_sample_cube_lod(texture, &sampler, direction, f_set((float)level)));
}
