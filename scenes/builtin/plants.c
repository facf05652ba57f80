/* The built-in plants: atlases of trees and grass for billboards, painted leaf by leaf with a depth buffer.
 *
 * Trees: 4 columns of 256×512, two conifers and two broad-leaved trees; their normals (x right, y up, z to the eye,
 * coded) and in alpha how open the leaf is to the sky. Grass: 4 columns of 256×256, green, tall, dry, flowering.
 * Rows from the top; the foot of a plant is in the middle of its column's lowest row. */
#include "scenes/builtin/builtin.h"

#include <ambiance/math.h>
#include <ambiance/random.h>

enum { COLUMNS = 4, COLUMN = 256, TREE_HEIGHT = 512, GRASS_HEIGHT = 256, FINER = 2 };

typedef struct painter {
    amb_image *colour, *normal, *depth; /* FINER times as large; normal's alpha: openness */
    int x0, width, height;              /* the column, in fine pixels */
    uint32_t state;
} painter;

typedef struct leaf {
    v3 at;   /* x -0.5…0.5, y 0…1 upwards (of the height), z towards the eye, in the same unit */
    float r; /* radius */
    v3 rgb, normal;
    float open;
} leaf;

/* One call a statement: C leaves the order of arguments to the compiler. */
static float chance(painter *p)
{
    p->state = p->state * 747796405u + 2891336453u; /* LCG; hashed below */
    return amb_unit(amb_hash(p->state));
}

static void put(const painter *p, const leaf *l)
{
    float unit = (float)p->height, cx = (float)p->x0 + 0.5f * (float)p->width + l->at.x * unit,
          cy = (1.0f - l->at.y) * unit;
    float r = l->r * unit;
    int x_first = (int)(cx - r), x_last = (int)(cx + r) + 1, y_first = (int)(cy - r), y_last = (int)(cy + r) + 1;
    for (int y = y_first < 0 ? 0 : y_first; y <= y_last && y < p->height; y++)
        for (int x = x_first < p->x0 ? p->x0 : x_first; x <= x_last && x < p->x0 + p->width; x++) {
            float dx = ((float)x + 0.5f - cx) / r, dy = ((float)y + 0.5f - cy) / r, d = dx * dx + dy * dy;
            float *depth = amb_image_row(p->depth, 0, y) + x;
            float z = l->at.z + 2.0f + l->r * (1.0f - d) * 0.5f;
            if (d > 1.0f || z <= *depth)
                continue;
            *depth = z;
            v3 n = v3_normalize((v3){l->normal.x + 0.35f * dx, l->normal.y - 0.35f * dy, l->normal.z + 0.2f});
            const float colour[4] = {l->rgb.x, l->rgb.y, l->rgb.z, 1.0f};
            const float normal[4] = {n.x, n.y, n.z, l->open};
            for (int c = 0; c < 4; c++) {
                amb_image_row(p->colour, c, y)[x] = colour[c];
                amb_image_row(p->normal, c, y)[x] = normal[c];
            }
        }
}

static v3 blend(v3 a, v3 b, float t) { return v3_add(a, v3_scale(v3_sub(b, a), t)); }

static v3 around(float angle, float radius, float y)
{
    float s, c;
    f_sincos(angle, &s, &c);
    return (v3){c * radius, y, s * radius};
}

static void trunk(painter *p, float height, float foot, v3 rgb)
{
    for (int i = 0; i < 160; i++) {
        float t = (float)i / 160.0f;
        float width = foot * (1.0f - 0.85f * t);
        for (int side = -2; side <= 2; side++) {
            float x = (float)side * 0.5f * width;
            float shade = 0.7f + 0.5f * chance(p);
            leaf l = {
                {x, t * height, 0.0f}, width * 0.42f, v3_scale(rgb, shade), {(float)side * 0.45f, 0.1f, 0.8f}, 0.6f};
            put(p, &l);
        }
    }
}

/* Whorls of drooping branches on a straight trunk. */
static void conifer(painter *p, float spread, v3 dark, v3 light)
{
    trunk(p, 0.95f, 0.018f, (v3){0.07f, 0.045f, 0.03f});
    for (int whorl = 0; whorl < 46; whorl++) {
        float t = ((float)whorl + 0.6f * chance(p)) / 46.0f, y = 0.07f + 0.92f * t;
        float most = spread * f_pow(1.0f - t, 0.85f) + 0.012f;
        int branches = 9 + (int)(6.0f * (1.0f - t));
        for (int b = 0; b < branches; b++) {
            float angle = 6.2831853f * ((float)b + chance(p)) / (float)branches;
            float length = most * (0.62f + 0.42f * chance(p)), droop = 0.10f + 0.22f * (1.0f - t);
            for (int k = 2; k <= 20; k++) {
                float along = (float)k / 20.0f;
                float turn = 0.1f * (chance(p) - 0.5f), lift = 0.010f * (chance(p) - 0.5f);
                v3 at = around(angle + turn, length * along, y - droop * length * along * along + lift);
                float tip = along * along, bright = 0.35f + 0.65f * chance(p);
                leaf l = {at, 0.0062f - 0.003f * tip, blend(dark, light, bright * (0.25f + 0.75f * tip)),
                          v3_normalize((v3){at.x * 1.3f, 0.16f + 0.5f * tip * spread, at.z * 1.3f}),
                          0.30f + 0.70f * tip};
                put(p, &l);
            }
        }
    }
}

