/* Air around a planet, as three draws (Ambiance report, Earth): a multiplicative sphere that dims the ground, an
 * additive sphere with the light scattered in front of it, and the sky dome, a larger sphere seen from inside, behind
 * the planet. */
#ifndef AMB_SCENES_PLANET_AIR_WIDE_H
#define AMB_SCENES_PLANET_AIR_WIDE_H

#include "scenes/planet_wide.h"
#include "shade/atmosphere.h"

typedef struct planet_air {
    planet_view view;
    amb_atmosphere air;
    float ground_gain, dome_gain; /* factors on the light scattered before the ground and in the dome */
    int only;                     /* 0 both scatterings; 1 molecules; 2 aerosols: to look at one alone */
} planet_air;

/* Parameters of the air and their rows, for the struct `type` with a member `air`. */
typedef struct planet_air_params {
    float height, scale_height; /* of the air's end over the ground and H0, planet radii */
    v3 rayleigh;                /* optical depth straight up, by colour */
    float mie, asymmetry;
    v3 sunlight; /* colour of the light that is scattered */
    float ground, dome;
    int samples, only;
} planet_air_params;
static const char *const planet_air_only[] = {"both", "rayleigh", "mie", NULL};
#define PLANET_AIR_ROWS(type, top, h0, r, g, b, mie_depth, mie_g, sun_r, sun_g, sun_b, ground_gain, dome_gain)           \
    {"air_height",        AMB_PARAM_FLOAT, "radii", 0.001f, 0.5f, {top}, NULL, offsetof(type, air.height),               \
     "where the air ends"},                                                                                              \
        {"air_scale_height",                                                                                             \
         AMB_PARAM_FLOAT,                                                                                                \
         "radii",                                                                                                        \
         0.0002f,                                                                                                        \
         0.2f,                                                                                                           \
         {h0},                                                                                                           \
         NULL,                                                                                                           \
         offsetof(type, air.scale_height),                                                                               \
         "height over which its density falls to 1/e"},                                                                  \
        {"rayleigh",                                                                                                     \
         AMB_PARAM_COLOR,                                                                                                \
         "",                                                                                                             \
         0,                                                                                                              \
         10,                                                                                                             \
         {r, g, b},                                                                                                      \
         NULL,                                                                                                           \
         offsetof(type, air.rayleigh),                                                                                   \
         "optical depth of molecules straight up, by colour"},                                                           \
        {"mie",                                                                                                          \
         AMB_PARAM_FLOAT,                                                                                                \
         "",                                                                                                             \
         0,                                                                                                              \
         10,                                                                                                             \
         {mie_depth},                                                                                                    \
         NULL,                                                                                                           \
         offsetof(type, air.mie),                                                                                        \
         "optical depth of aerosols straight up"},                                                                       \
        {"mie_asymmetry",                                                                                                \
         AMB_PARAM_FLOAT,                                                                                                \
         "",                                                                                                             \
         -0.95f,                                                                                                         \
         0.95f,                                                                                                          \
         {mie_g},                                                                                                        \
         NULL,                                                                                                           \
         offsetof(type, air.asymmetry),                                                                                  \
         "g of the aerosols' phase function"},                                                                           \
        {"air_sunlight",                                                                                                 \
         AMB_PARAM_COLOR,                                                                                                \
         "",                                                                                                             \
         0,                                                                                                              \
         10,                                                                                                             \
         {sun_r, sun_g, sun_b},                                                                                          \
         NULL,                                                                                                           \
         offsetof(type, air.sunlight),                                                                                   \
         "colour of the sunlight that is scattered"},                                                                    \
        {"air_ground",                                                                                                   \
         AMB_PARAM_FLOAT,                                                                                                \
         "",                                                                                                             \
         0,                                                                                                              \
         10,                                                                                                             \
         {ground_gain},                                                                                                  \
         NULL,                                                                                                           \
         offsetof(type, air.ground),                                                                                     \
         "factor on the scattering in front of the ground"},                                                             \
        {"air_dome", AMB_PARAM_FLOAT, "", 0, 10, {dome_gain}, NULL, offsetof(type, air.dome), "factor on the sky dome"}, \
        {"air_samples",           AMB_PARAM_INT, "", 1, ATMOSPHERE_SAMPLES, {12}, NULL, offsetof(type, air.samples),     \
         "segments of a view ray"},                                                                                      \
    {                                                                                                                    \
        "air_only", AMB_PARAM_CHOICE, "", 0, 0, {0}, planet_air_only, offsetof(type, air.only),                          \
            "scattering of molecules or aerosols alone"                                                                  \
    }

AMB_INLINE amb_atmosphere planet_atmosphere(const planet_air_params *p, v3 sun_rgb)
{
    float per_length = 1.0f / p->scale_height;
    amb_atmosphere air = {.radius = 1.0f,
                          .top = 1.0f + p->height,
                          .scale_height = p->scale_height,
                          .rayleigh = v3_scale(p->rayleigh, p->only == 2 ? 0.0f : per_length),
                          .asymmetry = p->asymmetry,
                          .sun_rgb = v3_mul(p->sunlight, sun_rgb),
                          .sun_softness = 0.0093f,
                          .samples = p->samples};
    float aerosols = p->only == 1 ? 0.0f : p->mie * per_length;
    air.mie = (v3){aerosols, aerosols, aerosols};
    amb_atmosphere_fit(&air);
    return air;
}

