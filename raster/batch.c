/* Running a pass: draws are cut into chunks of triangles, chunks gathered into batches of bounded size. A batch goes
 * through the geometry stages, one chunk a job, and then over the tiles, one tile a job. Each tile plays the chunks in
 * order, so primitive order is kept however jobs are spread over threads. */
#include "core/dispatch.h"
#include "raster/clock.h"
#include "raster/internal.h"

#include <stdlib.h>

#define LOOKUP_SLOTS 32768

AMB_DECLARE_WIDE(void, raster_vertices, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_domain, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_geometry, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_setup, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_tile, (const amb_pass *pass, int tile, raster_scratch *scratch, int thread));

/* For every set of wanted quads of a block and every slot to begin at: which lane each lane takes. */
static int32_t *make_packing(uint32_t lanes)
{
    uint32_t quads = lanes / 4;
    int32_t *packing = calloc((size_t)lanes * quads << quads, sizeof *packing);
    for (uint32_t wanted = 0; packing && wanted < 1u << quads; wanted++)
        for (uint32_t first = 0; first < quads; first++) {
            int32_t *entry = packing + (size_t)(wanted * quads + first) * lanes;
            uint32_t slot = first;
            for (uint32_t quad = 0; quad < quads; quad++)
                if (wanted >> quad & 1u) {
                    for (uint32_t k = 0; k < 4 && slot < quads; k++)
                        entry[slot * 4 + k] = (int32_t)(quad * 4 + k);
                    slot++;
                }
        }
    return packing;
}

static void make_boxes(raster_scratch *s)
{
    for (int width = 1; width <= RASTER_SMALL_BOX; width++)
        for (int height = 1; height <= RASTER_SMALL_BOX; height++) {
            int32_t *box = s->boxes[width - 1 + RASTER_SMALL_BOX * (height - 1)];
            for (int i = 0; i < width * height; i++)
                box[i] = (i % width) << 9 | (i / width) << 17;
        }
}

static bool make_scratch(const amb_pass *pass, raster_scratch *s)
{
    const size_t vertices = RASTER_CHUNK_VERTICES + 16, corners = RASTER_CHUNK_EMITTED + 16; /* lanes of padding */
    const size_t spare = (size_t)16 * (size_t)pass->planes * (size_t)pass->samples;          /* a block */
    s->lookup = calloc(LOOKUP_SLOTS, sizeof *s->lookup);
    s->index = malloc(vertices * sizeof *s->index);
    s->instance = malloc(vertices * sizeof *s->instance);
    s->clip_x = malloc(4 * vertices * sizeof *s->clip_x);
    s->code = malloc(vertices * sizeof *s->code);
    s->corner_memory = malloc(4 * corners * sizeof *s->corner_memory);
    s->group = aligned_alloc(64, (size_t)AMB_MAX_VARYINGS * 16 * sizeof *s->group);
    s->tile = aligned_alloc(64, (raster_tile_floats(pass) + spare) * sizeof *s->tile);
    make_boxes(s);
    s->packing = make_packing((uint32_t)amb_context_isa(pass->context));
    if (!s->lookup || !s->index || !s->instance || !s->clip_x || !s->code || !s->corner_memory || !s->group ||
        !s->tile || !s->packing)
        return false;
    memset(s->group, 0, (size_t)AMB_MAX_VARYINGS * 16 * sizeof *s->group);
    s->clip_y = s->clip_x + vertices;
    s->clip_z = s->clip_y + vertices;
    s->clip_w = s->clip_z + vertices;
    for (int i = 0; i < 4; i++)
        s->corner[i] = s->corner_memory + (size_t)i * corners;
    return true;
}

/* What patches need. */
static bool make_patch_scratch(raster_scratch *s)
{
    const size_t vertices = RASTER_CHUNK_VERTICES + 16;
    s->patch = malloc(vertices * sizeof *s->patch);
    s->u = malloc(2 * vertices * sizeof *s->u);
    s->seen = malloc(RASTER_PATTERN_POINTS * sizeof *s->seen);
    s->patterns = calloc(1, sizeof *s->patterns);
    s->constants = aligned_alloc(64, (size_t)AMB_MAX_PATCH_FLOATS * 16 * sizeof *s->constants);
    s->corners = aligned_alloc(64, (size_t)AMB_MAX_PATCH_CORNERS * 16 * sizeof *s->corners);
    if (!s->patch || !s->u || !s->seen || !s->patterns || !s->constants || !s->corners)
        return false;
    s->v = s->u + vertices;
    return true;
}

