/* The rasterizer: record draws into a pass, finish the pass, read the target.
 *
 *   amb_pass *pass = NULL;
 *   amb_pass_begin(context, &target, &pass, error);
 *   amb_pass_draw(pass, &draw, error);           // any number; recorded, not run
 *   amb_pass_finish(&pass, &stats, error);       // runs every tile, playing all draws in order
 *
 * Rules are a GPU's: window coordinates snapped to 1/256 pixel (round half to even), int64 edge functions, pixel
 * centres at .5, top-left rule, near clip and guard band, depth 0…1, perspective-correct varyings. Pixels do not
 * depend on threads, tile size, lanes or which lanes share a block. */
#ifndef AMBIANCE_RASTER_H
#define AMBIANCE_RASTER_H

#include <ambiance/context.h>
#include <ambiance/texture.h>

#define AMB_MAX_TARGETS 16  /* colour attachments (AOVs among them) of one pass */
#define AMB_MAX_VARYINGS 64 /* floats a vertex */
#define AMB_MAX_PATCH_CORNERS 32
#define AMB_MAX_PATCH_FLOATS 128
#define AMB_MAX_GEOMETRY_VERTICES 256

/* ---- shaders ---------------------------------------------------------------------------------------------------- */

typedef struct amb_vs_in {
    const void *uniforms;
    i32x vertex; /* index value (indexed draw) or running number; always valid, in dead lanes too */
    i32x instance;
} amb_vs_in;

typedef struct amb_vs_out {
    v4x clip;       /* D3D clip space */
    void *varyings; /* the draw's varyings struct of f32x members, zeroed, to be written */
} amb_vs_out;

typedef struct amb_fs_in {
    const void *uniforms;
    const void *varyings; /* as written by the vertex stage, interpolated */
    f32x x, y;            /* pixel centre in window coordinates, y down; of dead lanes perhaps outside the target */
    f32x depth;           /* 0…1; for full-screen draws the far plane, 1 */
    maskx live;           /* covered lanes that passed the early depth test; others are helpers for derivatives */
    maskx front;          /* front face; lanes may belong to different triangles of the draw, quads never do */
    i32x primitive;       /* running number of the triangle, line, point or patch in its draw, as it went in */
    int thread;           /* 0…threads-1, for per-thread scratch */
} amb_fs_in;

typedef struct amb_fs_out {
    v4x color[AMB_MAX_TARGETS]; /* of attachments 0…; in: zero; channels an attachment lacks are ignored */
    f32x depth;                 /* in: the interpolated depth; read back only if the draw says writes_depth */
    maskx live;                 /* in: as fs_in; clear lanes to discard */
} amb_fs_out;

typedef void (*amb_vertex_shader)(const amb_vs_in *in, amb_vs_out *out);
typedef void (*amb_fragment_shader)(const amb_fs_in *in, amb_fs_out *out);

/* Tessellation: instead of a vertex shader, a hull shader sees every patch once and says how finely to cut it, and a
 * domain shader makes a vertex of every point that the tessellator then places in the patch's domain. */

typedef struct amb_hs_in { /* a patch a lane */
    const void *uniforms;
    const i32x *corner; /* [corners of a patch] index values; always valid, in dead lanes too */
    i32x patch;         /* running number in the draw */
    i32x instance;
} amb_hs_in;

/* Factors are how many segments: D3D11's rules. An edge factor that is NaN or not above 0 culls the patch; others are
 * clamped to 1…64 (2…64 FRACTIONAL_EVEN, 1…63 FRACTIONAL_ODD).
 *   AMB_QUAD      edge 0: u = 0, 1: v = 0, 2: u = 1, 3: v = 1; inside 0: along u, 1: along v
 *   AMB_TRIANGLE  edge 0: u = 0, 1: v = 0, 2: w = 0; inside 0 */
typedef struct amb_hs_out {
    f32x edge[4], inside[2]; /* in: 1 */
    void *constants;         /* the draw's patch struct of f32x members, zeroed, to be written */
} amb_hs_out;

typedef struct amb_ds_in { /* a point a lane; lanes may belong to different patches */
    const void *uniforms;
    const void *constants; /* as written by the hull shader, of each lane's own patch */
    const i32x *corner;
    i32x patch, instance;
    f32x u, v, w; /* multiples of 1/65536 in 0…1, so 1 - u is exact. AMB_TRIANGLE: u + v + w = 1; AMB_QUAD: w = 0 */
} amb_ds_in;

typedef void (*amb_hull_shader)(const amb_hs_in *in, amb_hs_out *out);
typedef void (*amb_domain_shader)(const amb_ds_in *in, amb_vs_out *out);

/* The geometry stage: a shader sees whole primitives and emits up to a fixed number of vertices for each, as strips. */

