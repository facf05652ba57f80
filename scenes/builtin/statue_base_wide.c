/* The plinth: a round, moulded pedestal of revolution, and the low rock she stands on. */
#include "scenes/builtin/statue.h"

/* Union of stacked discs with rounded edges, as plane distances in (radius, y). */
static f32x disc(f32x radial, f32x y, float radius, float bottom, float top, float round)
{
    float middle = 0.5f * (bottom + top), half = 0.5f * (top - bottom) - round;
    return sdf_corner(radial - (radius - round), f_abs(y - middle) - half) - round;
}

f32x statue_base(v3x p)
{
    f32x radial = f_sqrt(p.x * p.x + p.z * p.z);
    f32x d = disc(radial, p.y, 0.268f, -0.135f, -0.105f, 0.004f);
    d = sdf_smooth_union(d, disc(radial, p.y, 0.256f, -0.109f, -0.087f, 0.0105f), 0.005f);
    d = sdf_smooth_union(d, disc(radial, p.y, 0.232f, -0.1f, -0.03f, 0.005f), 0.005f);
    d = sdf_smooth_union(d, disc(radial, p.y, 0.246f, -0.036f, -0.018f, 0.0085f), 0.005f);
    d = sdf_smooth_union(d, disc(radial, p.y, 0.239f, -0.03f, 0.0f, 0.004f), 0.005f);
    /* A hollow moulding around the drum. */
    f32x hollow = f_sqrt((radial - 0.254f) * (radial - 0.254f) + (p.y + 0.0605f) * (p.y + 0.0605f)) - 0.028f;
    return sdf_smooth_subtract(d, hollow, 0.008f);
}
