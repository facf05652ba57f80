/* Mercury: a cratered sphere under DOT3 bump mapping and contrasted wrapped diffuse, before the stars (Ambiance report,
 * "Mercury", figs. 1 to 6). World units: the planet's radius is 1 and its centre the origin. */
#include "shade/diffuse.h"
#include "shade/normal_map.h"

#include <ambiance/math.h>
#include <ambiance/normal_map.h>
#include <ambiance/raster.h>
#include <ambiance/scene.h>
#include <stdlib.h>

/* ---- parameters ------------------------------------------------------------------------------------------------- */

enum { SHOW_BEAUTY, SHOW_ALBEDO, SHOW_DIFFUSE, SHOW_NORMALS, SHOW_BUMP };
static const char *const show_names[] = {"beauty", "albedo", "diffuse", "normals", "bump", NULL};

typedef struct mercury_params {
    float wrap, contrast, bump, albedo, exposure, sun_light, sun_size, star_light, ambient;
    float rotation, tilt, fov, twilight;
    v3 sun_direction, tint;
    int show, stars, planet, anisotropy;
} mercury_params;

#define FIELD(name) offsetof(mercury_params, name)
static const amb_param mercury_table[] = {
    {"wrap",
     AMB_PARAM_FLOAT,
     "",
     0.0f,
     1.0f,
     {0.12f},
     NULL,
     FIELD(wrap),
     "wrapped diffuse: light reaches this far (as a cosine) past the terminator"},
    {"contrast",
     AMB_PARAM_FLOAT,
     "",
     0.05f,
     4.0f,
     {0.47f},
     NULL,
     FIELD(contrast),
     "power k of the contrasted wrapped diffuse; below 1 evens the lit side"},
    {"bump",
     AMB_PARAM_FLOAT,
     "",
     0.0f,
     8.0f,
     {1.0f},
     NULL,
     FIELD(bump),
     "strength of the normal map's slopes; 0 is a smooth sphere"},
    {"twilight",
     AMB_PARAM_FLOAT,
     "",
     0.01f,
     1.0f,
     {0.22f},
     NULL,
     FIELD(twilight),
     "how far (as a cosine) beyond the terminator raised ground still catches light"},
    {"albedo", AMB_PARAM_FLOAT, "", 0.0f, 4.0f, {1.0f}, NULL, FIELD(albedo), "factor of the colour map"},
    {"tint", AMB_PARAM_COLOR, "", 0.0f, 4.0f, {1.0f, 1.0f, 1.0f}, NULL, FIELD(tint), "colour of the sunlight"},
    {"sun_direction",
     AMB_PARAM_VEC3,
     "",
     -1.0f,
     1.0f,
     {-0.78f, 0.16f, 0.60f},
     NULL,
     FIELD(sun_direction),
     "toward the sun, world axes; any length but 0"},
    {"sun_light",
     AMB_PARAM_FLOAT,
     "",
     0.0f,
     100.0f,
     {3.5f},
     NULL,
     FIELD(sun_light),
     "radiance of a white surface that faces the sun"},
    {"sun_size",
     AMB_PARAM_FLOAT,
     "degrees",
     0.0f,
     20.0f,
     {0.69f},
     NULL,
     FIELD(sun_size),
     "radius of the sun's disc; 0.69 is what Mercury sees on average"},
    {"ambient", AMB_PARAM_FLOAT, "", 0.0f, 1.0f, {0.0015f}, NULL, FIELD(ambient), "light of stars on the night side"},
    {"star_light", AMB_PARAM_FLOAT, "", 0.0f, 100.0f, {1.6f}, NULL, FIELD(star_light), "factor of the star map"},
    {"exposure",
     AMB_PARAM_FLOAT,
     "stops",
     -16.0f,
     16.0f,
     {0.0f},
     NULL,
     FIELD(exposure),
     "scales all light by 2^exposure"},
    {"rotation",
     AMB_PARAM_FLOAT,
     "degrees/s",
     -90.0f,
     90.0f,
     {0.9f},
     NULL,
     FIELD(rotation),
     "the planet turns about its axis"},
    {"tilt",
     AMB_PARAM_FLOAT,
     "degrees",
     -180.0f,
     180.0f,
     {205.0f - 180.0f},
     NULL,
     FIELD(tilt),
     "longitude that faces +x at time 0"},
    {"fov", AMB_PARAM_FLOAT, "degrees", 5.0f, 120.0f, {36.0f}, NULL, FIELD(fov), "vertical field of view"},
    {"anisotropy",
     AMB_PARAM_INT,
     "",
     1.0f,
     16.0f,
     {8.0f},
     NULL,
     FIELD(anisotropy),
     "most texture taps a pixel, toward the limb"},
    {"show",
     AMB_PARAM_CHOICE,
     "",
     0.0f,
     0.0f,
     {SHOW_BEAUTY},
     show_names,
     FIELD(show),
     "what the picture shows: all of it, or one component"},
    {"planet", AMB_PARAM_BOOL, "", 0.0f, 1.0f, {1.0f}, NULL, FIELD(planet), "draw the planet"},
    {"stars", AMB_PARAM_BOOL, "", 0.0f, 1.0f, {1.0f}, NULL, FIELD(stars), "draw the stars and the sun"},
};

