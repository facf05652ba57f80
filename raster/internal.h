/* What the rasterizer's stages share. The way of a triangle:
 *
 *   pass.c        records draws and checks them; batch.c cuts them into chunks, runs batches of chunks, then the tiles
 *   collect.c     gathers a chunk's corners, each vertex once
 *   vertex_wide.c shades those vertices
 *     or, for patches:
 *   hull_wide.c   shades a window of patches; patches.c cuts it into chunks of bounded size
 *   tessellate.c  places points and triangles in each patch's domain; patches.c gathers a chunk's
 *   domain_wide.c shades those points
 *     then, for both:
 *   geometry_wide.c runs the geometry shader, if there is one, over the chunk's primitives
 *   vertex.h      takes vertices to the window
 *   setup_wide.c  drops, culls and bounds the chunk's triangles; setup.c clips (clip.c) those that need it
 *   bin.c         sorts them into the tiles they touch
 *   memory.c      holds the memory of all that, which a context keeps from pass to pass
 *   target.c      checks and clears attachments; formats.h says what they store
 *   tile_wide.c   plays all chunks of a batch over one tile: coverage, then fragment.h: depth, shading, blending
 *
 * A batch is bounded in bytes, so memory does not grow with the number of triangles. */
#ifndef AMBIANCE_RASTER_INTERNAL_H
#define AMBIANCE_RASTER_INTERNAL_H

#include "raster/formats.h"
#include "raster/tessellate.h"

#define RASTER_SUBPIXEL 256 /* fixed-point steps a pixel */
#define RASTER_GUARD_PIXELS \
    262144.0 /* the guard band reaches at most this far from the window's centre, at least half */
#define RASTER_GRID_PIXELS 524288.0f /* window coordinates beyond are nowhere */
#define RASTER_CHUNK_TRIANGLES 4096  /* triangles a chunk, before clipping */
#define RASTER_TRIANGLES 65536       /* a chunk may hold after it */
#define RASTER_CHUNK_VERTICES (3 * RASTER_CHUNK_TRIANGLES)
#define RASTER_INDEX_SPAN 32768   /* of a chunk whose indices are looked up in a table */
#define RASTER_CHUNK_EMITTED 6144 /* vertices and primitives a chunk's geometry shader may emit */
#define RASTER_PATCH_GROUP 256    /* patches a job of the hull stage */
#define RASTER_PATCH_WINDOW 16384 /* patches hull-shaded at a time, at most */
#define RASTER_PATCH_BYTES ((size_t)8 << 20)
#define RASTER_POLYGON 9          /* vertices of a triangle clipped by six planes */
#define RASTER_LARGE_TILES 16     /* triangles on more tiles than this are not binned but offered to every tile */
#define RASTER_MAX_TILE 128       /* pixels, tile edge */
#define RASTER_BATCH_CHUNKS 16384 /* their numbers fit 16 bits */
#define RASTER_BLOCK_BYTES ((size_t)1 << 20) /* of arenas, at least */
#define RASTER_THREAD_JOBS 32                /* of the geometry stages, a thread, at most: enough for an even load */
#define RASTER_UNBINNED 64 /* triangles of a chunk that is not worth bins: each of its tiles looks at all */
#define RASTER_BATCH_BYTES ((size_t)24 << 20) /* for two threads; half of it more for each further one */
#define RASTER_NOWHERE (1 << 30)              /* beyond every window coordinate */
#define RASTER_MAX_POINT 4096.0f
#define RASTER_VERTEX_WORDS 4 /* of raster_vertex before its varyings */
#define RASTER_MAX_SAMPLES 8
#define RASTER_TILE 64
#define RASTER_SMALL_BOX 8 /* quads, edge: small triangles are played together, quad by quad */

/* Clip codes of a vertex. */
enum {
    RASTER_NEAR = 1,
    RASTER_FAR = 2,
    RASTER_LEFT = 4,
    RASTER_RIGHT = 8,
    RASTER_BOTTOM = 16,
    RASTER_TOP = 32,
    RASTER_INVALID = 64, /* NaN, infinite or w = 0: takes its triangles with it */
};

typedef struct raster_draw {
    amb_draw state;        /* its uniforms are a copy */
    uint32_t per_instance; /* primitives or patches, as they go in */
    uint64_t triangles;    /* the same, of all instances; 0 for full-screen draws */
    uint32_t chunk_most;   /* primitives of a chunk, before a geometry shader */
    bool screen, patches;  /* what kind of draw */
    int x0, y0, x1, y1;    /* scissor inside the target, ends exclusive */
    bool lines, points;    /* what triangle-like records hold: wireframe draws are lines too */
    bool wireframe;        /* lines that are edges of triangles */
} raster_draw;