/* What geometry shaders need: primary: floats of a vertex that goes in; emitted: of all that one primitive emits. */
static bool make_geometry_scratch(raster_scratch *s, size_t primary, size_t emitted)
{
    const size_t corners = RASTER_CHUNK_EMITTED + 16;
    s->primary = malloc(primary * (RASTER_CHUNK_VERTICES + 16) * sizeof *s->primary);
    s->emitted = calloc((emitted + 3) * 16, sizeof *s->emitted); /* varyings are read by four */
    s->other_memory = malloc(4 * corners * sizeof *s->other_memory);
    if (!s->primary || !s->emitted || !s->other_memory)
        return false;
    for (int i = 0; i < 4; i++)
        s->other_corner[i] = s->other_memory + (size_t)i * corners;
    return true;
}

static bool make_workers(amb_pass *pass)
{
    int threads = amb_context_threads(pass->context);
    pass->scratch = calloc((size_t)threads, sizeof *pass->scratch);
    if (!pass->scratch)
        return false;
    pass->threads = threads;
    bool patches = false;
    size_t primary = 0, emitted = 0;
    for (size_t i = 0; i < pass->draw_count; i++) {
        const amb_geometry *g = &pass->draw[i].state.geometry;
        const size_t in = 4 + (size_t)g->input_floats,
                     out = (4 + (size_t)pass->draw[i].state.varying_floats) * (size_t)g->vertices;
        patches |= pass->draw[i].patches;
        if (g->shader)
            primary = in > primary ? in : primary, emitted = out > emitted ? out : emitted;
    }
    for (int i = 0; i < threads; i++) {
        raster_scratch *s = &pass->scratch[i];
        if (!make_scratch(pass, s) || (patches && !make_patch_scratch(s)) ||
            (emitted > 0 && !make_geometry_scratch(s, primary, emitted)))
            return false;
    }
    return raster_make_patches(pass);
}

bool raster_reserve_vertices(raster_chunk *chunk, size_t count)
{
    return raster_grow(&chunk->vertex, &chunk->vertex_capacity, count * chunk->stride, sizeof *chunk->vertex);
}

bool raster_reserve_triangles(raster_chunk *chunk, size_t count)
{
    return raster_grow(&chunk->triangle, &chunk->triangle_capacity, count, sizeof *chunk->triangle);
}

/* ---- jobs ------------------------------------------------------------------------------------------------------- */

/* Room for the vertices that the chunk's shaders make. */
static bool reserve(raster_chunk *chunk, const raster_scratch *scratch)
{
    const amb_geometry *g = &chunk->draw->state.geometry;
    size_t vertices = scratch->unique_count, triangles = scratch->corner_count;
    if (g->shader)
        vertices = triangles = (triangles + 15) / 16 * 16 * (size_t)g->vertices;
    vertices += 16, triangles += 16;
    return raster_renew(&chunk->vertex, &chunk->vertex_capacity, vertices * chunk->stride, sizeof *chunk->vertex) &&
           raster_renew(&chunk->triangle, &chunk->triangle_capacity, triangles, sizeof *chunk->triangle);
}

static void chunk_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    raster_chunk *chunk = &pass->chunk[pass->chunks_ready + (size_t)index];
    raster_scratch *scratch = &pass->scratch[thread];
    const amb_isa isa = amb_context_isa(pass->context);
    if (chunk->count == 0)
        return;
    const bool timed = pass->target.time_stages;
    uint64_t lap = raster_start(timed);
    if (chunk->draw->patches)
        raster_collect_patches(pass, chunk, scratch);
    else
        raster_collect(chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_CORNERS, lap);
    if (scratch->failed || !reserve(chunk, scratch)) {
        scratch->failed = true;
        return;
    }
    if (chunk->draw->patches)
        AMB_DISPATCH(isa, raster_domain)(pass, chunk, scratch);
    else
        AMB_DISPATCH(isa, raster_vertices)(pass, chunk, scratch);
    if (chunk->draw->state.geometry.shader)
        AMB_DISPATCH(isa, raster_geometry)(pass, chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_VERTICES, lap);
    chunk->primitive = scratch->corner_count > 0 ? scratch->corner[3][0] : 0; /* they ascend */
    AMB_DISPATCH(isa, raster_setup)(pass, chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_SETUP, lap);
    raster_bin(pass, chunk, scratch);
    raster_lap(timed, &scratch->stats, AMB_STAGE_BINS, lap);
}

