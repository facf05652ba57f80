/* The whole chain: anti-aliasing, bloom, colour adjustment, vignette, grain, filmic display transform. The peer runs
 * the last five as one shader, as one would write them. */
#include "bench/post_bloom.h"
#include "bench/post_mlaa.h"

#include <stdlib.h>

static const char *const chain_text = "mlaa:threshold=12,corners=0.25;"
                                      "bloom:threshold=1,intensity=0.3,sigma=1.7,reduce=quarter;"
                                      "adjust:saturation=1.2,contrast=1.1,brightness=1.05;"
                                      "vignette:strength=0.5;"
                                      "grain:amount=0.05;"
                                      "display:curve=filmic,white=11.2";

static const char *const finish_source =
    "uniform sampler2D t0, t1; out vec4 result;\n"
    "uint mix_bits(uint h) {\n"
    "    h = (h ^ (h >> 16u)) * 0x85ebca6bu; h = (h ^ (h >> 13u)) * 0xc2b2ae35u; return h ^ (h >> 16u);\n"
    "}\n"
    "vec3 hable(vec3 a) {\n"
    "    return (a * (a * 0.15 + 0.05) + 0.004) / (a * (a * 0.15 + 0.5) + 0.06) - 0.02 / 0.3;\n"
    "}\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "    vec2 size = vec2(textureSize(t0, 0));\n"
    "    vec3 c = texelFetch(t0, at, 0).rgb + 0.3 * texture(t1, gl_FragCoord.xy / (vec2(textureSize(t1, 0)) * "
    "4.0)).rgb;\n"
    "    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);\n"
    "    c = mix(vec3(dot(c, luminance)), c, 1.2);\n"
    "    c = ((c - 0.18) * 1.1 + 0.18) * 1.05;\n"
    "    vec2 off = 2.0 * gl_FragCoord.xy - size;\n"
    "    float over = 1.0 + dot(off, off) * 0.25 / dot(size, size);\n"
    "    c /= over * over;\n"
    "    uint h = mix_bits(uint(at.x) + mix_bits(uint(at.y) + mix_bits(0x846ca68bu)) * 0x9e3779b9u);\n"
    "    float noise = (float(h >> 16u) - float(h & 0xffffu)) / 65536.0;\n"
    "    c += 0.05 * noise * sqrt(clamp(dot(c, luminance), 0.0, 65504.0));\n"
    "    c = clamp(hable(clamp(c, 0.0, 65504.0)) / hable(vec3(11.2)), 0.0, 1.0);\n"
    "    c = mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(c, vec3(0.0031308))));\n"
    "    result = vec4(c, 1.0);\n"
    "}\n";

typedef struct chain_state {
    post_state *post;
    peer_mlaa mlaa;
    peer_bloom bloom;
    GLuint finish;
    post_target *smooth, *result;
} chain_state;

static void chain_close(void *state)
{
    chain_state *s = state;
    if (s)
        post_close(s->post);
    free(s);
}

static amb_status chain_open(const bench_options *options, void **state, amb_error *error)
{
    chain_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the chain workload");
    amb_status status = post_open(options, chain_text, &s->post, error);
    if (status || !options->peer)
        return status;
    status = peer_mlaa_open(s->post, &s->mlaa, error);
    if (!status)
        status = peer_bloom_open(s->post, &s->bloom, error);
    if (!status)
        status = post_program(s->post, finish_source, &s->finish, error);
    if (!status)
        status = post_target_add(s->post, options->width, options->height, false, &s->smooth, error);
    if (!status)
        status = post_target_add(s->post, options->width, options->height, false, &s->result, error);
    s->post->result = s->result;
    return status;
}

static amb_status chain_prepare(void *state, amb_error *error)
{
    return post_prepare(((chain_state *)state)->post, error);
}

static amb_status chain_run(void *state, const amb_context *context, amb_error *error)
{
    return post_run(((chain_state *)state)->post, context, error);
}

static amb_status chain_run_peer(void *state, amb_error *error)
{
    const chain_state *s = state;
    peer_mlaa_draw(&s->mlaa, s->post->source, s->smooth);
    peer_bloom_draw(&s->bloom, s->smooth->texture);
    post_draw(s->result, s->finish, s->smooth->texture, s->bloom.half[0]->texture, 0);
    glFinish();
    return gl_check(error);
}

static amb_status chain_difference(void *state, double *rmse, amb_error *error)
{
    return post_difference(((chain_state *)state)->post, rmse, error);
}

/* Three planes of floats: read for edges, read for bloom, then read and written. */
static bench_count chain_count(const void *state, const amb_context *context)
{
    (void)context;
    const amb_image *p = ((const chain_state *)state)->post->picture;
    double pixels = (double)p->width * p->height;
    return (bench_count){.bytes = pixels * 12.0 * 4.0, .items = pixels * 1e-6, .unit = "Mpixel/s"};
}

const bench_workload bench_post_chain = {
    .name = "chain",
    .about = "mlaa, bloom, adjust, vignette, grain, filmic display transform",
    .open = chain_open,
    .prepare = chain_prepare,
    .run = chain_run,
    .run_peer = chain_run_peer,
    .difference = chain_difference,
    .count = chain_count,
    .close = chain_close,
    .peer_goal = 6.0,
    .threads_goal = 1.8,
};
