/* Scene julia: the distance against quaternions in double precision and fine steps, the normal against differences,
 * the picture's components against each other. */
#include "tests/julia_probe.h"

#include <ambiance/scene.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { POINTS = 1001, SHAPES = 24 };
#define PERIOD 80.0

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

/* Connected shapes: along the path, and some that it does not meet. */
static v4 shape(int i)
{
    static const v4 others[4] = {
        {-1, 0.2f, 0, 0}, {-0.08f, 0, -0.78f, -0.025f}, {0, 0, 0, 0}, {-0.6f, 0.1f, 0.1f, 0.3f}};
    return i < 4 ? others[i] : amb_julia_path(PERIOD * (i - 4) / (SHAPES - 4), PERIOD);
}

/* ---- quaternions, plainly -----------------------------------------------------------------------------------------
 */

typedef struct quaternion {
    double r, i, j, k;
} quaternion;

static quaternion multiply(quaternion a, quaternion b)
{
    return (quaternion){a.r * b.r - a.i * b.i - a.j * b.j - a.k * b.k, a.r * b.i + a.i * b.r + a.j * b.k - a.k * b.j,
                        a.r * b.j - a.i * b.k + a.j * b.r + a.k * b.i, a.r * b.k + a.i * b.j - a.j * b.i + a.k * b.r};
}
static double norm(quaternion a) { return sqrt(a.r * a.r + a.i * a.i + a.j * a.j + a.k * a.k); }

static quaternion next(quaternion z, v4 c)
{
    quaternion q = multiply(z, z);
    return (quaternion){q.r + (double)c.x, q.i + (double)c.y, q.j + (double)c.z, q.k + (double)c.w};
}

typedef struct orbit {
    int escaped;
    double potential, derivative;
} orbit; /* log|z|/2ⁿ; Π 2|z| / 2ⁿ / |z| · |z| */

/* Iterates far past the scene's escape radius. */
static orbit follow(double x, double y, double z, v4 c, int iterations)
{
    quaternion q = {x, y, z, 0};
    double log_slope = 0; /* log |z'| */
    for (int n = 0; n < iterations; n++) {
        if (norm(q) > 1e8) {
            double potential = ldexp(log(norm(q)), -n);
            return (orbit){1, potential, exp(log_slope - log(norm(q)) - n * log(2))};
        }
        log_slope += log(2 * norm(q));
        q = next(q, c);
    }
    return (orbit){0, 0, 0};
}

static double potential_at(const double p[3], v4 c) { return follow(p[0], p[1], p[2], c, 200).potential; }

/* Random points around the set, most of them near it. */
static void scatter(v3 *point, const julia_set *set, uint32_t seed)
{
    for (int i = 0; i < POINTS; i++) {
        v3 p = uniform3(&seed, -set->radius, set->radius);
        for (int step = 0; step < i % 8; step++) { /* walk towards the set along the gradient */
            julia_probed at;
            probe_julia_x1(set, &p, 1, &at);
            p = v3_sub(p, v3_scale(at.normal, at.distance));
        }
        point[i] = p;
    }
}

/* ---- the distance -------------------------------------------------------------------------------------------------
 */

static void distance_is_the_formula_on_quaternions(void **state)
{
    (void)state;
    static v3 point[POINTS];
    static julia_probed probed[POINTS];
    int compared = 0;
    for (int s = 0; s < SHAPES; s++) {
        v4 c = shape(s);
        julia_set set = julia_make(c, 40);
        scatter(point, &set, (uint32_t)s + 1);
        probe_julia_x4(&set, point, POINTS, probed);
        for (int i = 0; i < POINTS; i++) {
            orbit o = follow((double)point[i].x, (double)point[i].y, (double)point[i].z, c, 60);
            if (!o.escaped || probed[i].distance < 1e-4f)
                continue;
            double g = o.potential, expected = 0.5 * (g / o.derivative) / (1 + g + g * g / 3);
            double koebe = 0.25 * -expm1(-2 * g) / o.derivative;
            assert_true(expected <= koebe * 1.000001);
            /* The scene stops at a small radius and rounds the logarithm down. */
            assert_true(fabs((double)probed[i].distance / expected - 1) < 0.03);
            compared++;
        }
    }
    assert_true(compared > SHAPES * POINTS / 4);
}

