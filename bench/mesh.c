/* 100k triangles, lit, normal-mapped, mip-mapped (trilinear 2048²), reflecting a cube map: ours and GLSL. */
#include "bench/mesh.h"
#include "bench/bench.h"
#include "core/dispatch.h"

#include <ambiance/half.h>
#include <ambiance/math.h>
#include <ambiance/noise.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

AMB_DECLARE_WIDE(const mesh_shaders *, mesh_shaders_get, (void));

enum { RINGS = 225, SEGMENTS = 224, TEXTURE = 2048, CUBE = 256 };

typedef struct peer_mesh {
    gl_target target;
    GLuint program, array, buffers[2], textures[3];
    GLint world_to_clip, eye;
} peer_mesh;

typedef struct mesh_state {
    mesh_uniforms uniforms;
    amb_mesh *mesh;
    amb_texture *color, *normal, *environment;
    amb_image *picture, *depth;
    amb_pass_stats stats;
    bool has_peer;
    peer_mesh peer;
} mesh_state;

/* ---- data, the same for both ----------------------------------------------------------------------------------------
 */

/* Bytes of a chain of levels of size² texels of `texel` bytes, and the offset of each. */
static size_t chain_bytes(int size, size_t texel, size_t faces)
{
    size_t bytes = 0;
    for (; size > 0; size /= 2)
        bytes += (size_t)size * (size_t)size * texel * faces;
    return bytes;
}
static int levels_of(int size)
{
    int levels = 0;
    for (; size > 0; size /= 2)
        levels++;
    return levels;
}

/* Box-filters RGBA8 level by level behind the first. */
static void shrink_rgba8(uint8_t *chain, int size)
{
    for (; size > 1; size /= 2) {
        uint8_t *next = chain + (size_t)size * (size_t)size * 4;
        for (int y = 0; y < size / 2; y++)
            for (int x = 0; x < size / 2; x++)
                for (int c = 0; c < 4; c++) {
                    const uint8_t *a = chain + ((size_t)(2 * y) * (size_t)size + (size_t)(2 * x)) * 4 + c,
                                  *b = a + (size_t)size * 4;
                    next[((size_t)y * (size_t)(size / 2) + (size_t)x) * 4 + (size_t)c] =
                        (uint8_t)((a[0] + a[4] + b[0] + b[4] + 2) / 4);
                }
        chain = next;
    }
}

static uint8_t unorm8(float a) { return (uint8_t)(f_saturate(a) * 255.0f + 0.5f); }

/* Rust-coloured blotches, and the normals of the same bumps. */
static void paint_surface(uint8_t *color, uint8_t *normal)
{
    for (int y = 0; y < TEXTURE; y++)
        for (int x = 0; x < TEXTURE; x++) {
            v2x p = {(float)x * (24.0f / TEXTURE), (float)y * (24.0f / TEXTURE)};
            noise2x n = fbm2(noise_value2, p, (amb_lattice){.seed = 5}, (amb_fbm){4, 2.0f, 0.5f});
            float t = 0.5f + 0.3f * n.value;
            uint8_t *c = color + ((size_t)y * TEXTURE + (size_t)x) * 4,
                    *m = normal + ((size_t)y * TEXTURE + (size_t)x) * 4;
            c[0] = unorm8(0.25f + 0.6f * t), c[1] = unorm8(0.15f + 0.5f * t * t), c[2] = unorm8(0.1f + 0.3f * t * t),
            c[3] = 255;
            v3 up = v3_normalize((v3){-0.12f * n.slope.x, -0.12f * n.slope.y, 1.0f});
            m[0] = unorm8(up.x * 0.5f + 0.5f), m[1] = unorm8(up.y * 0.5f + 0.5f), m[2] = unorm8(up.z * 0.5f + 0.5f),
            m[3] = 255;
        }
    shrink_rgba8(color, TEXTURE);
    shrink_rgba8(normal, TEXTURE);
}

