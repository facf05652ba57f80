/* Scene hillscape: tessellated hills and water under a daylight sky, four lights with shadow maps, a moving sphere,
 * plants and a fire from the geometry stage (hillscape coursework). */
#include "scenes/canvas.h"
#include "scenes/hillscape_shade.h"

#include <ambiance/post.h>

#include <stdio.h>
#include <stdlib.h>

/* ---- camera -------------------------------------------------------------------------------------------------------
 */

/* Never in the ground or the sea, whatever the height map. */
static amb_camera camera_at(const hill_frame *f, const amb_scene_job *job)
{
    float fov = 50.0f * (AMB_PI / 180.0f), near = 0.4f, far = 60000.0f;
    amb_camera c = amb_camera_at(hill_flight, HILL_FLIGHT_KEYS, hill_folded(job->time, (double)HILL_SECONDS), fov, near,
                                 far, job->width, job->height);
    float ground = f_lane(hill_ground(f, (v2x){f_set(c.position.x), f_set(c.position.z)}, f_set(2.0f)), 0);
    float least = amb_s_max(ground, 0.0f) + 2.2f;
    if (c.position.y >= least)
        return c;
    v3 up = {0, least - c.position.y, 0};
    return amb_camera_look(v3_add(c.position, up), v3_add(c.target, up), c.up, fov, near, far, job->width, job->height);
}

/* ---- passes -------------------------------------------------------------------------------------------------------
 */

hill_pass hill_pass_make(const hill_frame *frame, m4 world_to_clip, v3 eye, int height)
{
    hill_pass p = {.frame = frame,
                   .world_to_clip = world_to_clip,
                   .from = frame->camera.position,
                   .eye = eye,
                   .tess_limit = 64.0f,
                   .height = height,
                   .pixels = 1.0f};
    v4 *r = world_to_clip.row;
    p.plane[0] = v4_add(r[3], r[0]);
    p.plane[1] = v4_sub(r[3], r[0]);
    p.plane[2] = v4_add(r[3], r[1]);
    p.plane[3] = v4_sub(r[3], r[1]);
    p.plane[4] = r[2];
    p.plane[5] = v4_sub(r[3], r[2]);
    return p;
}

amb_status hill_pass_finish(const amb_scene_job *job, amb_pass **pass, amb_error *error)
{
    amb_pass_stats stats = {0};
    amb_status status = amb_pass_finish(pass, &stats, error);
    canvas_add_stats(job, &stats);
    return status;
}

/* Opaque things near to far as far as is known, the sky where nothing is, then what blends. */
static amb_status draw_scene(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    amb_status status = hill_draw_sphere(pass, out, error);
    if (status == AMB_OK)
        status = hill_draw_terrain(pass, out, error);
    if (status == AMB_OK)
        status = hill_draw_trees(pass, out, error);
    if (status == AMB_OK && !pass->upside_down)
        status = hill_draw_grass(pass, out, error);
    if (status == AMB_OK)
        status = hill_draw_sky(pass, out, error);
    if (status == AMB_OK && !pass->upside_down)
        status = hill_draw_water(pass, out, error);
    if (status == AMB_OK && !pass->color_off)
        status = hill_draw_fire(pass, out, error);
    return status;
}

/* A picture that later passes look up: one of the frame's textures, drawn by `draw`, with mips. */
static amb_status draw_texture(const amb_scene_job *job, hill_textures *textures, const hill_pass *view, int width,
                               amb_status (*draw)(const hill_pass *, amb_pass *, amb_error *), bool with_depth,
                               const amb_texture **out, amb_error *error)
{
    amb_texture_desc desc = {.texel = AMB_TEXEL_RGBA16F, .width = width, .height = view->height, .make_mips = true};
    amb_texture *texture = NULL;
    amb_image *depth = NULL;
    amb_pass *pass = NULL;
    amb_status status = amb_texture_create(&desc, &texture, error);
    if (status != AMB_OK)
        return status;
    textures->made[textures->count++] = texture;
    if (with_depth)
        status = amb_image_create(width, view->height, 1, &depth, error);
    amb_target target = {.color_texture = {{.texture = texture}},
                         .depth = depth,
                         .clear_depth = 1.0f,
                         .time_stages = job->stats != NULL};
    if (status == AMB_OK)
        status = amb_pass_begin(job->context, &target, &pass, error);
    if (status == AMB_OK)
        status = draw(view, pass, error);
    if (status == AMB_OK)
        status = hill_pass_finish(job, &pass, error);
    if (status == AMB_OK)
        status = amb_texture_make_mips(texture, error);
    if (status == AMB_OK)
        *out = texture;
    amb_pass_close(&pass);
    amb_image_close(&depth);
    return status;
}

static amb_status make_panorama(const amb_scene_job *job, hill_frame *f, hill_textures *textures, amb_error *error)
{
    int height = job->height / 4 < HILL_PANORAMA_HEIGHT ? job->height / 4 + 8 : HILL_PANORAMA_HEIGHT;
    hill_pass view = hill_pass_make(f, f->camera.world_to_clip, f->camera.position, height);
    return draw_texture(job, textures, &view, 4 * height, hill_draw_panorama, false, &f->panorama, error);
}

/* The scene as the water mirrors it, at half size. */
static amb_status make_mirror(const amb_scene_job *job, hill_frame *f, hill_textures *textures, amb_error *error)
{
    m4 flip = m4_mul(f->camera.world_to_clip, m4_scale((v3){1, -1, 1}));
    hill_pass view = hill_pass_make(f, flip, f->camera.position, (job->height + 1) / 2);
    view.upside_down = true;
    view.from.y = -view.from.y;
    view.tess_limit = 8.0f;
    view.pixels = 2.0f;
    return draw_texture(job, textures, &view, (job->width + 1) / 2, draw_scene, true, &f->mirror, error);
}

