/* A canvas: the images that a scene's passes draw on. It has an attachment for the colour and one for each requested
 * AOV, at factor² samples a pixel, and resolves them into the frame's layers when it is finished.
 *
 *   amb_canvas canvas;
 *   amb_status status = canvas_begin(job, aovs, aov_count, factor, &canvas, error);
 *   … amb_pass_draw(canvas.pass, …); shaders write out->color[canvas.slot[aov]] where slot > 0 …
 *   return canvas_finish(job, aovs, &canvas, status, error); */
#ifndef AMB_SCENES_CANVAS_H
#define AMB_SCENES_CANVAS_H

#include <ambiance/raster.h>
#include <ambiance/scene.h>

#define CANVAS_MAX_AOVS 24
#define CANVAS_MAX_FACTOR 4

typedef struct amb_canvas {
    int factor, width, height; /* samples along a pixel's side; size in samples */
    amb_pass *pass;
    amb_image *depth;
    amb_image *image[AMB_MAX_TARGETS]; /* by attachment; 0 is the colour */
    int aov[AMB_MAX_TARGETS];          /* which row of the scene's table an attachment holds */
    int count;
    int slot[CANVAS_MAX_AOVS]; /* attachment of each AOV of the table; 0: not wanted ("depth" never has one) */
} amb_canvas;

/* Every attachment starts at 0, depth at 1. Errors: LIMIT (more AOVs at once than a pass has attachments), those of
 * images and passes. On error the canvas holds nothing. */
amb_status canvas_begin(const amb_scene_job *job, const amb_aov *aovs, size_t aov_count, int factor, amb_canvas *canvas,
                        amb_error *error);
/* Runs the pass if `status` (of the drawing before) is OK, resolves, frees; returns the first failure. Values that may
 * not be mixed (depth, position, normal, id) take the pixel's first sample, the rest the mean. */
amb_status canvas_finish(const amb_scene_job *job, const amb_aov *aovs, amb_canvas *canvas, amb_status status,
                         amb_error *error);

/* Adds one pass's to the job's, where those are wanted: for scenes with passes of their own. */
void canvas_add_stats(const amb_scene_job *job, const amb_pass_stats *stats);

#endif
