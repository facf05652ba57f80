#include "bench/post.h"

#include <ambiance/half.h>
#include <ambiance/math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the picture ------------------------------------------------------------------------------------------------- */

/* A stand-in for a rendered frame: a third of it sky or dark, smoothly shaded bodies, facades with window rows, slanted
 * beams, a sun of light 12. Hard edges throughout, as rendered without samples. */
static v3 paint(float x, float y)
{
    float dx = x - 0.33f, dy = y - 0.42f, r2 = dx * dx + dy * dy;
    if (r2 < 0.05f) { /* a shaded ball with a highlight */
        float z = f_sqrt(0.05f - r2) * 4.47f;
        float facing = f_max(0.0f, (-dx * 2.0f - dy * 2.4f) + 0.6f * z);
        float shine = f_max(0.0f, facing - 0.9f) * 40.0f;
        return (v3){0.05f + 0.6f * facing + shine, 0.06f + 0.45f * facing + shine, 0.08f + 0.3f * facing + shine};
    }
    dx = x - 1.08f, dy = y - 0.2f, r2 = dx * dx + dy * dy;
    if (r2 < 0.006f)
        return (v3){12.0f, 10.0f, 5.0f};
    float skyline = 0.62f + 0.1f * f_floor(4.0f * f_sin(23.0f * f_floor(x * 9.0f))) * 0.25f;
    if (y > skyline) { /* facades */
        float u = f_fract(x * 9.0f), v = f_fract(y * 31.0f), w = f_fract(x * 54.0f);
        bool window = v > 0.35f && w > 0.3f && u > 0.08f && u < 0.92f;
        float wall = 0.12f + 0.25f * f_fract(f_floor(x * 9.0f) * 0.37f) + 0.1f * u;
        return window ? (v3){0.5f * wall, 0.7f * wall, 0.9f} : (v3){wall, 0.9f * wall, 0.8f * wall};
    }
    if (f_fract(x * 1.7f + y * 5.3f) < 0.04f && x > 0.7f)
        return (v3){0.7f, 0.65f, 0.5f};
    return (v3){0.02f + 0.25f * y, 0.04f + 0.4f * y, 0.1f + 0.6f * y};
}

static float as_half(float a) { return half_to_f(f_to_half(a)); }

static void paint_picture(const amb_image *image)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            v3 rgb = paint(((float)x + 0.5f) / (float)image->height, ((float)y + 0.5f) / (float)image->height);
            amb_image_row(image, 0, y)[x] = as_half(rgb.x);
            amb_image_row(image, 1, y)[x] = as_half(rgb.y);
            amb_image_row(image, 2, y)[x] = as_half(rgb.z);
            amb_image_row(image, 3, y)[x] = 1.0f;
        }
}

/* ---- the peer ---------------------------------------------------------------------------------------------------- */

static void texture_setup(GLuint texture)
{
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

/* Row 0 of the picture is the bottom row of the texture: the shaders then count rows as we do. */
static amb_status upload(post_state *s, amb_error *error)
{
    const amb_image *from = s->picture;
    float *rgba = malloc((size_t)from->width * (size_t)from->height * 4 * sizeof *rgba);
    if (!rgba)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the peer's picture");
    for (int y = 0; y < from->height; y++)
        for (int x = 0; x < from->width; x++)
            for (int c = 0; c < 4; c++)
                rgba[((size_t)y * (size_t)from->width + (size_t)x) * 4 + (size_t)c] = amb_image_row(from, c, y)[x];
    glGenVertexArrays(1, &s->array);
    glGenTextures(1, &s->source);
    texture_setup(s->source);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, from->width, from->height, 0, GL_RGBA, GL_FLOAT, rgba);
    free(rgba);
    s->has_peer = true;
    return gl_check(error);
}

amb_status post_program(post_state *s, const char *fragment, GLuint *out, amb_error *error)
{
    static const char *const vertex = "void main() {\n"
                                      "    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;\n"
                                      "    gl_Position = vec4(corner, 0.0, 1.0);\n"
                                      "}\n";
    amb_status status = gl_program(vertex, fragment, out, error);
    if (status)
        return status;
    s->program[s->programs++] = *out;
    glUseProgram(*out);
    static const char *const names[] = {"t0", "t1", "t2"};
    for (int i = 0; i < 3; i++)
        glUniform1i(glGetUniformLocation(*out, names[i]), i);
    return gl_check(error);
}

