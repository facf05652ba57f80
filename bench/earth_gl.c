/* Earth in GLSL: the shaders of scenes/earth_wide.c, planet_wide.h, planet_air_wide.h and shade/, line for line. */
#include "bench/earth.h"
#include "core/texture_layout.h"

#include <GLES2/gl2ext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUND, CLOUDS, BEFORE, DOME, PROGRAMS };
enum { MAPS = 4, UNITS = 6 }; /* of which relief and clouds are looked up twice: with and without anisotropy */

static const char *const vertex_source =
    "layout(location=0) in vec3 position;\n"
    "uniform mat4 world_to_clip; uniform vec3 axis_x, axis_y, axis_z; uniform float shell;\n"
    "out vec3 world;\n"
    "void main() {\n"
    "    world = (axis_x * position.x + axis_y * position.y + axis_z * position.z) * shell;\n"
    "    vec4 clip = world_to_clip * vec4(world, 1.0);\n"
    "    gl_Position = vec4(clip.xy, 2.0 * clip.z - clip.w, clip.w);\n"
    "}\n";

static const char *const air_source =
    "in vec3 world; layout(location = 0, index = 0) out vec4 result;\n"
    "uniform vec3 eye, to_sun, sun_rgb, rayleigh, mie, air_sun_rgb;\n"
    "uniform float top, scale_height, asymmetry, softness, fit[7], fit_end; uniform int samples;\n"
    "const float PI = 3.14159265;\n"
    "float air_depth(float density, float zenith) {\n"
    "    float x = clamp(1.0 - zenith, 0.0, fit_end), p = fit[6];\n"
    "    for (int i = 5; i >= 0; i--) p = p * x + fit[i];\n"
    "    return density * exp(p) * scale_height;\n"
    "}\n"
    "float air_sunlight(float r, float zenith) {\n"
    "    float perigee = r * sqrt(max(1.0 - zenith * zenith, 0.0)), way = max(-zenith * r, 0.0);\n"
    "    float seen = clamp((perigee - 1.0) / (way * softness + 1.0e-6) + 0.5, 0.0, 1.0);\n"
    "    return zenith > 0.0 ? 1.0 : seen;\n"
    "}\n"
    "void air_span(out vec3 direction, out float near, out float far) {\n"
    "    vec3 way = world - eye; float distance = length(way);\n"
    "    direction = way / distance;\n"
    "    float b = dot(eye, direction); vec3 nearest = eye - direction * b;\n"
    "    float d = top * top - dot(nearest, nearest), half_way = sqrt(max(d, 0.0));\n"
    "    near = max(-b - half_way, 0.0);\n"
    "    far = d > 0.0 ? min(distance, -b + half_way) : near;\n"
    "}\n"
    "vec3 air_scatter(out vec3 transmit) {\n"
    "    vec3 direction; float near, far; air_span(direction, near, far);\n"
    "    vec3 scatter = rayleigh + mie, sum = vec3(0.0);\n"
    "    float step_size = max(far - near, 0.0) / float(samples), depth = 0.0;\n"
    "    for (int i = 0; i < samples; i++) {\n"
    "        vec3 at = eye + direction * (near + step_size * (float(i) + 0.5));\n"
    "        float r = length(at), density = exp(min((1.0 - r) / scale_height, 0.0));\n"
    "        float zenith = dot(at, to_sun) / r;\n"
    "        float passed = depth + 0.5 * (density * step_size) + air_depth(density, zenith);\n"
    "        sum += density * step_size * air_sunlight(r, zenith) * exp(-scatter * passed);\n"
    "        depth += density * step_size;\n"
    "    }\n"
    "    transmit = exp(-scatter * depth);\n"
    "    float c = dot(direction, to_sun), g = asymmetry;\n"
    "    float lobe = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c);\n"
    "    float aerosols = 3.0 * (1.0 - g * g) / (2.0 * (2.0 + g * g)) * (1.0 + c * c) / (lobe * sqrt(lobe));\n"
    "    return air_sun_rgb * 0.25 * (rayleigh * 0.75 * (1.0 + c * c) + mie * aerosols) * sum;\n"
    "}\n";

