/* A scene of the registry as a workload: loaded once for each instruction set, with built-in assets and its default
 * parameters. */
#ifndef AMB_BENCH_SHOWN_H
#define AMB_BENCH_SHOWN_H

#include "bench/bench.h"

#include <ambiance/scene.h>

enum { SHOWN_MAX_ISAS = 3 };

typedef struct shown {
    const char *name;
    double time; /* seconds into the scene */
    int width, height;
    void *params; /* the scene's, with defaults; may be changed before the first run */
    amb_frame *frame;
    amb_context *loader; /* the widest */
    amb_assets *assets;
    struct {
        const amb_scene *scene;
        void *state;
    } loaded[SHOWN_MAX_ISAS];
    int loaded_count;
} shown;

amb_status shown_open(const char *name, double time, const bench_options *options, shown *out, amb_error *error);
void shown_close(shown *s);
/* The scene's state for a context's instruction set, loaded when there is none yet. */
amb_status shown_load(shown *s, const amb_context *context, const amb_scene **scene, void **state, amb_error *error);
/* A frame; stats may be NULL. */
amb_status shown_run(shown *s, const amb_context *context, amb_pass_stats *stats, amb_error *error);
/* RMSE of the last frame's colours and the peer's. */
amb_status shown_difference(const shown *s, const gl_target *target, double *rmse, amb_error *error);

#endif
