/* A plain rasterizer straight from the rules, sharing no code with raster/: the tests' truth for coverage. */
#ifndef TESTS_TRUTH_RASTER_H
#define TESTS_TRUTH_RASTER_H

#include <stdint.h>

/* A window triangle after clipping: what a GPU's rasterizer is given. */
typedef struct truth_triangle {
    int64_t x[3], y[3]; /* 1/256 pixel */
    double clip[3][4];
} truth_triangle;

/* Clips, projects and snaps; returns how many triangles came of it (at most 7; degenerate ones are among them). */
int truth_clip(const float clip[3][4], int width, int height, truth_triangle out[7]);
/* Twice the area in (1/256 pixel)², positive when clockwise on the screen. */
int64_t truth_area(const truth_triangle *t);
/* Does the triangle own the centre of pixel (x, y)? */
int truth_covers(const truth_triangle *t, int x, int y);
/* Calls pixel() for every owned pixel of the window. */
void truth_draw(const float clip[3][4], int width, int height, void (*pixel)(void *user, int x, int y), void *user);

#endif
