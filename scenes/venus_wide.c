/* Scene venus: cloud tops in evened light under a faint blue dome. */
#include "scenes/planet_airy_wide.h"

extern const planet_body WIDE(planet_venus);

static const amb_param venus_table[] = {
    PLANET_PARAM_ROWS(airy_params, -88, 10, 40, 300, 3, 0.95f),
    PLANET_SURFACE_ROWS(airy_params, 0.32f, 0.75f, 1.0f, 0.72f, 0.42f, 0.15f, 3, 0, 0, 0),
    PLANET_AIR_ROWS(airy_params, 0.022f, 0.0045f, 0.02f, 0.035f, 0.075f, 0.02f, 0.70f, 1, 1, 1, 0.25f, 0.45f),
    AIRY_ROW,
    PLANET_SHOW_ROW(airy_params),
};

const planet_body WIDE(planet_venus) = {
    .name = "venus",
    .state_bytes = sizeof(airy_state),
    .map = {{"venus/color", offsetof(airy_state, colour)}, {"venus/surface", offsetof(airy_state, ground)}},
    .draw = airy_draw,
    .sky = &planet_sky_of_stars,
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_ball,
};

static amb_status venus_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_venus), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_venus) = {
    .name = "venus",
    .about = "cloud tops in evened light under a faint blue dome",
    .seconds = 40.0f,
    .params = {venus_table, sizeof venus_table / sizeof *venus_table, sizeof(airy_params)},
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = venus_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
