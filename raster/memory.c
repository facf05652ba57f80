/* The memory of a pass, most of which the context keeps for the next one: asking the system for pages again costs more
 * than using them. */
#include "core/spare.h"
#include "raster/internal.h"

#include <stdlib.h>

#define LOOKUP_SLOTS 32768

bool raster_grow(void *array, size_t *capacity, size_t needed, size_t element_bytes)
{
    if (needed <= *capacity)
        return true;
    size_t wanted = *capacity > 0 ? *capacity : needed; /* many arrays never grow */
    while (wanted < needed)
        wanted *= 2;
    if (wanted > SIZE_MAX / element_bytes)
        return false;
    void *old;
    memcpy(&old, array, sizeof old);
    void *grown = realloc(old, wanted * element_bytes);
    if (!grown)
        return false;
    memcpy(array, &grown, sizeof grown);
    *capacity = wanted;
    return true;
}

bool raster_renew(void *array, size_t *capacity, size_t needed, size_t element_bytes)
{
    void *old, *none = NULL;
    if (needed <= *capacity)
        return true;
    memcpy(&old, array, sizeof old);
    free(old);
    memcpy(array, &none, sizeof none);
    *capacity = 0;
    return raster_grow(array, capacity, needed, element_bytes);
}

/* ---- arenas ------------------------------------------------------------------------------------------------------ */

#define ALIGNMENT ((size_t)64)

struct raster_block {
    raster_block *next;
    size_t bytes, used; /* with this header, which takes the first ALIGNMENT bytes */
};

static size_t whole_lines(size_t bytes) { return (bytes + ALIGNMENT - 1) & ~(ALIGNMENT - 1); }

static raster_block *add_block(raster_arena *arena, size_t bytes)
{
    raster_block *block = aligned_alloc(ALIGNMENT, bytes > RASTER_BLOCK_BYTES ? bytes : RASTER_BLOCK_BYTES);
    if (!block)
        return NULL;
    raster_block **place = arena->now ? &arena->now->next : &arena->first;
    *block = (raster_block){*place, bytes > RASTER_BLOCK_BYTES ? bytes : RASTER_BLOCK_BYTES, ALIGNMENT};
    return *place = block;
}

void *raster_take(raster_arena *arena, size_t bytes)
{
    if (bytes > SIZE_MAX / 2)
        return NULL;
    bytes = whole_lines(bytes);
    raster_block *block = arena->now;
    while (block && block->bytes - block->used < bytes)
        block = block->next;
    if (!block)
        block = add_block(arena, bytes + ALIGNMENT);
    if (!block)
        return NULL;
    arena->now = block;
    void *piece = (char *)block + block->used;
    block->used += bytes;
    return piece;
}

void raster_trim(raster_arena *arena, const void *piece, size_t bytes, size_t kept)
{
    if ((const char *)piece + whole_lines(bytes) == (const char *)arena->now + arena->now->used)
        arena->now->used -= whole_lines(bytes) - whole_lines(kept);
}

void raster_reset(raster_arena *arena)
{
    for (raster_block *block = arena->first; block; block = block->next)
        block->used = ALIGNMENT;
    arena->now = arena->first;
}

size_t raster_arena_bytes(const raster_arena *arena)
{
    size_t bytes = 0;
    for (const raster_block *block = arena->first; block; block = block->next)
        bytes += block->used;
    return bytes;
}

static void free_arena(raster_arena *arena)
{
    for (raster_block *block = arena->first, *next; block; block = next) {
        next = block->next;
        free(block);
    }
}

/* Room for `count` records in all, of which the first `used` are kept; false when out of memory. */
static bool reserve(raster_arena *arena, void *array, size_t *capacity, size_t used, size_t count, size_t record_bytes)
{
    if (count <= *capacity)
        return true;
    const size_t wanted = 2 * *capacity > count ? 2 * *capacity : count;
    void *old, *grown = raster_take(arena, wanted * record_bytes);
    if (!grown)
        return false;
    memcpy(&old, array, sizeof old);
    if (used > 0)
        memcpy(grown, old, used * record_bytes);
    memcpy(array, &grown, sizeof grown);
    *capacity = wanted;
    return true;
}

