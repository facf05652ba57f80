/* Scene hillscape: its four lights and their shadow maps. */
#include "scenes/hillscape_shade.h"

static const float degree = AMB_PI / 180.0f;

/* ---- lights -------------------------------------------------------------------------------------------------------
 */

static float ground_under(const hill_frame *f, v3 place)
{
    return f_lane(hill_ground(f, (v2x){f_set(place.x), f_set(place.z)}, f_set(0.0f)), 0);
}
static v3 above_ground(const hill_frame *f, v3 place)
{
    return (v3){place.x, place.y + amb_s_max(ground_under(f, place), 0.0f), place.z}; /* or the sea */
}

static v3 sun_direction(const hill_params *p, double time)
{
    double turn = p->day > 0.0f ? time / (double)p->day * 360.0 : 0.0;
    float azimuth = hill_folded((double)p->sun_azimuth + turn, 360.0) * degree, sine, cosine, high, level;
    f32x s, c;
    f_sincos(f_set(azimuth), &s, &c);
    sine = f_lane(s, 0);
    cosine = f_lane(c, 0);
    f_sincos(f_set(p->sun_elevation * degree), &s, &c);
    high = f_lane(s, 0);
    level = f_lane(c, 0);
    return (v3){sine * level, high, -cosine * level};
}

static v3 scaled_color(v3 a, v3 b, float s) { return (v3){a.x * b.x * s, a.y * b.y * s, a.z * b.z * s}; }

static void make_sun(hill_frame *f)
{
    const hill_params *p = &f->p;
    v3 to_sun = sun_direction(p, f->time);
    f->sky = amb_sky_make(to_sun, p->turbidity);
    f->gain = 0.064f * p->exposure;
    float risen = f_lane(f_smoothstep(f_set(-0.02f), f_set(0.015f), f_set(to_sun.y)), 0);
    f->sun_seen = p->sun ? risen * 0.02f : 0.0f;
    f->light[LIGHT_SUN] = (amb_light){.kind = AMB_LIGHT_DIRECTIONAL,
                                      .rgb = scaled_color(f->sky.sun_rgb, p->sun_color, f->gain * risen),
                                      .to_light = to_sun};
    f->light_on[LIGHT_SUN] = p->sun && risen > 0.0f;
    v3 sun = f->light_on[LIGHT_SUN] ? f->light[LIGHT_SUN].rgb : (v3){0, 0, 0};
    v3 sky = v3_scale(f->sky.ambient_rgb, f->gain);
    const v3 ground = {0.105f, 0.11f, 0.07f}; /* mean albedo of what lies around */
    v3 level = v3_add(v3_scale(sun, amb_s_max(to_sun.y, 0.0f)), sky);
    f->sky_light[0] = sky;
    f->sky_light[1] = v3_add(scaled_color(level, ground, 1.0f), v3_scale(sky, 0.12f));
    v3x around = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
    for (int i = 0; i < 4; i++)
        around = v3x_add(around, sky_horizon_rgb(&f->sky, (v3x){f_set((float)(i == 0) - (float)(i == 1)), f_set(0.0f),
                                                                f_set((float)(i == 2) - (float)(i == 3))}));
    /* Of all sides; that of the direction looked in is added there. */
    f->haze_rgb = v3_add(v3_scale(v3x_lane(around, 0), 0.25f * 0.36f * f->gain), v3_scale(sky, 0.08f));
}

void hill_lights_make(hill_frame *f)
{
    const hill_params *p = &f->p;
    make_sun(f);
    float length = v3_length(p->fill_direction);
    f->light[LIGHT_FILL] = (amb_light){.kind = AMB_LIGHT_DIRECTIONAL,
                                       .rgb = v3_scale(p->fill_color, p->exposure),
                                       .to_light = v3_scale(p->fill_direction, 1.0f / amb_s_max(length, 1.0e-20f))};
    f->light_on[LIGHT_FILL] = p->fill && length > 0.0f;
    float flicker =
        1.0f + 0.13f * f_lane(f_sin(f_set(f->seconds * 11.0f)), 0) * f_lane(f_sin(f_set(f->seconds * 7.3f)), 0);
    f->light[LIGHT_POINT] = (amb_light){.kind = AMB_LIGHT_POINT,
                                        .rgb = v3_scale(p->point_color, p->exposure * flicker),
                                        .position = above_ground(f, p->point_position),
                                        .reach = p->point_reach};
    f->light_on[LIGHT_POINT] = p->point != 0;
    v3 from = above_ground(f, p->spot_position), to = above_ground(f, p->spot_target);
    v3 way = v3_sub(to, from);
    f->light[LIGHT_SPOT] = (amb_light){.kind = AMB_LIGHT_SPOT,
                                       .rgb = v3_scale(p->spot_color, p->exposure),
                                       .position = from,
                                       .reach = p->spot_reach,
                                       .axis = v3_scale(way, 1.0f / amb_s_max(v3_length(way), 1.0e-20f)),
                                       .cos_inner = f_lane(f_cos(f_set(0.75f * p->spot_angle * degree)), 0),
                                       .cos_outer = f_lane(f_cos(f_set(p->spot_angle * degree)), 0)};
    f->light_on[LIGHT_SPOT] = p->spot && v3_length(way) > 0.0f;

    f->waves = (amb_waves){.height = p->wave_height,
                           .frequency = p->wave_frequency,
                           .speed = p->wave_speed,
                           .noise = p->waves == WAVES_OF_NOISE,
                           .count = p->wave_count};
    waves_at_time(&f->waves, f->time);
    float s = f_lane(f_sin(f_set(hill_folded(f->time * (double)p->sphere_speed, 360.0) * degree)), 0);
    float c = f_lane(f_cos(f_set(hill_folded(f->time * (double)p->sphere_speed, 360.0) * degree)), 0);
    f->sphere_at = (v3){245.0f + 55.0f * s, 12.0f + 0.6f * p->sphere_radius, 130.0f - 55.0f * c};
}