/* Inside the ball of the distance, fine steps along the gradient and in random directions meet no point of the set. */
static void distance_never_overshoots(void **state)
{
    (void)state;
    enum { FINE = 24, WAYS = 3, TRIED = 400 };
    static v3 point[POINTS];
    static julia_probed probed[POINTS];
    int balls = 0, met_beyond = 0;
    for (int s = 0; s < SHAPES; s++) {
        v4 c = shape(s);
        julia_set set = julia_make(c, 60);
        scatter(point, &set, (uint32_t)s + 100);
        probe_julia_x4(&set, point, TRIED, probed);
        uint32_t seed = 5;
        for (int i = 0; i < TRIED; i++) {
            if (probed[i].distance < 1e-5f)
                continue;
            balls++;
            for (int w = 0; w < WAYS; w++) {
                v3 way = w == 0 ? v3_neg(probed[i].normal) : v3_normalize(uniform3(&seed, -1, 1));
                for (int f = 1; f <= 3 * FINE; f++) {
                    double t = (double)probed[i].distance * f / FINE;
                    int escaped = follow((double)point[i].x + t * (double)way.x, (double)point[i].y + t * (double)way.y,
                                         (double)point[i].z + t * (double)way.z, c, 2000)
                                      .escaped;
                    if (escaped)
                        continue;
                    if (f <= FINE)
                        fail_msg("c = (%g, %g, %g, %g): %g from (%g, %g, %g), but the set is %g away", (double)c.x,
                                 (double)c.y, (double)c.z, (double)c.w, (double)probed[i].distance, (double)point[i].x,
                                 (double)point[i].y, (double)point[i].z, t);
                    met_beyond++;
                    break;
                }
            }
        }
    }
    assert_true(balls > SHAPES * TRIED / 4);
    assert_true(met_beyond > balls / 3); /* the test could fail: most sets begin within three distances */
}

/* With z², the set is the unit ball and the distance known. */
static void unit_ball_is_met_exactly(void **state)
{
    (void)state;
    julia_set set = julia_make((v4){0, 0, 0, 0}, 60);
    for (int i = 1; i < 100; i++) {
        v3 p = v3_scale((v3){0.6f, -0.64f, 0.48f}, 1.0f + 0.01f * (float)i);
        julia_probed at;
        probe_julia_x1(&set, &p, 1, &at);
        assert_true(at.distance <= 0.01f * (float)i && at.distance > 0.3f * 0.01f * (float)i);
        assert_true(v3_length(v3_sub(at.normal, v3_normalize(p))) < 1e-5f);
        p = v3_scale(p, 0.99f / (1.0f + 0.01f * (float)i));
        probe_julia_x1(&set, &p, 1, &at);
        assert_true(at.distance == 0);
    }
    assert_true(set.radius >= 1 && set.radius < 1.001f);
}

static void normal_is_the_gradient_of_the_potential(void **state)
{
    (void)state;
    static v3 point[POINTS];
    static julia_probed probed[POINTS];
    int compared = 0;
    for (int s = 0; s < SHAPES; s++) {
        v4 c = shape(s);
        julia_set set = julia_make(c, 40);
        scatter(point, &set, (uint32_t)s + 200);
        probe_julia_x4(&set, point, POINTS, probed);
        for (int i = 0; i < POINTS; i++) {
            if (probed[i].distance < 1e-3f)
                continue;
            double g[3], length = 0, step = (double)probed[i].distance * 1e-3, dot = 0;
            for (int k = 0; k < 3; k++) {
                double p[3] = {(double)point[i].x, (double)point[i].y, (double)point[i].z};
                p[k] += step;
                double above = potential_at(p, c);
                p[k] -= 2 * step;
                g[k] = above - potential_at(p, c);
                length += g[k] * g[k];
            }
            const double n[3] = {(double)probed[i].normal.x, (double)probed[i].normal.y, (double)probed[i].normal.z};
            for (int k = 0; k < 3; k++)
                dot += n[k] * g[k] / sqrt(length);
            assert_true(dot > 0.998); /* 3.6°: the scene stops at a small radius */
            compared++;
        }
    }
    assert_true(compared > SHAPES * POINTS / 4);
}

