/* Scene mercury: a cratered sphere under DOT3 bump mapping and contrasted wrapped diffuse, before the stars (Ambiance
 * report, "Mercury", figs. 1 to 6). */
#include "scenes/planet_wide.h"

#include "shade/diffuse.h"

extern const planet_body WIDE(planet_mercury);

enum { SHOW_BEAUTY, SHOW_ALBEDO, SHOW_DIFFUSE, SHOW_NORMALS, SHOW_BUMP };
static const char *const show_names[] = {"beauty", "albedo", "diffuse", "normals", "bump", NULL};

typedef struct mercury_params {
    planet_params planet;
    float wrap, contrast, bump, twilight, sun_size, sun_glow, starlight, fov;
    v3 tint;
    int show, show_planet;
} mercury_params;

#define FIELD(name) offsetof(mercury_params, name)
static const amb_param mercury_table[] = {
    PLANET_PARAM_ROWS(mercury_params, -52.4f, 9.2f, 122, 420, 0.03f, 1.2f),
    {"wrap", AMB_PARAM_FLOAT, "", 0, 1, {0.22f}, NULL, FIELD(wrap), "w of the wrapped diffuse light"},
    {"contrast",
     AMB_PARAM_FLOAT,
     "",
     0.05f,
     4,
     {0.47f},
     NULL,
     FIELD(contrast),
     "its power k; below 1 evens the lit side"},
    {"bump", AMB_PARAM_FLOAT, "", 0, 8, {1}, NULL, FIELD(bump), "strength of the relief; 0: a smooth sphere"},
    {"twilight",
     AMB_PARAM_FLOAT,
     "",
     0.01f,
     1,
     {0.16f},
     NULL,
     FIELD(twilight),
     "how far, as a cosine, slopes past the terminator catch light"},
    {"tint", AMB_PARAM_COLOR, "", 0, 4, {1, 1, 1}, NULL, FIELD(tint), "colour of the sunlight"},
    {"sun_size",
     AMB_PARAM_FLOAT,
     "degrees",
     0,
     20,
     {0.69f},
     NULL,
     FIELD(sun_size),
     "radius of the sun's disc; Mercury sees 0.69 on average"},
    {"sun_glow",
     AMB_PARAM_FLOAT,
     "",
     0,
     10000,
     {40},
     NULL,
     FIELD(sun_glow),
     "radiance of the disc, relative to white that faces the sun"},
    {"starlight", AMB_PARAM_FLOAT, "", 0, 1, {0.0015f}, NULL, FIELD(starlight), "light on the night side"},
    {"fov", AMB_PARAM_FLOAT, "degrees", 5, 120, {36}, NULL, FIELD(fov), "vertical field of view"},
    {"show",
     AMB_PARAM_CHOICE,
     "",
     0,
     0,
     {SHOW_BEAUTY},
     show_names,
     FIELD(show),
     "what the picture shows: all, or one component"},
    {"planet", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, FIELD(show_planet), "draw the planet"},
};
#undef FIELD

enum { MERCURY_DIFFUSE = PLANET_AOVS, MERCURY_BUMP, MERCURY_AOVS };
static const amb_aov mercury_aovs[MERCURY_AOVS] = {
    PLANET_AOV_ROWS,
    {"diffuse", 1, "contrasted wrapped diffuse factor"},
    {"bump", 3, "tangent-space normal: x east, y south, z up"},
};

typedef struct mercury_state {
    planet_state planet;
    const amb_texture *color; /* the resolver's */
    amb_texture *relief;
} mercury_state;

typedef struct mercury_uniforms {
    planet_view view; /* first: the planets' shaders read it */
    const mercury_state *state;
    const mercury_params *params;
} mercury_uniforms;

/* ---- shaders ---------------------------------------------------------------------------------------------------- */

static void mercury_ground(const amb_fs_in *in, amb_fs_out *out)
{
    const mercury_uniforms *u = in->uniforms;
    const mercury_params *k = u->params;
    const planet_varyings *v = in->varyings;
    planet_point p = planet_point_of(&u->view, v->world);
    v3x albedo = v4x_xyz(planet_map(u->state->color, &p));
    v3x m = normal_map_decode(v4x_xyz(planet_map(u->state->relief, &p)), k->bump);

    /* DOT3: the light goes to the normal's space. */
    v3x light = normal_map_to_tangent(v3x_splat(u->view.to_sun), p.east, p.south, p.normal);
    f32x diffuse = diffuse_wrapped_contrast(v3x_dot(m, light), k->wrap, k->contrast);
    /* Slopes beyond the terminator face the sun but lie in the planet's own shadow. */
    diffuse = diffuse * f_smoothstep(f_set(-k->twilight), f_set(k->twilight), light.z);

    v3x lit = v3x_scale(v3x_splat(u->view.sun_rgb), diffuse);
    v3x night = v3x_splat(v3_of(k->starlight, k->starlight, k->starlight));
    v3x color = v3x_mul(albedo, v3x_add(lit, night));
    v3x normal = normal_map_apply(m, p.east, p.south, p.normal), factor = v3x_of(diffuse, diffuse, diffuse);
    switch (k->show) {
    case SHOW_ALBEDO:
        color = albedo;
        break;
    case SHOW_DIFFUSE:
        color = factor;
        break;
    case SHOW_NORMALS:
        color = normal_map_encode(normal);
        break;
    case SHOW_BUMP:
        color = normal_map_encode(m);
        break;
    default:
        break;
    }
    out->color[0] = v4x_of3(color, f_set(1.0f));
    planet_put_surface(&u->view, out, &p, normal, albedo, 1.0f);
    planet_put(&u->view, out, PLANET_LIGHT, lit);
    planet_put(&u->view, out, MERCURY_DIFFUSE, factor);
    planet_put(&u->view, out, MERCURY_BUMP, m);
}

