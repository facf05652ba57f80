/* Scene sun: an HDR disc of granules with a darkened limb, and a corona; both bloom, and keep their yellow in a fade to
 * black (Ambiance report, fig. 55). */
#include "scenes/planet_wide.h"

#include <ambiance/noise.h>

extern const planet_body WIDE(planet_sun);

typedef struct sun_params {
    planet_params planet;
    float radiance, limb, limb_contrast, corona, corona_reach, streamers, boil;
} sun_params;

#define FIELD(name) offsetof(sun_params, name)
static const amb_param sun_table[] = {
    PLANET_PARAM_ROWS(sun_params, 0, 0, 20, 300, 7, 1.0f),
    {"radiance", AMB_PARAM_FLOAT, "", 0, 1000, {1.5f}, NULL, FIELD(radiance), "of the disc's middle; 1: paper white"},
    {"limb", AMB_PARAM_FLOAT, "", 0, 1, {0.62f}, NULL, FIELD(limb), "u of the limb's darkening 1 - u(1 - cos)"},
    {"limb_contrast", AMB_PARAM_FLOAT, "", 0, 4, {0.6f}, NULL, FIELD(limb_contrast), "how much redder the limb is"},
    {"corona", AMB_PARAM_FLOAT, "", 0, 100, {0.42f}, NULL, FIELD(corona), "radiance of the corona at the limb"},
    {"corona_reach", AMB_PARAM_FLOAT, "radii", 0.01f, 5, {0.24f}, NULL, FIELD(corona_reach), "where it fell to 1/e"},
    {"streamers", AMB_PARAM_FLOAT, "", 0, 1, {0.75f}, NULL, FIELD(streamers), "contrast of the corona's rays"},
    {"boil", AMB_PARAM_FLOAT, "", 0, 10, {1}, NULL, FIELD(boil), "speed of the changing granules and rays"},
    PLANET_SHOW_ROW(sun_params),
};
#undef FIELD
static const amb_aov sun_aovs[] = {PLANET_AOV_ROWS};

typedef struct sun_state {
    planet_state planet;
    const amb_texture *colour;
} sun_state;

typedef struct sun_uniforms {
    planet_view view;
    const sun_params *params;
    const amb_texture *colour;
    float boil_time;
} sun_uniforms;

/* I(µ)/I(1) = 1 - u(1 - µ), stronger in blue than in red (A. S. Eddington's linear law). */
static v3x limb_darkening(const sun_params *p, f32x cosine)
{
    f32x away = 1.0f - f_saturate(cosine);
    v3 strength = {1.0f, 1.0f + 0.35f * p->limb_contrast, 1.0f + 0.8f * p->limb_contrast};
    v3x dark = v3x_scale(v3x_splat(v3_scale(strength, p->limb)), away);
    v3x left = v3x_sub(v3x_splat((v3){1, 1, 1}), dark);
    return v3x_max(left, v3x_splat((v3){0, 0, 0}));
}

static void sun_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const sun_uniforms *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    planet_point p = planet_point_of(&u->view, v->world);
    v3x map = v4x_xyz(planet_map(u->colour, &p));
    v3x cell = v3x_scale(planet_to_own(&u->view, p.normal), f_set(38.0f));
    cell.y = cell.y + u->boil_time;
    f32x boil = noise_gradient3(cell, (amb_lattice){.seed = 901}).value;
    f32x glow = (1.0f + 0.22f * boil) * u->params->radiance;
    v3x light = v3x_mul(v3x_scale(map, glow), limb_darkening(u->params, v3x_dot(p.normal, p.to_eye)));
    planet_put_surface(&u->view, out, &p, p.normal, map, 1.0f);
    planet_put(&u->view, out, PLANET_LIGHT, light);
    out->color[0] = planet_shown(&u->view, light, map, p.normal, light);
}

