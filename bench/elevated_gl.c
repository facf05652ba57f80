/* The elevated workload in GLSL. */
#include "bench/elevated.h"
#include "bench/gl.h"

#include <stdio.h>

/* Noise out of an RGBA8I texture: a cell's four corners are one texel, as in ours. */
#define NOISE                                                                                                        \
    "uniform highp isampler2D noise; uniform vec4 turn[12], origin[12]; uniform float erosion;\n"                    \
    "struct surface { float value; vec2 slope; vec3 curve; };\n"                                                     \
    "surface noise_at(vec2 p, ivec2 cell) {\n"                                                                       \
    "    vec2 base = floor(p), t = p - base, u = t * (t - 1.0);\n"                                                   \
    "    vec2 q = t * t * t * (t * (t * 6.0 - 15.0) + 10.0), dq = 30.0 * u * u, ddq = 60.0 * u * (2.0 * t - 1.0);\n" \
    "    vec4 k = vec4(texelFetch(noise, (ivec2(base) + cell) & 255, 0)) * (1.0 / 128.0);\n"                         \
    "    vec2 along = k.yz - k.xx; float both = k.x - k.y + k.w - k.z;\n"                                            \
    "    vec2 rise = along + both * q.yx;\n"                                                                         \
    "    return surface(k.x + along.x * q.x + rise.y * q.y + 1.0 / 256.0, dq * rise,\n"                              \
    "                   vec3(ddq.x * rise.x, dq.x * dq.y * both, ddq.y * rise.y));\n"                                \
    "}\n"                                                                                                            \
    "surface octave_at(int i, vec2 p) {\n"                                                                           \
    "    vec4 o = turn[i];\n"                                                                                        \
    "    return noise_at(vec2(p.x * o.x - p.y * o.y, p.x * o.y + p.y * o.x) * o.z + origin[i].xy,\n"                 \
    "                    ivec2(origin[i].zw));\n"                                                                    \
    "}\n"                                                                                                            \
    "vec3 terrain(vec2 p, int octaves) {\n"                                                                          \
    "    float z = 0.0, amplitude = 1.0; vec2 slope = vec2(0.0), h = vec2(0.0); vec3 j = vec3(0.0);\n"               \
    "    for (int i = 0; i < octaves; i++) {\n"                                                                      \
    "        vec4 o = turn[i]; surface f = octave_at(i, p);\n"                                                       \
    "        vec2 g = vec2(f.slope.x * o.x + f.slope.y * o.y, f.slope.y * o.x - f.slope.x * o.y);\n"                 \
    "        float cc = o.x * o.x, ss = o.y * o.y, cs = o.x * o.y, twist = 2.0 * f.curve.y * cs;\n"                  \
    "        h += g;\n"                                                                                              \
    "        j += o.z * vec3(f.curve.x * cc + f.curve.z * ss + twist,\n"                                             \
    "                        (f.curve.z - f.curve.x) * cs + f.curve.y * (cc - ss),\n"                                \
    "                        f.curve.x * ss + f.curve.z * cc - twist);\n"                                            \
    "        float inverse = 1.0 / (1.0 + erosion * dot(h, h)), term = amplitude * f.value * inverse;\n"             \
    "        z += term;\n"                                                                                           \
    "        slope += inverse * g - (term * inverse * 2.0 * erosion) * vec2(dot(j.xy, h), dot(j.yz, h));\n"          \
    "        amplitude *= 0.5;\n"                                                                                    \
    "    }\n"                                                                                                        \
    "    return vec3(z, slope);\n"                                                                                   \
    "}\n"