bool raster_reserve_vertices(raster_chunk *chunk, raster_scratch *scratch, size_t count)
{
    return reserve(&scratch->batch, &chunk->vertex, &chunk->vertex_capacity, chunk->vertex_count, count,
                   chunk->stride * sizeof *chunk->vertex);
}

bool raster_reserve_triangles(raster_chunk *chunk, raster_scratch *scratch, size_t count)
{
    return reserve(&scratch->batch, &chunk->triangle, &chunk->triangle_capacity, chunk->triangle_count, count,
                   sizeof *chunk->triangle);
}

/* ---- workers ----------------------------------------------------------------------------------------------------- */

static void free_scratch(raster_scratch *scratch)
{
    free(scratch->lookup);
    free(scratch->local_of);
    free(scratch->index);
    free(scratch->instance);
    free(scratch->clip_x);
    free(scratch->code);
    free(scratch->corner_memory);
    free(scratch->tile_of);
    free(scratch->other_memory);
    free(scratch->group);
    free(scratch->tile);
    free(scratch->packing);
    free(scratch->patch);
    free(scratch->u);
    free(scratch->seen);
    for (int i = 0; scratch->patterns && i < RASTER_PATTERN_SLOTS; i++)
        raster_free_pattern(&scratch->patterns->slot[i]);
    free(scratch->patterns);
    free(scratch->constants);
    free(scratch->corners);
    free(scratch->primary);
    free(scratch->emitted);
    free_arena(&scratch->batch);
}

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

/* What was made for an earlier pass stays. */
static bool make_scratch(const amb_pass *pass, raster_scratch *s)
{
    const size_t vertices = RASTER_CHUNK_VERTICES + 16, corners = RASTER_CHUNK_EMITTED + 16; /* lanes of padding */
    if (!s->packing) {                                                                       /* made last */
        free_scratch(s);
        *s = (raster_scratch){0};
        s->lookup = calloc(LOOKUP_SLOTS, sizeof *s->lookup);
        s->local_of = malloc(RASTER_INDEX_SPAN * sizeof *s->local_of);
        s->index = malloc(vertices * sizeof *s->index);
        s->instance = malloc(vertices * sizeof *s->instance);
        s->clip_x = malloc(4 * vertices * sizeof *s->clip_x);
        s->code = malloc(vertices * sizeof *s->code);
        s->corner_memory = malloc(4 * corners * sizeof *s->corner_memory);
        s->tile_of = malloc(RASTER_TRIANGLES * sizeof *s->tile_of);
        s->group = aligned_alloc(64, (size_t)AMB_MAX_VARYINGS * 16 * sizeof *s->group);
        if (!s->lookup || !s->local_of || !s->index || !s->instance || !s->clip_x || !s->code || !s->corner_memory ||
            !s->tile_of || !s->group)
            return false;
        memset(s->group, 0, (size_t)AMB_MAX_VARYINGS * 16 * sizeof *s->group);
        s->clip_y = s->clip_x + vertices;
        s->clip_z = s->clip_y + vertices;
        s->clip_w = s->clip_z + vertices;
        for (int i = 0; i < 4; i++)
            s->corner[i] = s->corner_memory + (size_t)i * corners;
        make_boxes(s);
        s->packing = make_packing((uint32_t)amb_context_isa(pass->context));
    }
    s->stats = (amb_pass_stats){0};
    s->failed = false;
    return s->packing != NULL;
}

static bool make_tile(const amb_pass *pass, raster_scratch *s)
{
    const size_t spare = (size_t)16 * (size_t)pass->planes * (size_t)pass->samples; /* a block */
    const size_t floats = raster_tile_floats(pass) + spare;
    if (floats <= s->tile_capacity)
        return true;
    free(s->tile);
    s->tile = aligned_alloc(64, floats * sizeof *s->tile);
    s->tile_capacity = s->tile ? floats : 0;
    return s->tile != NULL;
}

