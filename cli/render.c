/* ambiance render: one frame of a scene to one or more files. */
#include "cli/cli.h"

#include "core/names.h"

#include <ambiance/io.h>
#include <ambiance/post.h>
#include <ambiance/scene.h>

#include <ctype.h>
#include <float.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: ambiance render SCENE [OPTION…] [-o FILE]…\n\n"
    "  -o, --output FILE  .exr or .png; may be given several times (default SCENE.png)\n"
    "                     #### in the name becomes the frame number, padded to as many digits\n"
    "  --time T           seconds (default 0); any time renders directly\n"
    "  --size WxH         pixels (default 1440x1080)\n"
    "  --set NAME=VALUE   a parameter of the scene, as `ambiance list SCENE` shows them; may be repeated\n"
    "  --aov NAME,…       further layers for EXR files, or `all`\n"
    "  --post CHAIN       post chain, as \"bloom:threshold=1;display\"; `scene`: the scene's own; `none`\n"
    "  --intermediates    every step of the post passes as further layers of EXR files (bloom.bright, mlaa.edges, …)\n"
    "  --half, --float    pixel type of EXR files (default --float)\n"
    "  --frame N          frame number of the file name and of the grain of post passes (default 0)\n" SETUP_HELP
    "  --json             describe the result for programs\n"
    "  --quiet            no progress, no summary\n\n"
    "PNG files show the picture: after the whole post chain (default: the scene's own), which always ends with the\n"
    "`display` transform: it is added where a chain lacks it. EXR files stay linear: `display` is never applied to\n"
    "them, nor is anything else unless --post asks. Layers other than color are as the scene made them.\n";

enum { MAX_OUTPUTS = 16, MAX_SETTINGS = 256 };

typedef struct request {
    setup setup;
    const char *scene;
    double time;
    int width, height;
    long frame_index;
    const char *setting[MAX_SETTINGS]; /* NAME=VALUE */
    int setting_count;
    const char *aov[AMB_MAX_LAYERS + 1]; /* NULL-ended */
    int aov_count;
    char *aov_text; /* what aov[] points into */
    const char *post;
    const char *output[MAX_OUTPUTS]; /* as given */
    char path[MAX_OUTPUTS][PATH_MAX];
    int output_count;
    amb_pixel_type pixel_type;
    bool intermediates, json, quiet;
} request;

/* ---- the command line -------------------------------------------------------------------------------------------- */

static int read_aovs(request *r, const char *text)
{
    free(r->aov_text);
    r->aov_count = 0;
    r->aov_text = strdup(text);
    if (!r->aov_text)
        return fail(EXIT_FILES, "out of memory");
    for (char *rest = r->aov_text, *name; (name = strsep(&rest, ",")) != NULL;) {
        if (r->aov_count == AMB_MAX_LAYERS)
            return fail(EXIT_USAGE, "--aov: more than %d names", AMB_MAX_LAYERS);
        r->aov[r->aov_count++] = name;
    }
    r->aov[r->aov_count] = NULL;
    return 0;
}

static int add_text(const char *option, const char **list, int *count, int limit, const char *text)
{
    if (*count == limit)
        return fail(EXIT_USAGE, "%s: given more than %d times", option, limit);
    list[(*count)++] = text;
    return 0;
}

static int read_option(request *r, int option)
{
    long long number;
    int code;
    switch (option) {
    case 'o':
        return add_text("--output", r->output, &r->output_count, MAX_OUTPUTS, optarg);
    case 't':
        return read_number("--time", optarg, -(double)FLT_MAX, (double)FLT_MAX, &r->time);
    case 's':
        return read_size("--size", optarg, &r->width, &r->height);
    case 'S':
        return add_text("--set", r->setting, &r->setting_count, MAX_SETTINGS, optarg);
    case 'a':
        return read_aovs(r, optarg);
    case 'p':
        r->post = optarg;
        return 0;
    case 'i':
        r->intermediates = true;
        return 0;
    case 'h':
        r->pixel_type = AMB_HALF;
        return 0;
    case 'f':
        r->pixel_type = AMB_FLOAT;
        return 0;
    case 'n':
        if ((code = read_integer("--frame", optarg, 0, 99999999, &number)) == 0)
            r->frame_index = (long)number;
        return code;
    case 'j':
        r->json = true;
        return 0;
    case 'q':
        r->quiet = true;
        return 0;
    case '?':
        return EXIT_USAGE;
    default:
        return read_setup(&r->setup, option, optarg);
    }
}

