/* Every function of wide.h and math.h as a case, and what only makes sense at more than one lane. */
#include "lanes.h"
#include <ambiance/math.h>

/* ---- math.h ----------------------------------------------------------------------------------------------------- */
#define ONE(name) LANES_CASE(name, 1, 1, { out[0] = f_##name(in[0]); })
ONE(exp)
ONE(exp2)
ONE(log)
ONE(log2)
ONE(sin)
ONE(cos)
ONE(tan)
ONE(asin)
ONE(acos)
ONE(atan)
ONE(cbrt)
#define TWO(name) LANES_CASE(name, 2, 1, { out[0] = f_##name(in[0], in[1]); })
TWO(pow)
TWO(atan2)
LANES_CASE(sincos, 1, 2, { f_sincos(in[0], &out[0], &out[1]); })

const lanes_case WIDE(lanes_math)[] = {LANES_ENTRY(exp, 1, 1),   LANES_ENTRY(exp2, 1, 1),   LANES_ENTRY(log, 1, 1),
                                       LANES_ENTRY(log2, 1, 1),  LANES_ENTRY(sin, 1, 1),    LANES_ENTRY(cos, 1, 1),
                                       LANES_ENTRY(tan, 1, 1),   LANES_ENTRY(asin, 1, 1),   LANES_ENTRY(acos, 1, 1),
                                       LANES_ENTRY(atan, 1, 1),  LANES_ENTRY(cbrt, 1, 1),   LANES_ENTRY(pow, 2, 1),
                                       LANES_ENTRY(atan2, 2, 1), LANES_ENTRY(sincos, 1, 2), {0}};

/* ---- wide.h ----------------------------------------------------------------------------------------------------- */
ONE(sqrt)
ONE(abs)
ONE(trunc)
ONE(floor)
ONE(ceil)
ONE(round)
ONE(fract)
ONE(saturate)
TWO(min)
TWO(max)
TWO(copysign)
LANES_CASE(clamp, 3, 1, { out[0] = f_clamp(in[0], in[1], in[2]); })
LANES_CASE(lerp, 3, 1, { out[0] = f_lerp(in[0], in[1], in[2]); })
LANES_CASE(smoothstep, 3, 1, { out[0] = f_smoothstep(in[0], in[1], in[2]); })
LANES_CASE(sel, 4, 1, { out[0] = f_sel((in[0] < in[1]) | ~(in[2] == in[3]), in[2], in[3]); })
LANES_CASE(to_i, 1, 1, { out[0] = f_from_bits(f_to_i(in[0])); })
LANES_CASE(from_i, 1, 1, { out[0] = i_to_f(f_bits(in[0])); })
LANES_CASE(i_min_max, 2, 2, {
    out[0] = f_from_bits(i_min(f_bits(in[0]), f_bits(in[1])));
    out[1] = f_from_bits(i_max(f_bits(in[0]), f_bits(in[1])));
})
LANES_CASE(classes, 1, 2, {
    out[0] = f_sel(f_is_nan(in[0]), f_set(1.0f), f_set(0.0f));
    out[1] = f_sel(f_is_finite(in[0]), f_set(1.0f), f_set(0.0f));
})

const lanes_case WIDE(lanes_primitives)[] = {
    LANES_ENTRY(sqrt, 1, 1),   LANES_ENTRY(abs, 1, 1),       LANES_ENTRY(trunc, 1, 1),      LANES_ENTRY(floor, 1, 1),
    LANES_ENTRY(ceil, 1, 1),   LANES_ENTRY(round, 1, 1),     LANES_ENTRY(fract, 1, 1),      LANES_ENTRY(saturate, 1, 1),
    LANES_ENTRY(min, 2, 1),    LANES_ENTRY(max, 2, 1),       LANES_ENTRY(copysign, 2, 1),   LANES_ENTRY(clamp, 3, 1),
    LANES_ENTRY(lerp, 3, 1),   LANES_ENTRY(sel, 4, 1),       LANES_ENTRY(smoothstep, 3, 1), LANES_ENTRY(to_i, 1, 1),
    LANES_ENTRY(from_i, 1, 1), LANES_ENTRY(i_min_max, 2, 2), LANES_ENTRY(classes, 1, 2),    {0}};

