/* Scene julia: a quaternion Julia set, sphere traced inside its bounding ball, lit by HDR environments (seed, "Julia
 * sets"; after the demo "kindernoiser" by rgba, 2007). */
#include "scenes/canvas.h"
#include "scenes/julia.h"

#include <ambiance/march.h>
#include <ambiance/raster.h>
#include <ambiance/rays.h>
#include <ambiance/scene.h>

#include <stdlib.h>

/* ---- parameters ---------------------------------------------------------------------------------------------------
 */

enum {
    COMPONENT_ALL,
    COMPONENT_AMBIENT,
    COMPONENT_DIFFUSE,
    COMPONENT_SPECULAR,
    COMPONENT_REFLECTION,
    COMPONENT_FRESNEL
};

typedef struct julia_params {
    int component, environment, morph, iterations, steps, samples;
    v3 constant;
    float constant_k, tolerance;
    v3 light_direction, light_color, ambient_color, inner_color, outer_color, specular_color;
    float ambient, diffuse, specular, shininess, reflection, fresnel_power, occlusion, shadow, background, blur;
} julia_params;

static const char *const component_names[] = {"all", "ambient", "diffuse", "specular", "reflection", "fresnel", NULL};
static const char *const environment_names[] = {"outdoor", "studio", NULL};

#define FIELD(member) .offset = offsetof(julia_params, member)
#define FLOAT(NAME, UNIT, LO, HI, DEFAULT, DOC)                                                                    \
    {                                                                                                              \
        .name = #NAME, .type = AMB_PARAM_FLOAT, .unit = UNIT, .minimum = LO, .maximum = HI, .fallback = {DEFAULT}, \
        FIELD(NAME), .doc = DOC                                                                                    \
    }
#define INT(NAME, UNIT, LO, HI, DEFAULT, DOC)                                                                    \
    {                                                                                                            \
        .name = #NAME, .type = AMB_PARAM_INT, .unit = UNIT, .minimum = LO, .maximum = HI, .fallback = {DEFAULT}, \
        FIELD(NAME), .doc = DOC                                                                                  \
    }
#define VEC3(NAME, LO, HI, X, Y, Z, DOC)                                                                        \
    {                                                                                                           \
        .name = #NAME, .type = AMB_PARAM_VEC3, .unit = "", .minimum = LO, .maximum = HI, .fallback = {X, Y, Z}, \
        FIELD(NAME), .doc = DOC                                                                                 \
    }
#define COLOR(NAME, R, G, B, DOC)                                                                                \
    {                                                                                                            \
        .name = #NAME, .type = AMB_PARAM_COLOR, .unit = "", .minimum = 0, .maximum = 100, .fallback = {R, G, B}, \
        FIELD(NAME), .doc = DOC                                                                                  \
    }

