#include "scenes/elevated_patches.h"

#include <stdlib.h>

/* Rings are nested squares [centre - reach, centre + reach)² of a level's sides; a centre is even, so that a ring's
 * outline lies on the next level's lattice. */
typedef struct ring {
    int level, x, z, reach;
    float side;
} ring;

static int even_nearest(float a)
{
    float half = a * 0.5f + 0.5f;
    int whole = (int)half;
    return 2 * ((float)whole > half ? whole - 1 : whole);
}

static ring ring_of(int level, v3 eye, float sight)
{
    ring r = {.level = level, .reach = PATCH_REACH, .side = PATCH_SIDE * (float)(1 << level)};
    r.x = even_nearest(eye.x / r.side);
    r.z = even_nearest(eye.z / r.side);
    int far = (int)(sight / r.side) + 2;
    if (level == PATCH_LEVELS - 1 && far > r.reach)
        r.reach = far;
    return r;
}

/* Whether the box over a patch is on the outer side of one of the picture's planes. */
static bool outside(v3 corner, v3 size, m4 world_to_clip)
{
    int out[5] = {0};
    for (int i = 0; i < 8; i++) {
        v3 p = {corner.x + ((i & 1) ? size.x : 0.0f), corner.y + ((i & 2) ? size.y : 0.0f),
                corner.z + ((i & 4) ? size.z : 0.0f)};
        v4 c = m4_mul_v4(world_to_clip, v4_of3(p, 1.0f));
        out[0] += c.x<-c.w, out[1] += c.x> c.w, out[2] += c.y<-c.w, out[3] += c.y> c.w, out[4] += c.z < 0.0f;
    }
    for (int i = 0; i < 5; i++)
        if (out[i] == 8)
            return true;
    return false;
}

static uint32_t named(const ring *r, int x, int z, bool last)
{
    uint32_t edges = 0;
    if (!last)
        edges = (uint32_t)((x == r->x - r->reach) | (z == r->z - r->reach) << 1 | (x + 1 == r->x + r->reach) << 2 |
                           (z + 1 == r->z + r->reach) << 3);
    return (uint32_t)(x + PATCH_ORIGIN) | (uint32_t)(z + PATCH_ORIGIN) << 12 | edges << 24 | (uint32_t)r->level << 28;
}

amb_status elevated_patches(v3 eye, m4 world_to_clip, float sight, float low, float high, uint32_t **index,
                            uint32_t *count, amb_error *error)
{
    size_t room = 0;
    for (int level = 0; level < PATCH_LEVELS; level++) {
        size_t across = 2 * (size_t)ring_of(level, eye, sight).reach;
        room += across * across;
    }
    *count = 0;
    *index = malloc(room * sizeof **index);
    if (!*index)
        return amb_fail(error, AMB_ERROR_MEMORY, "no memory for %zu patches of the ground", room);
    ring inner = {.reach = 0};
    for (int level = 0; level < PATCH_LEVELS; level++) {
        ring r = ring_of(level, eye, sight);
        int hole = inner.reach / 2, hole_x = inner.x / 2, hole_z = inner.z / 2;
        v3 size = {r.side, high - low, r.side};
        for (int z = r.z - r.reach; z < r.z + r.reach; z++)
            for (int x = r.x - r.reach; x < r.x + r.reach; x++) {
                bool within = x >= hole_x - hole && x < hole_x + hole && z >= hole_z - hole && z < hole_z + hole;
                float dx = ((float)x + 0.5f) * r.side - eye.x, dz = ((float)z + 0.5f) * r.side - eye.z;
                float beyond = sight + r.side;
                v3 corner = {(float)x * r.side, low, (float)z * r.side};
                if (!within && dx * dx + dz * dz < beyond * beyond && !outside(corner, size, world_to_clip))
                    (*index)[(*count)++] = named(&r, x, z, level == PATCH_LEVELS - 1);
            }
        inner = r;
    }
    return AMB_OK;
}
