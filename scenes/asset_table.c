#include "scenes/asset_table.h"

#include "scenes/builtin/builtin.h"

/* An environment and its irradiance: two rows of one source. */
#define ENVIRONMENT(NAME, ABOUT, PACK, VERSION, MAKE)                                                                 \
    {.name = NAME,                                                                                                    \
     .about = ABOUT,                                                                                                  \
     .kind = ASSET_ENVIRONMENT,                                                                                       \
     .srgb = true,                                                                                                    \
     .user_file = {NAME ".exr", NAME ".hdr", NAME ".ktx", NAME ".png", NAME ".jpg", NAME ".jpeg"},                    \
     .pack_file = PACK,                                                                                               \
     .version = VERSION,                                                                                              \
     .make_texture = MAKE},                                                                                           \
    {                                                                                                                 \
        .name = NAME "/irradiance", .about = "irradiance / pi of " NAME, .kind = ASSET_IRRADIANCE, .version = VERSION \
    }

/* A latitude-longitude map, or rings by radius; PACKED_MAP: the pack has one too. */
#define PACKED_MAP(NAME, ABOUT, SRGB, PACK, VERSION, MAKE)                                                  \
    {                                                                                                       \
        .name = NAME, .about = ABOUT, .kind = ASSET_TEXTURE, .srgb = SRGB,                                  \
        .user_file = {NAME ".png", NAME ".jpg", NAME ".jpeg", NAME ".exr", NAME ".hdr"}, .pack_file = PACK, \
        .version = VERSION, .make_texture = MAKE                                                            \
    }
/* A map made from the map OF by DERIVE, unless there is a file, or a generator and OF is built in. */
#define DERIVED_MAP(NAME, ABOUT, SRGB, PACK, VERSION, MAKE, OF, DERIVE)                                     \
    {                                                                                                       \
        .name = NAME, .about = ABOUT, .kind = ASSET_TEXTURE, .srgb = SRGB,                                  \
        .user_file = {NAME ".png", NAME ".jpg", NAME ".jpeg", NAME ".exr", NAME ".hdr"}, .pack_file = PACK, \
        .version = VERSION, .make_texture = MAKE, .of = OF, .derive = DERIVE                                \
    }
#define MAP(NAME, ABOUT, SRGB, VERSION, MAKE) PACKED_MAP(NAME, ABOUT, SRGB, NULL, VERSION, MAKE)

