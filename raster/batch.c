/* Running a pass: draws are cut into chunks of triangles, chunks gathered into batches of bounded size. A batch goes
 * through the geometry stages, one chunk a job, and then over the tiles, one tile a job. Each tile plays the chunks in
 * order, so primitive order is kept however jobs are spread over threads. */
#include "core/dispatch.h"
#include "raster/clock.h"
#include "raster/internal.h"

#include <stdlib.h>

AMB_DECLARE_WIDE(void, raster_vertices, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_domain, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_geometry, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_setup, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
AMB_DECLARE_WIDE(void, raster_tile, (const amb_pass *pass, int tile, raster_scratch *scratch, int thread));

/* ---- jobs ------------------------------------------------------------------------------------------------------- */

/* Room for the vertices that the chunk's shaders make, in whole groups of lanes. */
static bool reserve_made(raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_geometry *g = &chunk->draw->state.geometry;
    size_t vertices = (scratch->unique_count + 15u) & ~15u;
    if (g->shader)
        vertices = ((scratch->corner_count + 15u) & ~15u) * (size_t)g->vertices;
    return raster_reserve_vertices(chunk, scratch, vertices);
}

/* Set-up, with as many triangles as come in, or more where some are clipped. */
static bool set_up(amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    chunk->primitive = scratch->corner_count > 0 ? scratch->corner[3][0] : 0; /* they ascend */
    if (!raster_reserve_triangles(chunk, scratch, scratch->corner_count + 16u))
        return false;
    AMB_DISPATCH(amb_context_isa(pass->context), raster_setup)(pass, chunk, scratch);
    raster_trim(&scratch->batch, chunk->triangle, chunk->triangle_capacity * sizeof *chunk->triangle,
                chunk->triangle_count * sizeof *chunk->triangle);
    return !scratch->failed;
}

static void run_chunk(amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
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
    if (scratch->failed || !reserve_made(chunk, scratch)) {
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
    if (!set_up(pass, chunk, scratch)) {
        scratch->failed = true;
        return;
    }
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_SETUP, lap);
    raster_bin(pass, chunk, scratch);
    raster_lap(timed, &scratch->stats, AMB_STAGE_BINS, lap);
}

/* Some neighbouring chunks: those of small draws are less work than handing out a job. */
static void chunks_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    const size_t first = pass->chunks_ready + (size_t)index * pass->job_chunks, left = pass->chunk_count - first;
    for (size_t i = 0; i < pass->job_chunks && i < left; i++)
        run_chunk(pass, &pass->chunk[first + i], &pass->scratch[thread]);
}

/* A tile no draw touched gets its clear values. */
static void clear_tile(const amb_pass *pass, int index)
{
    int x0 = index % pass->tiles_x * pass->tile_size, y0 = index / pass->tiles_x * pass->tile_size;
    int x1 = x0 + pass->tile_size < pass->width ? x0 + pass->tile_size : pass->width;
    int y1 = y0 + pass->tile_size < pass->height ? y0 + pass->tile_size : pass->height;
    for (int i = 0; i < pass->target_count; i++)
        raster_clear_pixels(&pass->color[i], x0, y0, x1, y1);
    raster_clear_pixels(&pass->depth, x0, y0, x1, y1);
    raster_clear_pixels(&pass->stencil, x0, y0, x1, y1);
}

static void tile_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    bool waits = pass->last_batch && pass->samples > 1 && pass->tile_store[index]; /* for its samples' average */
    if (pass->tile_first[index] == pass->tile_first[index + 1] && !waits) {
        if (pass->last_batch && !pass->tile_started[index] && !pass->target.keep)
            clear_tile(pass, index);
        return;
    }
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
    const size_t waiting = pass->chunk_count - pass->chunks_ready;
    const size_t jobs = RASTER_THREAD_JOBS * (size_t)pass->threads; /* up to twice as many */
    pass->job_chunks = waiting > jobs ? waiting / jobs : 1;
    amb_parallel_for(pass->context, (int)((waiting + pass->job_chunks - 1) / pass->job_chunks), chunks_job, pass);
    pass->chunks_ready = pass->chunk_count;
    return !any_failed(pass);
}

static bool run_batch(amb_pass *pass, bool last)
{
    if (pass->chunk_count == 0 && !last)
        return true;
    pass->last_batch = last;
    if (!raster_ready_chunks(pass) || !raster_list_chunks(pass))
        return false;
    amb_parallel_for(pass->context, pass->tiles_x * pass->tiles_y, tile_job, pass);
    pass->chunk_count = pass->chunks_ready = 0;
    pass->bytes = 0;
    for (int i = 0; i < pass->threads; i++)
        raster_reset(&pass->scratch[i].batch);
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
    return (triangles > RASTER_UNBINNED ? (tiles + 1) * sizeof(uint32_t) : 0) +
           (vertices * chunk->stride + triangles) * sizeof(uint32_t) + triangles * sizeof(raster_triangle);
}

/* What those hold that have been through the geometry stages: mostly far less. */
static size_t ready_bytes(const amb_pass *pass)
{
    size_t bytes = pass->chunk_count * sizeof *pass->chunk;
    for (int i = 0; i < pass->threads; i++)
        bytes += raster_arena_bytes(&pass->scratch[i].batch);
    return bytes;
}

/* Makes room in the batch for `more` bytes: first by finding out what its chunks really hold, then by playing it. */
static bool make_room(amb_pass *pass, size_t more)
{
    if (pass->chunk_count == 0 || (pass->chunk_count < RASTER_BATCH_CHUNKS && pass->bytes + more <= pass->batch_bytes))
        return true;
    if (!raster_ready_chunks(pass))
        return false;
    pass->bytes = ready_bytes(pass);
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
    const size_t more = chunk_bytes(pass, &next);
    if (!make_room(pass, more))
        return false;
    if (!raster_grow(&pass->chunk, &pass->chunk_capacity, pass->chunk_count + 1, sizeof *pass->chunk))
        return false;
    pass->chunk[pass->chunk_count++] = next;
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
    bool done = raster_make_workers(p) && run_draws(p);
    if (done)
        raster_finish_textures(p);
    if (done && stats)
        sum_stats(p, stats);
    amb_pass_close(pass);
    return done ? AMB_OK : amb_fail(error, AMB_ERROR_MEMORY, "pass: out of memory while running it");
}