static const char *const point_source =
    "uniform vec3 axis_x, axis_y, axis_z;\n"
    "uniform sampler2D ground_map, relief_map, night_map, cloud_map, plain_relief_map, plain_cloud_map;\n"
    "uniform float wrap, night_gain, gloss, gloss_exponent, bump, parallax, cover, cloud_shell, cloud_ring, "
    "cloud_shadow,\n"
    "    cloud_bump;\n"
    "vec3 normal, to_eye, east, south; vec2 uv, uv_dx, uv_dy;\n"
    "vec3 own(vec3 w) { return vec3(dot(w, axis_x), dot(w, axis_y), dot(w, axis_z)); }\n"
    "vec2 uv_of(vec3 d) {\n"
    "    return vec2(0.5 - atan(d.x, -d.z) * (0.5 / PI), acos(clamp(d.y, -1.0, 1.0)) / PI);\n"
    "}\n"
    "vec2 uv_change(vec3 d, vec3 c, float across) {\n"
    "    return vec2((d.z * c.x - d.x * c.z) / across * (0.5 / PI), -c.y / across / PI);\n"
    "}\n"
    "void at_point() {\n"
    "    vec3 d = normalize(own(world));\n"
    "    normal = axis_x * d.x + axis_y * d.y + axis_z * d.z;\n"
    "    to_eye = normalize(eye - world);\n"
    "    float across = sqrt(max(d.x * d.x + d.z * d.z, 1.0e-12));\n"
    "    east = axis_x * (d.z / across) - axis_z * (d.x / across);\n"
    "    south = normalize(cross(east, normal));\n"
    "    uv = uv_of(d);\n"
    "    uv_dx = uv_change(d, dFdx(d), across);\n"
    "    uv_dy = uv_change(d, dFdy(d), across);\n"
    "}\n"
    "vec3 bumped(vec3 texel, float strength) {\n"
    "    vec3 m = texel * 2.0 - 1.0;\n"
    "    m = normalize(vec3(m.xy * strength, m.z));\n"
    "    return normalize(east * m.x + south * m.y + normal * m.z);\n"
    "}\n"
    "vec3 sunlight_at_ground(float zenith) {\n"
    "    return exp(-(rayleigh + mie) * (0.5 * air_depth(1.0, max(zenith, -0.03))));\n"
    "}\n"
    "float wrapped(float n_dot_l, float w) { return max((n_dot_l + w) / (1.0 + w), 0.0); }\n";

static const char *const main_source[PROGRAMS] = {
    "void main() {\n"
    "    at_point();\n"
    "    float height = textureGrad(plain_relief_map, uv, uv_dx, uv_dy).a;\n"
    "    uv += vec2(dot(to_eye, east), dot(to_eye, south)) * (height * parallax);\n"
    "    float facing = dot(normal, to_sun);\n"
    "    vec3 color = vec3(0.0);\n"
    "    if (facing > -0.12) {\n"
    "        vec4 ground = textureGrad(ground_map, uv, uv_dx, uv_dy);\n"
    "        vec3 n = bumped(textureGrad(relief_map, uv, uv_dx, uv_dy).xyz, bump);\n"
    "        float lit = wrapped(dot(n, to_sun), wrap) * smoothstep(-0.12, 0.05, facing);\n"
    "        vec3 above = world + to_sun * ((cloud_shell - 1.0) / max(facing, 0.12));\n"
    "        float shade = textureGrad(plain_cloud_map, uv_of(normalize(own(above))), uv_dx, uv_dy).a;\n"
    "        vec3 light = sun_rgb * sunlight_at_ground(facing) * (1.0 - shade * cloud_shadow * cover);\n"
    "        float cosine = max(dot(normal, normalize(to_sun + to_eye)), 0.0);\n"
    "        float highlight = facing > 0.0 ? pow(cosine, gloss_exponent) * ground.a * gloss : 0.0;\n"
    "        color = ground.rgb * lit * light + light * highlight;\n"
    "    }\n"
    "    if (facing < 0.0) color += textureGrad(night_map, uv, uv_dx, uv_dy).rgb * (-facing * night_gain);\n"
    "    result = vec4(color, 1.0);\n"
    "}\n",
    "void main() {\n"
    "    at_point();\n"
    "    vec4 map = textureGrad(cloud_map, uv, uv_dx, uv_dy);\n"
    "    vec3 n = bumped(map.xyz, cloud_bump);\n"
    "    float facing = dot(normal, to_sun);\n"
    "    float lit = wrapped(dot(n, to_sun), 0.15) * smoothstep(-0.14, 0.10, facing);\n"
    "    float ring = pow(1.0 - clamp(dot(normal, to_eye), 0.0, 1.0), cloud_ring);\n"
    "    result = vec4(sun_rgb * sunlight_at_ground(facing) * (lit * 0.92), clamp(map.a - ring, 0.0, 1.0) * cover);\n"
    "}\n",
    ("uniform float gain; layout(location = 0, index = 1) out vec4 second;\n"
     "void main() { vec3 t; result = vec4(air_scatter(t) * gain, 0.0); second = vec4(t, 1.0); }\n"),
    "uniform float gain; void main() { vec3 t; result = vec4(air_scatter(t) * gain, 0.0); }\n",
};