static void tile_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    bool waits = pass->last_batch && pass->samples > 1 && pass->tile_store[index]; /* for its samples' average */
    if (pass->tile_first[index] == pass->tile_first[index + 1] && !waits)
        return;
    AMB_DISPATCH(amb_context_isa(pass->context), raster_tile)(pass, index, &pass->scratch[thread], thread);
    pass->tile_started[index] = 1;
}

static bool any_failed(const amb_pass *pass)
{
    for (int i = 0; i < pass->threads; i++)
        if (pass->scratch[i].failed)
            return true;
    return false;
}

bool raster_ready_chunks(amb_pass *pass)
{
    amb_parallel_for(pass->context, (int)(pass->chunk_count - pass->chunks_ready), chunk_job, pass);
    pass->chunks_ready = pass->chunk_count;
    return !any_failed(pass);
}

static bool run_batch(amb_pass *pass, bool last)
{
    if (pass->chunk_count == 0)
        return true;
    pass->last_batch = last;
    if (!raster_ready_chunks(pass) || !raster_list_chunks(pass))
        return false;
    amb_parallel_for(pass->context, pass->tiles_x * pass->tiles_y, tile_job, pass);
    pass->chunk_count = pass->chunks_ready = 0;
    pass->bytes = 0;
    return !any_failed(pass);
}

/* ---- chunks and batches ----------------------------------------------------------------------------------------- */

/* Bytes a chunk may come to hold: what the batch's budget counts. */
static size_t chunk_bytes(const amb_pass *pass, const raster_chunk *chunk)
{
    const amb_geometry *g = &chunk->draw->state.geometry;
    size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y, triangles = chunk->count,
           vertices = chunk->most_vertices;
    if (g->shader)
        vertices = triangles *= (size_t)g->vertices;
    return (tiles + 1) * (sizeof(uint32_t) + sizeof(uint16_t)) +
           (vertices * chunk->stride + triangles * 2) * sizeof(uint32_t) + triangles * sizeof(raster_triangle);
}

/* What one holds that has been through the geometry stages: mostly far less. */
static size_t ready_bytes(const amb_pass *pass, const raster_chunk *chunk)
{
    size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y;
    size_t entries = chunk->binned ? 2 * tiles + chunk->tile_start[tiles] : 0;
    if (chunk->count == 0 || chunk->large_count > 0)
        entries += (chunk->count ? chunk->large_count : 0) + tiles;
    return sizeof *chunk + (size_t)chunk->vertex_count * chunk->stride * sizeof(uint32_t) +
           (size_t)chunk->triangle_count * sizeof(raster_triangle) + entries * sizeof(uint16_t);
}

/* Makes room in the batch for `more` bytes: first by finding out what its chunks really hold, then by playing it. */
static bool make_room(amb_pass *pass, size_t more)
{
    if (pass->chunk_count == 0 || (pass->chunk_count < RASTER_BATCH_CHUNKS && pass->bytes + more <= pass->batch_bytes))
        return true;
    if (!raster_ready_chunks(pass))
        return false;
    pass->bytes = 0;
    for (size_t i = 0; i < pass->chunk_count; i++)
        pass->bytes += ready_bytes(pass, &pass->chunk[i]);
    /* Topping up ever smaller rests would run the geometry stages on ever fewer chunks at once. */
    const size_t enough = pass->batch_bytes - pass->batch_bytes / 4;
    if (pass->chunk_count < RASTER_BATCH_CHUNKS && pass->bytes <= enough && pass->bytes + more <= pass->batch_bytes)
        return true;
    return run_batch(pass, false);
}

bool raster_add_chunk(amb_pass *pass, const raster_chunk *chunk)
{
    raster_chunk next = *chunk;
    next.stride = (RASTER_VERTEX_WORDS + (uint32_t)next.draw->state.varying_floats + 3) & ~3u;
    const size_t more = chunk_bytes(pass, &next), before = pass->chunk_capacity;
    if (!make_room(pass, more))
        return false;
    if (!raster_grow(&pass->chunk, &pass->chunk_capacity, pass->chunk_count + 1, sizeof *pass->chunk))
        return false;
    memset(pass->chunk + before, 0, (pass->chunk_capacity - before) * sizeof *pass->chunk);
    raster_chunk *slot = &pass->chunk[pass->chunk_count++];
    slot->draw = next.draw;
    slot->first = next.first, slot->count = next.count;
    slot->patch = next.patch, slot->skipped = next.skipped;
    slot->stride = next.stride;
    slot->binned = false;
    slot->vertex_count = slot->triangle_count = slot->large_count = 0;
    pass->bytes += more;
    return true;
}

