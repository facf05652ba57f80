/* The golden manifest: SHA-256 of the float pixels of every scene, with built-in assets and default parameters.
 *
 *   golden check MANIFEST [SCENE]   renders every row at every instruction set of this processor and 1, 2, 5 threads
 *   golden update MANIFEST [SCENE]  writes the manifest anew, or one scene's rows, if all of those agree
 *
 * Each line of the manifest: SCENE TIME WIDTHxHEIGHT LAYER SHA256, the hash being that of amb_image_sha256. The layer
 * "post" is color after the scene's own chain. */
#include <ambiance/io.h>
#include <ambiance/post.h>
#include <ambiance/scene.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__clang__)
#define COMPILER "clang"
#else
#define COMPILER "gcc"
#endif

typedef struct golden_case { /* what is rendered of every scene */
    const char *time;
    int width, height;
    bool all_layers;
} golden_case;

static const golden_case cases[] = {
    {"0", 96, 72, true}, {"3", 120, 90, false}, {"7.5", 61, 43, false}, {"1234.5", 43, 61, false}};
enum { CASE_COUNT = sizeof cases / sizeof *cases };

typedef struct row {
    char key[128]; /* "SCENE TIME WIDTHxHEIGHT LAYER" */
    char sha256[65];
    char made_by[64]; /* the first configuration that rendered it */
    bool was_seen;
} row;

typedef struct manifest {
    row *row;
    int count, room;
    bool is_update;
    int wrong, compared;
} manifest;

static row *find_row(const manifest *m, const char *key)
{
    for (int i = 0; i < m->count; i++)
        if (strcmp(m->row[i].key, key) == 0)
            return &m->row[i];
    return NULL;
}

static row *add_row(manifest *m, const char *key, const char *sha256, const char *made_by)
{
    if (m->count == m->room) {
        int room = m->room ? 2 * m->room : 64;
        row *grown = realloc(m->row, (size_t)room * sizeof *grown);
        if (!grown)
            return NULL;
        m->row = grown;
        m->room = room;
    }
    row *added = &m->row[m->count++];
    *added = (row){0};
    snprintf(added->key, sizeof added->key, "%s", key);
    snprintf(added->sha256, sizeof added->sha256, "%s", sha256);
    snprintf(added->made_by, sizeof added->made_by, "%s", made_by);
    return added;
}

static int read_manifest(manifest *m, const char *path)
{
    char line[512], scene[64], time[32], size[32], layer[40], sha256[72], key[192];
    FILE *file = fopen(path, "r");
    if (!file) {
        perror(path);
        return 3;
    }
    int code = 0;
    for (int number = 1; code == 0 && fgets(line, sizeof line, file); number++) {
        if (line[0] == '#' || line[0] == '\n')
            continue;
        if (sscanf(line, "%63s %31s %31s %39s %71s", scene, time, size, layer, sha256) != 5 || strlen(sha256) != 64) {
            fprintf(stderr, "%s:%d: not SCENE TIME WIDTHxHEIGHT LAYER SHA256\n", path, number);
            code = 3;
            break;
        }
        snprintf(key, sizeof key, "%s %s %s %s", scene, time, size, layer);
        if (!add_row(m, key, sha256, "the manifest"))
            code = 3;
    }
    fclose(file);
    return code;
}

static int write_manifest(const manifest *m, const char *path)
{
    amb_output *output = NULL;
    amb_error error;
    char line[320];
    const char *head = "# SHA-256 of the float pixels of every scene (docs/determinism.md). Rewritten by `make "
                       "golden-update`; a change\n# here is a change of pictures, and its commit says why.\n"
                       "# SCENE TIME WIDTHxHEIGHT LAYER SHA256\n";
    if (amb_output_begin(path, &output, &error) != AMB_OK)
        goto error;
    if (amb_output_write(output, head, strlen(head), &error) != AMB_OK)
        goto error;
    for (int i = 0; i < m->count; i++) {
        int length = snprintf(line, sizeof line, "%s %s\n", m->row[i].key, m->row[i].sha256);
        if (amb_output_write(output, line, (size_t)length, &error) != AMB_OK)
            goto error;
    }
    if (amb_output_commit(&output, &error) == AMB_OK)
        return 0;
error:
    amb_output_abort(&output);
    fprintf(stderr, "%s\n", error.detail);
    return 3;
}

/* Holds one layer to the manifest, or to the configuration that made the row first. */
static void check_layer(manifest *m, const char *scene, const golden_case *c, const char *layer, const amb_image *image,
                        const char *configuration)
{
    char key[128], sha256[65];
    snprintf(key, sizeof key, "%s %s %dx%d %s", scene, c->time, c->width, c->height, layer);
    amb_image_sha256(image, sha256);
    row *known = find_row(m, key);
    m->compared++;
    if (!known && !m->is_update) {
        fprintf(stderr, "%s: not in the manifest (%s)\n", key, configuration);
        m->wrong++;
    }
    if (!known)
        known = add_row(m, key, sha256, configuration);
    if (!known) {
        fprintf(stderr, "out of memory\n");
        m->wrong++;
        return;
    }
    if (m->is_update && !known->was_seen) { /* read from the manifest, to be replaced */
        snprintf(known->sha256, sizeof known->sha256, "%s", sha256);
        snprintf(known->made_by, sizeof known->made_by, "%s", configuration);
    }
    known->was_seen = true;
    if (strcmp(known->sha256, sha256) != 0) {
        fprintf(stderr, "%s: %s gives %.16s..., %s has %.16s...\n", key, configuration, sha256, known->made_by,
                known->sha256);
        m->wrong++;
    }
}