/* Light that reaches the ground's height under a sun of that zenith cosine: of what is scattered out of the sun's rays
 * about half comes down as skylight, so depth counts half. Reddens the ground at the terminator. */
AMB_INLINE v3x planet_sunlight_at_ground(const amb_atmosphere *air, f32x zenith_cosine)
{
    f32x depth = 0.5f * atmosphere_depth(air, f_set(1.0f), f_max(zenith_cosine, f_set(-0.03f)));
    v3x scatter = v3x_splat(v3_add(air->rayleigh, air->mie));
    return (v3x){f_exp(-scatter.x * depth), f_exp(-scatter.y * depth), f_exp(-scatter.z * depth)};
}

/* Air between the eye and the shell's point. */
AMB_INLINE atmosphere_light planet_air_to(const planet_air *u, v3x world)
{
    v3x eye = v3x_splat(u->view.eye), way = v3x_sub(world, eye);
    f32x distance = v3x_length(way), enter, leave;
    v3x direction = v3x_scale(way, 1.0f / f_max(distance, f_set(FLT_MIN)));
    maskx meets = atmosphere_sphere(eye, direction, u->air.top, &enter, &leave);
    f32x near = f_max(enter, f_set(0.0f));
    f32x far = f_sel(meets, f_min(distance, leave), near);
    return atmosphere_along(&u->air, eye, direction, near, far, u->view.to_sun);
}

AMB_INLINE void planet_air_attenuate(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_varyings *v = in->varyings;
    out->color[0] = v4x_of3(planet_air_to(in->uniforms, v->world).transmit, f_set(1.0f));
}
AMB_INLINE void planet_air_scatter(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_air *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    v3x light = planet_air_to(u, v->world).in_scatter;
    out->color[0] = v4x_of3(v3x_scale(light, f_set(u->ground_gain)), f_set(0.0f));
}
/* Both at once: the second colour is what multiplies the target. */
AMB_INLINE void planet_air_before_ground(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_air *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    atmosphere_light light = planet_air_to(u, v->world);
    out->color[0] = v4x_of3(v3x_scale(light.in_scatter, f_set(u->ground_gain)), f_set(0.0f));
    out->color[1] = v4x_of3(light.transmit, f_set(1.0f));
}
AMB_INLINE void planet_air_dome(const amb_fs_in *in, amb_fs_out *out)
{
    const planet_air *u = in->uniforms;
    const planet_varyings *v = in->varyings;
    v3x light = planet_air_to(u, v->world).in_scatter;
    out->color[0] = v4x_of3(v3x_scale(light, f_set(u->dome_gain)), f_set(0.0f));
}

/* The air before the ground: a multiplicative and an additive sphere in one draw where the pass has a single attachment
 * (the only one that two colours can go to), else in two. The result is the same bit by bit. */
AMB_INLINE amb_status planet_air_before_draw(amb_pass *pass, const planet_air *u, amb_error *error)
{
    int show = u->view.show;
    bool both = show == PLANET_SHOW_BEAUTY;
    amb_draw dim = planet_shell_draw("air, dimming", planet_vertex, planet_air_attenuate, &u->view, sizeof *u);
    dim.depth_compare = AMB_ALWAYS;
    dim.depth_write_off = true;
    dim.targets_off = ~1u;
    dim.blend[0] = AMB_BLEND_MULTIPLY;
    amb_draw scatter = dim, before = dim;
    scatter.label = "air, scattering";
    scatter.fragment = planet_air_scatter;
    scatter.blend[0] = AMB_BLEND_ADD;
    before.label = "air before the ground";
    before.fragment = planet_air_before_ground;
    before.blend[0] = AMB_BLEND_EQUATION;
    before.equation[0] = (amb_blend_equation){.color_source = AMB_FACTOR_ONE,
                                              .color_target = AMB_FACTOR_SECOND,
                                              .alpha_source = AMB_FACTOR_ONE,
                                              .alpha_target = AMB_FACTOR_ONE};
    if (both && u->view.attachments == 1)
        return amb_pass_draw(pass, &before, error);
    amb_status status = both || show == PLANET_SHOW_ATTENUATION ? amb_pass_draw(pass, &dim, error) : AMB_OK;
    if (status == AMB_OK && (both || show == PLANET_SHOW_SCATTERING))
        status = amb_pass_draw(pass, &scatter, error);
    return status;
}

/* Records the air, or the part that the view shows alone; call it after everything on the planet. */
AMB_INLINE amb_status planet_air_draw(amb_pass *pass, planet_air *u, amb_error *error)
{
    u->view.shell = 1.0f;
    amb_status status = planet_air_before_draw(pass, u, error);
    if (status != AMB_OK || (u->view.show != PLANET_SHOW_BEAUTY && u->view.show != PLANET_SHOW_SCATTERING))
        return status;
    u->view.shell = u->air.top;
    amb_draw dome = planet_shell_draw("sky dome", planet_vertex, planet_air_dome, &u->view, sizeof *u);
    dome.cull = AMB_CULL_FRONT;
    dome.depth_compare = AMB_LESS;
    dome.depth_write_off = true;
    dome.targets_off = ~1u;
    dome.blend[0] = AMB_BLEND_ADD;
    return amb_pass_draw(pass, &dome, error);
}

#endif
