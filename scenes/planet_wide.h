/* The lanes part of the planets: vertex shader, the point seen on a shell, map look-ups, background. Included by the
 * *_wide.c files of planets. */
#ifndef AMB_SCENES_PLANET_WIDE_H
#define AMB_SCENES_PLANET_WIDE_H

#include "scenes/planet.h"
#include "shade/normal_map.h"

#include <ambiance/math.h>
#include <ambiance/raster.h>

typedef struct planet_varyings {
    v3x world;
} planet_varyings;

/* Own frame → world, of a direction. */
AMB_INLINE v3x planet_to_world(const planet_view *view, v3x own)
{
    v3x x = v3x_scale(v3x_splat(view->axis[0]), own.x), y = v3x_scale(v3x_splat(view->axis[1]), own.y);
    return v3x_add(v3x_add(x, y), v3x_scale(v3x_splat(view->axis[2]), own.z));
}
AMB_INLINE v3x planet_to_own(const planet_view *view, v3x world)
{
    return (v3x){v3x_dot(world, v3x_splat(view->axis[0])), v3x_dot(world, v3x_splat(view->axis[1])),
                 v3x_dot(world, v3x_splat(view->axis[2]))};
}

/* Draws view->sphere as the shell view->shell · view->scale. */
AMB_INLINE void planet_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const planet_view *view = in->uniforms;
    planet_varyings *v = out->varyings;
    v3x unit = v3x_gather(view->sphere->position, in->vertex);
    v3x own = v3x_mul(unit, v3x_splat(v3_scale(view->scale, view->shell)));
    v->world = planet_to_world(view, own);
    out->clip = m4_project_x(view->world_to_clip, v->world);
}

/* The point seen on a shell. */
typedef struct planet_point {
    v3x world, normal, to_eye; /* of the smooth spheroid; unit but `world` */
    v3x east, south;           /* unit, world: along +u and +v of the maps */
    v2x uv, uv_dx, uv_dy;      /* and their change to the next pixel; no seam at ±180° */
} planet_point;

/* Of the unit direction d: u = 0.5 - atan2(x, -z)/2π, growing eastward (to the right for an observer outside, north
 * up), v = acos(y)/π. */
AMB_INLINE v2x planet_uv(v3x d)
{
    v2x uv = {0.5f - f_atan2(d.x, -d.z) * (0.5f * AMB_INV_PI),
              f_acos(f_clamp(d.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI};
    return uv;
}
/* Its gradient for a change of d, as if a texel were everywhere as wide as at the equator: without a seam at ±180° and
 * without a pole. Toward the poles maps are stretched along u and hold no detail there that filtering must remove. */
AMB_INLINE v2x planet_uv_change(v3x d, v3x change)
{
    f32x across = f_sqrt(f_max(d.x * d.x + d.z * d.z, f_set(1.0e-12f)));
    v2x uv = {(d.z * change.x - d.x * change.z) / across * (0.5f * AMB_INV_PI), -change.y / across * AMB_INV_PI};
    return uv;
}

AMB_INLINE planet_point planet_point_of(const planet_view *view, v3x world)
{
    planet_point p;
    v3 inverse = {1.0f / view->scale.x, 1.0f / view->scale.y, 1.0f / view->scale.z};
    v3x d = v3x_normalize(v3x_mul(planet_to_own(view, world), v3x_splat(inverse)));
    p.world = world;
    p.normal = v3x_normalize(planet_to_world(view, v3x_mul(d, v3x_splat(inverse))));
    p.to_eye = v3x_normalize(v3x_sub(v3x_splat(view->eye), world));
    f32x across = f_sqrt(f_max(d.x * d.x + d.z * d.z, f_set(1.0e-12f)));
    v3x east = {d.z / across, f_set(0.0f), -d.x / across};
    p.east = planet_to_world(view, east);
    p.south = v3x_normalize(v3x_cross(p.east, p.normal));
    p.uv = planet_uv(d);
#if AMB_LANES > 1
    p.uv_dx = planet_uv_change(d, (v3x){f_ddx(d.x), f_ddx(d.y), f_ddx(d.z)});
    p.uv_dy = planet_uv_change(d, (v3x){f_ddy(d.x), f_ddy(d.y), f_ddy(d.z)});
#else
    p.uv_dx = p.uv_dy = (v2x){0.0f, 0.0f};
#endif
    return p;
}

static const amb_sampler planet_sampler = {
    .filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}, .max_anisotropy = 4};

/* For maps whose detail at grazing views is not missed: one probe a look-up. */
static const amb_sampler planet_plain_sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};

