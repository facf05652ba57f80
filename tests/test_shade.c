/* Shading functions against double precision written from the equations, and against the identities they must obey. */
#include "lanes.h"

#include <math.h>
#include <setjmp.h>
#include <shade/color.h>
#include <shade/diffuse.h>
#include <shade/fog.h>
#include <shade/fresnel.h>
#include <shade/normal_map.h>
#include <shade/phase.h>
#include <shade/ring.h>
#include <shade/specular.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

LANES_DECLARE(lanes_shade);
static const lanes_set shade_set = LANES_SET(lanes_shade);
static const double pi = 3.14159265358979323846;

static void near(float got, double want, double tolerance)
{
    if (!(fabs((double)got - want) <= tolerance))
        fail_msg("got %.9g, want %.9g ± %g", (double)got, want, tolerance);
}

typedef struct d3 {
    double x, y, z;
} d3;
static double dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static d3 unit(d3 a)
{
    double s = 1.0 / sqrt(dot(a, a));
    return (d3){a.x * s, a.y * s, a.z * s};
}
static d3 widen(v3 a) { return (d3){(double)a.x, (double)a.y, (double)a.z}; }
static v3x direction(uint64_t *seed)
{
    float f[3];
    do
        lanes_floats_in(lanes_random(seed), -1.0f, 1.0f, f, 3);
    while (f[0] * f[0] + f[1] * f[1] + f[2] * f[2] < 0.1f);
    return v3x_normalize((v3x){f[0], f[1], f[2]});
}
static v3 uniform(v3x a) { return (v3){a.x, a.y, a.z}; }

/* ---- diffuse ------------------------------------------------------------------------------------------------------
 */

static void diffuse_follows_the_report(void **state)
{
    (void)state;
    for (int i = -1000; i <= 1000; i++) {
        float c = (float)i / 1000.0f;
        double d = (double)c;
        near(diffuse_lambert(c), fmax(d, 0.0), 0.0);
        near(diffuse_night(c), fmax(-d, 0.0), 0.0);
        for (int k = 0; k <= 10; k++) {
            float w = (float)k / 10.0f;
            double wrapped = fmax((d + (double)w) / (1.0 + (double)w), 0.0);
            near(diffuse_wrapped(c, w), wrapped, 2e-7);
            if (wrapped == 0.0 || wrapped > 1e-3)
                near(diffuse_wrapped_contrast(c, w, 0.47f), pow(wrapped, (double)0.47f),
                     1e-6 + 3e-8 / (wrapped + 1e-3));
            double t = w > 0.0f ? fmin(fmax((d + (double)w) / (2.0 * (double)w), 0.0), 1.0) : (d > 0.0);
            v3x tinted = diffuse_wrapped_tinted(c, w, (v3){0.25f, 1.0f, 0.5f});
            if (w > 0.0f)
                near(tinted.x, wrapped * (0.25 + 0.75 * t * t * (3.0 - 2.0 * t)), 2e-6);
            near(tinted.y, wrapped, 3e-7);
        }
        near(diffuse_wrapped(c, 0.0f), (double)diffuse_lambert(c), 0.0);
        near(view_aligned_ring(c, 4.0f), pow(1.0 - fmax(d, 0.0), 4.0), 1e-6);
    }
    /* facing the light is 1; the wrapped light ends at n·l = -w */
    near(diffuse_wrapped(1.0f, 0.5f), 1.0, 1e-7);
    near(diffuse_wrapped(-0.5f, 0.5f), 0.0, 0.0);
    near(diffuse_wrapped_contrast(-1.0f, 0.5f, 0.47f), 0.0, 0.0);
    near(diffuse_wrapped_tinted(1.0f, 0.3f, (v3){0.0f, 0.0f, 0.0f}).x, 1.0, 1e-6);
    near(view_aligned_ring(0.0f, 7.0f), 1.0, 0.0);
}

