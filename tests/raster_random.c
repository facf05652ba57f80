#include "tests/raster_random.h"

#include "tests/format_truth.h"
#include "tests/raster_random_pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- from bytes to a pass -----------------------------------------------------------------------------------------
 */

static int number(random_pass *p, int limit)
{
    int v = p->byte < p->end ? *p->byte++ : 0;
    if (limit > 256)
        v = v * 256 + (p->byte < p->end ? *p->byte++ : 0);
    return v % limit;
}

static float clip_component(random_pass *p, float plain)
{
    static const float hostile[] = {NAN, INFINITY, -INFINITY, 1e-40f, 3e38f, -3e38f, 0.0f, -0.0f};
    int n = number(p, 64);
    return n < 8 ? hostile[n] : plain;
}

/* Sets whether all have one depth, and returns whether they lie close together: then triangles are of a few pixels, one
 * over the other, and there may be many. */
static bool random_vertices(random_pass *p, random_draw *d)
{
    int kind = number(p, 4);
    float z = (float)number(p, 33) * 0.03125f;
    const bool cluster = number(p, 3) == 0;
    const double middle_x = number(p, 256) / 256.0 * p->width, middle_y = number(p, 256) / 256.0 * p->height;
    d->flat = kind < 2;
    for (int i = 0; i < MAX_VERTICES; i++) {
        v4 *c = &d->vertex[i].clip;
        double reach = kind == 1 && !cluster ? 2000.0 : 1.0;
        double x = (number(p, 1024) - 128) / 768.0 * p->width, y = (number(p, 1024) - 128) / 768.0 * p->height;
        if (cluster)
            x = middle_x + (number(p, 512) - 256) / 64.0, y = middle_y + (number(p, 512) - 256) / 64.0;
        double w = d->flat ? 1.0 : (number(p, 512) - 100) / 128.0;
        c->x = (float)((x * reach / (p->width * 0.5) - 1.0) * w);
        c->y = (float)((1.0 - y * reach / (p->height * 0.5)) * w);
        c->z = d->flat ? z : (float)(number(p, 300) - 20) / 256.0f * (float)w;
        c->w = (float)w;
        if (kind == 3)
            *c = (v4){clip_component(p, c->x), clip_component(p, c->y), clip_component(p, c->z),
                      clip_component(p, c->w)};
    }
    return cluster;
}

static void random_output(random_pass *p, amb_draw *s)
{
    for (int i = 0; i < p->targets; i++) {
        s->blend[i] = (amb_blend)number(p, 5);
        amb_blend_equation *q = &s->equation[i];
        amb_factor *factor[4] = {&q->color_source, &q->color_target, &q->alpha_source, &q->alpha_target};
        for (int k = 0; k < 4; k++)
            *factor[k] = (amb_factor)number(p, p->targets == 1 ? 17 : 13);
        q->color_op = (amb_blend_op)number(p, 5), q->alpha_op = (amb_blend_op)number(p, 5);
        s->channels_off[i] = number(p, 4) == 0 ? (uint8_t)number(p, 16) : 0;
    }
    s->alpha_to_coverage = number(p, 6) == 0;
    s->blend_constant = (v4){0.5f, 0.25f, -1.0f, 0.75f};
    s->targets_off = number(p, 5) == 0 ? (uint32_t)number(p, 512) : 0;
    s->depth_compare = (amb_compare)number(p, 9);
    s->depth_write_off = number(p, 3) == 0;
    if (p->target.stencil && number(p, 2)) {
        amb_stencil *t = &s->stencil;
        amb_stencil_face *face[2] = {&t->front, &t->back};
        t->on = true;
        t->reference = (uint8_t)number(p, 256);
        t->read_mask_off = number(p, 2) ? (uint8_t)number(p, 256) : 0;
        t->write_mask_off = number(p, 2) ? (uint8_t)number(p, 256) : 0;
        for (int i = 0; i < 2; i++) {
            face[i]->compare = (amb_compare)number(p, 9);
            face[i]->fail = (amb_stencil_op)number(p, 8), face[i]->depth_fail = (amb_stencil_op)number(p, 8);
            face[i]->pass = (amb_stencil_op)number(p, 8);
        }
    }
    if (number(p, 3) == 0)
        s->scissor = (amb_rect){number(p, 256) - 30, number(p, 256) - 30, 1 + number(p, 128), 1 + number(p, 128)};
}

