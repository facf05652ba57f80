/* The layers workload's shader; layers.c holds its GLSL twin. */
#include "bench/layers.h"

#define layer_shader_get WIDE(layer_shader_get)
layer_shader layer_shader_get(void);

static void fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const layer_uniforms *l = in->uniforms;
    v2x uv = {l->u.x * in->x + l->u.y * in->y + l->u.z, l->v.x * in->x + l->v.y * in->y + l->v.z};
    v4x texel = amb_sample_2d(l->texture, &l->sampler, uv);
    out->color[0] = v4x_mul(texel, v4x_splat(l->tint));
}

layer_shader layer_shader_get(void) { return (layer_shader){AMB_LANES, fragment}; }