/* The direction of face (x, y), both -1…1 from left to right and top to bottom. */
static v3 cube_direction(int face, float x, float y)
{
    const v3 d[6] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
    return v3_normalize(d[face]);
}
/* A sky with a soft bright window and noise clouds, halves; every level is painted anew, not filtered. */
static void paint_sky(uint16_t *chain)
{
    for (int size = CUBE; size > 0; size /= 2)
        for (int face = 0; face < 6; face++)
            for (int y = 0; y < size; y++)
                for (int x = 0; x < size; x++, chain += 4) {
                    v3 d = cube_direction(face, ((float)x + 0.5f) * 2.0f / (float)size - 1.0f,
                                          ((float)y + 0.5f) * 2.0f / (float)size - 1.0f);
                    float up = 0.5f + 0.5f * d.y, window = amb_pow(f_max(0.6f * d.x + 0.8f * d.y, 0.0f), 40.0f) * 6.0f;
                    float cloud =
                        0.3f * noise_value3((v3x){d.x * 4.0f, d.y * 4.0f, d.z * 4.0f}, (amb_lattice){.seed = 2}).value;
                    float rgba[4] = {0.3f + 0.3f * up + window + cloud, 0.35f + 0.4f * up + window + cloud,
                                     0.4f + 0.7f * up + window + cloud, 1.0f};
                    for (int c = 0; c < 4; c++)
                        chain[c] = (uint16_t)f_to_half(rgba[c]);
                }
}

/* A boulder: a sphere moved along its normals by noise. */
static amb_status make_boulder(amb_mesh **out, amb_error *error)
{
    amb_status status = amb_mesh_sphere(RINGS, SEGMENTS, out, error);
    if (status)
        return status;
    for (uint32_t i = 0; i < (*out)->vertex_count; i++) {
        v3 p = (*out)->position[i];
        float bump =
            fbm3(noise_gradient3, (v3x){p.x * 2.0f, p.y * 2.0f, p.z * 2.0f}, (amb_lattice){0}, (amb_fbm){4, 2.0f, 0.5f})
                .value;
        (*out)->position[i] = v3_scale(p, 1.0f + 0.2f * bump);
    }
    status = amb_mesh_smooth_normals(*out, true, error);
    return status ? status : amb_mesh_tangents(*out, error);
}

/* ---- the peer
 * -------------------------------------------------------------------------------------------------------- */

static const char *const peer_vertex = "layout(location=0) in vec3 position; layout(location=1) in vec3 normal;\n"
                                       "layout(location=2) in vec4 tangent; layout(location=3) in vec2 uv;\n"
                                       "out vec3 world, up; out vec4 along; out vec2 where;\n"
                                       "uniform mat4 world_to_clip;\n"
                                       "void main() {\n"
                                       "    world = position; up = normal; along = tangent; where = uv;\n"
                                       "    vec4 clip = world_to_clip * vec4(position, 1.0);\n"
                                       "    gl_Position = vec4(clip.xy, 2.0 * clip.z - clip.w, clip.w);\n"
                                       "}\n";
static const char *const peer_fragment =
    "in vec3 world, up; in vec4 along; in vec2 where;\n"
    "uniform sampler2D color, normal_map; uniform samplerCube environment;\n"
    "uniform vec3 eye, to_sun, sun_rgb, ambient_rgb; uniform float specular_exponent, f0;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    vec3 albedo = texture(color, where).rgb, texel = texture(normal_map, where).rgb;\n"
    "    vec3 across = cross(up, along.xyz) * along.w, m = normalize(texel * 2.0 - 1.0);\n"
    "    vec3 n = normalize(along.xyz * m.x + across * m.y + up * m.z);\n"
    "    vec3 to_eye = normalize(eye - world);\n"
    "    float facing = max(dot(n, to_sun), 0.0);\n"
    "    float cosine = max(dot(n, normalize(to_sun + to_eye)), 0.0);\n"
    "    float highlight = dot(n, to_sun) > 0.0 ? pow(cosine, specular_exponent) : 0.0;\n"
    "    float u = 1.0 - clamp(dot(n, to_eye), 0.0, 1.0);\n"
    "    float reflectance = f0 + (1.0 - f0) * (u * u * u * u * u);\n"
    "    vec3 sky = texture(environment, reflect(-to_eye, n)).rgb;\n"
    "    result = vec4(albedo * (ambient_rgb + sun_rgb * facing) + sun_rgb * highlight + sky * reflectance, 1.0);\n"
    "}\n";

