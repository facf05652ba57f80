/* Scene mars: relief and parallax under thin reddened air. */
#include "scenes/planet_airy_wide.h"

extern const planet_body WIDE(planet_mars);

static const amb_param mars_table[] = {
    PLANET_PARAM_ROWS(airy_params, -86, 10, 120, 246, 25, 1.45f),
    PLANET_SURFACE_ROWS(airy_params, 0.10f, 0.85f, 1.0f, 0.55f, 0.36f, 0, 4, 0.5f, 0.0022f, 0),
    PLANET_AIR_ROWS(airy_params, 0.022f, 0.0050f, 0.030f, 0.034f, 0.045f, 0.075f, 0.62f, 1.0f, 0.62f, 0.40f, 0.8f,
                    0.6f),
    AIRY_ROW,
    PLANET_SHOW_ROW(airy_params),
};

const planet_body WIDE(planet_mars) = {
    .name = "mars",
    .state_bytes = sizeof(airy_state),
    .map = {{"mars/color", offsetof(airy_state, colour)},
            {"mars/height", offsetof(airy_state, height)},
            {"mars/relief", offsetof(airy_state, relief)}},
    .draw = airy_draw,
    .sky = &planet_sky_of_stars,
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_ball,
};

static amb_status mars_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_mars), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_mars) = {
    .name = "mars",
    .about = "relief and parallax under thin reddened air",
    .seconds = 40.0f,
    .params = {mars_table, sizeof mars_table / sizeof *mars_table, sizeof(airy_params)},
    .aovs = airy_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = mars_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
