/* Scene uranus: a pale planet lying on its side, with thin flat-shaded rings. */
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"

extern const planet_body WIDE(planet_uranus);

typedef struct uranus_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, ring_brightness;
    int show_rings;
} uranus_params;

static const amb_param uranus_table[] = {
    PLANET_PARAM_ROWS(uranus_params, -70, 6, 0, 200, 82, 1.0f),
    PLANET_SURFACE_ROWS(uranus_params, 0.20f, 0.85f, 0.70f, 0.92f, 1.0f, 0.45f, 2.2f, 0, 0, 0),
    {"oblateness",
     AMB_PARAM_FLOAT,
     "",
     0,
     0.5f,
     {0.023f},
     NULL,
     offsetof(uranus_params, oblateness),
     "how much shorter the axis is"},
    {"ring_brightness",
     AMB_PARAM_FLOAT,
     "",
     0,
     10,
     {0.35f},
     NULL,
     offsetof(uranus_params, ring_brightness),
     "factor on the light of the rings"},
    {"rings", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(uranus_params, show_rings), "draw the rings"},
    PLANET_SHOW_ROW(uranus_params),
};
static const amb_aov uranus_aovs[] = {PLANET_AOV_ROWS};

typedef struct uranus_state {
    planet_state planet;
    const amb_texture *colour, *rings;
} uranus_state;

static amb_status uranus_draw(const void *opaque, const void *params, const planet_view *view, double time,
                              amb_pass *pass, amb_error *error)
{
    const uranus_state *s = opaque;
    const uranus_params *p = params;
    (void)time;
    planet_surface surface = {.view = *view, .look = p->surface, .colour = s->colour};
    surface.view.scale = (v3){1.0f, 1.0f - p->oblateness, 1.0f};
    amb_draw draw = planet_surface_draw(&surface);
    amb_status status = amb_pass_draw(pass, &draw, error);
    planet_rings rings = {
        .view = surface.view, .map = s->rings, .brightness = p->ring_brightness, .shadow_sharpness = 40.0f};
    if (status == AMB_OK && p->show_rings)
        status = planet_rings_draw(pass, &rings, error);
    return status;
}

const planet_body WIDE(planet_uranus) = {
    .name = "uranus",
    .state_bytes = sizeof(uranus_state),
    .map = {{"uranus/color", offsetof(uranus_state, colour)}, {"uranus/rings", offsetof(uranus_state, rings)}},
    .draw = uranus_draw,
    .sky = &planet_sky_of_stars,
    .aovs = uranus_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_rings,
};

static amb_status uranus_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_uranus), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_uranus) = {
    .name = "uranus",
    .about = "a pale planet lying on its side, with thin flat-shaded rings",
    .seconds = 40.0f,
    .params = {uranus_table, sizeof uranus_table / sizeof *uranus_table, sizeof(uranus_params)},
    .aovs = uranus_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = uranus_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
