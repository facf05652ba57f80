/* Scene solar: one flight from the sun past all the planets (Ambiance report, "The solar system"). Bodies are drawn
 * from far to near, each in its own frame and its own share of the depth range. */
#include "scenes/planet_wide.h"
#include "scenes/solar.h"

#include <stdlib.h>

typedef struct solar_params {
    planet_params planet; /* of which exposure, stars and samples count here */
    float fade_in, fade_out, fade;
} solar_params;

static const amb_param solar_table[] = {
    {"exposure",
     AMB_PARAM_FLOAT,
     "",
     0,
     100,
     {1},
     NULL,
     offsetof(solar_params, planet.exposure),
     "factor on the sun's light, over each body's own"},
    {"stars", AMB_PARAM_FLOAT, "", 0, 100, {0.4f}, NULL, offsetof(solar_params, planet.stars), "factor on the stars"},
    {"samples",
     AMB_PARAM_INT,
     "",
     1,
     CANVAS_MAX_FACTOR,
     {2},
     NULL,
     offsetof(solar_params, planet.samples),
     "samples along a pixel's side"},
    {"fade_in",
     AMB_PARAM_FLOAT,
     "s",
     0,
     60,
     {2.5f},
     NULL,
     offsetof(solar_params, fade_in),
     "time of the fade from black at the start"},
    {"fade_out",
     AMB_PARAM_FLOAT,
     "s",
     0,
     60,
     {4},
     NULL,
     offsetof(solar_params, fade_out),
     "time of the fade to black at the end"},
    {"fade", AMB_PARAM_FLOAT, "", 0, 1, {1}, NULL, offsetof(solar_params, fade), "factor on all light; 0: black"},
};
static const amb_aov solar_aovs[] = {
    {"position", 3, "from the body's centre, in its radii"},
    {"normal", 3, "world normal, unit, bumps included"},
    {"albedo", 3, "linear albedo"},
    {"id", 1, "1 a body, 2 its rings, 0 background"},
    {"depth", 1, "0 … 1; every body has its own share, nearer ones the smaller"},
    {"light", 3, "light on the surface before its albedo"},
};

/* ---- bodies ----------------------------------------------------------------------------------------------------- */

#define BODIES(X) X(sun) X(mercury) X(venus) X(earth) X(mars) X(jupiter) X(saturn) X(uranus) X(neptune) X(pluto)
#define DECLARE(name)                             \
    extern const planet_body WIDE(planet_##name); \
    extern const amb_scene WIDE(amb_scene_##name);
BODIES(DECLARE)
#define BODY(name) {&WIDE(planet_##name), &WIDE(amb_scene_##name)},
static const struct {
    const planet_body *body;
    const amb_scene *scene; /* its parameters' defaults are the tour's, but for the sun's radiance */
} bodies[SOLAR_BODIES] = {BODIES(BODY)};

typedef struct solar_state {
    void *body[SOLAR_BODIES], *params[SOLAR_BODIES];
} solar_state;

static void solar_unload(void *opaque)
{
    solar_state *state = opaque;
    for (int i = 0; i < SOLAR_BODIES; i++) {
        planet_unload(state->body[i]);
        free(state->params[i]);
    }
    free(state);
}

static amb_status solar_load(const amb_context *context, amb_assets *assets, void **out, amb_error *error)
{
    solar_state *s = calloc(1, sizeof *s);
    amb_status status = AMB_OK;
    *out = NULL;
    if (!s)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for scene solar");
    for (int i = 0; i < SOLAR_BODIES && status == AMB_OK; i++) {
        const amb_params *params = &bodies[i].scene->params;
        s->params[i] = calloc(1, params->size);
        if (!s->params[i]) {
            status = amb_fail(error, AMB_ERROR_MEMORY, "out of memory for the parameters of scene solar");
            break;
        }
        amb_params_defaults(params, s->params[i]);
        if (i == 0) /* beside lit planets it outshines them */
            status = amb_params_set(params, s->params[0], "scene solar", "radiance", "4", error);
        if (status == AMB_OK)
            status = planet_load(bodies[i].body, context, assets, &s->body[i], error);
    }
    if (status != AMB_OK) {
        solar_unload(s);
        return status;
    }
    *out = s;
    return AMB_OK;
}

/* ---- frame ------------------------------------------------------------------------------------------------------ */

typedef struct solar_body_view {
    int body;
    float distance; /* of its centre from the eye, in its radii */
    amb_camera camera;
} solar_body_view;

/* The camera in the frame of a body, its depth range just around it. False: nothing of it is in the picture. */
static bool solar_look(const solar_place *place, const amb_camera *from, int width, int height, solar_body_view *out)
{
    v3 to_eye = v3_scale(v3_sub(from->position, place->centre), 1.0f / place->radius);
    v3 to_target = v3_scale(v3_sub(from->target, place->centre), 1.0f / place->radius);
    float distance = v3_length(to_eye), reach = place->reach;
    float near = 0.7f * (distance - reach), far = distance + 2.0f * reach;
    out->distance = distance;
    out->camera = amb_camera_look(to_eye, to_target, from->up, from->vertical_fov, near > 0.005f ? near : 0.005f, far,
                                  width, height);
    v3 ahead = v3_normalize(v3_sub(from->target, from->position));
    float along = -v3_dot(to_eye, ahead);
    v3 off = v3_add(to_eye, v3_scale(ahead, along));
    float half_height = amb_tan(0.5f * from->vertical_fov), aspect = (float)width / (float)height;
    float corner = half_height * __builtin_sqrtf(1.0f + aspect * aspect); /* tangent of the half diagonal */
    float slack = reach * __builtin_sqrtf(1.0f + corner * corner);
    bool outside = along < -reach || v3_length(off) > along * corner + slack;
    bool too_small = half_height * 2.0f * distance > reach * 4.0f * (float)height; /* under half a sample across */
    return !outside && !too_small;
}

/* Depth 0…1 of the matrix to from … from + share of the whole range. */
static m4 depth_share(m4 world_to_clip, float from, float share)
{
    v4 z = world_to_clip.row[2], w = world_to_clip.row[3];
    world_to_clip.row[2] =
        (v4){from * w.x + share * z.x, from * w.y + share * z.y, from * w.z + share * z.z, from * w.w + share * z.w};
    return world_to_clip;
}

static void far_to_near(solar_body_view *view, const solar_place *place, int count)
{
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0; k--) {
            float here = view[k].distance * place[view[k].body].radius;
            float before = view[k - 1].distance * place[view[k - 1].body].radius;
            if (here <= before)
                break;
            solar_body_view swap = view[k];
            view[k] = view[k - 1];
            view[k - 1] = swap;
        }
}

typedef struct solar_fade {
    float factor;
} solar_fade;
static void solar_fade_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    f32x factor = f_set(((const solar_fade *)in->uniforms)->factor);
    out->color[0] = (v4x){factor, factor, factor, f_set(1.0f)};
}

