/* ambiance info: what a file holds. */
#include "cli/cli.h"

#include <ambiance/io.h>

#include <math.h>
#include <string.h>

static const char help[] =
    "usage: ambiance info [--json] FILE…\n\n"
    "Shows what files hold: of pictures (EXR, PNG, JPEG, HDR) size, layers, and each channel's least, greatest and "
    "mean\n"
    "value; of pictures that ambiance wrote also what made them; of KTX textures size, levels and format; of models\n"
    "(OBJ, PLY, glTF) counts and bounds.\n\n"
    "  --json             for programs: an array with an object for each file\n";

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

typedef struct range {
    float least, greatest; /* of the finite values */
    double mean;
    uint64_t finite, infinite, nan;
} range;

static range find_range(const amb_image *image, int channel)
{
    range r = {.least = INFINITY, .greatest = -INFINITY};
    double sum = 0.0;
    for (int y = 0; y < image->height; y++) {
        const float *row = amb_image_row(image, channel, y);
        for (int x = 0; x < image->width; x++) {
            if (!isfinite(row[x])) {
                r.nan += isnan(row[x]) != 0;
                r.infinite += isnan(row[x]) == 0;
                continue;
            }
            r.finite++;
            r.least = row[x] < r.least ? row[x] : r.least;
            r.greatest = row[x] > r.greatest ? row[x] : r.greatest;
            sum += (double)row[x];
        }
    }
    r.mean = r.finite ? sum / (double)r.finite : (double)NAN;
    return r;
}

static void print_layer(const amb_layer *layer)
{
    for (int channel = 0; channel < layer->image->channels; channel++) {
        range r = find_range(layer->image, channel);
        printf("  %-18s %s  ", channel ? "" : layer->name, channel_name(layer->image->channels, channel));
        if (r.finite)
            printf("least %-13.7g greatest %-13.7g mean %.7g", (double)r.least, (double)r.greatest, r.mean);
        else
            printf("no finite value");
        if (r.nan || r.infinite)
            printf("  (%llu NaN, %llu infinite)", (unsigned long long)r.nan, (unsigned long long)r.infinite);
        putchar('\n');
    }
}

static void print_metadata(const amb_metadata *meta)
{
    if (!meta->scene[0])
        return;
    printf("  scene       %s at %.17g s\n  parameters  %s\n  post        %s\n  assets      %s\n  version     %s\n",
           meta->scene, meta->time, meta->parameters ? meta->parameters : "",
           meta->post && meta->post[0] ? meta->post : "none", meta->assets_sha256[0] ? meta->assets_sha256 : "none",
           meta->version);
}

static json_t *json_layer(const amb_layer *layer)
{
    char sha256[65];
    json_t *channels = json_array();
    for (int channel = 0; channel < layer->image->channels; channel++) {
        range r = find_range(layer->image, channel);
        json_array_append_new(
            channels, json_pack("{s:s, s:o, s:o, s:o, s:I, s:I}", "name", channel_name(layer->image->channels, channel),
                                "least", json_float(r.least), "greatest", json_float(r.greatest), "mean",
                                json_number(r.mean), "nan", (json_int_t)r.nan, "infinite", (json_int_t)r.infinite));
    }
    amb_image_sha256(layer->image, sha256);
    return json_pack("{s:o, s:s, s:o}", "name", json_text(layer->name), "sha256", sha256, "channels", channels);
}

static json_t *json_picture(const amb_frame *frame)
{
    const amb_metadata *meta = &frame->meta;
    json_t *layers = json_array();
    for (int i = 0; i < frame->layer_count; i++)
        json_array_append_new(layers, json_layer(&frame->layer[i]));
    json_t *object = json_pack("{s:i, s:i, s:o}", "width", frame->width, "height", frame->height, "layers", layers);
    if (meta->scene[0])
        json_object_set_new(object, "made_by",
                            json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "scene", json_text(meta->scene), "time",
                                      json_number(meta->time), "parameters",
                                      json_text(meta->parameters ? meta->parameters : ""), "post",
                                      json_text(meta->post ? meta->post : ""), "assets_sha256",
                                      json_text(meta->assets_sha256), "version", json_text(meta->version)));
    return object;
}

