/* Scene hillscape: what does not depend on parameters or time. */
#include "scenes/hillscape.h"

#include <stdlib.h>

static const amb_material materials[GROUND_COUNT] = {
    [GROUND_SAND] = {.asset = "ground/sand",
                     .size = 9.0f,
                     .bump = 0.35f,
                     .roughness = 0.55f,
                     .f0 = 0.03f,
                     .tint = {0.80f, 0.76f, 0.70f}},
    [GROUND_GRASS] = {.asset = "ground/grass",
                      .size = 4.5f,
                      .bump = 0.8f,
                      .roughness = 0.6f,
                      .f0 = 0.03f,
                      .tint = {0.82f, 0.82f, 0.85f}},
    [GROUND_ROCK] = {.asset = "ground/rock",
                     .size = 13.0f,
                     .bump = 1.3f,
                     .roughness = 0.45f,
                     .f0 = 0.04f,
                     .tint = {0.88f, 0.80f, 0.70f}},
    [GROUND_SNOW] =
        {.asset = "ground/snow", .size = 19.0f, .bump = 0.35f, .roughness = 0.35f, .f0 = 0.03f, .tint = {1, 1, 1}},
};

/* ---- grids --------------------------------------------------------------------------------------------------------
 */

/* Corners and patches of a grid of cells² whose corner lines are at line[0…cells]. Corners of a patch in the order
 * (u, v) = (0, 0), (1, 0), (1, 1), (0, 1). */
static amb_status make_grid(const float *line, int cells, v2 **corner, uint32_t **patch, amb_error *error)
{
    size_t side = (size_t)cells + 1;
    *corner = malloc(side * side * sizeof **corner);
    *patch = malloc(4 * (size_t)cells * (size_t)cells * sizeof **patch);
    if (!*corner || !*patch)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for the grids of scene hillscape");
    for (size_t z = 0; z < side; z++)
        for (size_t x = 0; x < side; x++)
            (*corner)[z * side + x] = (v2){line[x], line[z]};
    uint32_t *p = *patch;
    for (uint32_t z = 0; z < (uint32_t)cells; z++)
        for (uint32_t x = 0; x < (uint32_t)cells; x++, p += 4) {
            uint32_t first = z * (uint32_t)side + x;
            p[0] = first;
            p[1] = first + 1;
            p[2] = first + (uint32_t)side + 1;
            p[3] = first + (uint32_t)side;
        }
    return AMB_OK;
}

static amb_status make_grids(hill_state *s, amb_error *error)
{
    float line[HILL_PATCHES + 1], water[WATER_CELLS + 1];
    const int half = WATER_CELLS / 2, even = half - 8; /* the outermost 8 double each time */
    for (int i = 0; i <= HILL_PATCHES; i++)
        line[i] = ((float)i - 0.5f * HILL_PATCHES) * (HILL_SIZE / HILL_PATCHES);
    water[half] = 0.0f;
    for (int i = 1; i <= half; i++) {
        float step = i <= even ? WATER_CELL : WATER_CELL * (float)(1 << (i - even));
        water[half + i] = water[half + i - 1] + step;
        water[half - i] = -water[half + i];
    }
    amb_status status = make_grid(line, HILL_PATCHES, &s->corner, &s->patch, error);
    return status == AMB_OK ? make_grid(water, WATER_CELLS, &s->water_corner, &s->water_patch, error) : status;
}

/* ---- what is made of the heights ----------------------------------------------------------------------------------
 */

typedef struct height_job {
    hill_state *state;
    amb_image *height, *slope;
} height_job;

/* The report's central differences, per unit of u and v. */
static void slope_row(void *user, int y, int thread)
{
    (void)thread;
    const height_job *job = user;
    const amb_image *h = job->height;
    int above = y > 0 ? y - 1 : 0, below = y + 1 < h->height ? y + 1 : y;
    for (int x = 0; x < h->width; x++) {
        int left = x > 0 ? x - 1 : 0, right = x + 1 < h->width ? x + 1 : x;
        float du =
            (amb_image_row(h, 0, y)[right] - amb_image_row(h, 0, y)[left]) * (float)h->width / (float)(right - left);
        float dv =
            (amb_image_row(h, 0, below)[x] - amb_image_row(h, 0, above)[x]) * (float)h->height / (float)(below - above);
        amb_image_row(job->slope, 0, y)[x] = du;
        amb_image_row(job->slope, 1, y)[x] = dv;
    }
}

