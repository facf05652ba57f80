/* Anti-aliasing at its defaults, against three passes of GLSL: discontinuities of CIE Lab, weights with searches that
 * stop at the ends of lines, blending; each leaves early where nothing is to do. */
#include "bench/post_mlaa.h"

#include <stdlib.h>

static const char *const detect_source =
    "uniform sampler2D t0; out vec4 result;\n"
    "float curve(float t) { return t > 0.00885645 ? pow(t, 1.0 / 3.0) : t * 7.787037 + 0.1379310; }\n"
    "vec3 lab(ivec2 at) {\n"
    "    vec3 c = clamp(texelFetch(t0, at, 0).rgb, 0.0, 1.0);\n"
    "    float x = curve(dot(c, vec3(0.433953, 0.376219, 0.189828)));\n"
    "    float y = curve(dot(c, vec3(0.212673, 0.715152, 0.072175)));\n"
    "    float z = curve(dot(c, vec3(0.017757, 0.109468, 0.872775)));\n"
    "    return vec3(116.0 * y, 500.0 * (x - y), 200.0 * (y - z));\n"
    "}\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(t0, 0) - 1;\n"
    "    vec3 here = lab(at);\n"
    "    vec3 right = here - lab(min(at + ivec2(1, 0), last)), down = here - lab(min(at + ivec2(0, 1), last));\n"
    "    result = vec4(dot(right, right) > 144.0, dot(down, down) > 144.0, 0.0, 1.0);\n"
    "}\n";
/* edge(p).x: beyond p to the right; .y: below. A line runs along `along`; its sides lie at p and p + across. */
static const char *const weigh_source =
    "uniform sampler2D t0; out vec4 result;\n"
    "ivec2 last;\n"
    "float edge(ivec2 at, int which) {\n"
    "    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) return 0.0;\n"
    "    vec2 e = texelFetch(t0, at, 0).rg;\n"
    "    return which == 0 ? e.x : e.y;\n"
    "}\n"
    "float weight(ivec2 at, bool vertical, bool second) {\n"
    "    ivec2 along = vertical ? ivec2(0, 1) : ivec2(1, 0), across = vertical ? ivec2(1, 0) : ivec2(0, 1);\n"
    "    int line = vertical ? 0 : 1;\n"
    "    if (edge(at, line) == 0.0) return 0.0;\n"
    "    int back = 0, ahead = 0;\n"
    "    while (back < 255 && edge(at - along * (back + 1), line) > 0.0) back++;\n"
    "    while (ahead < 255 && edge(at + along * (ahead + 1), line) > 0.0) ahead++;\n"
    "    if (back == ahead) return 0.0;\n"
    "    ivec2 end = back < ahead ? at - along * (back + 1) : at + along * ahead;\n"
    "    float a = edge(end, 1 - line), b = edge(end + across, 1 - line);\n"
    "    if (a == b || (b > 0.0) != second) return 0.0;\n"
    "    float corner = edge(second ? end + 2 * across : end - across, 1 - line);\n"
    "    float area = 0.5 * (1.0 - float(2 * min(back, ahead) + 1) / float(back + ahead + 1));\n"
    "    return corner > 0.0 ? 0.25 * area : area;\n"
    "}\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "    last = textureSize(t0, 0) - 1;\n"
    "    result = vec4(weight(at - ivec2(0, 1), false, true), weight(at, false, false),\n"
    "                  weight(at - ivec2(1, 0), true, true), weight(at, true, false));\n"
    "}\n";
