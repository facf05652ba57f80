/* Preetham's sky against the paper's formulas in double precision, and where the paper is silent. */
#include <shade/sky.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

static void near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("got %.9g, want %.9g ± %g", got, want, tolerance);
}
static v3 sun_at(double height, double azimuth) /* degrees */
{
    double h = height * pi / 180, a = azimuth * pi / 180;
    return (v3){(float)(cos(h) * sin(a)), (float)sin(h), (float)(cos(h) * cos(a))};
}

/* ---- the paper, appendix A.2, written out ------------------------------------------------------------------------ */

typedef struct perez {
    double a, b, c, d, e;
} perez;
static double perez_f(perez p, double theta, double gamma)
{
    return (1 + p.a * exp(p.b / cos(theta))) * (1 + p.c * exp(p.d * gamma) + p.e * cos(gamma) * cos(gamma));
}
static perez luminance_perez(double t)
{
    return (perez){0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                   -0.0670 * t + 0.3703};
}
static perez x_perez(double t)
{
    return (perez){-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                   -0.0033 * t + 0.0452};
}
static perez y_perez(double t)
{
    return (perez){-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                   -0.0109 * t + 0.0529};
}
static double zenith_luminance(double t, double s)
{
    double chi = (4.0 / 9.0 - t / 120.0) * (pi - 2 * s);
    return (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
}
static double zenith_x(double t, double s)
{
    double s2 = s * s, s3 = s2 * s;
    return (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) * t * t +
           (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) * t +
           (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886);
}
static double zenith_y(double t, double s)
{
    double s2 = s * s, s3 = s2 * s;
    return (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) * t * t +
           (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) * t +
           (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688);
}

static const double turbidities[] = {2, 3, 4, 6, 9};
static const double heights[] = {4, 15, 35, 60, 85};
#define COUNT(a) (sizeof(a) / sizeof *(a))

static void sky_is_the_papers(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(turbidities); i++)
        for (size_t k = 0; k < COUNT(heights); k++) {
            double t = turbidities[i], s = (90 - heights[k]) * pi / 180;
            amb_sky sky = amb_sky_make(sun_at(heights[k], 40), (float)t);
            near((double)sky.zenith.x, zenith_luminance(t, s), 1e-4);
            near((double)sky.zenith.y, zenith_x(t, s), 2e-6);
            near((double)sky.zenith.z, zenith_y(t, s), 2e-6);
            for (int i_theta = 0; i_theta < 10; i_theta++)
                for (int i_azimuth = 0; i_azimuth < 9; i_azimuth++) {
                    double theta = 0.173 * i_theta, azimuth = 0.7 * i_azimuth;
                    v3x d = {(float)(sin(theta) * sin(azimuth)), (float)cos(theta), (float)(sin(theta) * cos(azimuth))};
                    double cosine = (double)d.x * (double)sky.to_sun.x + (double)d.y * (double)sky.to_sun.y +
                                    (double)d.z * (double)sky.to_sun.z;
                    double gamma = acos(fmin(fmax(cosine, -1), 1)), at = acos(fmin((double)d.y, 1));
                    v3x c = sky_xyy(&sky, d);
                    double want_y = zenith_luminance(t, s) * perez_f(luminance_perez(t), at, gamma) /
                                    perez_f(luminance_perez(t), 0, s);
                    double want_cx = zenith_x(t, s) * perez_f(x_perez(t), at, gamma) / perez_f(x_perez(t), 0, s);
                    double want_cy = zenith_y(t, s) * perez_f(y_perez(t), at, gamma) / perez_f(y_perez(t), 0, s);
                    near((double)c.z, want_y, 3e-5 * want_y);
                    near((double)c.x, want_cx, 1e-5);
                    near((double)c.y, want_cy, 1e-5);
                }
            v3x up = sky_xyy(&sky, (v3x){0, 1, 0});
            near((double)up.z, (double)sky.zenith.x, 1e-5 * (double)sky.zenith.x);
        }
}

/* Two values of the paper's zenith luminance worked by hand, T = 2: overhead sun, χ = (4/9 - 1/60)π = 77.0°,
 * 3.1196·tan χ + 1.9882; sun at 60° from the zenith, χ = 77.0°/3. */
