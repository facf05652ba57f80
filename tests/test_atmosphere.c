/* The atmosphere's fast form against the same integrals by brute force in double precision. */
#include "shade/atmosphere.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static double uniform(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 16777216.0;
}

static amb_atmosphere earth(int samples)
{
    amb_atmosphere air = {.radius = 1,
                          .top = 1.025f,
                          .scale_height = 0.00625f,
                          .rayleigh = {5.6f, 13.0f, 31.8f},
                          .mie = {2.0f, 2.0f, 2.0f},
                          .asymmetry = 0.76f,
                          .sun_rgb = {1, 1, 1},
                          .sun_softness = 0.0093f,
                          .samples = samples};
    amb_atmosphere_fit(&air);
    return air;
}

/* ---- truth: the integrals as written, double precision ------------------------------------------------------------
 */

static double truth_density(const amb_atmosphere *air, double x, double y, double z)
{
    return exp(((double)air->radius - sqrt(x * x + y * y + z * z)) / (double)air->scale_height);
}

/* ∫ density from p along the unit direction d to the air's end, 0 < cosine to the zenith or above the ground. */
static double truth_depth(const amb_atmosphere *air, const double p[3], const double d[3], int steps)
{
    double b = p[0] * d[0] + p[1] * d[1] + p[2] * d[2];
    double c = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - (double)air->top * (double)air->top;
    double length = -b + sqrt(fmax(b * b - c, 0)), sum = 0;
    for (int i = 0; i < steps; i++) {
        double t = length * (i + 0.5) / steps;
        sum += truth_density(air, p[0] + d[0] * t, p[1] + d[1] * t, p[2] + d[2] * t);
    }
    return sum * length / steps;
}

/* The sun's share that is not behind the planet; the same definition as the fast form's. */
static double truth_sunlight(const amb_atmosphere *air, const double p[3], const double d[3])
{
    double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    double cosine = (p[0] * d[0] + p[1] * d[1] + p[2] * d[2]) / r;
    if (cosine > 0)
        return 1;
    double perigee = r * sqrt(fmax(1 - cosine * cosine, 0));
    double soft = -cosine * r * (double)air->sun_softness + 1e-6 * (double)air->radius;
    return fmin(fmax((perigee - (double)air->radius) / soft + 0.5, 0), 1);
}

static void truth_along(const amb_atmosphere *air, const double o[3], const double d[3], double near, double far,
                        const double sun[3], double in_scatter[3], double transmit[3])
{
    const float *rayleigh = &air->rayleigh.x, *mie = &air->mie.x;
    enum { STEPS = 160 };
    double step = (far - near) / STEPS, depth = 0, sum[3] = {0, 0, 0};
    for (int i = 0; i < STEPS; i++) {
        double t = near + step * (i + 0.5), p[3] = {o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t};
        double density = truth_density(air, p[0], p[1], p[2]);
        double lit = truth_sunlight(air, p, sun);
        double passed = depth + 0.5 * density * step + (lit > 0 ? truth_depth(air, p, sun, 160) : 0);
        for (int c = 0; c < 3; c++)
            sum[c] += lit * density * step * exp(-((double)rayleigh[c] + (double)mie[c]) * passed);
        depth += density * step;
    }
    double cosine = d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2], g = (double)air->asymmetry;
    double phase_r = 0.75 * (1 + cosine * cosine);
    double phase_m = 1.5 * (1 - g * g) / (2 + g * g) * (1 + cosine * cosine) / pow(1 + g * g - 2 * g * cosine, 1.5);
    for (int c = 0; c < 3; c++) {
        in_scatter[c] = sum[c] * ((double)rayleigh[c] * phase_r + (double)mie[c] * phase_m) / 4;
        transmit[c] = exp(-((double)rayleigh[c] + (double)mie[c]) * depth);
    }
}

/* ---- random views --------------------------------------------------------------------------------------------------
 */

static void random_unit(uint32_t *state, double d[3])
{
    double z = 2 * uniform(state) - 1, angle = 6.283185307179586 * uniform(state), r = sqrt(1 - z * z);
    d[0] = r * cos(angle);
    d[1] = r * sin(angle);
    d[2] = z;
}

