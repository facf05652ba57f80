/* Procedural mountains: a grid of 512×512 quads displaced by 8 octaves, lit with 12 octaves of normal, fog, and
 * Preetham's sky over it: ours and GLSL. */
#include "bench/elevated.h"
#include "bench/picture.h"
#include "core/dispatch.h"

#include <ambiance/camera.h>
#include <stdlib.h>

AMB_DECLARE_WIDE(const elevated_bench_shaders *, elevated_bench_shaders_get, (void));

enum { SIDE = ELEVATED_QUADS + 1, INDICES = ELEVATED_QUADS * ELEVATED_QUADS * 6 };

typedef struct elevated_state {
    elevated_bench bench;
    amb_noise_texture noise;
    uint32_t *index;
    picture picture;
    GLuint ground, sky, texture, array, indices;
} elevated_state;

static amb_status open_peer(elevated_state *s, amb_error *error)
{
    amb_status status = gl_program(elevated_gl_ground_vertex, elevated_gl_ground_fragment, &s->ground, error);
    if (!status)
        status = gl_program(elevated_gl_sky_vertex, elevated_gl_sky_fragment, &s->sky, error);
    if (status)
        return status;
    glGenTextures(1, &s->texture);
    glBindTexture(GL_TEXTURE_2D, s->texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8I, AMB_NOISE_TEXTURE, AMB_NOISE_TEXTURE, 0, GL_RGBA_INTEGER, GL_BYTE,
                 s->noise.corners);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glGenVertexArrays(1, &s->array);
    glBindVertexArray(s->array);
    glGenBuffers(1, &s->indices);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, s->indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, INDICES * sizeof *s->index, s->index, GL_STATIC_DRAW);
    elevated_gl_uniforms(s->ground, &s->bench);
    elevated_gl_uniforms(s->sky, &s->bench);
    gl_set1(s->sky, "height", (float)s->picture.color->height);
    return gl_check(error);
}

static amb_status elevated_run_peer(void *state, amb_error *error)
{
    const elevated_state *s = state;
    picture_peer_begin(&s->picture);
    glBindVertexArray(s->array);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, s->texture);
    glUseProgram(s->ground);
    glDrawElements(GL_TRIANGLES, INDICES, GL_UNSIGNED_INT, NULL);
    glUseProgram(s->sky);
    glDepthFunc(GL_LEQUAL);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return picture_peer_end(&s->picture, error);
}

/* From the eye's side on, so that near ground hides far ground before it is shaded. */
static void make_grid(uint32_t *index)
{
    for (uint32_t y = ELEVATED_QUADS; y-- > 0;)
        for (uint32_t x = 0; x < ELEVATED_QUADS; x++, index += 6) {
            uint32_t a = y * SIDE + x, b = a + 1, c = a + SIDE, d = c + 1;
            const uint32_t two[6] = {a, c, b, b, c, d};
            for (int i = 0; i < 6; i++)
                index[i] = two[i];
        }
}

static void set_uniforms(elevated_state *s, const bench_options *options)
{
    elevated_bench *b = &s->bench;
    const v3 eye = {0.0f, 0.55f, 0.0f};
    amb_camera camera = amb_camera_look(eye, (v3){0.3f, 0.25f, -3.0f}, (v3){0, 1, 0}, 0.75f, 0.05f, 40.0f,
                                        options->width, options->height);
    *b = (elevated_bench){.world_to_clip = camera.world_to_clip,
                          .eye = eye,
                          .ray_origin = camera.ray_origin,
                          .ray_dx = camera.ray_dx,
                          .ray_dy = camera.ray_dy,
                          .size = 14.0f,
                          .scale = 0.42f,
                          .gain = 0.04f,
                          .fog_density = 0.08f,
                          .fog_falloff = 3.0f,
                          .snow_rgb = {0.86f, 0.90f, 0.95f},
                          .land_rgb = {0.17f, 0.145f, 0.125f},
                          .snow = {0.9f, 1.1f, 1.1f, 1.1f, 0.55f},
                          .occlusion_power = 1.6f,
                          .occlusion_floor = 0.18f};
    amb_terrain_place(&b->terrain, &s->noise, 7, 1.0f, true, 0, 0);
    b->sky = amb_sky_make(v3_normalize((v3){0.75f, 0.42f, -0.3f}), 3.0f);
}

