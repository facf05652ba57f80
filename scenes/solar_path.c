#include "scenes/solar.h"

#include <ambiance/math.h>

/* One body: its size, how much room the flight gives it (gaps between bodies are four times the sum of theirs), and
 * where it is around the sun, degrees. */
typedef struct stop {
    float radius, reach, room, azimuth, height;
    float look_back; /* 1: the flight leaves looking back, at a crescent beside the sun; 0: sideways */
} stop;

static const stop stops[SOLAR_BODIES] = {
    {3.2f, 4.0f, 3.2f, 0.0f, 0.0f, 0.0f},     /* sun */
    {0.7f, 1.1f, 0.8f, 214.0f, 0.3f, 0.0f},   /* mercury */
    {1.1f, 1.1f, 1.1f, 226.0f, -0.4f, 0.0f},  /* venus */
    {1.2f, 1.1f, 1.2f, 236.0f, 0.5f, 1.0f},   /* earth */
    {0.9f, 1.1f, 1.0f, 247.0f, -0.5f, 0.0f},  /* mars */
    {2.6f, 1.1f, 2.6f, 256.0f, 0.8f, 0.0f},   /* jupiter */
    {2.1f, 2.45f, 3.6f, 266.0f, -0.8f, 1.0f}, /* saturn */
    {1.5f, 2.45f, 2.0f, 275.0f, 0.9f, 0.0f},  /* uranus */
    {1.5f, 1.1f, 1.5f, 283.0f, -0.3f, 0.0f},  /* neptune */
    {0.6f, 1.2f, 0.7f, 290.0f, 0.2f, 1.0f},   /* pluto */
};

void solar_places(solar_place place[SOLAR_BODIES])
{
    float distance = 0.0f;
    for (int i = 0; i < SOLAR_BODIES; i++) {
        const stop *s = &stops[i];
        if (i > 0)
            distance += 4.0f * (s->room + stops[i - 1].room);
        float azimuth = s->azimuth * (AMB_PI / 180.0f);
        place[i] = (solar_place){.centre = {distance * f_sin(azimuth), s->height, distance * f_cos(azimuth)},
                                 .radius = s->radius,
                                 .reach = s->reach};
    }
}

/* A key beside a body; offsets in its rooms: away from the sun, to the flight's side, up. */
static amb_camera_key beside(const solar_place *place, float room, float time, v3 eye, v3 target)
{
    v3 out = v3_normalize((v3){place->centre.x, 0.0f, place->centre.z}), up = {0, 1, 0}, side = v3_cross(out, up);
    v3 to[2] = {eye, target};
    for (int i = 0; i < 2; i++) {
        v3 offset = v3_add(v3_add(v3_scale(out, to[i].x), v3_scale(side, to[i].y)), v3_scale(up, to[i].z));
        to[i] = v3_add(place->centre, v3_scale(offset, room));
    }
    return (amb_camera_key){time, to[0], to[1], up};
}

/* Each body is met from the sunny side, passed, and left; three keys a body, and a turn where the flight looked back.
 */
size_t solar_path(const solar_place place[SOLAR_BODIES], amb_camera_key *key)
{
    const float first = 13.0f, slot = 11.6f, pass = 3.2f;
    size_t n = 0;
    key[n++] = (amb_camera_key){0.0f, {6.5f, 4.5f, 12.5f}, {0, 0, 0}, {0, 1, 0}};
    key[n++] = (amb_camera_key){5.0f, {-3.0f, 2.0f, 10.5f}, {-0.6f, 0, 0}, {0, 1, 0}};
    key[n++] = (amb_camera_key){9.0f, {-9.0f, 1.0f, 4.0f}, {-3.0f, 0, -2.0f}, {0, 1, 0}};
    for (int i = 1; i < SOLAR_BODIES; i++) {
        const stop *s = &stops[i];
        float t = first + slot * (float)(i - 1);
        const solar_place *p = &place[i];
        key[n++] = beside(p, s->room, t, (v3){-3.1f, 1.9f, 0.7f}, (v3){0, 0, 0});
        key[n++] = beside(p, s->room, t + pass, (v3){-0.9f, 2.5f, 0.35f}, (v3){0.1f, 0, 0});
        if (s->look_back > 0.0f)
            key[n++] = beside(p, s->room, t + 2.0f * pass, (v3){3.0f, 2.0f, 0.3f}, (v3){0, 0.9f, 0});
        else
            key[n++] = beside(p, s->room, t + 2.0f * pass, (v3){1.0f, 3.0f, 0.15f}, (v3){0.3f, 0, 0});
        if (s->look_back > 0.0f && i + 1 < SOLAR_BODIES)
            key[n++] = beside(p, s->room, t + 2.0f * pass + 2.4f, (v3){4.6f, 2.3f, 0.2f}, (v3){5.2f, -3.0f, 0.1f});
    }
    key[n++] = beside(&place[SOLAR_BODIES - 1], stops[SOLAR_BODIES - 1].room, SOLAR_SECONDS, (v3){6.5f, 3.4f, 0.8f},
                      (v3){0, 1.2f, 0});
    return n;
}