/* A vertex after the vertex stage: four words that are fetched at once; the varyings follow, and padding to a multiple
 * of four words: four floats can be read wherever one can. */
typedef struct raster_vertex {
    float z; /* depth 0…1 */
    float inverse_w;
    int32_t x, y; /* window, 1/256 pixel; x is RASTER_NOWHERE where a triangle would need clipping */
    float varying[];
} raster_vertex;

/* A triangle left by set-up: 16 bits of each word are a vertex number, ordered so that the doubled area is positive
 * with y down, or the first pixel's x. Tiles fetch all four words at once, lanes-wide. Bounds are inclusive, inside the
 * target, of pixels that may be covered. */
typedef struct raster_triangle {
    uint32_t v0_primitive; /* << 16: running number from the chunk's `primitive` on; top bit: front face */
    uint32_t v1_x1, v2_y1; /* << 16: last pixel */
    uint32_t x0_y0;        /* first pixel, x | y << 16 */
} raster_triangle;

_Static_assert(RASTER_CHUNK_VERTICES + RASTER_POLYGON * RASTER_CHUNK_TRIANGLES <= 65536, "16-bit vertex numbers");
_Static_assert((1 + RASTER_POLYGON) * RASTER_CHUNK_EMITTED <= 65536, "16-bit vertex numbers");
_Static_assert((RASTER_POLYGON - 2) * RASTER_CHUNK_EMITTED <= RASTER_TRIANGLES, "16-bit triangle numbers");
_Static_assert((RASTER_POLYGON - 2) * RASTER_CHUNK_TRIANGLES <= RASTER_TRIANGLES, "16-bit triangle numbers");
_Static_assert(RASTER_PATCH_WINDOW <= 32768 && RASTER_CHUNK_TRIANGLES <= 32768, "15-bit primitive numbers");

typedef struct raster_chunk {
    const raster_draw *draw;
    uint64_t first; /* triangle of the draw */
    uint32_t count; /* triangles; 0: a full-screen draw */
    uint32_t
        patch; /* or: first is 0, and from this patch of the window on, after `skipped` of its triangles, so many */
    uint32_t skipped;
    uint32_t most_vertices; /* before it has any */

    uint32_t *vertex; /* raster_vertex records of `stride` words each */
    uint32_t stride, vertex_count;
    size_t vertex_capacity, triangle_capacity; /* records */
    raster_triangle *triangle;
    uint32_t triangle_count;
    uint32_t primitive;                          /* running number in the draw of the first */
    uint16_t tile_x0, tile_y0, tile_x1, tile_y1; /* tiles that the triangles' boxes touch */
    bool binned;                                 /* else every tile of them looks at all triangles */
    uint32_t *tile_start;                        /* tiles + 1: where each tile's entries start */
    uint16_t *entry;                             /* triangle numbers, tile by tile, ascending */
    uint16_t *large;                             /* those on many tiles, ascending */
    uint32_t large_count;
} raster_chunk;

static inline raster_vertex *raster_vertex_at(const raster_chunk *chunk, uint32_t number)
{
    return (raster_vertex *)(void *)(chunk->vertex + (size_t)number * chunk->stride);
}

/* primitive_front: running number in the draw, top bit: front face. Bounds as in raster_triangle. */
static inline raster_triangle raster_make_triangle(const raster_chunk *chunk, const uint32_t v[3],
                                                   uint32_t primitive_front, int x0, int y0, int x1, int y1)
{
    return (raster_triangle){.v0_primitive =
                                 v[0] | (primitive_front - chunk->primitive) << 16 | (primitive_front & 1u << 31),
                             .v1_x1 = v[1] | (uint32_t)x1 << 16,
                             .v2_y1 = v[2] | (uint32_t)y1 << 16,
                             .x0_y0 = (uint32_t)x0 | (uint32_t)y0 << 16};
}

/* Memory that is taken piece by piece and given back as a whole. */
typedef struct raster_block raster_block;
typedef struct raster_arena {
    raster_block *first, *now;
} raster_arena;

