/* Scene saturn: an oblate planet and its rings, each in the shadow of the other. */
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"

extern const planet_body WIDE(planet_saturn);

typedef struct saturn_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, ring_brightness, ring_shadow, shadow_sharpness;
    int show_rings;
} saturn_params;

static const amb_param saturn_table[] = {
    PLANET_PARAM_ROWS(saturn_params, -66, 14, 0, 120, 22, 1.0f),
    PLANET_SURFACE_ROWS(saturn_params, 0.18f, 0.85f, 0.66f, 0.82f, 0.78f, 0.5f, 2.4f, 0, 0, 0),
    {"oblateness",
     AMB_PARAM_FLOAT,
     "",
     0,
     0.5f,
     {0.098f},
     NULL,
     offsetof(saturn_params, oblateness),
     "how much shorter the axis is"},
    {"ring_brightness",
     AMB_PARAM_FLOAT,
     "",
     0,
     10,
     {1.6f},
     NULL,
     offsetof(saturn_params, ring_brightness),
     "factor on the light of the rings"},
    {"ring_shadow",
     AMB_PARAM_FLOAT,
     "",
     0,
     1,
     {0.85f},
     NULL,
     offsetof(saturn_params, ring_shadow),
     "strength of their shadow on the planet"},
    {"shadow_sharpness",
     AMB_PARAM_FLOAT,
     "",
     1,
     1000,
     {60},
     NULL,
     offsetof(saturn_params, shadow_sharpness),
     "of the planet's shadow on the rings"},
    {"rings", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(saturn_params, show_rings), "draw the rings"},
    PLANET_SHOW_ROW(saturn_params),
};
static const amb_aov saturn_aovs[] = {PLANET_AOV_ROWS};

typedef struct saturn_state {
    planet_state planet;
    const amb_texture *colour, *rings, *scatter;
} saturn_state;

static amb_status saturn_draw(const void *opaque, const void *params, const planet_view *view, double time,
                              amb_pass *pass, amb_error *error)
{
    const saturn_state *s = opaque;
    const saturn_params *p = params;
    (void)time;
    planet_surface surface = {.view = *view,
                              .look = p->surface,
                              .colour = s->colour,
                              .rings = p->show_rings ? s->rings : NULL,
                              .ring_shadow = p->ring_shadow};
    surface.view.scale = (v3){1.0f, 1.0f - p->oblateness, 1.0f};
    amb_draw draw = planet_surface_draw(&surface);
    amb_status status = amb_pass_draw(pass, &draw, error);
    planet_rings rings = {.view = surface.view,
                          .map = s->rings,
                          .scatter = s->scatter,
                          .brightness = p->ring_brightness,
                          .shadow_sharpness = p->shadow_sharpness,
                          .gain = {1, 1, 1}};
    if (status == AMB_OK && p->show_rings)
        status = planet_rings_draw(pass, &rings, error);
    return status;
}

const planet_body WIDE(planet_saturn) = {
    .name = "saturn",
    .state_bytes = sizeof(saturn_state),
    .map = {{"saturn/color", offsetof(saturn_state, colour)},
            {"saturn/rings", offsetof(saturn_state, rings)},
            {"saturn/scatter", offsetof(saturn_state, scatter)}},
    .draw = saturn_draw,
    .sky = &planet_sky_of_stars,
    .aovs = saturn_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_rings,
};

static amb_status saturn_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_saturn), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_saturn) = {
    .name = "saturn",
    .about = "an oblate planet and its rings, each in the shadow of the other",
    .seconds = 40.0f,
    .params = {saturn_table, sizeof saturn_table / sizeof *saturn_table, sizeof(saturn_params)},
    .aovs = saturn_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = saturn_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
