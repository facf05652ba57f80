/* Shaders of scene elevated, in the order of the report's chapter: height, normal, light, shadow, snow, fog; sky. */
#include "scenes/elevated_shade.h"
#include "shade/diffuse.h"
#include "shade/fog.h"

AMB_INLINE void put(const elevated_uniforms *u, amb_fs_out *out, int aov, v3x value)
{
    if (u->slot[aov] > 0)
        out->color[u->slot[aov]] = v4x_of3(value, f_set(1.0f));
}
AMB_INLINE v3x grey(f32x a) { return (v3x){a, a, a}; }

/* Octaves whose cells are at least `length` wide; real, so that the last one fades. */
AMB_INLINE f32x octaves_down_to(f32x length, int most)
{
    return f_clamp(1.0f - f_log2(length), f_set(1.0f), f_set((float)most));
}

/* ---- geometry -----------------------------------------------------------------------------------------------------
 */

/* What one triangle edge should span at a point of the plane, in cells. */
AMB_INLINE f32x edge_length(const elevated_uniforms *u, f32x x, f32x z)
{
    f32x dx = x - u->eye.x, dz = z - u->eye.z;
    f32x distance = f_sqrt(dx * dx + dz * dz + u->params->clearance * u->params->clearance);
    return distance * (u->params->triangle / u->pixels);
}

/* Octaves of the geometry there: a function of place alone, so neighbouring patches meet. */
AMB_INLINE f32x geometry_octaves(const elevated_uniforms *u, f32x x, f32x z)
{
    return octaves_down_to(edge_length(u, x, z) * 3.0f, u->params->geometry_octaves);
}

AMB_INLINE v3x displaced(const elevated_uniforms *u, f32x x, f32x z)
{
    f32x height = terrain_at(&u->ground, (v2x){x, z}, geometry_octaves(u, x, z)).height;
    return (v3x){x, height * u->params->height, z};
}

/* Segments of an edge with the given middle: a power of two, so that they lie on one lattice of the world at every
 * distance and nothing slides along the ground. From the edge alone: both patches at it agree. */
AMB_INLINE f32x edge_segments(const elevated_uniforms *u, f32x x, f32x z, f32x length)
{
    f32x wanted = f_clamp(length / edge_length(u, x, z), f_set(2.0f), f_set(64.0f));
    return f_from_bits((f_bits(wanted) + 0x7fffff) & (255 << 23)); /* the power of two at or above */
}

void elevated_ground_hull(const amb_hs_in *in, amb_hs_out *out)
{
    const elevated_uniforms *u = in->uniforms;
    i32x patch = in->corner[0], px = patch_x(patch), pz = patch_z(patch);
    f32x side = patch_side(patch);
    for (int edge = 0; edge < 4; edge++) { /* u = 0, v = 0, u = 1, v = 1 */
        bool along_z = edge % 2 == 0, upper = edge >= 2;
        maskx half = patch_half_edge(patch, edge);
        f32x across = i_to_f((along_z ? px : pz) + (upper ? 1 : 0)) * side;
        i32x place = along_z ? pz : px;
        f32x own = (i_to_f(place) + 0.5f) * side, twice = i_to_f((place >> 1) * 2 + 1) * side; /* the larger edge's */
        f32x middle = f_sel(half, twice, own), length = f_sel(half, side + side, side);
        f32x segments = edge_segments(u, along_z ? across : middle, along_z ? middle : across, length);
        out->edge[edge] = f_sel(half, segments * 0.5f, segments);
    }
    out->inside[0] = f_max(out->edge[1], out->edge[3]);
    out->inside[1] = f_max(out->edge[0], out->edge[2]);
}

void elevated_ground_domain(const amb_ds_in *in, amb_vs_out *out)
{
    const elevated_uniforms *u = in->uniforms;
    elevated_varyings *v = out->varyings;
    i32x patch = in->corner[0];
    f32x side = patch_side(patch);
    v->world = displaced(u, (i_to_f(patch_x(patch)) + in->u) * side, (i_to_f(patch_z(patch)) + in->v) * side);
    out->clip = m4_project_x(u->world_to_clip, v->world);
}

