#include "tests/stage_shaders.h"

#define stage_test_shaders_get WIDE(stage_test_shaders_get)
const stage_test_shaders *stage_test_shaders_get(void);

typedef struct patch {
    v4x corner[4];
} patch;

static void vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const stage_test_uniforms *u = in->uniforms;
    v4x *varying = out->varyings;
    out->clip = v4x_gather(u->clip, in->vertex);
    *varying = v4x_of(i_to_f(in->vertex), i_to_f(in->instance), f_set(0.0f), f_set(1.0f));
}

static void hull(const amb_hs_in *in, amb_hs_out *out)
{
    const stage_test_uniforms *u = in->uniforms;
    patch *p = out->constants;
    for (int i = 0; i < 4; i++) {
        p->corner[i] = v4x_gather(u->clip, in->corner[i < u->corners ? i : 0]);
        out->edge[i] = f_gather(u->factor, in->patch * 6 + i);
    }
    out->inside[0] = f_gather(u->factor, in->patch * 6 + 4);
    out->inside[1] = f_gather(u->factor, in->patch * 6 + 5);
}

/* The two products that an edge leaves are added the same way from either side, and the others are zeros. */
static void quad(const amb_ds_in *in, amb_vs_out *out)
{
    const patch *p = in->constants;
    v4x *varying = out->varyings;
    f32x u = in->u, v = in->v, left = 1.0f - u, bottom = 1.0f - v;
    out->clip = v4x_add(v4x_add(v4x_scale(p->corner[0], left * bottom), v4x_scale(p->corner[1], u * bottom)),
                        v4x_add(v4x_scale(p->corner[2], u * v), v4x_scale(p->corner[3], left * v)));
    *varying = v4x_of(u, v, i_to_f(in->patch), i_to_f(in->instance));
}

static void triangle(const amb_ds_in *in, amb_vs_out *out)
{
    const patch *p = in->constants;
    v4x *varying = out->varyings;
    out->clip = v4x_add(v4x_add(v4x_scale(p->corner[0], in->u), v4x_scale(p->corner[1], in->v)),
                        v4x_scale(p->corner[2], in->w));
    *varying = v4x_of(in->u, in->v, i_to_f(in->patch), i_to_f(in->instance));
}

static void emit_corner(const amb_gs_in *in, amb_gs_out *out, int corner)
{
    v4x *varying = out->varyings;
    const v4x *from = in->varyings[corner];
    out->clip = in->clip[corner];
    *varying = *from;
    amb_emit(out, in->live);
}

static void same(const amb_gs_in *in, amb_gs_out *out)
{
    for (int i = 0; i < 3; i++)
        emit_corner(in, out, i);
}

static void cull(const amb_gs_in *in, amb_gs_out *out)
{
    amb_gs_in kept = *in;
    i32x third = f_to_i(i_to_f(in->primitive) * (1.0f / 3.0f) + 0.1f);
    kept.live &= in->primitive - third * 3 != 1;
    for (int i = 0; i < 3; i++)
        emit_corner(&kept, out, i);
}

static void billboard(const amb_gs_in *in, amb_gs_out *out)
{
    const stage_test_uniforms *u = in->uniforms;
    v4x *varying = out->varyings;
    const v4x *from = in->varyings[0];
    for (int i = 0; i < 4; i++) {
        out->clip = in->clip[0];
        out->clip.x += (i & 1 ? u->size.x : -u->size.x);
        out->clip.y += (i & 2 ? u->size.y : -u->size.y);
        *varying = *from;
        varying->y = f_set((float)i);
        amb_emit(out, in->live);
    }
}

static void amplify(const amb_gs_in *in, amb_gs_out *out)
{
    const stage_test_uniforms *u = in->uniforms;
    v4x *varying = out->varyings;
    const v4x *from = in->varyings[0];
    i32x most = u->emitted - (in->primitive - f_to_i(i_to_f(in->primitive) * (1.0f / 7.0f) + 0.01f) * 7);
    for (int i = 0; i < u->emitted; i++) {
        out->clip = in->clip[0];
        out->clip.x += u->size.x * (float)i;
        out->clip.y += i & 1 ? u->size.y : 0.0f;
        *varying = *from;
        varying->y = f_set((float)i);
        amb_emit(out, in->live & (i < most));
    }
}

static void cuts(const amb_gs_in *in, amb_gs_out *out)
{
    const stage_test_uniforms *u = in->uniforms;
    v4x *varying = out->varyings;
    const v4x *from = in->varyings[0];
    i32x length = i_set(0), most = in->primitive - f_to_i(i_to_f(in->primitive) * 0.2f + 0.1f) * 5 + 1; /* 1…5 */
    for (int i = 0; i < 16; i++) {
        out->clip = in->clip[0];
        out->clip.x += u->size.x * (float)i;
        out->clip.y += i & 1 ? u->size.y : 0.0f;
        *varying = *from;
        varying->y = f_set((float)i);
        amb_emit(out, in->live);
        length += 1;
        maskx full = length == most;
        amb_cut(out, full & in->live);
        length = i_sel(full, i_set(0), length);
        most = i_sel(full, i_sel(most == STAGE_TEST_STRIP_LENGTH, i_set(1), most + 1), most);
    }
}

static void covered(const amb_fs_in *in, amb_fs_out *out)
{
    out->color[0] = v4x_of(f_sel(in->front, f_set(1.0f), f_set(-1.0f)), f_set(1.0f), f_set(0.0f), f_set(1.0f));
}

static void shade(const amb_fs_in *in, amb_fs_out *out)
{
    const v4x *v = in->varyings;
    out->color[0] = v4x_of(v->x, v->y, v->z, f_set(0.5f));
}

static void number(const amb_fs_in *in, amb_fs_out *out)
{
    const v4x *v = in->varyings;
    out->color[0] = v4x_of(v->x, v->y, i_to_f(in->primitive), v->z);
}

const stage_test_shaders *stage_test_shaders_get(void)
{
    static const stage_test_shaders shaders = {AMB_LANES, vertex,  hull, quad,    triangle, same,  cull,
                                               billboard, amplify, cuts, covered, shade,    number};
    return &shaders;
}
