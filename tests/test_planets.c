/* Frames of planets: maps without seams, earth's layers, and the tour past all of them. Rendered at the widest
 * instruction set. */
#include "core/dispatch.h"
#include "scenes/planet.h"
#include "scenes/solar.h"
#include "tests/truth_vec.h"

#include <ambiance/assets.h>
#include <ambiance/io.h>
#include <ambiance/math.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- frames ----------------------------------------------------------------------------------------------------- */

enum { WIDTH = 128, HEIGHT = 96, PARAMS_BYTES = 1024 };

extern const planet_body planet_earth_x4, planet_uranus_x4;
#if defined(__x86_64__)
extern const planet_body planet_earth_x8, planet_earth_x16, planet_uranus_x8, planet_uranus_x16;
#endif

typedef struct fixture {
    amb_context *context;
    amb_assets *assets;
    char folder[64];
    const planet_body *earth, *uranus;
    const amb_scene *earth_scene, *uranus_scene;
    void *earth_state, *uranus_state;
} fixture;

/* Synthetic maps in a user's folder: f(u, v) per channel. */
typedef float (*map_value)(double u, double v, int channel);
static float stripes_map(double u, double v, int c)
{
    (void)c;
    return (float)(0.5 + 0.4 * cos(2 * PI * 8 * u) * sin(PI * v) + 0.1 * cos(2 * PI * 32 * u) * sin(PI * v));
}
static float patches_map(double u, double v, int c)
{
    return (float)(0.3 + 0.1 * c + 0.2 * sin(2 * PI * 5 * u) * sin(PI * v * 3));
}
static float one_map(double u, double v, int c) { return (void)u, (void)v, (void)c, 1.0f; }
static float black_map(double u, double v, int c) { return (void)u, (void)v, (float)(c == 3); }

static int write_map(const fixture *f, const char *name, map_value value)
{
    char path[160];
    amb_frame *frame = NULL;
    int width = 512, height = 256;
    if (amb_frame_create(width, height, &frame, NULL))
        return 1;
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                amb_image_row(amb_frame_layer(frame, "color"), c, y)[x] =
                    c == 3 ? 1.0f : value((x + 0.5) / width, (y + 0.5) / height, c);
    snprintf(path, sizeof path, "%s/%s.exr", f->folder, name);
    char *slash = strrchr(path, '/');
    *slash = 0;
    mkdir(path, 0700);
    *slash = '/';
    int failed = amb_write_exr(frame, path, AMB_FLOAT, NULL);
    amb_frame_close(&frame);
    return failed;
}

static const struct {
    const char *name;
    map_value value;
} maps[] = {{"stars", black_map},         {"uranus/color", stripes_map}, {"uranus/rings", black_map},
            {"earth/color", patches_map}, {"earth/night", one_map},      {"earth/water", one_map},
            {"earth/height", one_map},    {"earth/clouds", one_map}};

static int set_up(void **state)
{
    fixture *f = calloc(1, sizeof *f);
    *state = f;
    if (!f)
        return 1;
    strcpy(f->folder, "/tmp/ambiance-planets-XXXXXX");
    if (!mkdtemp(f->folder) || amb_context_create(NULL, &f->context, NULL))
        return 1;
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        if (write_map(f, maps[i].name, maps[i].value))
            return 1;
    amb_isa isa = amb_context_isa(f->context);
    f->earth = AMB_DISPATCH(isa, &planet_earth);
    f->uranus = AMB_DISPATCH(isa, &planet_uranus);
    f->earth_scene = amb_scene_by_name(isa, "earth");
    f->uranus_scene = amb_scene_by_name(isa, "uranus");
    return amb_assets_create(f->context, &(amb_assets_options){.user_dir = f->folder}, &f->assets, NULL) ||
           planet_load(f->earth, f->context, f->assets, &f->earth_state, NULL) ||
           planet_load(f->uranus, f->context, f->assets, &f->uranus_state, NULL);
}

static int tear_down(void **state)
{
    fixture *f = *state;
    planet_unload(f->earth_state);
    planet_unload(f->uranus_state);
    amb_assets_close(&f->assets);
    amb_context_close(&f->context);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
        char path[160];
        snprintf(path, sizeof path, "%s/%s.exr", f->folder, maps[i].name);
        unlink(path);
    }
    for (size_t i = 0; i < 2; i++) {
        char path[160];
        snprintf(path, sizeof path, "%s/%s", f->folder, i ? "uranus" : "earth");
        rmdir(path);
    }
    rmdir(f->folder);
    free(f);
    return 0;
}

