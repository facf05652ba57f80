/* Scene lucy: statues in any orientation are stood up, and its outputs add up, in a white furnace above all. */
#include <ambiance/scene.h>

#include "scenes/lucy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* A folder of our own with a small statue and an environment of radiance 1 everywhere. */
typedef struct folder {
    char root[64], mesh[128], studio[128], outdoor[128];
} folder;

static void make_parent(const char *root, const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", root, name);
    assert_int_equal(mkdir(path, 0700), 0);
}

static void write_white(const char *path)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n", file);
    for (int i = 0; i < 32; i++)
        fwrite((unsigned char[4]){128, 128, 128, 129}, 1, 4, file); /* 0.5 · 2¹ */
    fclose(file);
}

/* A pyramid of height 6 on a base of half width 1.5, its axis along +-x, y or z, far from the origin. */
static void write_pyramid(const char *path, int axis, float sign)
{
    static const float corner[5][3] = {
        {-1.5f, 0, 1.5f}, {1.5f, 0, 1.5f}, {1.5f, 0, -1.5f}, {-1.5f, 0, -1.5f}, {0, 6, 0}};
    static const int face[6][3] = {{1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 1, 5}, {1, 3, 2}, {1, 4, 3}};
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < 5; i++) {
        float p[3] = {corner[i][0], corner[i][1], corner[i][2]}, out[3];
        for (int k = 0; k < 3; k++) /* y goes to `axis`, the others follow in turn: a rotation */
            out[(k + axis + 2) % 3] = p[k];
        if (sign < 0.0f) { /* half a turn about the next axis */
            out[axis] = -out[axis];
            out[(axis + 2) % 3] = -out[(axis + 2) % 3];
        }
        fprintf(file, "v %g %g %g\n", (double)out[0] + 20.0, (double)out[1] - 7.0, (double)out[2] + 3.0);
    }
    for (int i = 0; i < 6; i++)
        fprintf(file, "f %d %d %d\n", face[i][0], face[i][1], face[i][2]);
    fclose(file);
}

static int open_folder(void **state)
{
    folder *f = calloc(1, sizeof *f);
    assert_non_null(f);
    snprintf(f->root, sizeof f->root, "/tmp/ambiance-lucy-XXXXXX");
    assert_non_null(mkdtemp(f->root));
    make_parent(f->root, "lucy");
    make_parent(f->root, "env");
    snprintf(f->mesh, sizeof f->mesh, "%s/lucy/lucy.obj", f->root);
    snprintf(f->studio, sizeof f->studio, "%s/env/studio.hdr", f->root);
    snprintf(f->outdoor, sizeof f->outdoor, "%s/env/outdoor.hdr", f->root);
    write_white(f->studio);
    write_white(f->outdoor);
    write_pyramid(f->mesh, 1, 1.0f);
    *state = f;
    return 0;
}

static int close_folder(void **state)
{
    folder *f = *state;
    char path[128];
    unlink(f->mesh);
    unlink(f->studio);
    unlink(f->outdoor);
    snprintf(path, sizeof path, "%s/lucy", f->root);
    rmdir(path);
    snprintf(path, sizeof path, "%s/env", f->root);
    rmdir(path);
    rmdir(f->root);
    free(f);
    return 0;
}

