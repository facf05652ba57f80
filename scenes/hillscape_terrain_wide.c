/* Scene hillscape: the hills. Hull: the report's factor; domain: the height map; fragment: ground textures blended by
 * slope and height, lights, haze. */
#include "scenes/hillscape_shade.h"

/* ---- tessellation -------------------------------------------------------------------------------------------------
 */

static v3x on_ground(const hill_frame *f, v2x place)
{
    return (v3x){place.x, hill_ground(f, place, f_set(4.0f)), place.y};
}

/* Edges from their own midpoints, so that two patches agree about the edge they share. */
static void terrain_hull(const amb_hs_in *in, amb_hs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    v2x c[4];
    for (int i = 0; i < 4; i++)
        c[i] = v2x_gather(f->state->corner, in->corner[i]);
    float most = amb_s_min(f->p.tess_max, pass->tess_limit), least = amb_s_min(f->p.tess_min, most);
    static const int ends[4][2] = {{0, 3}, {0, 1}, {1, 2}, {3, 2}}; /* u = 0, v = 0, u = 1, v = 1 */
    for (int i = 0; i < 4; i++) {
        v2x middle = v2x_scale(v2x_add(c[ends[i][0]], c[ends[i][1]]), f_set(0.5f));
        out->edge[i] = hill_tessellation(f->camera.position, on_ground(f, middle), least, most);
    }
    v2x centre = v2x_scale(v2x_add(c[0], c[2]), f_set(0.5f));
    out->inside[0] = out->inside[1] = hill_tessellation(f->camera.position, on_ground(f, centre), least, most);
    v2x bounds = v2x_gather(f->state->bounds, in->corner[0]);
    v3x low = {c[0].x, (bounds.x - HILL_SEA) * f->p.relief, c[0].y};
    v3x high = {c[2].x, (bounds.y - HILL_SEA) * f->p.relief, c[2].y};
    maskx seen = hill_box_seen(pass, low, high);
    if (pass->upside_down)
        seen = seen & (high.y > 0.0f);
    out->edge[0] = f_sel(seen, out->edge[0], f_set(0.0f));
}

typedef struct terrain_varyings {
    v3x world;
    f32x factor; /* the tessellation's, to be looked at */
} terrain_varyings;

/* Heights from the level whose texels are as wide as a quad may be there: a function of the place and the eye alone, so
 * that patches meet. */
static void terrain_domain(const amb_ds_in *in, amb_vs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    terrain_varyings *v = out->varyings;
    v2x from = v2x_gather(f->state->corner, in->corner[0]), to = v2x_gather(f->state->corner, in->corner[2]);
    v2x place = {f_lerp(from.x, to.x, in->u), f_lerp(from.y, to.y, in->v)};
    f32x dx = place.x - f->camera.position.x, dz = place.y - f->camera.position.z;
    f32x distance = f_sqrt(dx * dx + dz * dz);
    f32x lod = f_clamp(distance * (1.0f / 250.0f) - 1.0f, f_set(0.0f), f_set(2.0f));
    v->world = (v3x){place.x, hill_ground(f, place, lod), place.y};
    v->factor = hill_tessellation(f->camera.position, v->world, f->p.tess_min, f->p.tess_max);
    out->clip = m4_project_x(pass->world_to_clip, v->world);
}

/* ---- ground -------------------------------------------------------------------------------------------------------
 */

/* Shares of the materials by height, slope and chance; they sum to 1. */
static void ground_weights(const hill_frame *f, f32x y, f32x up, v4x noise, f32x *weight)
{
    f32x rough = noise.x - 0.5f, broad = noise.y - 0.5f, one = f_set(1.0f);
    f32x rock = f_smoothstep(f_set(0.80f), f_set(0.62f), up + rough * 0.22f + broad * 0.10f);
    f32x sand = f_smoothstep(f_set(2.6f), f_set(0.9f), y + rough * 3.2f);
    f32x snow = f_smoothstep(f_set(-9.0f), f_set(9.0f), y - f->p.snow_line + rough * 60.0f + broad * 50.0f);
    snow = snow * f_smoothstep(f_set(0.58f), f_set(0.74f), up + rough * 0.15f);
    weight[GROUND_SNOW] = snow;
    weight[GROUND_ROCK] = (one - snow) * rock;
    f32x rest = (one - snow) * (one - rock);
    weight[GROUND_SAND] = rest * sand;
    weight[GROUND_GRASS] = rest * (one - sand);
}

/* A material on a plane at two sizes: the fine one near, the coarse one (turned, so that the two never agree) far away,
 * so that no tile repeats to the eye. */
