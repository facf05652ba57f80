/* Patches: a draw's are hull-shaded a window at a time, so that memory does not grow with their number. When it is
 * known how finely each is cut, the window is divided into chunks of bounded size; a patch too large for one continues
 * in the next. Chunks collect their points and corners from the patterns of tessellate.c. */
#include "core/dispatch.h"
#include "raster/clock.h"
#include "raster/internal.h"

#include <stdlib.h>

AMB_DECLARE_WIDE(void, raster_hull,
                 (amb_pass * pass, const raster_draw *draw, uint32_t first, uint32_t count, raster_scratch *scratch));

/* ---- windows ---------------------------------------------------------------------------------------------------- */

static size_t patch_bytes(const amb_tessellation *t)
{
    return sizeof(raster_factors) + sizeof(uint32_t) * (2 + (size_t)t->patch_floats + (size_t)t->corners);
}

/* A draw's window: as many patches as fit its bytes, in whole groups. */
static uint32_t window_of(const raster_draw *draw)
{
    const size_t fit = RASTER_PATCH_BYTES / patch_bytes(&draw->state.tessellation);
    const uint64_t groups = (draw->triangles + RASTER_PATCH_GROUP - 1) / RASTER_PATCH_GROUP;
    uint32_t window = fit < RASTER_PATCH_WINDOW ? (uint32_t)fit & ~(RASTER_PATCH_GROUP - 1u) : RASTER_PATCH_WINDOW;
    return groups * RASTER_PATCH_GROUP < window ? (uint32_t)groups * RASTER_PATCH_GROUP : window;
}

bool raster_make_patches(amb_pass *pass)
{
    size_t patches = 0, floats = 0, corners = 0;
    for (size_t i = 0; i < pass->draw_count; i++) {
        const raster_draw *draw = &pass->draw[i];
        if (!draw->patches)
            continue;
        const size_t window = window_of(draw), f = window * (size_t)draw->state.tessellation.patch_floats,
                     c = window * (size_t)draw->state.tessellation.corners;
        patches = window > patches ? window : patches;
        floats = f > floats ? f : floats;
        corners = c > corners ? c : corners;
    }
    if (patches == 0)
        return true;
    pass->patches.factors = raster_take(&pass->arena, patches * sizeof *pass->patches.factors);
    pass->patches.points = raster_take(&pass->arena, patches * sizeof *pass->patches.points);
    pass->patches.primitives = raster_take(&pass->arena, patches * sizeof *pass->patches.primitives);
    pass->patches.constants = raster_take(&pass->arena, floats * sizeof *pass->patches.constants);
    pass->patches.corners = raster_take(&pass->arena, corners * sizeof *pass->patches.corners);
    return pass->patches.factors && pass->patches.points && pass->patches.primitives && pass->patches.constants &&
           pass->patches.corners;
}

static void hull_job(void *user, int index, int thread)
{
    amb_pass *pass = user;
    const uint32_t first = (uint32_t)index * RASTER_PATCH_GROUP, left = pass->patches.count - first;
    const bool timed = pass->target.time_stages;
    const uint64_t lap = raster_start(timed);
    AMB_DISPATCH(amb_context_isa(pass->context), raster_hull)
    (pass, pass->patches.draw, first, left < RASTER_PATCH_GROUP ? left : RASTER_PATCH_GROUP, &pass->scratch[thread]);
    raster_lap(timed, &pass->scratch[thread].stats, AMB_STAGE_VERTICES, lap);
}

/* Whole patches fill a chunk as long as they fit; one too large for a chunk of its own is divided. */
static bool cut_window(amb_pass *pass, const raster_draw *draw)
{
    raster_chunk chunk = {.draw = draw};
    for (uint32_t patch = 0; patch < pass->patches.count; patch++) {
        const uint32_t points = pass->patches.points[patch], primitives = pass->patches.primitives[patch];
        for (uint32_t used = 0; used < primitives;) {
            const uint32_t left = primitives - used, room = draw->chunk_most - chunk.count;
            if (chunk.count > 0 && left > room) {
                if (!raster_add_chunk(pass, &chunk))
                    return false;
                chunk.count = chunk.most_vertices = 0;
                continue;
            }
            if (chunk.count == 0)
                chunk.patch = patch, chunk.skipped = used;
            const uint32_t taken = left < room ? left : room;
            chunk.count += taken;
            chunk.most_vertices += points < 3 * taken ? points : 3 * taken;
            used += taken;
        }
    }
    return (chunk.count == 0 || raster_add_chunk(pass, &chunk)) && raster_ready_chunks(pass);
}

