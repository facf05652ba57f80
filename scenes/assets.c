/* The asset resolver: finds each asset's source when it is created, loads on request, remembers what was used. */
#include "core/names.h"
#include "io/file.h"
#include "scenes/asset_cache.h"
#include "scenes/asset_table.h"
#include "scenes/builtin/builtin.h"

#include <errno.h>
#include <sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#ifndef AMB_PACK_DIR
#define AMB_PACK_DIR "/usr/local/share/ambiance/pack" /* where `make install` puts the pack */
#endif

typedef struct asset {
    const asset_row *row;
    amb_asset_source source;
    char path[1024];  /* "" for built in */
    char sha256[65];  /* "" until made or read */
    bool is_used;     /* handed out */
    struct asset *of; /* what it is made from; NULL: a file or a generator */
    amb_texture *texture;
    amb_mesh *mesh;
} asset;

struct amb_assets {
    const amb_context *context;
    int count;
    asset *asset; /* one a row of the table */
    asset_cache cache;
};

/* ---- where ----------------------------------------------------------------------------------------------------- */

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

static amb_status join(char path[1024], const char *folder, const char *file, amb_error *error)
{
    int length = snprintf(path, 1024, "%s/%s", folder, file);
    return length < 1024 ? AMB_OK : amb_fail(error, AMB_ERROR_LIMIT, "assets folder '%.200s…': name too long", folder);
}

/* $XDG_DATA_HOME/NAME or ~/.local/share/NAME; "" when neither variable is set. */
static amb_status data_folder(char path[1024], const char *name, amb_error *error)
{
    char file[64];
    path[0] = '\0';
    if (variable("XDG_DATA_HOME"))
        return join(path, variable("XDG_DATA_HOME"), name, error);
    snprintf(file, sizeof file, ".local/share/%s", name);
    return variable("HOME") ? join(path, variable("HOME"), file, error) : AMB_OK;
}

static bool is_folder(const char *path)
{
    struct stat file;
    return stat(path, &file) == 0 && S_ISDIR(file.st_mode);
}

/* The user's folder. One that was asked for by name must be there. */
static amb_status find_user_folder(const char *asked, char path[1024], amb_error *error)
{
    asked = asked ? asked : variable("AMBIANCE_ASSETS");
    if (!asked)
        return data_folder(path, "ambiance", error);
    struct stat file;
    if (stat(asked, &file) != 0)
        return amb_fail(error, AMB_ERROR_IO, "assets folder '%s': %s", asked, strerror(errno));
    if (!S_ISDIR(file.st_mode))
        return amb_fail(error, AMB_ERROR_IO, "assets folder '%s': it is not a folder", asked);
    return join(path, asked, "", error);
}

/* The pack may be missing anywhere: it is a download. */
static amb_status find_pack_folder(const char *asked, char path[1024], amb_error *error)
{
    asked = asked ? asked : variable("AMBIANCE_PACK");
    if (asked)
        return join(path, asked, "", error);
    amb_status status = data_folder(path, "ambiance-pack", error);
    if (status == AMB_OK && !is_folder(path))
        status = join(path, AMB_PACK_DIR, "", error);
    return status;
}

/* Sets path when folder has the file. A file that is there but cannot be read is found too: loading says why. */
static amb_status look_for(const char *folder, const char *file, char path[1024], bool *is_found, amb_error *error)
{
    struct stat info;
    *is_found = false;
    if (!*folder || !file)
        return AMB_OK;
    size_t length = strlen(folder);
    char trimmed[1024];
    snprintf(trimmed, sizeof trimmed, "%.*s", (int)(length - (length > 1 && folder[length - 1] == '/')), folder);
    amb_status status = join(path, trimmed, file, error);
    *is_found = status == AMB_OK && (stat(path, &info) == 0 || (errno != ENOENT && errno != ENOTDIR));
    if (!*is_found)
        path[0] = '\0';
    return status;
}