/* ---- specular ------------------------------------------------------------------------------------------------------
 */

static void highlights_match_double(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < 20000; i++) {
        v3x nx = direction(&seed), lx = direction(&seed), vx = direction(&seed);
        d3 n = widen(uniform(nx)), l = widen(uniform(lx)), v = widen(uniform(vx));
        double nl = dot(n, l), nv = dot(n, v);
        if (fabs(nl) < 1e-3 || fabs(nv) < 1e-3)
            continue;
        d3 r = {2.0 * nl * n.x - l.x, 2.0 * nl * n.y - l.y, 2.0 * nl * n.z - l.z};
        d3 sum = {l.x + v.x, l.y + v.y, l.z + v.z};
        if (dot(sum, sum) < 0.01)
            continue;
        d3 h = unit(sum);
        near(specular_phong(nx, lx, vx, 16.0f), nl > 0 ? pow(fmax(dot(r, v), 0.0), 16.0) : 0.0, 1e-5);
        near(specular_blinn_phong(nx, lx, vx, 16.0f), nl > 0 ? pow(fmax(dot(n, h), 0.0), 16.0) : 0.0, 1e-5);
        float brdf = specular_cook_torrance(nx, lx, vx, 0.35f);
        if (nl > 0.1 && nv > 0.1) {
            double nh = dot(n, h), vh = dot(v, h), m2 = (double)0.35f * (double)0.35f;
            double d = exp((nh * nh - 1.0) / (nh * nh * m2)) / (pi * m2 * nh * nh * nh * nh);
            double want = d * fmin(1.0, fmin(2.0 * nh * nv / vh, 2.0 * nh * nl / vh)) / (4.0 * nl * nv);
            near(brdf, want, 1e-4 * want + 1e-6);
            near(specular_cook_torrance(nx, vx, lx, 0.35f), (double)brdf, 1e-5 * want + 1e-7); /* reciprocity */
        } else if (nl < 0.0 || nv < 0.0) {
            near(brdf, 0.0, 0.0);
        }
    }
    v3x up = {0.0f, 0.0f, 1.0f};
    near(specular_phong(up, up, up, 50.0f), 1.0, 1e-6);
    near(specular_blinn_phong(up, up, up, 50.0f), 1.0, 1e-5);
    /* ∫ D cosθ dω = 1 */
    for (int k = 1; k <= 5; k++) {
        float m = 0.1f * (float)k;
        double sum = 0.0;
        for (int i = 0; i < 20000; i++) {
            double theta = (i + 0.5) * (pi / 2.0) / 20000.0;
            sum += (double)specular_beckmann((float)cos(theta), m) * cos(theta) * sin(theta) * 2.0 * pi * (pi / 2.0) /
                   20000.0;
        }
        near((float)sum, 1.0, 2e-4);
    }
}

static void fresnel_terms(void **state)
{
    (void)state;
    for (int i = 0; i <= 1000; i++) {
        float c = (float)i / 1000.0f;
        double d = (double)c, f0 = (double)0.04f;
        near(fresnel_schlick(c, 0.04f), pow(1.0 - d, 5.0) + f0 * (1.0 - pow(1.0 - d, 5.0)), 3e-7);
        near(fresnel_power(c, 2.5f), 1.0 - pow(d, 2.5), 3e-7);
        double t = sqrt(1.0 - (1.0 - d * d) / 2.25), s = (d - 1.5 * t) / (d + 1.5 * t),
               p = (t - 1.5 * d) / (t + 1.5 * d);
        near(fresnel_dielectric(c, 1.5f), 0.5 * (s * s + p * p), 1e-6);
        near(fresnel_dielectric(c, 1.0f), 0.0, 1e-6);
    }
    near(fresnel_schlick(-0.5f, 0.04f), 1.0, 0.0); /* facing away counts as grazing */
    near(fresnel_schlick(0.0f, 0.3f), 1.0, 0.0);
    near(fresnel_schlick(1.0f, 0.3f), (double)0.3f, 0.0);
    near(fresnel_dielectric(1.0f, 1.5f), 0.04, 1e-7);
    near(fresnel_power(0.0f, 3.0f), 1.0, 0.0);
    near(fresnel_power(1.0f, 3.0f), 0.0, 0.0);
}

