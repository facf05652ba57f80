/* Scene uranus: a pale planet lying on its side, with thin flat-shaded rings. */
#include "scenes/planet_rings_wide.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_uranus);

typedef struct uranus_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, ring_brightness;
    int show_rings;
} uranus_params;

static const amb_param uranus_table[] = {
    PLANET_PARAM_ROWS(uranus_params, -70, 6, 0, 200, 82),
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
};
static const amb_aov uranus_aovs[] = {PLANET_AOV_ROWS};

typedef struct uranus_state {
    planet_state planet;
    const amb_texture *colour, *rings;
} uranus_state;

static void uranus_unload(void *opaque)
{
    uranus_state *state = opaque;
    planet_unload(&state->planet);
    free(state);
}

static amb_status uranus_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    uranus_state *s = calloc(1, sizeof *s);
    *out = NULL;
    (void)context;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene uranus");
    const planet_map_name maps[] = {{"uranus/color", &s->colour}, {"uranus/rings", &s->rings}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    if (status != AMB_OK) {
        uranus_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

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

const planet_body WIDE(planet_uranus) = {uranus_load, uranus_unload, uranus_draw};

static const amb_camera_key uranus_keys[] = {
    {0.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},    {10.0f, {2.0f, 0.7f, 4.9f}, {0, 0, 0}, {0, 1, 0}},
    {20.0f, {4.2f, -0.5f, 2.2f}, {0.2f, 0, 0}, {0, 1, 0}}, {30.0f, {0.9f, -1.2f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-2.6f, 1.35f, 4.6f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight uranus_flight = {uranus_keys, sizeof uranus_keys / sizeof *uranus_keys, 40.0f};

static amb_status uranus_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_uranus), uranus_aovs, PLANET_AOVS, &uranus_flight, planet_background_draw, state,
                        job, error);
}

const amb_scene WIDE(amb_scene_uranus) = {
    .name = "uranus",
    .about = "a pale planet lying on its side, with thin flat-shaded rings",
    .seconds = 40.0f,
    .params = {uranus_table, sizeof uranus_table / sizeof *uranus_table, sizeof(uranus_params)},
    .aovs = uranus_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = uranus_load,
    .frame = uranus_frame,
    .unload = uranus_unload,
};