/* An asset made from another one comes from where that one does. */
static void resolve_of(asset *item, asset *of)
{
    item->of = of;
    item->source = of->source;
    memcpy(item->path, of->path, sizeof item->path);
}

/* The item of a name in the rows before `end`; NULL: none. */
static asset *named(asset *items, const asset *end, const char *name)
{
    for (asset *item = items; item < end; item++)
        if (strcmp(item->row->name, name) == 0)
            return item;
    return NULL;
}

static amb_status resolve(asset *items, asset *item, const char *user, const char *pack, amb_error *error)
{
    const size_t names = sizeof item->row->user_file / sizeof *item->row->user_file;
    bool is_found = false;
    amb_status status = AMB_OK;
    if (item->row->kind == ASSET_IRRADIANCE) {
        resolve_of(item, item - 1);
        return AMB_OK;
    }
    item->source = AMB_ASSET_USER;
    for (size_t i = 0; i < names && !is_found && status == AMB_OK; i++)
        status = look_for(user, item->row->user_file[i], item->path, &is_found, error);
    if (!is_found && status == AMB_OK) {
        item->source = AMB_ASSET_PACK;
        status = look_for(pack, item->row->pack_file, item->path, &is_found, error);
    }
    if (is_found || status != AMB_OK)
        return status;
    item->source = AMB_ASSET_BUILTIN;
    asset *of = item->row->of ? named(items, item, item->row->of) : NULL;
    if (of && (!item->row->make_texture || of->source != AMB_ASSET_BUILTIN))
        resolve_of(item, of);
    return AMB_OK;
}

amb_status amb_assets_create(const amb_context *context, const amb_assets_options *options, amb_assets **out,
                             amb_error *error)
{
    static const amb_assets_options defaults = {0};
    char user[1024] = "", pack[1024] = "";
    amb_status status = AMB_OK;
    *out = NULL;
    options = options ? options : &defaults;
    amb_assets *assets = calloc(1, sizeof *assets);
    asset *items = calloc((size_t)asset_table_count, sizeof *items);
    if (!assets || !items) {
        free(items);
        free(assets);
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for the asset table");
    }
    *assets = (amb_assets){.context = context, .count = asset_table_count, .asset = items};
    asset_cache_open(&assets->cache, options->keep_made);
    if (!options->builtin_only)
        status = find_user_folder(options->user_dir, user, error);
    if (status == AMB_OK && !options->builtin_only)
        status = find_pack_folder(options->pack_dir, pack, error);
    for (int i = 0; i < asset_table_count && status == AMB_OK; i++) {
        items[i].row = &asset_table[i];
        status = resolve(items, &items[i], user, pack, error);
    }
    if (status != AMB_OK)
        amb_assets_close(&assets);
    *out = assets;
    return status;
}

void amb_assets_close(amb_assets **assets)
{
    if (!assets || !*assets)
        return;
    for (int i = 0; i < (*assets)->count; i++) {
        amb_texture_close(&(*assets)->asset[i].texture);
        amb_mesh_close(&(*assets)->asset[i].mesh);
    }
    free((*assets)->asset);
    free(*assets);
    *assets = NULL;
}

/* ---- loading --------------------------------------------------------------------------------------------------- */

/* A cube map stays; a 2:1 panorama becomes one whose faces are as fine as its horizon. */
static amb_status to_cube(const amb_context *context, const char *path, amb_texture **texture, amb_error *error)
{
    amb_texture_info info = amb_texture_describe(*texture);
    amb_texture *cube;
    if (info.kind == AMB_TEXTURE_CUBE)
        return AMB_OK;
    if (info.width != 2 * info.height)
        return amb_fail(error, AMB_ERROR_FORMAT,
                        "%s: panorama of %dx%d pixels; allowed are a width of twice the height, or a cube map", path,
                        info.width, info.height);
    int size = (info.width / 4 + 15) / 16 * 16;
    amb_status status = amb_panorama_to_cube(context, *texture, size, &cube, error);
    if (status == AMB_OK) {
        amb_texture_close(texture);
        *texture = cube;
    }
    return status;
}

