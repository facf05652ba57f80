/* Look-ups within a register, where a gather from memory would cost many times as much. */
#ifndef AMB_POST_LANES_H
#define AMB_POST_LANES_H

#include <ambiance/wide.h>

/* Lane i of the result is lane index[i] of a. */
AMB_INLINE f32x f_permute(f32x a, i32x index)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_permutexvar_ps((__m512i)index, (__m512)a);
#elif AMB_X86 && AMB_LANES == 8
    return (f32x)_mm256_permutevar8x32_ps((__m256)a, (__m256i)index);
#elif AMB_X86 && AMB_LANES == 4
    return (f32x)_mm_shuffle_epi8((__m128i)a, (__m128i)(index * 0x04040404 + 0x03020100));
#else
    f32x r = a;
    for (int i = 0; i < AMB_LANES; i++)
        r = f_with_lane(r, i, f_lane(a, i_lane(index, i)));
    return r;
#endif
}

/* table[index] of 16 floats, lane by lane; index 0…15. */
AMB_INLINE f32x f_table16(const float *table, i32x index)
{
#if AMB_X86 && AMB_LANES == 16
    return (f32x)_mm512_permutexvar_ps((__m512i)index, (__m512)f_load(table));
#elif AMB_X86 && AMB_LANES == 8
    f32x low = (f32x)_mm256_permutevar8x32_ps((__m256)f_load(table), (__m256i)index);
    f32x high = (f32x)_mm256_permutevar8x32_ps((__m256)f_load(table + 8), (__m256i)index);
    return f_sel(index > 7, high, low);
#else
    return f_gather(table, index);
#endif
}

#endif
