/* A plain rasterizer straight from the rules, sharing no code with raster/: the tests' truth for coverage. */
#ifndef TESTS_TRUTH_RASTER_H
#define TESTS_TRUTH_RASTER_H

#include <stdint.h>

/* A window triangle after clipping: what a GPU's rasterizer is given. */
typedef struct truth_triangle {
    int64_t x[3], y[3]; /* 1/256 pixel */
    double clip[3][4];
    double weight[3][3]; /* of the unclipped triangle's corners, at each of these */
} truth_triangle;

/* Clips, projects and snaps; returns how many triangles came of it (at most 7; degenerate ones are among them). With
 * clip_depth 0 the near and far planes are left out. */
int truth_clip(const float clip[3][4], int width, int height, int clip_depth, truth_triangle out[7]);
/* Twice the area in (1/256 pixel)², positive when clockwise on the screen. */
int64_t truth_area(const truth_triangle *t);
/* Does the triangle own the centre of pixel (x, y)? */
int truth_covers(const truth_triangle *t, int x, int y);
/* The same for a sample dx, dy sixteenths of a pixel from the centre. */
int truth_covers_sample(const truth_triangle *t, int x, int y, int dx, int dy);
/* The perspective-correct value, from those at the corners, at a sample dx, dy sixteenths of a pixel from the centre of
 * a pixel. condition, if given: how much larger the terms are than their sum; 1 inside. */
double truth_value(const truth_triangle *t, const double corner[3], int x, int y, int dx, int dy, double *condition);
/* Depth there: linear in the window. */
double truth_depth(const truth_triangle *t, int x, int y, int dx, int dy);
/* Calls pixel() for every pixel of the window that a snapped triangle owns. */
void truth_fill(const truth_triangle *t, int width, int height, void (*pixel)(void *user, int x, int y), void *user);
/* The same for samples dx, dy sixteenths of a pixel from the centres. */
void truth_fill_sample(const truth_triangle *t, int width, int height, int dx, int dy,
                       void (*pixel)(void *user, int x, int y), void *user);
/* Clips and fills, whatever way the pieces face. */
void truth_draw(const float clip[3][4], int width, int height, void (*pixel)(void *user, int x, int y), void *user);

/* A line by the diamond-exit rule, after clipping; with clip_depth 0 without the near and far planes. */
void truth_draw_line(const float from[4], const float to[4], int width, int height, int clip_depth,
                     void (*pixel)(void *user, int x, int y), void *user);
/* A square of that many pixels about a vertex; nothing when the vertex is outside the clip volume. */
void truth_draw_point(const float clip[4], float size, int width, int height, int clip_depth,
                      void (*pixel)(void *user, int x, int y), void *user);

#endif