static void upload_texture(GLuint texture, GLenum kind, GLenum format, GLenum type, int size, const void *chain,
                           size_t texel)
{
    const char *data = chain;
    GLsizei faces = kind == GL_TEXTURE_CUBE_MAP ? 6 : 1;
    glBindTexture(kind, texture);
    for (GLint level = 0; size > 0; size /= 2, level++)
        for (GLsizei face = 0; face < faces; face++) {
            GLenum target = faces == 6 ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face : GL_TEXTURE_2D;
            glTexImage2D(target, level, (GLint)format, size, size, 0, GL_RGBA, type, data);
            data += (size_t)size * (size_t)size * texel;
        }
    glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

static void upload_mesh(peer_mesh *p, const amb_mesh *mesh)
{
    const size_t n = mesh->vertex_count;
    const struct {
        const void *data;
        GLint components;
    } attribute[4] = {{mesh->position, 3}, {mesh->normal, 3}, {mesh->tangent, 4}, {mesh->uv, 2}};
    glGenVertexArrays(1, &p->array);
    glBindVertexArray(p->array);
    glGenBuffers(2, p->buffers);
    glBindBuffer(GL_ARRAY_BUFFER, p->buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n * 12 * sizeof(float)), NULL, GL_STATIC_DRAW);
    size_t at = 0;
    for (GLuint i = 0; i < 4; i++) {
        size_t bytes = n * (size_t)attribute[i].components * sizeof(float);
        glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)at, (GLsizeiptr)bytes, attribute[i].data);
        glVertexAttribPointer(i, attribute[i].components, GL_FLOAT, GL_FALSE, 0, (const void *)(uintptr_t)at);
        glEnableVertexAttribArray(i);
        at += bytes;
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, p->buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)((size_t)mesh->triangle_count * 3 * sizeof(uint32_t)),
                 mesh->index, GL_STATIC_DRAW);
}

static void set3(GLuint program, const char *name, v3 a)
{
    glUniform3f(glGetUniformLocation(program, name), a.x, a.y, a.z);
}

static amb_status open_peer(mesh_state *s, const void *color, const void *normal, const void *sky, amb_error *error)
{
    peer_mesh *p = &s->peer;
    const mesh_uniforms *u = &s->uniforms;
    amb_status status = gl_target_create(s->picture->width, s->picture->height, &p->target, error);
    if (!status)
        status = gl_program(peer_vertex, peer_fragment, &p->program, error);
    if (status)
        return status;
    upload_mesh(p, s->mesh);
    glGenTextures(3, p->textures);
    upload_texture(p->textures[0], GL_TEXTURE_2D, GL_RGBA8, GL_UNSIGNED_BYTE, TEXTURE, color, 4);
    upload_texture(p->textures[1], GL_TEXTURE_2D, GL_RGBA8, GL_UNSIGNED_BYTE, TEXTURE, normal, 4);
    upload_texture(p->textures[2], GL_TEXTURE_CUBE_MAP, GL_RGBA16F, GL_HALF_FLOAT, CUBE, sky, 8);
    glUseProgram(p->program);
    glUniform1i(glGetUniformLocation(p->program, "color"), 0);
    glUniform1i(glGetUniformLocation(p->program, "normal_map"), 1);
    glUniform1i(glGetUniformLocation(p->program, "environment"), 2);
    float columns[16];
    for (int i = 0; i < 4; i++) {
        v4 r = u->world_to_clip.row[i];
        columns[i] = r.x, columns[4 + i] = r.y, columns[8 + i] = r.z, columns[12 + i] = r.w;
    }
    glUniformMatrix4fv(glGetUniformLocation(p->program, "world_to_clip"), 1, GL_FALSE, columns);
    set3(p->program, "eye", u->eye);
    set3(p->program, "to_sun", u->light.to_sun);
    set3(p->program, "sun_rgb", u->light.sun_rgb);
    set3(p->program, "ambient_rgb", u->light.ambient_rgb);
    glUniform1f(glGetUniformLocation(p->program, "specular_exponent"), u->light.specular_exponent);
    glUniform1f(glGetUniformLocation(p->program, "f0"), u->light.f0);
    s->has_peer = true;
    return gl_check(error);
}