/* ---- shadow maps --------------------------------------------------------------------------------------------------
 */

static v3 up_across(v3 axis) { return axis.y > 0.95f || axis.y < -0.95f ? (v3){1, 0, 0} : (v3){0, 1, 0}; }

typedef struct shadow_maker {
    const amb_scene_job *job;
    hill_frame *frame;
    hill_textures *textures;
    amb_error *error;
} shadow_maker;

/* Draws what casts shadows as depth seen through a matrix. */
static amb_status draw_depth(const shadow_maker *m, m4 world_to_clip, v3 eye, float tess_limit, bool clamp,
                             amb_texture *map, int slice)
{
    amb_pass *pass = NULL;
    amb_target target = {
        .depth_texture = {.texture = map, .slice = slice}, .clear_depth = 1.0f, .time_stages = m->job->stats != NULL};
    hill_pass view = hill_pass_make(m->frame, world_to_clip, eye, amb_texture_describe(map).height);
    view.depth_only = true;
    view.depth_clamp = clamp;
    view.tess_limit = tess_limit;
    amb_status status = amb_pass_begin(m->job->context, &target, &pass, m->error);
    if (status == AMB_OK)
        status = hill_draw_terrain(&view, pass, m->error);
    if (status == AMB_OK)
        status = hill_draw_sphere(&view, pass, m->error);
    if (status == AMB_OK)
        status = hill_draw_trees(&view, pass, m->error);
    if (status == AMB_OK)
        status = hill_pass_finish(m->job, &pass, m->error);
    amb_pass_close(&pass);
    return status;
}

/* An empty map, kept by the frame's textures. */
static amb_status new_map(const shadow_maker *m, amb_texture_kind kind, int size, amb_texture **out)
{
    amb_texture_desc desc = {.kind = kind, .texel = AMB_TEXEL_R32F, .width = size, .height = size};
    amb_status status = amb_texture_create(&desc, out, m->error);
    if (status == AMB_OK)
        m->textures->made[m->textures->count++] = *out;
    return status;
}

static amb_status make_map(const shadow_maker *m, int size, m4 world_to_clip, v3 eye, float tess_limit, bool clamp,
                           const amb_texture **out)
{
    amb_texture *map;
    amb_status status = new_map(m, AMB_TEXTURE_2D, size, &map);
    if (status == AMB_OK)
        status = draw_depth(m, world_to_clip, eye, tess_limit, clamp, map, 0);
    *out = map;
    return status;
}

/* The sphere about the part of the view between two distances. */
static void slice_sphere(const amb_camera *c, float from, float to, v3 *centre, float *radius)
{
    v3 ahead = v3_normalize(v3_sub(c->target, c->position));
    float half = f_lane(f_tan(f_set(0.5f * c->vertical_fov)), 0),
          aspect = c->view_to_clip.row[1].y / c->view_to_clip.row[0].x;
    float corner = half * half * (1.0f + aspect * aspect);
    /* On the axis, equally far from the near and the far corners, or at the far end of a wide view. */
    float middle = amb_s_min(0.5f * (from + to) * (1.0f + corner), to);
    *centre = v3_add(c->position, v3_scale(ahead, middle));
    *radius = __builtin_sqrtf((to - middle) * (to - middle) + to * to * corner);
}

