/* Clusters of neighbouring triangles: the primitives of the tree. */
#include "march/rays_internal.h"

#define BINS 16

typedef struct bin {
    v3 lo, hi;
    uint32_t count;
} bin;

static const bin empty_bin = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}, 0};

static void grow(bin *b, v3 lo, v3 hi, uint32_t count)
{
    b->lo = v3_min(b->lo, lo);
    b->hi = v3_max(b->hi, hi);
    b->count += count;
}

/* Half the surface of the bounds times the clusters needed: the expected work of testing them. */
static double cost(const bin *b)
{
    if (b->count == 0)
        return 0;
    double x = (double)b->hi.x - (double)b->lo.x, y = (double)b->hi.y - (double)b->lo.y;
    double z = (double)b->hi.z - (double)b->lo.z;
    return ((x * y + y * z) + z * x) * (double)((b->count + AMB_CLUSTER - 1) / AMB_CLUSTER);
}

static float axis_of(v3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/* Twice the centre of the reference's box on one axis, halved before adding so that it cannot overflow. */
static float middle(const amb_reference *r, int axis)
{
    return 0.5f * axis_of(r->lo, axis) + 0.5f * axis_of(r->hi, axis);
}

typedef struct split {
    int axis, bin;
    float lo, scale;
} split;

static int bin_of(const amb_reference *r, const split *s)
{
    int b = (int)((middle(r, s->axis) - s->lo) * s->scale);
    return b < 0 ? 0 : b >= BINS ? BINS - 1 : b;
}

/* The cheapest of the 3·(BINS - 1) planes; bin < 0 when all centres coincide. */
static split best_split(const amb_reference *reference, uint32_t count)
{
    v3 lo = empty_bin.lo, hi = empty_bin.hi;
    for (uint32_t i = 0; i < count; i++) {
        v3 m = {middle(&reference[i], 0), middle(&reference[i], 1), middle(&reference[i], 2)};
        lo = v3_min(lo, m);
        hi = v3_max(hi, m);
    }
    split best = {.bin = -1};
    double least = 0;
    for (int axis = 0; axis < 3; axis++) {
        float extent = axis_of(hi, axis) - axis_of(lo, axis);
        split s = {axis, -1, axis_of(lo, axis), (float)BINS / extent};
        if (!(extent > 0) || !(s.scale <= FLT_MAX))
            continue;
        bin bins[BINS], left[BINS];
        for (int b = 0; b < BINS; b++)
            bins[b] = empty_bin;
        for (uint32_t i = 0; i < count; i++)
            grow(&bins[bin_of(&reference[i], &s)], reference[i].lo, reference[i].hi, 1);
        left[0] = bins[0];
        for (int b = 1; b < BINS; b++) {
            left[b] = left[b - 1];
            grow(&left[b], bins[b].lo, bins[b].hi, bins[b].count);
        }
        bin right = empty_bin;
        for (int b = BINS - 1; b > 0; b--) {
            grow(&right, bins[b].lo, bins[b].hi, bins[b].count);
            if (right.count == 0 || left[b - 1].count == 0)
                continue;
            double c = cost(&left[b - 1]) + cost(&right);
            if (best.bin < 0 || c < least) {
                least = c;
                s.bin = b;
                best = s;
            }
        }
    }
    return best;
}

/* Number of references moved to the front half. */
static uint32_t divide(amb_reference *reference, uint32_t count)
{
    split s = best_split(reference, count);
    if (s.bin < 0)
        return count / 2;
    uint32_t front = 0;
    for (uint32_t i = 0; i < count; i++)
        if (bin_of(&reference[i], &s) < s.bin) {
            amb_reference r = reference[i];
            reference[i] = reference[front];
            reference[front++] = r;
        }
    return front;
}

void amb_cluster_build(amb_reference *reference, uint32_t count,
                       void (*emit)(void *user, const amb_reference *first, uint32_t n), void *user)
{
    /* The larger half waits and the smaller is divided first, so at most log2(2³²) ranges wait. */
    struct {
        uint32_t first, count;
    } waiting[33];
    int depth = 0;
    uint32_t first = 0, n = count;
    while (n > 0) {
        if (n > AMB_CLUSTER) {
            uint32_t front = divide(reference + first, n);
            bool front_waits = front > n - front;
            waiting[depth].first = front_waits ? first : first + front;
            waiting[depth++].count = front_waits ? front : n - front;
            first = front_waits ? first + front : first;
            n = front_waits ? n - front : front;
            continue;
        }
        emit(user, reference + first, n);
        n = 0;
        if (depth > 0) {
            first = waiting[--depth].first;
            n = waiting[depth].count;
        }
    }
}
