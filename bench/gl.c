#include "bench/gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct gl {
    EGLDisplay display;
    EGLContext context;
    char renderer[256];
};

static amb_status no_driver(const char *what, amb_error *error)
{
    return amb_fail(error, AMB_ERROR_NOT_FOUND, "no peer: %s failed (0x%x); install libegl-mesa0 and libgl1-mesa-dri",
                    what, (unsigned)eglGetError());
}

static amb_status start(gl *g, amb_error *error)
{
    g->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (g->display == EGL_NO_DISPLAY || !eglInitialize(g->display, NULL, NULL))
        return no_driver("eglInitialize", error);
    if (!eglBindAPI(EGL_OPENGL_ES_API))
        return no_driver("eglBindAPI", error);
    static const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
    static const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2, EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (!eglChooseConfig(g->display, wanted, &config, 1, &count) || count < 1)
        return no_driver("eglChooseConfig", error);
    g->context = eglCreateContext(g->display, config, EGL_NO_CONTEXT, version);
    if (g->context == EGL_NO_CONTEXT)
        return no_driver("eglCreateContext", error);
    if (!eglMakeCurrent(g->display, EGL_NO_SURFACE, EGL_NO_SURFACE, g->context))
        return no_driver("eglMakeCurrent", error);
    const char *renderer = (const char *)glGetString(GL_RENDERER), *driver = (const char *)glGetString(GL_VERSION);
    snprintf(g->renderer, sizeof g->renderer, "%s, %s", renderer ? renderer : "?", driver ? driver : "?");
    if (!strstr(g->renderer, "llvmpipe"))
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "no peer: the driver is %s, not llvmpipe", g->renderer);
    return AMB_OK;
}

amb_status gl_open(int threads, gl **out, amb_error *error)
{
    *out = NULL;
    char count[16];
    snprintf(count, sizeof count, "%d", threads);
    setenv("LP_NUM_THREADS", count, 0);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    setenv("GALLIUM_DRIVER", "llvmpipe", 1);
    gl *g = calloc(1, sizeof *g);
    if (!g)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the peer's context");
    amb_status status = start(g, error);
    if (status)
        gl_close(&g);
    *out = g;
    return status;
}

void gl_close(gl **context)
{
    gl *g = *context;
    if (!g)
        return;
    if (g->display != EGL_NO_DISPLAY) {
        eglMakeCurrent(g->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (g->context != EGL_NO_CONTEXT)
            eglDestroyContext(g->display, g->context);
        eglTerminate(g->display);
    }
    free(g);
    *context = NULL;
}

const char *gl_renderer(const gl *context) { return context->renderer; }

static amb_status compile(GLenum stage, const char *source, GLuint *out, amb_error *error)
{
    static const char *const head = "#version 320 es\n#extension GL_EXT_blend_func_extended : enable\nprecision highp "
                                    "float; precision highp int; precision highp "
                                    "sampler2D; precision highp samplerCube;\n";
    const char *parts[2] = {head, source};
    GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 2, parts, NULL);
    glCompileShader(shader);
    GLint compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    *out = shader;
    if (compiled)
        return AMB_OK;
    char log[400] = "";
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    return amb_fail(error, AMB_ERROR_FORMAT, "the peer's %s shader: %s",
                    stage == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
}

amb_status gl_program_of(const gl_stage *stage, int stages, GLuint *out, amb_error *error)
{
    GLuint shader[4] = {0};
    amb_status status = AMB_OK;
    *out = 0;
    for (int i = 0; i < stages && !status; i++)
        status = compile(stage[i].kind, stage[i].source, &shader[i], error);
    if (!status) {
        GLuint program = glCreateProgram();
        for (int i = 0; i < stages; i++)
            glAttachShader(program, shader[i]);
        glLinkProgram(program);
        GLint linked = 0;
        glGetProgramiv(program, GL_LINK_STATUS, &linked);
        if (linked) {
            *out = program;
        } else {
            char log[400] = "";
            glGetProgramInfoLog(program, sizeof log, NULL, log);
            glDeleteProgram(program);
            status = amb_fail(error, AMB_ERROR_FORMAT, "the peer's program: %s", log);
        }
    }
    for (int i = 0; i < stages; i++)
        glDeleteShader(shader[i]);
    return status;
}

amb_status gl_program(const char *vertex, const char *fragment, GLuint *out, amb_error *error)
{
    const gl_stage stages[2] = {{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}};
    return gl_program_of(stages, 2, out, error);
}

static amb_status check_frame(const gl_target *t, const char *what, amb_error *error)
{
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "no peer: it cannot render to %s of %dx%d", what, t->width,
                        t->height);
    glViewport(0, 0, t->width, t->height);
    return gl_check(error);
}

static GLuint renderbuffer(GLenum attachment, GLenum format, int samples, const gl_target *t)
{
    GLuint name;
    glGenRenderbuffers(1, &name);
    glBindRenderbuffer(GL_RENDERBUFFER, name);
    if (samples > 1)
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, t->width, t->height);
    else
        glRenderbufferStorage(GL_RENDERBUFFER, format, t->width, t->height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, name);
    return name;
}

amb_status gl_target_create(int width, int height, int samples, gl_target *out, amb_error *error)
{
    *out = (gl_target){.width = width, .height = height};
    glGenFramebuffers(1, &out->frame);
    glBindFramebuffer(GL_FRAMEBUFFER, out->frame);
    out->color = renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA16F, samples, out);
    out->depth = renderbuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F, samples, out);
    return check_frame(out, "half floats", error);
}

amb_status gl_depth_target_create(int width, int height, gl_target *out, amb_error *error)
{
    *out = (gl_target){.width = width, .height = height};
    glGenFramebuffers(1, &out->frame);
    glBindFramebuffer(GL_FRAMEBUFFER, out->frame);
    glGenTextures(1, &out->depth);
    glBindTexture(GL_TEXTURE_2D, out->depth);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, width, height);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, out->depth, 0);
    return check_frame(out, "depth", error);
}

void gl_target_close(gl_target *target)
{
    glDeleteFramebuffers(1, &target->frame);
    if (target->color) {
        glDeleteRenderbuffers(1, &target->color);
        glDeleteRenderbuffers(1, &target->depth);
    } else {
        glDeleteTextures(1, &target->depth);
    }
    *target = (gl_target){0};
}

void gl_resolve(const gl_target *multisampled, const gl_target *to)
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, multisampled->frame);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to->frame);
    glBlitFramebuffer(0, 0, to->width, to->height, 0, 0, to->width, to->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void gl_read(const gl_target *target, float *rgba)
{
    glBindFramebuffer(GL_FRAMEBUFFER, target->frame);
    glReadPixels(0, 0, target->width, target->height, GL_RGBA, GL_FLOAT, rgba);
}

amb_status gl_check(amb_error *error)
{
    GLenum code = glGetError();
    return code == GL_NO_ERROR ? AMB_OK : amb_fail(error, AMB_ERROR_ARGUMENT, "the peer reports GL error 0x%x", code);
}