/* One worker's own memory: on cache lines of its own, for others count in theirs all the time. */
typedef struct raster_scratch {
    _Alignas(128) raster_arena batch; /* what the batch's chunks hold */
    uint64_t *lookup;                 /* index → local vertex: key, generation, local number */
    uint32_t generation;
    uint16_t *local_of;        /* index less the chunk's lowest → local vertex + 1, where that range is small */
    int32_t *index, *instance; /* of the chunk's unique vertices, padded to the lanes */
    int32_t *patch;            /* of the chunk's points: number in the window */
    float *u, *v;
    uint16_t *seen; /* by point of a pattern: its local number + 1, where only a part of the patch is drawn */
    raster_pattern_cache *patterns;
    float *constants; /* of one group of points: what the hull shader wrote */
    int32_t *corners; /* and its patches' index values */
    float *primary;   /* clip position and varyings of vertices that go to a geometry shader */
    float *emitted;   /* [vertex][clip position and varyings][lane] of one group of primitives */
    float *clip_x, *clip_y, *clip_z, *clip_w;
    int32_t *code;
    uint32_t *corner[4]; /* of the triangles: three local vertices, running number; padded to the lanes */
    uint32_t *corner_memory, *other_memory;
    uint32_t *other_corner[4]; /* room for what a geometry shader makes of them */
    uint32_t corner_count, unique_count;
    uint32_t *tile_of; /* of the chunk's triangles, while they are binned */
    float *group;      /* varyings of one group of vertices, as the shader writes them */
    float *tile;       /* colour and depth of one tile, block by block */
    int32_t *packing;  /* [wanted][first][lane]: source lanes that bring a block's wanted quads to slots first… */
    int32_t boxes[RASTER_SMALL_BOX * RASTER_SMALL_BOX][RASTER_SMALL_BOX * RASTER_SMALL_BOX];
    /* [width - 1 + RASTER_SMALL_BOX · (height - 1), quads][…]: the quads of a box, x << 8 | y << 16 in pixels */
    size_t primary_capacity, emitted_capacity, tile_capacity;
    bool failed; /* out of memory */
    amb_pass_stats stats;
} raster_scratch;

/* Where an attachment's pixels are. */
typedef struct raster_attachment {
    amb_image *image;     /* or, if NULL, */
    amb_texture *texture; /* of one slice of one level */
    int level, slice;
    int channels;
    int first; /* plane of its first channel; plane 0 is depth */
    raster_format format;
    float clear[4]; /* as stored; absent channels 0, alpha 1 */
    uint32_t clear_words[4];
} raster_attachment;

/* A window of a draw's patches after the hull stage, lane group by lane group. */
typedef struct raster_patches {
    const raster_draw *draw;
    uint64_t first; /* patch of the draw */
    uint32_t count;
    raster_factors *factors;
    uint32_t *points, *primitives; /* that each will give */
    float *constants;              /* [group][float][lane] */
    int32_t *corners;              /* [group][corner][lane] */
} raster_patches;

typedef struct raster_spare raster_spare; /* memory.c */

struct amb_pass {
    const amb_context *context;
    amb_target target;
    int width, height;
    int target_count;
    raster_attachment color[AMB_MAX_TARGETS], depth, stencil; /* the last two may have neither image nor texture */
    raster_srgb *srgb;                                        /* NULL without an sRGB attachment */
    int stencil_plane;                                        /* 0: none */
    int planes;                                               /* of one sample */
    int samples;                                              /* 1, 2, 4 or 8 */
    int32_t low_round, high_round; /* pixels that may be covered by lo…hi: (lo + low) >> 8 … (hi - high) >> 8 */
    float **tile_store;            /* per tile, between batches: all its samples; NULL at one sample */
    int tile_size, tiles_x, tiles_y;
    size_t batch_bytes;
    bool last_batch;
    float guard_x, guard_y;
    uint8_t *tile_started; /* per tile: its images hold pixels of this pass */

    raster_draw *draw;
    size_t draw_count, draw_capacity;

    raster_chunk *chunk;
    size_t chunk_count, chunk_capacity; /* of the batch being run */
    raster_arena arena;                 /* what lasts as long as the pass */
    raster_spare *spare;                /* where all this waits for the context's next pass */
    size_t job_chunks;                  /* chunks that a job takes through the geometry stages */
    size_t chunks_ready;                /* of those, through the geometry stages */
    size_t bytes;                       /* what the batch's chunks hold, or may come to hold */
    uint32_t *tile_first;               /* tiles + 1: where each tile's chunks start in tile_chunk */
    uint16_t *tile_chunk;               /* numbers of chunks, tile by tile, ascending */
    size_t tile_chunk_capacity;
    raster_patches patches;
    raster_scratch *scratch;
    int threads;
};

