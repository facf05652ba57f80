#include "hillscape_probe.h"

#if AMB_LANES > 1

static hill_frame frame_of(const hill_probe *probe)
{
    hill_frame f = {.p = *probe->params, .state = probe->state, .patch = probe->state->patch};
    f.camera =
        amb_camera_look(probe->eye, v3_add(probe->eye, (v3){0, -0.2f, -1}), (v3){0, 1, 0}, 0.8f, 0.5f, 5000.0f, 64, 64);
    hill_lights_make(&f);
    return f;
}

/* From above, leaning: a graph over the picture as long as slope · lean < 1. */
static m4 leaning_view(const hill_probe *probe)
{
    float s = 1.0f / probe->half;
    m4 m = {{{s, probe->lean * s, 0, -probe->centre.x * s},
             {0, -probe->lean * s, -s, probe->centre.z * s},
             {0, 0, 0, 0.5f},
             {0, 0, 0, 1}}};
    return m;
}

/* Faces count by their side, so that a sheet that folds over still sums to one, and one that is torn does not. */
static void one(const amb_fs_in *in, amb_fs_out *out) { out->color[0].x = f_sel(in->front, f_set(1.0f), f_set(-1.0f)); }

static amb_hull_shader real_hull;
static void own_edges(const amb_hs_in *in, amb_hs_out *out)
{
    real_hull(in, out);
    maskx seen = out->edge[0] > 0.0f;
    for (int i = 0; i < 4; i++)
        out->edge[i] = f_sel(seen, out->inside[0], f_set(0.0f));
}

amb_status WIDE(hill_probe_cover)(const hill_probe *probe, amb_error *error)
{
    hill_frame f = frame_of(probe);
    hill_pass view = hill_pass_make(&f, leaning_view(probe), probe->eye, probe->count->height);
    amb_draw draw = hill_terrain_draw(&view);
    draw.fragment = one;
    draw.blend[0] = AMB_BLEND_ADD;
    draw.front_clockwise = true;
    if (probe->own_edges) {
        real_hull = draw.tessellation.hull;
        draw.tessellation.hull = own_edges;
    }
    amb_target target = {.color = {probe->count}};
    amb_pass *pass = NULL;
    amb_status status = amb_pass_begin(probe->context, &target, &pass, error);
    if (status == AMB_OK)
        status = amb_pass_draw(pass, &draw, error);
    if (status == AMB_OK)
        status = amb_pass_finish(&pass, NULL, error);
    amb_pass_close(&pass);
    return status;
}

void WIDE(hill_probe_edges)(const hill_probe *probe)
{
    hill_frame f = frame_of(probe);
    hill_pass view = hill_pass_make(&f, leaning_view(probe), probe->eye, 64);
    amb_draw draw = hill_terrain_draw(&view);
    for (int first = 0; first < HILL_PATCHES * HILL_PATCHES; first += AMB_LANES) {
        i32x corner[4], patch = i_lane_index() + first;
        for (int k = 0; k < 4; k++)
            corner[k] = u_as_i(u_gather(draw.indices, patch * 4 + k));
        amb_hs_out out = {.constants = NULL};
        draw.tessellation.hull(&(amb_hs_in){.uniforms = &view, .corner = corner, .patch = patch}, &out);
        for (int lane = 0; lane < AMB_LANES; lane++)
            for (int k = 0; k < 4; k++)
                probe->edge[4 * (first + lane) + k] = f_lane(out.edge[k], lane);
    }
}

bool WIDE(hill_probe_hidden)(const amb_rays *rays, v3 from, v3 way, float far)
{
    amb_rayx ray = {v3x_splat(from), v3x_splat(way), f_set(0.0f), f_set(far)};
    return m_any(amb_rays_occluded(rays, &ray, m_from_bits(1u)));
}

#endif
