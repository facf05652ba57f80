/* Random numbers and noise as cases. */
#include "lanes.h"
#include <ambiance/noise.h>

static const amb_lattice field = {7u, 3, -5, 1000000, -2000000000};

#define POINT2 ((v2x){in[0], in[1]})
#define POINT3 ((v3x){in[0], in[1], in[2]})
#define POINT4 ((v4x){in[0], in[1], in[2], in[3]})

AMB_INLINE void write2(noise2x n, f32x *out)
{
    out[0] = n.value, out[1] = n.slope.x, out[2] = n.slope.y, out[3] = n.xx, out[4] = n.xy, out[5] = n.yy;
}
AMB_INLINE void write3(noise3x n, f32x *out)
{
    out[0] = n.value, out[1] = n.slope.x, out[2] = n.slope.y, out[3] = n.slope.z;
}
AMB_INLINE void write4(noise4x n, f32x *out)
{
    out[0] = n.value, out[1] = n.slope.x, out[2] = n.slope.y, out[3] = n.slope.z, out[4] = n.slope.w;
}

LANES_CASE(value2, 2, 6, { write2(noise_value2(POINT2, field), out); })
LANES_CASE(gradient2, 2, 6, { write2(noise_gradient2(POINT2, field), out); })
LANES_CASE(value3, 3, 4, { write3(noise_value3(POINT3, field), out); })
LANES_CASE(gradient3, 3, 4, { write3(noise_gradient3(POINT3, field), out); })
LANES_CASE(value4, 4, 5, { write4(noise_value4(POINT4, field, false), out); })
LANES_CASE(value4_linear, 4, 5, { write4(noise_value4(POINT4, field, true), out); })
LANES_CASE(fbm_value2, 2, 6, { write2(fbm2(noise_value2, POINT2, field, (amb_fbm){5, 2.0f, 0.5f}), out); })
LANES_CASE(fbm_gradient3, 3, 4, { write3(fbm3(noise_gradient3, POINT3, field, (amb_fbm){4, 2.0f, 0.5f}), out); })
/* inputs are bit patterns */
LANES_CASE(random, 3, 4, {
    v4x r = v4x_random(f_bits(in[0]), f_bits(in[1]), i_as_u(f_bits(in[2])), 9u);
    out[0] = r.x, out[1] = r.y, out[2] = r.z, out[3] = r.w;
})
LANES_CASE(hash, 1, 1, { out[0] = f_unit(u_hash(i_as_u(f_bits(in[0])))); })

const lanes_case WIDE(lanes_noise)[] = {LANES_ENTRY(value2, 2, 6),
                                        LANES_ENTRY(gradient2, 2, 6),
                                        LANES_ENTRY(value3, 3, 4),
                                        LANES_ENTRY(gradient3, 3, 4),
                                        LANES_ENTRY(value4, 4, 5),
                                        LANES_ENTRY(value4_linear, 4, 5),
                                        LANES_ENTRY(fbm_value2, 2, 6),
                                        LANES_ENTRY(fbm_gradient3, 3, 4),
                                        LANES_ENTRY(random, 3, 4),
                                        LANES_ENTRY(hash, 1, 1),
                                        {0}};