/* A body alone, from any eye, with "name=value" settings; NULL-ended. */
static amb_frame *render_outputs(const fixture *f, bool earth, v3 eye, v3 target, const char *const *settings,
                                 bool aovs)
{
    const amb_scene *scene = earth ? f->earth_scene : f->uranus_scene;
    const planet_body *body = earth ? f->earth : f->uranus;
    const void *state = earth ? f->earth_state : f->uranus_state;
    _Alignas(16) unsigned char params[PARAMS_BYTES];
    assert_true(scene->params.size <= sizeof params);
    amb_params_defaults(&scene->params, params);
    for (int i = 0; settings[i]; i += 2)
        assert_int_equal(amb_params_set(&scene->params, params, "test", settings[i], settings[i + 1], NULL), AMB_OK);
    amb_frame *frame = NULL;
    amb_image *layer;
    assert_int_equal(amb_frame_create(WIDTH, HEIGHT, &frame, NULL), AMB_OK);
    for (size_t i = 0; i < scene->aov_count && aovs; i++)
        assert_int_equal(amb_frame_add_layer(frame, scene->aovs[i].name, scene->aovs[i].channels, &layer, NULL),
                         AMB_OK);
    amb_scene_job job = {.context = f->context, .params = params, .width = WIDTH, .height = HEIGHT, .frame = frame};
    v3 ahead = v3_normalize(v3_sub(target, eye)), up = fabsf(ahead.y) > 0.9f ? (v3){0, 0, 1} : (v3){0, 1, 0};
    amb_camera_key keys[] = {{0.0f, eye, target, up}, {1.0f, eye, target, up}};
    planet_flight flight = {keys, 2, 42.0f};
    amb_canvas canvas;
    assert_int_equal(canvas_begin(&job, scene->aovs, scene->aov_count, 1, &canvas, NULL), AMB_OK);
    planet_view view = planet_view_at(state, (const planet_params *)(const void *)params, &job, &canvas, &flight);
    amb_status status = body->draw(state, params, &view, 0.0, canvas.pass, NULL);
    assert_int_equal(canvas_finish(&job, scene->aovs, &canvas, status, NULL), AMB_OK);
    return frame;
}

static amb_frame *render(const fixture *f, bool earth, v3 eye, v3 target, const char *const *settings)
{
    return render_outputs(f, earth, eye, target, settings, true);
}

static double at(const amb_frame *frame, const char *layer, int c, int x, int y)
{
    return (double)amb_image_row(amb_frame_layer(frame, layer), c, y)[x];
}

static double largest_difference(const amb_frame *a, const amb_frame *b)
{
    double most = 0;
    for (int c = 0; c < 3; c++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
                most = fmax(most, fabs(at(a, "color", c, x, y) - at(b, "color", c, x, y)));
    return most;
}

/* A map that repeats every 45° looks the same turned by 45°, wherever the date line is; and across a pole. */
static void test_no_seam_and_clean_poles(void **state)
{
    const fixture *f = *state;
    static const v3 eyes[] = {{0, 0.2f, 3.2f}, {0.05f, 3.2f, 0.1f}, {0.1f, -3.2f, 0.05f}};
    for (int i = 0; i < 3; i++) {
        amb_frame *frame[2], *other;
        for (int k = 0; k < 2; k++) {
            const char *const settings[] = {"flat", "true", "rings",      "false", "turn", k ? "90" : "0",
                                            "tilt", "0",    "oblateness", "0",     NULL};
            frame[k] = render(f, false, eyes[i], (v3){0, 0, 0}, settings);
        }
        assert_true(largest_difference(frame[0], frame[1]) < 1e-2);
        const char *const settings[] = {"flat", "true", "rings",      "false", "turn", "11.25",
                                        "tilt", "0",    "oblateness", "0",     NULL};
        other = render(f, false, eyes[i], (v3){0, 0, 0}, settings);
        assert_true(largest_difference(frame[0], other) > 0.05); /* the measure can see a change */
        amb_frame_close(&frame[0]);
        amb_frame_close(&frame[1]);
        amb_frame_close(&other);
    }
}

/* colour = day + night + gloss without air and clouds; cities shine only where the sun does not. */
static void test_earth_components(void **state)
{
    const fixture *f = *state;
    const char *const settings[] = {"air", "false", "clouds", "0", "sun_azimuth", "100", "sun_elevation", "10", NULL};
    const double degree = PI / 180;
    const vec sun = {cos(10 * degree) * sin(100 * degree), sin(10 * degree), cos(10 * degree) * cos(100 * degree)};
    amb_frame *frame = render(f, true, (v3){0, 0.2f, 2.9f}, (v3){0, 0, 0}, settings);
    int day = 0, night = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            if (at(frame, "id", 0, x, y) == 0.0)
                continue;
            vec p = {at(frame, "position", 0, x, y), at(frame, "position", 1, x, y), at(frame, "position", 2, x, y)};
            double n_dot_l = vec_dot(vec_unit(p), sun);
            for (int c = 0; c < 3; c++) {
                double sum = at(frame, "day", c, x, y) + at(frame, "night", c, x, y) + at(frame, "gloss", c, x, y);
                assert_true(fabs(at(frame, "color", c, x, y) - sum) < 1e-6);
            }
            if (n_dot_l > 1e-4)
                assert_true(at(frame, "night", 0, x, y) == 0.0), day++;
            if (n_dot_l < -0.2) {
                assert_true(at(frame, "day", 0, x, y) == 0.0 && at(frame, "gloss", 0, x, y) == 0.0);
                assert_true(fabs(at(frame, "night", 0, x, y) / -n_dot_l - 2.2) < 1e-2);
                night++;
            }
        }
    assert_true(day > 1000 && night > 1000);
    amb_frame_close(&frame);
}

