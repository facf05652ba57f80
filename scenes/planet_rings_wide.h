/* Rings: a flat annulus of two triangles in the planet's equator, blended over what is behind. */
#ifndef AMB_SCENES_PLANET_RINGS_WIDE_H
#define AMB_SCENES_PLANET_RINGS_WIDE_H

#include "scenes/builtin/rings.h"
#include "scenes/planet_wide.h"
#include "shade/ring.h"

typedef struct planet_rings {
    planet_view view;           /* its `scale` is the planet's, for its shadow */
    const amb_texture *map;     /* tint, opacity by radius */
    const amb_texture *scatter; /* back-, forward- and unlit-scattered intensity in r, g, b; NULL: flat shading */
    float brightness, shadow_sharpness;
    v3 gain; /* factors on the three intensities, to look at one alone; ignored when flat */
} planet_rings;

/* Sunlight that passes the planet on its way to a point of the rings. The spheroid of semi-axes view->scale is the unit
 * sphere of coordinates divided by them, and lines stay lines. */
AMB_INLINE f32x planet_rings_sunlight(const planet_view *view, v3x world, float sharpness)
{
    v3x inverse = v3x_splat((v3){1.0f / view->scale.x, 1.0f / view->scale.y, 1.0f / view->scale.z});
    v3x at = v3x_mul(planet_to_own(view, world), inverse);
    v3x to_sun = v3x_normalize(v3x_mul(planet_to_own(view, v3x_splat(view->to_sun)), inverse));
    return ring_planet_shadow(at, to_sun, 1.0f, sharpness);
}

/* Corners 0 1 2 and 2 1 3 of the square that holds the annulus. */
static void planet_rings_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const planet_rings *u = in->uniforms;
    planet_varyings *v = out->varyings;
    i32x corner = i_sel(in->vertex == 3, i_set(2), i_sel(in->vertex == 4, i_set(1), i_min(in->vertex, i_set(3))));
    f32x x = i_to_f((corner & 1) * 2 - 1) * RINGS_OUTER, z = i_to_f((corner >> 1) * 2 - 1) * RINGS_OUTER;
    v->world = planet_to_world(&u->view, (v3x){x, f_set(0.0f), z});
    out->clip = m4_project_x(u->view.world_to_clip, v->world);
}

static void planet_rings_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_rings *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    const planet_view *view = &u->view;
    static const amb_sampler across = {
        .filter = AMB_TRILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}, .max_anisotropy = 4};
    v3x own = planet_to_own(view, v->world);
    f32x radius = f_sqrt(own.x * own.x + own.z * own.z);
    f32x along = (radius - RINGS_INNER) * (1.0f / (RINGS_OUTER - RINGS_INNER)), none = f_set(0.0f);
    v2x uv = {along, f_set(0.5f)}, dx = {none, none}, dy = {none, none};
#if AMB_LANES > 1
    dx.x = f_ddx(along);
    dy.x = f_ddy(along);
#endif
    v4x map = amb_sample_2d_grad(u->map, &across, uv, dx, dy);

    v3x to_eye = v3x_normalize(v3x_sub(v3x_splat(view->eye), v->world)), to_sun = v3x_splat(view->to_sun);
    f32x light = f_set(u->brightness);
    if (u->scatter) {
        v3x pole = v3x_splat(view->axis[1]);
        maskx lit = v3x_dot(to_eye, pole) * v3x_dot(to_sun, pole) > 0.0f; /* eye and sun on one side of the plane */
        v3x s = v3x_mul(v4x_xyz(amb_sample_2d_grad(u->scatter, &across, uv, dx, dy)), v3x_splat(u->gain));
        light = light * ring_scatter(s.x, f_sel(lit, s.y, s.z), v3x_dot(to_sun, to_eye));
    }
    light = light * planet_rings_sunlight(view, v->world, u->shadow_sharpness);
    v3x sunlight = v3x_scale(v3x_splat(view->sun_rgb), light);
    f32x alpha = f_sel((along > 0.0f) & (along < 1.0f), map.w, none);
    out->live = out->live & (alpha > 0.0f);
    planet_put_surface(view, out, &(planet_point){.world = v->world}, v3x_splat(view->axis[1]), v4x_xyz(map), 2.0f);
    v3x colour = v3x_scale(v3x_mul(v4x_xyz(map), v3x_splat(view->sun_rgb)), light);
    out->color[0] = planet_shown(view, colour, v4x_xyz(map), v3x_splat(view->axis[1]), sunlight);
    out->color[0].w = alpha;
}

AMB_INLINE amb_status planet_rings_draw(amb_pass *pass, const planet_rings *u, amb_error *error)
{
    amb_draw draw = planet_shell_draw("rings", planet_rings_vertex, planet_rings_fragment, &u->view, sizeof *u);
    draw.indices = NULL;
    draw.count = 6;
    draw.vertex_count = 0;
    draw.cull = AMB_CULL_NONE;
    draw.blend[0] = AMB_BLEND_ALPHA;
    return amb_pass_draw(pass, &draw, error);
}

#endif
