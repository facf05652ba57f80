/* Scene lucy: what its loader makes and its shaders use. */
#ifndef AMB_SCENES_LUCY_H
#define AMB_SCENES_LUCY_H

#include <ambiance/rays.h>
#include <ambiance/scene.h>

#define LUCY_HEIGHT 2.0f      /* of every statue, world units; it stands on y = 0, its axis on x = z = 0 */
#define LUCY_DIRECTIONS 64    /* over the whole sphere: half of them count at each point */
#define LUCY_FLOOR_TEXELS 192 /* of the floor's shade map, a side */
#define LUCY_FLOOR_SIZE 3.2f  /* world units that it covers, a side */

typedef struct lucy_point { /* one a vertex */
    v3 open;                /* mean direction towards the open, unit: where the light comes from */
    float visibility;       /* cosine-weighted share of open directions, 0…1 */
} lucy_point;

typedef struct lucy_state {
    amb_mesh *mesh; /* standing, scaled; with normals */
    lucy_point *point;
    amb_rays *rays;                                    /* the mesh alone: geometry 0 */
    amb_texture *floor;                                /* R32F: visibility of the floor around the statue */
    const amb_texture *environment[2], *irradiance[2]; /* studio, outdoor; irradiance is over π */
} lucy_state;

typedef struct lucy_bake {
    const amb_rays *rays;
    const v3 *position, *normal;
    uint32_t count;
    bool above_floor; /* the floor at y = 0 closes half of the sphere, too */
    float reach;      /* world units: what is farther does not darken */
    v3 direction[LUCY_DIRECTIONS];
    lucy_point *out;
} lucy_bake;

#define LUCY_BAKE_CHUNK 4096
/* Points chunk·LUCY_BAKE_CHUNK and on, one chunk; user is a lucy_bake. */
#define lucy_bake_chunk WIDE(lucy_bake_chunk)

amb_status lucy_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error);
void lucy_unload(void *state);

#endif