/* An orthographic view along the light, moved by whole texels, so that edges keep still while the eye moves. */
static amb_status make_cascade(const shadow_maker *m, amb_shadow *s, int i, v3 to_light, v3 centre, float radius,
                               int size, float tess_limit)
{
    const float depth = 900.0f;
    m4 turn = m4_look_at((v3){0, 0, 0}, v3_neg(to_light), up_across(to_light));
    v3 at = m4_point(turn, centre);
    float texel = 2.0f * radius / (float)size;
    at.x = f_lane(f_floor(f_set(at.x / texel)), 0) * texel;
    at.y = f_lane(f_floor(f_set(at.y / texel)), 0) * texel;
    m4 clip = m4_orthographic(at.x - radius, at.x + radius, at.y - radius, at.y + radius, -at.z - depth, -at.z + depth);
    s->world_to_light[i] = m4_mul(clip, turn);
    s->texel[i] = texel;
    s->cascades = i + 1;
    return make_map(m, size, s->world_to_light[i], v3_add(centre, v3_scale(to_light, 20000.0f)), tess_limit, true,
                    &s->map[i]);
}

static amb_status make_directional(const shadow_maker *m, int light, const float *ends, int cascades, int size)
{
    hill_frame *f = m->frame;
    amb_shadow *s = &f->shadow[light];
    amb_status status = AMB_OK;
    float from = 0.0f;
    for (int i = 0; i < cascades && status == AMB_OK; i++) {
        v3 centre;
        float radius;
        slice_sphere(&f->camera, from, ends[i], &centre, &radius);
        status = make_cascade(m, s, i, f->light[light].to_light, centre, radius, size, i == 0 ? 12.0f : 6.0f);
        from = ends[i] * 0.9f;
    }
    return status;
}

static amb_status make_spot(const shadow_maker *m, int size)
{
    hill_frame *f = m->frame;
    amb_shadow *s = &f->shadow[LIGHT_SPOT];
    const amb_light *l = &f->light[LIGHT_SPOT];
    float angle = f->p.spot_angle * degree, near = amb_s_min(1.0f, 0.1f * l->reach);
    m4 view = m4_look_at(l->position, v3_add(l->position, l->axis), up_across(l->axis));
    s->world_to_light[0] = m4_mul(m4_perspective(2.0f * angle, 1.0f, near, l->reach), view);
    s->texel[0] = 2.0f * f_lane(f_tan(f_set(angle)), 0) / (float)size;
    s->position = l->position;
    s->perspective = true;
    s->cascades = 1;
    return make_map(m, size, s->world_to_light[0], l->position, 8.0f, false, &s->map[0]);
}

/* D3D's faces: seen from the middle their images are mirrored, which a negative x undoes. */
static amb_status make_cube(const shadow_maker *m, int size)
{
    static const v3 ahead[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const v3 up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
    hill_frame *f = m->frame;
    amb_shadow *s = &f->shadow[LIGHT_POINT];
    const amb_light *l = &f->light[LIGHT_POINT];
    amb_texture *cube;
    amb_status status = new_map(m, AMB_TEXTURE_CUBE, size, &cube);
    s->near = amb_s_min(0.4f, 0.1f * l->reach);
    s->far = l->reach;
    m4 lens = m4_mul(m4_scale((v3){-1, 1, 1}), m4_perspective(0.5f * AMB_PI, 1.0f, s->near, s->far));
    for (int i = 0; i < 6 && status == AMB_OK; i++) {
        m4 view = m4_look_at(l->position, v3_add(l->position, ahead[i]), up[i]);
        status = draw_depth(m, m4_mul(lens, view), l->position, 12.0f, false, cube, i);
    }
    s->cube = cube;
    s->texel[0] = 2.0f / (float)size;
    s->position = l->position;
    return status;
}

amb_status hill_shadows_make(const amb_scene_job *job, hill_frame *f, hill_textures *textures, amb_error *error)
{
    static const float sun_ends[3] = {60.0f, 240.0f, 1500.0f}, fill_ends[1] = {300.0f};
    const hill_params *p = &f->p;
    shadow_maker m = {job, f, textures, error};
    amb_status status = AMB_OK;
    int size = 64, half;
    while (size < 2 * job->height) /* small pictures need no large maps */
        size *= 2;
    size = size < p->shadow_size ? size : p->shadow_size;
    half = size / 2;
    for (int i = 0; i < HILL_LIGHTS; i++)
        f->shadow[i] = (amb_shadow){
            .taps = i == LIGHT_FILL && p->shadow_taps > 2 ? 2 : p->shadow_taps, .offset = 1.6f, .bias = 2.0e-5f};
    if (f->light_on[LIGHT_SUN] && p->sun_shadow)
        status = make_directional(&m, LIGHT_SUN, sun_ends, 3, size);
    if (status == AMB_OK && f->light_on[LIGHT_FILL] && p->fill_shadow)
        status = make_directional(&m, LIGHT_FILL, fill_ends, 1, half);
    if (status == AMB_OK && f->light_on[LIGHT_POINT] && p->point_shadow)
        status = make_cube(&m, half / 2);
    if (status == AMB_OK && f->light_on[LIGHT_SPOT] && p->spot_shadow)
        status = make_spot(&m, half);
    return status;
}
