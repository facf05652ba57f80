#include "scenes/material.h"

#include "shade/color.h"

enum { RELIEF_LIMIT = 2048 }; /* reliefs are no larger, unless the albedo has no smaller level */

typedef struct relief_job {
    amb_image *albedo, *relief; /* the first channel of albedo becomes the height */
} relief_job;

static void height_row(void *user, int y, int thread)
{
    (void)thread;
    const amb_image *a = ((const relief_job *)user)->albedo;
    float *r = amb_image_row(a, 0, y);
    const float *g = a->channels > 2 ? amb_image_row(a, 1, y) : r, *b = a->channels > 2 ? amb_image_row(a, 2, y) : r;
    for (int x = 0; x < a->width; x++)
        r[x] = f_sqrt(f_max(color_luminance((v3x){r[x], g[x], b[x]}), 0.0f)); /* about as coded for display */
}

static float height_at(const amb_image *image, int x, int y)
{
    int w = image->width, h = image->height;
    return amb_image_row(image, 0, (y + h) % h)[(x + w) % w];
}

/* Central differences over 2 texels, and how far the point is below the mean of a ring of 6 texels about it. */
static void relief_row(void *user, int y, int thread)
{
    (void)thread;
    const relief_job *job = user;
    const amb_image *h = job->albedo;
    for (int x = 0; x < h->width; x++) {
        float here = height_at(h, x, y), ring = 0.0f;
        float u = 4.0f * (height_at(h, x + 1, y) - height_at(h, x - 1, y));
        float v = 4.0f * (height_at(h, x, y + 1) - height_at(h, x, y - 1));
        static const int way[8][2] = {{6, 0}, {-6, 0}, {0, 6}, {0, -6}, {4, 4}, {4, -4}, {-4, 4}, {-4, -4}};
        for (int i = 0; i < 8; i++)
            ring += height_at(h, x + way[i][0], y + way[i][1]) * 0.125f;
        amb_image_row(job->relief, 0, y)[x] = f_saturate(u * 0.5f + 0.5f);
        amb_image_row(job->relief, 1, y)[x] = f_saturate(v * 0.5f + 0.5f);
        amb_image_row(job->relief, 2, y)[x] = f_saturate(here);
        amb_image_row(job->relief, 3, y)[x] = f_clamp(1.0f - 3.0f * (ring - here), 0.3f, 1.0f);
    }
}

amb_status material_load(const amb_context *context, amb_assets *assets, amb_material *material, amb_error *error)
{
    relief_job job = {0};
    amb_status status = amb_assets_texture(assets, material->asset, &material->albedo, error);
    if (status != AMB_OK)
        return status;
    amb_texture_info info = amb_texture_describe(material->albedo);
    int level = 0;
    while (level + 1 < info.levels && (info.width >> level > RELIEF_LIMIT || info.height >> level > RELIEF_LIMIT))
        level++;
    status = amb_texture_to_image(material->albedo, level, 0, &job.albedo, error);
    if (status == AMB_OK)
        status = amb_image_create(job.albedo->width, job.albedo->height, 4, &job.relief, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, job.albedo->height, height_row, &job);
        amb_parallel_for(context, job.albedo->height, relief_row, &job);
        status = amb_texture_from_image(job.relief, AMB_TEXEL_RGBA8, true, &material->relief, error);
    }
    amb_image_close(&job.albedo);
    amb_image_close(&job.relief);
    return status;
}

void material_unload(amb_material *material) { amb_texture_close(&material->relief); }
