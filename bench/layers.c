/* 64 full-screen alpha-blended layers, each its own turned and scaled look at a trilinear texture. */
#include "bench/layers.h"
#include "bench/paint.h"
#include "bench/picture.h"
#include "core/dispatch.h"

#include <ambiance/math.h>
#include <stdlib.h>

AMB_DECLARE_WIDE(layer_shader, layer_shader_get, (void));

enum { LAYERS = 64, TEXTURE = 1024 };

typedef struct layers_state {
    picture picture;
    amb_texture *texture;
    layer_uniforms layer[LAYERS];
    amb_draw draw[LAYERS];
    GLuint program, array, peer_texture;
    GLint u, v, tint;
} layers_state;

static const char *const peer_vertex = "void main() {\n"
                                       "    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;\n"
                                       "    gl_Position = vec4(corner, 0.0, 1.0);\n"
                                       "}\n";
static const char *const peer_fragment =
    "uniform sampler2D image; uniform vec3 u, v; uniform vec4 tint; uniform float height; out vec4 result;\n"
    "void main() {\n"
    "    vec3 at = vec3(gl_FragCoord.x, height - gl_FragCoord.y, 1.0);\n"
    "    result = texture(image, vec2(dot(u, at), dot(v, at))) * tint;\n"
    "}\n";

/* From a half to two texels a pixel, turned by a golden angle from layer to layer. */
static void set_layers(layers_state *s)
{
    for (int i = 0; i < LAYERS; i++) {
        float turn = 2.39996f * (float)i, texels = 0.5f * amb_exp2((float)i * (2.0f / LAYERS));
        float c = f_cos(turn) * texels / TEXTURE, d = f_sin(turn) * texels / TEXTURE;
        s->layer[i] = (layer_uniforms){.u = {c, -d, 0.37f * (float)i},
                                       .v = {d, c, 0.23f * (float)i},
                                       .tint = {0.5f + 0.5f * f_cos(turn), 0.75f, 0.5f + 0.5f * f_sin(turn), 0.3f},
                                       .texture = s->texture,
                                       .sampler = {.filter = AMB_TRILINEAR}};
    }
}

static amb_status open_peer(layers_state *s, const paint_chain *chain, amb_error *error)
{
    amb_status status = gl_program(peer_vertex, peer_fragment, &s->program, error);
    if (status)
        return status;
    glGenVertexArrays(1, &s->array);
    s->peer_texture =
        gl_upload_texture(GL_TEXTURE_2D, GL_RGBA8, GL_UNSIGNED_BYTE, TEXTURE, chain->data, chain->texel_bytes);
    glUseProgram(s->program);
    glUniform1i(glGetUniformLocation(s->program, "image"), 0);
    gl_set1(s->program, "height", (float)s->picture.target.height);
    s->u = glGetUniformLocation(s->program, "u");
    s->v = glGetUniformLocation(s->program, "v");
    s->tint = glGetUniformLocation(s->program, "tint");
    return gl_check(error);
}

static amb_status layers_open(const bench_options *options, void **state, amb_error *error)
{
    layers_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the layers workload");
    paint_chain color = {0}, normal = {0};
    amb_status status = paint_surface(TEXTURE, &color, &normal, error);
    if (!status)
        status = paint_texture(&color, &s->texture, error);
    if (!status)
        status = picture_open(options, 1, &s->picture, error);
    if (!status) {
        s->picture.clear_color = (v4){0.1f, 0.2f, 0.4f, 1.0f};
        set_layers(s);
        if (options->peer)
            status = open_peer(s, &color, error);
    }
    paint_close(&color);
    paint_close(&normal);
    return status;
}

static void layers_close(void *state)
{
    layers_state *s = state;
    if (!s)
        return;
    if (s->picture.has_peer) {
        glDeleteProgram(s->program);
        glDeleteVertexArrays(1, &s->array);
        glDeleteTextures(1, &s->peer_texture);
    }
    picture_close(&s->picture);
    amb_texture_close(&s->texture);
    free(s);
}

static void make_draws(layers_state *s, const amb_context *context)
{
    layer_shader shader = AMB_DISPATCH(amb_context_isa(context), layer_shader_get)();
    for (int i = 0; i < LAYERS; i++)
        s->draw[i] = (amb_draw){.label = "layer",
                                .lanes = shader.lanes,
                                .fragment = shader.fragment,
                                .uniforms = &s->layer[i],
                                .uniforms_size = sizeof s->layer[i],
                                .depth_compare = AMB_ALWAYS,
                                .depth_write_off = true,
                                .blend = {AMB_BLEND_ALPHA}};
}

static amb_status layers_run(void *state, const amb_context *context, amb_error *error)
{
    layers_state *s = state;
    make_draws(s, context);
    return picture_pass(&s->picture, context, s->draw, LAYERS, error);
}

static amb_status layers_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    layers_state *s = state;
    make_draws(s, context);
    return picture_facts(&s->picture, context, s->draw, LAYERS, facts, error);
}

static amb_status layers_run_peer(void *state, amb_error *error)
{
    const layers_state *s = state;
    picture_peer_begin(&s->picture);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(s->program);
    glBindVertexArray(s->array);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, s->peer_texture);
    for (int i = 0; i < LAYERS; i++) {
        const layer_uniforms *l = &s->layer[i];
        glUniform3f(s->u, l->u.x, l->u.y, l->u.z);
        glUniform3f(s->v, l->v.x, l->v.y, l->v.z);
        glUniform4f(s->tint, l->tint.x, l->tint.y, l->tint.z, l->tint.w);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glDisable(GL_BLEND);
    return picture_peer_end(&s->picture, error);
}

static amb_status layers_difference(void *state, double *rmse, amb_error *error)
{
    return picture_difference(&((layers_state *)state)->picture, rmse, error);
}

/* A fragment: 8 for coordinates, 30 for texels' places and levels, 7 blends of 4 channels of 3, 4 tints, 16 of alpha
 * blending. Bytes: the pictures, once; the layers meet in the caches. */
static bench_count layers_count(const void *state, const amb_context *context)
{
    const layers_state *s = state;
    (void)context;
    double fragments = (double)s->picture.stats.fragments_shaded;
    return (bench_count){.flops = fragments * (8 + 30 + 7 * 4 * 3 + 4 + 16),
                         .bytes = picture_bytes(&s->picture),
                         .items = fragments * 1e-6,
                         .unit = "Mfragments/s"};
}

const bench_workload bench_layers = {
    .name = "layers",
    .about = "64 full-screen alpha-blended layers of a trilinear 1024x1024 texture",
    .open = layers_open,
    .run = layers_run,
    .run_peer = layers_run_peer,
    .difference = layers_difference,
    .count = layers_count,
    .facts = layers_facts,
    .close = layers_close,
    .peer_goal = 3.0,
    .threads_goal = 1.9,
};
