/* A boulder, lit, normal-mapped, mip-mapped (trilinear 2048²), reflecting a cube map: ours and GLSL; with 100k and with
 * 1M triangles, and with 4 samples a pixel. */
#include "bench/mesh.h"
#include "bench/boulder.h"
#include "bench/paint.h"
#include "bench/picture.h"
#include "core/dispatch.h"

#include <stdlib.h>

AMB_DECLARE_WIDE(const mesh_shaders *, mesh_shaders_get, (void));

enum { TEXTURE = 2048, CUBE = 256 };

typedef struct peer_mesh {
    GLuint program, textures[3];
    gl_mesh mesh;
} peer_mesh;

typedef struct mesh_state {
    mesh_uniforms uniforms;
    amb_mesh *mesh;
    amb_texture *color, *normal, *environment;
    picture picture;
    peer_mesh peer;
} mesh_state;

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

static void open_peer_textures(peer_mesh *p, const paint_chain chain[3])
{
    p->textures[0] =
        gl_upload_texture(GL_TEXTURE_2D, GL_RGBA8, GL_UNSIGNED_BYTE, TEXTURE, chain[0].data, chain[0].texel_bytes);
    p->textures[1] =
        gl_upload_texture(GL_TEXTURE_2D, GL_RGBA8, GL_UNSIGNED_BYTE, TEXTURE, chain[1].data, chain[1].texel_bytes);
    p->textures[2] =
        gl_upload_texture(GL_TEXTURE_CUBE_MAP, GL_RGBA16F, GL_HALF_FLOAT, CUBE, chain[2].data, chain[2].texel_bytes);
}

static amb_status open_peer(mesh_state *s, const paint_chain chain[3], amb_error *error)
{
    peer_mesh *p = &s->peer;
    const mesh_uniforms *u = &s->uniforms;
    amb_status status = gl_program(peer_vertex, peer_fragment, &p->program, error);
    if (status)
        return status;
    gl_mesh_upload(s->mesh, &p->mesh);
    open_peer_textures(p, chain);
    glUseProgram(p->program);
    glUniform1i(glGetUniformLocation(p->program, "color"), 0);
    glUniform1i(glGetUniformLocation(p->program, "normal_map"), 1);
    glUniform1i(glGetUniformLocation(p->program, "environment"), 2);
    gl_set_matrix(p->program, "world_to_clip", u->world_to_clip);
    gl_set3(p->program, "eye", u->eye);
    gl_set3(p->program, "to_sun", u->light.to_sun);
    gl_set3(p->program, "sun_rgb", u->light.sun_rgb);
    gl_set3(p->program, "ambient_rgb", u->light.ambient_rgb);
    gl_set1(p->program, "specular_exponent", u->light.specular_exponent);
    gl_set1(p->program, "f0", u->light.f0);
    return gl_check(error);
}

static amb_status mesh_run_peer(void *state, amb_error *error)
{
    const mesh_state *s = state;
    const peer_mesh *p = &s->peer;
    picture_peer_begin(&s->picture);
    glUseProgram(p->program);
    glBindVertexArray(p->mesh.array);
    for (GLuint i = 0; i < 3; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(i == 2 ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D, p->textures[i]);
    }
    glDrawElements(GL_TRIANGLES, p->mesh.index_count, GL_UNSIGNED_INT, NULL);
    return picture_peer_end(&s->picture, error);
}

/* ---- ours
 * ------------------------------------------------------------------------------------------------------------ */