bool raster_run_patches(amb_pass *pass, const raster_draw *draw)
{
    const uint32_t window = window_of(draw);
    pass->patches.draw = draw;
    for (uint64_t first = 0; first < draw->triangles; first += window) {
        const uint64_t left = draw->triangles - first;
        pass->patches.first = first;
        pass->patches.count = left < window ? (uint32_t)left : window;
        const uint32_t jobs = (pass->patches.count + RASTER_PATCH_GROUP - 1) / RASTER_PATCH_GROUP;
        amb_parallel_for(pass->context, (int)jobs, hull_job, pass);
        if (!cut_window(pass, draw))
            return false;
    }
    return true;
}

/* ---- a chunk's points and corners ------------------------------------------------------------------------------- */

static uint32_t add_point(raster_scratch *scratch, const raster_pattern *pattern, uint32_t point, uint32_t patch)
{
    const uint32_t local = scratch->unique_count++;
    scratch->u[local] = pattern->u[point];
    scratch->v[local] = pattern->v[point];
    scratch->patch[local] = (int32_t)patch;
    return local;
}

static void add_corners(raster_scratch *scratch, uint32_t a, uint32_t b, uint32_t c, uint32_t number)
{
    const uint32_t n = scratch->corner_count++;
    scratch->corner[0][n] = a;
    scratch->corner[1][n] = b;
    scratch->corner[2][n] = c;
    scratch->corner[3][n] = number;
}

static void collect_points(raster_scratch *scratch, const raster_pattern *pattern, uint32_t first, uint32_t count,
                           uint32_t patch, uint32_t number)
{
    for (uint32_t i = first; i < first + count; i++) {
        uint32_t local = add_point(scratch, pattern, i, patch);
        add_corners(scratch, local, local, local, number);
    }
}

static void collect_whole(raster_scratch *scratch, const raster_pattern *pattern, uint32_t patch, uint32_t number,
                          bool clockwise)
{
    const uint32_t base = scratch->unique_count, turn = clockwise ? 1 : 0;
    for (uint32_t i = 0; i < (uint32_t)pattern->size.points; i++)
        add_point(scratch, pattern, i, patch);
    for (uint32_t i = 0; i < (uint32_t)pattern->size.triangles; i++) {
        const uint16_t *corner = pattern->corner + (size_t)3 * i;
        add_corners(scratch, base + corner[0], base + corner[1 + turn], base + corner[2 - turn], number);
    }
}

/* Some of a patch's triangles, and only the points they need. */
static void collect_part(raster_scratch *scratch, const raster_pattern *pattern, uint32_t first, uint32_t count,
                         uint32_t patch, uint32_t number, bool clockwise)
{
    memset(scratch->seen, 0, (size_t)pattern->size.points * sizeof *scratch->seen);
    for (uint32_t i = first; i < first + count; i++) {
        const uint16_t *corner = pattern->corner + (size_t)3 * i;
        uint32_t local[3];
        for (int k = 0; k < 3; k++) {
            uint16_t *seen = &scratch->seen[corner[k]];
            if (*seen == 0)
                *seen = (uint16_t)(add_point(scratch, pattern, corner[k], patch) + 1);
            local[k] = *seen - 1u;
        }
        add_corners(scratch, local[0], local[clockwise ? 2 : 1], local[clockwise ? 1 : 2], number);
    }
}

void raster_collect_patches(const amb_pass *pass, const raster_chunk *chunk, raster_scratch *scratch)
{
    const amb_tessellation *t = &chunk->draw->state.tessellation;
    uint32_t skipped = chunk->skipped;
    scratch->unique_count = scratch->corner_count = 0;
    for (uint32_t patch = chunk->patch; scratch->corner_count < chunk->count; patch++, skipped = 0) {
        const uint32_t whole = pass->patches.primitives[patch], room = chunk->count - scratch->corner_count,
                       number = (uint32_t)pass->patches.first + patch;
        if (whole == 0)
            continue;
        const raster_pattern *pattern =
            raster_find_pattern(scratch->patterns, t->shape, t->partitioning, &pass->patches.factors[patch]);
        if (!pattern) {
            scratch->failed = true;
            return;
        }
        const uint32_t count = whole - skipped < room ? whole - skipped : room;
        if (t->points)
            collect_points(scratch, pattern, skipped, count, patch, number);
        else if (count == whole)
            collect_whole(scratch, pattern, patch, number, t->clockwise);
        else
            collect_part(scratch, pattern, skipped, count, patch, number, t->clockwise);
    }
    scratch->stats.domain_points += scratch->unique_count;
    if (!chunk->draw->state.geometry.shader)
        scratch->stats.triangles_in += scratch->corner_count;
}
