/* Lanes shaders of scene lucy: what the frame hands them, and what goes from vertex to fragment. */
#ifndef AMB_SCENES_LUCY_SHADE_H
#define AMB_SCENES_LUCY_SHADE_H

#include "scenes/lucy.h"

#include <ambiance/raster.h>

typedef struct lucy_material {
    v3 albedo, f0;      /* diffuse albedo; reflectance facing the surface */
    v3 hollow;          /* albedo that gathers where the surface is hidden: dust, patina */
    float hollow_share; /* 0…1, there */
    float blur;         /* cube map level of its reflections */
} lucy_material;

/* Outputs besides colour, in the order of lucy_aovs. */
enum {
    OUT_POSITION,
    OUT_NORMAL,
    OUT_ALBEDO,
    OUT_ID,
    OUT_AMBIENT,
    OUT_REFLECTION,
    OUT_FRESNEL,
    OUT_KEY,
    OUT_DEPTH,
    OUT_COUNT
};

typedef struct lucy_uniforms {
    const lucy_state *state;
    const amb_texture *environment, *irradiance;
    m4 world_to_clip;
    v3 eye, view_origin, view_dx, view_dy; /* primary rays of window coordinates */
    v2 turn, light_turn;                   /* cosine and sine */
    lucy_material material;
    float reflectivity, fresnel_power, blur, occlusion, fade_near, fade_far;
    v3 key_rgb, to_key, key_side, key_up; /* diffuse radiance of white facing it; direction, and axes of its disc */
    int key_rays;
    v3 backdrop, forward; /* forward: the middle of the view */
    bool interreflection, use_backdrop;
    int slot[OUT_COUNT]; /* attachment of each output, or 0 */
} lucy_uniforms;

typedef struct lucy_statue_varyings {
    v3x position, normal, open;
    f32x visibility;
} lucy_statue_varyings;

typedef struct lucy_floor_varyings {
    f32x x, z;
} lucy_floor_varyings;

#define lucy_statue_vertex WIDE(lucy_statue_vertex)
void lucy_statue_vertex(const amb_vs_in *in, amb_vs_out *out);
#define lucy_statue_fragment WIDE(lucy_statue_fragment)
void lucy_statue_fragment(const amb_fs_in *in, amb_fs_out *out);
#define lucy_floor_vertex WIDE(lucy_floor_vertex) /* 6 vertices, not indexed */
void lucy_floor_vertex(const amb_vs_in *in, amb_vs_out *out);
#define lucy_floor_fragment WIDE(lucy_floor_fragment)
void lucy_floor_fragment(const amb_fs_in *in, amb_fs_out *out);
#define lucy_background_fragment WIDE(lucy_background_fragment)
void lucy_background_fragment(const amb_fs_in *in, amb_fs_out *out);

#endif
