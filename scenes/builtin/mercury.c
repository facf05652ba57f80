#include "scenes/builtin/mercury.h"
#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"

#include <ambiance/math.h>
#include <ambiance/random.h>
#include <stdlib.h>

enum { MAP_WIDTH = 4096, MAP_HEIGHT = 2048, CRATERS = 90000, RAY_CRATERS = 34, RAY_FIRST = 60000 };

AMB_DECLARE_WIDE(void, amb_mercury_row, (void *user, int y, int thread));

/* Number k of crater i, uniform in [0, 1). */
static float draw(uint32_t i, uint32_t k) { return amb_unit(amb_hash(i * 16u + k + 0x6d657263u)); }

/* Somewhere on the sphere, evenly. */
static void place(amb_crater *c, uint32_t i)
{
    float y = 2.0f * draw(i, 0) - 1.0f, longitude = AMB_TWO_PI * draw(i, 1);
    float r = f_sqrt(1.0f - y * y);
    c->center = v3_of(r * amb_cos(longitude), y, r * amb_sin(longitude));
    c->east = v3_normalize(v3_cross(v3_of(0.0f, 1.0f, 0.0f), c->center));
    c->north = v3_cross(c->center, c->east);
}

/* Crater i of all, from the largest to the smallest: cumulative numbers fall with the square of the radius, so every
 * octave of sizes covers the same area (R. J. Pike, "Geomorphology of impact craters on Mercury", 1988, for the shapes:
 * small ones are bowls, large ones have flat floors, central peaks and are relatively shallower). */
static amb_crater plain_crater(uint32_t i)
{
    const float largest = 0.17f, smallest = 0.0030f;
    float share = ((float)i + draw(i, 2)) / (float)CRATERS; /* 0: the largest */
    float inverse = (1.0f / (largest * largest)) + share * (1.0f / (smallest * smallest) - 1.0f / (largest * largest));
    amb_crater c = {.radius = 1.0f / f_sqrt(inverse), .seed = 61.0f * draw(i, 3)};
    place(&c, i);
    float age = draw(i, 4);
    float preserved = 0.16f + 0.84f * age * age * age; /* most are worn down */
    float size = f_sqrt(c.radius / 0.02f);
    bool complex = c.radius > 0.012f;
    c.reach = 2.1f;
    c.depth = 0.115f * preserved * (complex ? f_sqrt(size) : size);
    c.rim = 0.055f * preserved * (complex ? f_sqrt(size) : size);
    c.floor = complex ? f_min(0.35f + 2.5f * c.radius, 0.72f) : 0.1f;
    c.peak = complex && c.radius < 0.06f ? 0.8f * c.depth * draw(i, 5) : 0.0f;
    c.fresh = 0.10f * f_max(age - 0.86f, 0.0f) / 0.14f;
    return c;
}

/* A young crater with bright rays. */
static amb_crater ray_crater(uint32_t i)
{
    uint32_t id = RAY_FIRST + i;
    float size = draw(id, 2);
    amb_crater c = {.radius = 0.006f + 0.016f * size * size, .seed = 61.0f * draw(id, 3)};
    place(&c, id);
    c.reach = 9.0f + 18.0f * draw(id, 4) * draw(id, 6);
    c.depth = 0.10f;
    c.rim = 0.09f;
    c.floor = 0.3f;
    c.peak = 0.05f;
    c.fresh = 0.30f;
    c.rays = 0.20f + 0.22f * draw(id, 5);
    return c;
}

/* First and last row whose texels a crater may reach. */
static void row_range(const amb_mercury_map *map, const amb_crater *c, int *first, int *last)
{
    float polar = amb_acos(f_clamp(c->center.y, -1.0f, 1.0f)), reach = c->radius * c->reach * 1.02f;
    *first = f_to_i(f_floor((polar - reach) * (1.0f / AMB_PI) * (float)map->height)) - 1;
    *last = f_to_i(f_floor((polar + reach) * (1.0f / AMB_PI) * (float)map->height)) + 1;
    *first = *first < 0 ? 0 : *first;
    *last = *last >= map->height ? map->height - 1 : *last;
}

/* Sorts the craters into the rows they reach, keeping their order. first: height + 1 zeros. */
static uint32_t *list_by_row(const amb_mercury_map *map, uint32_t count, uint32_t *first)
{
    int from, to;
    for (uint32_t i = 0; i < count; i++) {
        row_range(map, &map->crater[i], &from, &to);
        for (int y = from; y <= to; y++)
            first[y]++;
    }
    uint32_t total = 0;
    for (int y = 0; y <= map->height; y++) { /* counts become ends */
        total += first[y];
        first[y] = total;
    }
    uint32_t *list = malloc((total ? total : 1) * sizeof *list);
    if (!list)
        return NULL;
    for (uint32_t i = count; i-- > 0;) { /* backwards: ends become starts, and order is kept */
        row_range(map, &map->crater[i], &from, &to);
        for (int y = from; y <= to; y++)
            list[--first[y]] = i;
    }
    return list;
}

amb_status amb_builtin_mercury(const amb_context *context, amb_texture **out, amb_error *error)
{
    amb_status status = AMB_OK;
    amb_mercury_map map = {.width = MAP_WIDTH, .height = MAP_HEIGHT};
    size_t bytes = (size_t)MAP_WIDTH * MAP_HEIGHT * 4, threads = (size_t)amb_context_threads(context);
    amb_crater *crater = calloc(CRATERS + RAY_CRATERS, sizeof *crater);
    uint32_t *first = calloc(MAP_HEIGHT + 1, sizeof *first), *list = NULL;
    map.texels = malloc(bytes);
    map.scratch = calloc(threads * 2 * (MAP_WIDTH + 32), sizeof *map.scratch);
    if (!crater || !first || !map.texels || !map.scratch)
        goto memory;
    for (uint32_t i = 0; i < CRATERS; i++)
        crater[i] = plain_crater(i);
    for (uint32_t i = 0; i < RAY_CRATERS; i++)
        crater[CRATERS + i] = ray_crater(i);
    map.crater = crater;
    list = list_by_row(&map, CRATERS + RAY_CRATERS, first);
    if (!list)
        goto memory;
    map.first = first;
    map.list = list;
    amb_parallel_for(context, MAP_HEIGHT, AMB_DISPATCH(amb_context_isa(context), amb_mercury_row), &map);

    amb_texture_desc desc = {.texel = AMB_TEXEL_SRGB8_A8,
                             .width = MAP_WIDTH,
                             .height = MAP_HEIGHT,
                             .make_mips = true,
                             .data = map.texels,
                             .data_bytes = bytes};
    status = amb_texture_create(&desc, out, error);
    goto done;
memory:
    status = amb_fail(error, AMB_ERROR_MEMORY, "mercury: no memory for a map of %d x %d texels", MAP_WIDTH, MAP_HEIGHT);
done:
    free(crater);
    free(first);
    free(list);
    free(map.texels);
    free(map.scratch);
    return status;
}
