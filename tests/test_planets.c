/* The planets: features that move between key frames, shadows of rings and planets against traced rays, spheroid
 * normals, maps without seams, and earth's layers. Shading functions are called here at one lane; frames are rendered
 * at the widest instruction set. */
#include "core/dispatch.h"
#include "core/texture_layout.h"
#include "scenes/builtin/giants.h"
#include "scenes/builtin/paint.h"
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"
#include "scenes/solar.h"

#include <ambiance/io.h>

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

#define PI 3.14159265358979323846

static uint64_t random_state = 12345;
/* In [lo, hi): a linear congruential generator (D. E. Knuth's MMIX constants). */
static double uniform(double lo, double hi)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(random_state >> 11) * 0x1p-53;
}

/* ---- Jupiter: key frames ---------------------------------------------------------------------------------------- */

enum { KEY_WIDTH = 512, KEY_HEIGHT = 256 };

static double grey(const amb_texture *t, int x, int y)
{
    v4 c;
    texels_decode(t->storage, texel_at(t, 0, (x + t->info.width) % t->info.width, y, 0), 1, &c);
    return (double)c.y;
}

/* One bright feature, a Gaussian around column x, on black; or one value. */
static amb_texture *feature_map(double x, float level)
{
    amb_image *image = NULL;
    amb_texture *map = NULL;
    assert_int_equal(amb_image_create(KEY_WIDTH, 4, 4, &image, NULL), AMB_OK);
    for (int y = 0; y < 4; y++)
        for (int i = 0; i < KEY_WIDTH; i++)
            for (int c = 0; c < 4; c++)
                amb_image_row(image, c, y)[i] = x < 0 ? level : (float)exp(-(i - x) * (i - x) / 18.0);
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA32F, false, &map, NULL), AMB_OK);
    amb_image_close(&image);
    return map;
}

typedef struct peaks {
    int count;
    double place, height; /* of the highest */
} peaks;

/* Local maxima above a quarter of a feature's height along the equator at `blend` between two keys. */
static peaks peaks_at(planet_surface *u, float blend)
{
    double row[KEY_WIDTH];
    peaks found = {0, 0, 0};
    u->blend = blend;
    for (int i = 0; i < KEY_WIDTH; i++) {
        planet_point p = {.uv = {((float)i + 0.5f) / KEY_WIDTH, 0.5f}};
        row[i] = (double)planet_surface_colour(u, &p).x;
    }
    for (int i = 1; i + 1 < KEY_WIDTH; i++)
        if (row[i] > 0.25 && row[i] >= row[i - 1] && row[i] > row[i + 1]) {
            found.count++;
            if (row[i] > found.height)
                found.height = row[i], found.place = i;
        }
    return found;
}

/* A feature 24 texels east in the next key, and a map that says so: one peak, on its way. A cross-fade shows two. */
static void test_moving_feature_stays_one(void **state)
{
    (void)state;
    amb_texture *key = feature_map(200, 0), *next = feature_map(224, 0);
    amb_texture *east = feature_map(-1, (128.0f + 63.5f) / 255.0f), *still = feature_map(-1, 128.0f / 255.0f);
    planet_surface u = {.colour = key, .next = next, .drift = 48.0f / KEY_WIDTH};
    for (int i = 1; i < 8; i++) {
        float blend = (float)i / 8.0f;
        u.velocity = east;
        peaks moved = peaks_at(&u, blend);
        assert_int_equal(moved.count, 1);
        assert_true(fabs(moved.place - (200.0 + 24.0 * (double)blend)) <= 0.51);
        assert_true(moved.height > 0.98);
    }
    u.velocity = still;
    assert_int_equal(peaks_at(&u, 0.5f).count, 2);
    amb_texture_close(&key);
    amb_texture_close(&next);
    amb_texture_close(&east);
    amb_texture_close(&still);
}

AMB_DECLARE_WIDE(v4x, amb_jupiter_colour, (v3x direction, const void *user));
AMB_DECLARE_WIDE(v4x, amb_jupiter_velocity, (v3x direction, const void *user));

