/* Running a pass: draws are cut into chunks of triangles, chunks gathered into batches of bounded size. A batch goes
 * through the geometry stages, one chunk a job, and then over the tiles, one tile a job. Each tile plays the chunks in
 * order, so primitive order is kept however jobs are spread over threads. */
#include "core/dispatch.h"
#include "raster/clock.h"
#include "raster/internal.h"

#include <stdlib.h>

#define LOOKUP_SLOTS 32768

AMB_DECLARE_WIDE(void, raster_vertices, (const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch));
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

static bool make_scratch(const amb_pass *pass, raster_scratch *s)
{
    const size_t vertices = RASTER_CHUNK_VERTICES + 16, triangles = RASTER_CHUNK_TRIANGLES + 16; /* lanes of padding */
    const size_t spare = (size_t)16 * (size_t)pass->planes * (size_t)pass->samples;              /* a block */
    s->lookup = calloc(LOOKUP_SLOTS, sizeof *s->lookup);
    s->index = malloc(vertices * sizeof *s->index);
    s->instance = malloc(vertices * sizeof *s->instance);
    s->clip_x = malloc(4 * vertices * sizeof *s->clip_x);
    s->code = malloc(vertices * sizeof *s->code);
    s->corner[0] = malloc(4 * triangles * sizeof *s->corner[0]);
    s->group = aligned_alloc(64, (size_t)AMB_MAX_VARYINGS * 16 * sizeof *s->group);
    s->tile = aligned_alloc(64, (raster_tile_floats(pass) + spare) * sizeof *s->tile);
    s->packing = make_packing((uint32_t)amb_context_isa(pass->context));
    if (!s->lookup || !s->index || !s->instance || !s->clip_x || !s->code || !s->corner[0] || !s->group || !s->tile ||
        !s->packing)
        return false;
    s->clip_y = s->clip_x + vertices;
    s->clip_z = s->clip_y + vertices;
    s->clip_w = s->clip_z + vertices;
    for (int i = 1; i < 4; i++)
        s->corner[i] = s->corner[i - 1] + triangles;
    return true;
}

static bool make_workers(amb_pass *pass)
{
    int threads = amb_context_threads(pass->context);
    pass->scratch = calloc((size_t)threads, sizeof *pass->scratch);
    if (!pass->scratch)
        return false;
    pass->threads = threads;
    for (int i = 0; i < threads; i++)
        if (!make_scratch(pass, &pass->scratch[i]))
            return false;
    return true;
}

bool raster_reserve_vertices(raster_chunk *chunk, size_t count)
{
    return raster_grow(&chunk->x, &chunk->x_capacity, count, sizeof *chunk->x) &&
           raster_grow(&chunk->y, &chunk->y_capacity, count, sizeof *chunk->y) &&
           raster_grow(&chunk->vertex, &chunk->vertex_capacity, count * chunk->stride, sizeof *chunk->vertex);
}

bool raster_reserve_triangles(raster_chunk *chunk, size_t count)
{
    raster_triangles *t = &chunk->triangle;
    uint32_t **array[6] = {&t->v[0], &t->v[1], &t->v[2], &t->primitive_front, &t->low, &t->high};
    for (int i = 0; i < 6; i++)
        if (!raster_grow(array[i], &t->capacity[i], count, sizeof(uint32_t)))
            return false;
    return true;
}

/* ---- jobs ------------------------------------------------------------------------------------------------------- */

static void chunk_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    raster_chunk *chunk = &pass->chunk[index];
    raster_scratch *scratch = &pass->scratch[thread];
    if (chunk->count == 0)
        return;
    const bool timed = pass->target.time_stages;
    uint64_t lap = raster_start(timed);
    raster_collect(chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_CORNERS, lap);
    if (!raster_reserve_vertices(chunk, (size_t)scratch->unique_count + 16) ||
        !raster_reserve_triangles(chunk, (size_t)scratch->corner_count + 16)) {
        scratch->failed = true;
        return;
    }
    amb_isa isa = amb_context_isa(pass->context);
    AMB_DISPATCH(isa, raster_vertices)(pass, chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_VERTICES, lap);
    AMB_DISPATCH(isa, raster_setup)(pass, chunk, scratch);
    lap = raster_lap(timed, &scratch->stats, AMB_STAGE_SETUP, lap);
    raster_bin(pass, chunk, scratch);
    raster_lap(timed, &scratch->stats, AMB_STAGE_BINS, lap);
}