/* A map at the point, moved by `offset` in u and v. */
AMB_INLINE v4x planet_map_at(const amb_texture *map, const planet_point *p, v2x offset)
{
    return amb_sample_2d_grad(map, &planet_sampler, v2x_add(p->uv, offset), p->uv_dx, p->uv_dy);
}
AMB_INLINE v4x planet_map(const amb_texture *map, const planet_point *p)
{
    return amb_sample_2d_grad(map, &planet_sampler, p->uv, p->uv_dx, p->uv_dy);
}

AMB_INLINE v4x planet_map_plain(const amb_texture *map, const planet_point *p, v2x uv)
{
    return amb_sample_2d_grad(map, &planet_plain_sampler, uv, p->uv_dx, p->uv_dy);
}

/* A coded tangent-space normal, brought to the world. */
AMB_INLINE v3x planet_bumped(const planet_point *p, v4x texel, float strength)
{
    v3x m = normal_map_decode(v4x_xyz(texel), strength);
    return normal_map_apply(m, p->east, p->south, p->normal);
}

AMB_INLINE void planet_put(const planet_view *view, amb_fs_out *out, int aov, v3x value)
{
    if (view->slot[aov] > 0)
        out->color[view->slot[aov]] = v4x_of3(value, f_set(1.0f));
}
/* The outputs that every planet has. */
AMB_INLINE void planet_put_surface(const planet_view *view, amb_fs_out *out, const planet_point *p, v3x normal,
                                   v3x albedo, float id)
{
    planet_put(view, out, PLANET_POSITION, p->world);
    planet_put(view, out, PLANET_NORMAL, normal);
    planet_put(view, out, PLANET_ALBEDO, albedo);
    planet_put(view, out, PLANET_ID, v3x_splat((v3){id, id, id}));
}

/* The picture's colour: everything, or the part that the view shows alone. */
AMB_INLINE v4x planet_shown(const planet_view *view, v3x everything, v3x albedo, v3x normal, v3x light)
{
    v3x shown = everything;
    switch (view->show) {
    case PLANET_SHOW_ALBEDO:
        shown = albedo;
        break;
    case PLANET_SHOW_NORMALS:
        shown = normal_map_encode(normal);
        break;
    case PLANET_SHOW_LIGHT:
        shown = light;
        break;
    case PLANET_SHOW_ATTENUATION:
        shown = v3x_splat((v3){1, 1, 1});
        break;
    case PLANET_SHOW_SCATTERING:
        shown = v3x_splat((v3){0, 0, 0});
        break;
    default:
        break;
    }
    return v4x_of3(shown, f_set(1.0f));
}

/* Stars by direction, and the sun's disc with a darkened limb. */
AMB_INLINE void planet_background(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_view *view = in->uniforms;
    v3x ray = v3x_add(v3x_splat(view->ray_origin),
                      v3x_add(v3x_scale(v3x_splat(view->ray_dx), in->x), v3x_scale(v3x_splat(view->ray_dy), in->y)));
    v3x d = v3x_normalize(ray);
    v3x sky = {-d.x, d.y, d.z}; /* seen from inside, east is to the left */
    planet_point p = {.uv = planet_uv(sky)};
#if AMB_LANES > 1
    p.uv_dx = planet_uv_change(sky, (v3x){f_ddx(sky.x), f_ddx(sky.y), f_ddx(sky.z)});
    p.uv_dy = planet_uv_change(sky, (v3x){f_ddy(sky.x), f_ddy(sky.y), f_ddy(sky.z)});
#else
    p.uv_dx = p.uv_dy = (v2x){0.0f, 0.0f};
#endif
    v3x light = v3x_splat((v3){0, 0, 0});
    if (view->star_gain > 0.0f)
        light = v3x_scale(v4x_xyz(planet_map(view->stars, &p)), f_set(view->star_gain));
    if (view->sun_size < 1.0f) {
        f32x cosine = v3x_dot(d, v3x_splat(view->to_sun));
        f32x depth = f_saturate((cosine - view->sun_size) * (1.0f / (1.0f - view->sun_size)));
        f32x disc = f_sel(cosine > view->sun_size, 0.4f + 0.6f * f_sqrt(depth), f_set(0.0f));
        light = v3x_add(light, v3x_scale(v3x_splat(v3_scale(view->sun_rgb, view->sun_glow)), disc));
    }
    out->color[0] = v4x_of3(light, f_set(1.0f));
}

