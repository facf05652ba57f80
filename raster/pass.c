/* A pass: the checked record of a target and its draws. Running it is batch.c's part. */
#include "raster/internal.h"

#include <stdlib.h>

#define MAX_TRIANGLES ((uint64_t)INT32_MAX) /* of one draw: their running numbers are ints */

/* The largest power of two g with g · half ≤ the guard band's reach: the product with any w is then exact. */
static float guard_factor(int size)
{
    double g = 1.0, half = 0.5 * size;
    while (2.0 * g * half <= RASTER_GUARD_PIXELS)
        g *= 2.0;
    return (float)g;
}

/* Tiles that fit the nearer caches with all their samples. Larger ones where there is depth alone leave more triangles
 * a tile to play together; but every thread needs some. */
static int choose_tile(const amb_pass *pass)
{
    const int large = RASTER_MAX_TILE;
    if (pass->samples > 1)
        return RASTER_TILE / 2;
    const bool enough = (pass->width / large) * (pass->height / large) >= 8 * amb_context_threads(pass->context);
    return pass->planes == 1 && enough ? large : RASTER_TILE;
}

amb_status raster_pass_begin(const amb_context *context, const amb_target *target, int tile_size, size_t batch_bytes,
                             amb_pass **out, amb_error *error)
{
    if (!out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "pass: no place for the result is given");
    *out = NULL;
    if (!context || !target)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "pass: no %s is given", context ? "target" : "context");
    amb_pass *pass = calloc(1, sizeof *pass);
    if (!pass)
        return amb_fail(error, AMB_ERROR_MEMORY, "pass: out of memory");
    pass->context = context;
    pass->target = *target;
    amb_status status = raster_prepare_target(pass, error);
    if (status != AMB_OK)
        goto error;
    pass->tile_size = tile_size = tile_size > 0 ? tile_size : choose_tile(pass);
    pass->batch_bytes = batch_bytes;
    pass->tiles_x = (pass->width + tile_size - 1) / tile_size;
    pass->tiles_y = (pass->height + tile_size - 1) / tile_size;
    pass->guard_x = guard_factor(pass->width);
    pass->guard_y = guard_factor(pass->height);
    pass->tile_started = calloc((size_t)pass->tiles_x * (size_t)pass->tiles_y, 1);
    pass->tile_first = calloc((size_t)pass->tiles_x * (size_t)pass->tiles_y + 1, sizeof *pass->tile_first);
    if (pass->samples > 1)
        pass->tile_store = calloc((size_t)pass->tiles_x * (size_t)pass->tiles_y, sizeof *pass->tile_store);
    if (!raster_take_spare(pass) || !pass->tile_started || !pass->tile_first ||
        (pass->samples > 1 && !pass->tile_store)) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "pass: out of memory for %d×%d tiles", pass->tiles_x, pass->tiles_y);
        goto error;
    }
    *out = pass;
    return AMB_OK;
error:
    amb_pass_close(&pass);
    return status;
}

amb_status amb_pass_begin(const amb_context *context, const amb_target *target, amb_pass **out, amb_error *error)
{
    size_t bytes = context ? RASTER_BATCH_BYTES / 2 * (size_t)amb_context_threads(context) : 0;
    return raster_pass_begin(context, target, 0, bytes > RASTER_BATCH_BYTES ? bytes : RASTER_BATCH_BYTES, out, error);
}

/* "draw 'label': " for messages. */
static const char *label_of(const amb_draw *draw) { return draw->label ? draw->label : "unnamed"; }

/* An enumerator out of 0…last. */
static amb_status check_choice(const amb_draw *d, const char *field, int value, int last, amb_error *error)
{
    if (value >= 0 && value <= last)
        return AMB_OK;
    return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': %s is %d; 0 to %d are allowed", label_of(d), field, value,
                    last);
}