/* ---- ground -------------------------------------------------------------------------------------------------------
 */

/* The larger side of a pixel's footprint on the plane. */
AMB_INLINE f32x footprint(v3x world)
{
#if AMB_LANES > 1
    f32x xx = f_ddx(world.x), xz = f_ddx(world.z), yx = f_ddy(world.x), yz = f_ddy(world.z);
    return f_sqrt(f_max(xx * xx + xz * xz, yx * yx + yz * yz));
#else
    (void)world;
    return f_set(0.0f);
#endif
}

/* How much of the sun reaches the ground: marched from the coarse ground's height, or guessed from the light on its
 * slope, or all of it. */
AMB_INLINE f32x ground_sunlight(const elevated_uniforms *u, v2x p, f32x octaves, terrain_surface coarse)
{
    const elevated_params *s = u->params;
    if (s->shadows == SHADOWS_OFF)
        return f_set(1.0f);
    if (s->shadows == SHADOWS_ESTIMATE) {
        v3x n = terrain_normal(coarse.slope, s->height);
        return f_smoothstep(f_set(-0.02f), f_set(0.18f), v3x_dot(n, v3x_splat(u->sky.to_sun)));
    }
    terrain_march m = {.scale = s->height,
                       .ceiling = u->ceiling,
                       .reach = s->shadow_reach,
                       .spread = s->shadow_size * (AMB_PI / 180.0f),
                       .steps = s->shadow_steps};
    return terrain_sunlight(&u->ground, &m, p, coarse.height * s->height, u->sky.to_sun,
                            f_min(octaves, f_set((float)s->shadow_octaves)));
}

/* The report's snow, with a snow line: height counts as noise does. */
AMB_INLINE f32x ground_snow(const elevated_uniforms *u, f32x normal_y, f32x y, f32x noise)
{
    return terrain_snow(normal_y, noise + y * (u->params->snow_height / u->params->height), u->params->snow);
}

/* Slope, in those of Z, of the relief that bare rock has besides: noise over the plane, and crags, noise over a
 * vertical plane, so that cliffs are not smooth downwards: the slope of c(k·(x, z), y) with y the ground's own height;
 * none on level ground, where it would be stripes. */
AMB_INLINE v2x rock_relief(const elevated_uniforms *u, v3x world, v2x slope, v2x speckle, f32x pixel)
{
    const elevated_params *s = u->params;
    const float along_x = 0.6f, along_z = 0.8f, scale = 2.0f * s->snow_scale, per_height = 1.0f / s->height;
    v2x at = {(world.x * along_x + world.z * along_z) * scale, world.y * scale};
    v2x crag = terrain_at(&u->speckle, at, octaves_down_to(pixel * (s->detail * scale), 7)).slope;
    f32x flat = f_set(s->roughness * s->snow_scale * per_height);
    f32x level = f_smoothstep(f_set(0.55f), f_set(0.92f), terrain_normal(slope, s->height).y);
    f32x steep = (1.0f - level) * (s->crags * scale * per_height);
    return (v2x){speckle.x * flat + steep * (crag.x * along_x + crag.y * (slope.x * s->height)),
                 speckle.y * flat + steep * (crag.x * along_z + crag.y * (slope.y * s->height))};
}

/* A tile of texture in the plane of two coordinates, relative to its mean. */
AMB_INLINE v3x tile_at(const elevated_texture *t, f32x x, f32x y)
{
    static const amb_sampler sampler = {.filter = AMB_TRILINEAR, .max_anisotropy = 4};
    v2x uv = {x * t->tiles, y * t->tiles};
#if AMB_LANES > 1
    v4x texel =
        amb_sample_2d_grad(t->map, &sampler, uv, (v2x){f_ddx(uv.x), f_ddx(uv.y)}, (v2x){f_ddy(uv.x), f_ddy(uv.y)});
#else
    v4x texel = amb_sample_2d_lod(t->map, &sampler, uv, f_set(0.0f));
#endif
    return v3x_mul(v4x_xyz(texel), v3x_splat(t->per_mean));
}

