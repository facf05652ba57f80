/* Morphological anti-aliasing written straight from its definition, slowly, in double precision and pixel by pixel,
 * sharing no code with post/. */
#ifndef AMB_TESTS_TRUTH_MLAA_H
#define AMB_TESTS_TRUTH_MLAA_H

#include "truth_post.h"

typedef struct truth_mlaa {
    int width, height;
    double corners; /* weights' factor where the crossing line is longer than a step; 1 from truth_mlaa_new */
    /* One entry a pixel. right, down: is there a discontinuity beyond; the margin is how far the Lab distance is from
     * the threshold. */
    unsigned char *right, *down;
    double *right_margin, *down_margin;
    int *distance[4];  /* left, right, up, down: 0 no line, else 1 + steps to that end, at most 256 */
    double *weight[4]; /* up, down, left, right */
} truth_mlaa;

enum { TRUTH_LEFT, TRUTH_RIGHT, TRUTH_UP, TRUTH_DOWN };

double truth_lab_distance(const double a[3], const double b[3]); /* linear Rec.709, clamped to 0…1 first */

/* Detects discontinuities of the image; gain multiplies its light. */
truth_mlaa truth_mlaa_detect(const truth_image *image, double gain, double threshold);
/* An empty one, to be filled with discontinuities by hand. */
truth_mlaa truth_mlaa_new(int width, int height);
void truth_mlaa_free(truth_mlaa *m);

/* Distances by recursive doubling: four passes of four samples, as the report's. */
void truth_mlaa_propagate(truth_mlaa *m);
/* Weights from distances, by looking at both ends of every pixel's line. */
void truth_mlaa_weigh(truth_mlaa *m);
/* The same weights, straight from each line: found whole, named L, Z or U (or none), and cut by the polygon that the
 * shape stands for. Lines longer than 256 are left out. */
void truth_mlaa_weigh_lines(truth_mlaa *m);
void truth_mlaa_blend(const truth_mlaa *m, truth_image *image);

/* Which sides are crossed at the start (end = 0) or end (end = 1) of the horizontal or vertical line through (x, y):
 * bit 0 the upper or left, bit 1 the lower or right. The end is `steps` away. */
int truth_mlaa_crossed(const truth_mlaa *m, int vertical, int x, int y, int end, int steps);

#endif