/* ---- surface detail ------------------------------------------------------------------------------------------------
 */

static void normal_maps_turn_normals(void **state)
{
    (void)state;
    uint64_t seed = 8;
    v3x flat = normal_map_decode((v3x){0.5f, 0.5f, 1.0f}, 1.0f);
    assert_true(flat.x == 0.0f && flat.y == 0.0f && flat.z == 1.0f);
    for (int i = 0; i < 5000; i++) {
        v3x m = direction(&seed), n = direction(&seed), other = direction(&seed);
        v3x t = v3x_normalize(v3x_cross(other, n)), b = normal_map_bitangent(t, n, 1.0f);
        v3x back = normal_map_decode(normal_map_encode(m), 1.0f);
        near(v3x_dot(back, m), 1.0, 1e-6);
        if (fabsf(v3x_dot(n, other)) > 0.95f)
            continue; /* too little left of t to be accurate */
        near(v3x_dot(normal_map_apply(flat, t, b, n), n), 1.0, 1e-6);
        near(v3x_dot(normal_map_apply((v3x){0.0f, 1.0f, 0.0f}, t, b, n), b), 1.0, 1e-6);
        near(v3x_dot(b, t), 0.0, 1e-6);
        near(v3x_dot(v3x_cross(t, b), n), 1.0, 1e-6); /* right-handed */
        v3x world = normal_map_apply(m, t, b, n), again = normal_map_to_tangent(world, t, b, n);
        near(again.x, (double)m.x, 2e-6);
        near(again.y, (double)m.y, 2e-6);
        near(again.z, (double)m.z, 2e-6);
    }
    v3x slope = normal_of_slopes(0.75f, 0.0f); /* 3-4-5 */
    near(slope.x, -0.6, 1e-7);
    near(slope.z, 0.8, 1e-7);
    near(normal_map_decode((v3x){0.8f, 0.5f, 0.9f}, 0.0f).z, 1.0, 0.0);
}

static void parallax_moves_toward_the_eye(void **state)
{
    (void)state;
    v3x eye = {0.6f, 0.0f, 0.8f};
    v2x uv = parallax_offset((v2x){0.25f, 0.5f}, eye, 1.0f, 0.04f, -0.02f);
    near(uv.x, 0.25 + 0.6 * 0.02, 1e-7);
    near(uv.y, 0.5, 0.0);
    near(parallax_offset((v2x){0.25f, 0.5f}, eye, 0.5f, 0.04f, -0.02f).x, 0.25, 1e-9);
    near(parallax_offset((v2x){0.25f, 0.5f}, (v3x){0.0f, 0.0f, 1.0f}, 0.9f, 0.04f, 0.0f).x, 0.25, 0.0);
}

/* ---- colour ---------------------------------------------------------------------------------------------------------
 */

static void srgb_is_the_standard_curve(void **state)
{
    (void)state;
    for (int i = 0; i <= 4000; i++) {
        float c = (float)i / 2000.0f; /* past 1 too */
        double d = (double)c;
        near(color_srgb_decode(c), d <= 0.04045 ? d / 12.92 : pow((d + 0.055) / 1.055, 2.4),
             4e-7 * fmax(1.0, d * d * d));
        near(color_srgb_encode(c), d <= 0.0031308 ? d * 12.92 : 1.055 * pow(d, 1.0 / 2.4) - 0.055, 4e-7);
        near(color_srgb_encode(color_srgb_decode(c)), d, 1e-6);
    }
    for (int i = 0; i < 256; i++) /* every byte survives */
        assert_int_equal((int)(color_srgb_encode(color_srgb_decode((float)i / 255.0f)) * 255.0f + 0.5f), i);
    near(color_srgb_decode(-0.1f), -0.1 / 12.92, 1e-8);
}

