/* Lights, waves and shadow look-ups against double precision written from the equations. */
#include "lanes.h"

#include <math.h>
#include <setjmp.h>
#include <shade/light.h>
#include <shade/waves.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

static void near(float got, double want, double tolerance)
{
    if (!(fabs((double)got - want) <= tolerance))
        fail_msg("got %.9g, want %.9g ± %g", (double)got, want, tolerance);
}

static v3 unit_vector(uint64_t *seed)
{
    float f[3];
    do
        lanes_floats_in(lanes_random(seed), -1.0f, 1.0f, f, 3);
    while (f[0] * f[0] + f[1] * f[1] + f[2] * f[2] < 0.1f);
    return v3_normalize((v3){f[0], f[1], f[2]});
}

/* ---- lights -------------------------------------------------------------------------------------------------------
 */

static void attenuation_is_inverse_square_and_ends_at_the_reach(void **state)
{
    (void)state;
    for (int i = 1; i <= 2000; i++) {
        double d = i * 0.01, reach = 12.0, ratio = d / reach;
        double window = fmax(1.0 - pow(ratio, 4.0), 0.0), want = window * window / fmax(d * d, 0.0625);
        near(light_attenuation((float)(d * d), 12.0f, 0.25f), want, 1.0e-5 * want + 1.0e-7);
    }
    near(light_attenuation(144.0f, 12.0f, 0.25f), 0.0, 0.0);
    near(light_attenuation(1.0e9f, 12.0f, 0.25f), 0.0, 0.0);
    near(light_attenuation(1.0f, 1000.0f, 0.25f), 1.0, 1.0e-6); /* far inside: 1/d² */
}

static void spots_shine_in_their_cone_only(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 20000; i++) {
        v3 axis = unit_vector(&seed), away = unit_vector(&seed);
        float distance;
        lanes_floats_in(lanes_random(&seed), 0.5f, 20.0f, &distance, 1);
        amb_light light = {.kind = AMB_LIGHT_SPOT,
                           .position = {1.0f, 2.0f, -3.0f},
                           .reach = 15.0f,
                           .axis = axis,
                           .cos_inner = 0.9f,
                           .cos_outer = 0.8f};
        v3 point = v3_add(light.position, v3_scale(away, distance));
        amb_arriving a = light_at(&light, (v3x){point.x, point.y, point.z});
        double cosine =
            (double)axis.x * (double)away.x + (double)axis.y * (double)away.y + (double)axis.z * (double)away.z;
        double t = fmin(fmax((cosine - 0.8) / 0.1, 0.0), 1.0), d = (double)distance;
        double window = fmax(1.0 - pow(d / 15.0, 4.0), 0.0);
        near(a.strength, t * t * (3.0 - 2.0 * t) * window * window / (d * d), 2.0e-4);
        near(a.to_light.x, -(double)away.x, 1.0e-5);
        near(a.to_light.y, -(double)away.y, 1.0e-5);
        if (cosine < 0.7999)
            assert_true(a.strength == 0.0f);
    }
}

static double clamp0(double a) { return a > 0.0 ? a : 0.0; }

