/* Splines and cameras: Catmull-Rom passes through its keys with continuous tangents; primary rays agree with the
 * projection; matrices against double precision. */
#include <ambiance/camera.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static float uniform(uint32_t *state, float lo, float hi)
{
    *state = *state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (float)(*state >> 8) / 16777216.0f;
}
static v3 uniform3(uint32_t *state, float lo, float hi)
{
    float x = uniform(state, lo, hi), y = uniform(state, lo, hi), z = uniform(state, lo, hi);
    return (v3){x, y, z};
}
static float distance(v3 a, v3 b) { return v3_length(v3_sub(a, b)); }

static void spline_passes_through_every_key(void **state)
{
    (void)state;
    uint32_t random = 1;
    for (int round = 0; round < 200; round++) {
        amb_spline_key key[9];
        size_t count = 1 + (size_t)round % 9;
        float time = uniform(&random, -5, 5);
        for (size_t i = 0; i < count; i++, time += uniform(&random, 0.1f, 3))
            key[i] = (amb_spline_key){time, uniform3(&random, -10, 10)};
        for (size_t i = 0; i < count; i++)
            assert_true(distance(amb_spline_at(key, count, key[i].time), key[i].value) <= 1e-5f);
        assert_true(distance(amb_spline_at(key, count, key[0].time - 9), key[0].value) == 0);
        assert_true(distance(amb_spline_at(key, count, key[count - 1].time + 9), key[count - 1].value) == 0);
    }
}

/* The defining property, straight from the definition: the tangent at an inner key is the slope between its
 * neighbours, and the same from both sides. */
static void spline_tangents_are_continuous(void **state)
{
    (void)state;
    uint32_t random = 2;
    for (int round = 0; round < 100; round++) {
        amb_spline_key key[6];
        for (int i = 0; i < 6; i++)
            key[i] = (amb_spline_key){(float)i + uniform(&random, 0, 0.5f), uniform3(&random, -3, 3)};
        for (size_t i = 1; i < 5; i++) {
            v3 slope = v3_scale(v3_sub(key[i + 1].value, key[i - 1].value), 1.0f / (key[i + 1].time - key[i - 1].time));
            float step = 1e-4f;
            v3 left = amb_spline_tangent(key, 6, key[i].time - step);
            v3 right = amb_spline_tangent(key, 6, key[i].time + step);
            assert_true(distance(left, slope) < 0.02f);
            assert_true(distance(right, slope) < 0.02f);
        }
        for (float t = key[0].time + 0.05f; t < key[5].time - 0.05f; t += 0.037f) { /* tangent is the derivative */
            float h = 0.01f;
            v3 numeric = v3_scale(v3_sub(amb_spline_at(key, 6, t + h), amb_spline_at(key, 6, t - h)), 0.5f / h);
            assert_true(distance(numeric, amb_spline_tangent(key, 6, t)) < 0.15f);
        }
    }
}

static void camera_path_equals_its_three_splines(void **state)
{
    (void)state;
    uint32_t random = 3;
    amb_camera_key key[12];
    amb_spline_key position[12], target[12];
    for (int i = 0; i < 12; i++) {
        key[i] = (amb_camera_key){(float)i * 1.5f, uniform3(&random, 5, 9), uniform3(&random, -1, 1), {0, 1, 0}};
        position[i] = (amb_spline_key){key[i].time, key[i].position};
        target[i] = (amb_spline_key){key[i].time, key[i].target};
    }
    for (size_t count = 1; count <= 12; count++)
        for (float t = -1; t < 19; t += 0.1f) {
            amb_camera c = amb_camera_at(key, count, t, 0.8f, 0.1f, 100, 640, 480);
            assert_true(distance(c.position, amb_spline_at(position, count, t)) == 0);
            assert_true(distance(c.target, amb_spline_at(target, count, t)) == 0);
        }
}