static void elevated_close(void *state)
{
    elevated_state *s = state;
    if (!s)
        return;
    if (s->picture.has_peer) {
        glDeleteProgram(s->ground);
        glDeleteProgram(s->sky);
        glDeleteTextures(1, &s->texture);
        glDeleteBuffers(1, &s->indices);
        glDeleteVertexArrays(1, &s->array);
    }
    picture_close(&s->picture);
    free(s->index);
    free(s);
}

static amb_status elevated_open(const bench_options *options, void **state, amb_error *error)
{
    elevated_state *s = *state = calloc(1, sizeof *s);
    if (!s || !(s->index = malloc(INDICES * sizeof *s->index)))
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the elevated workload");
    amb_noise_texture_make(&s->noise, 1);
    make_grid(s->index);
    set_uniforms(s, options);
    amb_status status = picture_open(options, 1, &s->picture, error);
    return !status && options->peer ? open_peer(s, error) : status;
}

static void elevated_draws(const elevated_state *s, const amb_context *context, amb_draw draw[2])
{
    const elevated_bench_shaders *shaders = AMB_DISPATCH(amb_context_isa(context), elevated_bench_shaders_get)();
    draw[0] = (amb_draw){.label = "ground",
                         .lanes = shaders->lanes,
                         .vertex = shaders->vertex,
                         .fragment = shaders->ground,
                         .uniforms = &s->bench,
                         .uniforms_size = sizeof s->bench,
                         .varying_floats = shaders->varying_floats,
                         .indices = s->index,
                         .count = INDICES,
                         .vertex_count = SIDE * SIDE,
                         .cull = AMB_CULL_BACK};
    draw[1] = (amb_draw){.label = "sky",
                         .lanes = shaders->lanes,
                         .fragment = shaders->sky,
                         .uniforms = &s->bench,
                         .uniforms_size = sizeof s->bench,
                         .depth_write_off = true};
}

static amb_status elevated_run(void *state, const amb_context *context, amb_error *error)
{
    elevated_state *s = state;
    amb_draw draw[2];
    elevated_draws(s, context, draw);
    return picture_pass(&s->picture, context, draw, 2, error);
}

static amb_status elevated_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    elevated_state *s = state;
    amb_draw draw[2];
    elevated_draws(s, context, draw);
    return picture_facts(&s->picture, context, draw, 2, facts, error);
}

static amb_status elevated_difference(void *state, double *rmse, amb_error *error)
{
    return picture_difference(&((elevated_state *)state)->picture, rmse, error);
}

/* Arithmetic as written: an octave of the height's slope is 118 operations, of a height alone 60, of the fBm 30; the
 * rest of a ground fragment some 190. The sky's fragments, 170 operations each, are not told apart in the pass's count:
 * what is left of the pixels after the ground is taken as theirs. */
static bench_count elevated_count(const void *state, const amb_context *context)
{
    const elevated_state *s = state;
    (void)context;
    double fragments = (double)s->picture.stats.fragments_shaded;
    double ground = (ELEVATED_SHADING + ELEVATED_COARSE) * 118.0 + ELEVATED_SNOW * 30.0 + 190.0;
    return (bench_count){.flops = fragments * ground + SIDE * SIDE * ELEVATED_GEOMETRY * 60.0,
                         .bytes = picture_bytes(&s->picture),
                         .items = fragments * 1e-6,
                         .unit = "Mfragments/s"};
}

const bench_workload bench_elevated = {
    .name = "elevated",
    .about = "mountains: 512x512 quads displaced by 8 octaves, 12 octaves of normal, snow, fog, Preetham's sky",
    .open = elevated_open,
    .run = elevated_run,
    .run_peer = elevated_run_peer,
    .difference = elevated_difference,
    .count = elevated_count,
    .facts = elevated_facts,
    .close = elevated_close,
    .peer_goal = 4.0,
    .threads_goal = 1.9,
};
