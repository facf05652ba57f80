#include "tests/texture_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- texel formats ---------------------------------------------------------------------------------------------- */

double ref_small(unsigned bits, int mantissa)
{
    unsigned exponent = bits >> mantissa, fraction = bits & ((1u << mantissa) - 1u);
    if (exponent == 31)
        return fraction ? (double)NAN : (double)INFINITY;
    if (exponent == 0)
        return ldexp(fraction, -14 - mantissa);
    return ldexp(1.0 + ldexp(fraction, -mantissa), (int)exponent - 15);
}

double ref_half(unsigned bits)
{
    double magnitude = ref_small(bits & 0x7fffu, 10);
    return bits & 0x8000u ? -magnitude : magnitude;
}

static double srgb(unsigned code)
{
    double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

int ref_texel_bytes(amb_texel texel)
{
    static const int bytes[] = {1, 2, 4, 4, 2, 8, 4, 16, 4, 4, 8};
    return bytes[texel];
}

static double float_of(const unsigned char *b)
{
    float f;
    memcpy(&f, b, 4);
    return (double)f;
}
static unsigned pair_of(const unsigned char *b) { return b[0] + 256u * b[1]; }

ref_color ref_decode(amb_texel texel, const unsigned char *b)
{
    ref_color r = {{0, 0, 0, 1}};
    unsigned word;
    switch (texel) {
    case AMB_TEXEL_R8:
        r.c[0] = b[0] / 255.0;
        break;
    case AMB_TEXEL_RG8:
        r.c[0] = b[0] / 255.0;
        r.c[1] = b[1] / 255.0;
        break;
    case AMB_TEXEL_RGBA8:
        for (int k = 0; k < 4; k++)
            r.c[k] = b[k] / 255.0;
        break;
    case AMB_TEXEL_SRGB8_A8:
        for (int k = 0; k < 3; k++)
            r.c[k] = srgb(b[k]);
        r.c[3] = b[3] / 255.0;
        break;
    case AMB_TEXEL_R16F:
        r.c[0] = ref_half(pair_of(b));
        break;
    case AMB_TEXEL_RG16F:
        r.c[0] = ref_half(pair_of(b));
        r.c[1] = ref_half(pair_of(b + 2));
        break;
    case AMB_TEXEL_RG32F:
        r.c[0] = float_of(b);
        r.c[1] = float_of(b + 4);
        break;
    case AMB_TEXEL_RGBA16F:
        for (int k = 0; k < 4; k++)
            r.c[k] = ref_half(pair_of(b + 2 * k));
        break;
    case AMB_TEXEL_R32F:
        r.c[0] = float_of(b);
        break;
    case AMB_TEXEL_RGBA32F:
        for (int k = 0; k < 4; k++)
            r.c[k] = float_of(b + 4 * k);
        break;
    case AMB_TEXEL_R11G11B10F:
        word = pair_of(b) + 65536u * pair_of(b + 2);
        r.c[0] = ref_small(word % 2048, 6);
        r.c[1] = ref_small(word / 2048 % 2048, 6);
        r.c[2] = ref_small(word / (2048 * 2048), 5);
        break;
    }
    return r;
}

/* ---- levels ----------------------------------------------------------------------------------------------------- */

static ref_color *ref_at(const ref_texture *t, int level, int x, int y, int z)
{
    return &t->texel[level][((size_t)z * (size_t)t->height[level] + (size_t)y) * (size_t)t->width[level] + (size_t)x];
}

/* How much of source texel j (of n) lies under destination texel i (of m), as a fraction of the destination. */
static double overlap(int i, int m, int j, int n)
{
    double scale = (double)n / m, lo = fmax(i * scale, j), hi = fmin((i + 1) * scale, j + 1);
    return hi > lo ? (hi - lo) / scale : 0.0;
}

static void ref_reduce(ref_texture *t, int level)
{
    int above = level - 1;
    for (int z = 0; z < t->slices[level]; z++)
        for (int y = 0; y < t->height[level]; y++)
            for (int x = 0; x < t->width[level]; x++) {
                ref_color sum = {{0}};
                for (int k = 0; k < t->slices[above]; k++)
                    for (int j = 0; j < t->height[above]; j++)
                        for (int i = 0; i < t->width[above]; i++) {
                            double wz = t->kind == AMB_TEXTURE_CUBE ? k == z
                                                                    : overlap(z, t->slices[level], k, t->slices[above]);
                            double w = wz * overlap(y, t->height[level], j, t->height[above]) *
                                       overlap(x, t->width[level], i, t->width[above]);
                            for (int c = 0; w > 0.0 && c < 4; c++)
                                sum.c[c] += w * ref_at(t, above, i, j, k)->c[c];
                        }
                *ref_at(t, level, x, y, z) = sum;
            }
}

ref_texture *ref_create(const amb_texture_desc *d)
{
    ref_texture *t = calloc(1, sizeof *t);
    const unsigned char *bytes = d->data;
    t->kind = d->kind;
    int given = d->levels ? d->levels : 1;
    for (int l = 0; l < 16; l++) {
        int w = d->width >> l, h = d->height >> l, s = d->kind == AMB_TEXTURE_3D ? d->depth >> l : 0;
        if (l >= given && (!d->make_mips || (w < 1 && h < 1 && s < 1)))
            break;
        t->levels = l + 1;
        t->width[l] = w > 1 ? w : 1;
        t->height[l] = h > 1 ? h : 1;
        t->slices[l] = d->kind == AMB_TEXTURE_CUBE ? 6 : s > 1 ? s : 1;
        size_t count = (size_t)t->width[l] * (size_t)t->height[l] * (size_t)t->slices[l];
        t->texel[l] = calloc(count, sizeof(ref_color));
        if (l >= given) {
            ref_reduce(t, l);
            continue;
        }
        for (size_t i = 0; i < count; i++, bytes += ref_texel_bytes(d->texel))
            t->texel[l][i] = ref_decode(d->texel, bytes);
    }
    return t;
}

void ref_close(ref_texture *t)
{
    for (int l = 0; l < t->levels; l++)
        free(t->texel[l]);
    free(t);
}

/* ---- one level -------------------------------------------------------------------------------------------------- */

static ref_color mix(ref_color a, ref_color b, double t)
{
    for (int k = 0; k < 4; k++)
        a.c[k] = a.c[k] * (1.0 - t) + b.c[k] * t;
    return a;
}

static int wrap_index(int i, int n, amb_wrap wrap)
{
    if (wrap == AMB_CLAMP)
        return i < 0 ? 0 : i >= n ? n - 1 : i;
    if (wrap == AMB_REPEAT)
        return ((i % n) + n) % n;
    int m = ((i % (2 * n)) + 2 * n) % (2 * n);
    return m < n ? m : 2 * n - 1 - m;
}

static int near_integer(double x, double tolerance) { return fabs(x - floor(x + 0.5)) < tolerance; }

static ref_color ref_level(const ref_texture *t, const amb_sampler *s, const double uvw[3], int level, int *ambiguous)
{
    int size[3] = {t->width[level], t->height[level], t->slices[level]}, dimensions = t->kind == AMB_TEXTURE_3D ? 3 : 2;
    int index[3][2] = {{0}};
    double fraction[3] = {0};
    for (int a = 0; a < dimensions; a++) {
        double x = uvw[a] * size[a];
        if (s->filter == AMB_NEAREST) {
            *ambiguous |= near_integer(x, 1e-4);
            index[a][0] = index[a][1] = wrap_index((int)floor(x), size[a], s->wrap[a]);
        } else {
            int i = (int)floor(x - 0.5);
            fraction[a] = x - 0.5 - i;
            index[a][0] = wrap_index(i, size[a], s->wrap[a]);
            index[a][1] = wrap_index(i + 1, size[a], s->wrap[a]);
        }
    }
    ref_color plane[2];
    for (int z = 0; z < 2; z++) {
        ref_color row[2];
        for (int y = 0; y < 2; y++)
            row[y] = mix(*ref_at(t, level, index[0][0], index[1][y], index[2][z]),
                         *ref_at(t, level, index[0][1], index[1][y], index[2][z]), fraction[0]);
        plane[z] = mix(row[0], row[1], fraction[1]);
    }
    return mix(plane[0], plane[1], fraction[2]);
}

/* ---- cube maps -------------------------------------------------------------------------------------------------- */

/* OpenGL 4.6 table 8.19: direction → face, sc, tc, ma. */
static int select_face(const double r[3], double *sc, double *tc, double *ma)
{
    double ax = fabs(r[0]), ay = fabs(r[1]), az = fabs(r[2]);
    if (ax >= ay && ax >= az) {
        *sc = r[0] > 0 ? -r[2] : r[2], *tc = -r[1], *ma = ax;
        return r[0] > 0 ? 0 : 1;
    }
    if (ay >= az) {
        *sc = r[0], *tc = r[1] > 0 ? r[2] : -r[2], *ma = ay;
        return r[1] > 0 ? 2 : 3;
    }
    *sc = r[2] > 0 ? r[0] : -r[0], *tc = -r[1], *ma = az;
    return r[2] > 0 ? 4 : 5;
}

/* The direction of (sc, tc, ma) on a face: the table read backwards. */
static void from_face(int face, double sc, double tc, double ma, double r[3])
{
    switch (face) {
    case 0:
        r[0] = ma, r[1] = -tc, r[2] = -sc;
        break;
    case 1:
        r[0] = -ma, r[1] = -tc, r[2] = sc;
        break;
    case 2:
        r[0] = sc, r[1] = ma, r[2] = tc;
        break;
    case 3:
        r[0] = sc, r[1] = -ma, r[2] = -tc;
        break;
    case 4:
        r[0] = sc, r[1] = -tc, r[2] = ma;
        break;
    default:
        r[0] = -sc, r[1] = -tc, r[2] = -ma;
        break;
    }
}

/* Texel (x, y) of a face; one step over an edge is the texel next to it on the other face. */
static ref_color cube_texel(const ref_texture *t, int level, int face, int x, int y)
{
    int n = t->width[level];
    if (x >= 0 && x < n && y >= 0 && y < n)
        return *ref_at(t, level, x, y, face);
    int out_x = x < 0 || x >= n, out_y = y < 0 || y >= n;
    if (out_x && out_y) { /* three faces meet: the average of their texels */
        int cx = x < 0 ? 0 : n - 1, cy = y < 0 ? 0 : n - 1;
        ref_color a = *ref_at(t, level, cx, cy, face), b = cube_texel(t, level, face, x, cy),
                  c = cube_texel(t, level, face, cx, y);
        for (int k = 0; k < 4; k++)
            a.c[k] = (a.c[k] + b.c[k] + c.c[k]) / 3.0;
        return a;
    }
    /* Fold the texel's centre around the edge: as far down the neighbour as it was beyond this face. */
    double s = (2 * x + 1.0) / n - 1.0, v = (2 * y + 1.0) / n - 1.0, m = 1.0 - 1.0 / n;
    if (out_x)
        s = s < 0 ? -1.0 : 1.0;
    else
        v = v < 0 ? -1.0 : 1.0;
    double r[3], sc, tc, ma;
    from_face(face, s, v, m, r);
    int other = select_face(r, &sc, &tc, &ma);
    return *ref_at(t, level, (int)floor((sc / ma + 1.0) / 2.0 * n), (int)floor((tc / ma + 1.0) / 2.0 * n), other);
}

static ref_color ref_cube_level(const ref_texture *t, const amb_sampler *s, const double direction[3], int level,
                                int *ambiguous)
{
    double sc, tc, ma;
    int n = t->width[level], face = select_face(direction, &sc, &tc, &ma);
    double x = (sc / ma + 1.0) / 2.0 * n, y = (tc / ma + 1.0) / 2.0 * n;
    if (s->filter == AMB_NEAREST) {
        *ambiguous |= near_integer(x, 1e-4) || near_integer(y, 1e-4);
        return cube_texel(t, level, face, x < n ? (int)x : n - 1, y < n ? (int)y : n - 1);
    }
    int i = (int)floor(x - 0.5), j = (int)floor(y - 0.5);
    double fx = x - 0.5 - i, fy = y - 0.5 - j;
    return mix(mix(cube_texel(t, level, face, i, j), cube_texel(t, level, face, i + 1, j), fx),
               mix(cube_texel(t, level, face, i, j + 1), cube_texel(t, level, face, i + 1, j + 1), fx), fy);
}

/* ---- levels of detail ------------------------------------------------------------------------------------------- */

static ref_color ref_tap(const ref_texture *t, const amb_sampler *s, const double at[3], int level, int *ambiguous)
{
    return t->kind == AMB_TEXTURE_CUBE ? ref_cube_level(t, s, at, level, ambiguous)
                                       : ref_level(t, s, at, level, ambiguous);
}

static double clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

/* taps samples along `axis`; lod without bias. */
static ref_sample ref_filter(const ref_texture *t, const amb_sampler *s, const double at[3], const double axis[3],
                             int taps, double lod, double lod_error)
{
    ref_sample out = {{{0}}, 0};
    double last = t->levels - 1, top = s->lod_max > 0.0f ? fmin((double)s->lod_max, last) : last;
    lod = clamp(clamp(lod + (double)s->lod_bias, (double)s->lod_min, top), 0.0, last);
    int near = s->filter == AMB_TRILINEAR ? (int)floor(lod) : (int)floor(lod + 0.5);
    if (s->filter != AMB_TRILINEAR)
        out.ambiguous |= near_integer(lod + 0.5, lod_error);
    double blend = s->filter == AMB_TRILINEAR ? lod - near : 0.0;
    for (int i = 1; i <= taps; i++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = at[a] + axis[a] * (i / (taps + 1.0) - 0.5);
        ref_color c = ref_tap(t, s, p, near, &out.ambiguous);
        if (blend > 0.0)
            c = mix(c, ref_tap(t, s, p, near + 1, &out.ambiguous), blend);
        for (int k = 0; k < 4; k++)
            out.color.c[k] += c.c[k] / taps;
    }
    return out;
}

/* From the lengths, in texels, of the pixel's axes. */
static ref_sample ref_footprint(const ref_texture *t, const amb_sampler *s, const double at[3], const double dx[3],
                                const double dy[3], double length_x, double length_y)
{
    double longer = fmax(length_x, length_y), shorter = fmin(length_x, length_y);
    int taps = 1, ambiguous = 0;
    if (s->max_anisotropy > 1) {
        double ratio = shorter > 0.0 ? longer / shorter : 1e9;
        ambiguous = near_integer(ratio, 1e-4 * ratio) || fabs(length_x / length_y - 1.0) < 1e-4;
        taps = (int)clamp(ceil(fmin(ratio, 1000.0)), 1.0, fmin(s->max_anisotropy, 16.0));
    }
    ref_sample r = ref_filter(t, s, at, length_x >= length_y ? dx : dy, taps, log2(longer / taps), 3e-4);
    r.ambiguous |= ambiguous;
    return r;
}

ref_sample ref_2d_lod(const ref_texture *t, const amb_sampler *s, const double uv[2], double lod)
{
    double at[3] = {uv[0], uv[1], 0}, none[3] = {0};
    return ref_filter(t, s, at, none, 1, lod, 1e-6);
}

ref_sample ref_2d_grad(const ref_texture *t, const amb_sampler *s, const double uv[2], const double dx[2],
                       const double dy[2])
{
    double at[3] = {uv[0], uv[1], 0}, x[3] = {dx[0], dx[1], 0}, y[3] = {dy[0], dy[1], 0};
    return ref_footprint(t, s, at, x, y, hypot(dx[0] * t->width[0], dx[1] * t->height[0]),
                         hypot(dy[0] * t->width[0], dy[1] * t->height[0]));
}

ref_sample ref_3d_lod(const ref_texture *t, const amb_sampler *s, const double uvw[3], double lod)
{
    double none[3] = {0};
    return ref_filter(t, s, uvw, none, 1, lod, 1e-6);
}

ref_sample ref_cube_lod(const ref_texture *t, const amb_sampler *s, const double direction[3], double lod)
{
    double none[3] = {0};
    return ref_filter(t, s, direction, none, 1, lod, 1e-6);
}

/* Length in texels of the derivative of the face coordinates, by a central difference on the face's plane. */
static double cube_length(const ref_texture *t, const double direction[3], const double change[3])
{
    double sc, tc, ma, c_sc, c_tc, c_ma, h = 1e-6;
    int face = select_face(direction, &sc, &tc, &ma);
    /* The change in the face's frame: the frame is linear, so read it off three unit steps. */
    double unit[3][3];
    from_face(face, 1, 0, 0, unit[0]);
    from_face(face, 0, 1, 0, unit[1]);
    from_face(face, 0, 0, 1, unit[2]);
    c_sc = change[0] * unit[0][0] + change[1] * unit[0][1] + change[2] * unit[0][2];
    c_tc = change[0] * unit[1][0] + change[1] * unit[1][1] + change[2] * unit[1][2];
    c_ma = change[0] * unit[2][0] + change[1] * unit[2][1] + change[2] * unit[2][2];
    double s1 = (sc + h * c_sc) / (ma + h * c_ma), s0 = (sc - h * c_sc) / (ma - h * c_ma);
    double t1 = (tc + h * c_tc) / (ma + h * c_ma), t0 = (tc - h * c_tc) / (ma - h * c_ma);
    return hypot((s1 - s0) / (2 * h), (t1 - t0) / (2 * h)) * t->width[0] / 2.0;
}

ref_sample ref_cube_grad(const ref_texture *t, const amb_sampler *s, const double direction[3], const double dx[3],
                         const double dy[3])
{
    return ref_footprint(t, s, direction, dx, dy, cube_length(t, direction, dx), cube_length(t, direction, dy));
}
