/* Scene hillscape: how a surface is lit, what air and water do to its light, and where the result goes. Lanes; included
 * by the scene's *_wide.c files. */
#ifndef AMB_SCENES_HILLSCAPE_SHADE_H
#define AMB_SCENES_HILLSCAPE_SHADE_H

#include "scenes/hillscape.h"
#include "shade/fog.h"

typedef struct hill_surface {
    v3x world, to_eye;
    f32x distance;
    v3x smooth, normal; /* of the form; with its relief */
    v3x albedo;
    f32x roughness, f0, open; /* open: share of the sky that is seen */
    f32x lift;    /* where shadows are looked up, from here towards the light: flat pictures of round things */
    f32x through; /* light from behind that thin leaves let through, a share of the diffuse */
    v3x diffuse, specular, ambient; /* light on white; highlights; the sky's */
    f32x shadow[HILL_LIGHTS];
} hill_surface;

AMB_INLINE hill_surface hill_surface_at(const hill_pass *pass, v3x world)
{
    hill_surface s;
    memset(&s, 0, sizeof s);
    v3x way = v3x_sub(v3x_splat(pass->from), world);
    s.world = world;
    s.distance = f_max(v3x_length(way), f_set(1.0e-3f));
    s.to_eye = v3x_scale(way, 1.0f / s.distance);
    s.open = f_set(1.0f);
    for (int i = 0; i < HILL_LIGHTS; i++)
        s.shadow[i] = f_set(1.0f);
    return s;
}

static const amb_sampler hill_noise_sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_REPEAT, AMB_REPEAT}};

/* The two scales of noise that vary the ground: fine (48 m) and broad (320 m) a tile. */
AMB_INLINE v4x hill_fine_noise(const hill_frame *f, v3x world)
{
    return amb_sample_2d(f->state->noise, &hill_noise_sampler, (v2x){world.x * 0.021f, world.z * 0.021f});
}
AMB_INLINE v4x hill_broad_noise(const hill_frame *f, v3x world)
{
    return amb_sample_2d(f->state->noise, &hill_noise_sampler, (v2x){world.x * 0.0031f, world.z * 0.0031f});
}

/* Grass from green to dry, by place. */
AMB_INLINE v3x hill_meadow_tint_of(v4x fine, v4x broad, f32x grass)
{
    f32x dry = f_saturate((broad.z - 0.5f) * 2.6f + (fine.w - 0.5f) * 1.2f + 0.45f) * grass;
    v3x tint = v3x_lerp(v3x_splat((v3){1, 1, 1}), v3x_splat((v3){1.75f, 1.28f, 0.75f}), dry * 0.8f);
    return v3x_scale(tint, 0.72f + 0.56f * fine.y);
}
AMB_INLINE v3x hill_meadow_tint(const hill_frame *f, v3x world, f32x grass)
{
    return hill_meadow_tint_of(hill_fine_noise(f, world), hill_broad_noise(f, world), grass);
}

/* Light of the sky and what the ground throws back, on white. */
AMB_INLINE v3x hill_sky_light(const hill_frame *f, v3x normal, f32x open)
{
    f32x up = normal.y * 0.5f + 0.5f;
    v3x light = v3x_lerp(v3x_splat(f->sky_light[1]), v3x_splat(f->sky_light[0]), up);
    return v3x_scale(light, open);
}

/* All lights on the surface: fills diffuse, specular, ambient and shadow. */
AMB_INLINE void hill_light(const hill_pass *pass, hill_surface *s, maskx live)
{
    const hill_frame *f = pass->frame;
    f32x zero = f_set(0.0f);
    s->ambient = hill_sky_light(f, s->normal, s->open);
    s->diffuse = s->specular = (v3x){zero, zero, zero};
    f32x gloss = 2.0f / f_max(s->roughness * s->roughness, f_set(1.0e-3f)); /* Blinn's exponent of slope m: 2/m² - 2 */
    for (int i = 0; i < HILL_LIGHTS; i++) {
        if (!f->light_on[i])
            continue;
        amb_arriving a = light_at(&f->light[i], s->world);
        f32x facing = v3x_dot(s->normal, a.to_light);
        maskx reached = live & (a.strength > 0.0f) & ((facing > 0.0f) | (s->through > 0.0f));
        if (!m_any(reached))
            continue;
        v3x from = v3x_add(s->world, v3x_scale(a.to_light, s->lift));
        f32x lit = shadow_at(&f->shadow[i], from, s->smooth, reached);
        s->shadow[i] = f_sel(reached, lit, f_set(1.0f)); /* other lanes' value would depend on these */
        amb_response r;
        if (f->p.brdf == BRDF_COOK_TORRANCE)
            r = light_cook_torrance(s->normal, a.to_light, s->to_eye, s->roughness, s->f0);
        else
            r = light_blinn_phong(s->normal, a.to_light, s->to_eye, gloss, s->f0 * 3.0f);
        r.diffuse += s->through * f_saturate(0.35f - 0.65f * facing);
        f32x strength = f_sel(reached, a.strength * s->shadow[i], zero);
        v3x rgb = v3x_splat(f->light[i].rgb);
        s->diffuse = v3x_add(s->diffuse, v3x_scale(rgb, strength * r.diffuse));
        s->specular = v3x_add(s->specular, v3x_scale(rgb, strength * r.specular));
    }
}

AMB_INLINE v3x hill_lit(const hill_surface *s)
{
    return v3x_add(v3x_mul(s->albedo, v3x_add(s->diffuse, s->ambient)), s->specular);
}

/* Absorption of the water, a metre: the red goes first. Depth of clear coastal water. */
static const v3 hill_water_absorption = {0.42f, 0.13f, 0.10f};

