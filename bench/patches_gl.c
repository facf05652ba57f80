/* The patches workload in GLSL. */
#include "bench/gl.h"
#include "bench/patches.h"

static const char *const vertex = "out int number;\n"
                                  "void main() { number = gl_VertexID; gl_Position = vec4(0.0); }\n";

static const char *const control =
    "layout(vertices = 1) out;\n"
    "in int number[]; uniform vec3 eye; uniform float size, reach; patch out vec3 place;\n"
    "float segments(vec2 p) { return reach / length(vec3(p.x, 0.0, p.y) - eye); }\n"
    "void main() {\n"
    "    int row = number[0] >> 9, column = number[0] & 511;\n"
    "    float side = size / 512.0, x = float(column) * side - 0.5 * size, z = float(row) * -side;\n"
    "    place = vec3(x, z, side);\n"
    "    vec4 e = vec4(segments(vec2(x, z - 0.5 * side)), segments(vec2(x + 0.5 * side, z)),\n"
    "                  segments(vec2(x + side, z - 0.5 * side)), segments(vec2(x + 0.5 * side, z - side)));\n"
    "    gl_TessLevelOuter[0] = e.x; gl_TessLevelOuter[1] = e.y; gl_TessLevelOuter[2] = e.z; gl_TessLevelOuter[3] = "
    "e.w;\n"
    "    gl_TessLevelInner[0] = 0.5 * (e.y + e.w); gl_TessLevelInner[1] = 0.5 * (e.x + e.z);\n"
    "}\n";

static const char *const evaluation =
    "layout(quads, fractional_even_spacing, ccw) in;\n"
    "uniform mat4 world_to_clip; uniform float height; patch in vec3 place; out vec3 up;\n"
    "void main() {\n"
    "    float x = place.x + gl_TessCoord.x * place.z, z = place.y - gl_TessCoord.y * place.z;\n"
    "    float frequency = 0.37, amplitude = 1.0; vec3 sum = vec3(0.0);\n"
    "    for (int i = 0; i < 4; i++) {\n"
    "        float a = fract(x * frequency + 0.3 * float(i)), b = fract(z * frequency + 0.7 * float(i));\n"
    "        float p = a * (1.0 - a), q = b * (1.0 - b);\n"
    "        sum.x += 256.0 * amplitude * (p * p) * (q * q);\n"
    "        sum.y += 512.0 * amplitude * frequency * p * (1.0 - 2.0 * a) * (q * q);\n"
    "        sum.z += 512.0 * amplitude * frequency * q * (1.0 - 2.0 * b) * (p * p);\n"
    "        frequency *= 2.3; amplitude *= 0.4;\n"
    "    }\n"
    "    up = vec3(-sum.y * height, 1.0, -sum.z * height);\n"
    "    vec4 clip = world_to_clip * vec4(x, sum.x * height, z, 1.0);\n"
    "    gl_Position = vec4(clip.xy, 2.0 * clip.z - clip.w, clip.w);\n"
    "}\n";

static const char *const fragment =
    "in vec3 up; uniform vec3 to_sun; out vec4 result;\n"
    "void main() {\n"
    "    float facing = max(dot(normalize(up), to_sun), 0.0);\n"
    "    result = vec4(0.1 + 0.9 * facing, 0.12 + 0.8 * facing, 0.15 + 0.6 * facing, 1.0);\n"
    "}\n";

amb_status patches_gl_program(const patches_uniforms *u, unsigned *program, amb_error *error)
{
    const gl_stage stages[4] = {{GL_VERTEX_SHADER, vertex},
                                {GL_TESS_CONTROL_SHADER, control},
                                {GL_TESS_EVALUATION_SHADER, evaluation},
                                {GL_FRAGMENT_SHADER, fragment}};
    amb_status status = gl_program_of(stages, 4, program, error);
    if (status)
        return status;
    glUseProgram(*program);
    gl_set_matrix(*program, "world_to_clip", u->world_to_clip);
    gl_set3(*program, "eye", u->eye);
    gl_set3(*program, "to_sun", u->to_sun);
    gl_set1(*program, "size", u->size);
    gl_set1(*program, "height", u->height);
    gl_set1(*program, "reach", u->reach);
    return gl_check(error);
}