/* FILE with its first run of # replaced by the frame number. */
static int expand_output(const request *r, const char *name, char path[PATH_MAX])
{
    size_t before = strcspn(name, "#"), digits = strspn(name + before, "#");
    int used = digits ? snprintf(path, PATH_MAX, "%.*s%0*ld%s", (int)before, name, (int)digits, r->frame_index,
                                 name + before + digits)
                      : snprintf(path, PATH_MAX, "%s", name);
    if (used < 0 || used >= PATH_MAX)
        return fail(EXIT_USAGE, "output: name longer than %d characters", PATH_MAX - 1);
    return check_output(path);
}

static int read_outputs(request *r)
{
    int code = 0;
    bool any_exr = false;
    char name[PATH_MAX];
    if (r->output_count == 0) {
        r->output_count = 1;
        snprintf(name, sizeof name, "%s.png", r->scene);
        code = expand_output(r, name, r->path[0]);
    } else {
        for (int i = 0; code == 0 && i < r->output_count; i++)
            code = expand_output(r, r->output[i], r->path[i]);
    }
    for (int i = 0; i < r->output_count; i++)
        any_exr |= !is_png(r->path[i]);
    if (code == 0 && r->aov_count && !any_exr)
        code = fail(EXIT_USAGE, "--aov: %s; AOVs are written to .exr files, and no output is one", r->aov[0]);
    return code;
}

static int read_request(int argc, char **argv, request *r)
{
    static const struct option options[] = {
        {"output", required_argument, NULL, 'o'},
        {"time", required_argument, NULL, 't'},
        {"size", required_argument, NULL, 's'},
        {"set", required_argument, NULL, 'S'},
        {"aov", required_argument, NULL, 'a'},
        {"post", required_argument, NULL, 'p'},
        {"intermediates", no_argument, NULL, 'i'},
        {"half", no_argument, NULL, 'h'},
        {"float", no_argument, NULL, 'f'},
        {"frame", required_argument, NULL, 'n'},
        {"json", no_argument, NULL, 'j'},
        {"quiet", no_argument, NULL, 'q'},
        SETUP_OPTIONS,
        {0},
    };
    int option, code = 0;
    *r = (request){.width = 1440, .height = 1080, .pixel_type = AMB_FLOAT};
    while (code == 0 && (option = next_option(argc, argv, ":o:", options)) != -1)
        code = read_option(r, option);
    if (code)
        return code;
    if (optind >= argc)
        return fail(EXIT_USAGE, "render: no scene; see `ambiance list`");
    if (optind + 1 < argc)
        return fail(EXIT_USAGE, "render: unexpected argument: %s; one scene is expected", argv[optind + 1]);
    r->scene = argv[optind];
    return 0;
}

/* ---- settings ---------------------------------------------------------------------------------------------------- */

typedef int (*setting_function)(void *user, const char *name, const char *value);

/* Splits every --set and hands it on. */
static int each_setting(const request *r, setting_function set, void *user)
{
    int code = 0;
    for (int i = 0; code == 0 && i < r->setting_count; i++) {
        char name[128];
        size_t length = strcspn(r->setting[i], "=");
        if (r->setting[i][length] != '=' || length == 0 || length >= sizeof name)
            return fail(EXIT_USAGE, "--set: %s; NAME=VALUE is expected", r->setting[i]);
        snprintf(name, sizeof name, "%.*s", (int)length, r->setting[i]);
        code = set(user, name, r->setting[i] + length + 1);
    }
    return code;
}

typedef struct trial {
    const amb_scene *scene;
    void *values;
} trial;

static int try_setting(void *user, const char *name, const char *value)
{
    trial *t = user;
    amb_error error;
    char owner[80];
    snprintf(owner, sizeof owner, "scene %s", t->scene->name);
    amb_status status = amb_params_set(&t->scene->params, t->values, owner, name, value, &error);
    return status == AMB_OK ? 0 : fail_library(&error);
}

static int apply_setting(void *user, const char *name, const char *value)
{
    amb_error error;
    return amb_show_set(user, name, value, &error) == AMB_OK ? 0 : fail_library(&error);
}

static const char *scene_name(const void *user, int index)
{
    (void)user;
    return amb_scene_by_index(AMB_ISA_AUTO, index)->name;
}