static const amb_param table[] = {
    {.name = "component",
     .type = AMB_PARAM_CHOICE,
     .unit = "",
     .choices = component_names,
     FIELD(component),
     .doc = "what the picture shows: all light, or one component alone"},
    {.name = "environment",
     .type = AMB_PARAM_CHOICE,
     .unit = "",
     .choices = environment_names,
     FIELD(environment),
     .doc = "HDR environment that lights, is reflected and is seen behind"},
    {.name = "morph",
     .type = AMB_PARAM_BOOL,
     .unit = "",
     .fallback = {1},
     FIELD(morph),
     .doc = "on: c follows its path over time; off: c is `constant`, `constant_k`"},
    VEC3(constant, -2, 2, -0.2f, 0.8f, 0, "real, i and j part of c when it does not morph"),
    FLOAT(constant_k, "", -2, 2, 0, "k part of c when it does not morph"),
    INT(iterations, "", 2, 60, 24, "most iterations of z² + c (an odd number counts as the next even one)"),
    FLOAT(tolerance, "pixels", 0.05f, 4, 0.5f, "a ray stops this near the surface"),
    INT(steps, "", 8, 1000, 200, "most steps a ray"),
    INT(samples, "", 1, 16, 1, "rays a pixel; other layers than color come from the first, at the centre"),
    VEC3(light_direction, -1, 1, 0.45f, 0.8f, 0.4f, "towards the light; any length above 0"),
    COLOR(light_color, 1.5f, 1.35f, 1.15f, "radiance of the light over pi"),
    COLOR(ambient_color, 0.03f, 0.035f, 0.05f, "light added to the environment's irradiance"),
    COLOR(inner_color, 0.48f, 0.05f, 0.015f, "albedo where the orbit comes near 0: the folds"),
    COLOR(outer_color, 0.85f, 0.66f, 0.44f, "albedo of the ribs between them"),
    COLOR(specular_color, 1, 0.95f, 0.85f, "colour of the highlight"),
    FLOAT(ambient, "", 0, 10, 0.45f, "amount of ambient light"),
    FLOAT(diffuse, "", 0, 10, 0.7f, "amount of diffuse light"),
    FLOAT(specular, "", 0, 10, 0.35f, "amount of specular light"),
    FLOAT(shininess, "", 1, 1000, 48, "Phong exponent"),
    FLOAT(reflection, "", 0, 10, 0.35f, "amount of reflected environment"),
    FLOAT(fresnel_power, "", 0.05f, 20, 0.6f, "k of the Fresnel term 1 - (v·n)^k"),
    FLOAT(occlusion, "", 0, 1, 0.8f, "how much folds and hollows darken ambient and reflected light"),
    FLOAT(shadow, "", 0, 1, 0.85f, "darkness of the light's shadows; 0 traces none"),
    FLOAT(background, "", 0, 10, 0.35f, "brightness of the environment behind"),
    FLOAT(blur, "levels", 0, 8, 2, "how far the environment behind is out of focus, in mip levels"),
};

static const amb_aov aovs[] = {
    {"depth", 1, "0 at the near plane … 1 at the far plane and behind"},
    {"position", 3, "world"},
    {"normal", 3, "world, unit"},
    {"albedo", 3, "linear"},
    {"id", 1, "1 = the set, 0 = background"},
    {"ambient", 3, "light from the irradiance map and the constant ambient colour"},
    {"diffuse", 3, "Lambert's term of the light"},
    {"specular", 3, "Phong's term of the light"},
    {"reflection", 3, "reflected environment times the Fresnel term"},
    {"fresnel", 1, "the Fresnel term"},
};
enum {
    OUT_DEPTH,
    OUT_POSITION,
    OUT_NORMAL,
    OUT_ALBEDO,
    OUT_ID,
    OUT_AMBIENT,
    OUT_DIFFUSE,
    OUT_SPECULAR,
    OUT_REFLECTION,
    OUT_FRESNEL,
    OUT_COUNT
};

/* ---- state --------------------------------------------------------------------------------------------------------
 */

typedef struct julia_state {
    amb_rays *ball; /* the unit ball: rays are scaled to the set's */
    const amb_texture *environment[2], *irradiance[2];
} julia_state;

static void julia_unload(void *state)
{
    julia_state *s = state;
    amb_rays_close(&s->ball);
    free(s);
}

