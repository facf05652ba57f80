/* Scene neptune: a deep blue planet with a dark spot and bright cirrus. */
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_neptune);

typedef struct neptune_params {
    planet_params planet;
    planet_surface_params surface;
} neptune_params;

static const amb_param neptune_table[] = {
    PLANET_PARAM_ROWS(neptune_params, -84, 10, 90, 160, 28),
    PLANET_SURFACE_ROWS(neptune_params, 0.18f, 0.85f, 0.60f, 0.80f, 1.0f, 0.6f, 2.4f, 0, 0, 0),
};
static const amb_aov neptune_aovs[] = {PLANET_AOV_ROWS};

typedef struct neptune_state {
    planet_state planet;
    const amb_texture *colour;
} neptune_state;

static void neptune_unload(void *opaque)
{
    neptune_state *state = opaque;
    planet_unload(&state->planet);
    free(state);
}

static amb_status neptune_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    neptune_state *s = calloc(1, sizeof *s);
    *out = NULL;
    (void)context;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene neptune");
    const planet_map_name maps[] = {{"neptune/color", &s->colour}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    if (status != AMB_OK) {
        neptune_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

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

const planet_body WIDE(planet_neptune) = {neptune_load, neptune_unload, neptune_draw};

static const amb_camera_key neptune_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight neptune_flight = {neptune_keys, sizeof neptune_keys / sizeof *neptune_keys, 40.0f};

static amb_status neptune_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_neptune), neptune_aovs, PLANET_AOVS, &neptune_flight, planet_background_draw,
                        state, job, error);
}

const amb_scene WIDE(amb_scene_neptune) = {
    .name = "neptune",
    .about = "a deep blue planet with a dark spot and bright cirrus",
    .seconds = 40.0f,
    .params = {neptune_table, sizeof neptune_table / sizeof *neptune_table, sizeof(neptune_params)},
    .aovs = neptune_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = neptune_load,
    .frame = neptune_frame,
    .unload = neptune_unload,
};
