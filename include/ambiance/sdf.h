/* Signed distance fields: primitives, blends and changes of space, to be combined with plain operators.
 *
 * Every function gives world units, negative inside. "Exact" means the Euclidean distance to the surface; "bound" means
 * zero on the surface, the right sign, gradient of length near 1 there, and a magnitude that may differ farther away
 * (its comment says which way). Points p are one a lane; sizes are uniform unless typed f32x. All is + - * / sqrt and
 * math.h: the same bits at every width. Pure functions; any thread.
 *
 * The method is that of J. C. Hart, "Sphere tracing" (The Visual Computer 12, 1996), whose appendix derives most exact
 * distances used here; the polynomial blends follow A. Ricci's constructive geometry (Computer Journal 16, 1973) in the
 * compact-support form that is common today. */
#ifndef AMBIANCE_SDF_H
#define AMBIANCE_SDF_H

#include <ambiance/math.h>
#include <ambiance/vec.h>

/* ---- primitives, centred at the origin unless points are given --------------------------------------------------- */

AMB_INLINE f32x sdf_sphere(v3x p, float radius) { return v3x_length(p) - radius; } /* exact */

/* Exact. `normal` is unit; the solid is where dot(p, normal) < offset. */
AMB_INLINE f32x sdf_half_space(v3x p, v3 normal, float offset) { return v3x_dot(p, v3x_splat(normal)) - offset; }

/* Bound, first order: f / |grad f| with f = |p/radii| - 1 scaled to length. Radii > 0. At most twice too large and
 * never of the wrong sign for radii within 3 : 1. */
AMB_INLINE f32x sdf_ellipsoid(v3x p, v3 radii)
{
    v3x unit = v3x_mul(p, v3x_splat((v3){1.0f / radii.x, 1.0f / radii.y, 1.0f / radii.z}));
    v3x steep = v3x_mul(unit, v3x_splat((v3){1.0f / radii.x, 1.0f / radii.y, 1.0f / radii.z}));
    f32x length = v3x_length(unit);
    f32x gradient = f_max(v3x_length(steep), f_set(1e-12f));
    /* At the centre 0/0; there the nearest surface is at most the smallest radius away. */
    float least = amb_s_min(radii.x, amb_s_min(radii.y, radii.z));
    f32x bound = length * (length - 1.0f) / gradient;
    return f_sel(length < 1e-3f, f_set(-least), bound);
}

/* Where p projects on the segment a…b, 0…1, unclamped. a != b. */
AMB_INLINE f32x sdf_segment_parameter(v3x p, v3 a, v3 b)
{
    v3 ab = v3_sub(b, a);
    return v3x_dot(v3x_sub(p, v3x_splat(a)), v3x_splat(v3_scale(ab, 1.0f / v3_dot(ab, ab))));
}

/* Exact: all points within radius of the segment a…b. */
AMB_INLINE f32x sdf_capsule(v3x p, v3 a, v3 b, float radius)
{
    f32x t = f_saturate(sdf_segment_parameter(p, a, b));
    v3x nearest = v3x_add(v3x_splat(a), v3x_scale(v3x_splat(v3_sub(b, a)), t));
    return v3x_length(v3x_sub(p, nearest)) - radius;
}

/* Exact outside and on the surface: hull of two spheres, |radius_a - radius_b| < |b - a|. The nearest sphere of the
 * swept family lies where the slanted side's normal through p meets the axis: at axial x - radial·s/c, with s the sine
 * of the cone's half angle. */