/* A row without its slow changes. */
static void details(const amb_texture *t, int y, double *out)
{
    for (int x = 0; x < KEY_WIDTH; x++) {
        double mean = 0;
        for (int i = -24; i <= 24; i++)
            mean += grey(t, x + i, y) / 49.0;
        out[x] = grey(t, x, y) - mean;
    }
}

/* Σ a(x) b(x + shift), b at whole texels. */
static double product(const double *a, const double *b, int shift)
{
    double sum = 0;
    for (int x = 0; x < KEY_WIDTH; x++)
        sum += a[x] * b[(x + shift + KEY_WIDTH) % KEY_WIDTH];
    return sum;
}

/* Shift of b against a by the peak of their correlation. */
static double shift_between(const double *a, const double *b)
{
    int best = 0;
    for (int s = -10; s <= 10; s++)
        best = product(a, b, s) > product(a, b, best) ? s : best;
    double l = product(a, b, best - 1), c = product(a, b, best), r = product(a, b, best + 1);
    return best + 0.5 * (l - r) / (l - 2.0 * c + r);
}

/* From every key to the next, the last to the first too, bands move as the velocity map says. */
static void test_keys_drift_as_the_velocity_map_says(void **state)
{
    (void)state;
    amb_context *context = NULL;
    amb_texture *key[JUPITER_KEYS] = {NULL}, *velocity = NULL;
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    amb_isa isa = amb_context_isa(context);
    for (int i = 0; i < JUPITER_KEYS; i++)
        assert_int_equal(amb_map_paint(context, KEY_WIDTH, KEY_HEIGHT, 1, AMB_DISPATCH(isa, amb_jupiter_colour),
                                       &(giant_frame){(float)i}, AMB_TEXEL_RGBA32F, &key[i], NULL),
                         AMB_OK);
    assert_int_equal(amb_map_paint(context, KEY_WIDTH, KEY_HEIGHT, 1, AMB_DISPATCH(isa, amb_jupiter_velocity), NULL,
                                   AMB_TEXEL_R8, &velocity, NULL),
                     AMB_OK);
    double a[KEY_WIDTH], b[KEY_WIDTH];
    for (int i = 0; i < JUPITER_KEYS; i++) {
        double error = 0, swing = 0;
        int rows = 0;
        for (int y = 64; y < 192; y += 4) {
            v4 v;
            texels_decode(velocity->storage, texel_at(velocity, 0, 0, y, 0), 1, &v);
            double want =
                ((double)v.x * 255.0 - 128.0) / 127.0 * (double)JUPITER_KEY_DRIFT * 2.0 / (2.0 * PI) * KEY_WIDTH;
            details(key[i], y, a);
            details(key[(i + 1) % JUPITER_KEYS], y, b);
            error += fabs(shift_between(a, b) - want);
            swing += fabs(want);
            rows++;
        }
        print_message("keys %d to %d: mean error %.3f of %.3f texels\n", i, (i + 1) % JUPITER_KEYS, error / rows,
                      swing / rows);
        assert_true(error / rows < 0.35 * swing / rows);
    }
    for (int i = 0; i < JUPITER_KEYS; i++)
        amb_texture_close(&key[i]);
    amb_texture_close(&velocity);
    amb_context_close(&context);
}

/* ---- shadows and normals ---------------------------------------------------------------------------------------- */

typedef struct vec {
    double x, y, z;
} vec;
static vec vec_of(v3 a) { return (vec){(double)a.x, (double)a.y, (double)a.z}; }
static v3x v3x_from(vec a) { return (v3x){(float)a.x, (float)a.y, (float)a.z}; }
static vec vec_ofx(v3x a) { return (vec){(double)a.x, (double)a.y, (double)a.z}; }
static v3 v3_from(vec a) { return (v3){(float)a.x, (float)a.y, (float)a.z}; }
static double vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec vec_add(vec a, vec b, double k) { return (vec){a.x + b.x * k, a.y + b.y * k, a.z + b.z * k}; }
static vec vec_unit(vec a) { return vec_add((vec){0, 0, 0}, a, 1.0 / sqrt(vec_dot(a, a))); }
static vec vec_cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec random_direction(void)
{
    double z = uniform(-1, 1), a = uniform(0, 2 * PI), r = sqrt(1 - z * z);
    return (vec){r * cos(a), r * sin(a), z};
}