/* A crown of leafy balls on a branching trunk. */
static void broadleaf(painter *p, float spread, v3 dark, v3 light)
{
    enum { BALLS = 34 };
    trunk(p, 0.55f, 0.021f, (v3){0.10f, 0.075f, 0.05f});
    for (int ball = 0; ball < BALLS; ball++) {
        float t = ((float)ball + 0.5f) / BALLS, y = 0.31f + 0.53f * t;
        float bulge = f_sqrt(1.0f - (1.7f * t - 0.75f) * (1.7f * t - 0.75f)) * 1.05f;
        float turn = 2.399963f * (float)ball + chance(p), out_by = 0.30f + 0.70f * f_sqrt(chance(p));
        v3 middle = around(turn, spread * bulge * out_by, y);
        float radius = 0.042f + 0.055f * chance(p);
        for (int k = 0; k < 16; k++) { /* its branch */
            float along = (float)k / 16.0f;
            v3 at = {middle.x * along, 0.30f + (y - 0.30f) * along, middle.z * along};
            leaf l = {at, 0.007f * (1.2f - along), {0.09f, 0.07f, 0.05f}, {at.x, 0.1f, 0.6f}, 0.5f};
            put(p, &l);
        }
        for (int k = 0; k < 1500; k++) {
            float z = 2.0f * chance(p) - 1.0f, ring = f_sqrt(1.0f - z * z);
            v3 n = around(6.2831853f * chance(p), ring, z), out;
            float depth = 0.66f + 0.52f * chance(p) * chance(p);
            v3 at = v3_add(middle, v3_scale(n, radius * depth));
            out = v3_normalize((v3){at.x * 1.6f, (at.y - 0.52f) * 1.6f, at.z * 1.6f});
            float up = 0.5f + 0.5f * n.y,
                  outer = f_saturate((v3_length((v3){at.x, (at.y - 0.55f) * 0.8f, at.z})) / (spread + 0.06f));
            float bright = f_saturate(0.15f + 0.45f * up + 0.40f * chance(p));
            leaf l = {at, 0.0034f + 0.0016f * chance(p), blend(dark, light, bright),
                      v3_normalize(v3_add(v3_scale(out, 0.75f), v3_scale(n, 0.6f))),
                      0.25f + 0.35f * outer + 0.40f * up * outer};
            put(p, &l);
        }
    }
}

static void paint_trees(painter *p)
{
    static const v3 dark[4] = {
        {0.010f, 0.021f, 0.010f}, {0.014f, 0.026f, 0.013f}, {0.022f, 0.040f, 0.010f}, {0.030f, 0.044f, 0.012f}};
    static const v3 light[4] = {
        {0.055f, 0.090f, 0.033f}, {0.070f, 0.105f, 0.045f}, {0.110f, 0.150f, 0.035f}, {0.165f, 0.165f, 0.045f}};
    for (int i = 0; i < COLUMNS; i++) {
        p->x0 = i * p->width;
        p->state = 1000u * (uint32_t)i + 17u;
        if (i < 2)
            conifer(p, i ? 0.20f : 0.165f, dark[i], light[i]);
        else
            broadleaf(p, i == 2 ? 0.185f : 0.165f, dark[i], light[i]);
    }
}

static void blade(painter *p, float x, float height, float lean, float width, v3 foot, v3 tip)
{
    float z = chance(p) * 0.2f;
    for (int k = 0; k < 90; k++) {
        float t = (float)k / 90.0f;
        leaf l = {{x + lean * t * t, height * t * (1.0f - 0.12f * lean * lean * t), z},
                  width * (1.0f - 0.85f * t),
                  blend(foot, tip, t),
                  {lean, 0.7f, 0.6f},
                  0.25f + 0.75f * t};
        put(p, &l);
    }
}