static v3x lab(float r, float g, float b) { return color_lab_of_rgb((v3x){r, g, b}); }
static void near3(v3x got, double x, double y, double z, double tolerance)
{
    near(got.x, x, tolerance);
    near(got.y, y, tolerance);
    near(got.z, z, tolerance);
}

/* Published L*a*b* of the sRGB corners (B. Lindbloom's calculator, D65). */
static void lab_of_known_colours(void **state)
{
    (void)state;
    near3(lab(1.0f, 1.0f, 1.0f), 100.0, 0.0, 0.0, 2e-4);
    near3(lab(0.0f, 0.0f, 0.0f), 0.0, 0.0, 0.0, 1e-5);
    near3(lab(1.0f, 0.0f, 0.0f), 53.2408, 80.0925, 67.2032, 0.01);
    near3(lab(0.0f, 1.0f, 0.0f), 87.7347, -86.1827, 83.1793, 0.01);
    near3(lab(0.0f, 0.0f, 1.0f), 32.2970, 79.1875, -107.8602, 0.01);
    near(lab(0.184187f, 0.184187f, 0.184187f).x, 50.0, 1e-3); /* L = 50 at Y = 0.184187 */
    near(lab(0.001f, 0.001f, 0.001f).x, 0.903296, 1e-5);      /* the straight part: 903.3·Y */
    for (int i = 0; i < 3000; i++) {
        float c[3];
        lanes_floats_in((uint64_t)i, 0.0f, 2.0f, c, 3);
        v3x rgb = {c[0], c[1], c[2]}, back = color_rgb_of_xyz(color_xyz_of_rgb(rgb));
        near3(back, (double)c[0], (double)c[1], (double)c[2], 3e-6);
        near(color_luminance(rgb), (double)color_xyz_of_rgb(rgb).y, 2e-4);
    }
    near(color_luminance((v3x){1.0f, 1.0f, 1.0f}), 1.0, 1e-7);
    near3(color_rgb_of_xyz(color_xyz_of_xyy(0.3127f, 0.3290f, 0.5f)), 0.5, 0.5, 0.5, 2e-4); /* D65 is grey */
}

/* ---- scattering -----------------------------------------------------------------------------------------------------
 */

static void phase_functions_have_mean_one(void **state)
{
    (void)state;
    const int steps = 200000;
    for (int k = -9; k <= 9; k++) {
        double g = k / 10.0, mean[3] = {0.0, 0.0, 0.0}, mean_cosine = 0.0;
        for (int i = 0; i < steps; i++) { /* dω = 2π d(cosθ) */
            float c = (float)(-1.0 + (i + 0.5) * 2.0 / steps);
            double hg = (double)phase_henyey_greenstein(c, (float)g);
            mean[0] += (double)phase_rayleigh(c) / steps;
            mean[1] += hg / steps;
            mean[2] += (double)phase_mie(c, (float)g) / steps;
            mean_cosine += hg * (double)c / steps;
        }
        for (int j = 0; j < 3; j++)
            near((float)mean[j], 1.0, 2e-5);
        near((float)mean_cosine, g, 2e-5); /* g is the mean cosine, by its definition */
    }
    for (int i = -1000; i <= 1000; i++) {
        double c = i / 1000.0, g = (double)-0.95f;
        double want = 1.5 * (1 - g * g) / (2 + g * g) * (1 + c * c) / pow(1 + g * g - 2 * g * (double)(float)c, 1.5);
        near(phase_mie((float)c, -0.95f), want, 3e-5 * want + 1e-5);
        near(phase_mie((float)c, 0.0f), (double)phase_rayleigh((float)c), 1e-6);
    }
}

