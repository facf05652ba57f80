#include <ambiance/math.h>
#include <ambiance/normal_map.h>
#include <stdlib.h>

/* Rows reach this many texels beyond both edges: the widest blur step, twice, and a little. */
enum { MARGIN = 2 << (AMB_MAX_NORMAL_MAP_OCTAVES - 1) };

typedef struct normal_job {
    const amb_image *color;
    const amb_normal_map_options *options;
    amb_image *height;  /* 1 channel */
    amb_image *from;    /* x and y of the last copy */
    amb_image *between; /* of the copy being made, blurred along u */
    amb_image *out;     /* x and y of the overlay, z of the sharp normal */
    float *scratch;     /* one padded row a thread */
    size_t scratch_floats;
    int step;     /* blur step, texels */
    float weight; /* gainⁱ */
} normal_job;

static float *scratch_row(const normal_job *job, int thread)
{
    return job->scratch + (size_t)thread * job->scratch_floats + MARGIN;
}

static int clamp_index(int i, int count) { return i < 0 ? 0 : i >= count ? count - 1 : i; }

/* Copies a row to padded[0…width-1] and continues it `reach` texels to both sides. */
static void pad_row(const float *row, int width, int reach, bool wrap, float *padded)
{
    memcpy(padded, row, (size_t)width * sizeof *row);
    for (int i = 1; i <= reach; i++) {
        padded[-i] = row[wrap ? (width - i % width) % width : 0];
        padded[width + i - 1] = row[wrap ? (i - 1) % width : width - 1];
    }
}

static void height_row(void *user, int y, int thread)
{
    (void)thread;
    const normal_job *job = user;
    float *height = amb_image_row(job->height, 0, y);
    const float *r = amb_image_row(job->color, 0, y);
    if (job->color->channels < 3) {
        memcpy(height, r, (size_t)job->color->width * sizeof *height);
        return;
    }
    const float *g = amb_image_row(job->color, 1, y), *b = amb_image_row(job->color, 2, y);
    for (int x = 0; x < job->color->width; x++)
        height[x] = (r[x] * 0.2126f + g[x] * 0.7152f) + b[x] * 0.0722f;
}

/* Sobel's [1 2 1] × [-1 0 1] over 8: exact for planes. */
static void normal_row(void *user, int y, int thread)
{
    const normal_job *job = user;
    const amb_normal_map_options *o = job->options;
    int width = job->height->width, rows = job->height->height;
    float *smooth = scratch_row(job, thread); /* [1 2 1] along v: its difference along u is the slope */
    const float *above = amb_image_row(job->height, 0, clamp_index(y - 1, rows));
    const float *here = amb_image_row(job->height, 0, y);
    const float *below = amb_image_row(job->height, 0, clamp_index(y + 1, rows));
    float *nx = amb_image_row(job->out, 0, y), *ny = amb_image_row(job->out, 1, y), *nz = amb_image_row(job->out, 2, y);
    float stretch = 1.0f;
    if (o->longitude_latitude)
        stretch = 1.0f / f_max(amb_sin(AMB_PI * (((float)y + 0.5f) / (float)rows)), 0.25f);
    float scale_u = -0.125f * o->strength * stretch, scale_v = -0.125f * o->strength;

    for (int x = 0; x < width; x++)
        ny[x] = (above[x] + 2.0f * here[x]) + below[x];
    pad_row(ny, width, 1, o->wrap_u, smooth);
    for (int x = 0; x < width; x++)
        nx[x] = (smooth[x + 1] - smooth[x - 1]) * scale_u;
    for (int x = 0; x < width; x++)
        nz[x] = below[x] - above[x];
    pad_row(nz, width, 1, o->wrap_u, smooth);
    for (int x = 0; x < width; x++)
        ny[x] = ((smooth[x - 1] + 2.0f * smooth[x]) + smooth[x + 1]) * scale_v;
    for (int x = 0; x < width; x++) {
        float inverse = 1.0f / f_sqrt((nx[x] * nx[x] + ny[x] * ny[x]) + 1.0f);
        nx[x] *= inverse;
        ny[x] *= inverse;
        nz[x] = inverse;
    }
    for (int c = 0; c < 2; c++)
        memcpy(amb_image_row(job->from, c, y), amb_image_row(job->out, c, y), (size_t)width * sizeof(float));
}