static amb_status load_texture(const amb_context *context, asset *item, const uint8_t *data, size_t bytes,
                               amb_error *error)
{
    if (!data)
        return item->row->make_texture(context, &item->texture, error);
    amb_status status = amb_read_texture_memory(data, bytes, item->path, item->row->srgb, &item->texture, error);
    if (status == AMB_OK && item->row->kind == ASSET_ENVIRONMENT)
        status = to_cube(context, item->path, &item->texture, error);
    else if (status == AMB_OK && amb_texture_describe(item->texture).kind != AMB_TEXTURE_2D)
        status = amb_fail(error, AMB_ERROR_FORMAT, "%s: a cube map; this asset is a flat texture", item->path);
    if (status != AMB_OK)
        amb_texture_close(&item->texture);
    return status;
}

static amb_status load_mesh(const amb_context *context, asset *item, amb_error *error)
{
    if (item->source == AMB_ASSET_BUILTIN)
        return item->row->make_mesh(context, &item->mesh, error);
    amb_status status = amb_read_mesh(item->path, &item->mesh, error);
    if (status == AMB_OK && item->mesh && !item->mesh->normal)
        status = amb_mesh_smooth_normals(item->mesh, true, error);
    if (status != AMB_OK)
        amb_mesh_close(&item->mesh);
    return status;
}

static amb_status load_source(const amb_context *context, asset *item, amb_error *error)
{
    uint8_t *data = NULL;
    size_t bytes = 0;
    amb_status status = AMB_OK;
    if (item->source != AMB_ASSET_BUILTIN)
        status = amb_read_file(item->path, &data, &bytes, error);
    if (status == AMB_OK)
        status = item->row->kind == ASSET_MESH ? load_mesh(context, item, error)
                                               : load_texture(context, item, data, bytes, error);
    if (status == AMB_OK && data)
        SHA256Data(data, bytes, item->sha256);
    free(data);
    return status;
}

static amb_status load(amb_assets *assets, asset *item, amb_error *error);

/* Sets the hash: of the file; of "builtin:NAME:VERSION"; of "NAME:VERSION of" and the hash of what it is made from, for
 * irradiance just that one. Only files need be loaded for it. */
static amb_status identify(amb_assets *assets, asset *item, amb_error *error)
{
    char text[256];
    int length = 0;
    if (item->sha256[0])
        return AMB_OK;
    if (!item->of && item->source != AMB_ASSET_BUILTIN)
        return load(assets, item, error);
    amb_status status = item->of ? identify(assets, item->of, error) : AMB_OK;
    if (status != AMB_OK)
        return status;
    if (item->of && item->row->kind == ASSET_IRRADIANCE) {
        memcpy(item->sha256, item->of->sha256, sizeof item->sha256);
        return AMB_OK;
    }
    if (item->of)
        length = snprintf(text, sizeof text, "%s:%d of %s", item->row->name, item->row->version, item->of->sha256);
    else
        length = snprintf(text, sizeof text, "builtin:%s:%d", item->row->name, item->row->version);
    SHA256Data((const uint8_t *)text, (size_t)length, item->sha256);
    return AMB_OK;
}

/* From its generator, or from another asset's texture. */
static amb_status make(amb_assets *assets, asset *item, amb_error *error)
{
    if (!item->of)
        return load_source(assets->context, item, error);
    amb_status status = load(assets, item->of, error);
    if (status != AMB_OK)
        return status;
    return item->row->kind == ASSET_IRRADIANCE
               ? amb_irradiance_cube(assets->context, item->of->texture, &item->texture, error)
               : item->row->derive(assets->context, item->of->texture, &item->texture, error);
}

