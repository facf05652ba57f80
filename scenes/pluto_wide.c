/* Scene pluto: shining ice and a faint icy air. */
#include "scenes/planet_airy_wide.h"

extern const planet_body WIDE(planet_pluto);

static const amb_param pluto_table[] = {
    PLANET_PARAM_ROWS(airy_params, -86, 14, 70, 400, -20, 1.05f),
    PLANET_SURFACE_ROWS(airy_params, 0.12f, 0.8f, 0.85f, 0.92f, 1.0f, 0, 4, 0.8f, 0, 0.5f),
    PLANET_AIR_ROWS(airy_params, 0.05f, 0.012f, 0.020f, 0.034f, 0.060f, 0.01f, 0.55f, 0.8f, 0.92f, 1.0f, 0.5f, 0.7f),
    AIRY_ROW,
    PLANET_SHOW_ROW(airy_params),
};

const planet_body WIDE(planet_pluto) = {
    .name = "pluto",
    .state_bytes = sizeof(airy_state),
    .map = {{"pluto/color", offsetof(airy_state, colour)}, {"pluto/gloss", offsetof(airy_state, gloss)}},
    .made = {{.offset = offsetof(airy_state, made_relief),
              .from = offsetof(airy_state, colour),
              .relief = {.strength = 3.0f, .octaves = 4, .gain = 1.2f, .wrap_u = true, .longitude_latitude = true}}},
    .draw = airy_draw,
    .sky = &planet_sky_of_stars,
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_ball,
};

static amb_status pluto_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_pluto), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_pluto) = {
    .name = "pluto",
    .about = "shining ice and a faint icy air",
    .seconds = 40.0f,
    .params = {pluto_table, sizeof pluto_table / sizeof *pluto_table, sizeof(airy_params)},
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = pluto_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