static void blur_row_u(void *user, int y, int thread)
{
    const normal_job *job = user;
    int width = job->height->width, s = job->step;
    const float *p = scratch_row(job, thread);
    for (int c = 0; c < 2; c++) {
        pad_row(amb_image_row(job->from, c, y), width, 2 * s, job->options->wrap_u, scratch_row(job, thread));
        float *to = amb_image_row(job->between, c, y);
        for (int x = 0; x < width; x++)
            to[x] = 0.0625f * (p[x - 2 * s] + p[x + 2 * s]) + 0.25f * (p[x - s] + p[x + s]) + 0.375f * p[x];
    }
}

/* Blurs along v into the next copy, and overlays that. */
static void blur_row_v(void *user, int y, int thread)
{
    (void)thread;
    const normal_job *job = user;
    int width = job->height->width, rows = job->height->height;
    for (int c = 0; c < 2; c++) {
        const float *p[5];
        for (int i = 0; i < 5; i++)
            p[i] = amb_image_row(job->between, c, clamp_index(y + (i - 2) * job->step, rows));
        float *copy = amb_image_row(job->from, c, y), *sum = amb_image_row(job->out, c, y);
        for (int x = 0; x < width; x++) {
            float b = 0.0625f * (p[0][x] + p[4][x]) + 0.25f * (p[1][x] + p[3][x]) + 0.375f * p[2][x];
            float top = b * job->weight;
            top = top < -1.0f ? -1.0f : top > 1.0f ? 1.0f : top;
            float base = sum[x];
            copy[x] = b;
            sum[x] = base + top * (1.0f - f_abs(base));
        }
    }
}

static void normalize_row(void *user, int y, int thread)
{
    (void)thread;
    const normal_job *job = user;
    float *nx = amb_image_row(job->out, 0, y), *ny = amb_image_row(job->out, 1, y), *nz = amb_image_row(job->out, 2, y);
    for (int x = 0; x < job->out->width; x++) {
        float inverse = 1.0f / f_sqrt((nx[x] * nx[x] + ny[x] * ny[x]) + f_max(nz[x] * nz[x], 1e-12f));
        nx[x] *= inverse;
        ny[x] *= inverse;
        nz[x] *= inverse;
    }
}

static amb_status check(const amb_context *context, const amb_image *color, const amb_normal_map_options *o,
                        amb_error *error)
{
    if (!context || !color || !o)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: %s is NULL",
                        !context ? "context"
                        : !color ? "color"
                                 : "options");
    if (color->channels != 1 && color->channels != 3 && color->channels != 4)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: the image has %d channels; allowed are 1, 3 and 4",
                        color->channels);
    if (!f_is_finite(o->strength))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: strength is %g; it must be finite",
                        (double)o->strength);
    if (o->octaves < 0 || o->octaves > AMB_MAX_NORMAL_MAP_OCTAVES)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: octaves is %d; allowed are 0 to %d", o->octaves,
                        AMB_MAX_NORMAL_MAP_OCTAVES);
    if (!(o->gain >= 0.0f && o->gain <= 8.0f))
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: gain is %g; allowed are 0 to 8", (double)o->gain);
    return AMB_OK;
}

amb_status amb_normal_map_make(const amb_context *context, const amb_image *color,
                               const amb_normal_map_options *options, amb_image **out, amb_error *error)
{
    if (!out)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "normal map: out is NULL");
    *out = NULL;
    amb_status status = check(context, color, options, error);
    if (status)
        return status;
    int width = color->width, height = color->height, threads = amb_context_threads(context);
    normal_job job = {.color = color, .options = options, .scratch_floats = (size_t)width + 2 * MARGIN, .weight = 1.0f};
    if ((status = amb_image_create(width, height, 1, &job.height, error)) ||
        (status = amb_image_create(width, height, 2, &job.from, error)) ||
        (status = amb_image_create(width, height, 2, &job.between, error)) ||
        (status = amb_image_create(width, height, 3, &job.out, error)))
        goto done;
    job.scratch = calloc((size_t)threads * job.scratch_floats, sizeof *job.scratch);
    if (!job.scratch) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "normal map: no memory for rows of %d texels", width);
        goto done;
    }
    amb_parallel_for(context, height, height_row, &job);
    amb_parallel_for(context, height, normal_row, &job);
    for (int i = 0; i < options->octaves; i++) {
        job.step = 1 << i;
        job.weight *= options->gain;
        amb_parallel_for(context, height, blur_row_u, &job);
        amb_parallel_for(context, height, blur_row_v, &job);
    }
    amb_parallel_for(context, height, normalize_row, &job);
    *out = job.out;
    job.out = NULL;
done:
    free(job.scratch);
    amb_image_close(&job.height);
    amb_image_close(&job.from);
    amb_image_close(&job.between);
    amb_image_close(&job.out);
    return status;
}
