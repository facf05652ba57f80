/* Scene neptune: a deep blue planet with a dark spot and bright cirrus. */
#include "scenes/planet_surface_wide.h"

extern const planet_body WIDE(planet_neptune);

typedef struct neptune_params {
    planet_params planet;
    planet_surface_params surface;
} neptune_params;

static const amb_param neptune_table[] = {
    PLANET_PARAM_ROWS(neptune_params, -84, 10, 90, 160, 28, 1.5f),
    PLANET_SURFACE_ROWS(neptune_params, 0.18f, 0.85f, 0.60f, 0.80f, 1.0f, 0.6f, 2.4f, 0, 0, 0),
    PLANET_SHOW_ROW(neptune_params),
};
static const amb_aov neptune_aovs[] = {PLANET_AOV_ROWS};

typedef struct neptune_state {
    planet_state planet;
    const amb_texture *colour;
} neptune_state;

static amb_status neptune_draw(const void *opaque, const void *params, const planet_view *view, double time,
                               amb_pass *pass, amb_error *error)
{
    const neptune_state *s = opaque;
    const neptune_params *p = params;
    planet_surface surface = {.view = *view, .look = p->surface, .colour = s->colour};
    (void)time;
    amb_draw draw = planet_surface_draw(&surface);
    return amb_pass_draw(pass, &draw, error);
}

const planet_body WIDE(planet_neptune) = {
    .name = "neptune",
    .state_bytes = sizeof(neptune_state),
    .map = {{"neptune/color", offsetof(neptune_state, colour)}},
    .draw = neptune_draw,
    .sky = &planet_sky_of_stars,
    .aovs = neptune_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_ball,
};

static amb_status neptune_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_neptune), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_neptune) = {
    .name = "neptune",
    .about = "a deep blue planet with a dark spot and bright cirrus",
    .seconds = 40.0f,
    .params = {neptune_table, sizeof neptune_table / sizeof *neptune_table, sizeof(neptune_params)},
    .aovs = neptune_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = neptune_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
