/* Scene earth: day and night, shining oceans, relief, clouds and their shadows, and the air (Ambiance report, Earth).
 */
#include "scenes/planet_air_wide.h"

#include "shade/diffuse.h"
#include "shade/specular.h"

extern const planet_body WIDE(planet_earth);

typedef struct earth_params {
    planet_params planet;
    planet_air_params air;
    float wrap, night, gloss, gloss_exponent, bump, parallax, clouds, cloud_height, cloud_ring, cloud_shadow,
        cloud_bump;
    int show_air;
} earth_params;

#define FIELD(name) offsetof(earth_params, name)
static const amb_param earth_table[] = {
    PLANET_PARAM_ROWS(earth_params, -62, 14, 200, 240, 23.4f, 2.0f),
    PLANET_AIR_ROWS(earth_params, 0.020f, 0.0042f, 0.046f, 0.108f, 0.265f, 0.035f, 0.78f, 1, 1, 1, 0.75f, 1.2f),
    {"wrap", AMB_PARAM_FLOAT, "", 0, 1, {0.06f}, NULL, FIELD(wrap), "w of the ground's wrapped diffuse light"},
    {"night", AMB_PARAM_FLOAT, "", 0, 20, {2.2f}, NULL, FIELD(night), "brightness of the cities at night"},
    {"gloss", AMB_PARAM_FLOAT, "", 0, 10, {0.55f}, NULL, FIELD(gloss), "strength of the oceans' highlight"},
    {"gloss_exponent", AMB_PARAM_FLOAT, "", 1, 1000, {90}, NULL, FIELD(gloss_exponent), "its exponent"},
    {"bump", AMB_PARAM_FLOAT, "", 0, 10, {1.0f}, NULL, FIELD(bump), "strength of the relief; 0: none"},
    {"parallax", AMB_PARAM_FLOAT, "", 0, 0.02f, {0.0016f}, NULL, FIELD(parallax), "height for parallax; 0: none"},
    {"clouds", AMB_PARAM_FLOAT, "", 0, 1, {1}, NULL, FIELD(clouds), "opacity of the clouds; 0: none"},
    {"cloud_height", AMB_PARAM_FLOAT, "radii", 0, 0.1f, {0.0035f}, NULL, FIELD(cloud_height), "of their shell"},
    {"cloud_ring", AMB_PARAM_FLOAT, "", 0.5f, 50, {7}, NULL, FIELD(cloud_ring), "exponent of the ring that fades them"},
    {"cloud_shadow", AMB_PARAM_FLOAT, "", 0, 1, {0.6f}, NULL, FIELD(cloud_shadow), "strength of their shadows"},
    {"cloud_bump", AMB_PARAM_FLOAT, "", 0, 10, {1.0f}, NULL, FIELD(cloud_bump), "strength of their relief"},
    {"air", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, FIELD(show_air), "draw the air"},
    PLANET_SHOW_ROW(earth_params),
};
#undef FIELD

enum { EARTH_DAY = PLANET_AOVS, EARTH_NIGHT, EARTH_GLOSS, EARTH_AOVS };
static const amb_aov earth_aovs[EARTH_AOVS] = {
    PLANET_AOV_ROWS,
    {"day", 3, "sunlit ground"},
    {"night", 3, "city lights"},
    {"gloss", 3, "highlight of the oceans"},
};

typedef struct earth_state {
    planet_state planet;
    const amb_texture *colour, *night, *water, *height, *clouds;
    amb_texture *ground;                /* colour, water in alpha */
    amb_texture *relief, *cloud_relief; /* coded normals, height or cover in alpha */
} earth_state;

typedef struct earth_uniforms {
    planet_air air; /* starts with the view */
    const earth_state *state;
    const earth_params *params;
    float cloud_shell;
} earth_uniforms;

/* ---- shaders ---------------------------------------------------------------------------------------------------- */

/* Share of sunlight that passes the clouds above a point of the ground. */
static f32x under_clouds(const earth_uniforms *u, const planet_point *p, f32x n_dot_l)
{
    const planet_view *view = &u->air.view;
    f32x way = (u->cloud_shell - 1.0f) / f_max(n_dot_l, f_set(0.12f));
    v3x above = v3x_add(p->world, v3x_scale(v3x_splat(view->to_sun), way));
    v2x uv = planet_uv(v3x_normalize(planet_to_own(view, above)));
    f32x cover = planet_map_plain(u->state->cloud_relief, p, uv).w;
    return 1.0f - cover * (u->params->cloud_shadow * u->params->clouds);
}