typedef struct planet_star_varyings {
    f32x x, y; /* window coordinates of the star */
    v3x light; /* at its middle */
} planet_star_varyings;

/* A star shines into a disc of some samples, whatever their size: a narrower view shows it brighter, as a telescope. */
AMB_INLINE void planet_star_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const planet_view *view = in->uniforms;
    planet_star_varyings *v = out->varyings;
    v3x d = v3x_gather(view->points->position, in->vertex), flux = v3x_gather(view->points->normal, in->vertex);
    m4 turn = view->world_to_clip;
    f32x x = v3x_dot(d, v3x_splat((v3){turn.row[0].x, turn.row[0].y, turn.row[0].z}));
    f32x y = v3x_dot(d, v3x_splat((v3){turn.row[1].x, turn.row[1].y, turn.row[1].z}));
    f32x w = v3x_dot(d, v3x_splat((v3){turn.row[3].x, turn.row[3].y, turn.row[3].z}));
    float radius = view->star_radius * view->sample_angle * 1000.0f; /* milliradians */
    v->x = (x / w + 1.0f) * (0.5f * view->size.x);
    v->y = (1.0f - y / w) * (0.5f * view->size.y);
    v->light = v3x_scale(flux, f_set(view->star_gain / (AMB_PI * radius * radius)));
    out->clip = (v4x){x, y, w * 0.5f, w};
}

AMB_INLINE void planet_star_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_view *view = in->uniforms;
    const planet_star_varyings *v = in->varyings;
    f32x dx = in->x - v->x, dy = in->y - v->y;
    f32x spot = f_exp((dx * dx + dy * dy) * (-1.0f / (view->star_radius * view->star_radius)));
    out->color[0] = v4x_of3(v3x_scale(v->light, spot), f_set(0.0f));
}

/* Only colour is written. */
static const planet_sky planet_sky_of_stars = {
    .background = {.label = "sky",
                   .lanes = AMB_LANES,
                   .fragment = planet_background,
                   .depth_compare = AMB_ALWAYS,
                   .depth_write_off = true,
                   .targets_off = ~1u},
    .points = {.label = "stars",
               .lanes = AMB_LANES,
               .vertex = planet_star_vertex,
               .fragment = planet_star_fragment,
               .varying_floats = sizeof(planet_star_varyings) / sizeof(f32x),
               .topology = AMB_POINTS,
               .depth_compare = AMB_ALWAYS,
               .depth_write_off = true,
               .blend = {AMB_BLEND_ADD},
               .targets_off = ~1u},
};

/* A draw of one shell; the caller sets shaders' uniforms, blending and what differs. */
AMB_INLINE amb_draw planet_shell_draw(const char *label, amb_vertex_shader vertex, amb_fragment_shader fragment,
                                      const planet_view *view, size_t uniforms_size)
{
    return (amb_draw){.label = label,
                      .lanes = AMB_LANES,
                      .vertex = vertex,
                      .fragment = fragment,
                      .uniforms = view,
                      .uniforms_size = uniforms_size,
                      .varying_floats = sizeof(planet_varyings) / sizeof(f32x),
                      .indices = view->sphere->index,
                      .count = view->sphere->triangle_count * 3,
                      .vertex_count = view->sphere->vertex_count,
                      .cull = AMB_CULL_BACK};
}

#endif
