#include "truth_post.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static truth_image truth_new(int width, int height)
{
    truth_image image = {width, height, calloc((size_t)width * (size_t)height * 3, sizeof(double))};
    if (!image.value)
        abort();
    return image;
}

truth_image truth_of_layer(const amb_image *from)
{
    truth_image image = truth_new(from->width, from->height);
    for (int y = 0; y < from->height; y++)
        for (int x = 0; x < from->width; x++)
            for (int c = 0; c < 3; c++)
                truth_at(&image, x, y)[c] = (double)amb_image_row(from, c, y)[x];
    return image;
}

truth_image truth_of_frame(const amb_frame *frame) { return truth_of_layer(amb_frame_layer(frame, "color")); }

void truth_free(truth_image *image)
{
    free(image->value);
    image->value = NULL;
}

static int clamp_int(int a, int lo, int hi) { return a < lo ? lo : a > hi ? hi : a; }

double *truth_at(const truth_image *image, int x, int y)
{
    x = clamp_int(x, 0, image->width - 1);
    y = clamp_int(y, 0, image->height - 1);
    return image->value + ((size_t)y * (size_t)image->width + (size_t)x) * 3;
}

static double clamp(double a, double lo, double hi) { return isnan(a) ? lo : a < lo ? lo : a > hi ? hi : a; }

/* ---- blurs ------------------------------------------------------------------------------------------------------- */

static truth_image shrink(const truth_image *image, int reduce)
{
    truth_image small = truth_new((image->width + reduce - 1) / reduce, (image->height + reduce - 1) / reduce);
    for (int y = 0; y < small.height; y++)
        for (int x = 0; x < small.width; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0.0;
                for (int j = 0; j < reduce; j++)
                    for (int i = 0; i < reduce; i++)
                        sum += truth_at(image, x * reduce + i, y * reduce + j)[c];
                truth_at(&small, x, y)[c] = sum / (reduce * reduce);
            }
    return small;
}

static void convolve(truth_image *image, const double *tap, int first, int taps, int dx, int dy)
{
    truth_image out = truth_new(image->width, image->height);
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < taps; k++)
                    truth_at(&out, x, y)[c] += tap[k] * truth_at(image, x + dx * (first + k), y + dy * (first + k))[c];
    truth_free(image);
    *image = out;
}

/* Bilinear, with cells' centres at (cell + ½)·reduce. */
static double enlarged(const truth_image *small, int reduce, int x, int y, int c)
{
    double u = (x + 0.5) / reduce - 0.5, v = (y + 0.5) / reduce - 0.5;
    int i = (int)floor(u), j = (int)floor(v);
    double a = u - i, b = v - j;
    return (1 - b) * ((1 - a) * truth_at(small, i, j)[c] + a * truth_at(small, i + 1, j)[c]) +
           b * ((1 - a) * truth_at(small, i, j + 1)[c] + a * truth_at(small, i + 1, j + 1)[c]);
}

void truth_gaussian_taps(double sigma, double tap[7])
{
    double sum = 0.0;
    for (int i = -3; i <= 3; i++)
        sum += tap[i + 3] = exp(-i * i / (2 * sigma * sigma));
    for (int i = 0; i < 7; i++)
        tap[i] /= sum;
}

static truth_image gaussian_of(const truth_image *image, double sigma, int reduce)
{
    double tap[7];
    truth_gaussian_taps(sigma, tap);
    truth_image small = shrink(image, reduce);
    for (int round = 0; round < 3; round++) {
        convolve(&small, tap, -3, 7, 1, 0);
        convolve(&small, tap, -3, 7, 0, 1);
    }
    return small;
}

static void map_pixels(truth_image *image, void (*map)(double *rgb, const double *args), const double *args)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            map(truth_at(image, x, y), args);
}

static truth_image copy_of(const truth_image *image)
{
    truth_image copy = truth_new(image->width, image->height);
    memcpy(copy.value, image->value, (size_t)copy.width * (size_t)copy.height * 3 * sizeof(double));
    return copy;
}