static amb_status check_equation(const amb_pass *pass, const amb_draw *d, int target, amb_error *error)
{
    const amb_blend_equation *q = &d->equation[target];
    const int factor[4] = {(int)q->color_source, (int)q->color_target, (int)q->alpha_source, (int)q->alpha_target};
    const int op[2] = {(int)q->color_op, (int)q->alpha_op};
    amb_status status = AMB_OK;
    for (int i = 0; i < 4 && status == AMB_OK; i++) {
        status = check_choice(d, "a blend factor", factor[i], AMB_FACTOR_ONE_MINUS_SECOND_ALPHA, error);
        if (status == AMB_OK && factor[i] >= AMB_FACTOR_SECOND && pass->target_count != 1)
            status = amb_fail(error, AMB_ERROR_ARGUMENT,
                              "draw '%s': blending with a second colour needs one colour image; the target has %d",
                              label_of(d), pass->target_count);
    }
    for (int i = 0; i < 2 && status == AMB_OK; i++)
        status = check_choice(d, "a blend operation", op[i], AMB_BLEND_MAX, error);
    return status;
}

static amb_status check_stencil(const amb_pass *pass, const amb_draw *d, amb_error *error)
{
    if (!d->stencil.on)
        return AMB_OK;
    if (!pass->target.stencil)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': stencil is on, but the target has no stencil image",
                        label_of(d));
    const amb_stencil_face *face[2] = {&d->stencil.front, &d->stencil.back};
    amb_status status = AMB_OK;
    for (int i = 0; i < 2 && status == AMB_OK; i++) {
        const int op[3] = {(int)face[i]->fail, (int)face[i]->depth_fail, (int)face[i]->pass};
        status = check_choice(d, "a stencil compare", (int)face[i]->compare, AMB_ALWAYS, error);
        for (int k = 0; k < 3 && status == AMB_OK; k++)
            status = check_choice(d, "a stencil operation", op[k], AMB_STENCIL_DECREMENT_WRAP, error);
    }
    return status;
}

static const char *const blend_names[] = {"blend[0]",  "blend[1]",  "blend[2]",  "blend[3]", "blend[4]",  "blend[5]",
                                          "blend[6]",  "blend[7]",  "blend[8]",  "blend[9]", "blend[10]", "blend[11]",
                                          "blend[12]", "blend[13]", "blend[14]", "blend[15]"};
_Static_assert(sizeof blend_names / sizeof *blend_names == AMB_MAX_TARGETS, "a name for every target");

static amb_status check_output(const amb_pass *pass, const amb_draw *d, amb_error *error)
{
    amb_status status = check_choice(d, "cull", (int)d->cull, AMB_CULL_FRONT, error);
    if (status == AMB_OK)
        status = check_choice(d, "depth_compare", (int)d->depth_compare, AMB_ALWAYS, error);
    for (int i = 0; i < pass->target_count && status == AMB_OK; i++) {
        status = check_choice(d, blend_names[i], (int)d->blend[i], AMB_BLEND_EQUATION, error);
        if (status == AMB_OK && d->blend[i] == AMB_BLEND_EQUATION)
            status = check_equation(pass, d, i, error);
    }
    if (status == AMB_OK)
        status = check_stencil(pass, d, error);
    const amb_rect *r = &d->scissor;
    if (status == AMB_OK && (r->width < 0 || r->height < 0))
        status = amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': the scissor is %d×%d; it cannot be negative",
                          label_of(d), r->width, r->height);
    if (status == AMB_OK &&
        !(f_is_finite(d->depth_bias) && f_is_finite(d->depth_bias_slope) && f_is_finite(d->depth_bias_clamp)))
        status = amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': a depth bias is not finite", label_of(d));
    return status;
}

/* A full-screen draw? */
static bool is_screen(const amb_draw *d) { return !d->vertex && d->topology != AMB_PATCHES; }

static amb_status check_state(const amb_pass *pass, const amb_draw *d, amb_error *error)
{
    const char *label = label_of(d);
    int lanes = (int)amb_context_isa(pass->context);
    if (d->lanes != lanes)
        return amb_fail(error, AMB_ERROR_ISA, "draw '%s': its shaders were compiled for %d lanes, the context runs %d",
                        label, d->lanes, lanes);
    if (is_screen(d) && !d->fragment)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': a full-screen draw needs a fragment shader", label);
    if (d->writes_depth && !d->fragment)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': writes_depth needs a fragment shader", label);
    if ((d->uniforms_size > 0) != (d->uniforms != NULL))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': uniforms are %s but uniforms_size is %zu", label,
                        d->uniforms ? "given" : "NULL", d->uniforms_size);
    if (d->varying_floats < 0 || d->varying_floats > AMB_MAX_VARYINGS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': varying_floats is %d; 0 to %d are allowed", label,
                        d->varying_floats, AMB_MAX_VARYINGS);
    return check_output(pass, d, error);
}

