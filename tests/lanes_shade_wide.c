/* Every shading function as a case. */
#include "lanes.h"
#include <shade/color.h>
#include <shade/diffuse.h>
#include <shade/fog.h>
#include <shade/fresnel.h>
#include <shade/light.h>
#include <shade/normal_map.h>
#include <shade/phase.h>
#include <shade/ring.h>
#include <shade/specular.h>
#include <shade/waves.h>

#define V3(i) ((v3x){in[i], in[(i) + 1], in[(i) + 2]})
AMB_INLINE void write(v3x v, f32x *out) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

LANES_CASE(lambert, 1, 1, { out[0] = diffuse_lambert(in[0]); })
LANES_CASE(wrapped, 1, 1, { out[0] = diffuse_wrapped(in[0], 0.4f); })
LANES_CASE(wrapped_contrast, 1, 1, { out[0] = diffuse_wrapped_contrast(in[0], 0.4f, 0.47f); })
LANES_CASE(wrapped_tinted, 1, 3, { write(diffuse_wrapped_tinted(in[0], 0.4f, (v3){0.2f, 0.9f, 0.5f}), out); })
LANES_CASE(night, 1, 1, { out[0] = diffuse_night(in[0]); })
LANES_CASE(ring, 1, 1, { out[0] = view_aligned_ring(in[0], 3.5f); })
LANES_CASE(phong, 9, 1, { out[0] = specular_phong(V3(0), V3(3), V3(6), 24.0f); })
LANES_CASE(blinn_phong, 9, 1, { out[0] = specular_blinn_phong(V3(0), V3(3), V3(6), 24.0f); })
LANES_CASE(beckmann, 1, 1, { out[0] = specular_beckmann(in[0], 0.3f); })
LANES_CASE(cook_torrance, 9, 1, { out[0] = specular_cook_torrance(V3(0), V3(3), V3(6), 0.3f); })
LANES_CASE(schlick, 2, 1, { out[0] = fresnel_schlick(in[0], in[1]); })
LANES_CASE(fresnel_k, 1, 1, { out[0] = fresnel_power(in[0], 2.5f); })
LANES_CASE(dielectric, 1, 1, { out[0] = fresnel_dielectric(in[0], 1.5f); })
LANES_CASE(decode, 3, 3, { write(normal_map_decode(V3(0), 0.7f), out); })
LANES_CASE(apply, 12, 3, { write(normal_map_apply(V3(0), V3(3), V3(6), V3(9)), out); })
LANES_CASE(to_tangent, 12, 3, { write(normal_map_to_tangent(V3(0), V3(3), V3(6), V3(9)), out); })
LANES_CASE(slopes, 2, 3, { write(normal_of_slopes(in[0], in[1]), out); })
LANES_CASE(parallax, 6, 2, {
    v2x uv = parallax_offset((v2x){in[0], in[1]}, V3(2), in[5], 0.04f, -0.02f);
    out[0] = uv.x, out[1] = uv.y;
})
LANES_CASE(srgb, 1, 2, { out[0] = color_srgb_decode(in[0]), out[1] = color_srgb_encode(in[0]); })
LANES_CASE(xyz, 3, 3, { write(color_xyz_of_rgb(V3(0)), out); })
LANES_CASE(rgb, 3, 3, { write(color_rgb_of_xyz(V3(0)), out); })
LANES_CASE(lab, 3, 3, { write(color_lab_of_rgb(V3(0)), out); })
LANES_CASE(luminance, 3, 1, { out[0] = color_luminance(V3(0)); })
LANES_CASE(phase, 1, 3, {
    out[0] = phase_rayleigh(in[0]), out[1] = phase_henyey_greenstein(in[0], 0.76f), out[2] = phase_mie(in[0], -0.95f);
})
LANES_CASE(fog, 3, 1, { out[0] = fog_depth(in[0], in[1], in[2], 0.02f, 0.3f); })
LANES_CASE(ring_light, 4, 2, {
    out[0] = ring_scatter(in[0], in[1], in[2]);
    out[1] = ring_planet_shadow(V3(0), (v3x){f_set(0.6f), f_set(0.0f), f_set(0.8f)}, 1.5f, 4.0f);
})
LANES_CASE(spot, 3, 4, {
    static const amb_light light = {.kind = AMB_LIGHT_SPOT,
                                    .position = {0.2f, 0.1f, -0.3f},
                                    .reach = 3.0f,
                                    .axis = {0.6f, 0.0f, 0.8f},
                                    .cos_inner = 0.9f,
                                    .cos_outer = 0.2f};
    amb_arriving a = light_at(&light, V3(0));
    write(a.to_light, out), out[3] = a.strength;
})
LANES_CASE(layered, 11, 2, {
    amb_response r = light_cook_torrance(V3(0), V3(3), V3(6), in[9], in[10]);
    out[0] = r.diffuse, out[1] = r.specular;
})
LANES_CASE(coursework, 11, 2, {
    amb_response r = light_blinn_phong(V3(0), V3(3), V3(6), in[9], in[10]);
    out[0] = r.diffuse, out[1] = r.specular;
})
LANES_CASE(waves, 3, 8, {
    for (int noise = 0; noise < 2; noise++) {
        amb_waves w = {.height = 0.6f, .frequency = 0.9f, .speed = 1.7f, .noise = noise != 0, .count = 4};
        waves_at_time(&w, 3.5);
        amb_wave wave = waves_at(&w, (v2x){in[0], in[1]}, in[2]);
        out[4 * noise] = wave.height, out[4 * noise + 1] = wave.slope.x;
        out[4 * noise + 2] = wave.slope.y, out[4 * noise + 3] = wave.roughness;
    }
})

const lanes_case WIDE(lanes_shade)[] = {LANES_ENTRY(lambert, 1, 1),
                                        LANES_ENTRY(wrapped, 1, 1),
                                        LANES_ENTRY(wrapped_contrast, 1, 1),
                                        LANES_ENTRY(wrapped_tinted, 1, 3),
                                        LANES_ENTRY(night, 1, 1),
                                        LANES_ENTRY(ring, 1, 1),
                                        LANES_ENTRY(phong, 9, 1),
                                        LANES_ENTRY(blinn_phong, 9, 1),
                                        LANES_ENTRY(beckmann, 1, 1),
                                        LANES_ENTRY(cook_torrance, 9, 1),
                                        LANES_ENTRY(schlick, 2, 1),
                                        LANES_ENTRY(fresnel_k, 1, 1),
                                        LANES_ENTRY(dielectric, 1, 1),
                                        LANES_ENTRY(decode, 3, 3),
                                        LANES_ENTRY(apply, 12, 3),
                                        LANES_ENTRY(to_tangent, 12, 3),
                                        LANES_ENTRY(slopes, 2, 3),
                                        LANES_ENTRY(parallax, 6, 2),
                                        LANES_ENTRY(srgb, 1, 2),
                                        LANES_ENTRY(xyz, 3, 3),
                                        LANES_ENTRY(rgb, 3, 3),
                                        LANES_ENTRY(lab, 3, 3),
                                        LANES_ENTRY(luminance, 3, 1),
                                        LANES_ENTRY(phase, 1, 3),
                                        LANES_ENTRY(fog, 3, 1),
                                        LANES_ENTRY(ring_light, 4, 2),
                                        LANES_ENTRY(spot, 3, 4),
                                        LANES_ENTRY(layered, 11, 2),
                                        LANES_ENTRY(coursework, 11, 2),
                                        LANES_ENTRY(waves, 3, 8),
                                        {0}};