/* ---- textures: the same numbers as ours, level by level
 * -------------------------------------------------------------- */

static amb_status upload(const amb_texture *texture, GLuint *out, amb_error *error)
{
    amb_texture_info info = amb_texture_describe(texture);
    v4 *texels = malloc((size_t)info.width * (size_t)info.height * sizeof *texels);
    if (!texels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to give earth's maps to the peer");
    glGenTextures(1, out);
    glBindTexture(GL_TEXTURE_2D, *out);
    for (int level = 0; level < info.levels; level++) {
        int width = level_size(info.width, level), height = level_size(info.height, level);
        for (int y = 0; y < height; y++)
            texels_decode(texture->storage, texel_at(texture, level, 0, y, 0), width,
                          texels + (size_t)y * (size_t)width);
        glTexImage2D(GL_TEXTURE_2D, level, GL_RGBA16F, width, height, 0, GL_RGBA, GL_FLOAT, texels);
    }
    free(texels);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, info.levels - 1);
    return gl_check(error);
}

static GLuint make_sampler(float anisotropy)
{
    GLuint sampler;
    glGenSamplers(1, &sampler);
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glSamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY_EXT, anisotropy);
    return sampler;
}

/* ---- programs ------------------------------------------------------------------------------------------------------
 */

static void set_uniforms(const earth_peer *p, int which)
{
    const earth_twin *t = &p->twin;
    GLuint program = p->program[which];
    const float shell[PROGRAMS] = {1.0f, t->cloud_shell, 1.0f, t->air.top};
    const struct {
        const char *name;
        float value;
    } numbers[] = {{"shell", shell[which]},
                   {"top", t->air.top},
                   {"scale_height", t->air.scale_height},
                   {"asymmetry", t->air.asymmetry},
                   {"softness", t->air.sun_softness},
                   {"fit_end", t->air.fit_end},
                   {"wrap", t->wrap},
                   {"night_gain", t->night_gain},
                   {"gloss", t->gloss},
                   {"gloss_exponent", t->gloss_exponent},
                   {"bump", t->bump},
                   {"parallax", t->parallax},
                   {"cover", t->cover},
                   {"cloud_shell", t->cloud_shell},
                   {"cloud_ring", t->cloud_ring},
                   {"cloud_shadow", t->cloud_shadow},
                   {"cloud_bump", t->cloud_bump},
                   {"gain", which == DOME ? t->dome_gain : t->ground_gain}};
    static const char *const maps[UNITS] = {"ground_map", "relief_map",       "night_map",
                                            "cloud_map",  "plain_relief_map", "plain_cloud_map"};
    glUseProgram(program);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        gl_set1(program, numbers[i].name, numbers[i].value);
    gl_set_matrix(program, "world_to_clip", t->view.world_to_clip);
    gl_set3(program, "axis_x", t->view.axis[0]);
    gl_set3(program, "axis_y", t->view.axis[1]);
    gl_set3(program, "axis_z", t->view.axis[2]);
    gl_set3(program, "eye", t->view.eye);
    gl_set3(program, "to_sun", t->view.to_sun);
    gl_set3(program, "sun_rgb", t->view.sun_rgb);
    gl_set3(program, "rayleigh", t->air.rayleigh);
    gl_set3(program, "mie", t->air.mie);
    gl_set3(program, "air_sun_rgb", t->air.sun_rgb);
    glUniform1i(glGetUniformLocation(program, "samples"), t->air.samples);
    glUniform1fv(glGetUniformLocation(program, "fit"), ATMOSPHERE_FIT, t->air.fit);
    for (int i = 0; i < UNITS; i++)
        glUniform1i(glGetUniformLocation(program, maps[i]), i);
}