/* What patches need. */
static bool make_patch_scratch(raster_scratch *s)
{
    const size_t vertices = RASTER_CHUNK_VERTICES + 16;
    if (s->v) /* set last */
        return true;
    s->patch = s->patch ? s->patch : malloc(vertices * sizeof *s->patch);
    s->u = s->u ? s->u : malloc(2 * vertices * sizeof *s->u);
    s->seen = s->seen ? s->seen : malloc(RASTER_PATTERN_POINTS * sizeof *s->seen);
    s->patterns = s->patterns ? s->patterns : calloc(1, sizeof *s->patterns);
    s->constants = s->constants ? s->constants : aligned_alloc(64, (size_t)AMB_MAX_PATCH_FLOATS * 16 * sizeof(float));
    s->corners = s->corners ? s->corners : aligned_alloc(64, (size_t)AMB_MAX_PATCH_CORNERS * 16 * sizeof(int32_t));
    if (!s->patch || !s->u || !s->seen || !s->patterns || !s->constants || !s->corners)
        return false;
    s->v = s->u + vertices;
    return true;
}

/* What geometry shaders need: primary: floats of a vertex that goes in; emitted: of all that one primitive emits. */
static bool make_geometry_scratch(raster_scratch *s, size_t primary, size_t emitted)
{
    const size_t corners = RASTER_CHUNK_EMITTED + 16, before = s->emitted_capacity;
    if (!raster_renew(&s->primary, &s->primary_capacity, primary * (RASTER_CHUNK_VERTICES + 16), sizeof *s->primary) ||
        !raster_renew(&s->emitted, &s->emitted_capacity, (emitted + 3) * 16, sizeof *s->emitted))
        return false;
    if (s->emitted_capacity > before) /* varyings are read by four */
        memset(s->emitted, 0, s->emitted_capacity * sizeof *s->emitted);
    if (s->other_memory)
        return true;
    s->other_memory = malloc(4 * corners * sizeof *s->other_memory);
    if (!s->other_memory)
        return false;
    for (int i = 0; i < 4; i++)
        s->other_corner[i] = s->other_memory + (size_t)i * corners;
    return true;
}

bool raster_make_workers(amb_pass *pass)
{
    const int threads = amb_context_threads(pass->context);
    if (!pass->scratch) {
        const size_t bytes = (size_t)threads * sizeof *pass->scratch;
        pass->scratch = aligned_alloc(_Alignof(raster_scratch), bytes);
        if (!pass->scratch)
            return false;
        memset(pass->scratch, 0, bytes);
    }
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
        if (!make_scratch(pass, s) || !make_tile(pass, s) || (patches && !make_patch_scratch(s)) ||
            (emitted > 0 && !make_geometry_scratch(s, primary, emitted)))
            return false;
    }
    return raster_make_patches(pass);
}

/* ---- from pass to pass ------------------------------------------------------------------------------------------- */

struct raster_spare {
    raster_chunk *chunk;
    raster_draw *draw;
    size_t chunk_capacity, draw_capacity;
    raster_arena arena;
    raster_scratch *scratch;
    int threads;
};

static void release(void *block)
{
    raster_spare *spare = block;
    for (int i = 0; i < spare->threads; i++)
        free_scratch(&spare->scratch[i]);
    free(spare->scratch);
    free_arena(&spare->arena);
    free(spare->chunk);
    free(spare->draw);
    free(spare);
}

bool raster_take_spare(amb_pass *pass)
{
    raster_spare *spare = amb_spare_take(pass->context);
    if (!spare)
        spare = calloc(1, sizeof *spare);
    if (!spare)
        return false;
    pass->spare = spare;
    pass->chunk = spare->chunk, pass->chunk_capacity = spare->chunk_capacity;
    pass->draw = spare->draw, pass->draw_capacity = spare->draw_capacity;
    pass->arena = spare->arena;
    pass->scratch = spare->scratch, pass->threads = spare->threads;
    return true;
}

void raster_keep_spare(amb_pass *pass)
{
    if (!pass->spare)
        return;
    raster_reset(&pass->arena);
    for (int i = 0; i < pass->threads; i++)
        raster_reset(&pass->scratch[i].batch);
    *pass->spare = (raster_spare){pass->chunk, pass->draw,    pass->chunk_capacity, pass->draw_capacity,
                                  pass->arena, pass->scratch, pass->threads};
    amb_spare_keep(pass->context, pass->spare, release);
}
