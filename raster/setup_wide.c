/* Triangle set-up, AMB_LANES triangles at a time: drop, cull, orient and bound. What is left of a triangle is three
 * vertex numbers and a box of pixels; edge functions are made per tile. */
#include "core/gather.h"
#include "raster/internal.h"
#include "raster/records.h"

#define raster_setup WIDE(raster_setup)
void raster_setup(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch);

#define SMALL (1 << 15) /* 128 pixels: areas of smaller triangles fit 32 bits */

typedef struct corners {
    i32x number[3], x[3], y[3];
} corners;

/* First and last pixel with a sample in [low, high] (1/256 pixel), inside first…last. */
static i32x first_pixel(const i32x a[3], int first, int round)
{
    return i_max((i_min(i_min(a[0], a[1]), a[2]) + round) >> 8, i_set(first));
}
static i32x last_pixel(const i32x a[3], int last, int round)
{
    return i_min((i_max(i_max(a[0], a[1]), a[2]) - round) >> 8, i_set(last));
}

static maskx is_small(i32x a, i32x b) { return (i_max(a, b) - i_min(a, b)) < SMALL; }

/* Of triangles whose box is at most 2×2 pixels: is any of the pixels inside? E is as in tile_wide.c. */
static maskx touches_a_centre(const corners *c, i32x x0, i32x y0, i32x x1, i32x y1, i32x turn)
{
    maskx touched = m_set(false);
    i32x a[3], b[3], e[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        a[i] = (c->y[j] - c->y[k]) * turn;
        b[i] = (c->x[k] - c->x[j]) * turn;
        maskx top_left = (a[i] > 0) | ((a[i] == 0) & (b[i] > 0));
        e[i] = a[i] * (x0 * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2 - c->x[j]) +
               b[i] * (y0 * RASTER_SUBPIXEL + RASTER_SUBPIXEL / 2 - c->y[j]) - i_sel(top_left, i_set(0), i_set(1));
    }
    i32x right = (x1 - x0) * RASTER_SUBPIXEL, down = (y1 - y0) * RASTER_SUBPIXEL;
    for (int corner = 0; corner < 4; corner++) {
        i32x any_negative = i_set(0);
        for (int i = 0; i < 3; i++)
            any_negative |= e[i] + (corner & 1 ? a[i] * right : i_set(0)) + (corner & 2 ? b[i] * down : i_set(0));
        touched |= any_negative >= 0;
    }
    return touched;
}

/* Appends the kept lanes in order. words: of every lane, as transpose_words gives them. */
static void append(raster_chunk *chunk, uint32_t kept, float words[4][AMB_LANES])
{
    for (; kept != 0; kept &= kept - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(kept);
        memcpy(&chunk->triangle[chunk->triangle_count++], &words[lane & 3][lane & ~3u], sizeof *chunk->triangle);
    }
}

static void setup_group(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch, uint32_t first,
                        uint32_t live)
{
    const raster_draw *limits = chunk->draw;
    const amb_draw *draw = &limits->state;
    corners c;
    for (int i = 0; i < 3; i++) {
        u32x vertex[4];
        c.number[i] = i_load((const int32_t *)(const void *)(scratch->corner[i] + first));
        fetch_4(chunk->vertex, c.number[i] * (int32_t)chunk->stride, vertex);
        c.x[i] = u_as_i(vertex[2]), c.y[i] = u_as_i(vertex[3]);
    }
    maskx simple = (i_max(i_max(c.x[0], c.x[1]), c.x[2]) < RASTER_NOWHERE) & is_small(c.x[0], c.x[1]) &
                   is_small(c.x[1], c.x[2]) & is_small(c.x[2], c.x[0]) & is_small(c.y[0], c.y[1]) &
                   is_small(c.y[1], c.y[2]) & is_small(c.y[2], c.y[0]);
    i32x area = (c.x[1] - c.x[0]) * (c.y[2] - c.y[0]) - (c.x[2] - c.x[0]) * (c.y[1] - c.y[0]);
    maskx clockwise = area > 0; /* y points down */
    maskx front = draw->front_clockwise ? clockwise : ~clockwise;
    i32x x0 = first_pixel(c.x, limits->x0, pass->low_round), x1 = last_pixel(c.x, limits->x1 - 1, pass->high_round);
    i32x y0 = first_pixel(c.y, limits->y0, pass->low_round), y1 = last_pixel(c.y, limits->y1 - 1, pass->high_round);
    maskx kept = simple & (area != 0) & (x0 <= x1) & (y0 <= y1);
    if (draw->cull != AMB_CULL_NONE)
        kept &= draw->cull == AMB_CULL_BACK ? front : ~front;
    maskx tiny = (x1 - x0 <= 1) & (y1 - y0 <= 1);
    if (pass->samples == 1 && m_any(kept & tiny))
        kept &= ~tiny | touches_a_centre(&c, x0, y0, x1, y1, i_sel(clockwise, i_set(1), i_set(-1)));
    i32x primitive = i_load((const int32_t *)(const void *)(scratch->corner[3] + first)) - (int32_t)chunk->primitive;
    i32x second = i_sel(clockwise, c.number[1], c.number[2]), third = i_sel(clockwise, c.number[2], c.number[1]);
    float words[4][AMB_LANES];
    transpose_words(f_from_bits(c.number[0] | (primitive << 16) | i_sel(front, i_set(INT32_MIN), i_set(0))),
                    f_from_bits(second | (x1 << 16)), f_from_bits(third | (y1 << 16)), f_from_bits(x0 | (y0 << 16)),
                    words);
    uint32_t kept_bits = m_bits(kept) & live, other = live & ~m_bits(simple);
    scratch->stats.triangles_culled += (uint64_t)__builtin_popcount(live & ~other & ~kept_bits);
    for (; other != 0; other &= other - 1) { /* in order: the simple ones before it, then the other */
        int lane = __builtin_ctz(other);
        uint32_t before = (1u << lane) - 1u;
        append(chunk, kept_bits & before, words);
        kept_bits &= ~before;
        raster_setup_one(pass, chunk, scratch, first + (uint32_t)lane);
        if (!raster_reserve_triangles(chunk, scratch, (size_t)chunk->triangle_count + AMB_LANES)) {
            scratch->failed = true;
            return;
        }
    }
    append(chunk, kept_bits, words);
}

void raster_setup(const amb_pass *pass, raster_chunk *chunk, raster_scratch *scratch)
{
    const uint32_t count = scratch->corner_count;
    if (chunk->draw->lines || chunk->draw->points) {
        raster_setup_lines(pass, chunk, scratch);
        return;
    }
    for (uint32_t i = count; i < count + AMB_LANES - 1 && count > 0; i++) /* lanes past the end must be readable */
        for (int k = 0; k < 4; k++)
            scratch->corner[k][i] = scratch->corner[k][count - 1];
    for (uint32_t first = 0; first < count && !scratch->failed; first += AMB_LANES) {
        uint32_t left = count - first;
        if (!raster_reserve_triangles(chunk, scratch, (size_t)chunk->triangle_count + AMB_LANES)) {
            scratch->failed = true;
            return;
        }
        setup_group(pass, chunk, scratch, first, left >= AMB_LANES ? AMB_ALL_LANES : (1u << left) - 1u);
    }
    scratch->stats.triangles_binned += chunk->triangle_count;
}
