/* The registry's tables make sense, and every scene is a pure function of parameters, time and size. */
#include <ambiance/post.h>
#include <ambiance/scene.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static amb_context *context;
static amb_assets *assets;

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static void registry_lists_the_same_scenes_for_every_isa(void **state)
{
    (void)state;
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    for (size_t k = 0; k < 3; k++) {
        if (!amb_scene_by_index(isas[k], 0))
            continue; /* not in this build */
        for (int i = 0; i < amb_scene_count(); i++) {
            const amb_scene *scene = amb_scene_by_index(isas[k], i), *first = amb_scene_by_index(AMB_ISA_V2, i);
            assert_non_null(scene);
            assert_string_equal(scene->name, first->name);
            assert_ptr_equal(amb_scene_by_name(isas[k], scene->name), scene);
            /* each instruction set has its own code */
            assert_true(k == 0 || scene->frame != first->frame || scene->load != first->load);
            for (int other = 0; other < i; other++)
                assert_string_not_equal(scene->name, amb_scene_by_index(isas[k], other)->name);
        }
        assert_null(amb_scene_by_index(isas[k], amb_scene_count()));
        assert_null(amb_scene_by_index(isas[k], -1));
        assert_null(amb_scene_by_name(isas[k], "no such scene"));
        assert_null(amb_scene_by_name(isas[k], ""));
        assert_null(amb_scene_by_name(isas[k], NULL));
    }
}

static bool is_line(const char *text) { return text && text[0] && !strchr(text, '\n'); }

static bool is_name(const char *text) { return is_line(text) && strlen(text) < 32 && !strpbrk(text, " =,;:/."); }

/* Names, ranges and defaults hold together, and every default prints as what reads back to the same bits. */
static void check_table(const amb_params *params, const char *owner)
{
    amb_error error = {0};
    char text[256];
    unsigned char *defaults = malloc(params->size + 1), *values = malloc(params->size + 1);
    assert_non_null(defaults);
    assert_non_null(values);
    amb_params_defaults(params, defaults);
    memcpy(values, defaults, params->size);
    for (size_t i = 0; i < params->count; i++) {
        const amb_param *p = &params->table[i];
        bool is_number = p->type != AMB_PARAM_BOOL && p->type != AMB_PARAM_CHOICE;
        size_t size = p->type == AMB_PARAM_VEC3 || p->type == AMB_PARAM_COLOR ? 12 : 4;
        assert_true(is_name(p->name));
        assert_true(is_line(p->doc));
        assert_non_null(p->unit);
        assert_true(p->offset + size <= params->size);
        assert_true(!is_number || p->minimum < p->maximum);
        for (size_t other = 0; other < i; other++) {
            assert_string_not_equal(p->name, params->table[other].name);
            size_t start = params->table[other].offset;
            assert_true(start + 4 <= p->offset || p->offset + size <= start);
        }
        assert_true(amb_params_print(p, defaults, text, sizeof text) < (int)sizeof text);
        assert_null(strpbrk(text, " ="));
        amb_status status = amb_params_set(params, values, owner, p->name, text, &error);
        if (status != AMB_OK)
            fail_msg("%s: default %s=%s: %s", owner, p->name, text, error.detail);
        if (memcmp(values, defaults, params->size) != 0)
            fail_msg("%s: default %s=%s reads back as something else", owner, p->name, text);
    }
    free(defaults);
    free(values);
}

static void scene_tables(void **state)
{
    (void)state;
    for (int i = 0; i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(AMB_ISA_AUTO, i);
        amb_chain *chain;
        amb_error error = {0};
        assert_true(is_name(scene->name));
        assert_true(is_line(scene->about));
        assert_true(scene->seconds > 0.0f && isfinite(scene->seconds));
        assert_non_null(scene->frame);
        check_table(&scene->params, scene->name);
        assert_true(scene->aov_count < AMB_MAX_LAYERS);
        for (size_t k = 0; k < scene->aov_count; k++) {
            const amb_aov *aov = &scene->aovs[k];
            assert_true(is_name(aov->name));
            assert_string_not_equal(aov->name, "color");
            assert_string_not_equal(aov->name, "all");
            assert_in_range(aov->channels, 1, AMB_MAX_CHANNELS);
            assert_true(is_line(aov->about));
            for (size_t other = 0; other < k; other++)
                assert_string_not_equal(aov->name, scene->aovs[other].name);
        }
        if (amb_chain_create(context, scene->post, &chain, &error) != AMB_OK)
            fail_msg("%s: %s", scene->name, error.detail);
        amb_chain_close(&chain);
    }
}

