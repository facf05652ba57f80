/* A terrain of 512×512 patches, cut by distance, in the hull and domain stages: ours and GLSL's. */
#include "bench/patches.h"
#include "bench/picture.h"
#include "core/dispatch.h"

#include <ambiance/camera.h>
#include <stdlib.h>

AMB_DECLARE_WIDE(const patches_shaders *, patches_shaders_get, (void));

/* llvmpipe counts a draw's tessellated vertices in 16 bits, so it gets its patches by the half row. */
enum { PATCHES = PATCHES_SIDE * PATCHES_SIDE, PEER_DRAW = 256 };

typedef struct patches_state {
    patches_uniforms uniforms;
    picture picture;
    GLuint program, array;
} patches_state;

static void set_uniforms(patches_state *s, const bench_options *options)
{
    const v3 eye = {0.0f, 1.4f, 0.6f};
    amb_camera camera = amb_camera_look(eye, (v3){0.2f, 0.2f, -3.0f}, (v3){0, 1, 0}, 0.9f, 0.05f, 60.0f, options->width,
                                        options->height);
    s->uniforms = (patches_uniforms){.world_to_clip = camera.world_to_clip,
                                     .eye = eye,
                                     .to_sun = v3_normalize((v3){0.6f, 0.5f, 0.3f}),
                                     .size = 16.0f,
                                     .height = 0.55f,
                                     .reach = 16.0f};
}

static void patches_close(void *state)
{
    patches_state *s = state;
    if (!s)
        return;
    if (s->picture.has_peer) {
        glDeleteProgram(s->program);
        glDeleteVertexArrays(1, &s->array);
    }
    picture_close(&s->picture);
    free(s);
}

static amb_status patches_open(const bench_options *options, void **state, amb_error *error)
{
    patches_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the patches workload");
    set_uniforms(s, options);
    amb_status status = picture_open(options, 1, &s->picture, error);
    if (status || !options->peer)
        return status;
    glGenVertexArrays(1, &s->array);
    return patches_gl_program(&s->uniforms, &s->program, error);
}

static amb_status patches_run_peer(void *state, amb_error *error)
{
    const patches_state *s = state;
    picture_peer_begin(&s->picture);
    glBindVertexArray(s->array);
    glUseProgram(s->program);
    glPatchParameteri(GL_PATCH_VERTICES, 1);
    for (int first = 0; first < PATCHES; first += PEER_DRAW)
        glDrawArrays(GL_PATCHES, first, PEER_DRAW);
    return picture_peer_end(&s->picture, error);
}

static amb_draw patches_draw(const patches_state *s, const amb_context *context)
{
    const patches_shaders *shaders = AMB_DISPATCH(amb_context_isa(context), patches_shaders_get)();
    amb_draw draw = {.label = "terrain",
                     .lanes = shaders->lanes,
                     .fragment = shaders->fragment,
                     .uniforms = &s->uniforms,
                     .uniforms_size = sizeof s->uniforms,
                     .varying_floats = shaders->varying_floats,
                     .count = PATCHES,
                     .topology = AMB_PATCHES,
                     .cull = AMB_CULL_BACK};
    draw.tessellation = (amb_tessellation){.hull = shaders->hull,
                                           .domain = shaders->domain,
                                           .corners = 1,
                                           .patch_floats = shaders->patch_floats,
                                           .shape = AMB_QUAD,
                                           .partitioning = AMB_FRACTIONAL_EVEN};
    return draw;
}

static amb_status patches_run(void *state, const amb_context *context, amb_error *error)
{
    patches_state *s = state;
    const amb_draw draw = patches_draw(s, context);
    return picture_pass(&s->picture, context, &draw, 1, error);
}

static amb_status patches_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    patches_state *s = state;
    const amb_draw draw = patches_draw(s, context);
    amb_status status = picture_facts(&s->picture, context, &draw, 1, facts, error);
    bench_fact(facts, "patches", (double)s->picture.stats.patches * 1e-6, "M");
    bench_fact(facts, "domain points", (double)s->picture.stats.domain_points * 1e-6, "M");
    return status;
}

static amb_status patches_difference(void *state, double *rmse, amb_error *error)
{
    return picture_difference(&((patches_state *)state)->picture, rmse, error);
}

static bench_count patches_count(const void *state, const amb_context *context)
{
    const patches_state *s = state;
    (void)context;
    return (bench_count){.bytes = picture_bytes(&s->picture),
                         .items = (double)s->picture.stats.triangles_in * 1e-6,
                         .unit = "Mtriangles/s"};
}

const bench_workload bench_patches = {
    .name = "patches",
    .about = "terrain of 512x512 tessellated patches, 2 to 12 segments by distance, lit",
    .open = patches_open,
    .run = patches_run,
    .run_peer = patches_run_peer,
    .difference = patches_difference,
    .count = patches_count,
    .facts = patches_facts,
    .close = patches_close,
    .peer_goal = 3.0,
    .threads_goal = 1.9,
};