/* Draws of vertices, and full-screen ones: those are a chunk of no triangles. */
static bool run_primitives(amb_pass *pass, const raster_draw *draw)
{
    raster_chunk chunk = {.draw = draw};
    do {
        uint64_t left = draw->triangles - chunk.first;
        chunk.count = left < draw->chunk_most ? (uint32_t)left : draw->chunk_most;
        chunk.most_vertices = 3 * chunk.count;
        if (!raster_add_chunk(pass, &chunk))
            return false;
        chunk.first += chunk.count;
    } while (chunk.first < draw->triangles);
    return true;
}

static bool run_draws(amb_pass *pass)
{
    for (size_t i = 0; i < pass->draw_count; i++) {
        const raster_draw *draw = &pass->draw[i];
        if ((!draw->screen && draw->triangles == 0) || draw->x0 >= draw->x1 || draw->y0 >= draw->y1)
            continue;
        if (!(draw->patches ? raster_run_patches(pass, draw) : run_primitives(pass, draw)))
            return false;
    }
    return run_batch(pass, true);
}

/* ---- finish ----------------------------------------------------------------------------------------------------- */

/* A tile no draw touched gets its clear values. */
static void clear_job(void *user, int index, int thread)
{
    (void)thread;
    const amb_pass *pass = user;
    if (pass->tile_started[index])
        return;
    int x0 = index % pass->tiles_x * pass->tile_size, y0 = index / pass->tiles_x * pass->tile_size;
    int x1 = x0 + pass->tile_size < pass->width ? x0 + pass->tile_size : pass->width;
    int y1 = y0 + pass->tile_size < pass->height ? y0 + pass->tile_size : pass->height;
    for (int i = 0; i < pass->target_count; i++)
        raster_clear_pixels(&pass->color[i], x0, y0, x1, y1);
    raster_clear_pixels(&pass->depth, x0, y0, x1, y1);
    raster_clear_pixels(&pass->stencil, x0, y0, x1, y1);
}

static void sum_stats(const amb_pass *pass, amb_pass_stats *sum)
{
    *sum = (amb_pass_stats){0};
    for (size_t i = 0; i < pass->draw_count; i++) {
        const raster_draw *draw = &pass->draw[i];
        if (draw->patches)
            sum->patches += draw->triangles;
        else if (!draw->state.geometry.shader)
            sum->triangles_in += draw->triangles;
    }
    for (int i = 0; i < pass->threads; i++) {
        const amb_pass_stats *s = &pass->scratch[i].stats;
        sum->vertices += s->vertices;
        sum->patches_culled += s->patches_culled;
        sum->domain_points += s->domain_points;
        sum->geometry_in += s->geometry_in;
        sum->geometry_vertices += s->geometry_vertices;
        sum->triangles_in += s->triangles_in;
        sum->triangles_clipped += s->triangles_clipped;
        sum->triangles_culled += s->triangles_culled;
        sum->triangles_binned += s->triangles_binned;
        sum->blocks_shaded += s->blocks_shaded;
        sum->fragments_shaded += s->fragments_shaded;
        for (int k = 0; k < AMB_STAGES; k++)
            sum->ticks[k] += s->ticks[k];
    }
}

const char *amb_stage_name(amb_stage stage)
{
    static const char *const names[AMB_STAGES] = {"corners", "vertices", "set-up",    "bins",
                                                  "tiles",   "coverage", "fragments", "output"};
    return stage >= 0 && stage < AMB_STAGES ? names[stage] : "unknown";
}

amb_status amb_pass_finish(amb_pass **pass, amb_pass_stats *stats, amb_error *error)
{
    if (!pass || !*pass)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "pass: none is given to finish");
    amb_pass *p = *pass;
    bool done = make_workers(p) && run_draws(p);
    if (done && !p->target.keep)
        amb_parallel_for(p->context, p->tiles_x * p->tiles_y, clear_job, p);
    if (done)
        raster_finish_textures(p);
    if (done && stats)
        sum_stats(p, stats);
    amb_pass_close(pass);
    return done ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "pass: out of memory while running it");
}