static void zenith_by_hand(void **state)
{
    (void)state;
    near((double)amb_sky_make((v3){0, 1, 0}, 2).zenith.x, 3.1196 * 4.33147587 + 1.9882, 2e-4);
    near((double)amb_sky_make(sun_at(30, 0), 2).zenith.x, 3.1196 * 0.48055 + 1.9882, 2e-4);
}

static void sky_turns_with_the_sun(void **state)
{
    (void)state;
    amb_sky one = amb_sky_make(sun_at(20, 0), 3), other = amb_sky_make(sun_at(20, 130), 3);
    for (int height = -30; height < 90; height += 17)
        for (int azimuth = 0; azimuth < 360; azimuth += 31) {
            v3 a = sun_at(height, azimuth), b = sun_at(height, azimuth + 130);
            v3x p = sky_rgb(&one, (v3x){a.x, a.y, a.z}), q = sky_rgb(&other, (v3x){b.x, b.y, b.z});
            near((double)p.x, (double)q.x, 2e-5 * (double)p.x + 1e-6);
            near((double)p.y, (double)q.y, 2e-5 * (double)p.y + 1e-6);
            near((double)p.z, (double)q.z, 5e-5 * (double)p.y + 1e-6);
        }
}

/* Any sun, turbidity and direction: finite, no negative channel, bright enough to be a colour. */
static void no_channel_is_negative(void **state)
{
    (void)state;
    for (int tenths = -10; tenths < 200; tenths += 9)
        for (int height = -180; height <= 180; height += 9) { /* half degrees */
            amb_sky sky = amb_sky_make(sun_at(0.5 * height, 77), 0.1f * (float)tenths);
            const float *numbers = &sky.sun_rgb.x;
            for (int i = 0; i < 6; i++) /* sun_rgb and ambient_rgb */
                assert_true(numbers[i] >= 0.0f && numbers[i] < 1000.0f);
            for (int up = -90; up <= 90; up += 9)
                for (int around = 0; around < 360; around += 30) {
                    v3 d = sun_at(up, around);
                    v3x c = sky_rgb(&sky, (v3x){d.x, d.y, d.z});
                    assert_true(c.x >= 0.0f && c.y >= 0.0f && c.z >= 0.0f);
                    assert_true(c.x + c.y + c.z > 0.0f && c.x + c.y + c.z < 5000.0f);
                }
        }
    amb_sky day = amb_sky_make(sun_at(40, 0), 3);
    v3x odd[] = {{0, 0, 0}, {NAN, 0, 1}, {0, INFINITY, 0}, {0, -1, 0}};
    for (size_t i = 0; i < COUNT(odd); i++) {
        v3x c = sky_rgb(&day, odd[i]);
        assert_true(c.x >= 0.0f && c.y >= 0.0f && c.z >= 0.0f); /* not NaN either */
    }
}

static void horizon_is_continuous(void **state)
{
    (void)state;
    amb_sky sky = amb_sky_make(sun_at(6, 20), 2.5f);
    for (int azimuth = 0; azimuth < 360; azimuth += 10) {
        v3 above = sun_at(0.01, azimuth), below = sun_at(-0.01, azimuth), deep = sun_at(-50, azimuth);
        v3x a = sky_rgb(&sky, (v3x){above.x, above.y, above.z}), b = sky_rgb(&sky, (v3x){below.x, below.y, below.z});
        v3x haze = sky_horizon_rgb(&sky, (v3x){above.x, above.y, above.z});
        v3x c = sky_rgb(&sky, (v3x){deep.x, deep.y, deep.z});
        for (int i = 0; i < 3; i++) {
            near((double)(&a.x)[i], (double)(&b.x)[i], 2e-3 * (double)a.y);
            near((double)(&haze.x)[i], (double)(&b.x)[i], 2e-3 * (double)a.y);
            near((double)(&c.x)[i], (double)(&b.x)[i], 1e-4 * (double)a.y);
        }
    }
}

