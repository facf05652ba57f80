#include "bench/picture.h"

#include <stdlib.h>

amb_status picture_open(const bench_options *options, int samples, picture *p, amb_error *error)
{
    *p = (picture){.samples = samples};
    amb_status status = amb_image_create(options->width, options->height, 4, &p->color, error);
    if (!status)
        status = amb_image_create(options->width, options->height, 1, &p->depth, error);
    if (status || !options->peer)
        return status;
    p->has_peer = true;
    status = gl_target_create(options->width, options->height, 1, &p->target, error);
    if (!status && samples > 1)
        status = gl_target_create(options->width, options->height, samples, &p->multisampled, error);
    return status;
}

amb_status picture_open_depth(const bench_options *options, int size, picture *p, amb_error *error)
{
    *p = (picture){.samples = 1};
    amb_status status = amb_image_create(size, size, 1, &p->depth, error);
    if (status || !options->peer)
        return status;
    p->has_peer = true;
    return gl_depth_target_create(size, size, &p->target, error);
}

void picture_close(picture *p)
{
    amb_image_close(&p->color);
    amb_image_close(&p->depth);
    if (p->has_peer) {
        gl_target_close(&p->target);
        if (p->samples > 1)
            gl_target_close(&p->multisampled);
    }
    *p = (picture){0};
}

static amb_status run_pass(picture *p, const amb_context *context, const amb_draw *draw, size_t count, bool timed,
                           amb_error *error)
{
    amb_target target = {.color = {p->color},
                         .depth = p->depth,
                         .clear_color = {p->clear_color},
                         .clear_depth = 1.0f,
                         .samples = p->samples,
                         .time_stages = timed};
    amb_pass *pass = NULL;
    amb_status status = amb_pass_begin(context, &target, &pass, error);
    for (size_t i = 0; i < count && !status; i++)
        status = amb_pass_draw(pass, &draw[i], error);
    if (!status)
        return amb_pass_finish(&pass, &p->stats, error);
    amb_pass_close(&pass);
    return status;
}

amb_status picture_pass(picture *p, const amb_context *context, const amb_draw *draw, size_t count, amb_error *error)
{
    return run_pass(p, context, draw, count, false, error);
}

void picture_peer_begin(const picture *p)
{
    const gl_target *t = p->samples > 1 ? &p->multisampled : &p->target;
    glBindFramebuffer(GL_FRAMEBUFFER, t->frame);
    glViewport(0, 0, t->width, t->height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glEnable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glClearColor(p->clear_color.x, p->clear_color.y, p->clear_color.z, p->clear_color.w);
    glClearDepthf(1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

amb_status picture_peer_end(const picture *p, amb_error *error)
{
    if (p->samples > 1)
        gl_resolve(&p->multisampled, &p->target);
    glFinish();
    return gl_check(error);
}

/* GL ES cannot read depth: a shader writes it as a colour. */
static amb_status depth_as_color(const picture *p, gl_target *out, amb_error *error)
{
    static const char *const vertex = "void main() {\n"
                                      "    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;\n"
                                      "    gl_Position = vec4(corner, 0.0, 1.0);\n"
                                      "}\n";
    static const char *const fragment = "uniform sampler2D depth; out vec4 result;\n"
                                        "void main() { result = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).rrrr; }\n";
    GLuint program = 0;
    amb_status status = gl_target_create(p->target.width, p->target.height, 1, out, error);
    if (!status)
        status = gl_program(vertex, fragment, &program, error);
    if (status)
        return status;
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(program);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, p->target.depth);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDeleteProgram(program);
    return gl_check(error);
}

amb_status picture_difference(const picture *p, double *rmse, amb_error *error)
{
    const amb_image *ours = p->color ? p->color : p->depth;
    float *pixels = malloc((size_t)ours->width * (size_t)ours->height * 4 * sizeof *pixels);
    if (!pixels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    gl_target shown = {0};
    amb_status status = p->color ? AMB_OK : depth_as_color(p, &shown, error);
    if (!status) {
        gl_read(p->color ? &p->target : &shown, pixels);
        *rmse = bench_rmse(ours, pixels);
        status = gl_check(error);
    }
    if (!p->color)
        gl_target_close(&shown);
    free(pixels);
    return status;
}

amb_status picture_facts(picture *p, const amb_context *context, const amb_draw *draw, size_t count, bench_facts *facts,
                         amb_error *error)
{
    amb_status status = run_pass(p, context, draw, count, true, error);
    if (status)
        return status;
    const amb_pass_stats *s = &p->stats;
    double all = 0.0;
    for (int i = 0; i < AMB_STAGES; i++)
        all += (double)s->ticks[i];
    for (int i = 0; i < AMB_STAGES && all > 0.0; i++)
        bench_fact(facts, amb_stage_name((amb_stage)i), 100.0 * (double)s->ticks[i] / all, "%");
    bench_fact(facts, "triangles in", (double)s->triangles_in, "");
    bench_fact(facts, "binned", (double)s->triangles_binned, "");
    bench_fact(facts, "fragments", (double)s->fragments_shaded, "");
    if (s->blocks_shaded > 0)
        bench_fact(facts, "lanes used",
                   100.0 * (double)s->fragments_shaded / ((double)s->blocks_shaded * (double)amb_context_isa(context)),
                   "%");
    return AMB_OK;
}

double picture_bytes(const picture *p)
{
    return (double)p->depth->width * p->depth->height * (p->color ? 5.0 : 1.0) * sizeof(float);
}
