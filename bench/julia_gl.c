/* julia in GLSL: scenes/julia.h, scenes/julia_wide.c and ambiance/march.h, line for line. */
#include "bench/julia.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const triangle =
    "void main() {\n"
    "    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 4.0 - 1.0;\n"
    "    gl_Position = vec4(corner, 0.0, 1.0);\n"
    "}\n";

#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)

/* The set, its distance, and the camera's rays. */
#define COMMON                                                                                                   \
    "#define ESCAPE " TEXT(JULIA_ESCAPE) "\n#define TILE " TEXT(                                                 \
        JULIA_TILE) "\n"                                                                                         \
                    "uniform vec4 c; uniform vec3 axis; uniform float along, ball; uniform int iterations;\n"    \
                    "uniform vec3 eye, ray_origin, ray_dx, ray_dy;\n"                                            \
                    "const float least = 1e-5;\n"                                                                \
                    "float julia_log(float a) {\n"                                                               \
                    "    float exponent = float((floatBitsToInt(a) >> 23) - 127);\n"                             \
                    "    float f = intBitsToFloat((floatBitsToInt(a) & 0x7fffff) | 0x3f800000) - 1.0;\n"         \
                    "    return (exponent + (f + 0.2786 * f * (1.0 - f))) * (0.5 * 0.693147180559945);\n"        \
                    "}\n"                                                                                        \
                    "float julia_distance(vec3 p) {\n"                                                           \
                    "    float x = p.x, y = p.y * axis.x + p.z * axis.y;\n"                                      \
                    "    float ww = max((p.y * p.y + p.z * p.z) - y * y, 0.0);\n"                                \
                    "    float xx = x * x, imaginary = y * y + ww, square = xx + imaginary;\n"                   \
                    "    float slope = 1.0, scale = 1.0;\n"                                                      \
                    "    for (int i = 0; i < iterations && square <= ESCAPE; i += 2) {\n"                        \
                    "        slope *= 16.0 * square;\n"                                                          \
                    "        y = (x + x) * y + along; ww = ww * (4.0 * xx); x = (xx - imaginary) + c.x;\n"       \
                    "        xx = x * x; imaginary = y * y + ww; square = xx + imaginary;\n"                     \
                    "        slope *= square;\n"                                                                 \
                    "        y = (x + x) * y + along; ww = ww * (4.0 * xx); x = (xx - imaginary) + c.x;\n"       \
                    "        xx = x * x; imaginary = y * y + ww; square = xx + imaginary;\n"                     \
                    "        scale *= 0.25;\n"                                                                   \
                    "    }\n"                                                                                    \
                    "    float log_z = julia_log(square), g = log_z * scale, far = 1.0 + g * (1.0 + g * (1.0 / " \
                    "3.0));\n"                                                                                   \
                    "    float d = sqrt(square / slope) * ((0.5 * log_z) / far);\n"                              \
                    "    return square <= ESCAPE ? 0.0 : d;\n"                                                   \
                    "}\n"                                                                                        \
                    "vec3 eye_ray(float x, float y) { return normalize(ray_origin + (ray_dx * x + ray_dy * y)); }\n"

/* One pixel a tile: t before which none of the tile's rays can hit. */
static const char *const cone_fragment = COMMON
    "uniform sampler2D coarse; uniform float tile; uniform bool first;\n"
    "out float start;\n"
    "void main() {\n"
    "    float x = floor(gl_FragCoord.x) * tile, y = floor(gl_FragCoord.y) * tile;\n"
    "    vec3 center = eye_ray(x + 0.5 * tile, y + 0.5 * tile);\n"
    "    float radius = 0.0;\n"
    "    for (int k = 0; k < 4; k++)\n"
    "        radius = max(radius, length(eye_ray(x + float(k & 1) * tile, y + float(k >> 1) * tile) - center));\n"
    "    float t = first ? max(length(eye) - ball, 0.0) : texelFetch(coarse, ivec2(gl_FragCoord.xy) / 4, 0).r;\n"
    "    float t1 = length(eye) + ball, safe = t, shrink = 1.0 / (1.0 + radius);\n"
    "    for (int i = 0; i < 64 && t <= t1; i++) {\n"
    "        float clear = julia_distance(eye + center * t) - t * radius;\n"
    "        if (clear > 0.0) safe = t + clear * shrink;\n"
    "        if (clear <= least) break;\n"
    "        t += clear * shrink;\n"
    "    }\n"
    "    start = safe;\n"
    "}\n";

