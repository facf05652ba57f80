/* ambiance list: scenes, one scene's tables, post passes, assets. */
#include "cli/cli.h"

#include "core/names.h"

#include <ambiance/post.h>
#include <ambiance/scene.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: ambiance list [SCENE] [--json | --names]\n"
    "       ambiance list --post [PASS] [--json | --names]\n"
    "       ambiance list --assets [--assets-dir DIR] [--pack DIR] [--json | --names]\n\n"
    "Without a name: all scenes. With one: its parameters (for `render --set`), its AOVs (for `render --aov`) and\n"
    "its default post chain. --post lists the passes of post chains and their parameters; --assets what scenes\n"
    "load and where it comes from: your folder, the pack, or built in.\n\n"
    "  --post             post passes instead of scenes\n"
    "  --assets           assets instead of scenes\n"
    "  --assets-dir DIR   with --assets: your own asset folder; `builtin`: only what the program generates itself\n"
    "  --pack DIR         with --assets: the downloaded asset pack\n"
    "  --json             for programs\n"
    "  --names            bare names, one a line: of scenes, passes or assets, or of one scene's or pass's "
    "parameters\n";

enum { LIST_TEXT, LIST_JSON, LIST_NAMES };

static const char *const type_names[] = {"float", "int", "bool", "vec3", "color", "choice"};

/* "0 to 10", "0.5 to 2 (each)", "true, false", "a, b, c" */
static void print_range(const amb_param *param, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    if (param->type == AMB_PARAM_BOOL)
        snprintf(text, size, "true, false");
    else if (param->type == AMB_PARAM_CHOICE)
        for (int i = 0; param->choices[i] && length < size; i++)
            length += (size_t)snprintf(text + length, size - length, "%s%s", i ? ", " : "", param->choices[i]);
    else
        snprintf(text, size, "%.7g to %.7g", (double)param->minimum, (double)param->maximum);
}

static void *defaults_of(const amb_params *params)
{
    void *values = malloc(params->size ? params->size : 1);
    if (values)
        amb_params_defaults(params, values);
    return values;
}

static int print_params(const amb_params *params)
{
    char value[128], range[256];
    void *values = defaults_of(params);
    if (!values)
        return fail(EXIT_FILES, "out of memory");
    for (size_t i = 0; i < params->count; i++) {
        const amb_param *p = &params->table[i];
        amb_params_print(p, values, value, sizeof value);
        print_range(p, range, sizeof range);
        printf("  %-20s %-6s = %s%s%s  [%s]\n  %20s %s\n", p->name, type_names[p->type], value, p->unit[0] ? " " : "",
               p->unit, range, "", p->doc);
    }
    if (params->count == 0)
        printf("  none\n");
    free(values);
    return 0;
}

static json_t *json_param(const amb_param *p, const void *values)
{
    char value[128];
    amb_params_print(p, values, value, sizeof value);
    json_t *object = json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", p->name, "type", type_names[p->type], "unit",
                               p->unit, "default", value, "doc", p->doc);
    if (p->type == AMB_PARAM_CHOICE) {
        json_t *choices = json_array();
        for (int i = 0; p->choices[i]; i++)
            json_array_append_new(choices, json_string(p->choices[i]));
        json_object_set_new(object, "choices", choices);
    } else if (p->type != AMB_PARAM_BOOL) {
        json_object_set_new(object, "minimum", json_float(p->minimum));
        json_object_set_new(object, "maximum", json_float(p->maximum));
    }
    return object;
}

static json_t *json_params(const amb_params *params)
{
    json_t *list = json_array();
    void *values = defaults_of(params);
    for (size_t i = 0; values && i < params->count; i++)
        json_array_append_new(list, json_param(&params->table[i], values));
    free(values);
    return list;
}

static void print_names(const amb_params *params)
{
    for (size_t i = 0; i < params->count; i++)
        puts(params->table[i].name);
}

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

static const char *scene_name(const void *user, int index)
{
    (void)user;
    return amb_scene_by_index(AMB_ISA_AUTO, index)->name;
}

static json_t *json_scene(const amb_scene *scene)
{
    json_t *aovs = json_array();
    for (size_t i = 0; i < scene->aov_count; i++)
        json_array_append_new(aovs, json_pack("{s:s, s:i, s:s}", "name", scene->aovs[i].name, "channels",
                                              scene->aovs[i].channels, "about", scene->aovs[i].about));
    return json_pack("{s:s, s:s, s:o, s:s, s:o, s:o}", "name", scene->name, "about", scene->about, "seconds",
                     json_float(scene->seconds), "post", scene->post ? scene->post : "", "parameters",
                     json_params(&scene->params), "aovs", aovs);
}

static int print_scene(const amb_scene *scene)
{
    printf("%s: %s; %g s\n\nparameters (--set NAME=VALUE)\n", scene->name, scene->about, (double)scene->seconds);
    int code = print_params(&scene->params);
    printf("\nAOVs (--aov NAME,…)\n");
    for (size_t i = 0; i < scene->aov_count; i++)
        printf("  %-20s %d channel%s  %s\n", scene->aovs[i].name, scene->aovs[i].channels,
               scene->aovs[i].channels == 1 ? " " : "s", scene->aovs[i].about);
    if (scene->aov_count == 0)
        printf("  none\n");
    printf("\npost chain\n  %s\n", scene->post ? scene->post : "none");
    return code;
}