/* Around the disc: brightness by the ray's closest distance to the centre, rays by the angle around it. */
static void sun_corona(const amb_fs_in *in, amb_fs_out *out)
{
    const sun_uniforms *u = in->uniforms;
    const planet_view *view = &u->view;
    const sun_params *k = u->params;
    v3x ray = v3x_add(v3x_splat(view->ray_origin),
                      v3x_add(v3x_scale(v3x_splat(view->ray_dx), in->x), v3x_scale(v3x_splat(view->ray_dy), in->y)));
    v3x d = v3x_normalize(ray), eye = v3x_splat(view->eye);
    v3x nearest = v3x_sub(eye, v3x_scale(d, v3x_dot(eye, d)));
    f32x radius = v3x_length(nearest);
    v3x around = v3x_scale(planet_to_own(view, nearest), 1.0f / f_max(radius, f_set(1.0e-3f)));
    f32x height = f_max(radius - 1.0f, f_set(0.0f));
    v3x at = v3x_add(v3x_scale(around, f_set(5.0f)), v3x_splat((v3){0, u->boil_time * 0.15f, 0}));
    f32x rays = fbm3(noise_gradient3, at, (amb_lattice){.seed = 902}, (amb_fbm){5, 2.0f, 0.6f}).value;
    f32x equator = 1.0f - 0.45f * around.y * around.y;
    f32x reach = k->corona_reach * equator * f_max(1.0f + k->streamers * 1.6f * rays, f_set(0.15f));
    f32x light = f_exp(-height / reach) * k->corona;
    light = f_sel(v3x_dot(eye, d) < 0.0f, light, f_set(0.0f));
    v3x inner = v3x_splat((v3){1.0f, 0.62f, 0.26f}), outer = v3x_splat((v3){1.0f, 0.36f, 0.10f});
    v3x colour = v3x_lerp(inner, outer, f_saturate(height * 2.2f));
    out->color[0] = v4x_of3(v3x_scale(colour, light), f_set(0.0f));
}

static amb_status sun_draw(const void *opaque, const void *params, const planet_view *view, double time, amb_pass *pass,
                           amb_error *error)
{
    const sun_state *s = opaque;
    const sun_params *p = params;
    sun_uniforms u = {.view = *view,
                      .params = p,
                      .colour = s->colour,
                      .boil_time = planet_loop_time(time * (double)p->boil, 4096.0f)};
    amb_draw corona = {.label = "corona",
                       .lanes = AMB_LANES,
                       .fragment = sun_corona,
                       .uniforms = &u,
                       .uniforms_size = sizeof u,
                       .depth_compare = AMB_ALWAYS,
                       .depth_write_off = true,
                       .targets_off = ~1u};
    corona.blend[0] = AMB_BLEND_ADD;
    bool has_corona = p->corona > 0.0f && view->show == PLANET_SHOW_BEAUTY;
    amb_status status = has_corona ? amb_pass_draw(pass, &corona, error) : AMB_OK;
    amb_draw disc = planet_shell_draw("sun", planet_vertex, sun_fragment, &u.view, sizeof u);
    return status == AMB_OK ? amb_pass_draw(pass, &disc, error) : status;
}

static const amb_camera_key sun_keys[] = {
    {0.0f, {-0.9f, 0.3f, 4.2f}, {0, 0, 0}, {0, 1, 0}},         {10.0f, {1.3f, 0.6f, 3.4f}, {0, 0, 0}, {0, 1, 0}},
    {20.0f, {1.2f, 0.2f, 1.9f}, {-0.35f, 0.1f, 0}, {0, 1, 0}}, {30.0f, {-0.4f, -0.6f, 3.6f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-0.9f, 0.3f, 4.2f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight sun_flight = {sun_keys, sizeof sun_keys / sizeof *sun_keys, 42.0f};

const planet_body WIDE(planet_sun) = {
    .name = "sun",
    .state_bytes = sizeof(sun_state),
    .map = {{"sun/color", offsetof(sun_state, colour)}},
    .draw = sun_draw,
    .sky = &planet_sky_of_stars,
    .aovs = sun_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &sun_flight,
};

static amb_status sun_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_sun), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_sun) = {
    .name = "sun",
    .about = "an HDR disc of granules and its corona",
    .seconds = 40.0f,
    .params = {sun_table, sizeof sun_table / sizeof *sun_table, sizeof(sun_params)},
    .aovs = sun_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.35;display:curve=aces",
    .load = sun_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
