/* The built-in assets: made by generators of ours, complete, deterministic on every instruction set and thread count.
 * Each gives a new object, owned by the caller. Errors: MEMORY. */
#ifndef AMB_SCENES_BUILTIN_H
#define AMB_SCENES_BUILTIN_H

#include <ambiance/context.h>
#include <ambiance/mesh.h>
#include <ambiance/texture.h>

/* HDR environments: RGBA16F cube maps, 512² faces, mips; linear radiance, 1 = paper white. */
amb_status amb_builtin_sky(const amb_context *context, amb_texture **out, amb_error *error); /* evening over a sea */
amb_status amb_builtin_studio(const amb_context *context, amb_texture **out,
                              amb_error *error); /* soft boxes, dark room */

/* The night sky but its stars: the Milky Way, RGBA16F, 2048 × 1024, mips; a panorama (its centre looks along -z, +x to
 * the right); linear radiance. */
amb_status amb_builtin_stars(const amb_context *context, amb_texture **out, amb_error *error);
/* 40,000 stars: positions are unit directions, normals their light, linear radiance times square milliradians. No
 * triangles. */
amb_status amb_builtin_star_points(const amb_context *context, amb_mesh **out, amb_error *error);
/* The map of Mercury: sRGB8_A8, 4096 × 2048, longitude-latitude, north on top. */
amb_status amb_builtin_mercury(const amb_context *context, amb_texture **out, amb_error *error);

/* The statue of scene lucy: a winged Victory with torch and wreath on a plinth. World units: the figure is about 1
 * tall, its feet at y = 0, y up, facing +z; the plinth reaches down to y = -0.135. Unit normals, no UVs; about 750,000
 * triangles, a closed manifold. Errors: MEMORY. */
amb_status amb_builtin_statue(const amb_context *context, amb_mesh **out, amb_error *error);

/* Latitude-longitude maps, 2048×1024 with mips: linear albedo (colour), 0…1 otherwise. */
amb_status amb_builtin_earth_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_earth_height(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_earth_water(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_earth_night(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_earth_clouds(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_venus_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_venus_surface(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_mars_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_mars_height(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_pluto_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_pluto_gloss(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_jupiter_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_saturn_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_uranus_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_neptune_colour(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_sun_colour(const amb_context *context, amb_texture **out, amb_error *error);

/* Maps made from a map, of its size. Jupiter's key frames of drifting bands and their drift, from the still map (that
 * is key frame 0); brightness, 0…1; Mars's coded normals from its height. */
amb_status amb_builtin_jupiter_key1(const amb_context *context, const amb_texture *still, amb_texture **out,
                                    amb_error *error);
amb_status amb_builtin_jupiter_key2(const amb_context *context, const amb_texture *still, amb_texture **out,
                                    amb_error *error);
amb_status amb_builtin_jupiter_key3(const amb_context *context, const amb_texture *still, amb_texture **out,
                                    amb_error *error);
amb_status amb_builtin_jupiter_key4(const amb_context *context, const amb_texture *still, amb_texture **out,
                                    amb_error *error);
amb_status amb_builtin_jupiter_velocity(const amb_context *context, const amb_texture *still, amb_texture **out,
                                        amb_error *error);
amb_status amb_builtin_brightness(const amb_context *context, const amb_texture *colour, amb_texture **out,
                                  amb_error *error);
amb_status amb_builtin_mars_relief(const amb_context *context, const amb_texture *height, amb_texture **out,
                                   amb_error *error);

/* Saturn's rings by radius (rings.h), 4096×1: tint and opacity; back-, forward- and unlit-scattered intensity in r, g,
 * b. */
amb_status amb_builtin_saturn_rings(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_saturn_ring_scatter(const amb_context *context, amb_texture **out, amb_error *error);

/* Uranus's nine narrow rings on the same scale: tint and opacity. */
amb_status amb_builtin_uranus_rings(const amb_context *context, amb_texture **out, amb_error *error);

/* The landscape: heights 0…1 of an island, 2048² R32F, the sea at 0.25; and 1024² tiles of ground, linear albedo. With
 * mips. */
amb_status amb_builtin_hills(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_ground_grass(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_ground_rock(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_ground_sand(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_ground_snow(const amb_context *context, amb_texture **out, amb_error *error);

/* Four independent noises, 512², RGBA8, tile; 0…1 about ½. */
amb_status amb_builtin_hills_noise(const amb_context *context, amb_texture **out, amb_error *error);
/* Atlases of plants, see plants.c: trees 1024×512, sRGB8_A8, their normals RGBA8; grass 1024×256, sRGB8_A8. */
amb_status amb_builtin_trees(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_tree_normals(const amb_context *context, amb_texture **out, amb_error *error);
amb_status amb_builtin_grass_tufts(const amb_context *context, amb_texture **out, amb_error *error);

/* A latitude-longitude panorama (its centre looks along -z, +x to the right) as an RGBA16F cube map of size² faces. */
amb_status amb_panorama_to_cube(const amb_context *context, const amb_texture *panorama, int size, amb_texture **out,
                                amb_error *error);
/* Irradiance of an environment over π, for every normal: an RGBA32F cube map of 32² faces. A white environment of
 * radiance 1 gives 1. Every texel is the full sum over the environment's 64² level: no basis, no ringing. */
amb_status amb_irradiance_cube(const amb_context *context, const amb_texture *environment, amb_texture **out,
                               amb_error *error);

#endif
