/* Scene hillscape: trees and grass. A vertex is a plant; the geometry stage turns each into a quad that faces the eye,
 * or the light in its shadow map. Cover comes from the atlases' alpha. */
#include "scenes/hillscape_shade.h"

typedef struct plant_root { /* what the vertex stage knows */
    v3x foot;
    f32x size, kind, seed;
} plant_root;

typedef struct plant_varyings {
    v3x world;
    v2x uv;
    v2x right; /* the quad's horizontal axis, x and z */
    f32x seed;
} plant_varyings;

/* One corner of a quad: `across` -½…½ of its width, `up` 0…1 of its height. */
static void emit_corner(const hill_pass *pass, amb_gs_out *out, const plant_root *r, v2x right, f32x width,
                        float across, float up, v2x sway, maskx live)
{
    plant_varyings *v = out->varyings;
    v->world = (v3x){r->foot.x + right.x * width * across + sway.x * up, r->foot.y + r->size * up,
                     r->foot.z + right.y * width * across + sway.y * up};
    v->uv = (v2x){(r->kind + 0.5f + across) * 0.25f, f_set(1.0f - up)};
    v->right = right;
    v->seed = r->seed;
    out->clip = m4_project_x(pass->world_to_clip, v->world);
    amb_emit(out, live);
}

/* Across the way from the eye to the plant, level; `turn` (radians, small) turns it away from that. */
static v2x facing(const hill_pass *pass, v3x foot, f32x turn)
{
    f32x x = foot.x - pass->eye.x, z = foot.z - pass->eye.z;
    f32x scale = 1.0f / f_sqrt(f_max(x * x + z * z, f_set(1.0e-6f)));
    v2x right = {-z * scale, x * scale};
    return (v2x){right.x - right.y * turn, right.y + right.x * turn};
}

static maskx plant_seen(const hill_pass *pass, const plant_root *r, f32x width)
{
    v3x low = {r->foot.x - width, r->foot.y, r->foot.z - width};
    return hill_box_seen(pass, low, (v3x){r->foot.x + width, r->foot.y + r->size, r->foot.z + width});
}

/* ---- trees --------------------------------------------------------------------------------------------------------
 */

static void tree_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    plant_root *r = out->varyings;
    v4x plant = v4x_gather((const v4 *)(const void *)f->state->plant, in->vertex);
    v2x place = {plant.x, plant.y};
    r->foot = (v3x){place.x, hill_ground(f, place, f_set(1.0f)) - 0.25f, place.y};
    r->size = plant.z;
    r->kind = plant.w;
    r->seed = f_unit(u_hash(i_as_u(in->vertex)));
    out->clip = m4_project_x(pass->world_to_clip, r->foot);
}

static void tree_geometry(const amb_gs_in *in, amb_gs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const plant_root r = *(const plant_root *)in->varyings[0];
    f32x width = r.size * 0.5f;
    maskx live = in->live & plant_seen(pass, &r, width) & (r.foot.y > 0.0f);
    if (!m_any(live))
        return;
    v2x right = facing(pass, r.foot, f_set(0.0f));
    f32x wind = f_sin(r.seed * 6.28f + pass->frame->seconds * 1.3f) * (r.size * 0.008f);
    v2x sway = {wind, wind * 0.6f};
    emit_corner(pass, out, &r, right, width, -0.5f, 0.0f, sway, live);
    emit_corner(pass, out, &r, right, width, 0.5f, 0.0f, sway, live);
    emit_corner(pass, out, &r, right, width, -0.5f, 1.0f, sway, live);
    emit_corner(pass, out, &r, right, width, 0.5f, 1.0f, sway, live);
}

static const amb_sampler atlas_sampler = {
    .filter = AMB_TRILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}, .lod_bias = -0.4f};

/* Cover made steep about ½ over one pixel, whatever the level; smaller levels have lost some to their neighbours. */
static f32x sharpened(f32x alpha, v2x uv, float texels)
{
    f32x rate = f_max(f_abs(f_ddx(uv.y)), f_abs(f_ddy(uv.y))) * texels; /* texels a pixel */
    f32x lost = f_clamp(rate * 0.12f, f_set(0.0f), f_set(0.9f));
    f32x slope = f_max(f_abs(f_ddx(alpha)) + f_abs(f_ddy(alpha)), f_set(0.25f));
    return f_saturate((alpha * (1.0f + lost) - 0.45f) / slope + 0.5f);
}

