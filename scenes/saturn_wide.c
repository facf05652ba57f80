/* Scene saturn: an oblate planet and its rings, each in the shadow of the other. */
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_saturn);

typedef struct saturn_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, ring_brightness, ring_shadow, shadow_sharpness;
    int show_rings;
} saturn_params;

static const amb_param saturn_table[] = {
    PLANET_PARAM_ROWS(saturn_params, -66, 14, 0, 120, 22),
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
};
static const amb_aov saturn_aovs[] = {PLANET_AOV_ROWS};

typedef struct saturn_state {
    planet_state planet;
    const amb_texture *colour, *rings, *scatter;
} saturn_state;

static void saturn_unload(void *opaque)
{
    saturn_state *state = opaque;
    planet_unload(&state->planet);
    free(state);
}

static amb_status saturn_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    saturn_state *s = calloc(1, sizeof *s);
    *out = NULL;
    (void)context;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene saturn");
    const planet_map_name maps[] = {
        {"saturn/color", &s->colour}, {"saturn/rings", &s->rings}, {"saturn/scatter", &s->scatter}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    if (status != AMB_OK) {
        saturn_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

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

const planet_body WIDE(planet_saturn) = {saturn_load, saturn_unload, saturn_draw};

static const amb_camera_key saturn_keys[] = {
    {0.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},    {10.0f, {2.0f, 0.7f, 4.9f}, {0, 0, 0}, {0, 1, 0}},
    {20.0f, {4.2f, -0.5f, 2.2f}, {0.2f, 0, 0}, {0, 1, 0}}, {30.0f, {0.9f, -1.2f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight saturn_flight = {saturn_keys, sizeof saturn_keys / sizeof *saturn_keys, 40.0f};

static amb_status saturn_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_saturn), saturn_aovs, PLANET_AOVS, &saturn_flight, planet_background_draw, state,
                        job, error);
}

const amb_scene WIDE(amb_scene_saturn) = {
    .name = "saturn",
    .about = "an oblate planet and its rings, each in the shadow of the other",
    .seconds = 40.0f,
    .params = {saturn_table, sizeof saturn_table / sizeof *saturn_table, sizeof(saturn_params)},
    .aovs = saturn_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = saturn_load,
    .frame = saturn_frame,
    .unload = saturn_unload,
};
