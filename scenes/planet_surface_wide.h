/* The ground, or the cloud tops, that most planets show: a map under contrasted or tinted wrapped light, with relief,
 * ice that shines, a dark edge, and the shadow of rings. Each part is off unless its map or strength is given. */
#ifndef AMB_SCENES_PLANET_SURFACE_WIDE_H
#define AMB_SCENES_PLANET_SURFACE_WIDE_H

#include "scenes/builtin/rings.h"
#include "scenes/planet_wide.h"
#include "shade/color.h"
#include "shade/diffuse.h"
#include "shade/specular.h"

/* Parameters of the surface, a member `surface` of the scene's struct. */
typedef struct planet_surface_params {
    float wrap, contrast; /* of the diffuse light */
    v3 tint;              /* of light in the wrapped zone */
    float edge, edge_power;
    float bump, parallax, gloss, gloss_exponent;
    int flat; /* show the map without light */
} planet_surface_params;
#define PLANET_SURFACE_ROWS(type, w, k, tint_r, tint_g, tint_b, dark, dark_power, relief, shift, shine)             \
    {"wrap", AMB_PARAM_FLOAT, "", 0, 1, {w}, NULL, offsetof(type, surface.wrap), "w of the wrapped diffuse light"}, \
        {"contrast",                                                                                                \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0.05f,                                                                                                     \
         8,                                                                                                         \
         {k},                                                                                                       \
         NULL,                                                                                                      \
         offsetof(type, surface.contrast),                                                                          \
         "its exponent: below 1 evens the lit side"},                                                               \
        {"tint",                                                                                                    \
         AMB_PARAM_COLOR,                                                                                           \
         "",                                                                                                        \
         0,                                                                                                         \
         4,                                                                                                         \
         {tint_r, tint_g, tint_b},                                                                                  \
         NULL,                                                                                                      \
         offsetof(type, surface.tint),                                                                              \
         "colour of light in the wrapped zone"},                                                                    \
        {"edge",                                                                                                    \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0,                                                                                                         \
         1,                                                                                                         \
         {dark},                                                                                                    \
         NULL,                                                                                                      \
         offsetof(type, surface.edge),                                                                              \
         "how dark the edge of the disc is; 0: not"},                                                               \
        {"edge_power",                                                                                              \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0.1f,                                                                                                      \
         20,                                                                                                        \
         {dark_power},                                                                                              \
         NULL,                                                                                                      \
         offsetof(type, surface.edge_power),                                                                        \
         "exponent of the ring that darkens it"},                                                                   \
        {"bump",                                                                                                    \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0,                                                                                                         \
         10,                                                                                                        \
         {relief},                                                                                                  \
         NULL,                                                                                                      \
         offsetof(type, surface.bump),                                                                              \
         "strength of the relief; 0: none"},                                                                        \
        {"parallax",                                                                                                \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0,                                                                                                         \
         0.02f,                                                                                                     \
         {shift},                                                                                                   \
         NULL,                                                                                                      \
         offsetof(type, surface.parallax),                                                                          \
         "height for parallax; 0: none"},                                                                           \
        {"gloss",                                                                                                   \
         AMB_PARAM_FLOAT,                                                                                           \
         "",                                                                                                        \
         0,                                                                                                         \
         10,                                                                                                        \
         {shine},                                                                                                   \
         NULL,                                                                                                      \
         offsetof(type, surface.gloss),                                                                             \
         "strength of the highlight; 0: none"},                                                                     \
        {"gloss_exponent", AMB_PARAM_FLOAT, "", 1, 1000, {24}, NULL, offsetof(type, surface.gloss_exponent),        \
         "its exponent"},                                                                                           \
    {                                                                                                               \
        "flat", AMB_PARAM_BOOL, "", 0, 0, {0}, NULL, offsetof(type, surface.flat), "show the map without light"     \
    }

typedef struct planet_surface {
    planet_view view;
    planet_surface_params look;
    const amb_texture *colour;
    const amb_texture *relief, *height, *gloss; /* NULL: none */
    const amb_texture *ground;                  /* what shimmers through the clouds of `colour`; NULL: nothing */
    float ground_strength;
    bool green_up;            /* the relief's y is coded northward */
    const amb_texture *rings; /* opacity by radius in alpha; NULL: no shadow of rings */
    float ring_shadow;
    /* An animated map: between the key frames `colour` and `next` everything moves along u by the velocity map. */
    const amb_texture *next, *velocity; /* NULL: a still map */
    float blend, drift;                 /* 0…1 from colour to next; u moved by full velocity between two keys */
} planet_surface;