/* Rock's texture from three sides, by the squared components of the normal. */
AMB_INLINE v3x rock_texture(const elevated_texture *t, v3x world, v3x normal)
{
    v3x top = v3x_scale(tile_at(t, world.x, world.z), normal.y * normal.y);
    v3x front = v3x_scale(tile_at(t, world.x, world.y), normal.z * normal.z);
    v3x side = v3x_scale(tile_at(t, world.z, world.y), normal.x * normal.x);
    return v3x_add(top, v3x_add(front, side));
}

/* Bands of rock of other colour, by height and noise. */
AMB_INLINE v3x land_albedo(const elevated_uniforms *u, v3x world, f32x normal_y, f32x noise)
{
    const elevated_params *s = u->params;
    f32x layer = 0.5f + 0.5f * f_sin(world.y * (60.0f / s->height) + noise * 4.0f);
    v3x rock = v3x_lerp(v3x_splat(s->land_color), v3x_splat(s->strata_color), layer * f_saturate(0.5f + noise));
    f32x low = f_saturate(0.30f - world.y * (1.6f / s->height) + 0.35f * noise) *
               f_smoothstep(f_set(0.62f), f_set(0.9f), normal_y);
    return v3x_lerp(rock, v3x_splat(s->valley_color), low);
}

/* Textures fade out where a tile spans few samples: from there their repetition would show. */
AMB_INLINE v3x ground_albedo(const elevated_uniforms *u, v3x world, v3x normal, f32x snow, f32x noise, f32x pixel)
{
    const elevated_params *s = u->params;
    v3x land = land_albedo(u, world, normal.y, noise), white = v3x_splat(s->snow_color);
    f32x strength = s->texture * f_smoothstep(f_set(60.0f), f_set(240.0f), 1.0f / (pixel * (float)s->tiles));
    if (m_any(strength > 0.0f)) {
        v3x one = v3x_splat((v3){1.0f, 1.0f, 1.0f});
        land = v3x_mul(land, v3x_lerp(one, rock_texture(&u->rock, world, normal), strength));
        white = v3x_mul(white, v3x_lerp(one, tile_at(&u->snow, world.x, world.z), strength));
    }
    return v3x_lerp(land, white, snow);
}

/* Light on the ground before its albedo: the sun; the sky's constant with noise and a faint blue light from behind,
 * both dimmed by occlusion. */
AMB_INLINE v3x ground_light(const elevated_uniforms *u, v3x normal, f32x sunlight, f32x occlusion, f32x noise)
{
    const elevated_params *s = u->params;
    f32x facing = diffuse_lambert(v3x_dot(normal, v3x_splat(u->sky.to_sun))) * sunlight;
    v3x sun = v3x_scale(v3x_splat(u->sun_rgb), facing);
    v3x ambient = v3x_scale(v3x_splat(u->ambient_rgb), (1.0f + s->ambient_noise * noise) * occlusion);
    f32x behind = diffuse_wrapped(v3x_dot(normal, v3x_splat(u->to_back)), 0.3f);
    v3x back = v3x_scale(v3x_splat(u->back_rgb), behind * occlusion);
    return v3x_add(sun, v3x_add(ambient, back));
}

typedef struct elevated_fog {
    v3x transmit, light;
    f32x depth;
} elevated_fog;

/* Haze between the eye and a point: it takes away by wavelength, and adds light: of the whole sky while it is thin, of
 * the horizon behind it as it thickens, so that the farthest ground meets the sky. */
