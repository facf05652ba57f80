/* A pass: the checked record of a target and its draws. Running it is batch.c's part. */
#include "raster/internal.h"

#include <stdlib.h>

#define MAX_TRIANGLES ((uint64_t)INT32_MAX) /* of one draw: their running numbers are ints */

bool raster_grow(void *array, size_t *capacity, size_t needed, size_t element_bytes)
{
    if (needed <= *capacity)
        return true;
    size_t wanted = *capacity < 16 ? 16 : *capacity;
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

static amb_status check_image(const amb_pass *pass, const amb_image *image, const char *name, int number,
                              amb_error *error)
{
    if (image->width != pass->width || image->height != pass->height)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s %d is %d×%d, the first image is %d×%d; all must agree",
                        name, number, image->width, image->height, pass->width, pass->height);
    if (image->channels < 1 || image->channels > AMB_MAX_CHANNELS || !image->data)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: %s %d has %d channels; 1 to %d are allowed", name, number,
                        image->channels, AMB_MAX_CHANNELS);
    return AMB_OK;
}

/* Counts the attachments and lays out a tile's planes. */
static amb_status check_target(amb_pass *pass, amb_error *error)
{
    const amb_target *t = &pass->target;
    const amb_image *first = t->color[0] ? t->color[0] : t->depth;
    if (!first)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: neither colour nor depth image is given");
    pass->width = first->width, pass->height = first->height;
    if (pass->width < 1 || pass->height < 1 || pass->width > AMB_MAX_IMAGE_SIZE || pass->height > AMB_MAX_IMAGE_SIZE)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "target: size %d×%d is outside 1…%d", pass->width, pass->height,
                        AMB_MAX_IMAGE_SIZE);
    pass->planes = 1;
    for (; pass->target_count < AMB_MAX_TARGETS && t->color[pass->target_count]; pass->target_count++) {
        int i = pass->target_count;
        amb_status status = check_image(pass, t->color[i], "colour image", i, error);
        if (status != AMB_OK)
            return status;
        for (int k = 0; k < i; k++)
            if (t->color[k] == t->color[i])
                return amb_fail(error, AMB_ERROR_ARGUMENT, "target: colour images %d and %d are the same image", k, i);
        pass->channel_first[i] = pass->planes;
        pass->planes += t->color[i]->channels;
    }
    if (!t->depth)
        return AMB_OK;
    amb_status status = check_image(pass, t->depth, "depth image", 0, error);
    if (status == AMB_OK && t->depth->channels != 1)
        status = amb_fail(error, AMB_ERROR_ARGUMENT, "target: the depth image has %d channels; it must have 1",
                          t->depth->channels);
    for (int k = 0; k < pass->target_count && status == AMB_OK; k++)
        if (t->color[k] == t->depth)
            status = amb_fail(error, AMB_ERROR_ARGUMENT, "target: colour image %d is also the depth image", k);
    return status;
}

/* The largest power of two g with g · half ≤ the guard band's reach: the product with any w is then exact. */
static float guard_factor(int size)
{
    double g = 1.0, half = 0.5 * size;
    while (2.0 * g * half <= RASTER_GUARD_PIXELS)
        g *= 2.0;
    return (float)g;
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
    amb_status status = check_target(pass, error);
    if (status != AMB_OK)
        goto error;
    pass->tile_size = tile_size;
    pass->batch_bytes = batch_bytes;
    pass->tiles_x = (pass->width + tile_size - 1) / tile_size;
    pass->tiles_y = (pass->height + tile_size - 1) / tile_size;
    pass->guard_x = guard_factor(pass->width);
    pass->guard_y = guard_factor(pass->height);
    pass->tile_started = calloc((size_t)pass->tiles_x * (size_t)pass->tiles_y, 1);
    if (!pass->tile_started) {
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
    return raster_pass_begin(context, target, RASTER_TILE, RASTER_BATCH_BYTES, out, error);
}

/* "draw 'label': " for messages. */
static const char *label_of(const amb_draw *draw) { return draw->label ? draw->label : "unnamed"; }

static amb_status check_state(const amb_pass *pass, const amb_draw *d, amb_error *error)
{
    const char *label = label_of(d);
    int lanes = (int)amb_context_isa(pass->context);
    if (d->lanes != lanes)
        return amb_fail(error, AMB_ERROR_ISA, "draw '%s': its shaders were compiled for %d lanes, the context runs %d",
                        label, d->lanes, lanes);
    if (!d->vertex && !d->fragment)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': a full-screen draw needs a fragment shader", label);
    if (d->writes_depth && !d->fragment)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': writes_depth needs a fragment shader", label);
    if ((d->uniforms_size > 0) != (d->uniforms != NULL))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': uniforms are %s but uniforms_size is %zu", label,
                        d->uniforms ? "given" : "NULL", d->uniforms_size);
    if (d->varying_floats < 0 || d->varying_floats > AMB_MAX_VARYINGS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': varying_floats is %d; 0 to %d are allowed", label,
                        d->varying_floats, AMB_MAX_VARYINGS);
    if ((unsigned)d->cull > AMB_CULL_FRONT)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': cull is %d; 0 to %d are allowed", label, (int)d->cull,
                        AMB_CULL_FRONT);
    if ((unsigned)d->depth_compare > AMB_ALWAYS)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': depth_compare is %d; 0 to %d are allowed", label,
                        (int)d->depth_compare, AMB_ALWAYS);
    for (int i = 0; i < pass->target_count; i++)
        if ((unsigned)d->blend[i] > AMB_BLEND_MULTIPLY)
            return amb_fail(error, AMB_ERROR_ARGUMENT, "draw '%s': blend[%d] is %d; 0 to %d are allowed", label, i,
                            (int)d->blend[i], AMB_BLEND_MULTIPLY);
    return AMB_OK;
}

