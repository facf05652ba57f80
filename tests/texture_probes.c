#include "tests/texture_probes.h"

#include <ambiance/context.h>

const int *probe_lanes(void)
{
    static int list[5];
    int count = 0;
    list[count++] = 1;
    for (int lanes = 4; lanes <= 16; lanes *= 2)
        if (amb_isa_available((amb_isa)lanes))
            list[count++] = lanes;
    list[count] = 0;
    return list;
}

void probe_texture(int lanes, const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                   int count, float (*out)[4])
{
    switch (lanes) {
    case 1:
        probe_texture_x1(texture, sampler, mode, in, count, out);
        break;
    case 4:
        probe_texture_x4(texture, sampler, mode, in, count, out);
        break;
#ifdef __x86_64__
    case 8:
        probe_texture_x8(texture, sampler, mode, in, count, out);
        break;
    case 16:
        probe_texture_x16(texture, sampler, mode, in, count, out);
        break;
#endif
    default:
        break;
    }
}

void probe_pair(int lanes, const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                float (*first)[4], float (*second)[4])
{
    if (lanes == 4)
        probe_pair_x4(texture, sampler, in, count, first, second);
#ifdef __x86_64__
    if (lanes == 8)
        probe_pair_x8(texture, sampler, in, count, first, second);
    if (lanes == 16)
        probe_pair_x16(texture, sampler, in, count, first, second);
#endif
}

void probe_half(int lanes, half_op op, float *floats, uint32_t *words, int count)
{
    switch (lanes) {
    case 1:
        probe_half_x1(op, floats, words, count);
        break;
    case 4:
        probe_half_x4(op, floats, words, count);
        break;
#ifdef __x86_64__
    case 8:
        probe_half_x8(op, floats, words, count);
        break;
    case 16:
        probe_half_x16(op, floats, words, count);
        break;
#endif
    default:
        break;
    }
}
