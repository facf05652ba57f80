/* Shaders of scene elevated; elevated_shade_wide.c. */
#ifndef AMB_SCENES_ELEVATED_SHADE_H
#define AMB_SCENES_ELEVATED_SHADE_H

#include "scenes/elevated.h"
#include "scenes/elevated_patches.h"

#include <ambiance/raster.h>

typedef struct elevated_varyings {
    v3x world;
} elevated_varyings;

#define elevated_ground_hull WIDE(elevated_ground_hull)
#define elevated_ground_domain WIDE(elevated_ground_domain)
#define elevated_ground_fragment WIDE(elevated_ground_fragment)
#define elevated_sky_fragment WIDE(elevated_sky_fragment)
void elevated_ground_hull(const amb_hs_in *in, amb_hs_out *out);
void elevated_ground_domain(const amb_ds_in *in, amb_vs_out *out);
void elevated_ground_fragment(const amb_fs_in *in, amb_fs_out *out);
void elevated_sky_fragment(const amb_fs_in *in, amb_fs_out *out);

#endif