/* Clouds' alpha is 1 - (1 - n.v)^k under a closed cover: a frame with k = 1 against one with k = 50 and one without. */
static void test_clouds_fade_at_the_limb(void **state)
{
    const fixture *f = *state;
    static const char *const exponents[] = {"1", "50"};
    const double shell = 1.0 + (double)0.0035f;
    v3 eye = {0, 0.2f, 2.9f};
    amb_frame *frame[3];
    for (int i = 0; i < 3; i++) {
        const char *const settings[] = {"air", "false",  "cloud_shadow",    "0",          "sun_azimuth",
                                        "0",   "clouds", i < 2 ? "1" : "0", "cloud_ring", exponents[i % 2],
                                        NULL};
        frame[i] = render(f, true, eye, (v3){0, 0, 0}, settings);
    }
    int middle = 0, limb = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            if (at(frame[0], "id", 0, x, y) == 0.0)
                continue;
            vec p = {at(frame[0], "position", 0, x, y), at(frame[0], "position", 1, x, y),
                     at(frame[0], "position", 2, x, y)};
            vec to_eye = vec_unit(vec_add(vec_of(eye), p, -1));
            double b = vec_dot(p, to_eye), up = sqrt(b * b - vec_dot(p, p) + shell * shell) - b;
            double n_dot_v = vec_dot(vec_unit(vec_add(p, to_eye, up)), to_eye);
            double ground = at(frame[2], "color", 0, x, y), whole = at(frame[1], "color", 0, x, y) - ground;
            if (fabs(whole) < 0.05)
                continue;
            double want = n_dot_v / (1.0 - pow(1.0 - n_dot_v, 50.0));
            assert_true(fabs((at(frame[0], "color", 0, x, y) - ground) / whole - want) < 0.02);
            middle += n_dot_v > 0.8;
            limb += n_dot_v < 0.25;
        }
    assert_true(middle > 500 && limb > 50);
    for (int i = 0; i < 3; i++)
        amb_frame_close(&frame[i]);
}

/* From space, along the ground, inside the air and at its very edge, by day and night: light is finite and not below
 * 0. */
static void test_earth_light_is_finite(void **state)
{
    const fixture *f = *state;
    static const v3 views[][2] = {{{0, 0, 2.5f}, {0, 0, 0}},        {{0, 0, 1.0201f}, {1, 0.2f, 1.0f}},
                                  {{0, 0.3f, 1.0f}, {0, 1.01f, 0}}, {{0, 1.003f, 0}, {0, 1.003f, 1}},
                                  {{-1.012f, 0, 0}, {-1, 1, 0.1f}}, {{1.3f, 0, 0}, {0, 1.01f, 0}}};
    static const char *const suns[] = {"0", "90", "180", "-88"};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++)
        for (int s = 0; s < 4; s++) {
            const char *const settings[] = {"sun_azimuth", suns[s], "sun_elevation", "0", NULL};
            amb_frame *frame = render(f, true, views[i][0], views[i][1], settings);
            double sum = 0;
            for (int c = 0; c < 3; c++)
                for (int y = 0; y < HEIGHT; y++)
                    for (int x = 0; x < WIDTH; x++) {
                        double light = at(frame, "color", c, x, y);
                        assert_true(light >= 0.0 && light < 1e4);
                        sum += light;
                    }
            assert_true(sum > 0);
            amb_frame_close(&frame);
        }
}