static amb_status mesh_run_peer(void *state, amb_error *error)
{
    const mesh_state *s = state;
    const peer_mesh *p = &s->peer;
    glBindFramebuffer(GL_FRAMEBUFFER, p->target.frame);
    glViewport(0, 0, p->target.width, p->target.height);
    glUseProgram(p->program);
    glBindVertexArray(p->array);
    for (GLuint i = 0; i < 3; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(i == 2 ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D, p->textures[i]);
    }
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glEnable(GL_CULL_FACE);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDrawElements(GL_TRIANGLES, (GLsizei)s->mesh->triangle_count * 3, GL_UNSIGNED_INT, NULL);
    glFinish();
    return gl_check(error);
}

/* ---- ours
 * ------------------------------------------------------------------------------------------------------------ */

static void mesh_close(void *state)
{
    mesh_state *s = state;
    if (!s)
        return;
    if (s->has_peer) {
        glDeleteProgram(s->peer.program);
        glDeleteVertexArrays(1, &s->peer.array);
        glDeleteBuffers(2, s->peer.buffers);
        glDeleteTextures(3, s->peer.textures);
        gl_target_close(&s->peer.target);
    }
    amb_mesh_close(&s->mesh);
    amb_texture_close(&s->color);
    amb_texture_close(&s->normal);
    amb_texture_close(&s->environment);
    amb_image_close(&s->picture);
    amb_image_close(&s->depth);
    free(s);
}

static amb_status make_textures(mesh_state *s, const uint8_t *color, const uint8_t *normal, const uint16_t *sky,
                                amb_error *error)
{
    amb_texture_desc surface = {.kind = AMB_TEXTURE_2D,
                                .texel = AMB_TEXEL_RGBA8,
                                .width = TEXTURE,
                                .height = TEXTURE,
                                .levels = levels_of(TEXTURE),
                                .data = color,
                                .data_bytes = chain_bytes(TEXTURE, 4, 1)};
    amb_status status = amb_texture_create(&surface, &s->color, error);
    surface.data = normal;
    if (!status)
        status = amb_texture_create(&surface, &s->normal, error);
    amb_texture_desc cube = {.kind = AMB_TEXTURE_CUBE,
                             .texel = AMB_TEXEL_RGBA16F,
                             .width = CUBE,
                             .height = CUBE,
                             .levels = levels_of(CUBE),
                             .data = sky,
                             .data_bytes = chain_bytes(CUBE, 8, 6)};
    return status ? status : amb_texture_create(&cube, &s->environment, error);
}

static void set_uniforms(mesh_state *s, const bench_options *options)
{
    const v3 eye = {1.2f, 0.9f, 3.4f};
    amb_camera camera =
        amb_camera_look(eye, (v3){0, 0, 0}, (v3){0, 1, 0}, 0.62f, 0.5f, 20.0f, options->width, options->height);
    s->uniforms = (mesh_uniforms){
        .world_to_clip = camera.world_to_clip,
        .eye = eye,
        .light = {v3_normalize((v3){0.6f, 0.8f, 0.5f}), {2.2f, 2.0f, 1.7f}, {0.15f, 0.18f, 0.25f}, 40.0f, 0.04f},
        .mesh = s->mesh,
        .color = s->color,
        .normal = s->normal,
        .environment = s->environment,
        .surface = {.filter = AMB_TRILINEAR},
        .sky = {.filter = AMB_TRILINEAR}};
}

