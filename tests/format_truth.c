#include "tests/format_truth.h"
#include "tests/texture_reference.h"

#include <math.h>

/* All finite values, ascending, of an unsigned float with 5 exponent and `mantissa` bits. */
static const double *values_of(int mantissa)
{
    static double values[11][31 << 10];
    double *v = values[mantissa];
    if (v[1] == 0.0)
        for (int i = (31 << mantissa) - 1; i >= 0; i--)
            v[i] = ref_small((unsigned)i, mantissa);
    return v;
}

/* The nearest of them to a value ≥ 0, ties to the even code. Beyond the last: the number of values (infinity). */
static int nearest(double value, int mantissa)
{
    const double *v = values_of(mantissa);
    int last = (31 << mantissa) - 1, low = 0, high = last + 1; /* v[low] <= value < v[high] */
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (v[middle] <= value)
            low = middle;
        else
            high = middle;
    }
    double above = low == last ? 65536.0 : v[low + 1]; /* where the next exponent would begin */
    double below = value - v[low], rest = above - value;
    return below < rest || (below == rest && low % 2 == 0) ? low : low + 1;
}

static float half_truth(float value)
{
    if (isnan(value) || isinf(value))
        return value;
    int code = nearest(fabs((double)value), 10);
    double magnitude = code == 31 << 10 ? (double)INFINITY : values_of(10)[code];
    return (float)copysign(magnitude, (double)value);
}

static float small_truth(float value, int mantissa)
{
    if (isnan(value))
        return value;
    if (value <= 0.0f)
        return 0.0f;
    if (isinf(value))
        return value;
    int last = (31 << mantissa) - 1, code = nearest((double)value, mantissa);
    return (float)values_of(mantissa)[code > last ? last : code];
}

/* Direct3D's steps, in float as it writes them. */
static float unorm_truth(float value)
{
    float c = value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f; /* NaN: 0 */
    c = c * 255.0f;
    c = c + 0.5f;
    return (float)(int)c / 255.0f;
}

static double coded(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

static float srgb_truth(float value)
{
    double distance, c = format_exact_code(AMB_TEXEL_SRGB8_A8, 0, (double)value, &distance) / 255.0;
    return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

int format_exact_code(amb_texel texel, int channel, double value, double *distance)
{
    double c = value > 0 ? value < 1 ? value : 1 : 0;
    if (texel == AMB_TEXEL_SRGB8_A8 && channel < 3)
        c = coded(c);
    double scaled = c * 255.0 + 0.5;
    *distance = fabs(scaled - floor(scaled + 0.5));
    return (int)floor(scaled);
}

bool format_is_unorm(amb_texel texel)
{
    return texel == AMB_TEXEL_R8 || texel == AMB_TEXEL_RG8 || texel == AMB_TEXEL_RGBA8 || texel == AMB_TEXEL_SRGB8_A8;
}

int format_channels(amb_texel texel)
{
    static const int channels[] = {1, 2, 4, 4, 1, 4, 1, 4, 3, 2, 2};
    return channels[texel];
}

float format_truth(amb_texel texel, int channel, float value)
{
    if (texel == AMB_TEXEL_SRGB8_A8 && channel < 3)
        return srgb_truth(value);
    if (format_is_unorm(texel))
        return unorm_truth(value);
    if (texel == AMB_TEXEL_R16F || texel == AMB_TEXEL_RG16F || texel == AMB_TEXEL_RGBA16F)
        return half_truth(value);
    if (texel == AMB_TEXEL_R11G11B10F)
        return small_truth(value, channel < 2 ? 6 : 5);
    return value;
}