/* Of one instance. */
static uint32_t primitives_of(const amb_draw *d)
{
    switch (d->topology) {
    case AMB_TRIANGLE_STRIP:
    case AMB_TRIANGLE_FAN:
        return d->count < 3 ? 0 : d->count - 2;
    case AMB_LINES:
        return d->count / 2;
    case AMB_LINE_STRIP:
        return d->count < 2 ? 0 : d->count - 1;
    case AMB_POINTS:
        return d->count;
    case AMB_PATCHES:
        return d->count / (uint32_t)d->tessellation.corners;
    default:
        return d->count / 3;
    }
}

static amb_status check_range(const amb_draw *d, const char *field, int value, int first, int last, amb_error *error)
{
    if (value >= first && value <= last)
        return AMB_OK;
    return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': %s is %d; %d to %d are allowed", label_of(d), field, value,
                    first, last);
}

static amb_status check_tessellation(const amb_draw *d, amb_error *error)
{
    const amb_tessellation *t = &d->tessellation;
    if (d->topology != AMB_PATCHES) {
        if (t->hull || t->domain)
            return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': a %s shader needs the topology AMB_PATCHES",
                            label_of(d), t->hull ? "hull" : "domain");
        return AMB_OK;
    }
    if (d->vertex)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': patches have no vertex shader; it must be NULL",
                        label_of(d));
    if (!t->hull || !t->domain)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': patches need a %s shader", label_of(d),
                        t->hull ? "domain" : "hull");
    amb_status status = check_range(d, "tessellation.corners", t->corners, 1, AMB_MAX_PATCH_CORNERS, error);
    if (status == AMB_OK)
        status = check_range(d, "tessellation.patch_floats", t->patch_floats, 0, AMB_MAX_PATCH_FLOATS, error);
    if (status == AMB_OK)
        status = check_choice(d, "tessellation.shape", (int)t->shape, AMB_TRIANGLE, error);
    if (status == AMB_OK)
        status = check_choice(d, "tessellation.partitioning", (int)t->partitioning, AMB_FRACTIONAL_EVEN, error);
    return status;
}

static amb_status check_geometry_shader(const amb_draw *d, amb_error *error)
{
    const amb_geometry *g = &d->geometry;
    if (!g->shader)
        return AMB_OK;
    if (is_screen(d))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': a full-screen draw cannot have a geometry shader",
                        label_of(d));
    if (g->output != AMB_TRIANGLES && g->output != AMB_LINES && g->output != AMB_POINTS)
        return amb_fail(error, AMB_ERROR_ARGUMENT,
                        "draw '%s': geometry.output is %d; AMB_TRIANGLES, AMB_LINES and AMB_POINTS are allowed",
                        label_of(d), (int)g->output);
    amb_status status = check_range(d, "geometry.vertices", g->vertices, 1, AMB_MAX_GEOMETRY_VERTICES, error);
    if (status == AMB_OK)
        status = check_range(d, "geometry.input_floats", g->input_floats, 0, AMB_MAX_VARYINGS, error);
    return status;
}

static amb_status check_geometry(const amb_draw *d, amb_error *error)
{
    const char *label = label_of(d);
    amb_status status = check_choice(d, "topology", (int)d->topology, AMB_PATCHES, error);
    if (status == AMB_OK)
        status = check_tessellation(d, error);
    if (status == AMB_OK)
        status = check_geometry_shader(d, error);
    if (status != AMB_OK || is_screen(d))
        return status;
    if (d->indices && d->vertex_count == 0)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': an indexed draw needs vertex_count above 0", label);
    if (!d->indices && d->vertex_count != 0)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': vertex_count is %u without indices; it must be 0", label,
                        d->vertex_count);
    if (d->indices && d->vertex_count > (uint32_t)INT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "draw '%s': vertex_count %u is above %d", label, d->vertex_count,
                        INT32_MAX);
    if (!d->indices && d->count > (uint32_t)INT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "draw '%s': count %u is above %d", label, d->count, INT32_MAX);
    if (!(d->point_size >= 0.0f && d->point_size <= RASTER_MAX_POINT))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': point_size is %g; 0 to %g are allowed", label,
                        (double)d->point_size, (double)RASTER_MAX_POINT);
    uint64_t primitives = (uint64_t)primitives_of(d) * (d->instances ? d->instances : 1);
    if (primitives > MAX_TRIANGLES || d->instances > (uint32_t)INT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "draw '%s': %u vertices × %u instances are more than %d primitives",
                        label, d->count, d->instances, INT32_MAX);
    return AMB_OK;
}

