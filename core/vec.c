#include <ambiance/math.h>
#include <ambiance/vec.h>

m4 m4_identity(void) { return (m4){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}; }

m4 m4_transpose(m4 a)
{
    return (m4){{{a.row[0].x, a.row[1].x, a.row[2].x, a.row[3].x},
                 {a.row[0].y, a.row[1].y, a.row[2].y, a.row[3].y},
                 {a.row[0].z, a.row[1].z, a.row[2].z, a.row[3].z},
                 {a.row[0].w, a.row[1].w, a.row[2].w, a.row[3].w}}};
}

m4 m4_mul(m4 a, m4 b)
{
    m4 columns = m4_transpose(b), product;
    for (int i = 0; i < 4; i++)
        product.row[i] = (v4){v4_dot(a.row[i], columns.row[0]), v4_dot(a.row[i], columns.row[1]),
                              v4_dot(a.row[i], columns.row[2]), v4_dot(a.row[i], columns.row[3])};
    return product;
}

/* Cofactors over the 2×2 minors of the upper and lower row pairs (Laplace expansion). */
m4 m4_inverse(m4 m)
{
    v4 a = m.row[0], b = m.row[1], c = m.row[2], d = m.row[3];
    float s0 = a.x * b.y - b.x * a.y, s1 = a.x * b.z - b.x * a.z, s2 = a.x * b.w - b.x * a.w;
    float s3 = a.y * b.z - b.y * a.z, s4 = a.y * b.w - b.y * a.w, s5 = a.z * b.w - b.z * a.w;
    float c5 = c.z * d.w - d.z * c.w, c4 = c.y * d.w - d.y * c.w, c3 = c.y * d.z - d.y * c.z;
    float c2 = c.x * d.w - d.x * c.w, c1 = c.x * d.z - d.x * c.z, c0 = c.x * d.y - d.x * c.y;
    float determinant = s0 * c5 - s1 * c4 + s2 * c3 + s3 * c2 - s4 * c1 + s5 * c0;
    if (determinant == 0.0f)
        return (m4){{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
    m4 adjugate = {{
        {b.y * c5 - b.z * c4 + b.w * c3, -a.y * c5 + a.z * c4 - a.w * c3, d.y * s5 - d.z * s4 + d.w * s3,
         -c.y * s5 + c.z * s4 - c.w * s3},
        {-b.x * c5 + b.z * c2 - b.w * c1, a.x * c5 - a.z * c2 + a.w * c1, -d.x * s5 + d.z * s2 - d.w * s1,
         c.x * s5 - c.z * s2 + c.w * s1},
        {b.x * c4 - b.y * c2 + b.w * c0, -a.x * c4 + a.y * c2 - a.w * c0, d.x * s4 - d.y * s2 + d.w * s0,
         -c.x * s4 + c.y * s2 - c.w * s0},
        {-b.x * c3 + b.y * c1 - b.z * c0, a.x * c3 - a.y * c1 + a.z * c0, -d.x * s3 + d.y * s1 - d.z * s0,
         c.x * s3 - c.y * s1 + c.z * s0},
    }};
    for (int i = 0; i < 4; i++)
        adjugate.row[i] = v4_scale(adjugate.row[i], 1.0f / determinant);
    return adjugate;
}

m4 m4_translate(v3 t) { return (m4){{{1, 0, 0, t.x}, {0, 1, 0, t.y}, {0, 0, 1, t.z}, {0, 0, 0, 1}}}; }
m4 m4_scale(v3 s) { return (m4){{{s.x, 0, 0, 0}, {0, s.y, 0, 0}, {0, 0, s.z, 0}, {0, 0, 0, 1}}}; }

/* Rodrigues' rotation formula. */
m4 m4_rotate(v3 u, float radians)
{
    float c = f_cos(radians), s = f_sin(radians), k = 1.0f - c;
    return (m4){{{c + u.x * u.x * k, u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s, 0},
                 {u.y * u.x * k + u.z * s, c + u.y * u.y * k, u.y * u.z * k - u.x * s, 0},
                 {u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k, 0},
                 {0, 0, 0, 1}}};
}

m4 m4_look_at(v3 eye, v3 target, v3 up)
{
    v3 back = v3_normalize(v3_sub(eye, target));
    v3 right = v3_normalize(v3_cross(up, back));
    v3 above = v3_cross(back, right);
    return (m4){{v4_of3(right, -v3_dot(right, eye)),
                 v4_of3(above, -v3_dot(above, eye)),
                 v4_of3(back, -v3_dot(back, eye)),
                 {0, 0, 0, 1}}};
}

m4 m4_perspective(float vertical_fov, float aspect, float near, float far)
{
    float scale = 1.0f / f_tan(0.5f * vertical_fov);
    float range = far / (near - far);
    return (m4){{{scale / aspect, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, range, range * near}, {0, 0, -1, 0}}};
}

m4 m4_orthographic(float left, float right, float bottom, float top, float near, float far)
{
    return (m4){{{2.0f / (right - left), 0, 0, (left + right) / (left - right)},
                 {0, 2.0f / (top - bottom), 0, (bottom + top) / (bottom - top)},
                 {0, 0, 1.0f / (near - far), near / (near - far)},
                 {0, 0, 0, 1}}};
}
