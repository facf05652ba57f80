/* Saturn's rings as functions of radius. Places and optical depths of the rings after L. W. Esposito, "Planetary Rings"
 * (2006), table 2.1 and fig. 4.6, rounded; the ringlets between are noise. */
#include "scenes/builtin/rings.h"

#include "scenes/builtin/builtin.h"
#include <ambiance/math.h>
#include <ambiance/noise.h>

enum { RING_TEXELS = 4096 };

typedef struct ring_zone {
    float inner, outer; /* planet radii */
    float depth, rough; /* normal optical depth; how much ringlets change it, relative */
    float scale;        /* ringlets a planet radius */
    float albedo, dust; /* brightness of lit particles; share of fine dust, which scatters forward */
    v3 tint;
} ring_zone;

static const ring_zone zones[] = {
    {1.11f, 1.236f, 0.008f, 0.9f, 60.0f, 0.20f, 1.0f, {0.50f, 0.46f, 0.42f}},    /* D */
    {1.239f, 1.527f, 0.09f, 0.8f, 90.0f, 0.25f, 0.35f, {0.52f, 0.47f, 0.40f}},   /* C */
    {1.527f, 1.66f, 0.85f, 0.35f, 140.0f, 0.50f, 0.05f, {0.74f, 0.64f, 0.49f}},  /* B, inner */
    {1.66f, 1.951f, 2.0f, 0.45f, 160.0f, 0.62f, 0.03f, {0.86f, 0.77f, 0.62f}},   /* B, outer */
    {1.951f, 2.027f, 0.09f, 0.6f, 160.0f, 0.30f, 0.45f, {0.56f, 0.52f, 0.46f}},  /* Cassini division */
    {2.027f, 2.269f, 0.55f, 0.16f, 130.0f, 0.50f, 0.10f, {0.70f, 0.64f, 0.55f}}, /* A */
    {2.322f, 2.330f, 0.10f, 0.4f, 300.0f, 0.40f, 0.9f, {0.66f, 0.64f, 0.60f}},   /* F */
};
/* Gaps inside the zones: Huygens, Encke and Keeler; the Maxwell gap. */
static const struct {
    float centre, half_width;
} gaps[] = {{1.9525f, 0.004f}, {2.2140f, 0.0027f}, {2.2630f, 0.0011f}, {1.4520f, 0.0022f}};

typedef struct ring_point {
    float depth, albedo, dust;
    v3 tint;
} ring_point;

static ring_point ring_at(float radius)
{
    ring_point at = {0, 0, 0, {0.6f, 0.55f, 0.5f}};
    for (size_t i = 0; i < sizeof zones / sizeof *zones; i++) {
        const ring_zone *zone = &zones[i];
        if (radius < zone->inner || radius >= zone->outer)
            continue;
        v2 p = {radius * zone->scale, 0.5f + 7.0f * (float)i};
        float ringlets =
            fbm2(noise_value2, (v2x){p.x, p.y}, (amb_lattice){.seed = 301}, (amb_fbm){5, 2.0f, 0.6f}).value;
        float edge = 0.0012f;
        float inside = f_smoothstep(zone->inner, zone->inner + edge, radius) *
                       (1.0f - f_smoothstep(zone->outer - edge, zone->outer, radius));
        float depth = zone->depth * inside * f_max(1.0f + zone->rough * ringlets, 0.05f);
        at = (ring_point){depth, zone->albedo * (1.0f + 0.10f * ringlets), zone->dust, zone->tint};
    }
    for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++) {
        float off = f_abs(radius - gaps[i].centre);
        at.depth *= f_smoothstep(gaps[i].half_width * 0.6f, gaps[i].half_width, off);
    }
    return at;
}