static material_point plane_at(const amb_material *m, v2x place, v2x px, v2x py, v3 along_u, v3 along_v, f32x far)
{
    const float a = 0.1413f, b = 0.1037f; /* 1/5.7 as large, turned by 36° */
    v2x wide = {place.x * a + place.y * b, place.y * a - place.x * b};
    v2x wx = {px.x * a + px.y * b, px.y * a - px.x * b}, wy = {py.x * a + py.y * b, py.y * a - py.x * b};
    material_point sum = material_none(), coarse = material_far(m, wide, wx, wy);
    f32x share = 1.0f - 0.65f * (1.0f - far);
    material_add(&sum, &coarse, share);
    if (m_any(share < 1.0f)) {
        material_point fine = material_at(m, place, px, py, along_u, along_v);
        material_add(&sum, &fine, 1.0f - share);
    }
    return sum;
}

/* Rock on the two upright planes, weighted by where the ground faces. */
static material_point rock_at(const amb_material *rock, const hill_surface *s, v3x dx, v3x dy, f32x far)
{
    f32x ax = s->smooth.x * s->smooth.x, az = s->smooth.z * s->smooth.z, total = f_max(ax + az, f_set(1.0e-12f));
    material_point sum = material_none();
    f32x wx = f_smoothstep(f_set(0.3f), f_set(0.7f), ax / total);
    if (m_any(wx > 0.0f)) {
        material_point a = plane_at(rock, (v2x){s->world.z, s->world.y}, (v2x){dx.z, dx.y}, (v2x){dy.z, dy.y},
                                    (v3){0, 0, 1}, (v3){0, 1, 0}, far);
        material_add(&sum, &a, wx);
    }
    if (m_any(wx < 1.0f)) {
        material_point b = plane_at(rock, (v2x){s->world.x, s->world.y}, (v2x){dx.x, dx.y}, (v2x){dy.x, dy.y},
                                    (v3){1, 0, 0}, (v3){0, 1, 0}, far);
        material_add(&sum, &b, 1.0f - wx);
    }
    return sum;
}

static material_point level_at(const amb_material *m, const hill_surface *s, v3x dx, v3x dy, f32x far)
{
    return plane_at(m, (v2x){s->world.x, s->world.z}, (v2x){dx.x, dx.z}, (v2x){dy.x, dy.z}, (v3){1, 0, 0},
                    (v3){0, 0, 1}, far);
}

/* The blend at the surface; weights are sharpened by the reliefs' heights: grass grows from the hollows of rock, sand
 * lies in them. */
static material_point ground_at(const hill_frame *f, const hill_surface *s, f32x *weight, f32x far)
{
    v3x dx = {f_ddx(s->world.x), f_ddx(s->world.y), f_ddx(s->world.z)};
    v3x dy = {f_ddy(s->world.x), f_ddy(s->world.y), f_ddy(s->world.z)};
    material_point m[GROUND_COUNT];
    f32x total = f_set(1.0e-6f), zero = f_set(0.0f);
    for (int i = 0; i < GROUND_COUNT; i++) {
        m[i] = material_none();
        if (!m_any(weight[i] > 0.0f))
            continue;
        m[i] = i == GROUND_ROCK ? rock_at(&f->state->ground[i], s, dx, dy, far)
                                : level_at(&f->state->ground[i], s, dx, dy, far);
        f32x sharp = weight[i] * (0.25f + 1.5f * m[i].height) * weight[i];
        weight[i] = f_sel(weight[i] > 0.0f, sharp, zero);
        total += weight[i];
    }
    material_point sum = material_none();
    for (int i = 0; i < GROUND_COUNT; i++) {
        weight[i] /= total;
        material_add(&sum, &m[i], weight[i]);
    }
    return sum;
}

/* ---- fragment -----------------------------------------------------------------------------------------------------
 */

static const amb_sampler slope_sampler = {
    .filter = AMB_TRILINEAR, .wrap = {AMB_CLAMP, AMB_CLAMP, AMB_CLAMP}, .max_anisotropy = 4};

/* The smooth normal from the central differences, and how much of the sky the larger forms leave. */
static void terrain_form(const hill_frame *f, hill_surface *s)
{
    v2x uv = hill_uv((v2x){s->world.x, s->world.z});
    v4x slope = amb_sample_2d(f->state->slopes, &slope_sampler, uv);
    float scale = -f->p.relief / HILL_SIZE;
    s->smooth = v3x_normalize((v3x){slope.x * scale, f_set(1.0f), slope.y * scale});
    f32x near = hill_ground(f, (v2x){s->world.x, s->world.z}, f_set(4.0f));
    f32x wide = hill_ground(f, (v2x){s->world.x, s->world.z}, f_set(6.0f));
    f32x below = f_max(near - s->world.y, f_set(0.0f)) * 0.05f + f_max(wide - s->world.y, f_set(0.0f)) * 0.013f;
    s->open = 1.0f / (1.0f + below) * (0.6f + 0.4f * s->smooth.y);
}