/* A planet turned any way, oblate. */
static planet_view random_view(void)
{
    vec pole = random_direction(), x = vec_unit(vec_cross(pole, random_direction()));
    planet_view view = {.scale = {1.0f, (float)uniform(0.8, 1.0), 1.0f}, .eye = {3, 1, 2}};
    view.axis[0] = v3_from(x);
    view.axis[1] = v3_from(pole);
    view.axis[2] = v3_from(vec_cross(x, pole));
    view.to_sun = v3_from(random_direction());
    return view;
}

/* Own coordinates of a world direction or point. */
static vec own(const planet_view *view, vec w)
{
    return (vec){vec_dot(w, vec_of(view->axis[0])), vec_dot(w, vec_of(view->axis[1])),
                 vec_dot(w, vec_of(view->axis[2]))};
}
static vec world(const planet_view *view, vec o)
{
    vec w = {0, 0, 0};
    w = vec_add(w, vec_of(view->axis[0]), o.x);
    w = vec_add(w, vec_of(view->axis[1]), o.y);
    return vec_add(w, vec_of(view->axis[2]), o.z);
}

/* Rings with one opaque zone: a point of the planet is dark where its ray to the sun crosses the ring plane there.
 * Tolerance: 0.008 planet radii at the zone's edges. */
static void test_ring_shadow_on_the_planet(void **state)
{
    (void)state;
    enum { TEXELS = 4096, FIRST = 1200, LAST = 2500 };
    const double inner = (double)RINGS_INNER, width = (double)RINGS_OUTER - inner;
    const double from = inner + width * FIRST / TEXELS, to = inner + width * LAST / TEXELS;
    amb_image *image = NULL;
    amb_texture *rings = NULL;
    assert_int_equal(amb_image_create(TEXELS, 1, 4, &image, NULL), AMB_OK);
    for (int x = FIRST; x < LAST; x++)
        amb_image_row(image, 3, 0)[x] = 1.0f;
    assert_int_equal(amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, &rings, NULL), AMB_OK);
    int dark = 0, lit = 0;
    for (int i = 0; i < 20000; i++) {
        planet_surface u = {.view = random_view(), .rings = rings, .ring_shadow = 1.0f};
        vec d = random_direction();
        vec on = {d.x, d.y * (double)u.view.scale.y, d.z}, sun = own(&u.view, vec_of(u.view.to_sun));
        double way = -on.y / sun.y;
        vec at = vec_add(on, sun, way);
        double radius = sqrt(at.x * at.x + at.z * at.z);
        if (fabs(radius - from) < 0.008 || fabs(radius - to) < 0.008 || fabs(on.y) < 1e-3 || fabs(sun.y) < 1e-2)
            continue;
        bool shadowed = way > 0 && radius > from && radius < to;
        double got = (double)planet_under_rings(&u, v3x_from(world(&u.view, on)));
        assert_true(fabs(got - (shadowed ? 0.0 : 1.0)) < 1e-3);
        shadowed ? dark++ : lit++;
    }
    assert_true(dark > 500 && lit > 5000);
    amb_texture_close(&rings);
    amb_image_close(&image);
}

/* A point of the rings is dark where its ray to the sun meets the spheroid: half the light is gone within
 * ln 2 / sharpness of the edge. Tolerance: 0.004 planet radii at sharpness 400. */