typedef struct amb_gs_in { /* a primitive a lane */
    const void *uniforms;
    v4x clip[3];             /* of its one, two or three corners, from the vertex or domain shader */
    const void *varyings[3]; /* the draw's struct of f32x members */
    i32x primitive;          /* running number of the triangle, line, point or patch in its draw */
    maskx live;
} amb_gs_in;

typedef struct amb_gs_out {
    v4x clip;       /* of the vertex to be emitted next; in: zero */
    void *varyings; /* the struct of f32x members that the fragment shader gets; in: zeroed */
    i32x count;     /* vertices emitted so far; at the draw's most, further ones are ignored */
    void (*emit)(struct amb_gs_out *out, maskx live);
    void (*cut)(struct amb_gs_out *out, maskx live);
} amb_gs_out;

/* Appends the vertex held by `out` to the strips of the live lanes. `out` keeps it. */
AMB_INLINE void amb_emit(amb_gs_out *out, maskx live) { out->emit(out, live); }
/* Ends the strips of the live lanes; their next vertex begins another. */
AMB_INLINE void amb_cut(amb_gs_out *out, maskx live) { out->cut(out, live); }

typedef void (*amb_geometry_shader)(const amb_gs_in *in, amb_gs_out *out);

/* ---- state ------------------------------------------------------------------------------------------------------ */

typedef enum amb_cull { AMB_CULL_NONE, AMB_CULL_BACK, AMB_CULL_FRONT } amb_cull;
typedef enum amb_topology {
    AMB_TRIANGLES,      /* corners 3i, 3i+1, 3i+2 */
    AMB_TRIANGLE_STRIP, /* i, i+1, i+2; odd triangles take the last two in the other order, so that faces agree */
    AMB_TRIANGLE_FAN,   /* 0, i+1, i+2 */
    AMB_LINES,          /* 2i, 2i+1; one pixel wide, diamond-exit rule, never culled, always front */
    AMB_LINE_STRIP,     /* i, i+1 */
    AMB_POINTS,         /* i; squares of point_size, top-left rule, never culled, always front */
    AMB_PATCHES,        /* n·i … n·i + n-1, with n corners; needs amb_draw.tessellation */
} amb_topology;         /* an index at or above vertex_count drops what uses it, so it also cuts strips */

typedef enum amb_patch_shape { AMB_QUAD, AMB_TRIANGLE } amb_patch_shape; /* of the domain */

/* How a factor becomes segments. INTEGER: rounded up. FRACTIONAL: the next odd or even number; between them a point of
 * each half edge splits in two and its halves drift apart, so that nothing jumps when a factor changes smoothly. */
typedef enum amb_partitioning { AMB_INTEGER, AMB_FRACTIONAL_ODD, AMB_FRACTIONAL_EVEN } amb_partitioning;

/* For AMB_PATCHES, without a vertex shader. Triangles come out patch by patch, in a fixed order, counter-clockwise in a
 * picture of the domain with u to the right and v up (D3D11's triangle_cw, whose v points down). */
typedef struct amb_tessellation {
    amb_hull_shader hull;
    amb_domain_shader domain;
    int corners;      /* of a patch, 1…AMB_MAX_PATCH_CORNERS */
    int patch_floats; /* sizeof(constants) / sizeof(f32x), 0…AMB_MAX_PATCH_FLOATS */
    amb_patch_shape shape;
    amb_partitioning partitioning;
    bool clockwise; /* turn the triangles over */
    bool points;    /* no triangles: every point of the domain once */
} amb_tessellation;

/* After the vertex or domain shader. Its input is the draw's topology, points or triangles of a tessellation. */
typedef struct amb_geometry {
    amb_geometry_shader shader;
    amb_topology output; /* AMB_TRIANGLES: strips of triangles; AMB_LINES: line strips; AMB_POINTS */
    int vertices;        /* the most one primitive emits, 1…AMB_MAX_GEOMETRY_VERTICES */
    int input_floats;    /* sizeof(its input's varyings) / sizeof(f32x); 0: the draw's varying_floats */
} amb_geometry;

typedef enum amb_blend {
    AMB_BLEND_OFF,
    AMB_BLEND_ALPHA,    /* src·a + dst·(1-a); alpha: a + dst·(1-a) */
    AMB_BLEND_ADD,      /* src + dst */
    AMB_BLEND_MULTIPLY, /* src · dst */
    AMB_BLEND_EQUATION, /* amb_draw.equation */
} amb_blend;