static void mesh_close(void *state)
{
    mesh_state *s = state;
    if (!s)
        return;
    if (s->picture.has_peer) {
        glDeleteProgram(s->peer.program);
        gl_mesh_close(&s->peer.mesh);
        glDeleteTextures(3, s->peer.textures);
    }
    picture_close(&s->picture);
    amb_mesh_close(&s->mesh);
    amb_texture_close(&s->color);
    amb_texture_close(&s->normal);
    amb_texture_close(&s->environment);
    free(s);
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

static amb_status open_boulder(const bench_options *options, int rings, int segments, int samples, void **state,
                               amb_error *error)
{
    mesh_state *s = *state = calloc(1, sizeof *s);
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for the mesh workload");
    paint_chain chain[3] = {0};
    amb_texture **const texture[3] = {&s->color, &s->normal, &s->environment};
    amb_status status = paint_surface(TEXTURE, &chain[0], &chain[1], error);
    if (!status)
        status = paint_sky(CUBE, &chain[2], error);
    for (int i = 0; i < 3 && !status; i++)
        status = paint_texture(&chain[i], texture[i], error);
    if (!status)
        status = boulder_create(rings, segments, &s->mesh, error);
    if (!status)
        status = picture_open(options, samples, &s->picture, error);
    if (!status) {
        set_uniforms(s, options);
        if (options->peer)
            status = open_peer(s, chain, error);
    }
    for (int i = 0; i < 3; i++)
        paint_close(&chain[i]);
    return status;
}

static amb_status mesh_open(const bench_options *options, void **state, amb_error *error)
{
    return open_boulder(options, 225, 224, 1, state, error);
}
static amb_status million_open(const bench_options *options, void **state, amb_error *error)
{
    return open_boulder(options, 708, 707, 1, state, error);
}
static amb_status samples_open(const bench_options *options, void **state, amb_error *error)
{
    return open_boulder(options, 225, 224, 4, state, error);
}

static amb_draw boulder_draw(const mesh_state *s, const amb_context *context)
{
    const mesh_shaders *shaders = AMB_DISPATCH(amb_context_isa(context), mesh_shaders_get)();
    return (amb_draw){.label = "boulder",
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
}

static amb_status mesh_run(void *state, const amb_context *context, amb_error *error)
{
    mesh_state *s = state;
    amb_draw draw = boulder_draw(s, context);
    return picture_pass(&s->picture, context, &draw, 1, error);
}

static amb_status mesh_facts(void *state, const amb_context *context, bench_facts *facts, amb_error *error)
{
    mesh_state *s = state;
    amb_draw draw = boulder_draw(s, context);
    return picture_facts(&s->picture, context, &draw, 1, facts, error);
}

static amb_status mesh_difference(void *state, double *rmse, amb_error *error)
{
    return picture_difference(&((mesh_state *)state)->picture, rmse, error);
}

/* Arithmetic of a fragment, as the two shaders are written: a trilinear RGBA look-up blends 2 levels of 4 texels in 4
 * channels (7 blends of 3 operations) and needs some 30 for coordinates and level; a cube look-up some 45. The lighting
 * is 170 with two normalisations of 10, a power of 30 and 12 interpolated varyings of 4. Bytes: the pictures, once. */
#define FRAGMENT_FLOPS (2 * (7 * 4 * 3 + 30) + (7 * 4 * 3 + 45) + 170 + 12 * 4)

static bench_count mesh_count(const void *state, const amb_context *context)
{
    const mesh_state *s = state;
    (void)context;
    double fragments = (double)s->picture.stats.fragments_shaded;
    return (bench_count){.flops = fragments * FRAGMENT_FLOPS,
                         .bytes = picture_bytes(&s->picture),
                         .items = fragments * 1e-6,
                         .unit = "Mfragments/s"};
}

#define MESH_WORKLOAD                                                                               \
    .run = mesh_run, .run_peer = mesh_run_peer, .difference = mesh_difference, .count = mesh_count, \
    .facts = mesh_facts, .close = mesh_close, .peer_goal = 3.0, .threads_goal = 1.9

const bench_workload bench_mesh = {
    .name = "mesh",
    .about = "100k triangles: sun, normal map, two trilinear 2048x2048 textures, cube-map reflection, depth",
    .open = mesh_open,
    MESH_WORKLOAD,
};
const bench_workload bench_mesh_million = {
    .name = "million",
    .about = "the same with 1M triangles, one or two pixels each",
    .open = million_open,
    MESH_WORKLOAD,
};
const bench_workload bench_mesh_samples = {
    .name = "samples",
    .about = "the 100k triangles with 4 samples a pixel",
    .open = samples_open,
    MESH_WORKLOAD,
};
