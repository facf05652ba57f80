/* Helping with mistyped names. */
#ifndef AMB_CORE_NAMES_H
#define AMB_CORE_NAMES_H

#include <stddef.h>

/* The index of the name closest to `wanted` by edit distance (Levenshtein), or -1 when none is near enough to be worth
 * suggesting. name(user, i) gives the i-th of `count` names. Pure; any thread. */
int amb_nearest_name(const char *wanted, int count, const char *(*name)(const void *user, int index), const void *user);
/* The end of an error line about an unknown name: "did you mean NEAREST?", "known: A, B, …" (cut when too long) or
 * "there are none". Returns text. */
const char *amb_names_hint(const char *wanted, int count, const char *(*name)(const void *user, int index),
                           const void *user, char *text, size_t size);

#endif