/* Patches instead of primitives. Depth comes from the shader, as the patches' own is rounded. */
static void random_patches(random_pass *p, const raster_test_shaders *shaders, random_draw *d)
{
    amb_draw *s = &d->state;
    amb_tessellation *t = &s->tessellation;
    t->shape = number(p, 2) ? AMB_QUAD : AMB_TRIANGLE;
    t->hull = shaders->hull, t->domain = t->shape == AMB_QUAD ? shaders->quad : shaders->triangle;
    t->corners = (t->shape == AMB_QUAD ? 4 : 3) + number(p, 2);
    t->patch_floats = 1;
    t->partitioning = (amb_partitioning)number(p, 3);
    t->clockwise = number(p, 2), t->points = number(p, 4) == 0;
    s->topology = AMB_PATCHES;
    s->vertex = NULL;
    s->writes_depth = true, s->fragment = shaders->coded_depth;
    d->uniforms.factors = number(p, 256);
    d->uniforms.corners = t->points ? 1 : 3;
}

static void random_draw_state(random_pass *p, const raster_test_shaders *shaders, random_draw *d)
{
    amb_draw *s = &d->state;
    const int most = random_vertices(p, d) ? MAX_INDICES : MAX_INDICES / 4;
    *s = (amb_draw){.lanes = shaders->lanes, .vertex = shaders->vertex, .varying_floats = 4};
    s->topology = (amb_topology)number(p, 6);
    s->count = (uint32_t)number(p, MAX_VERTICES + 1);
    if (number(p, 2)) {
        s->indices = d->index;
        s->vertex_count = (uint32_t)(1 + number(p, MAX_VERTICES));
        s->count = (uint32_t)number(p, most + 1);
        for (int i = 0; i < most; i++)
            d->index[i] = number(p, 16) == 0 ? UINT32_MAX : (uint32_t)number(p, MAX_VERTICES);
    }
    s->instances = (uint32_t)number(p, 4);
    if (number(p, 4) == 0) {
        static const amb_topology output[] = {AMB_TRIANGLES, AMB_LINES, AMB_POINTS};
        s->geometry = (amb_geometry){shaders->copy, output[number(p, 3)], 1 + number(p, 12), 0};
    }
    s->cull = (amb_cull)number(p, 3);
    s->front_clockwise = number(p, 2) != 0;
    s->wireframe = number(p, 6) == 0;
    s->point_size = number(p, 2) ? (float)number(p, 200) / 16.0f : 0.0f;
    s->depth_clamp = number(p, 4) == 0;
    s->depth_bias = number(p, 4) == 0 ? (float)(number(p, 512) - 256) * 4096.0f : 0.0f;
    s->depth_bias_clamp = number(p, 2) ? (float)(number(p, 64) - 32) / 256.0f : 0.0f;
    random_output(p, s);
    d->uniforms = (raster_test_uniforms){.vertex = d->vertex, .offset = {0.25f, -0.125f, 0, 0}};
    d->uniforms.holes = number(p, 2) ? number(p, 5) : 0;
    d->uniforms.step = (v4){-0.375f, 0.25f, 0, 0};
    d->uniforms.corners = s->topology <= AMB_TRIANGLE_FAN ? 3 : s->topology <= AMB_LINE_STRIP ? 2 : 1;
    d->uniforms.copies = number(p, 4);
    d->uniforms.targets = p->targets;
    d->uniforms.hostile = number(p, 4) == 0 ? number(p, 9) : 0;
    s->uniforms = &d->uniforms, s->uniforms_size = sizeof d->uniforms;
    s->writes_depth = !d->flat || number(p, 2);
    s->fragment = s->writes_depth ? shaders->coded_depth : number(p, 8) == 0 ? NULL : shaders->coded;
    int kind = number(p, 12);
    if (kind < 2)
        random_patches(p, shaders, d);
    else if (kind == 2 && s->fragment)
        s->vertex = NULL, s->geometry.shader = NULL; /* the whole screen */
}

/* A slice of a texture at a level where it has the pass's size. */
static bool random_texture(random_pass *p, amb_texel texel, amb_texture_slice *slice)
{
    static const amb_texture_kind kinds[] = {AMB_TEXTURE_2D, AMB_TEXTURE_2D_ARRAY, AMB_TEXTURE_3D, AMB_TEXTURE_CUBE};
    amb_texture_desc desc = {.texel = texel, .make_mips = true};
    desc.kind = kinds[number(p, p->width == p->height ? 4 : 3)];
    slice->level = number(p, 3);
    desc.width = (p->width << slice->level) + number(p, 1 << slice->level);
    desc.height =
        desc.kind == AMB_TEXTURE_CUBE ? desc.width : (p->height << slice->level) + number(p, 1 << slice->level);
    desc.depth = desc.kind == AMB_TEXTURE_3D ? 3 << slice->level : 3;
    slice->slice = desc.kind == AMB_TEXTURE_2D ? 0 : number(p, desc.kind == AMB_TEXTURE_CUBE ? 6 : 3);
    return amb_texture_create(&desc, &slice->texture, NULL) == AMB_OK;
}

