/* Post passes in plain double precision, written from their definitions and sharing no code with post/: what the tests
 * hold the passes to. Slow and simple; nothing here is fast on purpose. */
#ifndef AMB_TESTS_TRUTH_POST_H
#define AMB_TESTS_TRUTH_POST_H

#include <ambiance/frame.h>
#include <stdint.h>

typedef struct truth_image {
    int width, height;
    double *value; /* [(y·width + x)·3 + channel] */
} truth_image;

truth_image truth_of_frame(const amb_frame *frame); /* layer "color"; the caller's to free */
truth_image truth_of_layer(const amb_image *image); /* its first three channels */
void truth_free(truth_image *image);
double *truth_at(const truth_image *image, int x, int y); /* coordinates are clamped to the image */

void truth_bloom(truth_image *image, double threshold, double intensity, double sigma, int reduce);
void truth_brightpass(truth_image *image, double cutoff, double glare, int reduce, int normalized, int view);

typedef struct truth_adjustment {
    double blur, saturation, contrast, pivot, brightness, black, white, sigma;
    int reduce;
} truth_adjustment;
void truth_adjust(truth_image *image, const truth_adjustment *how);

typedef struct truth_screen {
    double exposure, white;
    const char *curve, *encode, *dither;
} truth_screen;
void truth_display(truth_image *image, const truth_screen *how);

void truth_vignette(truth_image *image, double strength);
void truth_grain(truth_image *image, double amount, int size, int colored, long frame_index);
void truth_dispersion(truth_image *image, double amount, double scale, long noise_index);

/* Separable 7-tap Gaussian, three rounds, as a whole-image convolution with edges clamped: for the impulse test. */
void truth_gaussian_taps(double sigma, double tap[7]);

#endif