static void earth_ground(const amb_fs_in *in, amb_fs_out *out)
{
    const earth_uniforms *u = in->uniforms;
    const earth_params *k = u->params;
    const planet_varyings *v = in->varyings;
    const planet_view *view = &u->air.view;
    planet_point p = planet_point_of(view, v->world);
    v3x to_sun = v3x_splat(view->to_sun), none = v3x_splat((v3){0, 0, 0});

    f32x height = planet_map_plain(u->state->relief, &p, p.uv).w;
    v3x eye_tangent = normal_map_to_tangent(p.to_eye, p.east, p.south, p.normal);
    p.uv = parallax_offset(p.uv, eye_tangent, height, k->parallax, 0.0f);
    f32x facing = v3x_dot(p.normal, to_sun), lit = f_set(0.0f), shine = f_set(0.0f);
    v3x albedo = none, normal = p.normal, light = none, gloss = none, night = none;
    maskx is_day = facing > -0.12f; /* elsewhere light and gloss are 0, and the ground is dark */
    if (m_any(is_day) || view->attachments > 1 || view->show != PLANET_SHOW_BEAUTY) {
        v4x ground = planet_map(u->state->ground, &p);
        albedo = v4x_xyz(ground);
        normal = planet_bumped(&p, planet_map(u->state->relief, &p), k->bump);
        lit = diffuse_wrapped(v3x_dot(normal, to_sun), k->wrap) * f_smoothstep(f_set(-0.12f), f_set(0.05f), facing);
        shine = specular_blinn_phong(p.normal, to_sun, p.to_eye, k->gloss_exponent) * ground.w * k->gloss;
    }
    if (m_any(is_day)) {
        v3x sunlight = v3x_mul(v3x_splat(view->sun_rgb), planet_sunlight_at_ground(&u->air.air, facing));
        sunlight = v3x_scale(sunlight, under_clouds(u, &p, facing));
        light = v3x_scale(sunlight, lit);
        gloss = v3x_scale(sunlight, shine);
    }
    if (m_any(facing < 0.0f)) /* elsewhere cities are dark */
        night = v3x_scale(v4x_xyz(planet_map_plain(u->state->night, &p, p.uv)), diffuse_night(facing) * k->night);
    v3x day = v3x_mul(albedo, light);

    planet_put_surface(view, out, &p, normal, albedo, 1.0f);
    planet_put(view, out, PLANET_LIGHT, light);
    planet_put(view, out, EARTH_DAY, day);
    planet_put(view, out, EARTH_NIGHT, night);
    planet_put(view, out, EARTH_GLOSS, gloss);
    out->color[0] = planet_shown(view, v3x_add(v3x_add(day, night), gloss), albedo, normal, light);
}

/* Their alpha is faded by a view-aligned ring, so that they do not cut into the sky dome. */
static void earth_clouds(const amb_fs_in *in, amb_fs_out *out)
{
    const earth_uniforms *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    const planet_view *view = &u->air.view;
    planet_point p = planet_point_of(view, v->world);
    v4x map = planet_map(u->state->cloud_relief, &p);
    f32x ring = view_aligned_ring(v3x_dot(p.normal, p.to_eye), u->params->cloud_ring);
    f32x alpha = f_saturate(map.w - ring) * u->params->clouds;
    if (!m_any(alpha > 0.0f))
        return; /* colour 0, alpha 0: nothing is blended */
    v3x normal = planet_bumped(&p, map, u->params->cloud_bump);
    f32x smooth_n_dot_l = v3x_dot(p.normal, v3x_splat(view->to_sun));
    f32x lit = diffuse_wrapped(v3x_dot(normal, v3x_splat(view->to_sun)), 0.15f) *
               f_smoothstep(f_set(-0.14f), f_set(0.10f), smooth_n_dot_l);
    v3x light = v3x_mul(v3x_splat(view->sun_rgb), planet_sunlight_at_ground(&u->air.air, smooth_n_dot_l));
    out->color[0] = v4x_of3(v3x_scale(light, lit * 0.92f), alpha);
}

