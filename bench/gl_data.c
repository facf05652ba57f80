/* What a peer's draw needs beside its program: uniforms, textures, meshes. */
#include "bench/gl.h"

void gl_set1(GLuint program, const char *name, float a) { glUniform1f(glGetUniformLocation(program, name), a); }
void gl_set3(GLuint program, const char *name, v3 a)
{
    glUniform3f(glGetUniformLocation(program, name), a.x, a.y, a.z);
}
void gl_set4(GLuint program, const char *name, v4 a)
{
    glUniform4f(glGetUniformLocation(program, name), a.x, a.y, a.z, a.w);
}
void gl_set_matrix(GLuint program, const char *name, m4 a)
{
    float columns[16];
    for (int i = 0; i < 4; i++) {
        v4 r = a.row[i];
        columns[i] = r.x, columns[4 + i] = r.y, columns[8 + i] = r.z, columns[12 + i] = r.w;
    }
    glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, columns);
}

GLuint gl_upload_texture(GLenum kind, GLenum format, GLenum type, int size, const void *chain, size_t texel_bytes)
{
    const char *data = chain;
    GLsizei faces = kind == GL_TEXTURE_CUBE_MAP ? 6 : 1;
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(kind, texture);
    for (GLint level = 0; size > 0; size /= 2, level++)
        for (GLsizei face = 0; face < faces; face++) {
            GLenum target = faces == 6 ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face : GL_TEXTURE_2D;
            glTexImage2D(target, level, (GLint)format, size, size, 0, GL_RGBA, type, data);
            data += (size_t)size * (size_t)size * texel_bytes;
        }
    glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return texture;
}

void gl_mesh_upload(const amb_mesh *mesh, gl_mesh *out)
{
    const size_t n = mesh->vertex_count;
    const struct {
        const void *data;
        GLint components;
    } attribute[4] = {{mesh->position, 3}, {mesh->normal, 3}, {mesh->tangent, 4}, {mesh->uv, 2}};
    out->index_count = (GLsizei)(mesh->triangle_count * 3);
    glGenVertexArrays(1, &out->array);
    glBindVertexArray(out->array);
    glGenBuffers(1, &out->vertices);
    glGenBuffers(1, &out->indices);
    glBindBuffer(GL_ARRAY_BUFFER, out->vertices);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n * 12 * sizeof(float)), NULL, GL_STATIC_DRAW);
    size_t at = 0;
    for (GLuint i = 0; i < 4; i++) {
        if (!attribute[i].data)
            continue;
        size_t bytes = n * (size_t)attribute[i].components * sizeof(float);
        glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)at, (GLsizeiptr)bytes, attribute[i].data);
        glVertexAttribPointer(i, attribute[i].components, GL_FLOAT, GL_FALSE, 0, (const void *)(uintptr_t)at);
        glEnableVertexAttribArray(i);
        at += bytes;
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, out->indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)((size_t)mesh->triangle_count * 3 * sizeof(uint32_t)),
                 mesh->index, GL_STATIC_DRAW);
}

void gl_mesh_close(gl_mesh *mesh)
{
    glDeleteVertexArrays(1, &mesh->array);
    glDeleteBuffers(1, &mesh->vertices);
    glDeleteBuffers(1, &mesh->indices);
    *mesh = (gl_mesh){0};
}