static void post_tables(void **state)
{
    (void)state;
    for (int i = 0; i < amb_post_count(); i++) {
        const amb_post_pass *pass = amb_post_by_index(AMB_ISA_AUTO, i);
        assert_true(is_name(pass->name));
        assert_true(is_line(pass->about));
        check_table(&pass->params, pass->name);
        for (int other = 0; other < i; other++)
            assert_string_not_equal(pass->name, amb_post_by_index(AMB_ISA_AUTO, other)->name);
    }
}

static void aov_names(void **state)
{
    (void)state;
    static const amb_aov aovs[] = {{"depth", 1, "far"}, {"normal", 3, "up"}};
    static const amb_scene scene = {.name = "test", .aovs = aovs, .aov_count = 2};
    amb_error error = {0};
    bool wanted[2] = {false, false};
    assert_int_equal(amb_scene_choose_aovs(&scene, NULL, wanted, &error), AMB_OK);
    assert_false(wanted[0] || wanted[1]);
    assert_int_equal(amb_scene_choose_aovs(&scene, (const char *const[]){"normal", "normal", NULL}, wanted, &error),
                     AMB_OK);
    assert_true(!wanted[0] && wanted[1]);
    assert_int_equal(amb_scene_choose_aovs(&scene, (const char *const[]){"all", NULL}, wanted, &error), AMB_OK);
    assert_true(wanted[0] && wanted[1]);
    assert_int_equal(amb_scene_choose_aovs(&scene, (const char *const[]){"depth", "norml", NULL}, NULL, &error),
                     AMB_ERROR_NOT_FOUND);
    assert_string_equal(error.detail, "scene test: unknown AOV: norml; did you mean normal?");
}

/* ---- rendering --------------------------------------------------------------------------------------------------- */

static amb_frame *render(const amb_show *show, double time, int width, int height, bool all)
{
    static const char *const names[] = {"all", NULL};
    amb_frame *frame;
    amb_error error = {0};
    if (amb_show_render(show, time, width, height, all ? names : NULL, &frame, &error) != AMB_OK)
        fail_msg("%s", error.detail);
    return frame;
}

static bool same_pixels(const amb_frame *a, const amb_frame *b)
{
    for (int i = 0; i < b->layer_count; i++) {
        char in_a[65], in_b[65];
        const amb_image *image = amb_frame_layer(a, b->layer[i].name);
        if (!image)
            return false;
        amb_image_sha256(image, in_a);
        amb_image_sha256(b->layer[i].image, in_b);
        if (strcmp(in_a, in_b) != 0)
            return false;
    }
    return true;
}

static void check_finite(const amb_frame *frame, const char *scene)
{
    for (int i = 0; i < frame->layer_count; i++) {
        const amb_image *image = frame->layer[i].image;
        for (int channel = 0; channel < image->channels; channel++)
            for (int y = 0; y < image->height; y++)
                for (int x = 0; x < image->width; x++) {
                    float value = amb_image_row(image, channel, y)[x];
                    if (!isfinite(value))
                        fail_msg("%s: %s at %d, %d is %g", scene, frame->layer[i].name, x, y, (double)value);
                }
    }
}

static void check_metadata(const amb_frame *frame, const amb_scene *scene, double time)
{
    assert_string_equal(frame->meta.scene, scene->name);
    assert_true(frame->meta.time == time);
    assert_string_equal(frame->meta.version, amb_version());
    assert_non_null(frame->meta.parameters);
    for (size_t i = 0; i < scene->params.count; i++)
        assert_non_null(strstr(frame->meta.parameters, scene->params.table[i].name));
}

/* Any order of frames, with and without AOVs, gives the same pixels; the picture moves, and no value is NaN. */
static void check_purity(const amb_show *show)
{
    const amb_scene *scene = amb_show_scene(show);
    amb_frame *first = render(show, 2.0, 37, 29, true),
              *other = render(show, 0.61 * (double)scene->seconds, 37, 29, true);
    amb_frame *again = render(show, 2.0, 37, 29, true), *color = render(show, 2.0, 37, 29, false);
    assert_int_equal(first->layer_count, 1 + (int)scene->aov_count);
    assert_int_equal(color->layer_count, 1);
    assert_true(same_pixels(first, again));
    assert_true(same_pixels(first, color)); /* asking for AOVs does not change color */
    if (same_pixels(first, other))
        fail_msg("%s: the same picture at two times", scene->name);
    check_finite(first, scene->name);
    check_finite(other, scene->name);
    check_metadata(first, scene, 2.0);
    amb_frame_close(&first);
    amb_frame_close(&other);
    amb_frame_close(&again);
    amb_frame_close(&color);
}