static void paint_grass(painter *p)
{
    static const v3 foot[4] = {
        {0.020f, 0.032f, 0.009f}, {0.022f, 0.034f, 0.010f}, {0.060f, 0.052f, 0.022f}, {0.020f, 0.034f, 0.010f}};
    static const v3 tip[4] = {
        {0.115f, 0.165f, 0.040f}, {0.145f, 0.180f, 0.050f}, {0.290f, 0.240f, 0.105f}, {0.150f, 0.205f, 0.050f}};
    static const v3 petal[3] = {{0.75f, 0.72f, 0.62f}, {0.62f, 0.42f, 0.05f}, {0.38f, 0.20f, 0.50f}};
    for (int i = 0; i < COLUMNS; i++) {
        p->x0 = i * p->width;
        p->state = 5000u * (uint32_t)i + 3u;
        for (int k = 0; k < 46; k++) {
            float x = (chance(p) - 0.5f) * 0.5f, tall = i == 1 ? 0.93f : 0.78f;
            float height = tall * (0.35f + 0.65f * chance(p)), lean = x * 0.5f + (chance(p) - 0.5f) * 0.35f;
            float bright = 0.65f + 0.6f * chance(p);
            blade(p, x, height, lean, 0.0085f + 0.004f * chance(p), foot[i], v3_scale(tip[i], bright));
            if (i == 3 && k % 6 == 0)
                for (int f = 0; f < 9; f++) {
                    float right = 0.014f * (chance(p) - 0.5f), up = 0.014f * (chance(p) - 0.5f), pale = chance(p);
                    leaf l = {{x + lean + right, height * (1.0f - 0.12f * lean * lean) + up, 0.3f},
                              0.011f,
                              v3_scale(petal[(k / 6) % 3], 0.7f + 0.5f * pale),
                              {0, 0.8f, 0.6f},
                              1.0f};
                    put(p, &l);
                }
        }
    }
}

/* The mean of FINER² fine pixels: of colours (normals) where something was painted, of cover over all; and where
 * nothing was, the column's mean, so that filtering finds no other colour beyond an edge. */
static void shrink(const painter *p, const amb_image *fine, bool normals, const amb_image *out)
{
    for (int column = 0; column < COLUMNS; column++) {
        float sum[4] = {0, 0, 0, 0}, covered = 0.0f;
        for (int pass = 0; pass < 2; pass++)
            for (int y = 0; y < out->height; y++)
                for (int x = column * COLUMN; x < (column + 1) * COLUMN; x++) {
                    float value[4] = {0, 0, 0, 0}, cover = 0.0f;
                    for (int j = 0; j < FINER * FINER; j++) {
                        int fx = x * FINER + j % FINER, fy = y * FINER + j / FINER;
                        float a = amb_image_row(p->colour, 3, fy)[fx];
                        cover += a;
                        for (int c = 0; c < 4; c++)
                            value[c] += a * amb_image_row(fine, c, fy)[fx];
                    }
                    if (pass == 0) {
                        covered += cover;
                        for (int c = 0; c < 4; c++)
                            sum[c] += value[c];
                        continue;
                    }
                    for (int c = 0; c < 4; c++) {
                        float v = cover > 0.0f ? value[c] / cover : sum[c] / f_max(covered, 1.0f);
                        if (normals && c < 3)
                            v = v * 0.5f + 0.5f;
                        if (!normals && c == 3)
                            v = cover / (float)(FINER * FINER);
                        amb_image_row(out, c, y)[x] = v;
                    }
                }
    }
}

static amb_status paint(int height, void (*plants)(painter *), bool normals, amb_texel texel, amb_texture **out,
                        amb_error *error)
{
    painter p = {.width = COLUMN * FINER, .height = height * FINER};
    amb_image *small = NULL;
    *out = NULL;
    amb_status status = amb_image_create(COLUMNS * p.width, p.height, 4, &p.colour, error);
    if (status == AMB_OK)
        status = amb_image_create(COLUMNS * p.width, p.height, 4, &p.normal, error);
    if (status == AMB_OK)
        status = amb_image_create(COLUMNS * p.width, p.height, 1, &p.depth, error);
    if (status == AMB_OK)
        status = amb_image_create(COLUMNS * COLUMN, height, 4, &small, error);
    if (status == AMB_OK) {
        plants(&p);
        shrink(&p, normals ? p.normal : p.colour, normals, small);
        status = amb_texture_from_image(small, texel, true, out, error);
    }
    amb_image_close(&p.colour);
    amb_image_close(&p.normal);
    amb_image_close(&p.depth);
    amb_image_close(&small);
    return status;
}

amb_status amb_builtin_trees(const amb_context *context, amb_texture **out, amb_error *error)
{
    (void)context;
    return paint(TREE_HEIGHT, paint_trees, false, AMB_TEXEL_SRGB8_A8, out, error);
}
amb_status amb_builtin_tree_normals(const amb_context *context, amb_texture **out, amb_error *error)
{
    (void)context;
    return paint(TREE_HEIGHT, paint_trees, true, AMB_TEXEL_RGBA8, out, error);
}
amb_status amb_builtin_grass_tufts(const amb_context *context, amb_texture **out, amb_error *error)
{
    (void)context;
    return paint(GRASS_HEIGHT, paint_grass, false, AMB_TEXEL_SRGB8_A8, out, error);
}
