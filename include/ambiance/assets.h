/* Assets: a name resolves, per asset, to the user's folder, then the pack, then a built-in generator; what was used is
 * recorded. See docs/assets.md. Thread rule: one resolver serves one thread at a time. */
#ifndef AMBIANCE_ASSETS_H
#define AMBIANCE_ASSETS_H

#include <ambiance/context.h>
#include <ambiance/mesh.h>
#include <ambiance/texture.h>

typedef enum amb_asset_source { AMB_ASSET_USER, AMB_ASSET_PACK, AMB_ASSET_BUILTIN } amb_asset_source;

typedef struct amb_assets amb_assets;

typedef struct amb_assets_options {
    const char *user_dir; /* NULL: $AMBIANCE_ASSETS, then $XDG_DATA_HOME/ambiance (or ~/.local/share/ambiance) */
    const char *pack_dir; /* NULL: $AMBIANCE_PACK, then <user data>/ambiance-pack, then the build's default */
    bool builtin_only;    /* ignore both folders: what goldens use */
    bool keep_made; /* keep made textures between runs: in $AMBIANCE_CACHE ("off": nowhere), $XDG_CACHE_HOME/ambiance or
                     * ~/.cache/ambiance */
} amb_assets_options;

amb_status amb_assets_create(const amb_context *context, const amb_assets_options *options, amb_assets **out,
                             amb_error *error);
void amb_assets_close(amb_assets **assets); /* also frees everything it handed out */

/* Each loads (or generates) once and hands out the same object again; owned by the resolver. NOT_FOUND for a name that
 * is not in the table or of another kind; a user or pack file that is damaged is an error, never skipped silently. */
amb_status amb_assets_texture(amb_assets *assets, const char *name, const amb_texture **out, amb_error *error);
amb_status amb_assets_mesh(amb_assets *assets, const char *name, const amb_mesh **out, amb_error *error);

/* One row a known asset; source and path are those that a load would use (path "" for built in). */
typedef struct amb_asset_info {
    const char *name, *about;
    amb_asset_source source;
    char path[1024];
    char sha256[65]; /* of the file, or of what says how it is made; "" until loaded */
} amb_asset_info;
int amb_assets_count(const amb_assets *assets);
void amb_assets_describe(const amb_assets *assets, int index, amb_asset_info *out);
/* SHA-256 over "name source sha256\n" of the assets loaded so far, sorted by name; "" when none. */
void amb_assets_digest(const amb_assets *assets, char hex[65]);

#endif
