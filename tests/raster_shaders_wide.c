#include "tests/raster_shaders.h"

#include <math.h>

#define raster_test_shaders_get WIDE(raster_test_shaders_get)
const raster_test_shaders *raster_test_shaders_get(void);

static void vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    const v4 *base = &u->vertex->clip;
    v4x *value = out->varyings;
    f32x instance = i_to_f(in->instance);
    out->clip = v4x_add(v4x_gather(base, in->vertex * 2), v4x_scale(v4x_splat(u->offset), instance));
    *value = v4x_gather(base, in->vertex * 2 + 1);
}

static void value(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    const v4x *v = in->varyings;
    out->color[0] = *v;
#if AMB_LANES > 1
    out->color[1] = (v4x){f_ddx(v->x), f_ddy(v->x), in->x, in->y};
#endif
    out->color[2] = (v4x){i_to_f(in->primitive), f_sel(in->front, f_set(1.0f), f_set(0.0f)), in->depth, f_set(1.0f)};
    if (u->discard > 0.0f)
        out->live &= v->x >= u->discard;
}

static void one(const amb_fs_in *in, amb_fs_out *out)
{
    const v4x *v = in->varyings;
    out->color[0] = (v4x){f_set(1.0f), v->x, f_set(0.0f), f_set(1.0f)};
}

static void write_depth(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    const v4x *v = in->varyings;
    out->color[0] = *v;
    out->depth = out->depth * u->depth;
}

static void screen(const amb_fs_in *in, amb_fs_out *out)
{
    out->color[0] = (v4x){in->x, in->y, in->depth, f_set(1.0f)};
}

static f32x code(i32x primitive, int salt, int hostile)
{
    static const float value[8] = RASTER_TEST_HOSTILE;
    f32x plain = i_to_f((primitive * 37 + (salt * 11 + 5)) & 31) * 0.0390625f - 0.25f;
    if (hostile == 0)
        return plain;
    return f_sel(((primitive * 7 + salt * 3) & 7) < hostile, f_gather(value, (primitive + salt) & 7), plain);
}

static void coded(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    for (int i = 0; i < 2 || i < u->targets; i++)
        out->color[i] = (v4x){code(in->primitive, 4 * i, u->hostile), code(in->primitive, 4 * i + 1, u->hostile),
                              code(in->primitive, 4 * i + 2, u->hostile), code(in->primitive, 4 * i + 3, u->hostile)};
    if (u->holes > 0)
        out->live &= ((f_to_i(in->x) + f_to_i(in->y) * 2 + in->primitive) & 3) >= u->holes;
}

static void coded_depth(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    coded(in, out);
    out->depth = code(in->primitive, 9, u->hostile);
}

static f32x factor_of(const raster_test_uniforms *u, i32x patch, int side)
{
    static const float table[8] = RASTER_TEST_FACTORS;
    i32x pick = RASTER_TEST_FACTOR(patch, side, u->factors);
    f32x factor = f_gather(table, pick);
    return u->factors % 2 == 0 ? f_sel(pick == 7, f_set(2.0f), factor) : factor;
}

static void hull(const amb_hs_in *in, amb_hs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    f32x *zero = out->constants;
    for (int i = 0; i < 4; i++)
        out->edge[i] = factor_of(u, in->patch, i);
    for (int i = 0; i < 2; i++)
        out->inside[i] = factor_of(u, in->patch, 4 + i);
    *zero = f_set(0.0f);
}

static v4x corner_of(const amb_ds_in *in, int k)
{
    const raster_test_uniforms *u = in->uniforms;
    return v4x_add(v4x_gather(&u->vertex->clip, in->corner[k] * 2),
                   v4x_scale(v4x_splat(u->offset), i_to_f(in->instance)));
}

static void quad(const amb_ds_in *in, amb_vs_out *out)
{
    f32x u = in->u, v = in->v, left = 1.0f - u, bottom = 1.0f - v;
    out->clip = v4x_add(v4x_add(v4x_scale(corner_of(in, 0), left * bottom), v4x_scale(corner_of(in, 1), u * bottom)),
                        v4x_add(v4x_scale(corner_of(in, 2), u * v), v4x_scale(corner_of(in, 3), left * v)));
}

static void triangle(const amb_ds_in *in, amb_vs_out *out)
{
    out->clip = v4x_add(v4x_add(v4x_scale(corner_of(in, 0), in->u), v4x_scale(corner_of(in, 1), in->v)),
                        v4x_scale(corner_of(in, 2), in->w));
}

static void copy(const amb_gs_in *in, amb_gs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    v4x *value = out->varyings;
    for (int c = 0; c < u->copies; c++) {
        maskx live = in->live & (RASTER_TEST_COPIES(in->primitive) > c);
        for (int k = 0; k < u->corners; k++) {
            const v4x *corner = in->varyings[k];
            out->clip = v4x_add(in->clip[k], v4x_scale(v4x_splat(u->step), f_set((float)c)));
            *value = *corner;
            amb_emit(out, live);
        }
        amb_cut(out, live);
    }
}

static void fetch(const amb_vs_in *in, amb_vs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    v4x *value = out->varyings;
    vertex(in, out);
    *value = amb_sample_2d_lod(u->texture, &u->sampler, v2x_of(value->x, value->y), value->z);
}

static void textured(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    const v4x *v = in->varyings;
    v2x uv = v2x_of(v->x, v->y);
#if AMB_LANES > 1
    out->color[0] = amb_sample_2d(u->texture, &u->sampler, uv);
#endif
    out->color[1] = amb_sample_2d_grad(u->texture, &u->sampler, uv, v2x_splat(u->ddx), v2x_splat(u->ddy));
}

static void textured_cube(const amb_fs_in *in, amb_fs_out *out)
{
#if AMB_LANES > 1
    const raster_test_uniforms *u = in->uniforms;
    const v4x *v = in->varyings;
    out->color[0] = amb_sample_cube(u->texture, &u->sampler, v3x_of(v->x, v->y, v->z));
#else
    (void)in, (void)out;
#endif
}

static void table(const amb_fs_in *in, amb_fs_out *out)
{
    const raster_test_uniforms *u = in->uniforms;
    i32x first = (f_to_i(in->y) * u->table_width + f_to_i(in->x)) * 4;
    first = i_sel(in->live, first, i_set(0)); /* blocks reach over the target's edge */
    v4x value = {f_gather(u->table, first), f_gather(u->table, first + 1), f_gather(u->table, first + 2),
                 f_gather(u->table, first + 3)};
    for (int i = 0; i < AMB_MAX_TARGETS; i++)
        out->color[i] = value;
}

const raster_test_shaders *raster_test_shaders_get(void)
{
    static const raster_test_shaders shaders = {
        .lanes = AMB_LANES,
        .vertex = vertex,
        .copy = copy,
        .hull = hull,
        .quad = quad,
        .triangle = triangle,
        .value = value,
        .one = one,
        .write_depth = write_depth,
        .coded = coded,
        .coded_depth = coded_depth,
        .screen = screen,
        .fetch = fetch,
        .textured = textured,
        .textured_cube = textured_cube,
        .table = table,
    };
    return &shaders;
}
