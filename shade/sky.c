#include "shade/sky.h"

/* Appendix A.2: coefficient = slope · turbidity + offset, for A B C D E of luminance, x and y. */
static const float perez_slope[3][5] = {{0.1787f, -0.3554f, -0.0227f, 0.1206f, -0.0670f},
                                        {-0.0193f, -0.0665f, -0.0004f, -0.0641f, -0.0033f},
                                        {-0.0167f, -0.0950f, -0.0079f, -0.0441f, -0.0109f}};
static const float perez_offset[3][5] = {{-1.4630f, 0.4275f, 5.3251f, -2.5771f, 0.3703f},
                                         {-0.2592f, 0.0008f, 0.2125f, -0.8989f, 0.0452f},
                                         {-0.2608f, 0.0092f, 0.2102f, -1.6537f, 0.0529f}};
/* Zenith chromaticity: rows T², T, 1; columns θs³, θs², θs, 1. */
static const float zenith_x[3][4] = {{0.00166f, -0.00375f, 0.00209f, 0.0f},
                                     {-0.02903f, 0.06377f, -0.03202f, 0.00394f},
                                     {0.11693f, -0.21196f, 0.06052f, 0.25886f}};
static const float zenith_y[3][4] = {{0.00275f, -0.00610f, 0.00317f, 0.0f},
                                     {-0.04214f, 0.08970f, -0.04153f, 0.00516f},
                                     {0.15346f, -0.26756f, 0.06670f, 0.26688f}};

static float zenith_chromaticity(const float m[3][4], float turbidity, float theta)
{
    float row[3];
    for (int i = 0; i < 3; i++)
        row[i] = ((m[i][0] * theta + m[i][1]) * theta + m[i][2]) * theta + m[i][3];
    return (row[0] * turbidity + row[1]) * turbidity + row[2];
}

/* kcd/m². The fit falls below 0 in thick haze with a low sun; half a thousandth of a clear day is the least. */
static float zenith_luminance(float turbidity, float theta)
{
    float chi = (4.0f / 9.0f - turbidity / 120.0f) * (AMB_PI - 2.0f * theta);
    float luminance = (4.0453f * turbidity - 4.9710f) * amb_tan(chi) - 0.2155f * turbidity + 2.4192f;
    return amb_s_max(luminance, 0.05f);
}

/* Appendix A.1. The sun's light that passes the air, per channel, seen at `degrees` from the zenith (at most 90). */
static v3 sun_transmittance(float turbidity, float degrees)
{
    static const float wavelength[3] = {0.610f, 0.550f, 0.465f}; /* µm */
    static const float ozone[3] = {0.120f, 0.085f, 0.008f};      /* per cm at those */
    float cosine = amb_cos(degrees * (AMB_PI / 180.0f));
    float mass = 1.0f / (cosine + 0.15f * amb_pow(93.885f - degrees, -1.253f));
    float beta = 0.04608365822050f * turbidity - 0.04586025928522f; /* Ångström's */
    v3 left;
    float *channel = &left.x;
    for (int i = 0; i < 3; i++) {
        float rayleigh = 0.008735f * amb_pow(wavelength[i], -4.08f);
        float aerosol = beta * amb_pow(wavelength[i], -1.3f);
        channel[i] = amb_exp(-mass * (rayleigh + aerosol + ozone[i] * 0.35f)); /* 0.35 cm of ozone */
    }
    return left;
}

/* Cosine-weighted mean over the upper hemisphere: midpoints of rings of equal weight. */
static v3 ambient(const amb_sky *sky)
{
    enum { RINGS = 16, SECTORS = 32 };
    v3 sum = {0.0f, 0.0f, 0.0f};
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < SECTORS; k++) {
            float sine2 = ((float)i + 0.5f) / RINGS, angle = AMB_TWO_PI * ((float)k + 0.5f) / SECTORS;
            float sine = f_sqrt(sine2);
            v3x direction = {sine * amb_cos(angle), f_sqrt(1.0f - sine2), sine * amb_sin(angle)};
            v3x rgb = sky_rgb(sky, direction);
            sum = v3_add(sum, (v3){rgb.x, rgb.y, rgb.z});
        }
    return v3_scale(sum, 1.0f / (RINGS * SECTORS));
}

amb_sky amb_sky_make(v3 to_sun, float turbidity)
{
    amb_sky sky = {.to_sun = to_sun, .turbidity = f_clamp(turbidity, 1.7f, 10.0f)};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 5; k++)
            sky.perez[i][k] = perez_slope[i][k] * sky.turbidity + perez_offset[i][k];

    v3x glow = sky_above_horizon_((v3x){to_sun.x, to_sun.y, to_sun.z});
    sky.glow_sun = (v3){glow.x, glow.y, glow.z};
    float theta = amb_acos(f_clamp(sky.glow_sun.y, -1.0f, 1.0f));
    float height = amb_asin(f_clamp(to_sun.y, -1.0f, 1.0f)) * (180.0f / AMB_PI); /* degrees */
    float twilight = amb_exp(f_min(height, 0.0f) * (4.60517f / 6.0f));           /* ln 100 in 6° */
    sky.zenith =
        (v3){zenith_luminance(sky.turbidity, theta) * twilight, zenith_chromaticity(zenith_x, sky.turbidity, theta),
             zenith_chromaticity(zenith_y, sky.turbidity, theta)};
    const float *zenith = &sky.zenith.x;
    float *scale = &sky.scale.x;
    for (int i = 0; i < 3; i++)
        scale[i] = zenith[i] / sky_perez_(sky.perez[i], amb_exp(sky.perez[i][1]), theta, amb_cos(theta));

    float above = f_saturate((height + 0.267f) / 0.534f); /* of the disc */
    float illuminance = 127.5f * AMB_INV_PI * above;
    sky.sun_rgb = v3_scale(sun_transmittance(sky.turbidity, f_min(90.0f - height, 90.0f)), illuminance);
    sky.ambient_rgb = ambient(&sky);
    return sky;
}