static void widths_agree_in_every_bit(void **state)
{
    (void)state;
    static v3 point[POINTS];
    static julia_probed one[POINTS], wide[POINTS];
    for (int s = 0; s < SHAPES; s++) {
        julia_set set = julia_make(shape(s), 3 + s);
        scatter(point, &set, (uint32_t)s + 300);
        probe_julia_x1(&set, point, POINTS, one);
        probe_julia_x4(&set, point, POINTS, wide);
        assert_memory_equal(one, wide, sizeof one);
#if defined(__x86_64__)
        if (amb_isa_available(AMB_ISA_V3)) {
            probe_julia_x8(&set, point, POINTS, wide);
            assert_memory_equal(one, wide, sizeof one);
        }
        if (amb_isa_available(AMB_ISA_V4)) {
            probe_julia_x16(&set, point, POINTS, wide);
            assert_memory_equal(one, wide, sizeof one);
        }
#endif
    }
}

static void path_is_closed_smooth_and_connected(void **state)
{
    (void)state;
    v4 before = amb_julia_path(-0.05, PERIOD), at = amb_julia_path(0, PERIOD);
    float longest = 0;
    for (int i = 0; i <= 1600; i++) {
        v4 next_at = amb_julia_path(0.05 * (i + 1), PERIOD);
        v4 step = v4_sub(at, before), next_step = v4_sub(next_at, at);
        assert_true(v4_length(v4_sub(next_step, step)) < 5e-4f); /* no kink, across the seam neither */
        longest = amb_s_max(longest, v4_length(step));
        before = at;
        at = next_at;
    }
    assert_true(longest > 1e-3f && longest < 0.01f);
    for (int i = 0; i < 800; i++) { /* connected: the orbit of 0 stays bounded */
        orbit o = follow(0, 0, 0, amb_julia_path(0.1 * i, PERIOD), 3000);
        assert_false(o.escaped);
    }
    v4 a = amb_julia_path(12.25, PERIOD), b = amb_julia_path(12.25 + 5 * PERIOD, PERIOD);
    assert_memory_equal(&a, &b, sizeof a);
}

/* ---- the picture --------------------------------------------------------------------------------------------------
 */

enum { WIDTH = 120, HEIGHT = 90 };

static amb_context *context;
static amb_assets *assets;

static int set_up(void **state)
{
    (void)state;
    amb_context_options options = {.threads = 2};
    amb_assets_options builtin = {.builtin_only = true};
    return amb_context_create(&options, &context, NULL) || amb_assets_create(context, &builtin, &assets, NULL);
}
static int tear_down(void **state)
{
    (void)state;
    amb_assets_close(&assets);
    amb_context_close(&context);
    return 0;
}

static amb_frame *picture(const char *const *settings, double time)
{
    amb_show *show = NULL;
    amb_frame *frame = NULL;
    static const char *const all[] = {"all", NULL};
    assert_int_equal(amb_show_open(context, assets, "julia", &show, NULL), AMB_OK);
    for (; settings && *settings; settings += 2)
        assert_int_equal(amb_show_set(show, settings[0], settings[1], NULL), AMB_OK);
    assert_int_equal(amb_show_render(show, time, WIDTH, HEIGHT, all, &frame, NULL), AMB_OK);
    amb_show_close(&show);
    return frame;
}
static float value(const amb_frame *frame, const char *layer, int channel, int x, int y)
{
    return amb_image_row(amb_frame_layer(frame, layer), channel, y)[x];
}
static v3 value3(const amb_frame *frame, const char *layer, int x, int y)
{
    return (v3){value(frame, layer, 0, x, y), value(frame, layer, 1, x, y), value(frame, layer, 2, x, y)};
}