/* Least and most height of what may be drawn of a patch: its texels and their neighbours. */
static void bounds_row(void *user, int row, int thread)
{
    (void)thread;
    const height_job *job = user;
    const amb_image *h = job->height;
    for (int i = 0; i < HILL_PATCHES; i++) {
        int x0 = i * h->width / HILL_PATCHES - 1, x1 = (i + 1) * h->width / HILL_PATCHES + 1;
        int y0 = row * h->height / HILL_PATCHES - 1, y1 = (row + 1) * h->height / HILL_PATCHES + 1;
        v2 b = {1.0e9f, -1.0e9f};
        for (int y = y0 < 0 ? 0 : y0; y < (y1 < h->height ? y1 : h->height); y++)
            for (int x = x0 < 0 ? 0 : x0; x < (x1 < h->width ? x1 : h->width); x++) {
                float v = amb_image_row(h, 0, y)[x];
                b.x = v < b.x ? v : b.x;
                b.y = v > b.y ? v : b.y;
            }
        job->state->bounds[row * (HILL_PATCHES + 1) + i] = b;
    }
}

static amb_status use_heights(const amb_context *context, hill_state *s, amb_image **height, amb_error *error)
{
    amb_texture_info info = amb_texture_describe(s->height);
    height_job job = {.state = s};
    if (info.width < 2 || info.height < 2)
        return amb_fail(error, AMB_ERROR_FORMAT, "hills/height: %d×%d texels; at least 2×2 are needed", info.width,
                        info.height);
    s->bounds = calloc((HILL_PATCHES + 1) * (HILL_PATCHES + 1), sizeof *s->bounds);
    if (!s->bounds)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for the bounds of scene hillscape");
    amb_status status = amb_texture_to_image(s->height, 0, 0, height, error);
    if (status == AMB_OK)
        status = amb_image_create(info.width, info.height, 2, &job.slope, error);
    if (status == AMB_OK) {
        job.height = *height;
        amb_parallel_for(context, info.height, slope_row, &job);
        amb_parallel_for(context, HILL_PATCHES, bounds_row, &job);
        status = amb_texture_from_image(job.slope, AMB_TEXEL_RGBA16F, true, &s->slopes, error);
    }
    amb_image_close(&job.slope);
    return status;
}

void hill_sort_patches(const hill_state *s, v3 eye, uint32_t *near_to_far)
{
    enum { PATCHES = HILL_PATCHES * HILL_PATCHES, STEPS = 1024 };
    uint32_t first[STEPS + 1] = {0};
    uint16_t step[PATCHES];
    for (int i = 0; i < PATCHES; i++) { /* a counting sort by distance, in steps of 4 m */
        v2 corner = s->corner[s->patch[4 * i]];
        float dx = corner.x + 8.0f - eye.x, dz = corner.y + 8.0f - eye.z;
        float distance = f_min(f_sqrt(dx * dx + dz * dz) * 0.25f, (float)(STEPS - 1));
        step[i] = (uint16_t)distance;
        first[step[i] + 1]++;
    }
    for (int i = 0; i < STEPS; i++)
        first[i + 1] += first[i];
    for (int i = 0; i < PATCHES; i++)
        memcpy(near_to_far + 4 * first[step[i]]++, s->patch + 4 * i, 4 * sizeof *near_to_far);
}

/* ---- plants -------------------------------------------------------------------------------------------------------
 */

enum { PLANT_CELLS = 470 };

/* Does the flight pass close by? Billboards are no company for an eye. */
enum { FLIGHT_STEPS = 240 };
static bool on_the_way(const v2 *way, float x, float z)
{
    for (int i = 0; i < FLIGHT_STEPS; i++) {
        float dx = x - way[i].x, dz = z - way[i].y;
        if (dx * dx + dz * dz < 17.0f * 17.0f)
            return true;
    }
    return false;
}

/* One tree at most a cell, away from its middle by chance, where it is not too steep, too wet or too high. Woods come
 * from a noise; the share of conifers grows with height. */
