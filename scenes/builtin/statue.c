#include "scenes/builtin/statue.h"

#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"

#include <ambiance/isosurface.h>

AMB_DECLARE_WIDE(void, amb_statue_desc, (amb_isosurface_desc * desc));

typedef struct bone {
    v2 a, b, c;
} bone; /* of the wing, in its plane, as in statue_wings_wide.c */
static const bone inner_bone = {{-0.01f, -0.03f}, {0.015f, 0.19f}, {0.15f, 0.265f}};
static const bone outer_bone = {{0.15f, 0.265f}, {0.245f, 0.32f}, {0.315f, 0.215f}};

static v2 bone_point(const bone *on, float t)
{
    float s = 1.0f - t;
    return v2_add(v2_add(v2_scale(on->a, s * s), v2_scale(on->b, 2.0f * s * t)), v2_scale(on->c, t * t));
}

/* Along the whole arm: 0 shoulder … 1 wrist … 2 finger. */
static v2 arm_point(float t) { return t < 1.0f ? bone_point(&inner_bone, t) : bone_point(&outer_bone, t - 1.0f); }

/* One row: feathers from arm position t0 to t1, their direction (radians from straight down, outwards positive),
 * length, half width and height running linearly. `setback` moves the quills down from the bone. */
typedef struct row {
    int count;
    float t0, t1, angle0, angle1, length0, length1, half0, half1, height, setback0, setback1, tilt, pointed;
} row;

static void add_row(statue_model *model, const row *r)
{
    for (int i = 0; i < r->count; i++) {
        float s = (float)i / (float)(r->count - 1);
        float angle = r->angle0 + (r->angle1 - r->angle0) * s;
        v2 at = arm_point(r->t0 + (r->t1 - r->t0) * s), along = {amb_sin(angle), -amb_cos(angle)};
        at = v2_add(at, v2_scale(along, r->setback0 + (r->setback1 - r->setback0) * s));
        float outer = 1.0f - s, length = r->length0 + (r->length1 - r->length0) * s;
        if (r->t0 > 1.0f) /* the hand's feathers: the outermost are shorter, which rounds the wing */
            length *= 1.0f - 0.11f * outer * outer * outer * outer;
        statue_feather *f = &model->feather[model->feather_count++];
        float half = r->half0 + (r->half1 - r->half0) * s;
        *f = (statue_feather){.u = at.x,
                              .v = at.y,
                              .along_u = along.x,
                              .along_v = along.y,
                              .length = length,
                              .root = half * 0.8f,
                              .tip = half * r->pointed,
                              .bulge = half * 1.2f,
                              .height = r->height + 0.0003f * (float)(i & 1),
                              .tilt = r->tilt};
        f->bend = -(0.05f + 0.05f * s) * f->length;
        f->length -= f->tip;
        float widest = half * 1.5f + (f->bend < 0.0f ? -f->bend : f->bend);
        f->center_u = f->u + f->along_u * f->length * 0.5f;
        f->center_v = f->v + f->along_v * f->length * 0.5f;
        f->reach = f->length * 0.5f + widest + 0.01f;
    }
}

void statue_model_make(statue_model *model)
{
    /* count, from, to, angles, lengths, half widths, height, setbacks, tilt, pointed */
    static const row rows[] = {
        {9, 1.95f, 1.04f, 0.46f, 0.13f, 0.66f, 0.62f, 0.0225f, 0.0265f, 0.004f, 0.0f, 0.0f, -0.16f, 0.45f},
        {8, 0.96f, 0.16f, 0.10f, -0.07f, 0.585f, 0.38f, 0.0265f, 0.024f, 0.004f, 0.0f, 0.0f, -0.16f, 0.8f},
        {9, 1.95f, 1.02f, 0.46f, 0.15f, 0.36f, 0.34f, 0.0195f, 0.0225f, 0.0105f, 0.0f, 0.0f, -0.18f, 0.75f},
        {8, 0.94f, 0.14f, 0.13f, -0.07f, 0.325f, 0.22f, 0.0225f, 0.0215f, 0.0105f, 0.0f, 0.0f, -0.18f, 0.85f},
        {10, 1.96f, 1.03f, 0.46f, 0.19f, 0.215f, 0.205f, 0.0165f, 0.0185f, 0.0155f, 0.0f, 0.0f, -0.18f, 0.9f},
        {9, 0.95f, 0.10f, 0.17f, -0.05f, 0.20f, 0.15f, 0.0185f, 0.0185f, 0.016f, 0.0f, 0.0f, -0.18f, 0.95f},
        {11, 1.97f, 1.03f, 0.48f, 0.24f, 0.125f, 0.125f, 0.013f, 0.0150f, 0.0195f, -0.004f, -0.004f, -0.18f, 0.95f},
        {11, 0.97f, 0.07f, 0.22f, 0.0f, 0.125f, 0.10f, 0.015f, 0.0155f, 0.0205f, -0.004f, 0.0f, -0.18f, 0.95f},
        {13, 1.96f, 1.02f, 0.55f, 0.3f, 0.062f, 0.066f, 0.0105f, 0.0125f, 0.0225f, -0.012f, -0.012f, -0.18f, 1.0f},
        {13, 0.98f, 0.05f, 0.28f, 0.05f, 0.066f, 0.058f, 0.0125f, 0.013f, 0.0245f, -0.012f, -0.008f, -0.18f, 1.0f},
    };
    model->feather_count = 0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        add_row(model, &rows[i]);
}

amb_status amb_builtin_statue(const amb_context *context, amb_mesh **out, amb_error *error)
{
    statue_model model;
    statue_model_make(&model);
    amb_isosurface_desc desc = {
        .user = &model, .lo = {-0.72f, -0.15f, -0.56f}, .hi = {0.72f, 1.35f, 0.28f}, .cell = 0.003f, .lipschitz = 2.5f};
    AMB_DISPATCH(amb_context_isa(context), amb_statue_desc)(&desc);
    return amb_isosurface(context, &desc, out, error);
}