enum { AOV_POSITION, AOV_NORMAL, AOV_ALBEDO, AOV_ID, AOV_DIFFUSE, AOV_BUMP, AOV_COUNT }; /* depth is no attachment */
static const amb_aov mercury_aovs[] = {
    {"position", 3, "world position of the surface; 0 where there is none"},
    {"normal", 3, "bumped world normal, unit"},
    {"albedo", 3, "colour map, linear"},
    {"id", 1, "1 planet, 0 background"},
    {"diffuse", 1, "contrasted wrapped diffuse factor"},
    {"bump", 3, "tangent-space normal: x east, y south, z up"},
    {"depth", 1, "0 near to 1 far, as the rasterizer has it"},
};

/* The flight: over the terminator, low along the sunlit limb, then back out into the planet's shadow side. */
static const amb_camera_key mercury_flight[] = {
    {0.0f, {0.30f, 0.34f, 3.30f}, {0.16f, 0.02f, 0.0f}, {0.10f, 1.0f, 0.0f}},
    {8.0f, {1.15f, 0.42f, 2.75f}, {0.26f, 0.04f, 0.0f}, {0.14f, 1.0f, 0.0f}},
    {16.0f, {1.95f, 0.12f, 1.75f}, {0.30f, 0.08f, 0.25f}, {0.16f, 1.0f, 0.0f}},
    {24.0f, {2.75f, -0.35f, 1.05f}, {0.10f, 0.05f, 0.15f}, {0.05f, 1.0f, 0.0f}},
    {32.0f, {3.10f, -0.56f, -1.03f}, {-0.25f, 0.02f, -0.05f}, {0.0f, 1.0f, 0.0f}},
};

/* ---- state ------------------------------------------------------------------------------------------------------ */

typedef struct mercury_state {
    amb_mesh *sphere;
    const amb_texture *color, *stars; /* the resolver's */
    amb_texture *normals;             /* coded tangent-space normals */
} mercury_state;

typedef struct color_rows {
    const amb_texture *color;
    amb_image *height;
} color_rows;

/* Heights of the normal map: the colour map's luminance, texel by texel. */
static void read_height_row(void *user, int y, int thread)
{
    (void)thread;
    const color_rows *job = user;
    const amb_sampler nearest = {.filter = AMB_NEAREST};
    float *row = amb_image_row(job->height, 0, y), lane[AMB_LANES];
    int width = job->height->width;
    f32x v = f_set(((float)y + 0.5f) / (float)job->height->height);
    for (int x = 0; x < width; x += AMB_LANES) {
        f32x u = (i_to_f(i_lane_index() + x) + 0.5f) / (float)width;
        v4x c = amb_sample_2d_lod(job->color, &nearest, v2x_of(u, v), f_set(0.0f));
        f_store(lane, (c.x * 0.2126f + c.y * 0.7152f) + c.z * 0.0722f);
        memcpy(row + x, lane, (size_t)(width - x < AMB_LANES ? width - x : AMB_LANES) * sizeof *row);
    }
}

static void code_normal_row(void *user, int y, int thread)
{
    (void)thread;
    const amb_image *normals = user;
    for (int c = 0; c < 3; c++) {
        float *row = amb_image_row(normals, c, y);
        for (int x = 0; x < normals->width; x++)
            row[x] = row[x] * 0.5f + 0.5f;
    }
}

/* Colour → height → normals → texture. Slopes are the same for maps of any resolution. */
static amb_status make_normals(const amb_context *context, const amb_texture *color, amb_texture **out,
                               amb_error *error)
{
    amb_texture_info info = amb_texture_describe(color);
    amb_image *height = NULL, *normals = NULL;
    amb_status status = amb_image_create(info.width, info.height, 1, &height, error);
    if (status)
        return status;
    amb_parallel_for(context, info.height, read_height_row, &(color_rows){color, height});
    amb_normal_map_options options = {.strength = 0.0019f * (float)info.width,
                                      .octaves = 5,
                                      .gain = 1.25f,
                                      .wrap_u = true,
                                      .longitude_latitude = true};
    status = amb_normal_map_make(context, height, &options, &normals, error);
    if (!status) {
        amb_parallel_for(context, info.height, code_normal_row, normals);
        status = amb_texture_from_image(normals, AMB_TEXEL_RGBA16F, true, out, error);
    }
    amb_image_close(&height);
    amb_image_close(&normals);
    return status;
}

