/* Scene mars: relief and parallax under thin reddened air. */
#include "scenes/planet_air_wide.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_mars);

typedef struct mars_params {
    planet_params planet;
    planet_surface_params surface;
    planet_air_params air;
    int show_air;
} mars_params;

static const amb_param mars_table[] = {
    PLANET_PARAM_ROWS(mars_params, -86, 10, 120, 246, 25),
    PLANET_SURFACE_ROWS(mars_params, 0.10f, 0.85f, 1.0f, 0.55f, 0.36f, 0, 4, 0.5f, 0.0022f, 0),
    PLANET_AIR_ROWS(mars_params, 0.022f, 0.0050f, 0.030f, 0.034f, 0.045f, 0.075f, 0.62f, 1.0f, 0.62f, 0.40f, 0.8f,
                    0.6f),
    {"air", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(mars_params, show_air), "draw the air"},
};
static const amb_aov mars_aovs[] = {PLANET_AOV_ROWS};

typedef struct mars_state {
    planet_state planet;
    const amb_texture *colour, *height;
    amb_texture *relief;
} mars_state;

static void mars_unload(void *opaque)
{
    mars_state *state = opaque;
    planet_unload(&state->planet);
    amb_texture_close(&state->relief);
    free(state);
}

static amb_status mars_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    mars_state *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene mars");
    const planet_map_name maps[] = {{"mars/color", &s->colour}, {"mars/height", &s->height}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    const amb_normal_map_options relief = {
        .strength = 16.0f, .octaves = 4, .gain = 1.3f, .wrap_u = true, .longitude_latitude = true};
    if (status == AMB_OK)
        status = planet_normal_texture(context, s->height, &relief, &s->relief, error);
    if (status != AMB_OK) {
        mars_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

static amb_status mars_draw(const void *opaque, const void *params, const planet_view *view, double time,
                            amb_pass *pass, amb_error *error)
{
    const mars_state *s = opaque;
    const mars_params *p = params;
    (void)time;
    planet_surface surface = {
        .view = *view, .look = p->surface, .colour = s->colour, .height = s->height, .relief = s->relief};
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

const planet_body WIDE(planet_mars) = {mars_load, mars_unload, mars_draw};

static const amb_camera_key mars_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight mars_flight = {mars_keys, sizeof mars_keys / sizeof *mars_keys, 40.0f};

static amb_status mars_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_mars), mars_aovs, PLANET_AOVS, &mars_flight, planet_background_draw, state, job,
                        error);
}

const amb_scene WIDE(amb_scene_mars) = {
    .name = "mars",
    .about = "relief and parallax under thin reddened air",
    .seconds = 40.0f,
    .params = {mars_table, sizeof mars_table / sizeof *mars_table, sizeof(mars_params)},
    .aovs = mars_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = mars_load,
    .frame = mars_frame,
    .unload = mars_unload,
};