static void components_add_up_and_stand_alone(void **state)
{
    (void)state;
    static const char *const names[] = {"ambient", "diffuse", "specular", "reflection"};
    amb_frame *frame = picture(NULL, 0), *alone[5];
    for (int k = 0; k < 5; k++)
        alone[k] = picture((const char *[]){"component", k < 4 ? names[k] : "fresnel", NULL}, 0);
    int hits = 0, bright[4] = {0};
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int hit = value(frame, "id", 0, x, y) == 1;
            assert_true(hit == (value(frame, "depth", 0, x, y) < 1));
            v3 sum = {0, 0, 0};
            for (int k = 0; k < 4; k++) {
                v3 part = value3(frame, names[k], x, y), shown = value3(alone[k], "color", x, y);
                assert_true(part.x == shown.x && part.y == shown.y && part.z == shown.z);
                sum = v3_add(sum, part);
                bright[k] += part.y > 0.05f;
            }
            assert_true(value(frame, "fresnel", 0, x, y) == value(alone[4], "color", 1, x, y));
            v3 color = value3(frame, "color", x, y);
            if (hit)
                assert_true(v3_length(v3_sub(color, sum)) <= 1e-5f * v3_length(color));
            else
                assert_true(v3_length(sum) == 0 && color.x > 0);
            hits += hit;
        }
    assert_true(hits > WIDTH * HEIGHT / 6 && hits < WIDTH * HEIGHT * 5 / 6);
    for (int k = 0; k < 4; k++) {
        assert_true(bright[k] > 20);
        amb_frame_close(&alone[k]);
    }
    amb_frame_close(&alone[4]);
    amb_frame_close(&frame);
}

/* Positions lie on the set, normals face the eye, the Fresnel and Lambert terms are the seed's formulas. */
static void surface_layers_hold_together(void **state)
{
    (void)state;
    amb_frame *frame = picture((const char *[]){"fresnel_power", "1.7", "shadow", "0", "light_direction", "0,1,0",
                                                "light_color", "1,1,1", "diffuse", "1", NULL},
                               0);
    julia_set set = julia_make(amb_julia_path(0, PERIOD), 24);
    const v3 eye = {0.324f, 0.972f, 2.86f};
    int hits = 0, facing = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            if (value(frame, "id", 0, x, y) == 0)
                continue;
            v3 p = value3(frame, "position", x, y), n = value3(frame, "normal", x, y);
            julia_probed at;
            probe_julia_x1(&set, &p, 1, &at);
            float pixel = 2 * tanf(0.4f) / HEIGHT * v3_length(v3_sub(p, eye));
            assert_true(at.distance <= 0.51f * pixel);
            assert_true(fabsf(v3_length(n) - 1) < 1e-5f);
            assert_true(v3_length(v3_sub(n, at.normal)) < 1e-3f || at.distance == 0);
            double view = (double)v3_dot(n, v3_normalize(v3_sub(eye, p)));
            facing += view > 0;
            double fresnel = 1 - pow(fmax(view, 0), (double)1.7f);
            assert_true(fabs((double)value(frame, "fresnel", 0, x, y) - fresnel) < 1e-4);
            v3 albedo = value3(frame, "albedo", x, y), diffuse = value3(frame, "diffuse", x, y);
            v3 lambert = v3_scale(albedo, amb_s_max(n.y, 0));
            assert_true(v3_length(v3_sub(diffuse, lambert)) < 1e-5f);
            hits++;
        }
    assert_true(hits > WIDTH * HEIGHT / 6);
    assert_true(facing > hits * 97 / 100);
    amb_frame_close(&frame);
}

static void more_samples_change_only_the_color(void **state)
{
    (void)state;
    amb_frame *one = picture(NULL, 9), *four = picture((const char *[]){"samples", "4", NULL}, 9);
    int softer = 0;
    for (int i = 0; i < one->layer_count; i++)
        for (int y = 0; y < HEIGHT; y++) {
            const amb_image *a = one->layer[i].image, *b = four->layer[i].image;
            for (int x = 0; x < WIDTH; x++) {
                int same = amb_image_row(a, 0, y)[x] == amb_image_row(b, 0, y)[x];
                assert_true(same || i == 0);
                softer += !same;
            }
        }
    assert_true(softer > WIDTH * HEIGHT / 10);
    amb_frame_close(&one);
    amb_frame_close(&four);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distance_is_the_formula_on_quaternions),
        cmocka_unit_test(distance_never_overshoots),
        cmocka_unit_test(unit_ball_is_met_exactly),
        cmocka_unit_test(normal_is_the_gradient_of_the_potential),
        cmocka_unit_test(widths_agree_in_every_bit),
        cmocka_unit_test(path_is_closed_smooth_and_connected),
        cmocka_unit_test(components_add_up_and_stand_alone),
        cmocka_unit_test(surface_layers_hold_together),
        cmocka_unit_test(more_samples_change_only_the_color),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
