/* Lanes to records of four words in memory. Part of the *_wide.c files that write vertices and triangles. */
#ifndef AMBIANCE_RASTER_RECORDS_H
#define AMBIANCE_RASTER_RECORDS_H

#include <ambiance/wide.h>

/* Lanes a, b, c, d (0…3 of v, 4…7 of w) of every four lanes. */
#define PICK(lane, four) ((lane) < 4 ? (lane) + 4 * (four) : (lane)-4 + AMB_LANES + 4 * (four))
#define PICKS(four, a, b, c, d) PICK(a, four), PICK(b, four), PICK(c, four), PICK(d, four)
#if AMB_LANES == 4
#define SHUFFLE(v, w, a, b, c, d) __builtin_shufflevector(v, w, PICKS(0, a, b, c, d))
#elif AMB_LANES == 8
#define SHUFFLE(v, w, a, b, c, d) __builtin_shufflevector(v, w, PICKS(0, a, b, c, d), PICKS(1, a, b, c, d))
#else
#define SHUFFLE(v, w, a, b, c, d)                                                                   \
    __builtin_shufflevector(v, w, PICKS(0, a, b, c, d), PICKS(1, a, b, c, d), PICKS(2, a, b, c, d), \
                            PICKS(3, a, b, c, d))
#endif

/* Four words of every lane, each lane's side by side: lane i's are at words[i & 3][i & ~3]. */
static inline void transpose_words(f32x a, f32x b, f32x c, f32x d, float words[4][AMB_LANES])
{
    f32x ab = SHUFFLE(a, b, 0, 4, 1, 5), cd = SHUFFLE(c, d, 0, 4, 1, 5);
    f32x ab2 = SHUFFLE(a, b, 2, 6, 3, 7), cd2 = SHUFFLE(c, d, 2, 6, 3, 7);
    f_store(words[0], SHUFFLE(ab, cd, 0, 1, 4, 5));
    f_store(words[1], SHUFFLE(ab, cd, 2, 3, 6, 7));
    f_store(words[2], SHUFFLE(ab2, cd2, 0, 1, 4, 5));
    f_store(words[3], SHUFFLE(ab2, cd2, 2, 3, 6, 7));
}

/* Lane by lane, four words to a record: `stride` words on is the next lane's. */
static inline void store_words(uint32_t *record, uint32_t stride, f32x a, f32x b, f32x c, f32x d)
{
    float words[4][AMB_LANES];
    transpose_words(a, b, c, d, words);
    for (uint32_t lane = 0; lane < AMB_LANES; lane++)
        memcpy(record + (size_t)lane * stride, &words[lane & 3][lane & ~3u], 4 * sizeof *record);
}
#undef SHUFFLE
#undef PICKS
#undef PICK

#endif