/* A frame of the scene with every layer wanted, by the scene's own functions: several contexts share one state. */
static amb_status render(const amb_scene *scene, const void *state, const void *params, const amb_context *context,
                         const golden_case *c, amb_frame **frame, amb_error *error)
{
    amb_image *image;
    amb_status status = amb_frame_create(c->width, c->height, frame, error);
    for (size_t i = 0; status == AMB_OK && c->all_layers && i < scene->aov_count; i++)
        status = amb_frame_add_layer(*frame, scene->aovs[i].name, scene->aovs[i].channels, &image, error);
    if (status != AMB_OK)
        return status;
    amb_scene_job job = {.context = context,
                         .params = params,
                         .time = strtod(c->time, NULL),
                         .width = c->width,
                         .height = c->height,
                         .frame = *frame};
    return scene->frame(state, &job, error);
}

static amb_status check_case(manifest *m, const amb_scene *scene, const void *state, const void *params,
                             const amb_context *context, const golden_case *c, amb_error *error)
{
    char configuration[64];
    amb_frame *frame = NULL;
    amb_chain *chain = NULL;
    snprintf(configuration, sizeof configuration, COMPILER " %s, %d thread%s", amb_isa_name(amb_context_isa(context)),
             amb_context_threads(context), amb_context_threads(context) == 1 ? "" : "s");
    amb_status status = render(scene, state, params, context, c, &frame, error);
    for (int i = 0; status == AMB_OK && i < frame->layer_count; i++)
        check_layer(m, scene->name, c, frame->layer[i].name, frame->layer[i].image, configuration);
    if (status == AMB_OK)
        status = amb_chain_create(context, scene->post ? scene->post : "display", &chain, error);
    if (status == AMB_OK)
        status = amb_chain_apply(chain, frame, 0, 0, error);
    if (status == AMB_OK)
        check_layer(m, scene->name, c, "post", frame->layer[0].image, configuration);
    amb_chain_close(&chain);
    amb_frame_close(&frame);
    return status;
}

enum { THREAD_COUNTS = 3 };
static const int threads[THREAD_COUNTS] = {1, 2, 5};

/* One scene at one instruction set: loaded once, by contexts[loader], rendered by all of them. */
static amb_status check_scene(manifest *m, const amb_scene *scene, amb_context *const contexts[THREAD_COUNTS],
                              int loader, amb_assets *assets, amb_error *error)
{
    void *state = NULL, *params = calloc(1, scene->params.size ? scene->params.size : 1);
    if (!params)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory");
    amb_params_defaults(&scene->params, params);
    amb_status status = scene->load ? scene->load(contexts[loader], assets, &state, error) : AMB_OK;
    for (int i = 0; status == AMB_OK && i < THREAD_COUNTS; i++)
        for (int k = 0; status == AMB_OK && k < CASE_COUNT; k++)
            status = check_case(m, scene, state, params, contexts[i], &cases[k], error);
    if (scene->unload && state)
        scene->unload(state);
    free(params);
    return status;
}

/* Each instruction set loads (and so generates its assets) with another number of threads. */
static amb_status check_isa(manifest *m, amb_isa isa, int loader, const char *only, amb_error *error)
{
    amb_context *contexts[THREAD_COUNTS] = {NULL};
    amb_assets *assets = NULL;
    amb_status status = AMB_OK;
    for (int i = 0; status == AMB_OK && i < THREAD_COUNTS; i++)
        status = amb_context_create(&(amb_context_options){.isa = isa, .threads = threads[i]}, &contexts[i], error);
    if (status == AMB_OK)
        status = amb_assets_create(contexts[loader], &(amb_assets_options){.builtin_only = true}, &assets, error);
    for (int i = 0; status == AMB_OK && i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(isa, i);
        if (!only || strcmp(only, scene->name) == 0)
            status = check_scene(m, scene, contexts, loader, assets, error);
    }
    amb_assets_close(&assets);
    for (int i = 0; i < THREAD_COUNTS; i++)
        amb_context_close(&contexts[i]);
    return status;
}

static int check_all(manifest *m, const char *only)
{
    static const amb_isa isas[] = {AMB_ISA_V2, AMB_ISA_V3, AMB_ISA_V4};
    amb_error error;
    for (size_t i = 0; i < sizeof isas / sizeof *isas; i++) {
        if (!amb_isa_available(isas[i])) {
            printf("golden: %s skipped: this processor lacks it\n", amb_isa_name(isas[i]));
            continue;
        }
        if (check_isa(m, isas[i], (int)i, only, &error) != AMB_OK) {
            fprintf(stderr, "golden: %s: %s\n", amb_isa_name(isas[i]), error.detail);
            return 3;
        }
    }
    for (int i = 0; i < m->count && !only; i++)
        if (!m->row[i].was_seen) {
            fprintf(stderr, "%s: in the manifest, but nothing renders it\n", m->row[i].key);
            m->wrong++;
        }
    return m->wrong ? 1 : 0;
}

int main(int argc, char **argv)
{
    manifest m = {0};
    m.is_update = argc >= 3 && strcmp(argv[1], "update") == 0;
    if (argc < 3 || argc > 4 || (!m.is_update && strcmp(argv[1], "check") != 0)) {
        fprintf(stderr, "usage: golden check|update MANIFEST [SCENE]\n");
        return 2;
    }
    const char *only = argc == 4 ? argv[3] : NULL; /* an update of one scene keeps the others' rows */
    int code = m.is_update && !only ? 0 : read_manifest(&m, argv[2]);
    if (code == 0)
        code = check_all(&m, only);
    if (code == 0 && m.is_update)
        code = write_manifest(&m, argv[2]);
    printf("golden: " COMPILER ": %d layers rendered, %d wrong; %d rows\n", m.compared, m.wrong, m.count);
    free(m.row);
    return code;
}
