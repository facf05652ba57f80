/* The table of known assets: one row each, in listing order. */
#ifndef AMBIANCE_SCENES_ASSET_TABLE_H
#define AMBIANCE_SCENES_ASSET_TABLE_H

#include <ambiance/assets.h>

typedef enum asset_kind {
    ASSET_TEXTURE,     /* a 2D texture */
    ASSET_ENVIRONMENT, /* a cube map with mips, from a cube map or a panorama */
    ASSET_IRRADIANCE,  /* the irradiance / pi of the environment in the row before */
    ASSET_MESH,
} asset_kind;

typedef struct asset_row {
    const char *name, *about;
    asset_kind kind;
    bool srgb;                /* 8-bit files: colour, not data */
    const char *user_file[8]; /* tried in this order in the user's folder; unused ones NULL */
    const char *pack_file;    /* NULL: the pack has none */
    int version;              /* of the generator: raised when its result changes */
    amb_status (*make_texture)(const amb_context *context, amb_texture **out, amb_error *error);
    /* Made from the texture of an earlier row, `of`, where no file is found: always when there is no make_texture, else
     * when that texture is not built in, so that maps of one planet fit together. */
    const char *of;
    amb_status (*derive)(const amb_context *context, const amb_texture *of, amb_texture **out, amb_error *error);
    amb_status (*make_mesh)(const amb_context *context, amb_mesh **out, amb_error *error);
} asset_row;

extern const asset_row asset_table[];
extern const int asset_table_count;

#endif
