#include "scenes/builtin/stars.h"
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "shade/color.h"

#include <ambiance/math.h>
#include <ambiance/random.h>
#include <stdlib.h>

enum { MAP_WIDTH = 4096, MAP_HEIGHT = 2048, STARS = 60000 };

AMB_DECLARE_WIDE(void, amb_stars_row, (void *user, int y, int thread));

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

/* Star i. Fluxes follow a power law, N(>F) ∝ F^-1.15, a little flatter than evenly spread stars would give (-1.5): the
 * galaxy ends. Two in five lie along it. */
static amb_star star_of(uint32_t i)
{
    v3 pole = v3_normalize(v3_of(0.38f, 0.86f, -0.34f));
    v3 east = v3_normalize(v3_cross(pole, v3_of(0.0f, 0.0f, 1.0f))), north = v3_cross(pole, east);
    float height = 2.0f * draw(i, 0) - 1.0f, longitude = AMB_TWO_PI * draw(i, 1);
    if (draw(i, 2) < 0.4f)
        height = (draw(i, 6) + draw(i, 7) - 1.0f) * 0.30f;
    float r = f_sqrt(1.0f - height * height);
    v3 plane = v3_add(v3_scale(east, amb_cos(longitude)), v3_scale(north, amb_sin(longitude)));
    float flux = f_min(0.045f * amb_pow(1.0f - draw(i, 3), -1.0f / 1.15f), 150.0f);
    float kelvin = 3300.0f * amb_pow(3.6f, draw(i, 4) * 0.6f + draw(i, 5) * 0.4f);
    return (amb_star){v3_normalize(v3_add(v3_scale(plane, r), v3_scale(pole, height))),
                      v3_scale(black_body(kelvin), flux)};
}

/* First and last row that a star reaches. */
static void row_range(const amb_star_map *map, const amb_star *s, int *first, int *last)
{
    float row = amb_acos(f_clamp(s->direction.y, -1.0f, 1.0f)) * (1.0f / AMB_PI) * (float)map->height;
    int reach = f_to_i(3.0f * map->blur * (1.0f / AMB_PI) * (float)map->height) + 1;
    *first = i_max(f_to_i(row) - reach, 0);
    *last = i_min(f_to_i(row) + reach, map->height - 1);
}

/* Sorts the stars into the rows they reach, keeping their order. first: height + 1 zeros. */
static uint32_t *list_by_row(const amb_star_map *map, uint32_t *first)
{
    int from, to;
    for (uint32_t i = 0; i < STARS; i++) {
        row_range(map, &map->star[i], &from, &to);
        for (int y = from; y <= to; y++)
            first[y]++;
    }
    uint32_t total = 0;
    for (int y = 0; y <= map->height; y++) {
        total += first[y];
        first[y] = total;
    }
    uint32_t *list = malloc((size_t)total * sizeof *list);
    if (!list)
        return NULL;
    for (uint32_t i = STARS; i-- > 0;) {
        row_range(map, &map->star[i], &from, &to);
        for (int y = from; y <= to; y++)
            list[--first[y]] = i;
    }
    return list;
}

amb_status amb_builtin_stars(const amb_context *context, amb_texture **out, amb_error *error)
{
    amb_status status = AMB_OK;
    amb_star_map map = {.width = MAP_WIDTH, .height = MAP_HEIGHT, .blur = 0.66f * AMB_PI / (float)MAP_HEIGHT};
    size_t bytes = (size_t)MAP_WIDTH * MAP_HEIGHT * 8, threads = (size_t)amb_context_threads(context);
    amb_star *star = calloc(STARS, sizeof *star);
    uint32_t *first = calloc(MAP_HEIGHT + 1, sizeof *first), *list = NULL;
    map.texels = malloc(bytes);
    map.scratch = calloc(threads * 3 * (MAP_WIDTH + 32), sizeof *map.scratch);
    if (!star || !first || !map.texels || !map.scratch)
        goto memory;
    for (uint32_t i = 0; i < STARS; i++)
        star[i] = star_of(i);
    map.star = star;
    list = list_by_row(&map, first);
    if (!list)
        goto memory;
    map.first = first;
    map.list = list;
    amb_parallel_for(context, MAP_HEIGHT, AMB_DISPATCH(amb_context_isa(context), amb_stars_row), &map);

    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA16F,
                             .width = MAP_WIDTH,
                             .height = MAP_HEIGHT,
                             .make_mips = true,
                             .data = map.texels,
                             .data_bytes = bytes};
    status = amb_texture_create(&desc, out, error);
    goto done;
memory:
    status = amb_fail(error, AMB_ERROR_MEMORY, "stars: no memory for a map of %d x %d texels", MAP_WIDTH, MAP_HEIGHT);
done:
    free(star);
    free(first);
    free(list);
    free(map.texels);
    free(map.scratch);
    return status;
}