static void mercury_unload(void *state)
{
    mercury_state *s = state;
    if (!s)
        return;
    amb_mesh_close(&s->sphere);
    amb_texture_close(&s->normals);
    free(s);
}

static amb_status mercury_load(const amb_context *context, amb_assets *assets, void **state, amb_error *error)
{
    mercury_state *s = calloc(1, sizeof *s);
    *state = s;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "scene mercury: out of memory");
    amb_status status = amb_mesh_sphere(256, 512, &s->sphere, error);
    if (!status)
        status = amb_assets_texture(assets, "mercury/color", &s->color, error);
    if (!status)
        status = amb_assets_texture(assets, "stars", &s->stars, error);
    if (!status)
        status = make_normals(context, s->color, &s->normals, error);
    if (status) {
        mercury_unload(s);
        *state = NULL;
    }
    return status;
}

/* ---- shaders ---------------------------------------------------------------------------------------------------- */

typedef struct mercury_uniforms {
    const v3 *position;
    const amb_texture *color, *normals, *stars;
    amb_sampler surface, sky;
    mercury_params p;
    m4 world_to_clip;
    float turn_sine, turn_cosine; /* object → world, about +y */
    v3 to_sun, to_sun_object;     /* unit */
    v3 sun_rgb;                   /* radiance of a white surface facing the sun */
    float gain;                   /* 2^exposure */
    float sun_cosine, sun_soft;   /* of the disc's edge, and the width of its smoothing */
    v3 ray_origin, ray_dx, ray_dy;
    int slot[AOV_COUNT]; /* attachment of each AOV, 0: not wanted */
} mercury_uniforms;

typedef struct mercury_varyings {
    v3x position;
} mercury_varyings; /* object space */

AMB_INLINE v3x to_world(const mercury_uniforms *u, v3x p)
{
    return v3x_of(p.x * u->turn_cosine + p.z * u->turn_sine, p.y, p.z * u->turn_cosine - p.x * u->turn_sine);
}

static void mercury_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const mercury_uniforms *u = in->uniforms;
    mercury_varyings *v = out->varyings;
    v->position = v3x_gather(u->position, in->vertex);
    out->clip = m4_project_x(u->world_to_clip, to_world(u, v->position));
}

/* Where a point of the unit sphere is on a longitude-latitude map, and its frame there: east, south, up.
 *
 * Texture gradients are taken along the surface, as if a texel were everywhere as wide as at the equator. They have no
 * seam at the date line and no pole: toward it, maps are stretched along u and hold no detail to be filtered away. */
typedef struct sphere_place {
    v3x east, south, up;
    v2x uv, ddx, ddy;
} sphere_place;

AMB_INLINE sphere_place place_on_sphere(v3x position)
{
    sphere_place s;
    v3x n = s.up = v3x_normalize(position);
    v3x dx = v3x_of(f_ddx(n.x), f_ddx(n.y), f_ddx(n.z)), dy = v3x_of(f_ddy(n.x), f_ddy(n.y), f_ddy(n.z));
    s.east = v3x_normalize(v3x_of(n.z, f_set(0.0f), -n.x));
    s.south = normal_map_bitangent(s.east, n, f_set(-1.0f));
    s.uv = v2x_of(f_atan2(-n.z, n.x) * (0.5f / AMB_PI), f_acos(f_clamp(n.y, f_set(-1.0f), f_set(1.0f))) * AMB_INV_PI);
    s.ddx = v2x_of(v3x_dot(dx, s.east) * (0.5f / AMB_PI), v3x_dot(dx, s.south) * AMB_INV_PI);
    s.ddy = v2x_of(v3x_dot(dy, s.east) * (0.5f / AMB_PI), v3x_dot(dy, s.south) * AMB_INV_PI);
    return s;
}

AMB_INLINE void write_aov(const mercury_uniforms *u, amb_fs_out *out, int aov, v3x value)
{
    if (u->slot[aov])
        out->color[u->slot[aov]] = v4x_of3(value, f_set(1.0f));
}