/* Once a run; made textures once a build, where the cache is on. */
static amb_status load(amb_assets *assets, asset *item, amb_error *error)
{
    if (item->texture || item->mesh)
        return AMB_OK;
    if (!item->of && item->source != AMB_ASSET_BUILTIN)
        return load_source(assets->context, item, error);
    amb_status status = identify(assets, item, error);
    if (status == AMB_OK && item->row->kind != ASSET_MESH)
        item->texture = asset_cache_get(&assets->cache, item->row->name, item->sha256);
    if (status != AMB_OK || item->texture)
        return status;
    status = make(assets, item, error);
    if (status == AMB_OK && item->texture)
        asset_cache_put(&assets->cache, item->row->name, item->sha256, item->texture);
    return status;
}

static const char *name_of(const void *user, int index)
{
    (void)user;
    return asset_table[index].name;
}

/* Finds, loads when needed, and marks as used. */
static amb_status use(amb_assets *assets, const char *name, bool is_mesh, asset **out, amb_error *error)
{
    asset *item = NULL;
    char hint[320];
    if (name)
        item = named(assets->asset, assets->asset + assets->count, name);
    if (!item)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "unknown asset: %s; %s", name ? name : "(none)",
                        amb_names_hint(name ? name : "", assets->count, name_of, NULL, hint, sizeof hint));
    if ((item->row->kind == ASSET_MESH) != is_mesh)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "asset %s: it is a %s, not a %s", name,
                        is_mesh ? "texture" : "mesh", is_mesh ? "mesh" : "texture");
    amb_status status = load(assets, item, error);
    item->is_used |= status == AMB_OK;
    *out = item;
    return status;
}

amb_status amb_assets_texture(amb_assets *assets, const char *name, const amb_texture **out, amb_error *error)
{
    asset *item = NULL;
    *out = NULL;
    amb_status status = use(assets, name, false, &item, error);
    if (status == AMB_OK && item)
        *out = item->texture;
    return status;
}

amb_status amb_assets_mesh(amb_assets *assets, const char *name, const amb_mesh **out, amb_error *error)
{
    asset *item = NULL;
    *out = NULL;
    amb_status status = use(assets, name, true, &item, error);
    if (status == AMB_OK && item)
        *out = item->mesh;
    return status;
}

/* ---- records --------------------------------------------------------------------------------------------------- */

int amb_assets_count(const amb_assets *assets) { return assets->count; }

void amb_assets_describe(const amb_assets *assets, int index, amb_asset_info *out)
{
    const asset *item = &assets->asset[index];
    *out = (amb_asset_info){.name = item->row->name, .about = item->row->about, .source = item->source};
    memcpy(out->path, item->path, sizeof out->path);
    memcpy(out->sha256, item->sha256, sizeof out->sha256);
}

/* The used asset of the first name after `last` (NULL: of all); NULL at the end. */
static const asset *next_used(const amb_assets *assets, const asset *last)
{
    const asset *next = NULL;
    for (int i = 0; i < assets->count; i++) {
        const asset *item = &assets->asset[i];
        if (item->is_used && (!last || strcmp(item->row->name, last->row->name) > 0) &&
            (!next || strcmp(item->row->name, next->row->name) < 0))
            next = item;
    }
    return next;
}

void amb_assets_digest(const amb_assets *assets, char hex[65])
{
    static const char *const sources[] = {"user", "pack", "builtin"};
    const asset *item = next_used(assets, NULL);
    hex[0] = '\0';
    if (!item)
        return;
    SHA2_CTX sha;
    SHA256Init(&sha);
    for (; item; item = next_used(assets, item)) {
        char line[256];
        int length = snprintf(line, sizeof line, "%s %s %s\n", item->row->name, sources[item->source], item->sha256);
        SHA256Update(&sha, (const uint8_t *)line, (size_t)length);
    }
    SHA256End(&sha, hex);
}
