/* Colour: Rec. 709 primaries, D65 white. Linear RGB unless named sRGB. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_COLOR_H
#define AMBIANCE_SHADE_COLOR_H

#include <ambiance/math.h>
#include <ambiance/vec.h>

/* Y of linear RGB, ITU-R BT.709: 0.2126 R + 0.7152 G + 0.0722 B. */
AMB_INLINE f32x color_luminance(v3x rgb) { return (rgb.x * 0.2126f + rgb.y * 0.7152f) + rgb.z * 0.0722f; }

/* IEC 61966-2-1, exact curve, a channel: coded → linear. Extends past 1; below 0 the straight part goes on. */
AMB_INLINE f32x color_srgb_decode(f32x c)
{
    f32x curve = f_pow((c + 0.055f) * (1.0f / 1.055f), f_set(2.4f));
    return f_sel(c <= 0.04045f, c * (1.0f / 12.92f), curve);
}
/* Linear → coded. */
AMB_INLINE f32x color_srgb_encode(f32x c)
{
    f32x curve = 1.055f * f_pow(c, f_set(1.0f / 2.4f)) - 0.055f;
    return f_sel(c <= 0.0031308f, c * 12.92f, curve);
}
AMB_INLINE v3x color_srgb_decode3(v3x c)
{
    return (v3x){color_srgb_decode(c.x), color_srgb_decode(c.y), color_srgb_decode(c.z)};
}
AMB_INLINE v3x color_srgb_encode3(v3x c)
{
    return (v3x){color_srgb_encode(c.x), color_srgb_encode(c.y), color_srgb_encode(c.z)};
}

/* CIE 1931 XYZ of linear RGB; white (1, 1, 1) has Y = 1. */
AMB_INLINE v3x color_xyz_of_rgb(v3x c)
{
    return (v3x){(c.x * 0.4123908f + c.y * 0.3575843f) + c.z * 0.1804808f,
                 (c.x * 0.2126390f + c.y * 0.7151687f) + c.z * 0.0721923f,
                 (c.x * 0.0193308f + c.y * 0.1191948f) + c.z * 0.9505322f};
}
AMB_INLINE v3x color_rgb_of_xyz(v3x c)
{
    return (v3x){(c.x * 3.2409699f - c.y * 1.5373832f) - c.z * 0.4986108f,
                 (c.y * 1.8759675f - c.x * 0.9692436f) + c.z * 0.0415551f,
                 (c.x * 0.0556301f - c.y * 0.2039770f) + c.z * 1.0569715f};
}
/* XYZ of chromaticity x, y and luminance Y; y must not be 0. */
AMB_INLINE v3x color_xyz_of_xyy(f32x x, f32x y, f32x luminance)
{
    f32x s = luminance / y;
    return (v3x){x * s, luminance, (1.0f - x - y) * s};
}

/* The nearest colour towards grey of the same luminance that has no negative channel; black where the luminance is not
 * above 0. For colours outside the Rec. 709 triangle. */
AMB_INLINE v3x color_clip_negative(v3x rgb)
{
    f32x zero = f_set(0.0f), grey = f_max(color_luminance(rgb), zero);
    f32x least = f_min(f_min(rgb.x, rgb.y), f_min(rgb.z, zero));
    f32x keep =
        f_sel(least < 0.0f, grey / f_max(grey - least, f_set(FLT_MIN)), f_set(1.0f)); /* grey + keep·least' = 0 */
    return (v3x){f_max(grey + (rgb.x - grey) * keep, zero), f_max(grey + (rgb.y - grey) * keep, zero),
                 f_max(grey + (rgb.z - grey) * keep, zero)};
}

AMB_INLINE f32x color_lab_curve_(f32x t)
{
    return f_sel(t > 216.0f / 24389.0f, f_cbrt(t), (t * (24389.0f / 27.0f) + 16.0f) * (1.0f / 116.0f));
}
/* CIE 1976 L*a*b* (L in 0..100 for colours up to white) of linear RGB, white D65. */
AMB_INLINE v3x color_lab_of_rgb(v3x rgb)
{
    v3x c = color_xyz_of_rgb(rgb);
    f32x x = color_lab_curve_(c.x * (1.0f / 0.9504559f)), y = color_lab_curve_(c.y);
    f32x z = color_lab_curve_(c.z * (1.0f / 1.0890578f));
    return (v3x){116.0f * y - 16.0f, 500.0f * (x - y), 200.0f * (y - z)};
}

#endif