static int clamp_to(int64_t a, int last) { return a < 0 ? 0 : a > last ? last : (int)a; }

static void set_scissor(const amb_pass *pass, raster_draw *draw)
{
    const amb_rect *r = &draw->state.scissor;
    bool whole = r->width == 0 && r->height == 0;
    draw->x0 = whole ? 0 : clamp_to(r->x, pass->width);
    draw->y0 = whole ? 0 : clamp_to(r->y, pass->height);
    draw->x1 = whole ? pass->width : clamp_to((int64_t)r->x + r->width, pass->width);
    draw->y1 = whole ? pass->height : clamp_to((int64_t)r->y + r->height, pass->height);
}

/* What goes in, what comes out, how much of it at a time. */
static void set_primitives(raster_draw *record)
{
    amb_draw *draw = &record->state;
    record->screen = is_screen(draw);
    if (record->screen)
        return;
    amb_topology out = draw->topology;
    record->patches = draw->topology == AMB_PATCHES;
    if (record->patches)
        out = draw->tessellation.points ? AMB_POINTS : AMB_TRIANGLES;
    record->chunk_most = RASTER_CHUNK_TRIANGLES;
    if (draw->geometry.shader) {
        uint32_t fit = RASTER_CHUNK_EMITTED / (uint32_t)draw->geometry.vertices & ~15u; /* whole groups of lanes */
        record->chunk_most = fit < RASTER_CHUNK_TRIANGLES ? fit : RASTER_CHUNK_TRIANGLES;
        out = draw->geometry.output;
        if (draw->geometry.input_floats == 0)
            draw->geometry.input_floats = draw->varying_floats;
    }
    record->per_instance = primitives_of(draw);
    record->triangles = (uint64_t)record->per_instance * (draw->instances ? draw->instances : 1);
    record->points = out == AMB_POINTS;
    record->wireframe = draw->wireframe && out <= AMB_TRIANGLE_FAN;
    record->lines = record->wireframe || out == AMB_LINES || out == AMB_LINE_STRIP;
}

amb_status amb_pass_draw(amb_pass *pass, const amb_draw *draw, amb_error *error)
{
    if (!pass || !draw)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw: no %s is given", pass ? "draw" : "pass");
    amb_status status = check_state(pass, draw, error);
    if (status == AMB_OK)
        status = check_geometry(draw, error);
    if (status != AMB_OK)
        return status;
    if (!raster_grow(&pass->draw, &pass->draw_capacity, pass->draw_count + 1, sizeof *pass->draw))
        return amb_fail(error, AMB_ERROR_MEMORY, "draw '%s': out of memory", label_of(draw));
    raster_draw *record = &pass->draw[pass->draw_count];
    *record = (raster_draw){.state = *draw};
    if (draw->uniforms) {
        void *uniforms = raster_take(&pass->arena, draw->uniforms_size);
        if (!uniforms)
            return amb_fail(error, AMB_ERROR_MEMORY, "draw '%s': out of memory for %zu bytes of uniforms",
                            label_of(draw), draw->uniforms_size);
        record->state.uniforms = memcpy(uniforms, draw->uniforms, draw->uniforms_size);
    }
    set_scissor(pass, record);
    set_primitives(record);
    if (!pass->depth.image && !pass->depth.texture)
        record->state.depth_compare = AMB_ALWAYS;
    else if (draw->depth_compare == AMB_COMPARE_DEFAULT)
        record->state.depth_compare = record->screen ? AMB_LESS_EQUAL : AMB_LESS;
    pass->draw_count++;
    return AMB_OK;
}

void amb_pass_close(amb_pass **pass)
{
    if (!pass || !*pass)
        return;
    amb_pass *p = *pass;
    raster_keep_spare(p);
    for (int i = 0; p->tile_store && i < p->tiles_x * p->tiles_y; i++)
        free(p->tile_store[i]);
    free(p->tile_store);
    free(p->tile_started);
    free(p->tile_first);
    free(p->tile_chunk);
    free(p->srgb);
    free(p);
    *pass = NULL;
}