/* Finds mistakes in scene, settings and AOVs before anything slow is done. */
static int check_scene(const request *r, const amb_scene **scene)
{
    char hint[320];
    amb_error error;
    *scene = amb_scene_by_name(AMB_ISA_AUTO, r->scene);
    if (!*scene)
        return fail(EXIT_USAGE, "unknown scene: %s; %s", r->scene,
                    amb_names_hint(r->scene, amb_scene_count(), scene_name, NULL, hint, sizeof hint));
    if (amb_scene_choose_aovs(*scene, r->aov_count ? r->aov : NULL, NULL, &error) != AMB_OK)
        return fail_library(&error);
    trial t = {*scene, malloc((*scene)->params.size ? (*scene)->params.size : 1)};
    if (!t.values)
        return fail(EXIT_FILES, "out of memory");
    amb_params_defaults(&(*scene)->params, t.values);
    int code = each_setting(r, try_setting, &t);
    free(t.values);
    return code;
}

/* ---- post chains ------------------------------------------------------------------------------------------------- */

static bool is_display(const char *pass, size_t length)
{
    while (length && isspace((unsigned char)*pass))
        pass++, length--;
    size_t name = 0;
    while (name < length && (isalnum((unsigned char)pass[name]) || pass[name] == '_' || pass[name] == '-'))
        name++;
    return name == strlen("display") && memcmp(pass, "display", name) == 0;
}

/* The chain for one kind of file, to be freed: linear without any display pass, or with one for sure. */
static char *chain_text(const char *chain, bool is_linear)
{
    size_t length = strlen(chain), used = 0;
    bool has_display = false;
    char *text = malloc(length + sizeof ";display");
    if (!text || strcmp(chain, "none") == 0)
        chain = "";
    for (const char *pass = chain; text && *pass;) {
        size_t size = strcspn(pass, ";");
        bool is_this = is_display(pass, size);
        has_display |= is_this;
        if (size && !(is_this && is_linear))
            used += (size_t)sprintf(text + used, "%s%.*s", used ? ";" : "", (int)size, pass);
        pass += size + (pass[size] == ';');
    }
    if (text && !has_display && !is_linear)
        used += (size_t)sprintf(text + used, "%sdisplay", used ? ";" : "");
    if (text)
        text[used] = '\0';
    return text;
}

typedef struct chains { /* [0] for EXR files, [1] for PNG files */
    char *text[2];
    amb_chain *chain[2];
} chains;

static int open_chains(const request *r, const amb_scene *scene, const amb_context *context, chains *c)
{
    const char *own = scene->post ? scene->post : "";
    amb_error error;
    for (int kind = 0; kind < 2; kind++) {
        const char *text = r->post && strcmp(r->post, "scene") != 0 ? r->post : r->post || kind == 1 ? own : "";
        c->text[kind] = chain_text(text, kind == 0);
        if (!c->text[kind])
            return fail(EXIT_FILES, "out of memory");
        if (amb_chain_create(context, c->text[kind], &c->chain[kind], &error) != AMB_OK)
            return fail_library(&error);
    }
    return 0;
}

static void close_chains(chains *c)
{
    for (int kind = 0; kind < 2; kind++) {
        amb_chain_close(&c->chain[kind]);
        free(c->text[kind]);
    }
}

/* ---- rendering and writing --------------------------------------------------------------------------------------- */

typedef struct seconds {
    double load, render, post, write, all;
} seconds;

static int apply_chain(const request *r, const chains *c, int kind, amb_frame *frame)
{
    amb_error error;
    if (amb_chain_apply(c->chain[kind], frame, r->frame_index, r->intermediates && kind == 0, &error) != AMB_OK)
        return fail_library(&error);
    free(frame->meta.post);
    frame->meta.post = strdup(c->text[kind]);
    return frame->meta.post ? 0 : fail(EXIT_FILES, "out of memory");
}

static int write_output(const request *r, const char *path, const amb_frame *frame)
{
    amb_error error;
    amb_status status;
    hold_signals();
    if (is_png(path)) {
        amb_image opaque = *frame->layer[0].image; /* planar: the picture without its alpha */
        opaque.channels = 3;
        status = amb_write_png(&opaque, path, &error);
    } else {
        status = amb_write_exr(frame, path, r->pixel_type, &error);
    }
    release_signals();
    return status == AMB_OK ? 0 : fail_file(&error);
}

/* Chain, then every file of one kind. */
static int write_kind(const request *r, const chains *c, int kind, amb_frame *frame, progress *p, seconds *s)
{
    s->write += progress_stage(p, "%s: post chain", r->scene);
    int code = apply_chain(r, c, kind, frame);
    s->post += progress_stage(p, "%s: writing", r->scene);
    for (int i = 0; code == 0 && i < r->output_count; i++)
        if (is_png(r->path[i]) == (kind == 1))
            code = write_output(r, r->path[i], frame);
    return code;
}

