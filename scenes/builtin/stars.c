/* The built-in night sky: the Milky Way as a panorama, and stars as points. */
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/paint.h"
#include "shade/color.h"

#include <ambiance/math.h>
#include <ambiance/random.h>
#include <stdlib.h>

enum { MAP_WIDTH = 2048, MAP_HEIGHT = 1024, STARS = 40000 };

AMB_DECLARE_WIDE(v4x, amb_milky_way, (v3x direction, const void *user));

static float draw(uint32_t i, uint32_t k) { return amb_unit(amb_hash(i * 8u + k + 0x73746172u)); }

/* Linear Rec. 709 colour of a black body between 1667 and 25000 K, luminance 1. Chromaticity of the Planckian locus by
 * the cubics of B. Kim et al., "Design of advanced color temperature control system for HDTV applications", 2002. */
static v3 black_body(float kelvin)
{
    float t = 1000.0f / kelvin;
    float x = kelvin < 4000.0f ? ((-0.2661239f * t - 0.2343589f) * t + 0.8776956f) * t + 0.179910f
                               : ((-3.0258469f * t + 2.1070379f) * t + 0.2226347f) * t + 0.240390f;
    float y = kelvin < 2222.0f   ? ((-1.1063814f * x - 1.34811020f) * x + 2.18555832f) * x - 0.20219683f
              : kelvin < 4000.0f ? ((-0.9549476f * x - 1.37418593f) * x + 2.09137015f) * x - 0.16748867f
                                 : ((3.0817580f * x - 5.87338670f) * x + 3.75112997f) * x - 0.37001483f;
    v3x rgb = color_rgb_of_xyz((v3x){x / y, 1.0f, (1.0f - x - y) / y});
    return v3_of(f_max(rgb.x, 0.0f), f_max(rgb.y, 0.0f), f_max(rgb.z, 0.0f));
}

/* Direction and light of star i. Fluxes follow a power law, N(>F) ∝ F^-1.15, a little flatter than evenly spread stars
 * would give (-1.5): the galaxy ends. Two in five lie along it. */
static void make_star(uint32_t i, v3 *direction, v3 *rgb)
{
    v3 pole = v3_normalize(v3_of(0.38f, 0.86f, -0.34f));
    v3 east = v3_normalize(v3_cross(pole, v3_of(0.0f, 0.0f, 1.0f))), north = v3_cross(pole, east);
    float height = 2.0f * draw(i, 0) - 1.0f, longitude = AMB_TWO_PI * draw(i, 1);
    if (draw(i, 2) < 0.4f)
        height = (draw(i, 6) + draw(i, 7) - 1.0f) * 0.30f;
    float r = f_sqrt(1.0f - height * height);
    v3 plane = v3_add(v3_scale(east, amb_cos(longitude)), v3_scale(north, amb_sin(longitude)));
    float flux = f_min(0.11f * amb_pow(1.0f - draw(i, 3), -1.0f / 1.15f), 300.0f);
    float kelvin = 3300.0f * amb_pow(3.6f, draw(i, 4) * 0.6f + draw(i, 5) * 0.4f);
    *direction = v3_normalize(v3_add(v3_scale(plane, r), v3_scale(pole, height)));
    *rgb = v3_scale(black_body(kelvin), flux);
}

amb_status amb_builtin_stars(const amb_context *context, amb_texture **out, amb_error *error)
{
    return amb_map_paint(context, MAP_WIDTH, MAP_HEIGHT, 1, AMB_DISPATCH(amb_context_isa(context), amb_milky_way), NULL,
                         AMB_TEXEL_RGBA16F, out, error);
}

amb_status amb_builtin_star_points(const amb_context *context, amb_mesh **out, amb_error *error)
{
    (void)context;
    amb_status status = amb_mesh_create(STARS, 0, out, error);
    if (status != AMB_OK)
        return status;
    (*out)->normal = calloc(STARS, sizeof *(*out)->normal);
    if (!(*out)->normal) {
        amb_mesh_close(out);
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for %d stars", STARS);
    }
    for (uint32_t i = 0; i < STARS; i++)
        make_star(i, &(*out)->position[i], &(*out)->normal[i]);
    return AMB_OK;
}