static int show_picture(const char *path, const char *kind, json_t **json)
{
    amb_frame *frame;
    int code = read_frame(path, &frame);
    if (code)
        return code;
    if (json) {
        *json = json_picture(frame);
    } else {
        printf("%s: %s, %dx%d\n", path, kind, frame->width, frame->height);
        for (int i = 0; i < frame->layer_count; i++)
            print_layer(&frame->layer[i]);
        print_metadata(&frame->meta);
    }
    amb_frame_close(&frame);
    return 0;
}

/* ---- textures and models ----------------------------------------------------------------------------------------- */

static int show_texture(const char *path, const char *kind, json_t **json)
{
    static const char *const kinds[] = {"2D", "cube map", "3D"};
    static const char *const texels[] = {"R8",   "RG8",     "RGBA8",      "sRGB8 A8", "R16F", "RGBA16F",
                                         "R32F", "RGBA32F", "R11G11B10F", "RG16F",    "RG32F"};
    amb_error error;
    amb_texture *texture;
    if (amb_read_texture(path, false, &texture, &error) != AMB_OK)
        return fail_file(&error);
    amb_texture_info info = amb_texture_describe(texture);
    amb_texture_close(&texture);
    if (json)
        *json = json_pack("{s:s, s:s, s:i, s:i, s:i}", "shape", kinds[info.kind], "texels", texels[info.texel], "width",
                          info.width, "height", info.height, "levels", info.levels);
    else
        printf("%s: %s, %s, %dx%d, %d level%s of %s\n", path, kind, kinds[info.kind], info.width, info.height,
               info.levels, info.levels == 1 ? "" : "s", texels[info.texel]);
    return 0;
}

static int show_mesh(const char *path, const char *kind, json_t **json)
{
    amb_error error;
    amb_mesh *mesh;
    v3 lo, hi;
    if (amb_read_mesh(path, &mesh, &error) != AMB_OK)
        return fail_file(&error);
    amb_mesh_bounds(mesh, &lo, &hi);
    if (json)
        *json =
            json_pack("{s:I, s:I, s:b, s:b, s:b, s:[ooo], s:[ooo]}", "vertices", (json_int_t)mesh->vertex_count,
                      "triangles", (json_int_t)mesh->triangle_count, "normals", mesh->normal != NULL, "uvs",
                      mesh->uv != NULL, "tangents", mesh->tangent != NULL, "low", json_float(lo.x), json_float(lo.y),
                      json_float(lo.z), "high", json_float(hi.x), json_float(hi.y), json_float(hi.z));
    else
        printf("%s: %s, %u vertices, %u triangles%s%s%s\n  from %g, %g, %g to %g, %g, %g\n", path, kind,
               mesh->vertex_count, mesh->triangle_count, mesh->normal ? ", normals" : "", mesh->uv ? ", UVs" : "",
               mesh->tangent ? ", tangents" : "", (double)lo.x, (double)lo.y, (double)lo.z, (double)hi.x, (double)hi.y,
               (double)hi.z);
    amb_mesh_close(&mesh);
    return 0;
}

static int show_file(const char *path, json_t *list)
{
    file_kind kind;
    json_t *json = NULL, **wanted = list ? &json : NULL;
    int code = find_file_kind(path, &kind);
    if (code)
        return code;
    const char *name = file_kind_name(kind);
    code = kind == FILE_KTX    ? show_texture(path, name, wanted)
           : kind == FILE_MESH ? show_mesh(path, name, wanted)
                               : show_picture(path, name, wanted);
    if (code || !list)
        return code;
    json_object_set_new(json, "file", json_text(path));
    json_object_set_new(json, "kind", json_string(name));
    return json_array_append_new(list, json) == 0 ? 0 : fail(EXIT_FILES, "JSON: out of memory");
}

static int run(int argc, char **argv)
{
    static const struct option options[] = {{"json", no_argument, NULL, 'j'}, {0}};
    int option, code = 0;
    bool json = false;
    while ((option = next_option(argc, argv, ":", options)) != -1) {
        if (option == '?')
            return EXIT_USAGE;
        json = true;
    }
    if (optind >= argc)
        return fail(EXIT_USAGE, "info: no file; see `ambiance info --help`");
    json_t *list = json ? json_array() : NULL;
    for (int i = optind; code == 0 && i < argc; i++)
        code = show_file(argv[i], list);
    if (code == 0 && list)
        return print_json(list);
    json_decref(list);
    return code;
}

const command command_info = {"info", "shows what a picture, texture or model file holds", help, run};