/* ---- scene ------------------------------------------------------------------------------------------------------ */

static amb_status earth_draw(const void *opaque, const void *params, const planet_view *from, double time,
                             amb_pass *pass, amb_error *error)
{
    const earth_params *p = params;
    earth_uniforms u = {.state = opaque, .params = p, .cloud_shell = 1.0f + p->cloud_height};
    planet_view *view = &u.air.view;
    (void)time;
    *view = *from;
    u.air.air = planet_atmosphere(&p->air, view->sun_rgb);
    u.air.ground_gain = p->air.ground;
    u.air.dome_gain = p->air.dome;

    amb_draw ground = planet_shell_draw("ground", planet_vertex, earth_ground, view, sizeof u);
    amb_status status = amb_pass_draw(pass, &ground, error);
    view->shell = u.cloud_shell;
    amb_draw clouds = planet_shell_draw("clouds", planet_vertex, earth_clouds, view, sizeof u);
    clouds.blend[0] = AMB_BLEND_ALPHA;
    clouds.depth_write_off = true;
    clouds.targets_off = ~1u;
    if (status == AMB_OK && p->clouds > 0.0f && view->show == PLANET_SHOW_BEAUTY)
        status = amb_pass_draw(pass, &clouds, error);
    if (status == AMB_OK && p->show_air)
        status = planet_air_draw(pass, &u.air, error);
    return status;
}

static const amb_camera_key earth_keys[] = {
    {0.0f, {-0.35f, 0.45f, 2.95f}, {0.0f, 0.0f, 0.0f}, {0, 1, 0}},
    {12.0f, {-2.2f, 0.3f, 1.9f}, {0.0f, 0.0f, 0.0f}, {0, 1, 0}},
    {24.0f, {-1.28f, 0.42f, -0.35f}, {-0.35f, 0.62f, 1.0f}, {-0.5f, 0.85f, 0.0f}},
    {36.0f, {0.4f, 0.55f, -2.7f}, {0.0f, 0.0f, 0.0f}, {0, 1, 0}},
    {48.0f, {2.3f, 0.1f, 1.6f}, {0.0f, 0.0f, 0.0f}, {0, 1, 0}},
    {60.0f, {-0.35f, 0.45f, 2.95f}, {0.0f, 0.0f, 0.0f}, {0, 1, 0}},
};

static const planet_flight earth_flight = {earth_keys, sizeof earth_keys / sizeof *earth_keys, 42.0f};

const planet_body WIDE(planet_earth) = {
    .name = "earth",
    .state_bytes = sizeof(earth_state),
    .map = {{"earth/color", offsetof(earth_state, colour)},
            {"earth/night", offsetof(earth_state, night)},
            {"earth/water", offsetof(earth_state, water)},
            {"earth/height", offsetof(earth_state, height)},
            {"earth/clouds", offsetof(earth_state, clouds)}},
    .made = {{.offset = offsetof(earth_state, ground),
              .from = offsetof(earth_state, colour),
              .alpha = offsetof(earth_state, water)},
             {.offset = offsetof(earth_state, relief),
              .from = offsetof(earth_state, height),
              .relief = {.strength = 6.0f, .octaves = 3, .gain = 1.0f, .wrap_u = true, .longitude_latitude = true}},
             {.offset = offsetof(earth_state, cloud_relief),
              .from = offsetof(earth_state, clouds),
              .relief = {.strength = 2.2f, .octaves = 3, .gain = 1.0f, .wrap_u = true, .longitude_latitude = true}}},
    .draw = earth_draw,
    .sky = &planet_sky_of_stars,
    .aovs = earth_aovs,
    .aov_count = EARTH_AOVS,
    .flight = &earth_flight,
};

static amb_status earth_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_earth), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_earth) = {
    .name = "earth",
    .about = "day and night, oceans, relief, clouds and air",
    .seconds = 60.0f,
    .params = {earth_table, sizeof earth_table / sizeof *earth_table, sizeof(earth_params)},
    .aovs = earth_aovs,
    .aov_count = EARTH_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = earth_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