/* Rock from dark and bluish to light and brown, by place; on steep faces the level noise runs down them as water does.
 */
static v3x rock_tint(v4x fine, v4x broad, f32x rock)
{
    f32x tone = (fine.z - 0.5f) * 1.5f + (broad.x - 0.5f) * 1.1f, one = f_set(1.0f);
    f32x warm = f_saturate((broad.w - 0.5f) * 2.2f + (fine.y - 0.5f) * 0.8f + 0.5f);
    v3x hue = v3x_lerp(v3x_splat((v3){0.84f, 0.90f, 1.0f}), v3x_splat((v3){1.14f, 1.0f, 0.82f}), warm);
    return v3x_lerp((v3x){one, one, one}, v3x_scale(hue, f_clamp(0.92f + tone, f_set(0.35f), f_set(1.6f))), rock);
}

/* Under water light loses its red on the way down and back up; wet ground by the water is darker and glossier. */
static void wet(hill_surface *s, f32x height)
{
    f32x damp = f_smoothstep(f_set(0.9f), f_set(0.1f), height);
    s->albedo = v3x_scale(s->albedo, 1.0f - 0.45f * damp);
    s->roughness = f_lerp(s->roughness, f_set(0.28f), damp * 0.8f);
}

static void terrain_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const hill_pass *pass = in->uniforms;
    const hill_frame *f = pass->frame;
    const terrain_varyings *v = in->varyings;
    hill_surface s = hill_surface_at(pass, v->world);
    if (pass->upside_down)
        out->live = out->live & (v->world.y > -0.03f);
    terrain_form(f, &s);
    v4x fine = hill_fine_noise(f, s.world), broad = hill_broad_noise(f, s.world);
    f32x weight[GROUND_COUNT];
    ground_weights(f, s.world.y, s.smooth.y, (v4x){fine.x, broad.y, fine.z, broad.w}, weight);
    f32x far = f_smoothstep(f_set(10.0f), f_set(180.0f), s.distance);
    material_point m = ground_at(f, &s, weight, far);
    s.albedo = v3x_mul(m.albedo, hill_meadow_tint_of(fine, broad, weight[GROUND_GRASS]));
    s.albedo = v3x_mul(s.albedo, rock_tint(fine, broad, weight[GROUND_ROCK]));
    s.normal = v3x_normalize(v3x_add(s.smooth, m.bent));
    s.open *= m.open;
    s.roughness = m.roughness;
    s.f0 = m.f0;
    wet(&s, s.world.y);
    hill_light(pass, &s, in->live);
    v3x lit = hill_under_water(f, &s);
    hill_put(pass, out, HILL_WEIGHTS, (v4x){weight[0], weight[1], weight[2], weight[3]});
    hill_put(pass, out, HILL_TESSELLATION, (v4x){v->factor, v->factor, v->factor, f_set(1.0f)});
    hill_write(pass, out, &s, lit, ID_TERRAIN);
}

amb_draw hill_terrain_draw(const hill_pass *pass)
{
    const hill_frame *f = pass->frame;
    amb_draw draw = hill_draw_of(pass, "terrain");
    draw.topology = AMB_PATCHES;
    draw.tessellation = (amb_tessellation){.hull = terrain_hull,
                                           .domain = terrain_domain,
                                           .corners = 4,
                                           .shape = AMB_QUAD,
                                           .partitioning = (amb_partitioning)f->p.partitioning};
    draw.fragment = pass->depth_only ? NULL : terrain_fragment;
    draw.varying_floats = sizeof(terrain_varyings) / sizeof(f32x);
    draw.indices = f->patch;
    draw.count = 4 * HILL_PATCHES * HILL_PATCHES;
    draw.vertex_count = (HILL_PATCHES + 1) * (HILL_PATCHES + 1);
    draw.cull = AMB_CULL_NONE;
    draw.wireframe = f->p.wireframe && !pass->depth_only;
    return draw;
}

amb_status hill_draw_terrain(const hill_pass *pass, amb_pass *out, amb_error *error)
{
    amb_draw draw = hill_terrain_draw(pass);
    return pass->frame->p.terrain ? amb_pass_draw(out, &draw, error) : AMB_OK;
}
