#include "core/isosurface_table.h"

int amb_iso_edge_corner(int edge)
{
    int axis = edge >> 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (edge & 1) << u | (edge >> 1 & 1) << v;
}

/* The edge between two corners that differ in one coordinate. */
static int edge_between(int a, int b)
{
    int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return 4 * axis + (a >> u & 1) + 2 * (a >> v & 1);
}

/* The corners of a face in cyclic order, and the edges from each to the next. */
static void face_ring(int axis, int side, int corner[4], int edge[4])
{
    int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
    corner[0] = base;
    corner[1] = base | u;
    corner[2] = base | u | v;
    corner[3] = base | v;
    for (int i = 0; i < 4; i++)
        edge[i] = edge_between(corner[i], corner[(i + 1) & 3]);
}

int amb_iso_stroke(int pattern, int axis, int edge)
{
    int corner[4], ring[4], place = 0;
    face_ring(axis, 0, corner, ring);
    while (ring[place] != edge && place < 3)
        place++;
    /* An inside corner i is cut off by a stroke between edges i-1 and i. */
    return pattern >> corner[0] & 1 ? (place == 1 || place == 2) : place >= 2;
}

static int root(const int parent[12], int edge)
{
    while (parent[edge] != edge)
        edge = parent[edge];
    return edge;
}

static void join(int parent[12], int a, int b)
{
    int ra = root(parent, a), rb = root(parent, b);
    if (ra < rb)
        parent[rb] = ra;
    else
        parent[ra] = rb;
}

/* Joins the crossed edges of one face by its strokes. Returns whether it has two. */
static int face_strokes(int pattern, int axis, int side, int parent[12])
{
    int corner[4], edge[4], crossed[4], count = 0;
    face_ring(axis, side, corner, edge);
    for (int i = 0; i < 4; i++)
        if ((pattern >> corner[i] ^ pattern >> corner[(i + 1) & 3]) & 1)
            crossed[count++] = edge[i];
    if (count == 2)
        join(parent, crossed[0], crossed[1]);
    if (count < 4)
        return 0;
    int first = pattern >> corner[0] & 1 ? 3 : 0;
    join(parent, edge[first], edge[(first + 1) & 3]);
    join(parent, edge[(first + 2) & 3], edge[(first + 3) & 3]);
    return 1;
}

static amb_iso_case make_case(int pattern)
{
    amb_iso_case c = {.loop_count = 0};
    int parent[12], doubled[6];
    for (int i = 0; i < 12; i++)
        parent[i] = i;
    for (int face = 0; face < 6; face++)
        doubled[face] = face_strokes(pattern, face >> 1, face & 1, parent);
    for (int i = 0; i < 12; i++) {
        int a = amb_iso_edge_corner(i), b = a | 1 << (i >> 2);
        c.loop[i] = AMB_ISO_NO_LOOP;
        if (!((pattern >> a ^ pattern >> b) & 1))
            continue;
        c.edge_count++;
        c.loop[i] = parent[i] == i ? c.loop_count++ : c.loop[root(parent, i)]; /* a root is its loop's lowest edge */
    }
    for (int face = 0; face < 6; face++) {
        int corner[4], edge[4];
        face_ring(face >> 1, face & 1, corner, edge);
        if (doubled[face] && c.loop[edge[0]] == c.loop[edge[1]] && c.loop[edge[0]] == c.loop[edge[2]])
            c.twice |= (uint8_t)(1 << face);
    }
    return c;
}

void amb_iso_cases(amb_iso_case table[256])
{
    for (int pattern = 0; pattern < 256; pattern++)
        table[pattern] = make_case(pattern);
}