static void highlights_are_blinn_phong_s_and_cook_torrance_s(void **state)
{
    (void)state;
    uint64_t seed = 9;
    for (int i = 0; i < 20000; i++) {
        v3 n = unit_vector(&seed), l = unit_vector(&seed), v = unit_vector(&seed);
        double nl = 0, nv = 0, h[3], hh = 0;
        const float *pn = &n.x, *pl = &l.x, *pv = &v.x;
        for (int k = 0; k < 3; k++) {
            nl += (double)pn[k] * (double)pl[k];
            nv += (double)pn[k] * (double)pv[k];
            h[k] = (double)pl[k] + (double)pv[k];
            hh += h[k] * h[k];
        }
        if (fabs(nl) < 0.02 || fabs(nv) < 0.02 || hh < 0.05)
            continue;
        double nh = 0, vh = 0, m = 0.3, f0 = 0.04;
        for (int k = 0; k < 3; k++) {
            nh += (double)pn[k] * h[k] / sqrt(hh);
            vh += (double)pv[k] * h[k] / sqrt(hh);
        }
        v3x nx = {n.x, n.y, n.z}, lx = {l.x, l.y, l.z}, vx = {v.x, v.y, v.z};
        amb_response blinn = light_blinn_phong(nx, lx, vx, 24.0f, 0.5f);
        near(blinn.diffuse, clamp0(nl), 1.0e-6);
        near(blinn.specular, nl > 0.0 ? 0.5 * pow(clamp0(nh), 24.0) : 0.0, 1.0e-5);
        amb_response cook = light_cook_torrance(nx, lx, vx, 0.3f, 0.04f);
        double fresnel = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0), tan2 = (1.0 - nh * nh) / (nh * nh);
        double beckmann = exp(-tan2 / (m * m)) / (pi * m * m * pow(nh, 4.0));
        double shadowing = fmin(1.0, fmin(2.0 * nh * nv / vh, 2.0 * nh * nl / vh));
        double want = nl > 0.0 && nv > 0.0 ? pi * fresnel * beckmann * shadowing / (4.0 * nv) : 0.0;
        near(cook.specular, want, 1.0e-4 * want + 1.0e-5);
        near(cook.diffuse, clamp0(nl) * (1.0 - f0 - (1.0 - f0) * pow(1.0 - clamp0(nl), 5.0)), 1.0e-5);
    }
}

/* Lambert under Cook-Torrance never gives back more than it gets: mean over the hemisphere of eyes, any roughness. */
static void cook_torrance_keeps_energy(void **state)
{
    (void)state;
    v3x n = {0, 0, 1};
    for (int r = 1; r <= 10; r++)
        for (int a = 0; a < 9; a++) {
            float elevation = (float)(a + 1) * 0.17f;
            v3x l = {cosf(elevation), 0, sinf(elevation)};
            double sum = 0.0;
            enum { STEPS = 256 };
            for (int i = 0; i < STEPS; i++)
                for (int j = 0; j < STEPS; j++) {
                    double z = (i + 0.5) / STEPS, phi = 2.0 * pi * (j + 0.5) / STEPS, s = sqrt(1.0 - z * z);
                    v3x v = {(float)(s * cos(phi)), (float)(s * sin(phi)), (float)z};
                    amb_response response = light_cook_torrance(n, l, v, 0.1f * (float)r, 0.04f);
                    sum += ((double)response.diffuse + (double)response.specular) * z * 2.0 / (STEPS * STEPS);
                }
            if (!(sum <= (double)l.z * 1.02)) /* what arrives: n·l */
                fail_msg("roughness %g, n·l %g: gives back %g", 0.1 * r, (double)l.z, sum);
        }
}

/* ---- waves --------------------------------------------------------------------------------------------------------
 */

static amb_waves some_waves(bool noise, double time)
{
    amb_waves w = {.height = 0.6f, .frequency = 0.9f, .speed = 1.7f, .noise = noise, .count = noise ? 5 : WAVES_SINES};
    waves_at_time(&w, time);
    return w;
}

static double sines_truth(double x, double z, double time, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
        waves_sine s = waves_sines[i];
        double k = 0.9 * (double)s.frequency;
        sum += 0.6 * (double)s.amplitude * sin(k * ((double)s.x * x + (double)s.z * z) + 1.7 * (double)s.speed * time);
    }
    return sum;
}

static void the_first_sine_is_the_coursework_s(void **state)
{
    (void)state;
    for (int i = 0; i < 2000; i++) {
        double x = i * 0.37 - 300.0, z = i * 0.11 - 100.0, time = i * 0.05;
        amb_waves w = some_waves(false, time);
        w.count = 1;
        amb_wave wave = waves_at(&w, (v2x){(float)x, (float)z}, 0.0f);
        near(wave.height, 0.6 * sin(0.9 * z + 1.7 * time), 3.0e-5);
        near(wave.slope.x, 0.0, 0.0);
        near(wave.slope.y, 0.6 * 0.9 * cos(0.9 * z + 1.7 * time), 5.0e-5);
    }
}