static void grow(hill_state *s, const amb_image *height)
{
    v2 way[FLIGHT_STEPS];
    for (int i = 0; i < FLIGHT_STEPS; i++) {
        float time = HILL_SECONDS * (float)i / FLIGHT_STEPS;
        amb_camera c = amb_camera_at(hill_flight, HILL_FLIGHT_KEYS, time, 1.0f, 1.0f, 2.0f, 4, 4);
        way[i] = (v2){c.position.x, c.position.z};
    }
    for (int j = 0; j < PLANT_CELLS; j++)
        for (int i = 0; i < PLANT_CELLS; i++) {
            u4x h = u4x_hash((u4x){(uint32_t)i, (uint32_t)j, 77u, 5u});
            float u = ((float)i + amb_unit(h.x)) / PLANT_CELLS, v = ((float)j + amb_unit(h.y)) / PLANT_CELLS;
            int x = (int)(u * (float)height->width), y = (int)(v * (float)height->height);
            x = x < height->width - 1 ? x : height->width - 2;
            y = y < height->height - 1 ? y : height->height - 2;
            float here = amb_image_row(height, 0, y)[x];
            float du = (amb_image_row(height, 0, y)[x + 1] - here) * (float)height->width;
            float dv = (amb_image_row(height, 0, y + 1)[x] - here) * (float)height->height;
            float steep = (du * du + dv * dv) * (300.0f / HILL_SIZE) * (300.0f / HILL_SIZE);
            v2x at = {u * 9.0f, v * 9.0f};
            float woods = fbm2(noise_gradient2, at, (amb_lattice){.seed = 91}, (amb_fbm){5, 2.0f, 0.55f}).value;
            float above = (here - HILL_SEA) * 300.0f;
            float wanted = 0.55f + 4.5f * woods - 0.004f * (above - 25.0f) - 0.30f * steep;
            if (above < 2.6f + 7.0f * amb_unit(amb_hash(h.z)) || above > 110.0f || steep > 0.85f ||
                amb_unit(h.z) > wanted)
                continue;
            float conifer = f_saturate(0.35f + above * 0.008f + 0.8f * woods);
            uint32_t bits = amb_hash(h.w);
            float kind = (float)(bits & 1u) + (amb_unit(bits) < conifer ? 0.0f : 2.0f);
            float size = (5.0f + 7.5f * amb_unit(amb_hash(bits))) * (1.1f - 0.004f * above);
            float east = (u - 0.5f) * HILL_SIZE, south = (v - 0.5f) * HILL_SIZE;
            if (!on_the_way(way, east, south))
                s->plant[s->plants++] = (hill_plant){east, south, size, kind};
        }
}

/* ---- load ---------------------------------------------------------------------------------------------------------
 */

void hill_unload(void *opaque)
{
    hill_state *s = opaque;
    amb_texture_close(&s->slopes);
    for (int i = 0; i < GROUND_COUNT; i++)
        material_unload(&s->ground[i]);
    amb_mesh_close(&s->sphere);
    free(s->corner);
    free(s->patch);
    free(s->bounds);
    free(s->water_corner);
    free(s->water_patch);
    free(s->plant);
    free(s);
}

static amb_status load(const amb_context *context, amb_assets *assets, hill_state *s, amb_error *error)
{
    static const struct {
        const char *name;
        size_t field;
    } maps[] = {{"hills/height", offsetof(hill_state, height)},
                {"hills/noise", offsetof(hill_state, noise)},
                {"plants/trees", offsetof(hill_state, trees)},
                {"plants/tree-normals", offsetof(hill_state, tree_normals)},
                {"plants/grass", offsetof(hill_state, blades)}};
    amb_image *height = NULL;
    amb_status status = make_grids(s, error);
    for (size_t i = 0; i < sizeof maps / sizeof *maps && status == AMB_OK; i++)
        status =
            amb_assets_texture(assets, maps[i].name, (const amb_texture **)(void *)((char *)s + maps[i].field), error);
    for (int i = 0; i < GROUND_COUNT && status == AMB_OK; i++) {
        s->ground[i] = materials[i];
        status = material_load(context, assets, &s->ground[i], error);
    }
    if (status == AMB_OK)
        status = use_heights(context, s, &height, error);
    if (status == AMB_OK && !(s->plant = malloc(PLANT_CELLS * PLANT_CELLS * sizeof *s->plant)))
        status = amb_fail(error, AMB_ERROR_MEMORY, "out of memory for the plants of scene hillscape");
    if (status == AMB_OK)
        grow(s, height);
    if (status == AMB_OK)
        status = amb_mesh_sphere(64, 128, &s->sphere, error);
    amb_image_close(&height);
    return status;
}

amb_status hill_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    hill_state *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene hillscape");
    amb_status status = load(context, assets, s, error);
    if (status != AMB_OK) {
        hill_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}