static int list_scenes(int format)
{
    json_t *list = format == LIST_JSON ? json_array() : NULL;
    for (int i = 0; i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(AMB_ISA_AUTO, i);
        if (format == LIST_JSON)
            json_array_append_new(list, json_scene(scene));
        else if (format == LIST_NAMES)
            puts(scene->name);
        else
            printf("%-14s %6g s  %s\n", scene->name, (double)scene->seconds, scene->about);
    }
    return format == LIST_JSON ? print_json(list) : 0;
}

static int list_scene(const char *name, int format)
{
    char hint[320];
    const amb_scene *scene = amb_scene_by_name(AMB_ISA_AUTO, name);
    if (!scene)
        return fail(EXIT_USAGE, "unknown scene: %s; %s", name,
                    amb_names_hint(name, amb_scene_count(), scene_name, NULL, hint, sizeof hint));
    if (format == LIST_NAMES)
        print_names(&scene->params);
    return format == LIST_JSON ? print_json(json_scene(scene)) : format == LIST_TEXT ? print_scene(scene) : 0;
}

/* ---- post passes ------------------------------------------------------------------------------------------------- */

static const char *pass_name(const void *user, int index)
{
    (void)user;
    return amb_post_by_index(AMB_ISA_AUTO, index)->name;
}

static json_t *json_pass(const amb_post_pass *pass)
{
    return json_pack("{s:s, s:s, s:o}", "name", pass->name, "about", pass->about, "parameters",
                     json_params(&pass->params));
}

static int list_passes(int format)
{
    json_t *list = format == LIST_JSON ? json_array() : NULL;
    for (int i = 0; i < amb_post_count(); i++) {
        const amb_post_pass *pass = amb_post_by_index(AMB_ISA_AUTO, i);
        if (format == LIST_JSON)
            json_array_append_new(list, json_pass(pass));
        else if (format == LIST_NAMES)
            puts(pass->name);
        else
            printf("%-14s %s\n", pass->name, pass->about);
    }
    return format == LIST_JSON ? print_json(list) : 0;
}

static int list_pass(const char *name, int format)
{
    char hint[320];
    const amb_post_pass *pass = amb_post_by_name(AMB_ISA_AUTO, name);
    if (!pass)
        return fail(EXIT_USAGE, "unknown post pass: %s; %s", name,
                    amb_names_hint(name, amb_post_count(), pass_name, NULL, hint, sizeof hint));
    if (format == LIST_JSON)
        return print_json(json_pass(pass));
    if (format == LIST_NAMES) {
        print_names(&pass->params);
        return 0;
    }
    printf("%s: %s\n\nparameters (--post %s:NAME=VALUE,…)\n", pass->name, pass->about, pass->name);
    return print_params(&pass->params);
}

/* ---- assets ------------------------------------------------------------------------------------------------------ */

static int list_assets(const setup *chosen, int format)
{
    static const char *const sources[] = {"yours", "pack", "builtin"};
    amb_context *context;
    amb_assets *assets;
    json_t *list = format == LIST_JSON ? json_array() : NULL;
    int code = open_setup(chosen, &context, &assets);
    for (int i = 0; code == 0 && i < amb_assets_count(assets); i++) {
        amb_asset_info info;
        amb_assets_describe(assets, i, &info);
        if (format == LIST_JSON)
            json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:o}", "name", info.name, "about", info.about,
                                                  "source", sources[info.source], "path", json_text(info.path)));
        else if (format == LIST_NAMES)
            puts(info.name);
        else
            printf("%-22s %-8s %s%s%s\n", info.name, sources[info.source], info.about, info.path[0] ? "  " : "",
                   info.path);
    }
    if (code == 0 && list)
        code = print_json(list);
    else
        json_decref(list);
    amb_assets_close(&assets);
    amb_context_close(&context);
    return code;
}

static int run(int argc, char **argv)
{
    enum { POST = 1, ASSETS, JSON, NAMES };
    static const struct option options[] = {
        {"post", no_argument, NULL, POST},
        {"assets", no_argument, NULL, ASSETS},
        {"assets-dir", required_argument, NULL, OPTION_ASSETS},
        {"pack", required_argument, NULL, OPTION_PACK},
        {"json", no_argument, NULL, JSON},
        {"names", no_argument, NULL, NAMES},
        {0},
    };
    setup chosen = {0};
    int format = LIST_TEXT, subject = 0, option;
    while ((option = next_option(argc, argv, ":", options)) != -1) {
        if (option == '?')
            return EXIT_USAGE;
        if (option == POST || option == ASSETS)
            subject = option;
        else if (option == JSON || option == NAMES)
            format = option == JSON ? LIST_JSON : LIST_NAMES;
        else
            read_setup(&chosen, option, optarg);
    }
    const char *name = optind < argc ? argv[optind] : NULL;
    if (argc - optind > (subject == ASSETS ? 0 : 1))
        return fail(EXIT_USAGE, "list: unexpected argument: %s; see `ambiance list --help`", argv[argc - 1]);
    if (subject == ASSETS)
        return list_assets(&chosen, format);
    if (subject == POST)
        return name ? list_pass(name, format) : list_passes(format);
    return name ? list_scene(name, format) : list_scenes(format);
}

const command command_list = {"list", "shows scenes, their parameters and AOVs, post passes, assets", help, run};