static void plant_depth_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const plant_varyings *v = in->varyings;
    f32x alpha = amb_sample_2d(pass->frame->state->trees, &atlas_sampler, v->uv).w;
    out->live = out->live & (alpha > 0.35f);
}

static void tree_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const plant_varyings *v = in->varyings;
    v4x colour = amb_sample_2d(f->state->trees, &atlas_sampler, v->uv);
    v4x form = amb_sample_2d(f->state->tree_normals, &atlas_sampler, v->uv);
    f32x cover = sharpened(colour.w, v->uv, 512.0f);
    bool sampled = f->p.samples > 0 && !pass->color_off && !pass->upside_down;
    out->live = out->live & (cover > (sampled ? 0.0f : 0.5f));
    if (!m_any(out->live))
        return;
    hill_surface s = hill_surface_at(pass, v->world);
    v3x n = {form.x * 2.0f - 1.0f, form.y * 2.0f - 1.0f, form.z * 2.0f - 1.0f};
    v3x ahead = {-v->right.y, f_set(0.0f), v->right.x}; /* out of the picture, to the eye */
    s.normal = v3x_normalize((v3x){v->right.x * n.x + ahead.x * n.z, n.y, v->right.y * n.x + ahead.z * n.z});
    s.smooth = s.normal;
    f32x bright = 0.75f + 0.5f * v->seed, warm = f_fract(v->seed * 17.0f) - 0.5f;
    s.albedo = v3x_mul(v4x_xyz(colour), (v3x){bright * (1.0f + 0.5f * warm), bright, bright * (1.0f - 0.2f * warm)});
    s.roughness = f_set(0.55f);
    s.f0 = f_set(0.02f);
    s.open = form.w;
    s.through = f_set(0.30f);
    s.lift = f_set(2.2f);
    hill_light(pass, &s, in->live);
    s.diffuse = v3x_scale(s.diffuse, 0.35f + 0.65f * form.w);
    hill_write(pass, out, &s, hill_lit(&s), ID_TREE);
    if (!pass->color_off)
        out->color[0].w = cover;
}

static amb_draw plant_draw(const hill_pass *pass, const char *label, amb_vertex_shader vertex,
                           amb_geometry_shader shader, amb_fragment_shader fragment, uint32_t count)
{
    const hill_frame *f = pass->frame;
    amb_draw draw = hill_draw_of(pass, label);
    draw.topology = AMB_POINTS;
    draw.vertex = vertex;
    draw.geometry = (amb_geometry){
        .shader = shader, .output = AMB_TRIANGLES, .vertices = 4, .input_floats = sizeof(plant_root) / sizeof(f32x)};
    draw.fragment = fragment;
    draw.varying_floats = sizeof(plant_varyings) / sizeof(f32x);
    draw.count = count;
    draw.wireframe = f->p.wireframe && !pass->depth_only;
    draw.alpha_to_coverage = f->p.samples > 0 && !pass->depth_only && !pass->color_off && !pass->upside_down;
    return draw;
}

amb_status hill_draw_trees(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    const hill_frame *f = pass->frame;
    if (!f->p.trees || !f->state->plants)
        return AMB_OK;
    amb_draw draw = plant_draw(pass, "trees", tree_vertex, tree_geometry,
                               pass->depth_only ? plant_depth_fragment : tree_fragment, f->state->plants);
    return amb_pass_draw(out, &draw, error);
}

/* ---- grass --------------------------------------------------------------------------------------------------------
 */

enum { GRASS_SIDE = 400 };
#define GRASS_SPACING 0.27f
#define GRASS_REACH (0.5f * GRASS_SPACING * GRASS_SIDE)