static void fog_integrates_density(void **state)
{
    (void)state;
    uint64_t seed = 4;
    for (int i = 0; i < 3000; i++) {
        float v[4];
        lanes_floats_in(lanes_random(&seed), -1.0f, 1.0f, v, 4);
        float oy = v[0] * 3.0f, t = 20.0f + v[2] * 19.0f;
        float ky = i % 3 ? v[1] : v[1] * (i % 2 ? 1e-4f : 1e-8f); /* level rays too */
        double sum = 0.0;
        const int steps = 400; /* Simpson's rule */
        for (int s = 0; s <= steps; s++) {
            double weight = s == 0 || s == steps ? 1.0 : s & 1 ? 4.0 : 2.0;
            sum += weight * 0.02 * exp(-0.3 * ((double)oy + (double)ky * (double)t * s / steps));
        }
        sum *= (double)t / steps / 3.0;
        near(fog_depth(oy, ky, t, 0.02f, 0.3f), sum, 4e-6 * sum);
    }
    near(fog_depth(0.0f, 0.0f, 10.0f, 0.5f, 0.3f), 5.0, 0.0);
    near(fog_depth(5.0f, 0.7f, 10.0f, 0.5f, 0.0f), 5.0, 0.0); /* no falloff: plain length */
    near(fog_depth(1.0f, 0.5f, 0.0f, 0.5f, 0.3f), 0.0, 0.0);
}

static void rings_scatter_and_take_the_shadow(void **state)
{
    (void)state;
    near(ring_scatter(0.8f, 0.3f, 1.0f), (double)0.8f, 1e-7);
    near(ring_scatter(0.8f, 0.3f, 0.0f), (double)0.3f, 0.0);
    near(ring_scatter(0.8f, 0.3f, -1.0f), (double)0.3f, 0.0);
    v3x sun = {1.0f, 0.0f, 0.0f};
    near(ring_planet_shadow((v3x){2.0f, 0.5f, 0.0f}, sun, 1.0f, 8.0f), 1.0, 0.0);  /* before the planet */
    near(ring_planet_shadow((v3x){-2.0f, 1.5f, 0.0f}, sun, 1.0f, 8.0f), 1.0, 0.0); /* beside the shadow */
    near(ring_planet_shadow((v3x){-2.0f, 0.5f, 0.0f}, sun, 1.0f, 8.0f), exp(-4.0), 1e-7);
    near(ring_planet_shadow((v3x){-2.0f, 0.0f, 0.999f}, sun, 1.0f, 8.0f), exp(-8.0 * 0.001), 1e-5);
}

/* ---- widths ---------------------------------------------------------------------------------------------------------
 */

static void fill(const lanes_case *test, int input, float *out, size_t count)
{
    lanes_floats_in((uint64_t)input * 31u + (uint64_t)test->name[0], -1.2f, 1.2f, out, count);
    lanes_any_floats((uint64_t)input, out, count / 8);
}
static void every_width_gives_the_same_bits(void **state)
{
    (void)state;
    size_t compared;
    assert_int_equal(lanes_mismatches(&shade_set, 1u << 14, fill, &compared), 0);
    assert_true(compared > 500000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diffuse_follows_the_report),
        cmocka_unit_test(highlights_match_double),
        cmocka_unit_test(fresnel_terms),
        cmocka_unit_test(normal_maps_turn_normals),
        cmocka_unit_test(parallax_moves_toward_the_eye),
        cmocka_unit_test(srgb_is_the_standard_curve),
        cmocka_unit_test(lab_of_known_colours),
        cmocka_unit_test(phase_functions_have_mean_one),
        cmocka_unit_test(fog_integrates_density),
        cmocka_unit_test(rings_scatter_and_take_the_shadow),
        cmocka_unit_test(every_width_gives_the_same_bits),
    };
    return cmocka_run_group_tests_name("shade", tests, NULL, NULL);
}
