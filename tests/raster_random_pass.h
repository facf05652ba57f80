/* A random pass and its truth: shared by raster_random.c, which builds both, and raster_random_truth.c. */
#ifndef TESTS_RASTER_RANDOM_PASS_H
#define TESTS_RASTER_RANDOM_PASS_H

#include "raster/internal.h"
#include "tests/raster_shaders.h"

#define MAX_DRAWS 6
#define MAX_VERTICES 24
#define MAX_INDICES 144
#define MAX_COLORS 9

typedef struct random_draw {
    amb_draw state;
    raster_test_vertex vertex[MAX_VERTICES];
    uint32_t index[MAX_INDICES];
    raster_test_uniforms uniforms;
    bool flat; /* one depth for all vertices, w = 1: the truth knows the depth exactly */
} random_draw;

typedef struct random_color {
    bool textured;
    amb_texel texel; /* of a texture */
    int channels;
    float *truth[4]; /* [channel][sample of a pixel] */
} random_color;

typedef struct random_pass {
    const uint8_t *byte, *end;
    int width, height, targets, draws, tile_size, samples;
    int split; /* before this draw the pass is finished and its target kept for another */
    amb_target target;
    random_color color[MAX_COLORS];
    random_draw draw[MAX_DRAWS];
    float *depth; /* the truth's, as its colours */
    int *stencil;
    /* while a primitive is drawn */
    const random_draw *now;
    int primitive;
    bool front;
    unsigned covered; /* samples of the pixel being drawn */
    uint8_t *mask;    /* samples of every pixel, while a triangle is found */
} random_pass;

static inline bool random_has_depth(const random_pass *p) { return p->target.depth || p->target.depth_texture.texture; }

static inline bool random_is_screen(const amb_draw *d) { return !d->vertex && d->topology != AMB_PATCHES; }

/* What attachment i keeps of a value. */
float random_stored(const random_pass *p, int i, int channel, float value);
void random_truth_clear(random_pass *p);
void random_truth_draw(random_pass *p, const random_draw *d);
/* Of the draw p->now: a triangle, line or point of 3, 2 or 1 corners; a pixel, all of its samples. */
void random_truth_primitive(random_pass *p, const float clip[3][4], int corners);
void random_truth_pixel(void *pass, int x, int y);
/* The end of a pass: every sample becomes what the pixel holds after it. */
void random_truth_resolve(random_pass *p);

#endif