AMB_INLINE f32x sdf_round_cone(v3x p, v3 a, v3 b, float radius_a, float radius_b)
{
    v3 ab = v3_sub(b, a);
    float length = v3_length(ab), sine = (radius_a - radius_b) / length;
    float cosine = __builtin_sqrtf(1.0f - sine * sine);
    v3x q = v3x_sub(p, v3x_splat(a));
    f32x axial = v3x_dot(q, v3x_splat(v3_scale(ab, 1.0f / length)));
    f32x radial = f_sqrt(f_max(v3x_dot(q, q) - axial * axial, f_set(0.0f)));
    f32x foot = f_clamp(axial - radial * (sine / cosine), f_set(0.0f), f_set(length));
    f32x along = axial - foot;
    return f_sqrt(along * along + radial * radial) - (radius_a - sine * foot);
}

/* Exact: circle of radius `major` in the xz plane, swept by a ball of radius `minor`. */
AMB_INLINE f32x sdf_torus(v3x p, float major, float minor)
{
    f32x ring = f_sqrt(p.x * p.x + p.z * p.z) - major;
    return f_sqrt(ring * ring + p.y * p.y) - minor;
}

/* Combines distances along two orthogonal directions into that of their intersection (exact for exact inputs). */
AMB_INLINE f32x sdf_corner(f32x a, f32x b)
{
    f32x outer_a = f_max(a, f_set(0.0f)), outer_b = f_max(b, f_set(0.0f));
    return f_min(f_max(a, b), f_set(0.0f)) + f_sqrt(outer_a * outer_a + outer_b * outer_b);
}

/* Exact: |x| ≤ half.x and so on, edges rounded by `round` (0: sharp; the outer size stays). */
AMB_INLINE f32x sdf_box(v3x p, v3 half, float round)
{
    f32x x = f_abs(p.x) - (half.x - round), y = f_abs(p.y) - (half.y - round), z = f_abs(p.z) - (half.z - round);
    f32x ox = f_max(x, f_set(0.0f)), oy = f_max(y, f_set(0.0f)), oz = f_max(z, f_set(0.0f));
    return f_min(f_max(x, f_max(y, z)), f_set(0.0f)) + f_sqrt((ox * ox + oy * oy) + oz * oz) - round;
}

/* Exact: around the y axis, |y| ≤ half_height, edges rounded by `round`. */
AMB_INLINE f32x sdf_cylinder(v3x p, float radius, float half_height, float round)
{
    f32x side = f_sqrt(p.x * p.x + p.z * p.z) - (radius - round);
    return sdf_corner(side, f_abs(p.y) - (half_height - round)) - round;
}

/* Extrusion of a plane figure along a third axis: `figure` is the plane distance, `across` the coordinate along the
 * axis, half its half length. Exact when `figure` is. */
AMB_INLINE f32x sdf_extrude(f32x figure, f32x across, float half) { return sdf_corner(figure, f_abs(across) - half); }

/* ---- curves ------------------------------------------------------------------------------------------------------ */

typedef struct sdf_curve {
    f32x distance; /* to the curve itself: subtract a radius for a tube, one that varies with t for a taper */
    f32x t;        /* parameter of the nearest point, 0…1 */
} sdf_curve;

/* The quadratic Bézier curve a, b, c (b the control point). The nearest of nine samples starts four Newton steps on the
 * derivative of the squared distance (Gauss-Newton where the curvature term makes it concave), so the result is never
 * below the exact distance and meets it to a few units in the last place unless two nearest points compete. */