static amb_status draw_color(const amb_scene_job *job, const hill_frame *f, amb_error *error)
{
    amb_image *depth = NULL;
    amb_pass *pass = NULL;
    amb_status status = amb_image_create(job->width, job->height, 1, &depth, error);
    amb_target target = {.color = {amb_frame_layer(job->frame, "color")},
                         .depth = depth,
                         .clear_depth = 1.0f,
                         .samples = 1 << f->p.samples,
                         .time_stages = job->stats != NULL};
    if (status == AMB_OK)
        status = amb_pass_begin(job->context, &target, &pass, error);
    hill_pass view = hill_pass_make(f, f->camera.world_to_clip, f->camera.position, job->height);
    if (status == AMB_OK)
        status = draw_scene(&view, pass, error);
    if (status == AMB_OK)
        status = hill_pass_finish(job, &pass, error);
    amb_pass_close(&pass);
    amb_image_close(&depth);
    return status;
}

/* The other outputs, at pixel centres: numbers must not be averaged over samples. */
static amb_status draw_outputs(const amb_scene_job *job, const hill_frame *f, amb_error *error)
{
    amb_pass *pass = NULL;
    amb_image *depth = amb_frame_layer(job->frame, "depth"), *own = NULL;
    hill_pass view = hill_pass_make(f, f->camera.world_to_clip, f->camera.position, job->height);
    amb_target target = {.clear_depth = 1.0f, .time_stages = job->stats != NULL};
    int count = 0;
    for (int i = HILL_DEPTH + 1; i < HILL_AOVS; i++) {
        amb_image *image = amb_frame_layer(job->frame, hill_aovs[i].name);
        if (!image)
            continue;
        target.color[count++] = image;
        view.slot[i] = count;
    }
    if (!count && !depth)
        return AMB_OK;
    view.color_off = true;
    amb_status status = depth ? AMB_OK : amb_image_create(job->width, job->height, 1, &own, error);
    target.depth = depth ? depth : own;
    if (status == AMB_OK)
        status = amb_pass_begin(job->context, &target, &pass, error);
    if (status == AMB_OK)
        status = draw_scene(&view, pass, error);
    if (status == AMB_OK)
        status = hill_pass_finish(job, &pass, error);
    amb_pass_close(&pass);
    amb_image_close(&own);
    return status;
}

/* The coursework's bloom is part of its scene, with its settings. */
static amb_status bloom(const amb_scene_job *job, const hill_params *p, amb_error *error)
{
    char text[160];
    amb_chain *chain = NULL;
    if (!p->bloom && !p->brightpass)
        return AMB_OK;
    snprintf(text, sizeof text, "brightpass:cutoff=%.9g,glare=%.9g,reduce=quarter,weights=normalized,view=%s",
             (double)p->bloom_sensitivity, (double)p->bloom_intensity, p->brightpass ? "brightpass" : "scene");
    amb_status status = amb_chain_create(job->context, text, &chain, error);
    if (status == AMB_OK)
        status = amb_chain_apply(chain, job->frame, 0, 0, error);
    amb_chain_close(&chain);
    return status;
}

static amb_status draw_passes(const amb_scene_job *job, hill_frame *f, hill_textures *textures, amb_error *error)
{
    amb_status status = make_panorama(job, f, textures, error);
    if (status == AMB_OK)
        status = hill_shadows_make(job, f, textures, error);
    if (status == AMB_OK && f->p.mirror && f->p.water)
        status = make_mirror(job, f, textures, error);
    if (status == AMB_OK)
        status = draw_color(job, f, error);
    if (status == AMB_OK)
        status = draw_outputs(job, f, error);
    return status == AMB_OK ? bloom(job, &f->p, error) : status;
}

static amb_status hill_frame_draw(const void *state, const amb_scene_job *job, amb_error *error)
{
    hill_frame f = {.p = *(const hill_params *)job->params, .state = state, .time = job->time};
    hill_textures textures = {.count = 0};
    uint32_t *patch = malloc(4 * HILL_PATCHES * HILL_PATCHES * sizeof *patch);
    if (!patch)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a frame of scene hillscape");
    f.seconds = hill_folded(job->time, 4096.0);
    f.camera = camera_at(&f, job);
    f.pixel = 2.0f * f_lane(f_tan(f_set(0.5f * f.camera.vertical_fov)), 0) / (float)job->height;
    hill_sort_patches(state, f.camera.position, patch);
    f.patch = patch;
    hill_lights_make(&f);
    for (int i = 0; i < FIRE_PARTICLES; i++)
        f.particle[i] = fire_particle_at(i, job->time);
    amb_status status = draw_passes(job, &f, &textures, error);
    for (int i = 0; i < textures.count; i++)
        amb_texture_close(&textures.made[i]);
    free(patch);
    return status;
}

const amb_scene WIDE(amb_scene_hillscape) = {
    .name = "hillscape",
    .about = "tessellated hills and water, shadows from four lights, plants and fire (coursework)",
    .seconds = HILL_SECONDS,
    .params = {hill_param_rows, HILL_PARAM_COUNT, sizeof(hill_params)},
    .aovs = hill_aovs,
    .aov_count = HILL_AOVS,
    .post = "adjust:saturation=1.18,contrast=1.12;display:curve=aces",
    .load = hill_load,
    .frame = hill_frame_draw,
    .unload = hill_unload,
};