static amb_context *context;
static amb_assets *open_assets(const folder *f)
{
    amb_assets *assets = NULL;
    amb_assets_options options = {.user_dir = f->root};
    amb_error error = {0};
    if (context == NULL)
        assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    if (amb_assets_create(context, &options, &assets, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    return assets;
}

static void any_statue_stands(void **state)
{
    const folder *f = *state;
    for (int i = 0; i < 6; i++) {
        write_pyramid(f->mesh, i / 2, i & 1 ? -1.0f : 1.0f);
        amb_assets *assets = open_assets(f);
        void *loaded = NULL;
        amb_error error = {0};
        if (lucy_load(context, assets, &loaded, &error) != AMB_OK)
            fail_msg("%s", error.detail);
        const lucy_state *lucy = loaded;
        v3 lo, hi;
        amb_mesh_bounds(lucy->mesh, &lo, &hi);
        assert_true(fabsf(hi.y - lo.y - LUCY_HEIGHT) < 1e-4f && fabsf(lo.y) < 0.01f);
        assert_true(fabsf(hi.x - 0.5f) < 1e-3f && fabsf(lo.x + 0.5f) < 1e-3f); /* 1.5 of 6 is half of 2 */
        assert_true(fabsf(hi.z - 0.5f) < 1e-3f && fabsf(lo.z + 0.5f) < 1e-3f);
        for (uint32_t v = 0; v < lucy->mesh->vertex_count; v++) {
            v3 p = lucy->mesh->position[v];
            if (p.y > 1.0f)
                assert_true(fabsf(p.x) < 1e-3f && fabsf(p.z) < 1e-3f); /* the tip is on top, over the middle */
            assert_true(lucy->point[v].visibility >= 0.0f && lucy->point[v].visibility <= 1.0f);
            assert_true(fabsf(v3_length(lucy->mesh->normal[v]) - 1.0f) < 1e-5f);
        }
        lucy_unload(loaded);
        amb_assets_close(&assets);
    }
    write_pyramid(f->mesh, 1, 1.0f);
}

typedef struct setting {
    const char *name, *value;
} setting;

static amb_frame *render(const folder *f, const setting *settings)
{
    static const char *const all[] = {"all", NULL};
    amb_assets *assets = open_assets(f);
    amb_show *show = NULL;
    amb_frame *frame = NULL;
    amb_error error = {0};
    amb_status status = amb_show_open(context, assets, "lucy", &show, &error);
    for (; status == AMB_OK && settings->name; settings++)
        status = amb_show_set(show, settings->name, settings->value, &error);
    if (status == AMB_OK)
        status = amb_show_render(show, 0.0, 80, 60, all, &frame, &error);
    if (status != AMB_OK)
        fail_msg("%s", error.detail);
    amb_show_close(&show);
    amb_assets_close(&assets);
    return frame;
}

static double value_at(const amb_frame *frame, const char *layer, int channel, int x, int y)
{
    return (double)amb_image_row(amb_frame_layer(frame, layer), channel, y)[x];
}

/* In an environment of radiance 1, without shadows and key light, what is not absorbed comes back as 1: colour is
 * albedo·(1 - F) + F for every pixel of the statue. */
static void white_furnace(void **state)
{
    static const setting furnace[] = {{"key", "0"},
                                      {"occlusion", "0"},
                                      {"interreflection", "off"},
                                      {"background", "environment"},
                                      {"samples", "1"},
                                      {"tint", "1,1,1"},
                                      {NULL, NULL}};
    amb_frame *frame = render(*state, furnace);
    int statue = 0, floor = 0, sky = 0;
    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 80; x++) {
            double id = value_at(frame, "id", 0, x, y), f = value_at(frame, "fresnel", 0, x, y);
            statue += id == 1.0;
            floor += id == 2.0;
            sky += id == 0.0;
            for (int c = 0; c < 3; c++) {
                double color = value_at(frame, "color", c, x, y), albedo = value_at(frame, "albedo", c, x, y);
                if (id == 0.0)
                    assert_true(fabs(color - 1.0) < 2e-3);
                if (id != 1.0)
                    continue;
                assert_true(fabs(color - (albedo * (1.0 - f) + f)) < 4e-3);
                assert_true(fabs(value_at(frame, "reflection", c, x, y) - 1.0) < 2e-3);
                assert_true(f >= 0.05 - 1e-6 && f <= 1.0);
            }
            if (id == 1.0) {
                double n = 0.0;
                for (int c = 0; c < 3; c++)
                    n += value_at(frame, "normal", c, x, y) * value_at(frame, "normal", c, x, y);
                assert_true(fabs(n - 1.0) < 1e-5);
                assert_true(value_at(frame, "position", 1, x, y) > -0.01 &&
                            value_at(frame, "position", 1, x, y) < 2.01);
            }
            assert_true(value_at(frame, "depth", 0, x, y) >= 0.0 && value_at(frame, "depth", 0, x, y) <= 1.0);
            assert_true((value_at(frame, "depth", 0, x, y) == 1.0) == (id == 0.0));
        }
    assert_true(statue > 100 && floor > 100 && sky > 100);
    amb_frame_close(&frame);
}

/* The components are the picture: ambient + key + reflection · fresnel, rays and shadows included. */
static void components_add_up(void **state)
{
    static const setting settings[] = {{"samples", "1"}, {"key", "2"}, {"key_azimuth", "-30"}, {NULL, NULL}};
    amb_frame *frame = render(*state, settings);
    double key = 0.0, near = 1e9, far = 0.0;
    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 80; x++) {
            double id = value_at(frame, "id", 0, x, y), f = value_at(frame, "fresnel", 0, x, y);
            double px = value_at(frame, "position", 0, x, y), pz = value_at(frame, "position", 2, x, y);
            for (int c = 0; c < 3 && id == 1.0; c++) {
                double sum = value_at(frame, "ambient", c, x, y) + value_at(frame, "key", c, x, y) +
                             value_at(frame, "reflection", c, x, y) * f;
                assert_true(fabs(value_at(frame, "color", c, x, y) - sum) < 1e-5 * (1.0 + sum));
                key += value_at(frame, "key", c, x, y);
            }
            if (id == 2.0) { /* the statue's shade lies on the floor around it */
                double ambient = value_at(frame, "ambient", 1, x, y), r = sqrt(px * px + pz * pz);
                near = r < 0.8 ? fmin(near, ambient) : near;
                far = r > 1.6 ? fmax(far, ambient) : far;
            }
        }
    assert_true(key > 1.0);
    assert_true(near < 0.9 * far);
    amb_frame_close(&frame);
}

static void every_choice_renders(void **state)
{
    static const char *const material[] = {"marble", "bronze", "porcelain", "gold", "obsidian"};
    for (int i = 0; i < 5; i++) {
        const setting settings[] = {{"material", material[i]},
                                    {"environment", i & 1 ? "outdoor" : "studio"},
                                    {"floor", i & 1 ? "off" : "on"},
                                    {"turn", i & 1 ? "200" : "0"},
                                    {"key_size", i & 1 ? "0" : "45"},
                                    {"samples", i == 4 ? "3" : "1"},
                                    {NULL, NULL}};
        amb_frame *frame = render(*state, settings);
        int floor = 0;
        for (int y = 0; y < 60; y++)
            for (int x = 0; x < 80; x++) {
                floor += value_at(frame, "id", 0, x, y) == 2.0;
                for (int c = 0; c < 3; c++) {
                    double color = value_at(frame, "color", c, x, y);
                    assert_true(color >= 0.0 && color < 1000.0);
                }
            }
        assert_true((floor > 0) == !(i & 1));
        amb_frame_close(&frame);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_statue_stands),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(components_add_up),
        cmocka_unit_test(every_choice_renders),
    };
    int failed = cmocka_run_group_tests(tests, open_folder, close_folder);
    amb_context_close(&context);
    return failed;
}