AMB_INLINE sdf_curve sdf_bezier(v3x p, v3 a, v3 b, v3 c)
{
    v3 first = v3_scale(v3_sub(b, a), 2.0f);             /* B'(0) */
    v3 second = v3_add(v3_sub(a, v3_scale(b, 2.0f)), c); /* B''/2 */
    v3x start = v3x_sub(v3x_splat(a), p), linear = v3x_splat(first), square = v3x_splat(second);
    f32x best = v3x_dot(start, start), t = f_set(0.0f);
    for (int i = 1; i <= 8; i++) {
        float s = (float)i * 0.125f;
        v3x offset = v3x_add(start, v3x_splat(v3_add(v3_scale(first, s), v3_scale(second, s * s))));
        f32x squared = v3x_dot(offset, offset);
        maskx nearer = squared < best;
        best = f_sel(nearer, squared, best);
        t = f_sel(nearer, f_set(s), t);
    }
    for (int i = 0; i < 4; i++) {
        v3x offset = v3x_add(start, v3x_scale(v3x_add(linear, v3x_scale(square, t)), t));
        v3x tangent = v3x_add(linear, v3x_scale(square, t + t));
        f32x slope = v3x_dot(offset, tangent), gauss = v3x_dot(tangent, tangent);
        f32x newton = gauss + 2.0f * v3x_dot(offset, square);
        f32x divisor = f_max(f_sel(newton > 0.25f * gauss, newton, gauss), f_set(1e-20f));
        t = f_saturate(t - slope / divisor);
    }
    v3x offset = v3x_add(start, v3x_scale(v3x_add(linear, v3x_scale(square, t)), t));
    f32x refined = v3x_dot(offset, offset);
    return (sdf_curve){f_sqrt(f_min(refined, best)), t};
}

/* ---- blends ------------------------------------------------------------------------------------------------------ */

/* Sharp; exact outside (union) or a lower bound. */
AMB_INLINE f32x sdf_union(f32x a, f32x b) { return f_min(a, b); }
AMB_INLINE f32x sdf_intersect(f32x a, f32x b) { return f_max(a, b); }
AMB_INLINE f32x sdf_subtract(f32x a, f32x b) { return f_max(a, -b); } /* a without b */

/* Union with a fillet: differs from the sharp one only where |a - b| < k, by at most k/4 (k > 0, world units); equals
 * it to the bit elsewhere, so a caller may leave out what is at least k farther. Gradient length stays ≤ 1. */
AMB_INLINE f32x sdf_smooth_union(f32x a, f32x b, float k)
{
    f32x overlap = f_max(k - f_abs(a - b), f_set(0.0f));
    return f_min(a, b) - overlap * overlap * (0.25f / k);
}
AMB_INLINE f32x sdf_smooth_intersect(f32x a, f32x b, float k) { return -sdf_smooth_union(-a, -b, k); }
AMB_INLINE f32x sdf_smooth_subtract(f32x a, f32x b, float k) { return -sdf_smooth_union(-a, b, k); }

/* |a| rounded over a width of about w: √(a² + w²) - w. For creases that should not be sharp. */
AMB_INLINE f32x sdf_smooth_abs(f32x a, float w) { return f_sqrt(a * a + w * w) - w; }

/* ---- changes of space -------------------------------------------------------------------------------------------- */

/* p in the frame whose axes are the (orthonormal) columns x, y, z at `origin`; distances are unchanged. */
typedef struct sdf_frame {
    v3 origin, x, y, z;
} sdf_frame;
AMB_INLINE v3x sdf_to_frame(v3x p, const sdf_frame *f)
{
    v3x q = v3x_sub(p, v3x_splat(f->origin));
    return (v3x){v3x_dot(q, v3x_splat(f->x)), v3x_dot(q, v3x_splat(f->y)), v3x_dot(q, v3x_splat(f->z))};
}

/* Turns p about the y axis by angle (radians, +x towards +z). */
AMB_INLINE v3x sdf_turn(v3x p, f32x angle)
{
    f32x s = f_sin(angle), c = f_cos(angle);
    return (v3x){c * p.x - s * p.z, p.y, s * p.x + c * p.z};
}

/* Twist about the y axis. A distance evaluated at the result has gradients up to √(1 + (radians_per_unit · r)²) at
 * distance r from the axis: divide by that for a bound. */
AMB_INLINE v3x sdf_twist(v3x p, float radians_per_unit) { return sdf_turn(p, p.y * radians_per_unit); }

/* Displaces a surface outwards by `height`. The sum's gradient is at most 1 + |grad height|. */
AMB_INLINE f32x sdf_displace(f32x distance, f32x height) { return distance - height; }

#endif
