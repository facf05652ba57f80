/* Scene jupiter: bands that drift between key frames, and the Great Red Spot. */
#include "scenes/builtin/giants.h"
#include "scenes/planet_surface_wide.h"

extern const planet_body WIDE(planet_jupiter);

typedef struct jupiter_params {
    planet_params planet;
    planet_surface_params surface;
    float oblateness, key_time;
    int still;
} jupiter_params;

static const amb_param jupiter_table[] = {
    PLANET_PARAM_ROWS(jupiter_params, -82, 8, 195, 120, 3, 1.05f),
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
    PLANET_SHOW_ROW(jupiter_params),
};
static const amb_aov jupiter_aovs[] = {PLANET_AOV_ROWS};

typedef struct jupiter_state {
    planet_state planet;
    const amb_texture *key[JUPITER_KEYS], *velocity;
} jupiter_state;

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

const planet_body WIDE(planet_jupiter) = {
    .name = "jupiter",
    .state_bytes = sizeof(jupiter_state),
    .map = {{"jupiter/color", offsetof(jupiter_state, key[0])},
            {"jupiter/color1", offsetof(jupiter_state, key[1])},
            {"jupiter/color2", offsetof(jupiter_state, key[2])},
            {"jupiter/color3", offsetof(jupiter_state, key[3])},
            {"jupiter/color4", offsetof(jupiter_state, key[4])},
            {"jupiter/velocity", offsetof(jupiter_state, velocity)}},
    .draw = jupiter_draw,
    .sky = &planet_sky_of_stars,
    .aovs = jupiter_aovs,
    .aov_count = PLANET_AOVS,
    .flight = &planet_flight_ball,
};

static amb_status jupiter_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    return planet_load(&WIDE(planet_jupiter), context, assets, state, error);
}

const amb_scene WIDE(amb_scene_jupiter) = {
    .name = "jupiter",
    .about = "bands that drift between key frames, and the Great Red Spot",
    .seconds = 40.0f,
    .params = {jupiter_table, sizeof jupiter_table / sizeof *jupiter_table, sizeof(jupiter_params)},
    .aovs = jupiter_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.25;display:curve=aces",
    .load = jupiter_load,
    .frame = planet_frame,
    .unload = planet_unload,
};