amb_status amb_builtin_saturn_rings(const amb_context *context, amb_texture **out, amb_error *error)
{
    (void)context;
    amb_image *image;
    *out = NULL;
    amb_status status = amb_image_create(RING_TEXELS, 1, 4, &image, error);
    if (status != AMB_OK)
        return status;
    for (int x = 0; x < RING_TEXELS; x++) {
        ring_point at = ring_at(RINGS_INNER + (RINGS_OUTER - RINGS_INNER) * ((float)x + 0.5f) / RING_TEXELS);
        amb_image_row(image, 0, 0)[x] = at.tint.x;
        amb_image_row(image, 1, 0)[x] = at.tint.y;
        amb_image_row(image, 2, 0)[x] = at.tint.z;
        amb_image_row(image, 3, 0)[x] = 1.0f - f_exp(-1.4f * at.depth);
    }
    status = amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, out, error);
    amb_image_close(&image);
    return status;
}

/* Single scattering in a thin layer: the lit side reflects 1 - e^(-2τ) of what its particles return; the unlit side
 * passes τ e^(-τ), most at τ = 1; dust sends light forward. */
amb_status amb_builtin_saturn_ring_scatter(const amb_context *context, amb_texture **out, amb_error *error)
{
    (void)context;
    amb_image *image;
    *out = NULL;
    amb_status status = amb_image_create(RING_TEXELS, 1, 3, &image, error);
    if (status != AMB_OK)
        return status;
    for (int x = 0; x < RING_TEXELS; x++) {
        ring_point at = ring_at(RINGS_INNER + (RINGS_OUTER - RINGS_INNER) * ((float)x + 0.5f) / RING_TEXELS);
        float lit = 1.0f - f_exp(-2.0f * at.depth);
        amb_image_row(image, 0, 0)[x] = at.albedo * lit * 1.5f;
        amb_image_row(image, 1, 0)[x] = lit * (0.30f * at.albedo + 1.1f * at.dust);
        amb_image_row(image, 2, 0)[x] = at.depth * f_exp(-at.depth) * (0.55f * at.albedo + 0.9f * at.dust);
    }
    status = amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, out, error);
    amb_image_close(&image);
    return status;
}

/* Radii in planet radii and widths of the nine main rings, the widths enlarged fivefold so that they show (J. L.
 * Elliot, P. D. Nicholson, in: Planetary Rings, 1984). */
amb_status amb_builtin_uranus_rings(const amb_context *context, amb_texture **out, amb_error *error)
{
    static const struct {
        float radius, width, opacity;
    } ring[] = {{1.637f, 0.003f, 0.35f}, {1.652f, 0.003f, 0.4f},  {1.666f, 0.003f, 0.4f},
                {1.750f, 0.005f, 0.45f}, {1.786f, 0.006f, 0.45f}, {1.834f, 0.004f, 0.35f},
                {1.863f, 0.004f, 0.5f},  {1.900f, 0.005f, 0.5f},  {2.006f, 0.011f, 0.85f}};
    amb_image *image;
    *out = NULL;
    (void)context;
    amb_status status = amb_image_create(RING_TEXELS, 1, 4, &image, error);
    if (status != AMB_OK)
        return status;
    for (int x = 0; x < RING_TEXELS; x++) {
        float radius = RINGS_INNER + (RINGS_OUTER - RINGS_INNER) * ((float)x + 0.5f) / RING_TEXELS, opacity = 0.012f;
        for (size_t i = 0; i < sizeof ring / sizeof *ring; i++) {
            float off = f_abs(radius - ring[i].radius);
            opacity += ring[i].opacity * (1.0f - f_smoothstep(0.5f * ring[i].width, 0.8f * ring[i].width, off));
        }
        opacity = opacity * f_smoothstep(1.60f, 1.63f, radius) * (1.0f - f_smoothstep(2.03f, 2.06f, radius));
        amb_image_row(image, 0, 0)[x] = 0.62f;
        amb_image_row(image, 1, 0)[x] = 0.66f;
        amb_image_row(image, 2, 0)[x] = 0.70f;
        amb_image_row(image, 3, 0)[x] = opacity;
    }
    status = amb_texture_from_image(image, AMB_TEXEL_RGBA16F, true, out, error);
    amb_image_close(&image);
    return status;
}