static bool tile_is_touched(const amb_pass *pass, int tile)
{
    for (size_t i = 0; i < pass->chunk_count; i++) {
        const raster_chunk *chunk = &pass->chunk[i];
        if (chunk->count == 0 || chunk->large_count > 0 || chunk->tile_start[tile] < chunk->tile_start[tile + 1])
            return true;
    }
    return false;
}

static void tile_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    bool waits = pass->last_batch && pass->samples > 1 && pass->tile_store[index]; /* for its samples' average */
    if (!tile_is_touched(pass, index) && !waits)
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

static bool run_batch(amb_pass *pass, bool last)
{
    if (pass->chunk_count == 0)
        return true;
    pass->last_batch = last;
    amb_parallel_for(pass->context, (int)pass->chunk_count, chunk_job, pass);
    if (any_failed(pass))
        return false;
    amb_parallel_for(pass->context, pass->tiles_x * pass->tiles_y, tile_job, pass);
    pass->chunk_count = 0;
    return !any_failed(pass);
}

/* ---- chunks and batches ----------------------------------------------------------------------------------------- */

/* Bytes a chunk may come to hold: what the batch's budget counts. */
static size_t chunk_bytes(const amb_pass *pass, uint32_t triangles, uint32_t stride)
{
    size_t tiles = (size_t)pass->tiles_x * (size_t)pass->tiles_y;
    return (tiles + 1) * sizeof(uint32_t) + (size_t)triangles * (3 * (stride + 2) + 6 + 2) * sizeof(uint32_t);
}

static raster_chunk *next_chunk(amb_pass *pass)
{
    size_t before = pass->chunk_capacity;
    if (!raster_grow(&pass->chunk, &pass->chunk_capacity, pass->chunk_count + 1, sizeof *pass->chunk))
        return NULL;
    memset(pass->chunk + before, 0, (pass->chunk_capacity - before) * sizeof *pass->chunk);
    return &pass->chunk[pass->chunk_count++];
}

static bool run_draws(amb_pass *pass)
{
    size_t bytes = 0;
    for (size_t i = 0; i < pass->draw_count; i++) {
        const raster_draw *draw = &pass->draw[i];
        uint32_t stride = (RASTER_VERTEX_WORDS + (uint32_t)draw->state.varying_floats + 3) & ~3u;
        uint64_t first = 0;
        if ((draw->state.vertex && draw->triangles == 0) || draw->x0 >= draw->x1 || draw->y0 >= draw->y1)
            continue;
        do {
            uint64_t left = draw->triangles - first;
            uint32_t count = left < RASTER_CHUNK_TRIANGLES ? (uint32_t)left : RASTER_CHUNK_TRIANGLES;
            size_t more = chunk_bytes(pass, count, stride);
            if (pass->chunk_count == RASTER_BATCH_CHUNKS ||
                (pass->chunk_count > 0 && bytes + more > pass->batch_bytes)) {
                if (!run_batch(pass, false))
                    return false;
                bytes = 0;
            }
            raster_chunk *chunk = next_chunk(pass);
            if (!chunk)
                return false;
            bytes += more;
            chunk->draw = draw;
            chunk->first = first;
            chunk->count = count;
            chunk->stride = stride;
            chunk->vertex_count = chunk->triangle.count = chunk->large_count = 0;
            first += count;
        } while (first < draw->triangles);
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
    for (size_t i = 0; i < pass->draw_count; i++)
        sum->triangles_in += pass->draw[i].triangles;
    for (int i = 0; i < pass->threads; i++) {
        const amb_pass_stats *s = &pass->scratch[i].stats;
        sum->vertices += s->vertices;
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