static void primary_rays_project_to_their_pixel(void **state)
{
    (void)state;
    uint32_t random = 4;
    for (int round = 0; round < 1000; round++) {
        int width = 1 + (int)uniform(&random, 0, 2000), height = 1 + (int)uniform(&random, 0, 2000);
        amb_camera c = amb_camera_look(uniform3(&random, -5, 5), uniform3(&random, 10, 20), (v3){0, 1, 0},
                                       uniform(&random, 0.2f, 2), 0.1f, 1000, width, height);
        float x = uniform(&random, 0, (float)width), y = uniform(&random, 0, (float)height);
        float z = uniform(&random, 0.2f, 500);
        v3 ray = v3_add(c.ray_origin, v3_add(v3_scale(c.ray_dx, x), v3_scale(c.ray_dy, y)));
        v4 clip = m4_mul_v4(c.world_to_clip, v4_of3(v3_add(c.position, v3_scale(ray, z)), 1));
        float window_x = (clip.x / clip.w * 0.5f + 0.5f) * (float)width;
        float window_y = (0.5f - clip.y / clip.w * 0.5f) * (float)height;
        float tolerance = 5e-4f * (float)(width + height) * (1 + 1 / z) * 0.1f + 1e-3f;
        assert_true(fabsf(window_x - x) < tolerance);
        assert_true(fabsf(window_y - y) < tolerance);
        assert_true(fabsf(clip.w - z) < 1e-4f * z + 1e-4f);
        assert_true(fabsf(clip.z / clip.w - amb_camera_depth_x(&c, z)) < 2e-4f / z + 1e-5f);
    }
}

static void depth_runs_from_zero_at_near_to_one_at_far(void **state)
{
    (void)state;
    amb_camera c = amb_camera_look((v3){0, 0, 0}, (v3){0, 0, -1}, (v3){0, 1, 0}, 1, 0.5f, 200, 100, 100);
    assert_true(fabsf(amb_camera_depth_x(&c, 0.5f)) < 1e-6f);
    assert_true(fabsf(amb_camera_depth_x(&c, 200) - 1) < 1e-6f);
    assert_true(c.world_to_view.row[0].x == 1 && c.world_to_view.row[1].y == 1 && c.world_to_view.row[2].z == 1);
}

static void matrix_inverse_undoes_its_matrix(void **state)
{
    (void)state;
    uint32_t random = 5;
    for (int round = 0; round < 1000; round++) {
        v3 axis = v3_normalize(uniform3(&random, -1, 1));
        m4 m = m4_mul(m4_translate(uniform3(&random, -4, 4)),
                      m4_mul(m4_rotate(axis, uniform(&random, -6, 6)), m4_scale(uniform3(&random, 0.5f, 2))));
        m4 inverse = m4_inverse(m);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                double sum = 0; /* in double, by the definition of the product */
                for (int k = 0; k < 4; k++)
                    sum += (double)(&m.row[i].x)[k] * (double)(&inverse.row[k].x)[j];
                assert_true(fabs(sum - (i == j)) < 2e-5);
            }
    }
    m4 none = m4_inverse(m4_scale((v3){1, 0, 1}));
    for (int i = 0; i < 16; i++)
        assert_true((&none.row[i / 4].x)[i % 4] == 0);
}

static void rotation_turns_counter_clockwise(void **state)
{
    (void)state;
    v3 y = m4_direction(m4_rotate((v3){0, 0, 1}, 1.57079633f), (v3){1, 0, 0});
    assert_true(distance(y, (v3){0, 1, 0}) < 1e-6f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spline_passes_through_every_key),
        cmocka_unit_test(spline_tangents_are_continuous),
        cmocka_unit_test(camera_path_equals_its_three_splines),
        cmocka_unit_test(primary_rays_project_to_their_pixel),
        cmocka_unit_test(depth_runs_from_zero_at_near_to_one_at_far),
        cmocka_unit_test(matrix_inverse_undoes_its_matrix),
        cmocka_unit_test(rotation_turns_counter_clockwise),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
