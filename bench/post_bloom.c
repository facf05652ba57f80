/* Bloom: threshold 1, quarter size, three rounds of 7 taps each way, against the same in GLSL on RGBA16F targets: one
 * pass for threshold and reduction, six blurs, one to add. */
#include "bench/post_bloom.h"

#include <ambiance/math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const bright_source =
    "uniform sampler2D t0; out vec4 result;\n"
    "void main() {\n"
    "    ivec2 last = textureSize(t0, 0) - 1, at = ivec2(gl_FragCoord.xy) * 4;\n"
    "    vec3 sum = vec3(0.0);\n"
    "    for (int j = 0; j < 4; j++)\n"
    "        for (int i = 0; i < 4; i++) {\n"
    "            vec3 c = clamp(texelFetch(t0, min(at + ivec2(i, j), last), 0).rgb, 0.0, 65504.0);\n"
    "            float largest = max(c.r, max(c.g, c.b));\n"
    "            sum += c * (max(largest - 1.0, 0.0) / max(largest, 1e-20));\n"
    "        }\n"
    "    result = vec4(sum * 0.0625, 1.0);\n"
    "}\n";
/* %s: ivec2(k, 0) or ivec2(0, k) */
static const char *const blur_source = "uniform sampler2D t0; out vec4 result;\n"
                                       "void main() {\n"
                                       "    ivec2 last = textureSize(t0, 0) - 1, at = ivec2(gl_FragCoord.xy);\n"
                                       "    const float w[4] = float[4](%.9g, %.9g, %.9g, %.9g);\n"
                                       "    vec3 sum = texelFetch(t0, at, 0).rgb * w[0];\n"
                                       "    for (int k = 1; k <= 3; k++)\n"
                                       "        sum += w[k] * (texelFetch(t0, min(at + %s, last), 0).rgb +\n"
                                       "                       texelFetch(t0, max(at - %s, ivec2(0)), 0).rgb);\n"
                                       "    result = vec4(sum, 1.0);\n"
                                       "}\n";
static const char *const add_source =
    "uniform sampler2D t0, t1; out vec4 result;\n"
    "void main() {\n"
    "    vec4 c = texelFetch(t0, ivec2(gl_FragCoord.xy), 0);\n"
    "    vec2 cells = vec2(textureSize(t1, 0)) * 4.0;\n"
    "    result = vec4(c.rgb + 0.3 * texture(t1, gl_FragCoord.xy / cells).rgb, c.a);\n"
    "}\n";

static amb_status blur_program(post_state *s, const char *step, GLuint *out, amb_error *error)
{
    float w[4], sum = 0.0f;
    for (int i = 0; i < 4; i++) {
        w[i] = amb_exp(-0.5f * (float)(i * i) / (1.7f * 1.7f));
        sum += i ? 2.0f * w[i] : w[i];
    }
    char source[1024];
    snprintf(source, sizeof source, blur_source, (double)(w[0] / sum), (double)(w[1] / sum), (double)(w[2] / sum),
             (double)(w[3] / sum), step, step);
    return post_program(s, source, out, error);
}

amb_status peer_bloom_open(post_state *s, peer_bloom *b, amb_error *error)
{
    int width = (s->picture->width + 3) / 4, height = (s->picture->height + 3) / 4;
    amb_status status = post_program(s, bright_source, &b->bright, error);
    if (!status)
        status = blur_program(s, "ivec2(k, 0)", &b->across, error);
    if (!status)
        status = blur_program(s, "ivec2(0, k)", &b->down, error);
    for (int i = 0; i < 2 && !status; i++)
        status = post_target_add(s, width, height, false, &b->half[i], error);
    return status;
}

void peer_bloom_draw(const peer_bloom *b, GLuint source)
{
    post_draw(b->half[0], b->bright, source, 0, 0);
    for (int round = 0; round < 3; round++) {
        post_draw(b->half[1], b->across, b->half[0]->texture, 0, 0);
        post_draw(b->half[0], b->down, b->half[1]->texture, 0, 0);
    }
}

/* ---- the workload ------------------------------------------------------------------------------------------------ */

typedef struct bloom_state {
    post_state *post;
    peer_bloom peer;
    GLuint add;
    post_target *result;
} bloom_state;

static void bloom_close(void *state)
{
    bloom_state *s = state;
    if (s)
        post_close(s->post);
    free(s);
}

static amb_status bloom_open(const bench_options *options, void **state, amb_error *error)
{
    bloom_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the bloom workload");
    amb_status status = post_open(options, "bloom:threshold=1,intensity=0.3,sigma=1.7,reduce=quarter", &s->post, error);
    if (status || !options->peer)
        return status;
    status = peer_bloom_open(s->post, &s->peer, error);
    if (!status)
        status = post_program(s->post, add_source, &s->add, error);
    if (!status)
        status = post_target_add(s->post, options->width, options->height, false, &s->result, error);
    s->post->result = s->result;
    return status;
}

static amb_status bloom_prepare(void *state, amb_error *error)
{
    return post_prepare(((bloom_state *)state)->post, error);
}

static amb_status bloom_run(void *state, const amb_context *context, amb_error *error)
{
    return post_run(((bloom_state *)state)->post, context, error);
}

static amb_status bloom_run_peer(void *state, amb_error *error)
{
    const bloom_state *s = state;
    peer_bloom_draw(&s->peer, s->post->source);
    post_draw(s->result, s->add, s->post->source, s->peer.half[0]->texture, 0);
    glFinish();
    return gl_check(error);
}

static amb_status bloom_difference(void *state, double *rmse, amb_error *error)
{
    return post_difference(((bloom_state *)state)->post, rmse, error);
}

/* Three planes of floats, read once; where something glows they are read and written again, which is not counted. */
static bench_count bloom_count(const void *state, const amb_context *context)
{
    (void)context;
    const amb_image *p = ((const bloom_state *)state)->post->picture;
    double pixels = (double)p->width * p->height;
    return (bench_count){.bytes = pixels * 12.0, .items = pixels * 1e-6, .unit = "Mpixel/s"};
}

const bench_workload bench_post_bloom = {
    .name = "bloom",
    .about = "threshold, quarter size, 3 x 7 taps each way, added",
    .open = bloom_open,
    .prepare = bloom_prepare,
    .run = bloom_run,
    .run_peer = bloom_run_peer,
    .difference = bloom_difference,
    .count = bloom_count,
    .close = bloom_close,
    .peer_goal = 8.0,
    .threads_goal = 1.8,
};