/* A ray that meets the air: from space toward the disc, from low orbit to the limb, or from inside. */
static bool random_view(uint32_t *state, const amb_atmosphere *air, double o[3], double d[3], double *near, double *far)
{
    double height = uniform(state) < 0.4 ? 3 * uniform(state) : 0.03 * uniform(state) * uniform(state);
    random_unit(state, o);
    double up[3] = {o[0], o[1], o[2]}, r = (double)air->radius + height + 1e-5;
    for (int i = 0; i < 3; i++)
        o[i] *= r;
    random_unit(state, d);
    if (uniform(state) < 0.5) { /* bend it toward the horizon, where errors are largest */
        double b = up[0] * d[0] + up[1] * d[1] + up[2] * d[2],
               bend = b + sqrt(1 - 1 / (r * r)) * (0.9 + 0.2 * uniform(state));
        double norm = 0;
        for (int i = 0; i < 3; i++)
            d[i] -= bend * up[i];
        for (int i = 0; i < 3; i++)
            norm += d[i] * d[i];
        for (int i = 0; i < 3; i++)
            d[i] /= sqrt(norm);
    }
    double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2], oo = r * r;
    double inside = b * b - oo + (double)air->top * (double)air->top;
    if (inside <= 0)
        return false;
    *near = fmax(-b - sqrt(inside), 0);
    *far = -b + sqrt(inside);
    double ground = b * b - oo + (double)air->radius * (double)air->radius;
    if (ground > 0 && -b - sqrt(ground) > 0)
        *far = -b - sqrt(ground);
    return *far > *near;
}

static double brightest_error(const atmosphere_light *fast, const double truth[3])
{
    const float *got = &fast->in_scatter.x;
    double most = 0;
    for (int c = 0; c < 3; c++)
        most = fmax(most, fabs((double)got[c] - truth[c]));
    return most;
}

/* Errors are stated against paper white under the sun, which is 1: what an eye compares the air with. */
static void fast_form_agrees_with_the_integrals(void **state)
{
    (void)state;
    amb_atmosphere air = earth(16);
    uint32_t random = 11;
    double worst = 0, total = 0, worst_transmit = 0;
    int views = 0;
    while (views < 10000) {
        double o[3], d[3], sun[3], near, far, scatter[3], transmit[3];
        if (!random_view(&random, &air, o, d, &near, &far))
            continue;
        random_unit(&random, sun);
        views++;
        v3 fo = {(float)o[0], (float)o[1], (float)o[2]}, fd = {(float)d[0], (float)d[1], (float)d[2]};
        v3 fs = {(float)sun[0], (float)sun[1], (float)sun[2]};
        atmosphere_light fast = atmosphere_along(&air, v3x_splat(fo), v3x_splat(fd), (float)near, (float)far, fs);
        truth_along(&air, o, d, near, far, sun, scatter, transmit);
        double error = brightest_error(&fast, scatter);
        total += error;
        worst = fmax(worst, error);
        for (int c = 0; c < 3; c++)
            worst_transmit = fmax(worst_transmit, fabs((double)(&fast.transmit.x)[c] - transmit[c]));
    }
    printf("in-scattering: mean error %.5f, worst %.4f; transmission: worst %.4f\n", total / views, worst,
           worst_transmit);
    assert_true(total / views < 0.0005);
    assert_true(worst < 0.02);
    assert_true(worst_transmit < 0.002);
}

static void more_samples_converge(void **state)
{
    (void)state;
    double mean[3];
    static const int counts[3] = {4, 16, 64};
    for (int k = 0; k < 3; k++) {
        amb_atmosphere air = earth(counts[k]);
        uint32_t random = 5;
        double total = 0;
        for (int views = 0; views < 600;) {
            double o[3], d[3], sun[3], near, far, scatter[3], transmit[3];
            if (!random_view(&random, &air, o, d, &near, &far))
                continue;
            random_unit(&random, sun);
            views++;
            atmosphere_light fast = atmosphere_along(&air, (v3x){(float)o[0], (float)o[1], (float)o[2]},
                                                     (v3x){(float)d[0], (float)d[1], (float)d[2]}, (float)near,
                                                     (float)far, (v3){(float)sun[0], (float)sun[1], (float)sun[2]});
            truth_along(&air, o, d, near, far, sun, scatter, transmit);
            total += brightest_error(&fast, scatter);
        }
        mean[k] = total / 600;
    }
    assert_true(mean[1] < 0.5 * mean[0]);
    assert_true(mean[2] < mean[1]);
}