static amb_status julia_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    static const char *const names[2][2] = {{"env/outdoor", "env/outdoor/irradiance"},
                                            {"env/studio", "env/studio/irradiance"}};
    julia_state *s = calloc(1, sizeof *s);
    if (s == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene julia");
    amb_rays_sphere unit = {{0, 0, 0}, 1};
    amb_rays_geometry geometry = {.spheres = &unit, .sphere_count = 1};
    amb_status status = amb_rays_create(context, &geometry, 1, &s->ball, error);
    for (int i = 0; i < 2 && status == AMB_OK; i++) {
        status = amb_assets_texture(assets, names[i][0], &s->environment[i], error);
        if (status == AMB_OK)
            status = amb_assets_texture(assets, names[i][1], &s->irradiance[i], error);
    }
    if (status != AMB_OK) {
        julia_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

/* ---- one frame ----------------------------------------------------------------------------------------------------
 */

typedef struct julia_uniforms {
    julia_params params;
    julia_set set;
    amb_camera camera;
    v3 to_light;
    amb_march_limits limits;
    const amb_rays *ball;
    const amb_texture *environment, *irradiance;
    const float *start; /* of each tile: safe for all its rays */
    const float *hit;   /* of each pixel, packet by packet: t, or -1 */
    int tiles_across;
    int target[OUT_COUNT]; /* attachment of each AOV; -1: not wanted */
} julia_uniforms;

static const amb_sampler sampler = {.filter = AMB_TRILINEAR};

AMB_INLINE v3x eye_ray(const amb_camera *c, f32x x, f32x y)
{
    v3x d = v3x_add(v3x_splat(c->ray_origin),
                    v3x_add(v3x_scale(v3x_splat(c->ray_dx), x), v3x_scale(v3x_splat(c->ray_dy), y)));
    return v3x_normalize(d);
}

/* One level of tiles: for each, t before which none of its rays can hit. */
typedef struct julia_tiles {
    const julia_uniforms *uniforms;
    const struct julia_tiles *coarse; /* NULL: start at the bounding ball */
    float *start;
    float *hit;             /* fine tiles only: t of each pixel */
    int size, across, down; /* pixels a tile; tiles */
} julia_tiles;

/* The tiles of one row: lanes are tiles. */
static void start_row(void *user, int row, int thread)
{
    (void)thread;
    const julia_tiles *tiles = user;
    const julia_uniforms *u = tiles->uniforms;
    float far = v3_length(u->camera.position), first = amb_s_max(far - u->set.radius, 0.0f), last = far + u->set.radius;
    float size = (float)tiles->size, lanes[AMB_LANES];
    for (int i = 0; i < tiles->across; i += AMB_LANES) {
        for (int k = 0; k < AMB_LANES; k++) {
            int x = i + k < tiles->across ? i + k : tiles->across - 1;
            lanes[k] = tiles->coarse ? tiles->coarse->start[row / 4 * tiles->coarse->across + x / 4] : first;
        }
        f32x start = f_load(lanes);
        f32x x = i_to_f(i_lane_index() + i) * size, y = f_set((float)row * size), radius = f_set(0.0f);
        v3x center = eye_ray(&u->camera, x + 0.5f * size, y + 0.5f * size);
        for (int k = 0; k < 4; k++) {
            v3x corner = eye_ray(&u->camera, x + (k & 1 ? size : 0.0f), y + (k & 2 ? size : 0.0f));
            radius = f_max(radius, v3x_length(v3x_sub(corner, center)));
        }
        f_store(lanes, amb_march_cone(julia_distance, &u->set, v3x_splat(u->camera.position), center, start,
                                      f_set(last), radius, u->limits.least, 64, m_set(true)));
        for (int k = 0; k < AMB_LANES && i + k < tiles->across; k++)
            tiles->start[row * tiles->across + i + k] = lanes[k];
    }
}

/* ---- the march ----------------------------------------------------------------------------------------------------
 */

/* Where rays are inside the bounding ball, not before `start`. */
AMB_INLINE maskx ball_interval(const julia_uniforms *u, v3x direction, float start, maskx live, f32x *t0, f32x *t1)
{
    v3 eye = u->camera.position;
    float far = v3_length(eye), unit = 1.0f / u->set.radius;
    *t0 = *t1 = f_set(0.0f);
    if (!(start <= far + u->set.radius))
        return m_set(false);
    /* In units of the ball, so that one tree serves every c; t stays in world units. */
    amb_rayx ray = {v3x_splat(v3_scale(eye, unit)), v3x_scale(direction, f_set(unit)), f_set(0.0f), f_set(FLT_MAX)};
    amb_hitx ball;
    amb_rays_closest(u->ball, &ray, live, &ball);
    *t0 = f_max(far < u->set.radius ? f_set(0.0f) : ball.t, f_set(start));
    *t1 = ball.t_exit;
    return ball.hit;
}

/* A tile's pixels as packets of AMB_LANES: fragment blocks, left to right, then down. */
#define PACKETS (JULIA_TILE * JULIA_TILE / AMB_LANES)
#define PACKETS_ACROSS (JULIA_TILE / AMB_BLOCK_W)

/* Marches the pixel centres of one row of tiles, two packets at a time; keeps t, or -1 for no hit. */
static void march_row(void *user, int row, int thread)
{
    (void)thread;
    const julia_tiles *tiles = user;
    const julia_uniforms *u = tiles->uniforms;
    int count = tiles->across * PACKETS;
    for (int first = 0; first < count; first += 2) {
        v3x direction[2];
        f32x t0[2], t1[2];
        maskx live[2];
        amb_marched m[2];
        for (int k = 0; k < 2; k++) {
            int packet = first + k < count ? first + k : count - 1, tile = packet / PACKETS, part = packet % PACKETS;
            int x = tile * JULIA_TILE + part % PACKETS_ACROSS * AMB_BLOCK_W;
            int y = row * JULIA_TILE + part / PACKETS_ACROSS * AMB_BLOCK_H;
            direction[k] = eye_ray(&u->camera, i_to_f(i_block_x() + x) + 0.5f, i_to_f(i_block_y() + y) + 0.5f);
            float start = tiles->start[row * tiles->across + tile];
            live[k] = ball_interval(u, direction[k], start, m_set(first + k < count), &t0[k], &t1[k]);
        }
        amb_march_pair(julia_distance_pair, &u->set, v3x_splat(u->camera.position), direction, t0, t1, &u->limits, live,
                       m);
        float *out = tiles->hit + ((size_t)row * (size_t)count + (size_t)first) * AMB_LANES;
        for (int k = 0; k < 2 && first + k < count; k++)
            f_store(out + k * AMB_LANES, f_sel(m[k].hit, m[k].t, f_set(-1.0f)));
    }
}

/* ---- shading ------------------------------------------------------------------------------------------------------
 */

typedef struct julia_light {
    v3x color, ambient, diffuse, specular, reflection, albedo, normal, position;
    f32x fresnel, depth;
    maskx hit;
} julia_light;

/* How much of the light arrives: least ratio of clearance to the distance walked towards it, a soft shadow. */
AMB_INLINE f32x light_reaching(const julia_uniforms *u, v3x from, f32x start, maskx live)
{
    v3x way = v3x_splat(u->to_light);
    f32x t = start, clear = f_set(1.0f);
    for (int i = 0; i < 16 && m_any(live); i++) {
        v3x p = v3x_add(from, v3x_scale(way, t));
        f32x d = julia_distance(p, &u->set);
        clear = f_sel(live, f_min(d * 16.0f / t, clear), clear);
        t = t + f_clamp(d * AMB_MARCH_STRIDE, start, f_set(0.25f));
        live &= (clear > 0.02f) & (v3x_dot(p, p) < u->set.radius * u->set.radius);
    }
    f32x c = f_saturate(clear);
    return c * c * (3.0f - 2.0f * c);
}

/* How free the space in front of the surface is, 0…1: clearance along the normal against that of a flat wall, whose
 * distance bound is half the distance. After A. Evans, "Fast approximations for global illumination on dynamic scenes",
 * SIGGRAPH 2006 course. */
AMB_INLINE f32x openness(const julia_uniforms *u, v3x from, v3x normal)
{
    static const float reach[3] = {0.04f, 0.12f, 0.3f}, weight[3] = {0.3f, 0.35f, 0.35f};
    v3x at[3];
    f32x d[3], open = f_set(0.0f);
    for (int i = 0; i < 3; i++)
        at[i] = v3x_add(from, v3x_scale(normal, f_set(reach[i])));
    julia_distance_pair(at, d, &u->set);
    d[2] = julia_distance(at[2], &u->set);
    for (int i = 0; i < 3; i++)
        open = open + f_saturate(d[i] * (2.0f / reach[i])) * weight[i];
    return open;
}

AMB_INLINE f32x positive(f32x a) { return f_max(a, f_set(0.0f)); }

/* The report's components at the hits. */
static julia_light shade_surface(const julia_uniforms *u, v3x direction, f32x t, maskx hit)
{
    const julia_params *k = &u->params;
    julia_light r = {.hit = hit};
    r.position = v3x_add(v3x_splat(u->camera.position), v3x_scale(direction, t));
    julia_surface s = julia_surface_at(r.position, &u->set);
    v3x n = r.normal = v3x_sel(hit, s.normal, v3x_neg(direction)), l = v3x_splat(u->to_light);
    f32x outer = f_smoothstep(f_set(0.03f), f_set(0.5f), s.trap);
    r.albedo = v3x_lerp(v3x_splat(k->inner_color), v3x_splat(k->outer_color), outer);
    f32x open = 1.0f - k->occlusion * (1.0f - openness(u, r.position, n));

    v4x irradiance = amb_sample_cube_lod(u->irradiance, &sampler, n, f_set(0.0f));
    v3x ambient = v3x_add(v4x_xyz(irradiance), v3x_splat(k->ambient_color));
    r.ambient = v3x_scale(v3x_mul(r.albedo, ambient), k->ambient * open);

    f32x lambert = positive(v3x_dot(n, l));
    maskx facing = hit & (lambert > 0.0f);
    f32x lit = f_set(1.0f);
    if (k->shadow > 0.0f && m_any(facing)) {
        f32x off = t * (u->limits.footprint * 4.0f);
        v3x from = v3x_add(r.position, v3x_scale(n, off));
        lit = 1.0f - k->shadow * (1.0f - light_reaching(u, from, off, facing));
    }
    r.diffuse = v3x_scale(v3x_mul(r.albedo, v3x_splat(k->light_color)), k->diffuse * lambert * lit);

    v3x mirror = v3x_reflect(direction, n);
    f32x phong = f_sel(facing, f_pow(positive(v3x_dot(mirror, l)), f_set(k->shininess)), f_set(0.0f));
    r.specular = v3x_scale(v3x_splat(v3_mul(k->specular_color, k->light_color)), k->specular * phong * lit);

    f32x view = f_saturate(-v3x_dot(n, direction));
    r.fresnel = 1.0f - f_pow(view, f_set(k->fresnel_power));
    v4x around = amb_sample_cube(u->environment, &sampler, v3x_sel(hit, mirror, direction));
    r.reflection = v3x_scale(v4x_xyz(around), k->reflection * r.fresnel * open);
    return r;
}

AMB_INLINE v3x chosen_component(const julia_light *r, int component)
{
    switch (component) {
    case COMPONENT_AMBIENT:
        return r->ambient;
    case COMPONENT_DIFFUSE:
        return r->diffuse;
    case COMPONENT_SPECULAR:
        return r->specular;
    case COMPONENT_REFLECTION:
        return r->reflection;
    case COMPONENT_FRESNEL:
        return (v3x){r->fresnel, r->fresnel, r->fresnel};
    default:
        return v3x_add(v3x_add(r->ambient, r->diffuse), v3x_add(r->specular, r->reflection));
    }
}

/* What is seen along a ray that hits the set at t, or the environment. */
static julia_light shade_pixel(const julia_uniforms *u, v3x direction, f32x t, maskx hit, maskx live)
{
    julia_light r = {.hit = hit, .depth = f_set(1.0f)};
    if (m_any(hit)) {
        r = shade_surface(u, direction, t, hit);
        v3x view = m4_point_x(u->camera.world_to_view, r.position);
        r.depth = f_sel(hit, amb_camera_depth_x(&u->camera, -view.z), f_set(1.0f));
        r.color = chosen_component(&r, u->params.component);
    }
    if (!m_all(hit | ~live)) {
        v3x behind = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
        if (u->params.component == COMPONENT_ALL)
            behind = v3x_scale(v4x_xyz(amb_sample_cube_lod(u->environment, &sampler, direction, f_set(u->params.blur))),
                               f_set(u->params.background));
        r.color = v3x_sel(hit, r.color, behind);
    }
    return r;
}

AMB_INLINE void write_target(const julia_uniforms *u, amb_fs_out *out, int which, maskx hit, v3x value)
{
    v3x none = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
    if (u->target[which] >= 0)
        out->color[u->target[which]] = v4x_of3(v3x_sel(hit, value, none), f_set(1.0f));
}

static void write_targets(const julia_uniforms *u, const julia_light *r, amb_fs_out *out)
{
    f32x one = f_set(1.0f);
    write_target(u, out, OUT_POSITION, r->hit, r->position);
    write_target(u, out, OUT_NORMAL, r->hit, r->normal);
    write_target(u, out, OUT_ALBEDO, r->hit, r->albedo);
    write_target(u, out, OUT_ID, r->hit, (v3x){one, one, one});
    write_target(u, out, OUT_AMBIENT, r->hit, r->ambient);
    write_target(u, out, OUT_DIFFUSE, r->hit, r->diffuse);
    write_target(u, out, OUT_SPECULAR, r->hit, r->specular);
    write_target(u, out, OUT_REFLECTION, r->hit, r->reflection);
    write_target(u, out, OUT_FRESNEL, r->hit, (v3x){r->fresnel, r->fresnel, r->fresnel});
    out->depth = r->depth;
}

/* One more ray of a pixel, off its centre. */
static v3x sample_color(const julia_uniforms *u, f32x x, f32x y, float start, maskx live)
{
    v3x direction = eye_ray(&u->camera, x, y);
    f32x t0, t1;
    maskx inside = ball_interval(u, direction, start, live, &t0, &t1);
    amb_marched m =
        amb_march(julia_distance, &u->set, v3x_splat(u->camera.position), direction, t0, t1, &u->limits, inside);
    return shade_pixel(u, direction, m.t, m.hit, live).color;
}

static void julia_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const julia_uniforms *u = in->uniforms;
    int x = (int)f_lane(in->x, 0), y = (int)f_lane(in->y, 0), tile = y / JULIA_TILE * u->tiles_across + x / JULIA_TILE;
    int part = y % JULIA_TILE / AMB_BLOCK_H * PACKETS_ACROSS + x % JULIA_TILE / AMB_BLOCK_W;
    f32x t = f_load(u->hit + (size_t)(tile * PACKETS + part) * AMB_LANES);
    julia_light r = shade_pixel(u, eye_ray(&u->camera, in->x, in->y), t, in->live & (t >= 0.0f), in->live);
    write_targets(u, &r, out);
    v3x sum = r.color;
    for (int i = 1; i < u->params.samples; i++) {
        /* The R2 sequence (M. Roberts, 2018) around the centre, inside the pixel. */
        float dx = (float)i * 0.7548776662f + 0.5f, dy = (float)i * 0.5698402910f + 0.5f;
        dx -= (float)(int)dx;
        dy -= (float)(int)dy;
        sum = v3x_add(sum, sample_color(u, in->x + (dx - 0.5f), in->y + (dy - 0.5f), u->start[tile], in->live));
    }
    out->color[0] = v4x_of3(v3x_scale(sum, f_set(1.0f / (float)u->params.samples)), f_set(1.0f));
}

static void fill_uniforms(julia_uniforms *u, const julia_state *s, const amb_scene_job *job)
{
    const julia_params *k = &u->params;
    v4 c = k->morph ? amb_julia_path(job->time, (double)JULIA_SECONDS) : v4_of3(k->constant, k->constant_k);
    u->set = julia_make(c, k->iterations);
    u->camera = amb_julia_camera(job->time, job->width, job->height);
    u->to_light = v3_normalize(k->light_direction);
    u->limits = (amb_march_limits){v3_length(u->camera.ray_dy) * 0.5f, k->tolerance * 2.0f, 1e-5f, k->steps};
    u->ball = s->ball;
    u->environment = s->environment[k->environment];
    u->irradiance = s->irradiance[k->environment];
}

/* Attachments: color first, then every AOV that the frame has. The depth AOV is the depth buffer. */
static amb_target choose_targets(julia_uniforms *u, const amb_frame *frame)
{
    amb_target target = {.clear_depth = 1};
    int count = 0;
    target.color[count++] = amb_frame_layer(frame, "color");
    for (int i = 0; i < OUT_COUNT; i++) {
        amb_image *image = amb_frame_layer(frame, aovs[i].name);
        u->target[i] = -1;
        if (i == OUT_DEPTH)
            target.depth = image;
        else if (image)
            target.color[u->target[i] = count++] = image;
    }
    return target;
}

static julia_tiles make_tiles(const julia_uniforms *u, const julia_tiles *coarse, int size, const amb_scene_job *job)
{
    return (julia_tiles){u, coarse, NULL, NULL, size, (job->width + size - 1) / size, (job->height + size - 1) / size};
}

static amb_status julia_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    julia_uniforms u = {.params = *(const julia_params *)job->params};
    amb_pass *pass = NULL;
    amb_pass_stats stats = {0};
    fill_uniforms(&u, state, job);
    amb_target target = choose_targets(&u, job->frame);
    target.time_stages = job->stats != NULL;
    julia_tiles coarse = make_tiles(&u, NULL, JULIA_COARSE_TILE, job), fine = make_tiles(&u, &coarse, JULIA_TILE, job);
    size_t coarse_count = (size_t)coarse.across * (size_t)coarse.down,
           fine_count = (size_t)fine.across * (size_t)fine.down;
    float *memory = malloc((coarse_count + fine_count * (1 + JULIA_TILE * JULIA_TILE)) * sizeof *memory);
    if (memory == NULL)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene julia");
    coarse.start = memory;
    u.start = fine.start = coarse.start + coarse_count;
    u.hit = fine.hit = fine.start + fine_count;
    u.tiles_across = fine.across;
    amb_parallel_for(job->context, coarse.down, start_row, &coarse);
    amb_parallel_for(job->context, fine.down, start_row, &fine);
    amb_parallel_for(job->context, fine.down, march_row, &fine);
    amb_status status = amb_pass_begin(job->context, &target, &pass, error);
    if (status != AMB_OK)
        goto done;
    amb_draw draw = {.label = "julia",
                     .lanes = AMB_LANES,
                     .fragment = julia_fragment,
                     .uniforms = &u,
                     .uniforms_size = sizeof u,
                     .writes_depth = true};
    status = amb_pass_draw(pass, &draw, error);
    if (status == AMB_OK)
        status = amb_pass_finish(&pass, &stats, error);
    canvas_add_stats(job, &stats);
done:
    amb_pass_close(&pass);
    free(memory);
    return status;
}

const amb_scene WIDE(amb_scene_julia) = {
    .name = "julia",
    .about = "a quaternion Julia set that changes shape, in HDR light",
    .seconds = JULIA_SECONDS,
    .params = {table, sizeof table / sizeof *table, sizeof(julia_params)},
    .aovs = aovs,
    .aov_count = OUT_COUNT,
    .post = "mlaa;bloom;display",
    .load = julia_load,
    .frame = julia_frame,
    .unload = julia_unload,
};