/* ---- scene ------------------------------------------------------------------------------------------------------ */

static amb_status mercury_draw(const void *opaque, const void *params, const planet_view *view, double time,
                               amb_pass *pass, amb_error *error)
{
    const mercury_params *p = params;
    mercury_uniforms u = {.view = *view, .state = opaque, .params = p};
    (void)time;
    u.view.sun_rgb = v3_mul(view->sun_rgb, p->tint);
    amb_draw ground = planet_shell_draw("ground", planet_vertex, mercury_ground, &u.view, sizeof u);
    return p->show_planet ? amb_pass_draw(pass, &ground, error) : AMB_OK;
}

const planet_body WIDE(planet_mercury) = {
    .name = "mercury",
    .state_bytes = sizeof(mercury_state),
    .map = {{"mercury/color", offsetof(mercury_state, color)}},
    .made = {{.offset = offsetof(mercury_state, relief),
              .from = offsetof(mercury_state, color),
              .slope = 0.042f,
              .relief = {.octaves = 5, .gain = 1.25f, .wrap_u = true, .longitude_latitude = true}}},
    .draw = mercury_draw,
};

static amb_status mercury_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_mercury), context, assets, state, error);
}

/* Once around, along the terminator, into the shadow, past sunrise at the limb, and over the full day side. */
static const amb_camera_key mercury_keys[] = {
    {0.0f, {0.29f, 0.34f, 3.29f}, {0.16f, 0.02f, 0.0f}, {0.10f, 1.0f, 0.0f}},
    {9.0f, {1.17f, 0.42f, 2.76f}, {0.26f, 0.04f, 0.0f}, {0.14f, 1.0f, 0.0f}},
    {18.0f, {1.97f, 0.12f, 1.77f}, {0.30f, 0.08f, 0.25f}, {0.16f, 1.0f, 0.0f}},
    {27.0f, {2.77f, -0.35f, 1.01f}, {0.10f, 0.05f, 0.15f}, {0.05f, 1.0f, 0.0f}},
    {36.0f, {3.11f, -0.56f, -1.05f}, {-0.20f, 0.02f, 0.10f}, {0.0f, 1.0f, 0.0f}},
    {43.0f, {2.25f, -0.50f, -2.68f}, {-0.05f, 0.0f, -0.05f}, {0.0f, 1.0f, 0.0f}},
    {50.0f, {0.28f, -0.10f, -3.19f}, {-0.15f, 0.0f, 0.0f}, {-0.06f, 1.0f, 0.0f}},
    {57.0f, {-2.20f, 0.35f, -1.72f}, {-0.10f, 0.0f, 0.10f}, {0.0f, 1.0f, 0.06f}},
    {64.0f, {-2.86f, 0.50f, 1.65f}, {0.0f, 0.0f, 0.10f}, {0.0f, 1.0f, 0.0f}},
    {72.0f, {0.29f, 0.34f, 3.29f}, {0.16f, 0.02f, 0.0f}, {0.10f, 1.0f, 0.0f}},
};

static amb_status mercury_frame(const void *opaque, const amb_scene_job *job, amb_error *error)
{
    const mercury_state *state = opaque;
    const mercury_params *p = job->params;
    amb_canvas canvas;
    amb_status status = canvas_begin(job, mercury_aovs, MERCURY_AOVS, p->planet.samples, &canvas, error);
    if (status != AMB_OK)
        return status;
    planet_flight flight = {mercury_keys, sizeof mercury_keys / sizeof *mercury_keys, p->fov};
    planet_view view = planet_view_at(&state->planet, &p->planet, job, &canvas, &flight);
    float half_sine = amb_sin(0.5f * p->sun_size * (AMB_PI / 180.0f));
    view.sun_size = 1.0f - 2.0f * half_sine * half_sine; /* a cosine that keeps its digits */
    view.sun_glow = p->sun_glow;

    if (p->show == SHOW_BEAUTY)
        status = planet_sky_draw(canvas.pass, &planet_sky_of_stars, &view, error);
    if (status == AMB_OK)
        status = mercury_draw(state, p, &view, job->time, canvas.pass, error);
    return canvas_finish(job, mercury_aovs, &canvas, status, error);
}

const amb_scene WIDE(amb_scene_mercury) = {
    .name = "mercury",
    .about = "craters at the terminator: DOT3 bump, contrasted wrapped diffuse, stars",
    .seconds = 72.0f,
    .params = {mercury_table, sizeof mercury_table / sizeof *mercury_table, sizeof(mercury_params)},
    .aovs = mercury_aovs,
    .aov_count = MERCURY_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = mercury_load,
    .frame = mercury_frame,
    .unload = planet_unload,
};