static void fitted_depth_agrees_with_the_table_it_stands_for(void **state)
{
    (void)state;
    static const float shells[][2] = {{1.025f, 0.00625f}, {1.05f, 0.01f}, {1.02f, 0.004f}}; /* top, scale height */
    for (int s = 0; s < 3; s++) {
        amb_atmosphere air = {.radius = 1, .top = shells[s][0], .scale_height = shells[s][1]};
        amb_atmosphere_fit(&air);
        double h0 = (double)air.scale_height;
        for (double h = 0; h < 1.01; h += 0.25) {
            double r = 1 + h * h0, horizon = -sqrt(1 - 1 / (r * r));
            for (double cosine = 1; cosine > horizon + 1e-3; cosine -= 0.01) {
                double p[3] = {0, r, 0}, d[3] = {sqrt(1 - cosine * cosine), cosine, 0};
                double truth = truth_depth(&air, p, d, 4000);
                double fast = (double)atmosphere_depth(&air, (float)exp(-h), (float)cosine);
                assert_true(fabs(fast / truth - 1) < 0.045);
            }
        }
        /* Straight up from the ground the depth is known exactly: H0 (1 - e^(-(top - radius)/H0)). */
        double exact = h0 * (1 - exp(-((double)air.top - 1) / h0));
        assert_true(fabs((double)atmosphere_depth(&air, 1, 1) / exact - 1) < 0.01);
    }
}

static void exponentials_are_exact_enough(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i <= 127000; i++) {
        double a = -87.0 + i * 1e-3;
        worst = fmax(worst, fabs((double)atmosphere_exp_((float)a) / exp((double)(float)a) - 1.0));
    }
    assert_true(worst < 8e-6);
    assert_true(atmosphere_exp_(-1e30f) >= 0.0f && atmosphere_exp_(-1e30f) < 2e-38f && atmosphere_exp_(0.0f) == 1.0f);
}

static void light_is_never_negative_and_never_nan(void **state)
{
    (void)state;
    amb_atmosphere air = earth(8);
    uint32_t random = 3;
    for (int i = 0; i < 200000; i++) {
        double d[3], sun[3];
        random_unit(&random, d);
        random_unit(&random, sun);
        double height = i % 4 == 0 ? 0 : i % 4 == 1 ? 0.025 : 0.03 * uniform(&random);
        v3x origin = {0, (float)(1 + height), 0};
        v3x direction = i % 5 == 0   ? (v3x){1, 0, 0}
                        : i % 5 == 1 ? (v3x){0, -1, 0}
                                     : (v3x){(float)d[0], (float)d[1], (float)d[2]};
        float near = 0, far = 0;
        maskx meets = atmosphere_sphere(origin, direction, air.top, &near, &far);
        if (!(meets & 1))
            far = near;
        v3 to_sun = i % 7 == 0 ? (v3){0, -1, 0} : (v3){(float)sun[0], (float)sun[1], (float)sun[2]};
        atmosphere_light light = atmosphere_along(&air, origin, direction, near > 0 ? near : 0, far, to_sun);
        for (int c = 0; c < 3; c++) {
            float scatter = (&light.in_scatter.x)[c], transmit = (&light.transmit.x)[c];
            assert_true(scatter >= 0 && scatter < 20);
            assert_true(transmit >= 0 && transmit <= 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_form_agrees_with_the_integrals),
        cmocka_unit_test(more_samples_converge),
        cmocka_unit_test(fitted_depth_agrees_with_the_table_it_stands_for),
        cmocka_unit_test(exponentials_are_exact_enough),
        cmocka_unit_test(light_is_never_negative_and_never_nan),
    };
    return cmocka_run_group_tests_name("atmosphere", tests, NULL, NULL);
}
