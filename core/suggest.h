/* "Did you mean …?": the known name nearest to a mistyped one. Pure functions over caller-owned state; any thread. */
#ifndef AMBIANCE_CORE_SUGGEST_H
#define AMBIANCE_CORE_SUGGEST_H

#include <stddef.h>

/* Letters to insert, delete, replace or swap with a neighbour to turn a into b, case ignored (optimal string alignment,
 * Damerau 1964). Names longer than 63 characters are compared by their first 63. */
int amb_name_distance(const char *a, const char *b);

typedef struct amb_names { /* the names offered so far; start from {0} */
    const char *wanted;    /* what was asked for; may be NULL: nothing is near */
    const char *nearest;   /* NULL until a name is near enough to be meant; the earliest of equally near ones */
    int distance;          /* of nearest */
    char list[256];        /* every name, comma separated, cut with "…" when too long */
} amb_names;

/* Offers one known name. A name is near enough at one third of its letters, but at least two. */
void amb_names_offer(amb_names *names, const char *known);
/* "did you mean NEAREST?" or "known: LIST" or "there are none". Returns text. */
const char *amb_names_hint(const amb_names *names, char *text, size_t size);

#endif