static void mercury_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const mercury_uniforms *u = in->uniforms;
    const mercury_varyings *v = in->varyings;
    sphere_place at = place_on_sphere(v->position);

    v4x texel = amb_sample_2d_grad(u->color, &u->surface, at.uv, at.ddx, at.ddy);
    v3x albedo = v3x_scale(v4x_xyz(texel), f_set(u->p.albedo));
    v4x coded = amb_sample_2d_grad(u->normals, &u->surface, at.uv, at.ddx, at.ddy);
    v3x m = normal_map_decode(v4x_xyz(coded), u->p.bump);

    /* DOT3: the light goes to the normal's space. */
    v3x light = normal_map_to_tangent(v3x_splat(u->to_sun_object), at.east, at.south, at.up);
    f32x diffuse = diffuse_wrapped_contrast(v3x_dot(m, light), u->p.wrap, u->p.contrast);
    /* Slopes beyond the terminator face the sun but lie in the planet's own shadow. */
    diffuse = diffuse * f_smoothstep(f_set(-u->p.twilight), f_set(u->p.twilight), light.z);

    v3x lit = v3x_scale(v3x_splat(u->sun_rgb), diffuse);
    v3x color = v3x_scale(v3x_mul(albedo, v3x_add(lit, v3x_splat(v3_of(u->p.ambient, u->p.ambient, u->p.ambient)))),
                          f_set(u->gain));
    v3x normal = to_world(u, normal_map_apply(m, at.east, at.south, at.up));
    switch (u->p.show) {
    case SHOW_ALBEDO:
        color = albedo;
        break;
    case SHOW_DIFFUSE:
        color = v3x_of(diffuse, diffuse, diffuse);
        break;
    case SHOW_NORMALS:
        color = normal_map_encode(normal);
        break;
    case SHOW_BUMP:
        color = normal_map_encode(m);
        break;
    default:
        break;
    }
    out->color[0] = v4x_of3(color, f_set(1.0f));
    write_aov(u, out, AOV_POSITION, to_world(u, v->position));
    write_aov(u, out, AOV_NORMAL, normal);
    write_aov(u, out, AOV_ALBEDO, albedo);
    write_aov(u, out, AOV_ID, v3x_splat(v3_of(1.0f, 0.0f, 0.0f)));
    write_aov(u, out, AOV_DIFFUSE, v3x_of(diffuse, diffuse, diffuse));
    write_aov(u, out, AOV_BUMP, m);
}

/* The star map by view direction (its centre is -z, +x to the right), and the sun's disc with a darker limb. */
static void sky_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const mercury_uniforms *u = in->uniforms;
    v3x ray = v3x_add(v3x_splat(u->ray_origin),
                      v3x_add(v3x_scale(v3x_splat(u->ray_dx), in->x), v3x_scale(v3x_splat(u->ray_dy), in->y)));
    v3x d = v3x_normalize(ray);
    sphere_place at = place_on_sphere(v3x_of(-d.z, d.y, -d.x));
    at.uv.x = at.uv.x + 0.5f;
    v4x texel = amb_sample_2d_grad(u->stars, &u->sky, at.uv, at.ddx, at.ddy);
    v3x stars = v3x_scale(v4x_xyz(texel), f_set(u->p.star_light));

    f32x cosine = v3x_dot(d, v3x_splat(u->to_sun));
    f32x disc = f_saturate((cosine - u->sun_cosine) * (1.0f / u->sun_soft) + 0.5f);
    f32x from_edge = f_saturate((cosine - u->sun_cosine) * (1.0f / (1.0f - u->sun_cosine + FLT_MIN)));
    f32x limb = 0.4f + 0.6f * f_sqrt(from_edge); /* linear limb darkening, u = 0.6 */
    v3x sun = v3x_scale(v3x_splat(u->sun_rgb), disc * limb * 800.0f);
    v3x color = v3x_scale(v3x_add(stars, sun), f_set(u->gain));
    out->color[0] = v4x_of3(u->p.show == SHOW_BEAUTY ? color : v3x_splat(v3_of(0.0f, 0.0f, 0.0f)), f_set(1.0f));
}

/* ---- frame ------------------------------------------------------------------------------------------------------ */

