/* A frame: named layers of one size. Layer "color" (RGBA, linear HDR) comes first; AOVs follow. */
#ifndef AMBIANCE_FRAME_H
#define AMBIANCE_FRAME_H

#include <ambiance/image.h>

#define AMB_MAX_LAYERS 32

typedef struct amb_layer {
    char name[32];
    amb_image *image; /* owned by the frame */
} amb_layer;

typedef struct amb_metadata { /* what made the frame; strings owned by the frame */
    char scene[64];
    double time;            /* seconds */
    char *parameters;       /* "name=value" joined by spaces, every parameter; may be NULL */
    char *post;             /* the chain, as --post reads it; NULL: none */
    char assets_sha256[65]; /* digest of the asset set used; "" if none */
    char version[32];
} amb_metadata;

typedef struct amb_frame {
    int width, height;
    int layer_count;
    amb_layer layer[AMB_MAX_LAYERS];
    amb_metadata meta;
} amb_frame;

amb_status amb_frame_create(int width, int height, amb_frame **out, amb_error *error); /* with an RGBA "color" layer */
void amb_frame_close(amb_frame **frame);                                               /* frees and nulls */
/* Adds a zeroed layer; ARGUMENT on a duplicate or overlong name, LIMIT past AMB_MAX_LAYERS. */
amb_status amb_frame_add_layer(amb_frame *frame, const char *name, int channels, amb_image **out, amb_error *error);
amb_image *amb_frame_layer(const amb_frame *frame, const char *name); /* NULL when absent */

#endif