static int write_outputs(const request *r, const chains *c, amb_frame *frame, progress *p, seconds *s)
{
    int pngs = 0, code = 0;
    for (int i = 0; i < r->output_count; i++)
        pngs += is_png(r->path[i]);
    amb_image *rendered = NULL; /* kept only when two chains start from it */
    amb_error error;
    bool both = pngs && pngs < r->output_count;
    if (both && amb_image_copy(frame->layer[0].image, &rendered, &error) != AMB_OK)
        return fail_file(&error);
    if (pngs < r->output_count)
        code = write_kind(r, c, 0, frame, p, s);
    if (both) {
        amb_image_close(&frame->layer[0].image);
        frame->layer[0].image = rendered;
    }
    if (code == 0 && pngs)
        code = write_kind(r, c, 1, frame, p, s);
    s->write += progress_stage(p, "%s: written", r->scene);
    return code;
}

static int report(const request *r, const amb_context *context, const amb_frame *frame, const char sha256[65],
                  const seconds *s)
{
    if (!r->json) {
        for (int i = 0; i < r->output_count && !r->quiet; i++)
            printf("%s: %s at %.15g s, %dx%d, %d layer%s; %.2f s\n", r->path[i], r->scene, r->time, r->width, r->height,
                   is_png(r->path[i]) ? 1 : frame->layer_count,
                   !is_png(r->path[i]) && frame->layer_count > 1 ? "s" : "", s->all);
        return 0;
    }
    json_t *files = json_array(), *layers = json_array();
    for (int i = 0; i < r->output_count; i++)
        json_array_append_new(files, json_text(r->path[i]));
    for (int i = 0; i < frame->layer_count; i++)
        json_array_append_new(layers, json_string(frame->layer[i].name));
    return print_json(json_pack(
        "{s:s, s:f, s:i, s:i, s:o, s:o, s:s, s:s, s:s, s:s, s:i, s:s, s:{s:f, s:f, s:f, s:f, s:f}}", "scene", r->scene,
        "time", r->time, "width", r->width, "height", r->height, "files", files, "layers", layers, "parameters",
        frame->meta.parameters, "assets_sha256", frame->meta.assets_sha256, "color_sha256", sha256, "isa",
        amb_isa_name(amb_context_isa(context)), "threads", amb_context_threads(context), "version", amb_version(),
        "seconds", "load", s->load, "render", s->render, "post", s->post, "write", s->write, "all", s->all));
}

static int render(const request *r, const amb_scene *scene)
{
    amb_context *context = NULL;
    amb_assets *assets = NULL;
    amb_show *show = NULL;
    amb_frame *frame = NULL;
    amb_error error;
    char sha256[65];
    chains c = {0};
    seconds s = {0};
    int code = open_setup(&r->setup, &context, &assets);
    if (code || (code = open_chains(r, scene, context, &c)))
        goto done;

    progress p = progress_start(!r->quiet);
    progress_stage(&p, "%s: loading", r->scene);
    if (amb_show_open(context, assets, r->scene, &show, &error) != AMB_OK) {
        code = fail_file(&error);
        goto done;
    }
    s.load = progress_stage(&p, "%s: rendering %dx%d", r->scene, r->width, r->height);
    code = each_setting(r, apply_setting, show);
    if (code == 0 &&
        amb_show_render(show, r->time, r->width, r->height, r->aov_count ? r->aov : NULL, &frame, &error) != AMB_OK) {
        progress_end(&p);
        code = fail_library(&error);
    }
    if (code)
        goto done;
    s.render = progress_stage(&p, "%s: hashing", r->scene);
    amb_image_sha256(frame->layer[0].image, sha256);
    progress_stage(&p, "%s: writing", r->scene);
    code = write_outputs(r, &c, frame, &p, &s);
    s.all = progress_end(&p);
    if (code == 0)
        code = report(r, context, frame, sha256, &s);

done:
    amb_frame_close(&frame);
    amb_show_close(&show);
    close_chains(&c);
    amb_assets_close(&assets);
    amb_context_close(&context);
    return code;
}

static int run(int argc, char **argv)
{
    request *r = malloc(sizeof *r);
    const amb_scene *scene;
    if (!r)
        return fail(EXIT_FILES, "out of memory");
    int code = read_request(argc, argv, r);
    if (code == 0 && (code = check_scene(r, &scene)) == 0 && (code = read_outputs(r)) == 0)
        code = render(r, scene);
    free(r->aov_text);
    free(r);
    return code;
}

const command command_render = {"render", "renders a frame of a scene to EXR or PNG", help, run};
