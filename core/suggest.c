#include "core/suggest.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define LONGEST 63

static int least(int a, int b) { return a < b ? a : b; }

static int fold(char c) { return tolower((unsigned char)c); }

int amb_name_distance(const char *a, const char *b)
{
    int rows[3][LONGEST + 1]; /* of the edit matrix: two rows above, the row above, this row */
    int *above2 = rows[0], *above = rows[1], *row = rows[2];
    int a_length = least((int)strlen(a), LONGEST), b_length = least((int)strlen(b), LONGEST);

    for (int j = 0; j <= b_length; j++)
        row[j] = j;
    for (int i = 1; i <= a_length; i++) {
        int *spare = above2;
        above2 = above;
        above = row;
        row = spare;
        row[0] = i;
        for (int j = 1; j <= b_length; j++) {
            int replaced = above[j - 1] + (fold(a[i - 1]) != fold(b[j - 1]));
            row[j] = least(replaced, 1 + least(above[j], row[j - 1]));
            if (i > 1 && j > 1 && fold(a[i - 1]) == fold(b[j - 2]) && fold(a[i - 2]) == fold(b[j - 1]))
                row[j] = least(row[j], above2[j - 2] + 1);
        }
    }
    return row[b_length];
}

void amb_names_offer(amb_names *names, const char *known)
{
    const char *cut = ", …";
    size_t used = strlen(names->list), room = sizeof names->list - used;
    size_t needed = strlen(known) + (used ? 2 : 0);
    bool is_cut = used >= strlen(cut) && strcmp(names->list + used - strlen(cut), cut) == 0;
    if (!is_cut && needed + strlen(cut) + 1 <= room)
        snprintf(names->list + used, room, "%s%s", used ? ", " : "", known);
    else if (!is_cut)
        snprintf(names->list + used, room, "%s", cut);

    if (!names->wanted)
        return;
    int distance = amb_name_distance(names->wanted, known), allowed = (int)strlen(known) / 3;
    if (distance > (allowed < 2 ? 2 : allowed) || distance >= (int)strlen(known))
        return;
    if (!names->nearest || distance < names->distance) {
        names->nearest = known;
        names->distance = distance;
    }
}

const char *amb_names_hint(const amb_names *names, char *text, size_t size)
{
    if (names->nearest)
        snprintf(text, size, "did you mean %s?", names->nearest);
    else if (names->list[0])
        snprintf(text, size, "known: %s", names->list);
    else
        snprintf(text, size, "there are none");
    return text;
}