static mercury_uniforms uniforms_at(const mercury_state *s, const amb_scene_job *job)
{
    mercury_uniforms u = {.position = s->sphere->position, .color = s->color, .normals = s->normals, .stars = s->stars};
    u.p = *(const mercury_params *)job->params;
    float time = (float)job->time;
    amb_camera camera = amb_camera_at(mercury_flight, sizeof mercury_flight / sizeof *mercury_flight, time,
                                      u.p.fov * (AMB_PI / 180.0f), 0.05f, 100.0f, job->width, job->height);
    u.world_to_clip = camera.world_to_clip;
    u.ray_origin = camera.ray_origin;
    u.ray_dx = camera.ray_dx;
    u.ray_dy = camera.ray_dy;

    double turns = ((double)u.p.tilt + (double)u.p.rotation * job->time) / 360.0;
    float angle = AMB_TWO_PI * (float)(turns - (double)(long long)turns);
    u.turn_sine = amb_sin(angle);
    u.turn_cosine = amb_cos(angle);
    u.to_sun = v3_normalize(u.p.sun_direction);
    u.to_sun_object = v3_of(u.to_sun.x * u.turn_cosine - u.to_sun.z * u.turn_sine, u.to_sun.y,
                            u.to_sun.x * u.turn_sine + u.to_sun.z * u.turn_cosine);
    u.sun_rgb = v3_scale(u.p.tint, u.p.sun_light);
    u.gain = amb_exp2(u.p.exposure);
    float size = u.p.sun_size * (AMB_PI / 180.0f), half_sine = amb_sin(0.5f * size);
    float pixel = v3_length(camera.ray_dy);
    u.sun_cosine = 1.0f - 2.0f * half_sine * half_sine; /* keeps its digits for small discs */
    u.sun_soft = amb_sin(size) * pixel + 1e-9f;
    u.surface =
        (amb_sampler){.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP}, .max_anisotropy = u.p.anisotropy};
    u.sky = (amb_sampler){.filter = AMB_TRILINEAR, .wrap = {AMB_REPEAT, AMB_CLAMP}};
    return u;
}

/* Attachments: the colour, then the wanted AOVs. */
static void bind_layers(const amb_frame *frame, amb_target *target, int slot[AOV_COUNT])
{
    int count = 0;
    target->color[count++] = amb_frame_layer(frame, "color");
    for (int i = 0; i < AOV_COUNT; i++) {
        amb_image *layer = amb_frame_layer(frame, mercury_aovs[i].name);
        slot[i] = layer ? count : 0;
        if (layer)
            target->color[count++] = layer;
    }
    target->clear_depth = 1.0f;
}

static amb_status mercury_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    const mercury_state *s = state;
    mercury_uniforms u = uniforms_at(s, job);
    amb_target target = {0};
    amb_image *own_depth = NULL;
    amb_pass *pass = NULL;
    amb_status status = AMB_OK;
    bind_layers(job->frame, &target, u.slot);
    target.depth = amb_frame_layer(job->frame, "depth");
    if (!target.depth) {
        status = amb_image_create(job->width, job->height, 1, &own_depth, error);
        if (status)
            return status;
        target.depth = own_depth;
    }

    amb_draw planet = {.label = "mercury",
                       .lanes = AMB_LANES,
                       .vertex = mercury_vertex,
                       .fragment = mercury_fragment,
                       .uniforms = &u,
                       .uniforms_size = sizeof u,
                       .varying_floats = sizeof(mercury_varyings) / sizeof(f32x),
                       .indices = s->sphere->index,
                       .count = 3 * s->sphere->triangle_count,
                       .vertex_count = s->sphere->vertex_count,
                       .cull = AMB_CULL_BACK};
    amb_draw sky = {.label = "sky",
                    .lanes = AMB_LANES,
                    .fragment = sky_fragment,
                    .uniforms = &u,
                    .uniforms_size = sizeof u,
                    .depth_compare = AMB_LESS_EQUAL,
                    .depth_write_off = true,
                    .targets_off = ~1u};
    status = amb_pass_begin(job->context, &target, &pass, error);
    if (!status && u.p.planet)
        status = amb_pass_draw(pass, &planet, error);
    if (!status && u.p.stars)
        status = amb_pass_draw(pass, &sky, error);
    if (!status)
        status = amb_pass_finish(&pass, NULL, error);
    amb_pass_close(&pass);
    amb_image_close(&own_depth);
    return status;
}

const amb_scene WIDE(amb_scene_mercury) = {
    .name = "mercury",
    .about = "Mercury's craters at the terminator: DOT3 bump, contrasted wrapped diffuse, stars",
    .seconds = 32.0f,
    .params = {mercury_table, sizeof mercury_table / sizeof *mercury_table, sizeof(mercury_params)},
    .aovs = mercury_aovs,
    .aov_count = sizeof mercury_aovs / sizeof *mercury_aovs,
    .post = "mlaa;bloom:threshold=1.0,intensity=0.25;display:curve=filmic",
    .load = mercury_load,
    .frame = mercury_frame,
    .unload = mercury_unload,
};