const asset_row asset_table[] = {
    ENVIRONMENT("env/outdoor", "outdoor light: an HDR cube map or panorama", "env/outdoor.exr", 1, amb_builtin_sky),
    ENVIRONMENT("env/studio", "indoor light: an HDR cube map or panorama", "env/studio.ktx", 1, amb_builtin_studio),
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
     .version = 2,
     .make_texture = amb_builtin_stars},
    {.name = "stars/points",
     .about = "stars drawn over the built-in sky only: directions, and light as normals",
     .kind = ASSET_MESH,
     .version = 1,
     .make_mesh = amb_builtin_star_points},
    {.name = "lucy/mesh",
     .about = "the statue of scene lucy: your scan, or a winged figure of our own",
     .kind = ASSET_MESH,
     .user_file = {"lucy/lucy.ply", "lucy/lucy.obj", "lucy/lucy.glb", "lucy/lucy.gltf", "lucy/lucy100k.ply",
                   "lucy/lucy100k.obj"},
     .version = 1,
     .make_mesh = amb_builtin_statue},
    /* Maps of the solar system. */
    PACKED_MAP("earth/color", "the Earth by day", true, "earth/color.jpg", 2, amb_builtin_earth_colour),
    PACKED_MAP("earth/night", "its lights at night", true, "earth/night.jpg", 2, amb_builtin_earth_night),
    PACKED_MAP("earth/water", "1 on water, 0 on land", false, "earth/water.png", 2, amb_builtin_earth_water),
    PACKED_MAP("earth/height", "its height", false, "earth/height.png", 2, amb_builtin_earth_height),
    PACKED_MAP("earth/clouds", "cover of its clouds: brightness times alpha", false, "earth/clouds.png", 2,
               amb_builtin_earth_clouds),
    MAP("venus/color", "the clouds of Venus", true, 1, amb_builtin_venus_colour),
    PACKED_MAP("venus/surface", "the ground below them", true, "venus/surface.jpg", 1, amb_builtin_venus_surface),
    PACKED_MAP("mars/color", "Mars", true, "mars/color.jpg", 2, amb_builtin_mars_colour),
    DERIVED_MAP("mars/height", "its height", false, NULL, 2, amb_builtin_mars_height, "mars/color",
                amb_builtin_brightness),
    DERIVED_MAP("mars/relief", "its normals, coded: x east, y north, z up", false, "mars/relief.jpg", 2, NULL,
                "mars/height", amb_builtin_mars_relief),
    PACKED_MAP("jupiter/color", "Jupiter", true, "jupiter/color.jpg", 3, amb_builtin_jupiter_colour),
    DERIVED_MAP("jupiter/color1", "Jupiter, key frame 1 of its drifting bands", true, NULL, 3, NULL, "jupiter/color",
                amb_builtin_jupiter_key1),
    DERIVED_MAP("jupiter/color2", "Jupiter, key frame 2 of its drifting bands", true, NULL, 3, NULL, "jupiter/color",
                amb_builtin_jupiter_key2),
    DERIVED_MAP("jupiter/color3", "Jupiter, key frame 3 of its drifting bands", true, NULL, 3, NULL, "jupiter/color",
                amb_builtin_jupiter_key3),
    DERIVED_MAP("jupiter/color4", "Jupiter, key frame 4 of its drifting bands", true, NULL, 3, NULL, "jupiter/color",
                amb_builtin_jupiter_key4),
    DERIVED_MAP("jupiter/velocity", "drift of its bands: 128 still, more to the right", false, NULL, 3, NULL,
                "jupiter/color", amb_builtin_jupiter_velocity),
    PACKED_MAP("saturn/color", "Saturn", true, "saturn/color.jpg", 1, amb_builtin_saturn_colour),
    MAP("saturn/rings", "tint and opacity of its rings by radius", true, 1, amb_builtin_saturn_rings),
    MAP("saturn/scatter", "back-, forward- and unlit-scattered light of its rings", false, 1,
        amb_builtin_saturn_ring_scatter),
    PACKED_MAP("uranus/color", "Uranus", true, "uranus/color.jpg", 1, amb_builtin_uranus_colour),
    MAP("uranus/rings", "tint and opacity of its rings by radius", true, 1, amb_builtin_uranus_rings),
    PACKED_MAP("neptune/color", "Neptune", true, "neptune/color.jpg", 1, amb_builtin_neptune_colour),
    PACKED_MAP("pluto/color", "Pluto", true, "pluto/color.png", 1, amb_builtin_pluto_colour),
    DERIVED_MAP("pluto/gloss", "where its ice shines", false, NULL, 1, amb_builtin_pluto_gloss, "pluto/color",
                amb_builtin_brightness),
    PACKED_MAP("sun/color", "the surface of the sun", true, "sun/color.jpg", 1, amb_builtin_sun_colour),
    /* Landscapes. */
    PACKED_MAP("hills/height", "heights of the hills: 0 lowest, 1 highest", false, NULL, 2, amb_builtin_hills),
    PACKED_MAP("ground/grass", "a tile of grass", true, "ground/grass.png", 2, amb_builtin_ground_grass),
    PACKED_MAP("ground/rock", "a tile of rock", true, "ground/rock.png", 2, amb_builtin_ground_rock),
    PACKED_MAP("ground/sand", "a tile of sand", true, "ground/sand.png", 2, amb_builtin_ground_sand),
    PACKED_MAP("ground/snow", "a tile of snow", true, "ground/snow.png", 2, amb_builtin_ground_snow),
    MAP("hills/noise", "four tiling noises, 0.5 on average", false, 2, amb_builtin_hills_noise),
    MAP("plants/trees", "four trees side by side, with alpha", true, 2, amb_builtin_trees),
    MAP("plants/tree-normals", "their normals; alpha: openness to the sky", false, 2, amb_builtin_tree_normals),
    MAP("plants/grass", "four tufts side by side, with alpha", true, 2, amb_builtin_grass_tufts),
};
const int asset_table_count = sizeof asset_table / sizeof *asset_table;