#define SKY                                                                                                         \
    "uniform float perez[15]; uniform vec3 zenith_scale, glow_sun;\n"                                               \
    "float perez_at(int i, float thin, float gamma, float cosine) {\n"                                              \
    "    return (1.0 + perez[5 * i] * thin) *\n"                                                                    \
    "           (1.0 + perez[5 * i + 2] * exp(perez[5 * i + 3] * gamma) + perez[5 * i + 4] * cosine * cosine);\n"   \
    "}\n"                                                                                                           \
    "vec3 sky_at(vec3 direction, bool horizon) {\n"                                                                 \
    "    vec3 up = normalize(vec3(direction.x, horizon ? 0.0 : max(direction.y, 0.0), direction.z));\n"             \
    "    float cosine = clamp(dot(up, glow_sun), -1.0, 1.0), gamma = acos(cosine);\n"                               \
    "    float inverse = 1.0 / max(up.y, 1.0e-3);\n"                                                                \
    "    vec3 thin = horizon ? vec3(0.0) : exp(vec3(perez[1], perez[6], perez[11]) * inverse);\n"                   \
    "    vec3 c = zenith_scale * vec3(perez_at(0, thin.x, gamma, cosine), perez_at(1, thin.y, gamma, cosine),\n"    \
    "                                 perez_at(2, thin.z, gamma, cosine));\n"                                       \
    "    float s = c.x / c.z; vec3 xyz = vec3(c.y * s, c.x, (1.0 - c.y - c.z) * s);\n"                              \
    "    vec3 rgb = vec3(dot(vec3(3.2409699, -1.5373832, -0.4986108), xyz),\n"                                      \
    "                    dot(vec3(-0.9692436, 1.8759675, 0.0415551), xyz),\n"                                       \
    "                    dot(vec3(0.0556301, -0.2039770, 1.0569715), xyz));\n"                                      \
    "    float grey = max(dot(rgb, vec3(0.2126, 0.7152, 0.0722)), 0.0), least = min(min(rgb.x, rgb.y), min(rgb.z, " \
    "0.0));\n"                                                                                                      \
    "    return max(grey + (rgb - grey) * (least < 0.0 ? grey / max(grey - least, 1.0e-30) : 1.0), 0.0);\n"         \
    "}\n"

#define NUMBER_(n) #n
#define NUMBER(n) NUMBER_(n)

const char *const elevated_gl_ground_vertex =
    NOISE "uniform mat4 world_to_clip; uniform float size, scale;\n"
          "out vec3 world;\n"
          "void main() {\n"
          "    int row = gl_VertexID / 513, column = gl_VertexID - row * 513;\n"
          "    vec2 p = vec2(float(column) / 512.0 - 0.5, float(row) / 512.0 - 1.0) * size;\n"
          "    world = vec3(p.x, terrain(p, 8).x * scale, p.y);\n"
          "    vec4 clip = world_to_clip * vec4(world, 1.0);\n"
          "    gl_Position = vec4(clip.xy, 2.0 * clip.z - clip.w, clip.w);\n"
          "}\n";

const char *const elevated_gl_ground_fragment = NOISE SKY
    "in vec3 world;\n"
    "uniform vec3 eye, to_sun, sun_rgb, ambient_rgb, snow_rgb, land_rgb; uniform vec4 edges; uniform float edge_e;\n"
    "uniform float scale, gain, fog_density, fog_falloff, occlusion_power, occlusion_floor;\n"
    "out vec4 result;\n"
    "vec3 normal_of(vec2 slope) { return normalize(vec3(-slope.x * scale, 1.0, -slope.y * scale)); }\n"
    "void main() {\n"
    "    vec2 p = world.xz;\n"
    "    vec3 normal = normal_of(terrain(p, 12).yz), coarse = normal_of(terrain(p, 5).yz);\n"
    "    float shadow = smoothstep(-0.02, 0.18, dot(coarse, to_sun));\n"
    "    float occlusion = pow(max(normal.y, 0.0), occlusion_power) + occlusion_floor;\n"
    "    float noise_sum = octave_at(0, p * 6.0).value + 0.5 * octave_at(1, p * 6.0).value +\n"
    "                      0.25 * octave_at(2, p * 6.0).value + 0.125 * octave_at(3, p * 6.0).value;\n"
    "    float low = edges.x - edges.y * normal.y, high = max(edges.z - edges.w * normal.y, low + 1.0e-6);\n"
    "    float snow = smoothstep(low, high, noise_sum * edge_e);\n"
    "    vec3 light = sun_rgb * (max(dot(normal, to_sun), 0.0) * shadow) + ambient_rgb * occlusion;\n"
    "    vec3 albedo = mix(land_rgb, snow_rgb, snow), way = world - eye;\n"
    "    float far = length(way); vec3 direction = way / far;\n"
    "    float u = fog_falloff * direction.y * far;\n"
    "    float mean = abs(u) < 0.25 ? 1.0 + u * (-1.0 / 2.0 + u * (1.0 / 6.0 + u * (-1.0 / 24.0 + u * (1.0 / 120.0 +\n"
    "                 u * (-1.0 / 720.0 + u * (1.0 / 5040.0)))))) : (1.0 - exp(-u)) / u;\n"
    "    float left = exp(-fog_density * exp(-fog_falloff * eye.y) * far * mean);\n"
    "    result = vec4(mix(sky_at(direction, true), albedo * light, left) * gain, 1.0);\n"
    "}\n";

