/* The peer: OpenGL ES 3 on Mesa's llvmpipe, without a window (EGL surfaceless). */
#ifndef AMB_BENCH_GL_H
#define AMB_BENCH_GL_H

#include <GLES3/gl32.h>
#include <ambiance/error.h>

typedef struct gl gl;

/* threads: of llvmpipe's rasterizer; the environment keeps a different LP_NUM_THREADS. Errors: NOT_FOUND when there is
 * no such driver. Only one at a time; only on the thread that opened it. */
amb_status gl_open(int threads, gl **out, amb_error *error);
void gl_close(gl **context); /* frees and nulls */
const char *gl_renderer(const gl *context);

/* Compiles and links; the sources lack their #version line. Errors: FORMAT with the compiler's words. */
amb_status gl_program(const char *vertex, const char *fragment, GLuint *out, amb_error *error);
/* A float RGBA target with a float depth buffer, bound and cleared. */
typedef struct gl_target {
    GLuint frame, color, depth;
    int width, height;
} gl_target;
amb_status gl_target_create(int width, int height, gl_target *out, amb_error *error);
void gl_target_close(gl_target *target);
/* Pixels of the bound target, rows from the bottom, RGBA. */
void gl_read(const gl_target *target, float *rgba);
/* GL's own complaint since the last call, or OK. */
amb_status gl_check(amb_error *error);

#endif