static bool random_color_target(random_pass *p, int i)
{
    random_color *color = &p->color[i];
    size_t pixels = (size_t)p->width * (size_t)p->height * (size_t)p->samples;
    bool made;
    color->textured = number(p, 2);
    p->target.clear_color[i] = (v4){0.5f, -0.25f, (float)number(p, 9) / 4.0f, 0.125f};
    if (color->textured) {
        color->texel = (amb_texel)number(p, AMB_TEXEL_LAST + 1);
        color->channels = format_channels(color->texel);
        made = random_texture(p, color->texel, &p->target.color_texture[i]);
    } else {
        color->channels = 1 + number(p, 4);
        made = amb_image_create(p->width, p->height, color->channels, &p->target.color[i], NULL) == AMB_OK;
    }
    for (int c = 0; c < color->channels && made; c++)
        made = (color->truth[c] = calloc(pixels, sizeof(float))) != NULL;
    return made;
}

static bool random_target(random_pass *p)
{
    static const int tiles[] = {64, 16, 32, 128};
    p->width = 1 + number(p, 90), p->height = number(p, 4) ? 1 + number(p, 70) : p->width;
    p->targets = 1 + (number(p, 8) ? number(p, 2) : number(p, MAX_COLORS));
    p->tile_size = tiles[number(p, 4)];
    p->samples = number(p, 2) ? 1 << number(p, 4) : 1;
    p->target.samples = p->samples;
    bool made = true;
    for (int i = 0; i < p->targets && made; i++)
        made = random_color_target(p, i);
    p->target.clear_depth = (float)number(p, 9) / 8.0f;
    p->target.clear_stencil = (uint8_t)number(p, 256);
    int depth = number(p, 4);
    if (made && depth == 1)
        made = random_texture(p, AMB_TEXEL_R32F, &p->target.depth_texture);
    if (made && depth > 1)
        made = amb_image_create(p->width, p->height, 1, &p->target.depth, NULL) == AMB_OK;
    if (made && number(p, 2))
        made = amb_image_create(p->width, p->height, 1, &p->target.stencil, NULL) == AMB_OK;
    size_t samples = (size_t)p->width * (size_t)p->height * (size_t)p->samples;
    p->depth = calloc(samples, sizeof *p->depth);
    p->stencil = calloc(samples, sizeof *p->stencil);
    p->mask = calloc(samples, sizeof *p->mask);
    return made && p->depth && p->stencil && p->mask;
}

/* One field beyond what is allowed: the draw must be refused, and leave nothing behind. */
static bool refuses_nonsense(random_pass *p, amb_pass *pass, const amb_draw *good)
{
    amb_draw d = *good;
    int nonsense = number(p, 2) ? 1 << 20 : -1 - number(p, 256);
    switch (number(p, 15)) {
    case 0:
        d.lanes = nonsense;
        break;
    case 1:
        d.cull = (amb_cull)nonsense;
        break;
    case 2:
        d.depth_compare = (amb_compare)nonsense;
        break;
    case 3:
        d.blend[number(p, p->targets)] = (amb_blend)nonsense;
        break;
    case 4:
        d.blend[0] = AMB_BLEND_EQUATION, d.equation[0].alpha_source = (amb_factor)nonsense;
        break;
    case 5:
        d.blend[0] = AMB_BLEND_EQUATION, d.equation[0].color_op = (amb_blend_op)nonsense;
        break;
    case 6:
        d.varying_floats = nonsense;
        break;
    case 7:
        d.scissor.height = -1 - number(p, 256);
        break;
    case 8:
        d.depth_bias = NAN;
        break;
    case 9:
        d.uniforms = NULL;
        break;
    case 10:
        d.stencil.on = true, d.stencil.back.fail = (amb_stencil_op)nonsense;
        break;
    case 11:
        d.geometry.shader = raster_test_shaders_of(AMB_ISA_V2)->copy; /* it is never run */
        d.geometry.vertices = number(p, 2) ? 0 : AMB_MAX_GEOMETRY_VERTICES + 1;
        break;
    case 12:
        d.topology = (amb_topology)nonsense;
        d.vertex = raster_test_shaders_of(AMB_ISA_V2)->vertex;
        break;
    case 13:
        d.topology = AMB_PATCHES; /* without a hull and a domain shader */
        d.tessellation = (amb_tessellation){0};
        break;
    default:
        d.vertex = NULL, d.fragment = NULL, d.topology = AMB_TRIANGLES;
    }
    amb_error error;
    return amb_pass_draw(pass, &d, &error) != AMB_OK && strlen(error.detail) > 10;
}

/* ---- both, compared ----------------------------------------------------------------------------------------------
 */

