#include "scenes/material.h"

#include "shade/color.h"

enum { LEVEL_LIMIT = 2048 }; /* reliefs are no larger */

typedef struct relief_job {
    const amb_texture *albedo;
    amb_image *height, *relief;
    float lod;
} relief_job;

static void height_row(void *user, int y, int thread)
{
    (void)thread;
    static const amb_sampler sampler = {.filter = AMB_BILINEAR};
    const relief_job *job = user;
    float *row = amb_image_row(job->height, 0, y);
    for (int x = 0; x < job->height->width; x++) {
        v2x uv = {((float)x + 0.5f) / (float)job->height->width, ((float)y + 0.5f) / (float)job->height->height};
        float c = color_luminance(v4x_xyz(amb_sample_2d_lod(job->albedo, &sampler, uv, job->lod)));
        row[x] = color_srgb_encode(c);
    }
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
    const amb_image *h = job->height;
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
    job.albedo = material->albedo;
    while (info.width > LEVEL_LIMIT || info.height > LEVEL_LIMIT) {
        info.width = info.width > 1 ? info.width / 2 : 1;
        info.height = info.height > 1 ? info.height / 2 : 1;
        job.lod += 1.0f;
    }
    status = amb_image_create(info.width, info.height, 1, &job.height, error);
    if (status == AMB_OK)
        status = amb_image_create(info.width, info.height, 4, &job.relief, error);
    if (status == AMB_OK) {
        amb_parallel_for(context, info.height, height_row, &job);
        amb_parallel_for(context, info.height, relief_row, &job);
        status = amb_texture_from_image(job.relief, AMB_TEXEL_RGBA8, true, &material->relief, error);
    }
    amb_image_close(&job.height);
    amb_image_close(&job.relief);
    return status;
}

void material_unload(amb_material *material) { amb_texture_close(&material->relief); }