static const char *const march_fragment = COMMON
    "uniform sampler2D starts; uniform samplerCube environment, irradiance;\n"
    "uniform int steps; uniform vec2 size; uniform float footprint, cone;\n"
    "uniform vec3 to_light, light_color, ambient_color, inner_color, outer_color, specular_color;\n"
    "uniform float ambient, diffuse, specular, shininess, reflection, fresnel_power, occlusion, shadow, background, "
    "blur;\n"
    "out vec4 result;\n"
    "void surface(vec3 p, out vec3 normal, out float trap) {\n"
    "    float x = p.x, y = p.y * axis.x + p.z * axis.y;\n"
    "    vec3 across = vec3(p.y - y * axis.x, p.z - y * axis.y, y * -axis.z);\n"
    "    float w = length(across);\n"
    "    vec3 jx = vec3(1.0, 0.0, 0.0), jy = vec3(0.0, 1.0, 0.0), jw = vec3(0.0, 0.0, 1.0), gradient = vec3(x, y, w);\n"
    "    trap = 1.0;\n"
    "    for (int i = 0; i <= iterations; i++) {\n"
    "        float xx = x * x, yy = y * y, ww = w * w, square = xx + (yy + ww);\n"
    "        gradient = jx * x + jy * y + jw * w;\n"
    "        if (i > 0) trap = min(square, trap);\n"
    "        if (square > ESCAPE || i == iterations) break;\n"
    "        float x2 = x + x, y2 = y + y, w2 = w + w;\n"
    "        vec3 nx = jx * x2 - jy * y2 - jw * w2;\n"
    "        jy = jy * x2 + jx * y2;\n"
    "        jw = jw * x2 + jx * w2;\n"
    "        jx = nx;\n"
    "        y = x2 * y + along;\n"
    "        w = x2 * w;\n"
    "        x = (xx - (yy + ww)) + c.x;\n"
    "    }\n"
    "    float per_w = gradient.z / max(length(across), 1e-20);\n"
    "    vec3 n = vec3(gradient.x, gradient.y * axis.x + per_w * across.x, gradient.y * axis.y + per_w * across.y);\n"
    "    n /= max(max(max(abs(n.x), abs(n.y)), abs(n.z)), 1e-37);\n"
    "    normal = normalize(n);\n"
    "}\n"
    "float light_reaching(vec3 from, float start) {\n"
    "    float t = start, clear = 1.0;\n"
    "    for (int i = 0; i < 16; i++) {\n"
    "        vec3 p = from + to_light * t;\n"
    "        float d = julia_distance(p);\n"
    "        clear = min(d * 16.0 / t, clear);\n"
    "        t += clamp(d * 1.5, start, 0.25);\n"
    "        if (clear <= 0.02 || dot(p, p) >= ball * ball) break;\n"
    "    }\n"
    "    return smoothstep(0.0, 1.0, clear);\n"
    "}\n"
    "float openness(vec3 from, vec3 normal) {\n"
    "    float open = clamp(julia_distance(from + normal * 0.04) * (2.0 / 0.04), 0.0, 1.0) * 0.3;\n"
    "    open += clamp(julia_distance(from + normal * 0.12) * (2.0 / 0.12), 0.0, 1.0) * 0.35;\n"
    "    return open + clamp(julia_distance(from + normal * 0.3) * (2.0 / 0.3), 0.0, 1.0) * 0.35;\n"
    "}\n"
    "bool march(vec3 direction, float t1, inout float t) {\n"
    "    float radius = 0.0, stride = 0.0;\n"
    "    for (int i = 0; i < steps && t <= t1; i++) {\n"
    "        float d = julia_distance(eye + direction * t);\n"
    "        if (stride > radius + abs(d)) {\n"
    "            t += radius - stride;\n"
    "            stride = radius;\n"
    "            continue;\n"
    "        }\n"
    "        if (d <= max(t * cone, least)) return true;\n"
    "        stride = min(d * 1.5, max(d, t1 - t));\n"
    "        t += stride;\n"
    "        radius = d;\n"
    "    }\n"
    "    return false;\n"
    "}\n"
    "void main() {\n"
    "    float wx = gl_FragCoord.x, wy = size.y - gl_FragCoord.y;\n"
    "    vec3 direction = eye_ray(wx, wy);\n"
    "    float start = texelFetch(starts, ivec2(wx, wy) / TILE, 0).r, far = length(eye);\n"
    "    float t = 0.0, half_b = dot(eye, direction), root = half_b * half_b - dot(eye, eye) + ball * ball;\n"
    "    bool hit = false;\n"
    "    if (start <= far + ball && root >= 0.0) {\n"
    "        t = max(far < ball ? 0.0 : -half_b - sqrt(root), start);\n"
    "        hit = march(direction, -half_b + sqrt(root), t);\n"
    "    }\n"
    "    vec3 look = direction, lit_rgb = vec3(0.0);\n"
    "    float mirrored = 0.0;\n"
    "    if (hit) {\n"
    "        vec3 position = eye + direction * t, n;\n"
    "        float trap;\n"
    "        surface(position, n, trap);\n"
    "        vec3 albedo = mix(inner_color, outer_color, smoothstep(0.03, 0.5, trap));\n"
    "        float open = 1.0 - occlusion * (1.0 - openness(position, n));\n"
    "        lit_rgb = albedo * (textureLod(irradiance, n, 0.0).rgb + ambient_color) * (ambient * open);\n"
    "        float lambert = max(dot(n, to_light), 0.0);\n"
    "        look = reflect(direction, n);\n"
    "        if (lambert > 0.0) {\n"
    "            float off = t * (footprint * 4.0);\n"
    "            float lit = 1.0 - shadow * (1.0 - light_reaching(position + n * off, off));\n"
    "            float phong = pow(max(dot(look, to_light), 0.0), shininess);\n"
    "            lit_rgb += albedo * light_color * (diffuse * lambert * lit);\n"
    "            lit_rgb += specular_color * light_color * (specular * phong * lit);\n"
    "        }\n"
    "        mirrored = reflection * (1.0 - pow(clamp(-dot(n, direction), 0.0, 1.0), fresnel_power)) * open;\n"
    "    }\n"
    "    vec3 around = texture(environment, look).rgb;\n"
    "    if (hit)\n"
    "        result = vec4(lit_rgb + around * mirrored, 1.0);\n"
    "    else\n"
    "        result = vec4(textureLod(environment, direction, blur).rgb * background, 1.0);\n"
    "}\n";

