/* A paper lantern in the evening: a shader of your own, run by the rasterizer, written as EXR and PNG. */
#include <ambiance/camera.h>
#include <ambiance/io.h>
#include <ambiance/post.h>
#include <ambiance/raster.h>
#include <stdio.h>

typedef struct {
    f32x height;
    v3x normal;
} lantern_varyings; /* one value a lane */
typedef struct {
    m4 world_to_clip;
    const amb_mesh *ball;
    v3 to_sun, sun_rgb, glow_rgb;
} lantern_uniforms;

static void lantern_vertex(const amb_vs_in *in, amb_vs_out *out)
{
    const lantern_uniforms *u = in->uniforms;
    v3x position = v3x_gather(u->ball->position, in->vertex);
    *(lantern_varyings *)out->varyings = (lantern_varyings){position.y, v3x_gather(u->ball->normal, in->vertex)};
    out->clip = m4_project_x(u->world_to_clip, position);
}

/* Lambert sun on paper that glows between its ribs. */
static void lantern_fragment(const amb_fs_in *in, amb_fs_out *out)
{
    const lantern_varyings *v = in->varyings;
    const lantern_uniforms *u = in->uniforms;
    f32x facing = f_saturate(v3x_dot(v3x_normalize(v->normal), v3x_splat(u->to_sun)));
    f32x paper = f_smoothstep(f_set(0.0f), f_set(0.2f), f_fract(v->height * 6.0f));
    v3x glow = v3x_scale(v3x_splat(u->glow_rgb), paper * (1.0f - 0.5f * v->height));
    out->color[0] = v4x_of3(v3x_add(v3x_scale(v3x_splat(u->sun_rgb), facing), glow), f_set(1.0f));
}

int main(void)
{
    const v3 eye = {0, 0.5f, 4}, target = {0, 0, 0}, up = {0, 1, 0};
    amb_error error;
    amb_context *context;
    amb_frame *frame;
    amb_mesh *ball;
    amb_pass *pass;
    amb_chain *chain;
    if (amb_context_create(&(amb_context_options){.isa = AMB_LANES}, &context, &error) ||
        amb_frame_create(640, 480, &frame, &error) || amb_mesh_sphere(32, 64, &ball, &error) ||
        amb_pass_begin(context, &(amb_target){.color = {frame->layer[0].image}}, &pass, &error))
        return fprintf(stderr, "%s\n", error.detail), 1;

    lantern_uniforms uniforms = {amb_camera_look(eye, target, up, 0.7f, 0.1f, 100, 640, 480).world_to_clip,
                                 ball,
                                 v3_normalize((v3){-3, 1, 1}),
                                 {0.4f, 0.3f, 0.5f},
                                 {1.2f, 0.5f, 0.1f}};
    amb_draw draw = {.lanes = AMB_LANES,
                     .vertex = lantern_vertex,
                     .fragment = lantern_fragment,
                     .cull = AMB_CULL_BACK,
                     .uniforms = &uniforms,
                     .uniforms_size = sizeof uniforms,
                     .varying_floats = sizeof(lantern_varyings) / sizeof(f32x),
                     .indices = ball->index,
                     .count = 3 * ball->triangle_count,
                     .vertex_count = ball->vertex_count};
    if (amb_pass_draw(pass, &draw, &error) || amb_pass_finish(&pass, NULL, &error) ||
        amb_write_exr(frame, "lantern.exr", AMB_FLOAT, &error) ||
        amb_chain_create(context, "bloom;display:curve=filmic", &chain, &error) ||
        amb_chain_apply(chain, frame, 0, 0, &error) || amb_write_png(frame->layer[0].image, "lantern.png", &error))
        return fprintf(stderr, "%s\n", error.detail), 1;

    amb_chain_close(&chain);
    amb_mesh_close(&ball);
    amb_frame_close(&frame);
    amb_context_close(&context);
    return 0;
}
