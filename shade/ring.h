/* Planetary rings: their scattering and the planet's shadow on them. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_RING_H
#define AMBIANCE_SHADE_RING_H

#include <ambiance/math.h>
#include <ambiance/vec.h>

/* lerp(other, back, wi·wo), wi to the light and wo to the eye (unit): `back` where the eye is on the light's side.
 * `other` is the forward scattering on the lit side of the ring plane, the unlit scattering on the other. The cosine is
 * clamped to [0, 1], so no texture is extrapolated. Ambiance report, Saturn. */
AMB_INLINE f32x ring_scatter(f32x back, f32x other, f32x wi_dot_wo)
{
    return f_lerp(other, back, f_saturate(wi_dot_wo));
}

/* Light left at p by a planet of `radius` around the origin: 1 outside its cylinder of shadow (and on the light's
 * side), e^(-sharpness·(radius - distance)) inside, from the distance of p's ray to the light from the centre. to_light
 * unit, sharpness > 0 per unit length. Ambiance report, Saturn. */
AMB_INLINE f32x ring_planet_shadow(v3x p, v3x to_light, float radius, float sharpness)
{
    f32x along = v3x_dot(p, to_light);
    f32x distance = v3x_length(v3x_sub(p, v3x_scale(to_light, along)));
    maskx shadowed = (along < 0.0f) & (distance < radius);
    return f_sel(shadowed, f_exp((distance - radius) * sharpness), f_set(1.0f));
}

#endif