amb_status earth_peer_open(const earth_twin *twin, int width, int height, earth_peer *out, amb_error *error)
{
    *out = (earth_peer){.twin = *twin};
    const amb_texture *const maps[MAPS] = {twin->ground, twin->relief, twin->night, twin->clouds};
    amb_status status = AMB_OK;
    out->fine = make_sampler(4.0f);
    out->plain = make_sampler(1.0f);
    for (int i = 0; i < MAPS && !status; i++)
        status = upload(maps[i], &out->textures[i], error);
    for (int i = 0; i < PROGRAMS && !status; i++) {
        char source[8192];
        snprintf(source, sizeof source, "%s%s%s", air_source, i < BEFORE ? point_source : "", main_source[i]);
        status = gl_program(vertex_source, source, &out->program[i], error);
        if (!status)
            set_uniforms(out, i);
    }
    gl_mesh_upload(twin->view.sphere, &out->sphere);
    if (!status)
        status = gl_target_create(width, height, 1, &out->target, error);
    return status ? status : gl_check(error);
}

amb_status earth_peer_run(const earth_peer *p, amb_error *error)
{
    glBindFramebuffer(GL_FRAMEBUFFER, p->target.frame);
    glViewport(0, 0, p->target.width, p->target.height);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glDepthMask(GL_TRUE);
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClearDepthf(1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glBindVertexArray(p->sphere.array);
    static const int map_of_unit[UNITS] = {0, 1, 2, 3, 1, 3};
    for (GLuint i = 0; i < UNITS; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(GL_TEXTURE_2D, p->textures[map_of_unit[i]]);
        glBindSampler(i, i >= MAPS || i == 2 ? p->plain : p->fine);
    }
    static const GLenum factors[PROGRAMS][2] = {
        {GL_ONE, GL_ZERO}, {GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA}, {GL_ONE, GL_SRC1_COLOR_EXT}, {GL_ONE, GL_ONE}};
    for (int i = 0; i < PROGRAMS; i++) {
        glUseProgram(p->program[i]);
        i == GROUND ? glDisable(GL_BLEND) : glEnable(GL_BLEND);
        glBlendFunc(factors[i][0], factors[i][1]);
        glDepthMask(i == GROUND);
        glDepthFunc(i == BEFORE ? GL_ALWAYS : GL_LESS);
        glCullFace(i == DOME ? GL_FRONT : GL_BACK);
        glDrawElements(GL_TRIANGLES, p->sphere.index_count, GL_UNSIGNED_INT, NULL);
    }
    for (GLuint i = 0; i < UNITS; i++)
        glBindSampler(i, 0);
    glCullFace(GL_BACK);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glFinish();
    return gl_check(error);
}

void earth_peer_close(earth_peer *p)
{
    for (int i = 0; i < PROGRAMS; i++)
        glDeleteProgram(p->program[i]);
    glDeleteTextures(MAPS, p->textures);
    glDeleteSamplers(1, &p->fine);
    glDeleteSamplers(1, &p->plain);
    gl_mesh_close(&p->sphere);
    gl_target_close(&p->target);
}