/* Tuft number → a cell of the world's own grid around the eye, and what grows in it by chance. */
static void grass_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    plant_root *r = out->varyings;
    i32x row = in->vertex / GRASS_SIDE, column = in->vertex - row * GRASS_SIDE;
    v3 eye = f->camera.position;
    i32x x = column + f_to_i(f_floor(f_set(eye.x / GRASS_SPACING))) - GRASS_SIDE / 2;
    i32x z = row + f_to_i(f_floor(f_set(eye.z / GRASS_SPACING))) - GRASS_SIDE / 2;
    v4x chance = v4x_random(x, z, u_set(0u), 31u), more = v4x_random(x, z, u_set(1u), 31u);
    v2x place = {(i_to_f(x) + chance.x) * GRASS_SPACING, (i_to_f(z) + chance.y) * GRASS_SPACING};
    f32x y = hill_ground(f, place, f_set(0.0f));
    f32x east = hill_ground(f, (v2x){place.x + 1.0f, place.y}, f_set(0.0f)) - y;
    f32x south = hill_ground(f, (v2x){place.x, place.y + 1.0f}, f_set(0.0f)) - y;
    f32x dx = place.x - eye.x, dz = place.y - eye.z, distance = f_sqrt(dx * dx + dz * dz);
    f32x grown = f_smoothstep(f_set(GRASS_REACH), f_set(0.55f * GRASS_REACH), distance);
    grown = grown * f_smoothstep(f_set(2.0f), f_set(3.6f), y + chance.z) *
            f_smoothstep(f_set(1.1f), f_set(0.6f), east * east + south * south);
    grown = grown * f_smoothstep(f_set(0.0f), f_set(-25.0f), y - f->p.snow_line);
    r->foot = (v3x){place.x, y - 0.05f, place.y};
    r->size = (0.17f + 0.34f * chance.w * chance.w) * grown;
    f32x kind = f_sel(more.x < 0.50f, f_set(0.0f), f_sel(more.x < 0.80f, f_set(1.0f), f_set(2.0f)));
    r->kind = f_sel(more.y < 0.07f, f_set(3.0f), kind);
    r->seed = more.z;
    out->clip = m4_project_x(pass->world_to_clip, r->foot);
}

static void grass_geometry(const amb_gs_in *in, amb_gs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const plant_root r = *(const plant_root *)in->varyings[0];
    f32x width = r.size * 1.15f;
    maskx live = in->live & (r.size > 0.05f) & plant_seen(pass, &r, width);
    if (!m_any(live))
        return;
    v2x right = facing(pass, r.foot, r.seed - 0.5f);
    f32x gust = f_sin(r.foot.x * 0.21f + r.foot.z * 0.13f + pass->frame->seconds * 1.9f);
    f32x wind = (0.10f * gust + 0.05f * f_sin(r.seed * 40.0f + pass->frame->seconds * 4.1f)) * r.size;
    v2x sway = {wind + 0.04f, wind * 0.5f};
    emit_corner(pass, out, &r, right, width, -0.5f, 0.0f, sway, live);
    emit_corner(pass, out, &r, right, width, 0.5f, 0.0f, sway, live);
    emit_corner(pass, out, &r, right, width, -0.5f, 1.0f, sway, live);
    emit_corner(pass, out, &r, right, width, 0.5f, 1.0f, sway, live);
}

static void grass_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const plant_varyings *v = in->varyings;
    v4x colour = amb_sample_2d(f->state->blades, &atlas_sampler, v->uv);
    f32x cover = sharpened(colour.w, v->uv, 256.0f);
    bool sampled = f->p.samples > 0 && !pass->color_off;
    out->live = out->live & (cover > (sampled ? 0.0f : 0.5f));
    if (!m_any(out->live))
        return;
    hill_surface s = hill_surface_at(pass, v->world);
    f32x up = 1.0f - v->uv.y;
    v3x ahead = {-v->right.y, f_set(0.0f), v->right.x};
    s.normal = v3x_normalize((v3x){ahead.x * 0.35f, f_set(1.0f), ahead.z * 0.35f});
    s.smooth = (v3x){f_set(0.0f), f_set(1.0f), f_set(0.0f)};
    s.albedo = v3x_scale(v3x_mul(v4x_xyz(colour), hill_meadow_tint(f, v->world, f_set(1.0f))), f_set(1.35f));
    s.roughness = f_set(0.5f);
    s.f0 = f_set(0.02f);
    s.open = 0.55f + 0.45f * up;
    s.through = f_set(0.45f);
    s.lift = f_set(0.1f);
    hill_light(pass, &s, in->live);
    s.diffuse = v3x_scale(s.diffuse, 0.75f + 0.35f * up);
    hill_write(pass, out, &s, hill_lit(&s), ID_GRASS);
    if (!pass->color_off)
        out->color[0].w = cover;
}

amb_status hill_draw_grass(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    if (!pass->frame->p.grass)
        return AMB_OK;
    amb_draw draw = plant_draw(pass, "grass", grass_vertex, grass_geometry, grass_fragment, GRASS_SIDE * GRASS_SIDE);
    return amb_pass_draw(out, &draw, error);
}
