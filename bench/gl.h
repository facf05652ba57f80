/* The peer: OpenGL ES 3 on Mesa's llvmpipe, without a window (EGL surfaceless). */
#ifndef AMB_BENCH_GL_H
#define AMB_BENCH_GL_H

#include <GLES3/gl32.h>
#include <ambiance/mesh.h>

typedef struct gl gl;

/* threads: of llvmpipe's rasterizer; the environment keeps a different LP_NUM_THREADS. Errors: NOT_FOUND when there is
 * no such driver. Only one at a time; only on the thread that opened it. */
amb_status gl_open(int threads, gl **out, amb_error *error);
void gl_close(gl **context); /* frees and nulls */
const char *gl_renderer(const gl *context);

/* Compiles and links; the sources lack their #version line. Errors: FORMAT with the compiler's words. */
amb_status gl_program(const char *vertex, const char *fragment, GLuint *out, amb_error *error);
/* The same of any stages, four at most. */
typedef struct gl_stage {
    GLenum kind;
    const char *source;
} gl_stage;
amb_status gl_program_of(const gl_stage *stage, int stages, GLuint *out, amb_error *error);
/* A target of RGBA halves with a float depth buffer, bound. */
typedef struct gl_target {
    GLuint frame, color, depth; /* renderbuffers; of a depth-only target a texture */
    int width, height;
} gl_target;
/* samples: 1, or more for a multisampled target, which is read after gl_resolve. */
amb_status gl_target_create(int width, int height, int samples, gl_target *out, amb_error *error);
/* No colour; its depth is a texture that a shader can read. */
amb_status gl_depth_target_create(int width, int height, gl_target *out, amb_error *error);
void gl_target_close(gl_target *target);
/* Averages the samples' colours into a target of one sample and the same size. */
void gl_resolve(const gl_target *multisampled, const gl_target *to);
/* Pixels of the target, rows from the bottom, RGBA. */
void gl_read(const gl_target *target, float *rgba);

/* Uniforms of the program in use. */
void gl_set1(GLuint program, const char *name, float a);
void gl_set3(GLuint program, const char *name, v3 a);
void gl_set4(GLuint program, const char *name, v4 a);
void gl_set_matrix(GLuint program, const char *name, m4 a);

/* A chain of levels of square RGBA texels, packed as amb_texture_desc wants them; trilinear filter, repeating.
 * kind: GL_TEXTURE_2D, or GL_TEXTURE_CUBE_MAP with six faces a level. */
GLuint gl_upload_texture(GLenum kind, GLenum format, GLenum type, int size, const void *chain, size_t texel_bytes);

/* A mesh in buffers: attributes 0 position, 1 normal, 2 tangent, 3 uv, those that it has. */
typedef struct gl_mesh {
    GLuint array, vertices, indices;
    GLsizei index_count;
} gl_mesh;
void gl_mesh_upload(const amb_mesh *mesh, gl_mesh *out);
void gl_mesh_close(gl_mesh *mesh);

/* GL's own complaint since the last call, or OK. */
amb_status gl_check(amb_error *error);

#endif