amb_status post_target_add(post_state *s, int width, int height, bool flags, post_target **out, amb_error *error)
{
    post_target *t = *out = &s->target[s->targets++];
    *t = (post_target){.width = width, .height = height};
    glGenFramebuffers(1, &t->frame);
    glGenTextures(1, &t->texture);
    texture_setup(t->texture);
    glTexStorage2D(GL_TEXTURE_2D, 1, flags ? GL_RG8 : GL_RGBA16F, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, t->frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, t->texture, 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "no peer: it cannot render to 16-bit float");
    return gl_check(error);
}

void post_draw(const post_target *to, GLuint program, GLuint t0, GLuint t1, GLuint t2)
{
    const GLuint textures[3] = {t0, t1, t2};
    glBindFramebuffer(GL_FRAMEBUFFER, to->frame);
    glViewport(0, 0, to->width, to->height);
    for (GLuint i = 0; i < 3; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(GL_TEXTURE_2D, textures[i]);
    }
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* ---- state ------------------------------------------------------------------------------------------------------- */

amb_status post_open(const bench_options *options, const char *chain, post_state **out, amb_error *error)
{
    post_state *s = *out = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for a post workload");
    s->text = chain;
    amb_status status = amb_frame_create(options->width, options->height, &s->frame, error);
    if (!status)
        status = amb_image_create(options->width, options->height, 4, &s->picture, error);
    if (status)
        return status;
    paint_picture(s->picture);
    if (!options->peer)
        return AMB_OK;
    status = upload(s, error);
    if (!status)
        glBindVertexArray(s->array);
    return status;
}

void post_close(void *state)
{
    post_state *s = state;
    if (!s)
        return;
    for (int i = 0; i < s->programs; i++)
        glDeleteProgram(s->program[i]);
    for (int i = 0; i < s->targets; i++) {
        glDeleteFramebuffers(1, &s->target[i].frame);
        glDeleteTextures(1, &s->target[i].texture);
    }
    if (s->has_peer) {
        glDeleteTextures(1, &s->source);
        glDeleteVertexArrays(1, &s->array);
    }
    for (int i = 0; i < 6; i++)
        amb_chain_close(&s->chain[i]);
    amb_frame_close(&s->frame);
    amb_image_close(&s->picture);
    free(s);
}

amb_status post_prepare(void *state, amb_error *error)
{
    (void)error;
    const post_state *s = state;
    const amb_image *to = amb_frame_layer(s->frame, "color");
    memcpy(to->data, s->picture->data, to->stride * (size_t)to->height * 4 * sizeof(float));
    return AMB_OK;
}

amb_status post_run(void *state, const amb_context *context, amb_error *error)
{
    post_state *s = state;
    int i = 0;
    while (i < 5 && s->context[i] && s->context[i] != context)
        i++;
    if (s->context[i] != context) {
        amb_chain_close(&s->chain[i]);
        s->context[i] = context;
        amb_status status = amb_chain_create(context, s->text, &s->chain[i], error);
        if (status)
            return status;
    }
    return amb_chain_apply(s->chain[i], s->frame, 0, 0, error);
}

amb_status post_difference(void *state, double *rmse, amb_error *error)
{
    const post_state *s = state;
    const amb_image *ours = amb_frame_layer(s->frame, "color");
    int width = ours->width, height = ours->height;
    float *rgba = malloc((size_t)width * (size_t)height * 4 * sizeof *rgba);
    amb_image *flipped = NULL;
    amb_status status = rgba ? amb_image_create(width, height, 3, &flipped, error)
                             : amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    if (!status && flipped) {
        glBindFramebuffer(GL_FRAMEBUFFER, s->result->frame);
        glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, rgba);
        for (int c = 0; c < 3; c++) /* the peer's rows count from the top, as ours */
            for (int y = 0; y < height; y++)
                memcpy(amb_image_row(flipped, c, height - 1 - y), amb_image_row(ours, c, y),
                       (size_t)width * sizeof(float));
        *rmse = bench_rmse(flipped, rgba);
        status = gl_check(error);
    }
    amb_image_close(&flipped);
    free(rgba);
    return status;
}