typedef enum amb_factor {
    AMB_FACTOR_ZERO,
    AMB_FACTOR_ONE,
    AMB_FACTOR_SOURCE,
    AMB_FACTOR_ONE_MINUS_SOURCE, /* the same channel of the shader's colour */
    AMB_FACTOR_SOURCE_ALPHA,
    AMB_FACTOR_ONE_MINUS_SOURCE_ALPHA,
    AMB_FACTOR_TARGET,
    AMB_FACTOR_ONE_MINUS_TARGET, /* of the stored colour; an absent alpha is 1 */
    AMB_FACTOR_TARGET_ALPHA,
    AMB_FACTOR_ONE_MINUS_TARGET_ALPHA,
    AMB_FACTOR_SOURCE_ALPHA_SATURATE, /* min(source alpha, 1 - target alpha); for alpha 1 */
    AMB_FACTOR_CONSTANT,
    AMB_FACTOR_ONE_MINUS_CONSTANT, /* amb_draw.blend_constant */
    AMB_FACTOR_SECOND,
    AMB_FACTOR_ONE_MINUS_SECOND, /* of color[1], with one colour attachment */
    AMB_FACTOR_SECOND_ALPHA,
    AMB_FACTOR_ONE_MINUS_SECOND_ALPHA,
} amb_factor;

typedef enum amb_blend_op {
    AMB_BLEND_SUM,        /* source · fs + target · ft */
    AMB_BLEND_DIFFERENCE, /* source · fs - target · ft */
    AMB_BLEND_REVERSE,    /* target · ft - source · fs */
    AMB_BLEND_MIN,
    AMB_BLEND_MAX, /* of source and target, without factors; a NaN source gives the target */
} amb_blend_op;

typedef struct amb_blend_equation {
    amb_factor color_source, color_target, alpha_source, alpha_target;
    amb_blend_op color_op, alpha_op;
} amb_blend_equation;

typedef enum amb_stencil_op {
    AMB_STENCIL_KEEP,
    AMB_STENCIL_ZERO,
    AMB_STENCIL_REPLACE,
    AMB_STENCIL_INCREMENT_CLAMP,
    AMB_STENCIL_DECREMENT_CLAMP,
    AMB_STENCIL_INVERT,
    AMB_STENCIL_INCREMENT_WRAP,
    AMB_STENCIL_DECREMENT_WRAP,
} amb_stencil_op;

typedef struct amb_stencil_face {
    amb_compare compare; /* (reference & mask) against (stored & mask); DEFAULT: ALWAYS */
    amb_stencil_op fail, depth_fail, pass;
} amb_stencil_face;

typedef struct amb_stencil {
    bool on;
    uint8_t reference, read_mask_off, write_mask_off; /* bits that are not compared, not written */
    amb_stencil_face front, back;
} amb_stencil;

typedef struct amb_rect {
    int x, y, width, height;
} amb_rect; /* pixels, y down */

typedef struct amb_draw {
    const char *label;            /* for statistics and errors; static storage; may be NULL */
    int lanes;                    /* AMB_LANES of the file the shaders were compiled in */
    amb_vertex_shader vertex;     /* NULL and no tessellation: a full-screen draw: every pixel once, no varyings, counts
                                   * below ignored */
    amb_fragment_shader fragment; /* NULL: depth only */
    const void *uniforms;
    size_t uniforms_size;    /* copied when recorded; pointers inside must outlive the pass */
    int varying_floats;      /* sizeof(varyings) / sizeof(f32x), 0…AMB_MAX_VARYINGS */
    const uint32_t *indices; /* NULL: not indexed; must outlive the pass */
    uint32_t count;          /* indices or vertices; a trailing partial primitive is dropped */
    uint32_t vertex_count;   /* indices at or above it drop their triangle; 0 for non-indexed draws */
    uint32_t instances;      /* 0 means 1 */
    amb_cull cull;
    bool front_clockwise;      /* as seen on the screen; default counter-clockwise is front */
    amb_compare depth_compare; /* the fragment's depth against the stored one. DEFAULT: LESS; LESS_EQUAL for full-screen
                                * draws, so that a background at depth 1 fills what is still clear. Without a depth
                                * image every test passes. */
    bool depth_write_off;
    bool writes_depth; /* the fragment shader writes out->depth: late depth test */
    amb_blend blend[AMB_MAX_TARGETS];
    uint32_t targets_off; /* bit i: attachment i is not written */

    amb_topology topology;
    amb_tessellation tessellation;
    amb_geometry geometry;
    float point_size; /* pixels, 0 means 1; at most 4096 */
    bool wireframe;   /* triangles that are not culled are drawn as their three edges, by the line rule */
    amb_rect scissor; /* width and height 0: the whole target */
    bool depth_clamp; /* no near and far clipping; depth is clamped to 0…1 */
    /* Added to a triangle's depth, as D3D11 for float depth: depth_bias · 2^(e - 23) + depth_bias_slope · m, where e is
     * the exponent of the triangle's largest depth and m = max(|∂z/∂x|, |∂z/∂y|); then at most (at least)
     * depth_bias_clamp, if it is above (below) 0. The sum is clamped to 0…1. */
    float depth_bias, depth_bias_slope, depth_bias_clamp;
    uint8_t channels_off[AMB_MAX_TARGETS];        /* bit c: channel c of that attachment is not written */
    amb_blend_equation equation[AMB_MAX_TARGETS]; /* where blend is AMB_BLEND_EQUATION */
    v4 blend_constant;
    amb_stencil stencil;    /* needs a stencil image */
    bool alpha_to_coverage; /* of n samples, only the first ⌊n·a + ½⌋ are written, a = alpha of color[0] in 0…1 */
} amb_draw;