static amb_status check_geometry(const amb_draw *d, amb_error *error)
{
    const char *label = label_of(d);
    if (!d->vertex)
        return AMB_OK;
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
    uint64_t triangles = (uint64_t)(d->count / 3) * (d->instances ? d->instances : 1);
    if (triangles > MAX_TRIANGLES || d->instances > (uint32_t)INT32_MAX)
        return amb_fail(error, AMB_ERROR_LIMIT, "draw '%s': %u vertices × %u instances are more than %d triangles",
                        label, d->count, d->instances, INT32_MAX);
    return AMB_OK;
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
    raster_draw record = {.state = *draw};
    if (draw->uniforms) {
        size_t bytes = (draw->uniforms_size + 63) & ~(size_t)63;
        record.uniforms = bytes >= draw->uniforms_size ? aligned_alloc(64, bytes) : NULL;
        if (!record.uniforms)
            return amb_fail(error, AMB_ERROR_MEMORY, "draw '%s': out of memory for %zu bytes of uniforms",
                            label_of(draw), draw->uniforms_size);
        memcpy(record.uniforms, draw->uniforms, draw->uniforms_size);
    }
    if (draw->vertex) {
        record.per_instance = draw->count / 3;
        record.triangles = (uint64_t)record.per_instance * (draw->instances ? draw->instances : 1);
    }
    record.state.uniforms = record.uniforms;
    if (!pass->target.depth)
        record.state.depth_compare = AMB_ALWAYS;
    else if (draw->depth_compare == AMB_COMPARE_DEFAULT)
        record.state.depth_compare = draw->vertex ? AMB_LESS : AMB_LESS_EQUAL;
    pass->draw[pass->draw_count++] = record;
    return AMB_OK;
}

static void free_chunk(raster_chunk *chunk)
{
    free(chunk->x);
    free(chunk->y);
    free(chunk->vertex);
    for (int i = 0; i < 3; i++)
        free(chunk->triangle.v[i]);
    free(chunk->triangle.primitive_front);
    free(chunk->triangle.low);
    free(chunk->triangle.high);
    free(chunk->tile_start);
    free(chunk->entry);
    free(chunk->large);
}

static void free_scratch(raster_scratch *scratch)
{
    free(scratch->lookup);
    free(scratch->index);
    free(scratch->instance);
    free(scratch->clip_x);
    free(scratch->code);
    free(scratch->corner[0]);
    free(scratch->group);
    free(scratch->tile);
}

void amb_pass_close(amb_pass **pass)
{
    if (!pass || !*pass)
        return;
    amb_pass *p = *pass;
    for (size_t i = 0; i < p->draw_count; i++)
        free(p->draw[i].uniforms);
    for (size_t i = 0; i < p->chunk_capacity; i++)
        free_chunk(&p->chunk[i]);
    for (int i = 0; i < p->threads; i++)
        free_scratch(&p->scratch[i]);
    free(p->draw);
    free(p->chunk);
    free(p->scratch);
    free(p->tile_started);
    free(p);
    *pass = NULL;
}
