/* Looks at the hills' tessellation from a test, at every instruction set. */
#ifndef AMB_TESTS_HILLSCAPE_PROBE_H
#define AMB_TESTS_HILLSCAPE_PROBE_H

#include "core/dispatch.h"
#include "scenes/hillscape.h"

#include <ambiance/rays.h>

typedef struct hill_probe {
    const amb_context *context;
    const hill_state *state;
    const hill_params *params;
    v3 eye;
    bool own_edges; /* every patch from its own centre, as the report does: it must tear */
    float lean;     /* of the view: x and z of a point move by this share of its y */
    v3 centre;
    float half;       /* of the square that is seen, m */
    amb_image *count; /* front faces less back faces over each pixel */
    float *edge;      /* 4 · HILL_PATCHES²: edge factors; 0: culled */
} hill_probe;

AMB_DECLARE_WIDE(amb_status, hill_probe_cover, (const hill_probe *probe, amb_error *error));
AMB_DECLARE_WIDE(void, hill_probe_edges, (const hill_probe *probe));
/* Is anything in the way? */
AMB_DECLARE_WIDE(bool, hill_probe_hidden, (const amb_rays *rays, v3 from, v3 way, float far));

#endif
