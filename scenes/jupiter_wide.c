/* Scene jupiter: bands that drift between key frames, and the Great Red Spot. */
#include "scenes/builtin/giants.h"
#include "scenes/planet_surface_wide.h"

#include <stdlib.h>

extern const planet_body WIDE(planet_jupiter);

typedef struct jupiter_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, key_time;
    int still;
} jupiter_params;

static const amb_param jupiter_table[] = {
    PLANET_PARAM_ROWS(jupiter_params, -82, 8, 115, 120, 3),
    PLANET_SURFACE_ROWS(jupiter_params, 0.16f, 0.80f, 0.62f, 0.80f, 0.58f, 0.55f, 2.6f, 0, 0, 0),
    {"oblateness",
     AMB_PARAM_FLOAT,
     "",
     0,
     0.5f,
     {0.065f},
     NULL,
     offsetof(jupiter_params, oblateness),
     "how much shorter the axis is"},
    {"key_time",
     AMB_PARAM_FLOAT,
     "s",
     0.1f,
     1000,
     {4},
     NULL,
     offsetof(jupiter_params, key_time),
     "from one key frame of the map to the next"},
    {"still", AMB_PARAM_BOOL, "", 0, 0, {0}, NULL, offsetof(jupiter_params, still), "show the first key frame only"},
};
static const amb_aov jupiter_aovs[] = {PLANET_AOV_ROWS};

typedef struct jupiter_state {
    planet_state planet;
    const amb_texture *key[JUPITER_KEYS], *velocity;
} jupiter_state;

static void jupiter_unload(void *opaque)
{
    jupiter_state *state = opaque;
    planet_unload(&state->planet);
    free(state);
}

static amb_status jupiter_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    jupiter_state *s = calloc(1, sizeof *s);
    *out = NULL;
    (void)context;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene jupiter");
    const planet_map_name maps[] = {{"jupiter/color", &s->key[0]},  {"jupiter/color1", &s->key[1]},
                                    {"jupiter/color2", &s->key[2]}, {"jupiter/color3", &s->key[3]},
                                    {"jupiter/color4", &s->key[4]}, {"jupiter/velocity", &s->velocity}};
    amb_status status = planet_load(assets, &s->planet, error);
    if (status == AMB_OK)
        status = planet_load_maps(assets, maps, sizeof maps / sizeof *maps, error);
    if (status != AMB_OK) {
        jupiter_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

static amb_status jupiter_draw(const void *opaque, const void *params, const planet_view *view, double time,
                               amb_pass *pass, amb_error *error)
{
    const jupiter_state *s = opaque;
    const jupiter_params *p = params;
    planet_surface surface = {
        .view = *view, .look = p->surface, .velocity = s->velocity, .drift = JUPITER_KEY_DRIFT * 2.0f / AMB_TWO_PI};
    surface.view.scale = (v3){1.0f, 1.0f - p->oblateness, 1.0f};
    if (p->still) {
        surface.colour = s->key[0];
    } else {
        float keys = planet_loop_time(time, p->key_time * JUPITER_KEYS) / p->key_time;
        int key = keys < JUPITER_KEYS ? (int)keys : JUPITER_KEYS - 1;
        surface.colour = s->key[key];
        surface.next = s->key[(key + 1) % JUPITER_KEYS];
        surface.blend = keys - (float)key;
    }
    amb_draw draw = planet_surface_draw(&surface);
    return amb_pass_draw(pass, &draw, error);
}

const planet_body WIDE(planet_jupiter) = {jupiter_load, jupiter_unload, jupiter_draw};

static const amb_camera_key jupiter_keys[] = {
    {0.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},  {10.0f, {1.2f, 0.75f, 2.4f}, {0.1f, 0, 0}, {0, 1, 0}},
    {20.0f, {2.5f, 0.1f, 1.1f}, {0, 0, 0}, {0, 1, 0}},    {30.0f, {0.6f, -0.5f, 2.9f}, {0, 0, 0}, {0, 1, 0}},
    {40.0f, {-1.1f, 0.35f, 2.75f}, {0, 0, 0}, {0, 1, 0}},
};
static const planet_flight jupiter_flight = {jupiter_keys, sizeof jupiter_keys / sizeof *jupiter_keys, 40.0f};

static amb_status jupiter_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    return planet_frame(&WIDE(planet_jupiter), jupiter_aovs, PLANET_AOVS, &jupiter_flight, planet_background_draw,
                        state, job, error);
}

const amb_scene WIDE(amb_scene_jupiter) = {
    .name = "jupiter",
    .about = "bands that drift between key frames, and the Great Red Spot",
    .seconds = 40.0f,
    .params = {jupiter_table, sizeof jupiter_table / sizeof *jupiter_table, sizeof(jupiter_params)},
    .aovs = jupiter_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = jupiter_load,
    .frame = jupiter_frame,
    .unload = jupiter_unload,
};