static amb_status mesh_open(const bench_options *options, void **state, amb_error *error)
{
    mesh_state *s = calloc(1, sizeof *s);
    *state = s;
    uint8_t *color = malloc(chain_bytes(TEXTURE, 4, 1)), *normal = malloc(chain_bytes(TEXTURE, 4, 1));
    uint16_t *sky = malloc(chain_bytes(CUBE, 8, 6));
    amb_status status = AMB_OK;
    if (!s || !color || !normal || !sky) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "no memory for the mesh workload");
        goto done;
    }
    paint_surface(color, normal);
    paint_sky(sky);
    status = make_boulder(&s->mesh, error);
    if (!status)
        status = make_textures(s, color, normal, sky, error);
    if (!status)
        status = amb_image_create(options->width, options->height, 4, &s->picture, error);
    if (!status)
        status = amb_image_create(options->width, options->height, 1, &s->depth, error);
    if (status)
        goto done;
    set_uniforms(s, options);
    if (options->peer)
        status = open_peer(s, color, normal, sky, error);
done:
    free(color);
    free(normal);
    free(sky);
    return status;
}

static amb_status mesh_run(void *state, const amb_context *context, amb_error *error)
{
    mesh_state *s = state;
    const mesh_shaders *shaders = AMB_DISPATCH(amb_context_isa(context), mesh_shaders_get)();
    amb_target target = {.color = {s->picture}, .depth = s->depth, .clear_depth = 1.0f};
    amb_draw draw = {.label = "boulder",
                     .lanes = shaders->lanes,
                     .vertex = shaders->vertex,
                     .fragment = shaders->fragment,
                     .uniforms = &s->uniforms,
                     .uniforms_size = sizeof s->uniforms,
                     .varying_floats = shaders->varying_floats,
                     .indices = s->mesh->index,
                     .count = s->mesh->triangle_count * 3,
                     .vertex_count = s->mesh->vertex_count,
                     .cull = AMB_CULL_BACK};
    amb_pass *pass = NULL;
    amb_status status = amb_pass_begin(context, &target, &pass, error);
    if (!status)
        status = amb_pass_draw(pass, &draw, error);
    if (!status)
        return amb_pass_finish(&pass, &s->stats, error);
    amb_pass_close(&pass);
    return status;
}

static amb_status mesh_difference(void *state, double *rmse, amb_error *error)
{
    const mesh_state *s = state;
    float *pixels = malloc((size_t)s->picture->width * (size_t)s->picture->height * 4 * sizeof *pixels);
    if (!pixels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to compare with the peer");
    gl_read(&s->peer.target, pixels);
    *rmse = bench_rmse(s->picture, pixels);
    free(pixels);
    return gl_check(error);
}

/* At least: colour and depth are cleared and written once a pixel. */
static bench_count mesh_count(const void *state, const amb_context *context)
{
    const mesh_state *s = state;
    (void)context;
    double pixels = (double)s->picture->width * s->picture->height;
    return (bench_count){
        .bytes = pixels * 5 * sizeof(float), .items = (double)s->stats.fragments_shaded * 1e-6, .unit = "Mfragments/s"};
}

const bench_workload bench_mesh = {
    .name = "mesh",
    .about = "100k triangles: sun, normal map, two trilinear 2048x2048 textures, cube-map reflection, depth",
    .open = mesh_open,
    .run = mesh_run,
    .run_peer = mesh_run_peer,
    .difference = mesh_difference,
    .count = mesh_count,
    .close = mesh_close,
    .peer_goal = 2.0,
    .threads_goal = 1.9,
};
