#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/paint.h"

enum { MAP_WIDTH = 2048 };

/* A map of one field: amb_builtin_NAME paints amb_NAME. */
#define SIZED_MAP(NAME, TEXEL, WIDTH)                                                                                \
    AMB_DECLARE_WIDE(v4x, amb_##NAME, (v3x direction, const void *user));                                            \
    amb_status amb_builtin_##NAME(const amb_context *context, amb_texture **out, amb_error *error)                   \
    {                                                                                                                \
        return amb_map_paint(context, WIDTH, WIDTH / 2, 1, AMB_DISPATCH(amb_context_isa(context), amb_##NAME), NULL, \
                             TEXEL, out, error);                                                                     \
    }

#define MAP(NAME, TEXEL) SIZED_MAP(NAME, TEXEL, MAP_WIDTH)

SIZED_MAP(earth_colour, AMB_TEXEL_SRGB8_A8, 4096)
MAP(earth_height, AMB_TEXEL_R16F)
MAP(earth_water, AMB_TEXEL_R8)
MAP(earth_night, AMB_TEXEL_SRGB8_A8)
SIZED_MAP(earth_clouds, AMB_TEXEL_R16F, 4096)
MAP(venus_colour, AMB_TEXEL_SRGB8_A8)
MAP(venus_surface, AMB_TEXEL_SRGB8_A8)
MAP(mars_colour, AMB_TEXEL_SRGB8_A8)
MAP(mars_height, AMB_TEXEL_R16F)
MAP(pluto_colour, AMB_TEXEL_SRGB8_A8)
MAP(pluto_gloss, AMB_TEXEL_R8)
MAP(jupiter_colour, AMB_TEXEL_SRGB8_A8)
MAP(saturn_colour, AMB_TEXEL_SRGB8_A8)
MAP(uranus_colour, AMB_TEXEL_SRGB8_A8)
MAP(neptune_colour, AMB_TEXEL_SRGB8_A8)
MAP(sun_colour, AMB_TEXEL_SRGB8_A8)
