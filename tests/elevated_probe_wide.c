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

const elevated_probe *elevated_probe_get(void)
{
    static const elevated_probe probe = {.lanes = AMB_LANES,
                                         .varying_floats = sizeof(elevated_varyings) / sizeof(f32x),
                                         .hull = elevated_ground_hull,
                                         .careless_hull = careless_hull,
                                         .domain = elevated_ground_domain,
                                         .signed_cover = signed_cover};
    return &probe;
}
#endif