/* Light is what is left of the ground's, plus what the air scatters: the parts that `show` gives alone add up; and
 * other outputs beside the colour (for which the air takes two draws instead of one) change none of its bits. */
static void test_air_parts_add_up(void **state)
{
    const fixture *f = *state;
    static const char *const parts[] = {"beauty", "beauty", "attenuation", "scattering"};
    static const char *const airs[] = {"true", "false", "true", "true"};
    v3 eye = {0.3f, 0.9f, 2.6f};
    amb_frame *frame[5];
    for (int i = 0; i < 5; i++) {
        const char *const settings[] = {"show",    parts[i % 4], "air",         airs[i % 4], "clouds", "0",
                                        "samples", "1",          "sun_azimuth", "70",        NULL};
        frame[i] = render_outputs(f, true, eye, (v3){0, 0, 0}, settings, i < 4);
    }
    int ground = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                assert_true(at(frame[0], "color", c, x, y) == at(frame[4], "color", c, x, y));
                if (at(frame[0], "id", 0, x, y) == 0.0)
                    continue;
                double left = at(frame[1], "color", c, x, y) * at(frame[2], "color", c, x, y);
                double sum = left + at(frame[3], "color", c, x, y);
                assert_true(fabs(at(frame[0], "color", c, x, y) - sum) < 2e-6);
                ground++;
            }
    assert_true(ground > 9000);
    for (int i = 0; i < 5; i++)
        amb_frame_close(&frame[i]);
}

/* ---- the tour --------------------------------------------------------------------------------------------------- */

/* The flight keeps clear of every body, moves and turns without a jump, and shows each body large once. */
static void test_tour_passes_every_body(void **state)
{
    (void)state;
    solar_place place[SOLAR_BODIES];
    amb_camera_key key[SOLAR_KEYS];
    solar_places(place);
    size_t count = solar_path(place, key);
    assert_true(count <= SOLAR_KEYS && key[0].time == 0.0f && key[count - 1].time == SOLAR_SECONDS);
    for (size_t i = 1; i < count; i++)
        assert_true(key[i].time > key[i - 1].time);
    double largest[SOLAR_BODIES] = {0}, most_turn = 0;
    vec before = {0, 0, 0}, ahead_before = {0, 0, 0};
    for (int i = 0; i <= 1200; i++) {
        amb_camera camera =
            amb_camera_at(key, count, (float)i * 0.1f, SOLAR_FOV * AMB_PI / 180.0f, 0.01f, 1000.0f, 4, 3);
        vec eye = vec_of(camera.position), ahead = vec_unit(vec_add(vec_of(camera.target), eye, -1));
        for (int b = 0; b < SOLAR_BODIES; b++) {
            vec to_body = vec_add(vec_of(place[b].centre), eye, -1);
            double distance = sqrt(vec_dot(to_body, to_body)) / (double)place[b].radius;
            assert_true(distance > 1.5);
            if (vec_dot(vec_unit(to_body), ahead) > 0.93)
                largest[b] = fmax(largest[b], 1.0 / distance);
        }
        if (i > 0) {
            vec step = vec_add(eye, before, -1);
            assert_true(sqrt(vec_dot(step, step)) < 1.0);
            most_turn = fmax(most_turn, acos(fmin(vec_dot(ahead, ahead_before), 1.0)) / 0.1 * 180 / PI);
        }
        before = eye, ahead_before = ahead;
    }
    print_message("fastest turn: %.1f degrees a second\n", most_turn);
    assert_true(most_turn < 90);
    for (int b = 0; b < SOLAR_BODIES; b++)
        assert_true(largest[b] > 0.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_seam_and_clean_poles), cmocka_unit_test(test_earth_components),
        cmocka_unit_test(test_clouds_fade_at_the_limb), cmocka_unit_test(test_earth_light_is_finite),
        cmocka_unit_test(test_air_parts_add_up),        cmocka_unit_test(test_tour_passes_every_body),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
