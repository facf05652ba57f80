#include "scenes/asset_table.h"

#include "scenes/builtin/builtin.h"

/* An environment and its irradiance: two rows of one source. */
#define ENVIRONMENT(NAME, ABOUT, VERSION, MAKE)                                                                       \
    {.name = NAME,                                                                                                    \
     .about = ABOUT,                                                                                                  \
     .kind = ASSET_ENVIRONMENT,                                                                                       \
     .srgb = true,                                                                                                    \
     .user_file = {NAME ".exr", NAME ".hdr", NAME ".ktx", NAME ".png", NAME ".jpg", NAME ".jpeg"},                    \
     .pack_file = NAME ".ktx",                                                                                        \
     .version = VERSION,                                                                                              \
     .make_texture = MAKE},                                                                                           \
    {                                                                                                                 \
        .name = NAME "/irradiance", .about = "irradiance / pi of " NAME, .kind = ASSET_IRRADIANCE, .version = VERSION \
    }

const asset_row asset_table[] = {
    ENVIRONMENT("env/outdoor", "outdoor light: an HDR cube map or panorama", 1, amb_builtin_sky),
    ENVIRONMENT("env/studio", "indoor light: an HDR cube map or panorama", 1, amb_builtin_studio),
    {.name = "mercury/color",
     .about = "map of Mercury, longitude-latitude, north on top",
     .kind = ASSET_TEXTURE,
     .srgb = true,
     .user_file = {"mercury/color.png", "mercury/color.jpg", "mercury/color.jpeg"},
     .pack_file = "mercury/color.jpg",
     .version = 1,
     .make_texture = amb_builtin_mercury},
    {.name = "stars",
     .about = "the night sky: a panorama, its centre looking along -z, +x to the right",
     .kind = ASSET_TEXTURE,
     .srgb = true,
     .user_file = {"stars.exr", "stars.hdr", "stars.png", "stars.jpg", "stars.jpeg"},
     .pack_file = "stars.jpg",
     .version = 1,
     .make_texture = amb_builtin_stars},
    {.name = "lucy/mesh",
     .about = "the statue of scene lucy: your scan, or a winged figure of our own",
     .kind = ASSET_MESH,
     .user_file = {"lucy/lucy.ply", "lucy/lucy.obj", "lucy/lucy.glb", "lucy/lucy.gltf", "lucy/lucy100k.ply",
                   "lucy/lucy100k.obj"},
     .version = 1,
     .make_mesh = amb_builtin_statue},
};
const int asset_table_count = sizeof asset_table / sizeof *asset_table;