static void clipped_colours_keep_their_luminance(void **state)
{
    (void)state;
    for (int i = -4; i <= 4; i++)
        for (int j = -4; j <= 4; j++)
            for (int k = -4; k <= 4; k++) {
                float r = 0.25f * (float)i, g = 0.25f * (float)j, b = 0.25f * (float)k;
                v3x in = {r, g, b}, out = color_clip_negative(in);
                float y = color_luminance(in);
                assert_true(out.x >= 0 && out.y >= 0 && out.z >= 0);
                near((double)color_luminance(out), fmax((double)y, 0), 1e-6);
                if (r >= 0 && g >= 0 && b >= 0)
                    assert_memory_equal(&in, &out, sizeof in);
                /* hue: differences from grey keep their direction */
                if (y > 0)
                    near((double)((out.x - y) * (b - y)), (double)((out.z - y) * (r - y)), 1e-6);
            }
}

/* A low sun is dimmer and redder; below the horizon it is gone, and the sky darkens 100-fold in 6°. */
static void sun_reddens_and_sets(void **state)
{
    (void)state;
    v3 before = amb_sky_make(sun_at(90, 0), 3).sun_rgb;
    /* overhead: Rayleigh 0.008735·0.55^-4.08 = 0.1001, aerosol 0.0924·0.55^-1.3 = 0.2010, ozone 0.35·0.085 = 0.0298 */
    near((double)before.y, 127.5 / pi * exp(-0.3309), 0.03);
    for (int height = 80; height > 0; height -= 5) {
        v3 now = amb_sky_make(sun_at(height, 0), 3).sun_rgb;
        assert_true(now.x < before.x && now.y < before.y && now.z < before.z);
        assert_true(now.z / now.x < before.z / before.x);
        before = now;
    }
    v3 gone = amb_sky_make(sun_at(-0.3, 0), 3).sun_rgb;
    assert_true(gone.x == 0.0f && gone.y == 0.0f && gone.z == 0.0f);
    double level = (double)amb_sky_make(sun_at(0, 0), 3).zenith.x,
           dusk = (double)amb_sky_make(sun_at(-6, 0), 3).zenith.x;
    near(dusk / level, 0.01, 1e-5);
}

/* The disc's light, summed over the sphere, is the sun's: ∫ L dω / π = sun_rgb. */
static void disc_holds_the_suns_light(void **state)
{
    (void)state;
    amb_sky sky = amb_sky_make((v3){0, 1, 0}, 3);
    const float radius = 0.99f;
    double sum = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; i++) {
        double cosine = 0.98 + 0.02 * (i + 0.5) / steps, sine = sqrt(1 - cosine * cosine);
        sum += (double)sky_sun_disc(&sky, (v3x){(float)sine, (float)cosine, 0}, radius).y * 2 * pi * 0.02 / steps;
    }
    near(sum / pi, (double)sky.sun_rgb.y, 2e-3 * (double)sky.sun_rgb.y);
    assert_true(sky_sun_disc(&sky, (v3x){0.2f, 0.9797959f, 0}, radius).y == 0.0f);
}

static void ambient_is_the_hemispheres_mean(void **state)
{
    (void)state;
    amb_sky sky = amb_sky_make(sun_at(25, 50), 3);
    double sum = 0;
    const int rings = 200, sectors = 200;
    for (int i = 0; i < rings; i++)
        for (int k = 0; k < sectors; k++) {
            double theta = pi / 2 * (i + 0.5) / rings, angle = 2 * pi * (k + 0.5) / sectors;
            v3x d = {(float)(sin(theta) * cos(angle)), (float)cos(theta), (float)(sin(theta) * sin(angle))};
            sum += (double)color_luminance(sky_rgb(&sky, d)) * sin(theta) * cos(theta);
        }
    sum *= pi / 2 / rings * 2 * pi / sectors / pi;
    v3x ambient = {sky.ambient_rgb.x, sky.ambient_rgb.y, sky.ambient_rgb.z};
    near((double)color_luminance(ambient), sum, 0.01 * sum);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sky_is_the_papers),
        cmocka_unit_test(zenith_by_hand),
        cmocka_unit_test(sky_turns_with_the_sun),
        cmocka_unit_test(no_channel_is_negative),
        cmocka_unit_test(horizon_is_continuous),
        cmocka_unit_test(clipped_colours_keep_their_luminance),
        cmocka_unit_test(sun_reddens_and_sets),
        cmocka_unit_test(disc_holds_the_suns_light),
        cmocka_unit_test(ambient_is_the_hemispheres_mean),
    };
    return cmocka_run_group_tests_name("sky", tests, NULL, NULL);
}
