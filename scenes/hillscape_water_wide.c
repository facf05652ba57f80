/* Scene hillscape: the water. The same hull as the hills'; the domain adds the waves; the fragment mirrors the scene by
 * Fresnel's share over what the depth leaves of the ground, with foam where it meets the land. */
#include "scenes/hillscape_shade.h"

static void water_hull(const amb_hs_in *in, amb_hs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    v2x c[4];
    for (int i = 0; i < 4; i++)
        c[i] = v2x_gather(f->state->water_corner, in->corner[i]);
    float most = amb_s_min(f->p.tess_max * 2.0f, amb_s_min(pass->tess_limit, 64.0f));
    float least = amb_s_min(f->p.tess_min, most);
    static const int ends[4][2] = {{0, 3}, {0, 1}, {1, 2}, {3, 2}};
    for (int i = 0; i < 4; i++) {
        v2x middle = v2x_scale(v2x_add(c[ends[i][0]], c[ends[i][1]]), f_set(0.5f));
        out->edge[i] = hill_tessellation(f->camera.position, (v3x){middle.x, f_set(0.0f), middle.y}, least, most);
    }
    v2x centre = v2x_scale(v2x_add(c[0], c[2]), f_set(0.5f));
    f32x inside = hill_tessellation(f->camera.position, (v3x){centre.x, f_set(0.0f), centre.y}, least, most);
    out->inside[0] = out->inside[1] = inside;
    float crest = 4.0f * f->p.wave_height;
    maskx seen = hill_box_seen(pass, (v3x){c[0].x, f_set(-crest), c[0].y}, (v3x){c[2].x, f_set(crest), c[2].y});
    out->edge[0] = f_sel(seen, out->edge[0], f_set(0.0f));
}

typedef struct water_varyings {
    v3x world;
    f32x factor;
} water_varyings;

static void water_domain(const amb_ds_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    water_varyings *v = out->varyings;
    v2x from = v2x_gather(f->state->water_corner, in->corner[0]),
        to = v2x_gather(f->state->water_corner, in->corner[2]);
    v2x place = {f_lerp(from.x, to.x, in->u), f_lerp(from.y, to.y, in->v)};
    f32x dx = place.x - f->camera.position.x, dz = place.y - f->camera.position.z;
    f32x spacing = 0.5f + f_sqrt(dx * dx + dz * dz) * (1.0f / 60.0f);
    v->world = (v3x){place.x, waves_at(&f->waves, place, spacing).height, place.y};
    v->factor = hill_tessellation(f->camera.position, v->world, f->p.tess_min, f->p.tess_max);
    out->clip = m4_project_x(pass->world_to_clip, v->world);
}

/* What the water mirrors: the scene's mirror image where the ray keeps near it, else the sky. */
static v3x mirrored(const hill_pass *pass, const hill_surface *s, v3x direction, f32x spread)
{
    const hill_frame *f = pass->frame;
    f32x lod = f_clamp(2.0f + spread * 14.0f, f_set(0.0f), f_set(6.0f));
    v3x up = {direction.x, f_abs(direction.y), direction.z};
    if (!f->mirror)
        return hill_panorama_at(f, up, lod);
    /* Where the mirrored ray of a flat sea would meet the picture, moved by the waves' tilt. */
    f32x reach = f_min(s->distance * 0.35f, f_set(60.0f));
    v3x level = {s->world.x + s->normal.x * reach, f_set(0.0f), s->world.z + s->normal.z * reach};
    v4x clip = m4_project_x(f->camera.world_to_clip, level);
    f32x w = 1.0f / f_max(clip.w, f_set(1.0e-3f));
    v2x uv = {clip.x * w * 0.5f + 0.5f, 0.5f - clip.y * w * 0.5f};
    f32x shift = s->normal.y * s->normal.y;
    uv.y = uv.y + (1.0f - shift) * 0.02f;
    static const amb_sampler sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_MIRROR, AMB_MIRROR, AMB_CLAMP}};
    return v4x_xyz(
        amb_sample_2d_lod(f->mirror, &sampler, uv, f_clamp(spread * 18.0f - 0.5f, f_set(0.0f), f_set(4.0f))));
}

static const amb_sampler foam_sampler = {.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_REPEAT, AMB_REPEAT}};

/* White water along the shore, coming and going. */
static f32x foam_at(const hill_frame *f, const hill_surface *s, f32x depth, float time)
{
    v2x a = {s->world.x * 0.11f + time * 0.011f, s->world.z * 0.11f},
        b = {s->world.x * 0.047f, s->world.z * 0.047f - time * 0.008f};
    f32x n = amb_sample_2d(f->state->noise, &foam_sampler, a).z, m = amb_sample_2d(f->state->noise, &foam_sampler, b).w;
    f32x swell = f_sin(depth * 7.0f - time * 1.1f + m * 17.0f) * 0.5f + 0.5f;
    f32x line = f_smoothstep(f_set(0.55f), f_set(0.0f), depth) * swell;
    f32x edge = f_smoothstep(f_set(0.10f), f_set(0.01f), depth);
    return f_saturate(f_smoothstep(f_set(0.52f), f_set(0.80f), n * 0.75f + line * 0.38f) * line * 0.8f +
                      edge * n * 0.6f);
}