/* Light left at a time of the flight: smooth steps at both ends. */
static float solar_fade_at(const solar_params *p, float time)
{
    float factor = p->fade;
    float parts[2][2] = {{time, p->fade_in}, {SOLAR_SECONDS - time, p->fade_out}};
    for (int i = 0; i < 2; i++)
        if (parts[i][0] < parts[i][1]) {
            float x = parts[i][0] / parts[i][1];
            factor *= x * x * (3.0f - 2.0f * x);
        }
    return factor;
}

static amb_status solar_draw(const solar_state *state, const amb_scene_job *job, const amb_canvas *canvas,
                             amb_error *error)
{
    const solar_params *p = job->params;
    float time = planet_loop_time(job->time, SOLAR_SECONDS);
    solar_place place[SOLAR_BODIES];
    amb_camera_key key[SOLAR_KEYS];
    solar_body_view seen[SOLAR_BODIES];
    solar_places(place);
    amb_camera camera = amb_camera_at(key, solar_path(place, key), time, SOLAR_FOV * (AMB_PI / 180.0f), 0.01f, 1000.0f,
                                      canvas->width, canvas->height);
    int count = 0;
    for (int i = 0; i < SOLAR_BODIES; i++) {
        seen[count].body = i;
        count += solar_look(&place[i], &camera, canvas->width, canvas->height, &seen[count]);
    }
    far_to_near(seen, place, count);

    planet_view sky = planet_view_of(state->body[0], &p->planet, job->time, canvas, &camera);
    amb_status status = planet_sky_draw(canvas->pass, &planet_sky_of_stars, &sky, error);
    for (int i = 0; i < count && status == AMB_OK; i++) {
        int b = seen[i].body;
        planet_view view = planet_view_of(state->body[b], state->params[b], job->time, canvas, &seen[i].camera);
        view.world_to_clip =
            depth_share(view.world_to_clip, (float)(count - 1 - i) / (float)count, 1.0f / (float)count);
        view.sun_rgb = v3_scale(view.sun_rgb, p->planet.exposure);
        if (b > 0)
            view.to_sun = v3_normalize(v3_neg(place[b].centre));
        status = bodies[b].body->draw(state->body[b], state->params[b], &view, job->time, canvas->pass, error);
    }
    solar_fade fade = {solar_fade_at(p, time)};
    amb_draw draw = planet_sky_of_stars.background;
    draw.label = "fade";
    draw.fragment = solar_fade_fragment;
    draw.uniforms = &fade;
    draw.uniforms_size = sizeof fade;
    draw.blend[0] = AMB_BLEND_MULTIPLY;
    return status == AMB_OK && fade.factor < 1.0f ? amb_pass_draw(canvas->pass, &draw, error) : status;
}

static amb_status solar_frame(const void *state, const amb_scene_job *job, amb_error *error)
{
    const solar_params *p = job->params;
    amb_canvas canvas;
    amb_status status = canvas_begin(job, solar_aovs, PLANET_AOVS, p->planet.samples, &canvas, error);
    if (status == AMB_OK)
        status = canvas_finish(job, solar_aovs, &canvas, solar_draw(state, job, &canvas, error), error);
    return status;
}

const amb_scene WIDE(amb_scene_solar) = {
    .name = "solar",
    .about = "one flight from the sun past all the planets",
    .seconds = SOLAR_SECONDS,
    .params = {solar_table, sizeof solar_table / sizeof *solar_table, sizeof(solar_params)},
    .aovs = solar_aovs,
    .aov_count = PLANET_AOVS,
    .post = "bloom:threshold=1.0,intensity=0.35;display:curve=aces",
    .load = solar_load,
    .frame = solar_frame,
    .unload = solar_unload,
};