/* A layer of an array, a face of a cube or a slice of a 3D texture, at one level. */
typedef struct amb_texture_slice {
    amb_texture *texture; /* NULL: none */
    int level, slice;
} amb_texture_slice;

/* Attachments are images, which hold what the draws wrote as it is, or slices of textures, which round it to their
 * format at every write, so that blending reads what a GPU's reads (half, R11G11B10F, 8-bit unorm and sRGB; blending
 * is linear). Textures must not be sampled before the pass has finished; their other levels are left as they are: see
 * amb_texture_make_mips. */
typedef struct amb_target {
    amb_image *color[AMB_MAX_TARGETS];                /* all of one size; 1…4 channels each */
    amb_texture_slice color_texture[AMB_MAX_TARGETS]; /* where color[i] is NULL; neither ends the list */
    amb_image *depth;                                 /* one channel; may be NULL */
    amb_texture_slice depth_texture;                  /* R32F; where depth is NULL */
    amb_image *stencil;                               /* one channel of whole numbers 0…255; may be NULL */
    v4 clear_color[AMB_MAX_TARGETS];
    float clear_depth; /* used as it is: give 1 for the usual */
    uint8_t clear_stencil;
    bool keep; /* true: start from the images' contents instead of the clear values */
    /* 0 or 1; 2, 4 or 8: multisampling at D3D's standard positions. Triangles cover samples, lines and points whole
     * pixels; shaders run once a pixel, at its centre; depth, stencil and blending work on samples. At the end colours
     * are averaged, depth and stencil are those of sample 0. */
    int samples;
    bool time_stages; /* fill amb_pass_stats.ticks: costs some 3 % */
} amb_target;

/* Where a pass spends its time. */
typedef enum amb_stage {
    AMB_STAGE_CORNERS,  /* gathering indices, tessellating */
    AMB_STAGE_VERTICES, /* vertex, hull, domain and geometry shader, and what takes their results to the window */
    AMB_STAGE_SETUP,    /* culling, clipping, bounds */
    AMB_STAGE_BINS,
    AMB_STAGE_TILES,     /* tiles from and to images */
    AMB_STAGE_COVERAGE,  /* edges, early tests, interpolation, packing */
    AMB_STAGE_FRAGMENTS, /* fragment shader */
    AMB_STAGE_OUTPUT,    /* late tests, blending, stores */
    AMB_STAGES
} amb_stage;
const char *amb_stage_name(amb_stage stage);

/* Counts of a pass, all but the ticks the same at any thread count. "triangles" are the primitives, lines and points
 * too. */
typedef struct amb_pass_stats {
    uint64_t vertices; /* vertex shader lanes alive */
    uint64_t patches;
    uint64_t patches_culled;    /* by an index or a factor */
    uint64_t domain_points;     /* domain shader lanes alive */
    uint64_t geometry_in;       /* geometry shader lanes alive */
    uint64_t geometry_vertices; /* emitted */
    uint64_t triangles_in;      /* after tessellation and geometry shader */
    uint64_t triangles_clipped; /* cut by a plane */
    uint64_t triangles_culled;  /* dropped: bad index or vertex, outside, facing away, degenerate, on no pixel */
    uint64_t triangles_binned;  /* what was left, pieces of clipped ones counted each */
    uint64_t blocks_shaded;     /* fragment shader calls: depends on the lanes */
    uint64_t fragments_shaded;  /* live lanes of those calls */
    uint64_t ticks[AMB_STAGES]; /* of the processor's time stamp counter, summed over threads; 0 unless time_stages */
} amb_pass_stats;

typedef struct amb_pass amb_pass;

/* Images and textures must outlive the pass. Errors: ARGUMENT, MEMORY. */
amb_status amb_pass_begin(const amb_context *context, const amb_target *target, amb_pass **out, amb_error *error);
/* Errors: ARGUMENT (naming the field), ISA (lanes differ from the context's), MEMORY. */
amb_status amb_pass_draw(amb_pass *pass, const amb_draw *draw, amb_error *error);
/* Runs, frees and nulls, also on error. stats may be NULL. Errors: MEMORY. */
amb_status amb_pass_finish(amb_pass **pass, amb_pass_stats *stats, amb_error *error);
/* Frees without running. */
void amb_pass_close(amb_pass **pass);

#endif
