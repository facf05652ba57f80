#include "scenes/supersample.h"

typedef struct resolve_job {
    const amb_image *large, *small;
    int factor;
    bool mean;
} resolve_job;

static void resolve_row(void *user, int row, int thread)
{
    (void)thread;
    const resolve_job *job = user;
    int channel = row / job->small->height, y = row % job->small->height, samples = job->mean ? job->factor : 1;
    float *out = amb_image_row(job->small, channel, y), scale = 1.0f / (float)(samples * samples);
    for (int x = 0; x < job->small->width; x++) {
        float sum = 0.0f;
        for (int j = 0; j < samples; j++) {
            const float *in = amb_image_row(job->large, channel, y * job->factor + j) + (ptrdiff_t)x * job->factor;
            for (int i = 0; i < samples; i++)
                sum += in[i];
        }
        out[x] = sum * scale;
    }
}

void amb_supersample_resolve(const amb_context *context, const amb_image *large, const amb_image *small, int factor,
                             bool mean)
{
    resolve_job job = {large, small, factor, mean};
    amb_parallel_for(context, small->height * small->channels, resolve_row, &job);
}
