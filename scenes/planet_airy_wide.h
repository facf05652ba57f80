/* Bodies of one surface under air: Venus, Mars, Pluto. Each is a table of parameters and a table of maps. */
#ifndef AMB_SCENES_PLANET_AIRY_WIDE_H
#define AMB_SCENES_PLANET_AIRY_WIDE_H

#include "scenes/planet_air_wide.h"
#include "scenes/planet_surface_wide.h"

typedef struct airy_params {
    planet_params planet;
    planet_surface_params surface;
    planet_air_params air;
    int show_air;
} airy_params;
#define AIRY_ROW                                                                                    \
    {                                                                                               \
        "air", AMB_PARAM_BOOL, "", 0, 0, {1}, NULL, offsetof(airy_params, show_air), "draw the air" \
    }

static const amb_aov airy_aovs[] = {PLANET_AOV_ROWS};

/* Which of these a body has is up to its table. */
typedef struct airy_state {
    planet_state planet;
    const amb_texture *colour, *height, *relief, *gloss, *ground;
    amb_texture *made_relief; /* where there is no map of it */
} airy_state;

static amb_status airy_draw(const void *opaque, const void *params, const planet_view *view, double time,
                            amb_pass *pass, amb_error *error)
{
    const airy_state *s = opaque;
    const airy_params *p = params;
    (void)time;
    planet_surface surface = {.view = *view,
                              .look = p->surface,
                              .colour = s->colour,
                              .height = s->height,
                              .relief = s->relief ? s->relief : s->made_relief,
                              .green_up = s->relief != NULL,
                              .gloss = s->gloss,
                              .ground = s->ground,
                              .ground_strength = 0.5f};
    amb_draw ground = planet_surface_draw(&surface);
    amb_status status = amb_pass_draw(pass, &ground, error);
    if (status != AMB_OK || !p->show_air)
        return status;
    planet_air air = {.view = *view,
                      .air = planet_atmosphere(&p->air, view->sun_rgb),
                      .ground_gain = p->air.ground,
                      .dome_gain = p->air.dome,
                      .only = p->air.only};
    return planet_air_draw(pass, &air, error);
}

#endif