/* ---- data
 * ------------------------------------------------------------------------------------------------------------ */

/* Uploads a cube map of ours, read back texel by texel at its centres: the peer's texels are the same numbers. */
static amb_status upload_cube(const amb_texture *texture, GLenum format, GLuint *out, amb_error *error)
{
    amb_texture_info info = amb_texture_describe(texture);
    const amb_sampler exact = {.filter = AMB_NEAREST};
    float *texels = malloc((size_t)info.width * (size_t)info.width * 4 * sizeof *texels);
    if (!texels)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory to copy a cube map to the peer");
    glGenTextures(1, out);
    glBindTexture(GL_TEXTURE_CUBE_MAP, *out);
    for (int level = 0, size = info.width; level<info.levels; level++, size = size> 1 ? size / 2 : 1)
        for (int face = 0; face < 6; face++) {
            float *texel = texels;
            for (int i = 0; i < size * size; i++, texel += 4) {
                float x = ((float)(i % size) + 0.5f) * 2.0f / (float)size - 1.0f,
                      y = ((float)(i / size) + 0.5f) * 2.0f / (float)size - 1.0f;
                const v3x d[6] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
                v4x value = amb_sample_cube_lod(texture, &exact, d[face], (float)level);
                memcpy(texel, (float[4]){value.x, value.y, value.z, value.w}, 16);
            }
            glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face, level, (GLint)format, size, size, 0, GL_RGBA,
                         GL_FLOAT, texels);
        }
    free(texels);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, info.levels - 1);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, info.levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return gl_check(error);
}

/* Every parameter of the scene goes to the uniform of its name. */
static void set_parameters(GLuint program, const julia_twin *twin)
{
    for (size_t i = 0; i < twin->table->count; i++) {
        const amb_param *p = &twin->table->table[i];
        GLint at = glGetUniformLocation(program, p->name);
        float f[3];
        int32_t n;
        if (at < 0)
            continue;
        if (p->type == AMB_PARAM_VEC3 || p->type == AMB_PARAM_COLOR) {
            memcpy(f, (const char *)twin->params + p->offset, sizeof f);
            glUniform3fv(at, 1, f);
        } else if (p->type == AMB_PARAM_FLOAT) {
            memcpy(f, (const char *)twin->params + p->offset, sizeof f[0]);
            glUniform1f(at, f[0]);
        } else {
            memcpy(&n, (const char *)twin->params + p->offset, sizeof n);
            glUniform1i(at, n);
        }
    }
}