/* A colour or depth attachment as an image; NULL when there is none. Copies of textures are to be closed. */
static amb_image *picture_of(amb_image *image, const amb_texture_slice *slice)
{
    if (slice->texture && amb_texture_to_image(slice->texture, slice->level, slice->slice, &image, NULL) != AMB_OK)
        return NULL;
    return image;
}

static bool same(float a, float b) { return a == b || (isnan(a) && isnan(b)); }

/* Counts differing pixels of one attachment; truth: one array a channel, `samples` values a pixel. */
static long compare_planes(const random_pass *p, const amb_image *image, float *const *truth, const char *name,
                           char what[64])
{
    long differences = 0;
    for (int i = 0; i < p->width * p->height; i++) {
        bool differs = !image;
        for (int c = 0; image && c < image->channels; c++)
            differs |= !same(amb_image_row(image, c, i / p->width)[i % p->width], truth[c][i * p->samples]);
        if (differs && differences++ == 0)
            snprintf(what, 64, "%s at (%d, %d) of %d×%d", name, i % p->width, i / p->width, p->width, p->height);
    }
    return differences;
}

static long compare_images(const random_pass *p, char what[64])
{
    long differences = 0;
    for (int t = 0; t < p->targets && differences == 0; t++) {
        char name[32];
        snprintf(name, sizeof name, p->color[t].textured ? "colour %d (format %d)" : "colour %d", t,
                 (int)p->color[t].texel);
        amb_image *image = picture_of(p->target.color[t], &p->target.color_texture[t]);
        differences = compare_planes(p, image, p->color[t].truth, name, what);
        if (p->color[t].textured)
            amb_image_close(&image);
    }
    if (random_has_depth(p) && differences == 0) {
        amb_image *image = picture_of(p->target.depth, &p->target.depth_texture);
        differences = compare_planes(p, image, &p->depth, "depth", what);
        if (p->target.depth_texture.texture)
            amb_image_close(&image);
    }
    for (int i = 0; p->target.stencil && differences == 0 && i < p->width * p->height; i++)
        if (amb_image_row(p->target.stencil, 0, i / p->width)[i % p->width] != (float)p->stencil[i * p->samples]) {
            snprintf(what, 64, "stencil at (%d, %d)", i % p->width, i / p->width);
            differences = 1;
        }
    return differences;
}

static void free_pass(random_pass *p)
{
    for (int i = 0; i < MAX_COLORS; i++) {
        amb_image_close(&p->target.color[i]);
        amb_texture_close(&p->target.color_texture[i].texture);
        for (int c = 0; c < 4; c++)
            free(p->color[i].truth[c]);
    }
    amb_image_close(&p->target.depth);
    amb_texture_close(&p->target.depth_texture.texture);
    amb_image_close(&p->target.stencil);
    free(p->depth);
    free(p->stencil);
    free(p->mask);
    free(p);
}

/* Records the draws, in one pass or in two, into both. False when a call fails that should not. */
static bool play(random_pass *p, const amb_context *context, char what[64])
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(context));
    const size_t batch = (size_t)number(p, 2) << 24;
    amb_pass *pass = NULL;
    amb_error error = {0};
    bool fine = true;
    snprintf(what, 64, "a call failed");
    for (int i = 0; i < p->draws && fine; i++) {
        random_draw *d = &p->draw[i];
        if (i == p->split && pass) {
            fine = amb_pass_finish(&pass, NULL, &error) == AMB_OK;
            p->target.keep = true;
            random_truth_resolve(p);
        }
        if (fine && !pass)
            fine = raster_pass_begin(context, &p->target, p->tile_size, batch, &pass, &error) == AMB_OK;
        random_draw_state(p, shaders, d);
        if (fine && number(p, 16) == 0)
            fine = refuses_nonsense(p, pass, &d->state);
        if (fine)
            fine = amb_pass_draw(pass, &d->state, &error) == AMB_OK;
        if (fine)
            random_truth_draw(p, d);
    }
    if (fine)
        fine = amb_pass_finish(&pass, NULL, &error) == AMB_OK;
    random_truth_resolve(p);
    if (!fine && error.status != AMB_OK)
        snprintf(what, 64, "%.63s", error.detail);
    amb_pass_close(&pass);
    return fine;
}

long raster_random_differences(const amb_context *context, const uint8_t *bytes, size_t count, char what[64])
{
    random_pass *p = calloc(1, sizeof *p);
    if (!p)
        return -1;
    p->byte = bytes, p->end = bytes + count;
    long differences = -1;
    if (random_target(p)) {
        random_truth_clear(p);
        p->draws = 1 + number(p, MAX_DRAWS);
        p->split = number(p, 4) ? MAX_DRAWS : number(p, p->draws);
        if (play(p, context, what))
            differences = compare_images(p, what);
    }
    free_pass(p);
    return differences;
}
