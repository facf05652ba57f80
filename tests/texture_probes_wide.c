#include "tests/texture_probes.h"

#include <ambiance/half.h>

static f32x column(const float *first, int floats_apart)
{
    float lane[AMB_LANES];
    for (int i = 0; i < AMB_LANES; i++)
        lane[i] = first[i * floats_apart];
    return f_load(lane);
}

static v3x vector(const float *first, int floats_apart)
{
    return v3x_of(column(first, floats_apart), column(first + 1, floats_apart), column(first + 2, floats_apart));
}

static v4x sample(const amb_texture *t, const amb_sampler *s, probe_mode mode, v3x at, v3x dx, v3x dy, f32x lod,
                  i32x layer, f32x reference)
{
    f32x zero = f_set(0.0f);
    v2x uv = v2x_of(at.x, at.y), ux = v2x_of(dx.x, dx.y), uy = v2x_of(dy.x, dy.y);
    switch (mode) {
    case PROBE_2D_LOD:
        return amb_sample_2d_lod(t, s, uv, lod);
    case PROBE_2D_GRAD:
        return amb_sample_2d_grad(t, s, uv, ux, uy);
    case PROBE_3D_LOD:
        return amb_sample_3d_lod(t, s, at, lod);
    case PROBE_CUBE_LOD:
        return amb_sample_cube_lod(t, s, at, lod);
    case PROBE_CUBE_GRAD:
        return amb_sample_cube_grad(t, s, at, dx, dy);
    case PROBE_ARRAY_LOD:
        return amb_sample_2d_array_lod(t, s, uv, layer, lod);
    case PROBE_ARRAY_GRAD:
        return amb_sample_2d_array_grad(t, s, uv, layer, ux, uy);
    case PROBE_COMPARE_2D:
        return (v4x){amb_compare_2d_lod(t, s, uv, reference, lod), zero, zero, zero};
    case PROBE_COMPARE_ARRAY:
        return (v4x){amb_compare_2d_array_lod(t, s, uv, layer, reference, lod), zero, zero, zero};
    case PROBE_COMPARE_CUBE:
        return (v4x){amb_compare_cube_lod(t, s, at, reference, lod), zero, zero, zero};
#if AMB_LANES > 1
    case PROBE_2D_QUAD:
        return amb_sample_2d(t, s, uv);
    case PROBE_CUBE_QUAD:
        return amb_sample_cube(t, s, at);
    case PROBE_ARRAY_QUAD:
        return amb_sample_2d_array(t, s, uv, layer);
#else
    case PROBE_2D_QUAD:
    case PROBE_ARRAY_QUAD:
    case PROBE_CUBE_QUAD:
        break;
#endif
    }
    return v4x_splat(v4_of(0.0f, 0.0f, 0.0f, 0.0f));
}

#define probe_texture_wide WIDE(probe_texture)
void probe_texture_wide(const amb_texture *texture, const amb_sampler *sampler, probe_mode mode, const probe *in,
                        int count, float (*out)[4])
{
    const int apart = (int)(sizeof *in / sizeof(float));
    for (int i = 0; i < count; i += AMB_LANES) {
        v4x c =
            sample(texture, sampler, mode, vector(in[i].at, apart), vector(in[i].dx, apart), vector(in[i].dy, apart),
                   column(&in[i].lod, apart), f_to_i(column(&in[i].layer, apart)), column(&in[i].reference, apart));
        for (int k = 0; k < AMB_LANES; k++) {
            v4 one = v4x_lane(c, k);
            memcpy(out[i + k], &one, sizeof one);
        }
    }
}

#if AMB_LANES > 1
static void put_lanes(v4x color, float (*out)[4])
{
    for (int k = 0; k < AMB_LANES; k++) {
        v4 one = v4x_lane(color, k);
        memcpy(out[k], &one, sizeof one);
    }
}

#define probe_pair_wide WIDE(probe_pair)
void probe_pair_wide(const amb_texture *const texture[2], const amb_sampler *sampler, const probe *in, int count,
                     float (*first)[4], float (*second)[4])
{
    const int apart = (int)(sizeof *in / sizeof(float));
    for (int i = 0; i < count; i += AMB_LANES) {
        v3x at = vector(in[i].at, apart);
        v4x color[2];
        amb_sample_2d_pair(texture[0], texture[1], sampler, v2x_of(at.x, at.y), color);
        put_lanes(color[0], first + i);
        put_lanes(color[1], second + i);
    }
}
#endif

#define probe_half_wide WIDE(probe_half)
void probe_half_wide(half_op op, float *floats, uint32_t *words, int count)
{
    for (int i = 0; i < count; i += AMB_LANES) {
        u32x word;
        memcpy(&word, words + i, sizeof word);
        if (op == HALF_DECODE) {
            f_store(floats + i, half_to_f(word));
        } else if (op == HALF_ENCODE) {
            word = f_to_half(f_load(floats + i));
            memcpy(words + i, &word, sizeof word);
        } else if (op == SMALL_DECODE) {
            v3x rgb = r11g11b10_decode(word);
            for (int k = 0; k < AMB_LANES; k++) {
                floats[3 * (i + k)] = f_lane(rgb.x, k);
                floats[3 * (i + k) + 1] = f_lane(rgb.y, k);
                floats[3 * (i + k) + 2] = f_lane(rgb.z, k);
            }
        } else {
            word = r11g11b10_encode(vector(floats + 3 * i, 3));
            memcpy(words + i, &word, sizeof word);
        }
    }
}