static void set_uniforms(GLuint program, const julia_twin *twin)
{
    const julia_set *set = &twin->set;
    const amb_camera *camera = &twin->camera;
    glUseProgram(program);
    set_parameters(program, twin);
    glUniform4f(glGetUniformLocation(program, "c"), set->c.x, set->c.y, set->c.z, set->c.w);
    gl_set3(program, "axis", set->axis);
    gl_set1(program, "along", set->along);
    gl_set1(program, "ball", set->radius);
    gl_set3(program, "eye", camera->position);
    gl_set3(program, "ray_origin", camera->ray_origin);
    gl_set3(program, "ray_dx", camera->ray_dx);
    gl_set3(program, "ray_dy", camera->ray_dy);
    gl_set3(program, "to_light", v3_normalize(julia_parameter3(twin, "light_direction")));
    gl_set1(program, "footprint", v3_length(camera->ray_dy) * 0.5f);
    gl_set1(program, "cone", v3_length(camera->ray_dy) * 0.5f * 2.0f * julia_parameter(twin, "tolerance"));
    glUniform2f(glGetUniformLocation(program, "size"), (float)twin->width, (float)twin->height);
    glUniform1i(glGetUniformLocation(program, "starts"), 0);
    glUniform1i(glGetUniformLocation(program, "environment"), 1);
    glUniform1i(glGetUniformLocation(program, "irradiance"), 2);
}

/* A target of one float a tile of the picture, which the next pass fetches. */
static amb_status make_starts(gl_target *out, int tile, const julia_twin *twin, amb_error *error)
{
    *out = (gl_target){.width = (twin->width + tile - 1) / tile, .height = (twin->height + tile - 1) / tile};
    glGenTextures(1, &out->color);
    glBindTexture(GL_TEXTURE_2D, out->color);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_R32F, out->width, out->height);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glGenFramebuffers(1, &out->frame);
    glBindFramebuffer(GL_FRAMEBUFFER, out->frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out->color, 0);
    return gl_check(error);
}

amb_status julia_peer_open(julia_peer *p, const julia_twin *twin, amb_error *error)
{
    *p = (julia_peer){0};
    amb_status status = gl_target_create(twin->width, twin->height, 1, &p->target, error);
    if (!status)
        status = make_starts(&p->coarse, JULIA_COARSE_TILE, twin, error);
    if (!status)
        status = make_starts(&p->starts, JULIA_TILE, twin, error);
    if (!status)
        status = gl_program(triangle, cone_fragment, &p->cone, error);
    if (!status)
        status = gl_program(triangle, march_fragment, &p->march, error);
    if (!status)
        status = upload_cube(twin->environment, GL_RGBA16F, &p->environment, error);
    if (!status)
        status = upload_cube(twin->irradiance, GL_RGBA32F, &p->irradiance, error);
    if (status)
        return status;
    glGenVertexArrays(1, &p->array);
    set_uniforms(p->cone, twin);
    set_uniforms(p->march, twin);
    return gl_check(error);
}

static void draw(const gl_target *target, GLuint program)
{
    glBindFramebuffer(GL_FRAMEBUFFER, target->frame);
    glViewport(0, 0, target->width, target->height);
    glUseProgram(program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

static void draw_cones(const julia_peer *p, const gl_target *target, int tile, bool first)
{
    glUseProgram(p->cone);
    gl_set1(p->cone, "tile", (float)tile);
    glUniform1i(glGetUniformLocation(p->cone, "first"), first);
    draw(target, p->cone);
}

amb_status julia_peer_run(const julia_peer *p, amb_error *error)
{
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(p->array);
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_CUBE_MAP, p->irradiance);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_CUBE_MAP, p->environment);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, 0);
    draw_cones(p, &p->coarse, JULIA_COARSE_TILE, true);
    glBindTexture(GL_TEXTURE_2D, p->coarse.color);
    draw_cones(p, &p->starts, JULIA_TILE, false);
    glBindTexture(GL_TEXTURE_2D, p->starts.color);
    draw(&p->target, p->march);
    glFinish();
    return gl_check(error);
}

void julia_peer_close(julia_peer *p)
{
    glDeleteProgram(p->cone);
    glDeleteProgram(p->march);
    glDeleteVertexArrays(1, &p->array);
    glDeleteTextures(1, &p->environment);
    glDeleteTextures(1, &p->irradiance);
    glDeleteTextures(1, &p->coarse.color);
    glDeleteTextures(1, &p->starts.color);
    glDeleteFramebuffers(1, &p->coarse.frame);
    glDeleteFramebuffers(1, &p->starts.frame);
    gl_target_close(&p->target);
}