/* What reaches the surface of the water from a point under it; the water's own light is added with the water. */
AMB_INLINE v3x hill_under_water(const hill_frame *f, const hill_surface *s)
{
    v3x lit = hill_lit(s);
    if (!f->p.water)
        return lit;
    f32x depth = f_max(-s->world.y, f_set(0.0f));
    f32x way = depth * (1.0f + 1.0f / f_max(s->to_eye.y * 0.7f + 0.45f, f_set(0.3f)));
    /* the green is the share that the water's alpha stands for */
    f32x r = f_exp(-(hill_water_absorption.x - hill_water_absorption.y) * way);
    f32x b = f_exp((hill_water_absorption.y - hill_water_absorption.z) * f_min(way, f_set(8.0f)));
    return (v3x){lit.x * r, lit.y, lit.z * b};
}

/* What the air between leaves, and what it adds: haze that thins out upwards, lit by the sky, and around the sun by it.
 */
typedef struct hill_air {
    f32x left;
    v3x added;
} hill_air;
AMB_INLINE hill_air hill_air_along(const hill_pass *pass, v3x direction, f32x distance)
{
    const hill_frame *f = pass->frame;
    const float density = 0.00017f, falloff = 1.0f / 140.0f;
    f32x height = f_set(amb_s_max(pass->from.y, 0.0f)); /* a mirrored ray counts from the water on */
    f32x depth = fog_depth(height, direction.y, distance, density * f->p.haze, falloff);
    f32x left = f_exp(-depth);
    f32x sunward = f_saturate(v3x_dot(direction, v3x_splat(f->sky.to_sun)));
    f32x glow = sunward * sunward;
    glow = glow * glow;
    glow = glow * glow * 0.35f;
    v3x level =
        v3x_scale(sky_horizon_rgb(&f->sky, (v3x){direction.x, f_set(0.0f), direction.z}), f_set(f->gain * 0.42f));
    f32x grey = color_luminance(level); /* light of many paths has lost some of its colour */
    level = v3x_lerp(level, (v3x){grey, grey, grey}, f_set(0.4f));
    v3x colour =
        v3x_add(v3x_add(v3x_splat(f->haze_rgb), level), v3x_scale(v3x_splat(f->light[LIGHT_SUN].rgb), glow * 0.15f));
    colour = v3x_mul(colour, v3x_splat((v3){0.78f, 0.93f, 1.14f})); /* small particles scatter blue most */
    return (hill_air){left, v3x_scale(colour, 1.0f - left)};
}

AMB_INLINE v3x hill_hazed(const hill_air *air, v3x light) { return v3x_add(v3x_scale(light, air->left), air->added); }

/* ---- results ------------------------------------------------------------------------------------------------------
 */

AMB_INLINE void hill_put(const hill_pass *pass, amb_fs_out *out, int aov, v4x value)
{
    if (pass->slot[aov])
        out->color[pass->slot[aov] - 1 + (pass->color_off ? 0 : 1)] = value;
}
AMB_INLINE void hill_put3(const hill_pass *pass, amb_fs_out *out, int aov, v3x value)
{
    hill_put(pass, out, aov, v4x_of3(value, f_set(1.0f)));
}
AMB_INLINE void hill_put1(const hill_pass *pass, amb_fs_out *out, int aov, f32x value)
{
    hill_put(pass, out, aov, (v4x){value, value, value, f_set(1.0f)});
}

/* Everything known about an opaque surface, seen through the air. */
AMB_INLINE void hill_write(const hill_pass *pass, amb_fs_out *out, const hill_surface *s, v3x lit, int id)
{
    hill_air air = hill_air_along(pass, v3x_neg(s->to_eye), s->distance);
    if (!pass->color_off) {
        out->color[0] = v4x_of3(hill_hazed(&air, lit), f_set(1.0f));
        return;
    }
    hill_put3(pass, out, HILL_POSITION, s->world);
    hill_put3(pass, out, HILL_NORMAL, s->normal);
    hill_put3(pass, out, HILL_ALBEDO, s->albedo);
    hill_put1(pass, out, HILL_ID, f_set((float)id));
    hill_put(pass, out, HILL_SHADOW, (v4x){s->shadow[0], s->shadow[1], s->shadow[2], s->shadow[3]});
    hill_put1(pass, out, HILL_ROUGHNESS, s->roughness);
    hill_put3(pass, out, HILL_AMBIENT, s->ambient);
    hill_put1(pass, out, HILL_HAZE, air.left);
}

/* The state that most draws share. */
AMB_INLINE amb_draw hill_draw_of(const hill_pass *pass, const char *label)
{
    return (amb_draw){.label = label,
                      .lanes = AMB_LANES,
                      .uniforms = pass,
                      .uniforms_size = sizeof *pass,
                      .depth_clamp = pass->depth_clamp,
                      .depth_bias_slope = pass->depth_only ? 1.5f : 0.0f};
}

/* ---- the sky ------------------------------------------------------------------------------------------------------
 */

#define HILL_PANORAMA_RANGE 1.0625f

static const amb_sampler hill_panorama_sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP, AMB_CLAMP}};

/* The painted sky in a direction, lod levels blurred; below the horizon that of the horizon. */
AMB_INLINE v3x hill_panorama_at(const hill_frame *f, v3x direction, f32x lod)
{
    v2x uv = {f_atan2(direction.x, -direction.z) * (0.5f * AMB_INV_PI) + 0.5f,
              (1.0f - f_max(direction.y, f_set(0.002f))) * (1.0f / HILL_PANORAMA_RANGE)};
    return v4x_xyz(amb_sample_2d_lod(f->panorama, &hill_panorama_sampler, uv, lod));
}

#endif