static void excess(double *rgb, const double *threshold)
{
    double largest = 0.0;
    for (int c = 0; c < 3; c++) {
        rgb[c] = clamp(rgb[c], 0.0, 65504.0);
        largest = fmax(largest, rgb[c]);
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = largest > *threshold ? rgb[c] * (largest - *threshold) / largest : 0.0;
}

static void add_enlarged(truth_image *image, const truth_image *small, int reduce, double amount)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            for (int c = 0; c < 3; c++)
                truth_at(image, x, y)[c] += amount * enlarged(small, reduce, x, y, c);
}

void truth_bloom(truth_image *image, double threshold, double intensity, double sigma, int reduce)
{
    truth_image bright = copy_of(image);
    map_pixels(&bright, excess, &threshold);
    truth_image small = gaussian_of(&bright, sigma, reduce);
    add_enlarged(image, &small, reduce, intensity);
    truth_free(&small);
    truth_free(&bright);
}

static void bright_pass(double *rgb, const double *args)
{
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp(rgb[c], 0.0, 65504.0);
    double luminance = 0.2125 * rgb[0] + 0.7154 * rgb[1] + 0.0721 * rgb[2];
    double final = fmax(0.0, luminance - args[0]) * args[1];
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp(rgb[c] * (final / (luminance + 0.00001)), 0.0, 1.0);
}

void truth_brightpass(truth_image *image, double cutoff, double glare, int reduce, int normalized, int view)
{
    static const double weights[5] = {0.4, 0.2, 0.2, 0.1, 0.1};
    double tap[8];
    for (int i = -4; i < 4; i++)
        tap[i + 4] = weights[abs(i)] / (normalized ? 1.5 : 1.0);
    truth_image bright = copy_of(image);
    map_pixels(&bright, bright_pass, (double[]){cutoff, glare});
    if (view) {
        memcpy(image->value, bright.value, (size_t)image->width * (size_t)image->height * 3 * sizeof(double));
    } else {
        truth_image small = shrink(&bright, reduce);
        convolve(&small, tap, -4, 8, 1, 0);
        convolve(&small, tap, -4, 8, 0, 1);
        add_enlarged(image, &small, reduce, 1.0);
        truth_free(&small);
    }
    truth_free(&bright);
}

/* ---- colour ------------------------------------------------------------------------------------------------------ */

static double harmless(double a) { return isnan(a) ? 0.0 : clamp(a, -65504.0, 65504.0); }

void truth_adjust(truth_image *image, const truth_adjustment *how)
{
    truth_image small = {0};
    if (how->blur > 0.0) {
        truth_image clean = copy_of(image);
        for (size_t i = 0; i < (size_t)clean.width * (size_t)clean.height * 3; i++)
            clean.value[i] = harmless(clean.value[i]);
        small = gaussian_of(&clean, how->sigma, how->reduce);
        truth_free(&clean);
    }
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            double *p = truth_at(image, x, y);
            for (int c = 0; c < 3 && how->blur > 0.0; c++)
                p[c] = (1 - how->blur) * harmless(p[c]) + how->blur * enlarged(&small, how->reduce, x, y, c);
            double grey = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
            for (int c = 0; c < 3; c++) {
                p[c] = grey + (p[c] - grey) * how->saturation;
                p[c] = how->pivot + (p[c] - how->pivot) * how->contrast;
                p[c] *= how->brightness;
                p[c] *= 1 - how->black;
                p[c] = p[c] * (1 - how->white) + how->white;
            }
        }
    if (small.value)
        truth_free(&small);
}

static double hable(double x)
{
    const double A = 0.15, B = 0.50, C = 0.10, D = 0.20, E = 0.02, F = 0.30;
    return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
}

static double toned(double a, const truth_screen *how)
{
    a = clamp(a * pow(2.0, how->exposure), 0.0, 65504.0);
    if (strcmp(how->curve, "reinhard") == 0)
        a = a * (1 + a / (how->white * how->white)) / (1 + a);
    else if (strcmp(how->curve, "filmic") == 0)
        a = hable(a) / hable(how->white);
    else if (strcmp(how->curve, "aces") == 0)
        a = a * (2.51 * a + 0.03) / (a * (2.43 * a + 0.59) + 0.14);
    return clamp(a, 0.0, 1.0);
}

static double coded(double a, const char *encode)
{
    if (strcmp(encode, "srgb") == 0)
        return a <= 0.0031308 ? 12.92 * a : 1.055 * pow(a, 1 / 2.4) - 0.055;
    if (strcmp(encode, "rec709") == 0)
        return a < 0.018 ? 4.5 * a : 1.099 * pow(a, 0.45) - 0.099;
    return a;
}