AMB_INLINE elevated_fog ground_fog(const elevated_uniforms *u, v3x world)
{
    const elevated_params *s = u->params;
    v3x way = v3x_sub(world, v3x_splat(u->eye));
    f32x distance = v3x_length(way);
    v3x direction = v3x_scale(way, 1.0f / f_max(distance, f_set(1.0e-6f)));
    elevated_fog fog;
    fog.depth = fog_depth(f_set(u->eye.y), direction.y, distance, s->fog_density, s->fog_falloff);
    fog.transmit = (v3x){f_exp(-fog.depth * s->fog_color.x), f_exp(-fog.depth * s->fog_color.y),
                         f_exp(-fog.depth * s->fog_color.z)};
    v3x horizon = v3x_mul(sky_horizon_rgb(&u->sky, direction), v3x_splat(u->gain));
    fog.light = v3x_lerp(v3x_splat(u->haze_rgb), horizon, 1.0f - f_exp(-fog.depth));
    return fog;
}

void elevated_ground_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const elevated_uniforms *u = in->uniforms;
    const elevated_params *s = u->params;
    v3x world = ((const elevated_varyings *)in->varyings)->world;
    v2x p = {world.x, world.z};
    f32x pixel = footprint(world);
    f32x octaves = octaves_down_to(pixel * s->detail, s->octaves);

    terrain_surface coarse, fine = terrain_at_both(&u->ground, p, octaves, s->shadow_octaves, &coarse);
    if (s->normals == NORMALS_CENTRAL)
        fine = terrain_at_central(&u->ground, p, octaves, pixel * s->normal_step);
    terrain_surface speckle = terrain_at(&u->speckle, v2x_scale(p, f_set(s->snow_scale)),
                                         octaves_down_to(pixel * (s->detail * s->snow_scale), 7));
    f32x noise = speckle.height;

    f32x snow = ground_snow(u, terrain_normal(fine.slope, s->height).y, world.y, noise);
    v2x relief = rock_relief(u, world, fine.slope, speckle.slope, pixel);
    v3x normal = terrain_normal(v2x_add(fine.slope, v2x_scale(relief, 1.0f - snow)), s->height);
    f32x sunlight = ground_sunlight(u, p, octaves, coarse);
    f32x occlusion = terrain_occlusion(normal.y, s->occlusion_power, s->occlusion_floor);
    v3x albedo = ground_albedo(u, world, normal, snow, noise, pixel);
    v3x light = ground_light(u, normal, sunlight, occlusion, noise);
    elevated_fog fog = ground_fog(u, world);

    v3x one = v3x_splat((v3){1.0f, 1.0f, 1.0f});
    v3x seen = v3x_add(v3x_mul(v3x_mul(albedo, light), fog.transmit), v3x_mul(fog.light, v3x_sub(one, fog.transmit)));
    out->color[0] = v4x_of3(seen, f_set(1.0f));
    put(u, out, OUT_POSITION, world);
    put(u, out, OUT_NORMAL, normal);
    put(u, out, OUT_ALBEDO, albedo);
    put(u, out, OUT_ID, one);
    put(u, out, OUT_AO, grey(occlusion));
    put(u, out, OUT_SHADOW, grey(sunlight));
    put(u, out, OUT_SNOW, grey(snow));
    put(u, out, OUT_FOG, grey(1.0f - f_exp(-fog.depth)));
    put(u, out, OUT_HEIGHT, grey(world.y));
    put(u, out, OUT_LIGHT, light);
}

/* ---- sky ----------------------------------------------------------------------------------------------------------
 */

void elevated_sky_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const elevated_uniforms *u = in->uniforms;
    v3x ray = v3x_add(v3x_splat(u->ray_origin),
                      v3x_add(v3x_scale(v3x_splat(u->ray_dx), in->x), v3x_scale(v3x_splat(u->ray_dy), in->y)));
    v3x direction = v3x_normalize(ray);
    v3x light = v3x_add(sky_rgb(&u->sky, direction), sky_sun_disc(&u->sky, direction, u->sun_cosine));
    out->color[0] = v4x_of3(v3x_mul(light, v3x_splat(u->gain)), f_set(1.0f));
    put(u, out, OUT_FOG, grey(f_set(1.0f)));
    put(u, out, OUT_SHADOW, grey(f_set(1.0f)));
}