static void slopes_are_the_heights_derivatives(void **state)
{
    (void)state;
    uint64_t seed = 12;
    for (int i = 0; i < 4000; i++) {
        float p[2];
        lanes_floats_in(lanes_random(&seed), -60.0f, 60.0f, p, 2);
        double time = 3.0 + i * 0.01, e = 1.0e-4;
        amb_waves w = some_waves(false, time);
        amb_wave wave = waves_at(&w, (v2x){p[0], p[1]}, 0.0f);
        double x = (double)p[0], z = (double)p[1];
        near(wave.height, sines_truth(x, z, time, WAVES_SINES), 2.0e-4);
        near(wave.slope.x, (sines_truth(x + e, z, time, 8) - sines_truth(x - e, z, time, 8)) / (2.0 * e), 1.5e-3);
        near(wave.slope.y, (sines_truth(x, z + e, time, 8) - sines_truth(x, z - e, time, 8)) / (2.0 * e), 1.5e-3);
        near(wave.roughness, 0.0, 0.0);
        /* noise: differences of floats over a wider step */
        w = some_waves(true, time);
        float d = 0.004f;
        wave = waves_at(&w, (v2x){p[0], p[1]}, 0.0f);
        float right = waves_at(&w, (v2x){p[0] + d, p[1]}, 0.0f).height,
              left = waves_at(&w, (v2x){p[0] - d, p[1]}, 0.0f).height;
        float below = waves_at(&w, (v2x){p[0], p[1] + d}, 0.0f).height,
              above = waves_at(&w, (v2x){p[0], p[1] - d}, 0.0f).height;
        near(wave.slope.x, ((double)right - (double)left) / ((double)(p[0] + d) - (double)(p[0] - d)), 6.0e-3);
        near(wave.slope.y, ((double)below - (double)above) / ((double)(p[1] + d) - (double)(p[1] - d)), 6.0e-3);
    }
}

static void waves_too_small_to_see_become_roughness(void **state)
{
    (void)state;
    amb_waves w = some_waves(false, 1.0);
    double all = 0.0;
    for (int i = 0; i < WAVES_SINES; i++) {
        double slope = 0.6 * (double)waves_sines[i].amplitude * 0.9 * (double)waves_sines[i].frequency;
        all += 0.5 * slope * slope;
    }
    for (float footprint = 0.0f; footprint < 40.0f; footprint += 0.25f) {
        amb_wave wave = waves_at(&w, (v2x){3.0f, 4.0f}, footprint);
        assert_true(wave.roughness >= 0.0f && (double)wave.roughness <= all * 1.00001);
    }
    amb_wave far = waves_at(&w, (v2x){3.0f, 4.0f}, 40.0f);
    near(far.height, 0.0, 0.0);
    near(far.slope.x, 0.0, 0.0);
    near(far.roughness, all, 1.0e-5 * all);
}

static void a_day_of_waves_keeps_its_phase(void **state)
{
    (void)state;
    const double times[] = {86400.0, 1.0e7, -5.0e6, 1.0e12};
    for (int i = 0; i < 4; i++) {
        amb_waves w = some_waves(false, times[i]);
        for (int k = 0; k < WAVES_SINES; k++) {
            double phase = 1.7 * (double)waves_sines[k].speed * times[i];
            double tolerance = 1.0e-6 + fabs(times[i]) * 1.0e-15;
            near((float)sin((double)w.turns[k]), sin((double)1.7f * (double)waves_sines[k].speed * times[i]),
                 tolerance + (fabs(phase) > 1.0e11 ? 1.0e-3 : 0.0));
        }
    }
    amb_waves w = some_waves(false, (double)NAN); /* any bits may come, but no crash and no bad index */
    (void)waves_at(&w, (v2x){1.0f, 1.0f}, 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(attenuation_is_inverse_square_and_ends_at_the_reach),
        cmocka_unit_test(spots_shine_in_their_cone_only),
        cmocka_unit_test(highlights_are_blinn_phong_s_and_cook_torrance_s),
        cmocka_unit_test(cook_torrance_keeps_energy),
        cmocka_unit_test(the_first_sine_is_the_coursework_s),
        cmocka_unit_test(slopes_are_the_heights_derivatives),
        cmocka_unit_test(waves_too_small_to_see_become_roughness),
        cmocka_unit_test(a_day_of_waves_keeps_its_phase),
    };
    return cmocka_run_group_tests_name("light", tests, NULL, NULL);
}