/* Frame A displaced by t, frame B by t - 1, then lerp: features move instead of fading (Ambiance report, Jupiter). */
AMB_INLINE v3x planet_surface_colour(const planet_surface *u, const planet_point *p)
{
    if (!u->next)
        return v4x_xyz(planet_map(u->colour, p));
    f32x velocity = (planet_map(u->velocity, p).x * 255.0f - 128.0f) * (1.0f / 127.0f); /* 128 is still */
    f32x move = velocity * -u->drift, none = f_set(0.0f);
    v4x a = planet_map_at(u->colour, p, (v2x){move * u->blend, none});
    v4x b = planet_map_at(u->next, p, (v2x){move * (u->blend - 1.0f), none});
    return v3x_lerp(v4x_xyz(a), v4x_xyz(b), f_set(u->blend));
}

/* Sunlight that passes the rings on its way to a point of the planet. */
AMB_INLINE f32x planet_under_rings(const planet_surface *u, v3x world)
{
    const planet_view *view = &u->view;
    v3x own = planet_to_own(view, world), to_sun = planet_to_own(view, v3x_splat(view->to_sun));
    f32x way = -own.y / to_sun.y;
    v3x at = v3x_add(own, v3x_scale(to_sun, way));
    f32x radius = f_sqrt(at.x * at.x + at.z * at.z);
    f32x u_map = (radius - RINGS_INNER) * (1.0f / (RINGS_OUTER - RINGS_INNER));
    maskx crosses = (way > 0.0f) & (u_map > 0.0f) & (u_map < 1.0f);
    static const amb_sampler across = {.filter = AMB_TRILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}};
    f32x opacity = amb_sample_2d_lod(u->rings, &across, (v2x){u_map, f_set(0.5f)}, f_set(3.0f)).w;
    return 1.0f - f_sel(crosses, opacity * u->ring_shadow, f_set(0.0f));
}

static void planet_surface_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_surface *u = in->uniforms;
    const planet_surface_params *k = &u->look;
    const planet_varyings *v = in->varyings;
    const planet_view *view = &u->view;
    planet_point p = planet_point_of(view, v->world);
    v3x to_sun = v3x_splat(view->to_sun);
    if (u->height && k->parallax > 0.0f) {
        v3x eye = normal_map_to_tangent(p.to_eye, p.east, p.south, p.normal);
        p.uv = parallax_offset(p.uv, eye, planet_map(u->height, &p).x, k->parallax, 0.0f);
    }
    v3x albedo = planet_surface_colour(u, &p);
    if (u->ground) {
        f32x below = color_luminance(v4x_xyz(planet_map(u->ground, &p)));
        albedo = v3x_scale(albedo, 1.0f + u->ground_strength * (below - 0.3f));
    }
    v3x normal = p.normal;
    if (u->relief) {
        v4x texel = planet_map(u->relief, &p);
        texel.y = u->green_up ? 1.0f - texel.y : texel.y;
        normal = planet_bumped(&p, texel, k->bump);
    }
    f32x n_dot_v = v3x_dot(p.normal, p.to_eye), n_dot_l = v3x_dot(normal, to_sun);

    f32x even = f_pow(diffuse_wrapped(n_dot_l, k->wrap), f_set(k->contrast));
    /* Relief may not light what the planet's own bulk shades. */
    even = even * f_smoothstep(f_set(-k->wrap - 0.1f), f_set(0.06f - k->wrap), v3x_dot(p.normal, to_sun));
    v3x light = v3x_lerp(v3x_splat(k->tint), v3x_splat((v3){1, 1, 1}), diffuse_wrap_depth(n_dot_l, k->wrap + 0.05f));
    light = v3x_mul(v3x_scale(light, even), v3x_splat(view->sun_rgb));
    if (u->rings)
        light = v3x_scale(light, planet_under_rings(u, p.world));
    light = v3x_scale(light, 1.0f - k->edge * view_aligned_ring(n_dot_v, k->edge_power));
    v3x colour = k->flat ? albedo : v3x_mul(albedo, light);
    if (u->gloss && k->gloss > 0.0f && !k->flat) {
        f32x shine = specular_blinn_phong(normal, to_sun, p.to_eye, k->gloss_exponent);
        colour = v3x_add(colour, v3x_scale(light, shine * planet_map(u->gloss, &p).x * k->gloss));
    }
    planet_put_surface(view, out, &p, normal, albedo, 1.0f);
    planet_put(view, out, PLANET_LIGHT, light);
    out->color[0] = planet_shown(view, colour, albedo, normal, light);
}

AMB_INLINE amb_draw planet_surface_draw(const planet_surface *u)
{
    return planet_shell_draw("surface", planet_vertex, planet_surface_fragment, &u->view, sizeof *u);
}

#endif