static void test_planet_shadow_on_the_rings(void **state)
{
    (void)state;
    int dark = 0, lit = 0;
    for (int i = 0; i < 20000; i++) {
        planet_view view = random_view();
        double a = uniform(0, 2 * PI), r = uniform((double)RINGS_INNER, (double)RINGS_OUTER), s = (double)view.scale.y;
        vec at = {r * cos(a), 0, r * sin(a)}, sun = own(&view, vec_of(view.to_sun));
        /* |at + k·sun| = 1 with y divided by the semi-axis: the discriminant for spheroids of radius 1 ± tolerance. */
        double qa = sun.x * sun.x + sun.y * sun.y / (s * s) + sun.z * sun.z;
        double qb = at.x * sun.x + at.z * sun.z, qc = at.x * at.x + at.z * at.z;
        double tolerance = 0.004;
        bool inside = qb < 0 && qb * qb - qa * (qc - (1 - tolerance) * (1 - tolerance)) > 0;
        bool outside = qb > 0 || qb * qb - qa * (qc - (1 + 1e-5) * (1 + 1e-5)) < 0;
        double got = (double)planet_rings_sunlight(&view, v3x_from(world(&view, at)), 400.0f);
        if (inside)
            assert_true(got < 0.5), dark++;
        if (outside)
            assert_true(got == 1.0), lit++;
    }
    assert_true(dark > 500 && lit > 5000);
}

/* Spheroid normals against cross products of central differences of its points. */
static void test_spheroid_normals(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 4000; i++) {
        planet_view view = random_view();
        double lat = uniform(-1.5, 1.5), lon = uniform(-PI, PI), h = 1e-5, s = (double)view.scale.y;
        vec p[5];
        for (int k = 0; k < 5; k++) {
            double b = lat + (k == 1 ? h : k == 2 ? -h : 0), l = lon + (k == 3 ? h : k == 4 ? -h : 0);
            p[k] = world(&view, (vec){cos(b) * sin(l), s * sin(b), cos(b) * cos(l)});
        }
        vec want = vec_unit(vec_cross(vec_add(p[3], p[4], -1), vec_add(p[1], p[2], -1)));
        planet_point got = planet_point_of(&view, v3x_from(p[0]));
        vec off = vec_add(vec_ofx(got.normal), want, -1);
        worst = fmax(worst, sqrt(vec_dot(off, off)));
        /* The tangents are unit, at right angles to it, and point east and south. */
        assert_true(fabs(vec_dot(vec_ofx(got.east), want)) < 1e-4 && fabs(vec_dot(vec_ofx(got.south), want)) < 1e-4);
        assert_true(vec_dot(vec_ofx(got.east), vec_add(p[3], p[4], -1)) > 0);
        assert_true(vec_dot(vec_ofx(got.south), vec_add(p[1], p[2], -1)) < 0);
    }
    assert_true(worst < 1e-5);
}

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
           f->earth->load(f->context, f->assets, &f->earth_state, NULL) ||
           f->uranus->load(f->context, f->assets, &f->uranus_state, NULL);
}

static int tear_down(void **state)
{
    fixture *f = *state;
    if (f->earth_state)
        f->earth->unload(f->earth_state);
    if (f->uranus_state)
        f->uranus->unload(f->uranus_state);
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
static amb_frame *render(const fixture *f, bool earth, v3 eye, v3 target, const char *const *settings)
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
    for (size_t i = 0; i < scene->aov_count; i++)
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
        cmocka_unit_test(test_moving_feature_stays_one),  cmocka_unit_test(test_keys_drift_as_the_velocity_map_says),
        cmocka_unit_test(test_ring_shadow_on_the_planet), cmocka_unit_test(test_planet_shadow_on_the_rings),
        cmocka_unit_test(test_spheroid_normals),          cmocka_unit_test(test_no_seam_and_clean_poles),
        cmocka_unit_test(test_earth_components),          cmocka_unit_test(test_clouds_fade_at_the_limb),
        cmocka_unit_test(test_earth_light_is_finite),     cmocka_unit_test(test_tour_passes_every_body),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
