/* Scene venus: cloud tops in evened light under a faint blue dome. */
#include "scenes/planet_air_wide.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_venus);

typedef struct venus_params {
    planet_params planet;
    planet_surface_params surface;
    planet_air_params air;
    int show_air;
} venus_params;

static const amb_param venus_table[] = {
    PLANET_PARAM_ROWS(venus_params, -88, 10, 40, 300, 3),
    PLANET_SURFACE_ROWS(venus_params, 0.32f, 0.75f, 1.0f, 0.72f, 0.42f, 0.15f, 3, 0, 0, 0),
    PLANET_AIR_ROWS(venus_params, 0.022f, 0.0045f, 0.02f, 0.035f, 0.075f, 0.02f, 0.70f, 1, 1, 1, 0.25f, 0.45f),
    {"air", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(venus_params, show_air), "draw the air"},
};
static const amb_aov venus_aovs[] = {PLANET_AOV_ROWS};

typedef struct venus_state {
    planet_state planet;
    const amb_texture *colour;
} venus_state;

static void venus_unload(void *opaque)
{
    venus_state *state = opaque;
    planet_unload(&state->planet);
    free(state);
}

static amb_status venus_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    venus_state *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene venus");
    const planet_map_name maps[] = {{"venus/color", &s->colour}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    (void)context;
    if (status != AMB_OK) {
        venus_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

static amb_status venus_draw(const void *opaque, const void *params, const planet_view *view, double time,
                             amb_pass *pass, amb_error *error)
{
    const venus_state *s = opaque;
    const venus_params *p = params;
    (void)time;
    planet_surface surface = {.view = *view, .look = p->surface, .colour = s->colour, .detail = s->colour};
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

const planet_body WIDE(planet_venus) = {venus_load, venus_unload, venus_draw};

static const amb_camera_key venus_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight venus_flight = {venus_keys, sizeof venus_keys / sizeof *venus_keys, 40.0f};

static amb_status venus_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_venus), venus_aovs, PLANET_AOVS, &venus_flight, planet_background_draw, state, job,
                        error);
}

const amb_scene WIDE(amb_scene_venus) = {
    .name = "venus",
    .about = "cloud tops in evened light under a faint blue dome",
    .seconds = 40.0f,
    .params = {venus_table, sizeof venus_table / sizeof *venus_table, sizeof(venus_params)},
    .aovs = venus_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = venus_load,
    .frame = venus_frame,
    .unload = venus_unload,
};