/* Doubling growth of an array to at least `needed` elements; false when out of memory. */
bool raster_grow(void *array, size_t *capacity, size_t needed, size_t element_bytes);
/* The same for an array whose contents nobody needs: they are not copied. */
bool raster_renew(void *array, size_t *capacity, size_t needed, size_t element_bytes);

/* `bytes` of the arena's, beginning with a cache line; NULL when out of memory. */
void *raster_take(raster_arena *arena, size_t bytes);
/* Gives back all but the first `kept` bytes of a piece, if none was taken since. */
void raster_trim(raster_arena *arena, const void *piece, size_t bytes, size_t kept);
/* Gives everything back; the memory stays the arena's. */
void raster_reset(raster_arena *arena);
size_t raster_arena_bytes(const raster_arena *arena);

/* The memory that a pass before has left in the context, or none; false when out of memory. */
bool raster_take_spare(amb_pass *pass);
void raster_keep_spare(amb_pass *pass);
/* Workers with all that the pass's draws need; false when out of memory. */
bool raster_make_workers(amb_pass *pass);

/* Room for that many vertices or triangles in all; false when out of memory. */
bool raster_reserve_vertices(raster_chunk *chunk, raster_scratch *scratch, size_t count);
bool raster_reserve_triangles(raster_chunk *chunk, raster_scratch *scratch, size_t count);
/* Floats of a tile in a worker's memory, without the spare block. */
static inline size_t raster_tile_floats(const amb_pass *pass)
{
    return (size_t)pass->tile_size * (size_t)pass->tile_size * (size_t)pass->planes * (size_t)pass->samples;
}

/* Checks pass->target and fills what follows from it. */
amb_status raster_prepare_target(amb_pass *pass, amb_error *error);
/* Gives pixels x0…x1-1, y0…y1-1 the clear value. */
void raster_clear_pixels(const raster_attachment *attachment, int x0, int y0, int x1, int y1);
/* Refreshes the borders of textures that were rendered into. */
void raster_finish_textures(const amb_pass *pass);

/* Adds a chunk to the batch, running the batch before that if it is full. */
bool raster_add_chunk(amb_pass *pass, const raster_chunk *chunk);
/* Takes the batch's chunks through the geometry stages. */
bool raster_ready_chunks(amb_pass *pass);
/* Memory for the largest window that the pass's draws need; false when out of memory. */
bool raster_make_patches(amb_pass *pass);
/* Shades a draw's patches, window by window, and adds their chunks. */
bool raster_run_patches(amb_pass *pass, const raster_draw *draw);
/* Points and corners of a chunk of patches. Sets scratch->failed. */
void raster_collect_patches(const amb_pass *pass, const raster_chunk *chunk, raster_scratch *scratch);
void raster_collect(const raster_chunk *chunk, raster_scratch *scratch);
/* One triangle the lanes leave alone: clipped, or too large for 32-bit areas. Sets scratch->failed. */
void raster_setup_one(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t corner);
/* Wireframe triangles, lines and points. */
void raster_setup_lines(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);
/* Appends a vertex made by clipping: a clip position and the weights of corners 1 and 2. False when it lands nowhere.
 * The array has room. */
bool raster_make_vertex(const amb_pass *pass, raster_chunk *chunk, const uint32_t corner[3], const double clip[4],
                        const double weight[2], uint32_t *number);
void raster_bin(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);
/* Lists, for every tile, the batch's chunks that touch it; false when out of memory. */
bool raster_list_chunks(amb_pass *pass);

typedef struct raster_polygon_vertex {
    double clip[4];   /* x, y, z, w */
    double weight[2]; /* of the triangle's corners 1 and 2 */
    int corner;       /* 0…2: an original corner, -1: a new vertex */
} raster_polygon_vertex;

typedef struct raster_polygon {
    int count;
    raster_polygon_vertex vertex[RASTER_POLYGON];
} raster_polygon;
/* Cuts the polygon with the planes named in `codes`, in the order of their bits. */
void raster_clip(raster_polygon *polygon, unsigned codes, double guard_x, double guard_y);
/* The same for the segment from vertex 0 to vertex 1; false when nothing is left. */
bool raster_clip_line(raster_polygon *line, unsigned codes, double guard_x, double guard_y);

/* The tests' knobs; pixels depend on neither. tile_size: 16, 32, 64 or 128 pixels, 0: what fits best; batch_bytes: what
 * a batch may hold before its tiles are played (0: at least one chunk). */
amb_status raster_pass_begin(const amb_context *context, const amb_target *target, int tile_size, size_t batch_bytes,
                             amb_pass **out, amb_error *error);

#endif
