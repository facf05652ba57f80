/* Scene pluto: shining ice and a faint icy air. */
#include "scenes/planet_air_wide.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_pluto);

typedef struct pluto_params {
    planet_params planet;
    planet_surface_params surface;
    planet_air_params air;
    int show_air;
} pluto_params;

static const amb_param pluto_table[] = {
    PLANET_PARAM_ROWS(pluto_params, -86, 14, 70, 400, -20),
    PLANET_SURFACE_ROWS(pluto_params, 0.12f, 0.8f, 0.85f, 0.92f, 1.0f, 0, 4, 0.8f, 0, 0.5f),
    PLANET_AIR_ROWS(pluto_params, 0.05f, 0.012f, 0.020f, 0.034f, 0.060f, 0.01f, 0.55f, 0.8f, 0.92f, 1.0f, 0.5f, 0.7f),
    {"air", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(pluto_params, show_air), "draw the air"},
};
static const amb_aov pluto_aovs[] = {PLANET_AOV_ROWS};

typedef struct pluto_state {
    planet_state planet;
    const amb_texture *colour, *gloss;
    amb_texture *relief;
} pluto_state;

static void pluto_unload(void *opaque)
{
    pluto_state *state = opaque;
    planet_unload(&state->planet);
    amb_texture_close(&state->relief);
    free(state);
}

static amb_status pluto_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    pluto_state *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene pluto");
    const planet_map_name maps[] = {{"pluto/color", &s->colour}, {"pluto/gloss", &s->gloss}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    const amb_normal_map_options relief = {
        .strength = 3.0f, .octaves = 4, .gain = 1.2f, .wrap_u = true, .longitude_latitude = true};
    if (status == AMB_OK)
        status = planet_normal_texture(context, s->colour, &relief, &s->relief, error);
    if (status != AMB_OK) {
        pluto_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

static amb_status pluto_draw(const void *opaque, const void *params, const planet_view *view, double time,
                             amb_pass *pass, amb_error *error)
{
    const pluto_state *s = opaque;
    const pluto_params *p = params;
    (void)time;
    planet_surface surface = {
        .view = *view, .look = p->surface, .colour = s->colour, .gloss = s->gloss, .relief = s->relief};
    amb_draw ground = planet_surface_draw(&surface);
    amb_status status = amb_pass_draw(pass, &ground, error);
    planet_air air = {.view = *view,
                      .air = planet_atmosphere(&p->air, view->sun_rgb),
                      .ground_gain = p->air.ground,
                      .dome_gain = p->air.dome};
    if (status == AMB_OK && p->show_air)
        status = planet_air_draw(pass, &air, error);
    return status;
}

const planet_body WIDE(planet_pluto) = {pluto_load, pluto_unload, pluto_draw};

static const amb_camera_key pluto_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight pluto_flight = {pluto_keys, sizeof pluto_keys / sizeof *pluto_keys, 40.0f};

static amb_status pluto_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_pluto), pluto_aovs, PLANET_AOVS, &pluto_flight, planet_background_draw, state, job,
                        error);
}

const amb_scene WIDE(amb_scene_pluto) = {
    .name = "pluto",
    .about = "shining ice and a faint icy air",
    .seconds = 40.0f,
    .params = {pluto_table, sizeof pluto_table / sizeof *pluto_table, sizeof(pluto_params)},
    .aovs = pluto_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = pluto_load,
    .frame = pluto_frame,
    .unload = pluto_unload,
};