/* Bayer's matrix by its recursion M(2n) = 4·M(n) + {0 2; 3 1}. */
static int bayer(int x, int y, int size)
{
    static const int base[2][2] = {{0, 2}, {3, 1}};
    return size == 1 ? 0 : 4 * bayer(x % (size / 2), y % (size / 2), size / 2) + base[y / (size / 2)][x / (size / 2)];
}

void truth_display(truth_image *image, const truth_screen *how)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            for (int c = 0; c < 3; c++) {
                double *p = truth_at(image, x, y) + c;
                *p = coded(toned(*p, how), how->encode);
                if (strcmp(how->dither, "ordered") == 0)
                    *p = fmin(floor(*p * 255 + (bayer(x % 8, y % 8, 8) + 0.5) / 64), 255) / 255;
            }
}

void truth_vignette(truth_image *image, double strength)
{
    double half_w = image->width / 2.0, half_h = image->height / 2.0, corner = hypot(half_w, half_h);
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            double angle = atan(strength * hypot(x + 0.5 - half_w, y + 0.5 - half_h) / corner);
            for (int c = 0; c < 3; c++)
                truth_at(image, x, y)[c] *= pow(cos(angle), 4.0);
        }
}

/* ---- noise: the integer hash as documented in post/hash.h -------------------------------------------------------- */

static uint32_t mix(uint32_t h)
{
    h ^= h >> 16;
    h *= UINT32_C(2246822507);
    h ^= h >> 13;
    h *= UINT32_C(3266489909);
    h ^= h >> 16;
    return h;
}

static uint32_t key_of(long frame, uint32_t channel)
{
    uint64_t f = (uint64_t)frame;
    return mix((uint32_t)(f * 2654435769u) ^ ((uint32_t)(f >> 32) * 2146121005u) ^ ((channel + 1) * 2221713035u));
}

static uint32_t lattice(int x, int y, uint32_t key) { return mix((uint32_t)x + 2654435769u * mix((uint32_t)y + key)); }

void truth_grain(truth_image *image, double amount, int size, int colored, long frame_index)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            double *p = truth_at(image, x, y);
            double light = clamp(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2], 0.0, 65504.0);
            for (uint32_t c = 0; c < 3; c++) {
                uint32_t h = lattice(x / size, y / size, key_of(frame_index, colored ? c : 0));
                p[c] += amount * sqrt(light) * ((double)(h >> 16) - (double)(h & 65535)) / 65536.0;
            }
        }
}

static double quintic(double t) { return t * t * t * (10 + t * (6 * t - 15)); }

static double value_noise(double x, double y, uint32_t key)
{
    int i = (int)floor(x), j = (int)floor(y);
    double u = quintic(x - i), v = quintic(y - j), corner[2][2];
    for (int b = 0; b < 2; b++)
        for (int a = 0; a < 2; a++)
            corner[b][a] = (lattice(i + a, j + b, key) >> 8) / 16777216.0;
    double n = (1 - v) * ((1 - u) * corner[0][0] + u * corner[0][1]) + v * ((1 - u) * corner[1][0] + u * corner[1][1]);
    return 2 * n - 1;
}

void truth_dispersion(truth_image *image, double amount, double scale, long noise_index)
{
    truth_image from = copy_of(image);
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++)
            for (uint32_t c = 0; c < 3; c++) {
                double u = x + amount * value_noise(x / scale, y / scale, key_of(noise_index, 16 + 2 * c));
                double v = y + amount * value_noise(x / scale, y / scale, key_of(noise_index, 17 + 2 * c));
                u = clamp(u, 0, image->width - 1);
                v = clamp(v, 0, image->height - 1);
                int i = (int)floor(u), j = (int)floor(v);
                double sum = 0.0;
                for (int b = 0; b < 2; b++)
                    for (int a = 0; a < 2; a++)
                        sum += (a ? u - i : 1 - (u - i)) * (b ? v - j : 1 - (v - j)) *
                               harmless(truth_at(&from, i + a, j + b)[c]);
                truth_at(image, x, y)[c] = sum;
            }
    truth_free(&from);
}