static void water_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const water_varyings *v = in->varyings;
    hill_surface s = hill_surface_at(pass, v->world);
    v2x place = {s.world.x, s.world.z};
    f32x footprint = s.distance * f->pixel / f_max(s.to_eye.y, f_set(0.04f)) * 0.9f;
    amb_wave wave = waves_at(&f->waves, place, footprint);
    /* Gusts: calm and ruffled patches. */
    v2x drift = {place.x * 0.0043f - f->seconds * 0.004f, place.y * 0.0061f};
    f32x gust = 0.30f + 1.3f * amb_sample_2d(f->state->noise, &foam_sampler, drift).x;
    wave.slope = v2x_scale(wave.slope, gust);
    wave.roughness *= gust * gust;
    s.normal = v3x_normalize((v3x){-wave.slope.x, f_set(1.0f), -wave.slope.y});
    /* Waves that face away are hidden behind others: the seen ones lean to the eye. */
    f32x away = f_max(0.02f - v3x_dot(s.normal, s.to_eye), f_set(0.0f));
    s.normal = v3x_normalize(v3x_add(s.normal, v3x_scale(s.to_eye, away)));
    s.smooth = (v3x){f_set(0.0f), f_set(1.0f), f_set(0.0f)};
    f32x spread = f_sqrt(wave.roughness);
    s.roughness = f_clamp(0.045f + spread, f_set(0.045f), f_set(0.5f));
    s.f0 = f_set(0.02f);
    v2x uv = hill_uv(place);
    maskx mapped = (uv.x > 0.0f) & (uv.x < 1.0f) & (uv.y > 0.0f) & (uv.y < 1.0f);
    f32x depth = f_max(s.world.y - hill_ground(f, place, f_set(0.0f)), f_set(0.0f));
    depth = f_sel(mapped, depth, f_set(60.0f));

    v3x direction = v3x_sub(v3x_scale(s.normal, 2.0f * v3x_dot(s.normal, s.to_eye)), s.to_eye);
    f32x fresnel = fresnel_dielectric(v3x_dot(s.normal, s.to_eye), 1.333f) / (1.0f + 2.0f * spread);
    v3x reflection = v3x_scale(mirrored(pass, &s, direction, spread), fresnel);
    s.albedo = v3x_splat((v3){0.7f, 0.72f, 0.74f});
    hill_light(pass, &s, in->live);

    /* The water's own light: the sky's and the sun's, scattered back blue-green. */
    f32x way = depth * (1.0f + 1.0f / f_max(s.to_eye.y * 0.7f + 0.45f, f_set(0.3f)));
    f32x seen = f_exp(-hill_water_absorption.y * way);
    v3x within =
        v3x_mul(v3x_splat((v3){0.010f, 0.040f, 0.047f}), v3x_add(s.ambient, v3x_scale(s.diffuse, f_set(0.6f))));
    v3x light = v3x_add(v3x_scale(within, (1.0f - fresnel) * (1.0f - seen)), s.specular);
    f32x foam = foam_at(f, &s, depth, f->seconds);
    light = v3x_lerp(light, v3x_mul(s.albedo, v3x_add(s.diffuse, s.ambient)), foam);
    reflection = v3x_scale(reflection, 1.0f - foam);
    fresnel = fresnel * (1.0f - foam);
    f32x alpha = f_lerp(1.0f - (1.0f - fresnel) * seen, f_set(1.0f), foam);

    hill_put3(pass, out, HILL_REFLECTION, reflection);
    hill_put1(pass, out, HILL_TESSELLATION, v->factor);
    hill_write(pass, out, &s, light, ID_WATER);
    if (pass->color_off)
        return;
    /* The ground below and what was mirrored have gone through the air already; the rest does now. */
    hill_air air = hill_air_along(pass, v3x_neg(s.to_eye), s.distance);
    if (!f->mirror)
        reflection = v3x_add(v3x_scale(reflection, air.left), v3x_scale(air.added, fresnel));
    v3x seen_light = v3x_add(v3x_scale(light, air.left), v3x_scale(air.added, alpha - fresnel));
    out->color[0] = v4x_of3(v3x_add(seen_light, reflection), alpha);
}

amb_status hill_draw_water(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    const hill_frame *f = pass->frame;
    if (!f->p.water)
        return AMB_OK;
    amb_draw draw = hill_draw_of(pass, "water");
    draw.topology = AMB_PATCHES;
    draw.tessellation = (amb_tessellation){.hull = water_hull,
                                           .domain = water_domain,
                                           .corners = 4,
                                           .shape = AMB_QUAD,
                                           .partitioning = (amb_partitioning)f->p.partitioning};
    draw.fragment = water_fragment;
    draw.varying_floats = sizeof(water_varyings) / sizeof(f32x);
    draw.indices = f->state->water_patch;
    draw.count = 4 * WATER_CELLS * WATER_CELLS;
    draw.vertex_count = (WATER_CELLS + 1) * (WATER_CELLS + 1);
    draw.wireframe = f->p.wireframe;
    if (!pass->color_off) {
        draw.blend[0] = AMB_BLEND_EQUATION;
        draw.equation[0] = (amb_blend_equation){AMB_FACTOR_ONE, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA,
                                                AMB_FACTOR_ONE, AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA,
                                                AMB_BLEND_SUM,  AMB_BLEND_SUM};
    }
    return amb_pass_draw(out, &draw, error);
}
