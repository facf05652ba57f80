#include "tests/elevated_probe.h"

#include "scenes/elevated_shade.h"

#if AMB_LANES > 1
#define elevated_probe_get WIDE(elevated_probe_get)
const elevated_probe *elevated_probe_get(void);

static void careless_hull(const amb_hs_in *in, amb_hs_out *out)
{
    elevated_ground_hull(in, out);
    maskx odd = (in->patch & 1) != 0;
    for (int i = 0; i < 4; i++)
        out->edge[i] = f_sel(odd, f_min(out->edge[i] * 2.0f, f_set(64.0f)), out->edge[i]);
}

static void signed_cover(const amb_fs_in *in, amb_fs_out *out)
{
    f32x sign = f_sel(in->front, f_set(1.0f), f_set(-1.0f));
    out->color[0] = (v4x){sign, sign, sign, sign};
}

static void heights(const elevated_uniforms *uniforms, const float *x, const float *z, float *y, int count)
{
    i32x patch = i_set(PATCH_ORIGIN | PATCH_ORIGIN << 12), none = i_set(0); /* level 0, at the origin */
    for (int i = 0; i < count; i += AMB_LANES) {
        elevated_varyings v;
        amb_ds_in in = {.uniforms = uniforms,
                        .corner = &patch,
                        .patch = none,
                        .instance = none,
                        .u = f_load(x + i) * (1.0f / PATCH_SIDE),
                        .v = f_load(z + i) * (1.0f / PATCH_SIDE)};
        amb_vs_out out = {.varyings = &v};
        elevated_ground_domain(&in, &out);
        f_store(y + i, v.world.y);
    }
}

const elevated_probe *elevated_probe_get(void)
{
    static const elevated_probe probe = {.lanes = AMB_LANES,
                                         .varying_floats = sizeof(elevated_varyings) / sizeof(f32x),
                                         .hull = elevated_ground_hull,
                                         .careless_hull = careless_hull,
                                         .domain = elevated_ground_domain,
                                         .signed_cover = signed_cover,
                                         .heights = heights};
    return &probe;
}
#endif