/* ---- what has lanes --------------------------------------------------------------------------------------------- */

/* Returns 0, or the line of the first check that fails. */
int WIDE(lanes_structure)(void);
#define CHECK(condition) \
    if (!(condition))    \
    return __LINE__

static int check_lanes(void)
{
    float values[AMB_LANES * 3];
    int32_t order[AMB_LANES];
    for (int i = 0; i < AMB_LANES * 3; i++)
        values[i] = (float)(i * i) - 7.0f;
    for (int i = 0; i < AMB_LANES; i++)
        order[i] = (i * 7 + 3) % (AMB_LANES * 3);
    f32x a = f_load(values + 1), g = f_gather(values, i_load(order));
    i32x gi = i_gather((const int32_t *)(const void *)values, i_load(order));
    for (int i = 0; i < AMB_LANES; i++) {
        CHECK(f_lane(a, i) == values[i + 1]);
        CHECK(f_lane(g, i) == values[order[i]]);
        CHECK(i_lane(gi, i) == i_lane(f_bits(g), i));
        CHECK(i_lane(i_lane_index(), i) == i);
        CHECK(f_lane(f_with_lane(a, i, 99.0f), i) == 99.0f);
        CHECK(i_lane(i_with_lane(gi, i, 42), i) == 42);
        for (int j = 0; j < AMB_LANES; j++)
            CHECK(j == i || f_lane(f_with_lane(a, i, 99.0f), j) == values[j + 1]);
    }
    CHECK(i_lane(f_bits(f_set(-0.0f)), AMB_LANES - 1) == INT32_MIN);
    CHECK(f_lane(f_set(__builtin_inff()), AMB_LANES - 1) == __builtin_inff());
    return 0;
}

static int check_masks(void)
{
    for (uint32_t bits = 0; bits <= AMB_ALL_LANES; bits++) {
        maskx m = m_from_bits(bits);
        CHECK(m_bits(m) == bits);
        CHECK(m_bits(~m) == (~bits & AMB_ALL_LANES));
        CHECK(m_any(m) == (bits != 0));
        CHECK(m_all(m) == (bits == AMB_ALL_LANES));
        for (int i = 0; i < AMB_LANES; i++)
            CHECK(m_lane(m, i) == ((bits >> i & 1) != 0));
    }
    CHECK(m_bits(m_set(true)) == AMB_ALL_LANES);
    CHECK(m_bits(m_set(false)) == 0);
    return 0;
}

static int check_blocks(void)
{
    bool seen[4][4] = {{false}};
    for (int i = 0; i < AMB_LANES; i++) {
        int x = i_lane(i_block_x(), i), y = i_lane(i_block_y(), i);
        CHECK(x >= 0 && x < AMB_BLOCK_W && y >= 0 && y < AMB_BLOCK_H && !seen[y][x]);
        seen[y][x] = true;
#if AMB_LANES > 1
        f32x px = i_to_f(i_block_x()), py = i_to_f(i_block_y());
        f32x plane = 3.0f * px - 5.0f * py + 1.0f;
        CHECK(f_lane(f_ddx(plane), i) == 3.0f && f_lane(f_ddy(plane), i) == -5.0f);
        f32x saddle = px * py; /* its slope differs by row and by column */
        CHECK(f_lane(f_ddx(saddle), i) == (float)y && f_lane(f_ddy(saddle), i) == (float)x);
#endif
    }
    return 0;
}

int WIDE(lanes_structure)(void)
{
    int line = check_lanes();
    if (!line)
        line = check_masks();
    return line ? line : check_blocks();
}
