#include "core/names.h"

#include <stdio.h>
#include <string.h>

#define LONGEST 63 /* longer words are not compared */

static int smallest(int a, int b, int c)
{
    int least = a < b ? a : b;
    return least < c ? least : c;
}

static int edit_distance(const char *a, const char *b)
{
    int row[LONGEST + 1];
    size_t length_a = strlen(a), length_b = strlen(b);
    if (length_a > LONGEST || length_b > LONGEST)
        return LONGEST;
    for (size_t j = 0; j <= length_b; j++)
        row[j] = (int)j;
    for (size_t i = 1; i <= length_a; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= length_b; j++) {
            int above = row[j];
            row[j] = smallest(row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1]));
            diagonal = above;
        }
    }
    return row[length_b];
}

int amb_nearest_name(const char *wanted, int count, const char *(*name)(const void *user, int index), const void *user)
{
    int best = -1, best_distance = (int)strlen(wanted) / 2 + 1;
    for (int i = 0; i < count; i++) {
        int distance = edit_distance(wanted, name(user, i));
        if (distance < best_distance) {
            best_distance = distance;
            best = i;
        }
    }
    return best;
}

const char *amb_names_hint(const char *wanted, int count, const char *(*name)(const void *user, int index),
                           const void *user, char *text, size_t size)
{
    int nearest = amb_nearest_name(wanted, count, name, user);
    if (nearest >= 0) {
        snprintf(text, size, "did you mean %s?", name(user, nearest));
        return text;
    }
    size_t length = (size_t)snprintf(text, size, count ? "known: " : "there are none");
    for (int i = 0; i < count; i++) {
        const char *separator = i ? ", " : "";
        if (length + strlen(separator) + strlen(name(user, i)) + sizeof ", ..." > size) {
            snprintf(text + length, size - length, ", ...");
            break;
        }
        length += (size_t)snprintf(text + length, size - length, "%s%s", separator, name(user, i));
    }
    return text;
}