/* One triangle over the screen, at the far plane. */
const char *const elevated_gl_sky_vertex =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0); }\n";
const char *const elevated_gl_sky_fragment =
    SKY "uniform vec3 ray_origin, ray_dx, ray_dy; uniform float gain, height;\n"
        "out vec4 result;\n"
        "void main() {\n"
        "    vec3 ray = ray_origin + ray_dx * gl_FragCoord.x + ray_dy * (height - gl_FragCoord.y);\n"
        "    result = vec4(sky_at(normalize(ray), false) * gain, 1.0);\n"
        "}\n";

void elevated_gl_uniforms(unsigned program, const elevated_bench *b)
{
    float turn[ELEVATED_SHADING][4], origin[ELEVATED_SHADING][4];
    for (int i = 0; i < ELEVATED_SHADING; i++) {
        const amb_terrain_octave *o = &b->terrain.octave[i];
        turn[i][0] = o->c, turn[i][1] = o->s, turn[i][2] = o->frequency, turn[i][3] = 0.0f;
        origin[i][0] = o->offset.x, origin[i][1] = o->offset.y;
        origin[i][2] = (float)(o->x & 255u);
        origin[i][3] = (float)(o->y & 255u);
    }
    glUseProgram(program);
    glUniform4fv(glGetUniformLocation(program, "turn"), ELEVATED_SHADING, &turn[0][0]);
    glUniform4fv(glGetUniformLocation(program, "origin"), ELEVATED_SHADING, &origin[0][0]);
    glUniform1fv(glGetUniformLocation(program, "perez"), 15, &b->sky.perez[0][0]);
    gl_set_matrix(program, "world_to_clip", b->world_to_clip);
    gl_set4(program, "edges", (v4){b->snow.a, b->snow.b, b->snow.c, b->snow.d});
    const struct {
        const char *name;
        v3 value;
    } vectors[] = {{"zenith_scale", b->sky.scale}, {"glow_sun", b->sky.glow_sun}, {"eye", b->eye},
                   {"to_sun", b->sky.to_sun},      {"sun_rgb", b->sky.sun_rgb},   {"ambient_rgb", b->sky.ambient_rgb},
                   {"snow_rgb", b->snow_rgb},      {"land_rgb", b->land_rgb},     {"ray_origin", b->ray_origin},
                   {"ray_dx", b->ray_dx},          {"ray_dy", b->ray_dy}};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        gl_set3(program, vectors[i].name, vectors[i].value);
    const struct {
        const char *name;
        float value;
    } numbers[] = {{"erosion", b->terrain.erosion},
                   {"size", b->size},
                   {"scale", b->scale},
                   {"gain", b->gain},
                   {"fog_density", b->fog_density},
                   {"fog_falloff", b->fog_falloff},
                   {"edge_e", b->snow.e},
                   {"occlusion_power", b->occlusion_power},
                   {"occlusion_floor", b->occlusion_floor}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        gl_set1(program, numbers[i].name, numbers[i].value);
}