static const char *const blend_source = "uniform sampler2D t0, t1; out vec4 result;\n"
                                        "void main() {\n"
                                        "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
                                        "    vec4 c = texelFetch(t0, at, 0), w = texelFetch(t1, at, 0);\n"
                                        "    float sum = dot(w, vec4(1.0));\n"
                                        "    result = c;\n"
                                        "    if (sum == 0.0) return;\n"
                                        "    ivec2 last = textureSize(t0, 0) - 1;\n"
                                        "    w /= max(sum, 1.0);\n"
                                        "    result += w.x * (texelFetch(t0, max(at - ivec2(0, 1), 0), 0) - c);\n"
                                        "    result += w.y * (texelFetch(t0, min(at + ivec2(0, 1), last), 0) - c);\n"
                                        "    result += w.z * (texelFetch(t0, max(at - ivec2(1, 0), 0), 0) - c);\n"
                                        "    result += w.w * (texelFetch(t0, min(at + ivec2(1, 0), last), 0) - c);\n"
                                        "}\n";

amb_status peer_mlaa_open(post_state *s, peer_mlaa *m, amb_error *error)
{
    amb_status status = post_program(s, detect_source, &m->detect, error);
    if (!status)
        status = post_program(s, weigh_source, &m->weigh, error);
    if (!status)
        status = post_program(s, blend_source, &m->blend, error);
    if (!status)
        status = post_target_add(s, s->picture->width, s->picture->height, true, &m->edges, error);
    if (!status)
        status = post_target_add(s, s->picture->width, s->picture->height, false, &m->weights, error);
    return status;
}

void peer_mlaa_draw(const peer_mlaa *m, GLuint source, const post_target *to)
{
    post_draw(m->edges, m->detect, source, 0, 0);
    post_draw(m->weights, m->weigh, m->edges->texture, 0, 0);
    post_draw(to, m->blend, source, m->weights->texture, 0);
}

/* ---- the workload ------------------------------------------------------------------------------------------------ */

typedef struct mlaa_state {
    post_state *post;
    peer_mlaa peer;
    post_target *result;
} mlaa_state;

static void mlaa_close(void *state)
{
    mlaa_state *s = state;
    if (s)
        post_close(s->post);
    free(s);
}

static amb_status mlaa_open(const bench_options *options, void **state, amb_error *error)
{
    mlaa_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the mlaa workload");
    amb_status status = post_open(options, "mlaa:threshold=12,corners=0.25", &s->post, error);
    if (status || !options->peer)
        return status;
    status = peer_mlaa_open(s->post, &s->peer, error);
    if (!status)
        status = post_target_add(s->post, options->width, options->height, false, &s->result, error);
    s->post->result = s->result;
    return status;
}

static amb_status mlaa_prepare(void *state, amb_error *error)
{
    return post_prepare(((mlaa_state *)state)->post, error);
}

static amb_status mlaa_run(void *state, const amb_context *context, amb_error *error)
{
    return post_run(((mlaa_state *)state)->post, context, error);
}

static amb_status mlaa_run_peer(void *state, amb_error *error)
{
    const mlaa_state *s = state;
    peer_mlaa_draw(&s->peer, s->post->source, s->result);
    glFinish();
    return gl_check(error);
}

static amb_status mlaa_difference(void *state, double *rmse, amb_error *error)
{
    return post_difference(((mlaa_state *)state)->post, rmse, error);
}

/* Three planes of floats, read once; what the few edge pixels add is not counted. */
static bench_count mlaa_count(const void *state, const amb_context *context)
{
    (void)context;
    const amb_image *p = ((const mlaa_state *)state)->post->picture;
    double pixels = (double)p->width * p->height;
    return (bench_count){.bytes = pixels * 12.0, .items = pixels * 1e-6, .unit = "Mpixel/s"};
}

const bench_workload bench_post_mlaa = {
    .name = "mlaa",
    .about = "anti-aliasing: CIE Lab edges, lines up to 255 pixels each way, blending",
    .open = mlaa_open,
    .prepare = mlaa_prepare,
    .run = mlaa_run,
    .run_peer = mlaa_run_peer,
    .difference = mlaa_difference,
    .count = mlaa_count,
    .close = mlaa_close,
    .peer_goal = 8.0,
    .threads_goal = 1.8,
};