/* Extreme sizes and times are frames too. */
static void check_extremes(const amb_show *show)
{
    static const struct {
        double time;
        int width, height;
    } cases[] = {{0.0, 1, 1}, {-5.0, 3, 2}, {1e9, 16, 9}, {-1e30, 5, 7}, {0.5, 1, 70}, {0.5, 70, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        amb_frame *frame = render(show, cases[i].time, cases[i].width, cases[i].height, true);
        check_finite(frame, amb_show_scene(show)->name);
        amb_frame_close(&frame);
    }
}

static void check_errors(amb_show *show)
{
    amb_frame *frame;
    amb_error error;
    assert_int_equal(amb_show_render(show, (double)NAN, 8, 8, NULL, &frame, &error), AMB_ERROR_ARGUMENT);
    assert_null(frame);
    assert_int_equal(amb_show_render(show, (double)INFINITY, 8, 8, NULL, &frame, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_show_render(show, 0.0, 0, 8, NULL, &frame, &error), AMB_ERROR_ARGUMENT);
    assert_int_equal(amb_show_render(show, 0.0, 8, -1, NULL, &frame, &error), AMB_ERROR_ARGUMENT);
    assert_int_not_equal(amb_show_render(show, 0.0, 1000000, 1, NULL, &frame, &error), AMB_OK);
    assert_null(frame);
    assert_int_equal(amb_show_render(show, 0.0, 8, 8, (const char *const[]){"no", NULL}, &frame, &error),
                     AMB_ERROR_NOT_FOUND);
    assert_int_equal(amb_show_set(show, "no such parameter", "1", &error), AMB_ERROR_NOT_FOUND);
}

/* Each end of each range and each choice renders; a changed parameter is in the metadata. */
static void check_parameters(amb_show *show)
{
    const amb_params *params = &amb_show_scene(show)->params;
    void *defaults = malloc(params->size + 1);
    char original[256], text[256], expected[320];
    amb_error error = {0};
    assert_non_null(defaults);
    amb_params_defaults(params, defaults);
    for (size_t i = 0; i < params->count; i++) {
        const amb_param *p = &params->table[i];
        amb_params_print(p, defaults, original, sizeof original);
        for (int k = 0; k < 2; k++) {
            double end = (double)(k ? p->maximum : p->minimum);
            if (p->type == AMB_PARAM_BOOL)
                snprintf(text, sizeof text, "%s", k ? "true" : "false");
            else if (p->type == AMB_PARAM_CHOICE)
                snprintf(text, sizeof text, "%s", p->choices[k && p->choices[1] ? 1 : 0]);
            else if (p->type == AMB_PARAM_VEC3 || p->type == AMB_PARAM_COLOR)
                snprintf(text, sizeof text, "%.9g,%.9g,%.9g", end, end, end);
            else
                snprintf(text, sizeof text, "%.9g", end);
            if (amb_show_set(show, p->name, text, &error) != AMB_OK)
                fail_msg("%s", error.detail);
            amb_frame *frame = render(show, 1.0, 9, 7, false);
            snprintf(expected, sizeof expected, "%s=", p->name);
            assert_non_null(strstr(frame->meta.parameters, expected));
            amb_frame_close(&frame);
        }
        assert_int_equal(amb_show_set(show, p->name, original, &error), AMB_OK);
    }
    free(defaults);
}

static void every_scene(void **state)
{
    (void)state;
    for (int i = 0; i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(amb_context_isa(context), i);
        amb_show *show;
        amb_error error = {0};
        if (amb_show_open(context, assets, scene->name, &show, &error) != AMB_OK)
            fail_msg("%s", error.detail);
        assert_ptr_equal(amb_show_scene(show), scene);
        check_purity(show);
        check_extremes(show);
        check_errors(show);
        check_parameters(show);
        amb_show_close(&show);
        assert_null(show);
    }
}

static void unknown_scene(void **state)
{
    (void)state;
    amb_show *show;
    amb_error error;
    assert_int_equal(amb_show_open(context, assets, "no such scene at all", &show, &error), AMB_ERROR_NOT_FOUND);
    assert_null(show);
    assert_memory_equal(error.detail, "unknown scene: no such scene at all; ", 37);
    amb_show_close(&show);
}

static int open_all(void **state)
{
    (void)state;
    return amb_context_create(NULL, &context, NULL) != AMB_OK ||
           amb_assets_create(context, &(amb_assets_options){.builtin_only = true}, &assets, NULL) != AMB_OK;
}

static int close_all(void **state)
{
    (void)state;
    amb_assets_close(&assets);
    amb_context_close(&context);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(registry_lists_the_same_scenes_for_every_isa),
        cmocka_unit_test(scene_tables),
        cmocka_unit_test(post_tables),
        cmocka_unit_test(aov_names),
        cmocka_unit_test(unknown_scene),
        cmocka_unit_test(every_scene),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
