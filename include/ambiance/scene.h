/* Scenes: pure functions of (parameters, time, size, assets). One file per scene ends in one const descriptor; the
 * registry has one line each. */
#ifndef AMBIANCE_SCENE_H
#define AMBIANCE_SCENE_H

#include <ambiance/assets.h>
#include <ambiance/camera.h>
#include <ambiance/context.h>
#include <ambiance/frame.h>
#include <ambiance/param.h>
#include <ambiance/raster.h>

/* An output besides colour. Shared names and meanings: depth (1: 0…1), position (3: world), normal (3: world, unit),
 * albedo (3: linear), id (1: object number, 0 = background); a scene adds its own components. */
typedef struct amb_aov {
    const char *name;
    int channels;
    const char *about;
} amb_aov;

typedef struct amb_scene_job {
    const amb_context *context;
    const void *params;    /* the scene's parameter struct, filled */
    double time;           /* seconds, any finite value */
    int width, height;     /* pixels */
    amb_frame *frame;      /* "color" and every requested AOV are there, zeroed, to be filled */
    amb_pass_stats *stats; /* NULL, or where the frame's passes add their counts and stages' ticks */
} amb_scene_job;

typedef struct amb_scene {
    const char *name, *about;
    float seconds; /* length of its loop or flight */
    amb_params params;
    const amb_aov *aovs;
    size_t aov_count;
    const char *post; /* its default chain, as --post reads it */
    /* Loads assets and builds what does not depend on time; *state is the scene's. */
    amb_status (*load)(const amb_context *context, amb_assets *assets, void **state, amb_error *error);
    /* Renders one frame; state is read-only. Several frames may be rendered at once. */
    amb_status (*frame)(const void *state, const amb_scene_job *job, amb_error *error);
    void (*unload)(void *state);
} amb_scene;

/* The registry: index 0…count-1, in listing order, for the context's instruction set. NULL past the end. */
int amb_scene_count(void);
const amb_scene *amb_scene_by_index(amb_isa isa, int index);
const amb_scene *amb_scene_by_name(amb_isa isa, const char *name); /* NULL when unknown */

/* Marks in wanted[0…aov_count-1] (may be NULL: only checks) the AOVs that the NULL-ended `names` (NULL: none; "all" for
 * every one) ask for. Errors: NOT_FOUND. */
amb_status amb_scene_choose_aovs(const amb_scene *scene, const char *const *names, bool *wanted, amb_error *error);

/* A loaded scene, its parameters and assets: the whole of rendering in three calls. */
typedef struct amb_show amb_show;
amb_status amb_show_open(const amb_context *context, amb_assets *assets, const char *scene, amb_show **out,
                         amb_error *error);
amb_status amb_show_set(amb_show *show, const char *name, const char *value, amb_error *error);
/* aovs: names, NULL-ended (NULL: none; "all" for every one). *out is the caller's to close. No post chain is applied.
 */
amb_status amb_show_render(const amb_show *show, double time, int width, int height, const char *const *aovs,
                           amb_frame **out, amb_error *error);
const amb_scene *amb_show_scene(const amb_show *show);
void amb_show_close(amb_show **show);

#endif
