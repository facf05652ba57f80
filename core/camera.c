#include <ambiance/camera.h>
#include <ambiance/math.h>

/* The segment [i, i+1] that holds `time`; count ≥ 2 and time inside the keys' range. */
static size_t segment_of(const amb_spline_key *key, size_t count, float time)
{
    size_t lo = 0, hi = count - 1;
    while (hi - lo > 1) {
        size_t middle = (lo + hi) / 2;
        if (key[middle].time <= time)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

/* Catmull-Rom tangent at key i for uneven times: the slope between its neighbours (one-sided at the ends). */
static v3 key_tangent(const amb_spline_key *key, size_t count, size_t i)
{
    size_t before = i > 0 ? i - 1 : 0, after = i + 1 < count ? i + 1 : count - 1;
    float seconds = key[after].time - key[before].time;
    v3 change = v3_sub(key[after].value, key[before].value);
    return seconds > 0.0f ? v3_scale(change, 1.0f / seconds) : (v3){0, 0, 0};
}

/* Cubic Hermite weights of a segment's two values and two tangents. */
typedef struct hermite {
    float value0, tangent0, value1, tangent1;
} hermite;

static v3 hermite_sum(const amb_spline_key *key, size_t count, size_t i, hermite w)
{
    v3 ends = v3_add(v3_scale(key[i].value, w.value0), v3_scale(key[i + 1].value, w.value1));
    v3 slopes =
        v3_add(v3_scale(key_tangent(key, count, i), w.tangent0), v3_scale(key_tangent(key, count, i + 1), w.tangent1));
    return v3_add(ends, slopes);
}

v3 amb_spline_at(const amb_spline_key *key, size_t count, float time)
{
    if (count == 1 || !(time > key[0].time))
        return key[0].value;
    if (time >= key[count - 1].time)
        return key[count - 1].value;
    size_t i = segment_of(key, count, time);
    float seconds = key[i + 1].time - key[i].time;
    float t = (time - key[i].time) / seconds, t2 = t * t, t3 = t2 * t;
    return hermite_sum(key, count, i,
                       (hermite){.value0 = 2.0f * t3 - 3.0f * t2 + 1.0f,
                                 .tangent0 = (t3 - 2.0f * t2 + t) * seconds,
                                 .value1 = -2.0f * t3 + 3.0f * t2,
                                 .tangent1 = (t3 - t2) * seconds});
}

v3 amb_spline_tangent(const amb_spline_key *key, size_t count, float time)
{
    if (count == 1 || !(time >= key[0].time && time <= key[count - 1].time))
        return (v3){0, 0, 0};
    size_t i = segment_of(key, count, time);
    float seconds = key[i + 1].time - key[i].time;
    float t = (time - key[i].time) / seconds, t2 = t * t;
    return hermite_sum(key, count, i,
                       (hermite){.value0 = (6.0f * t2 - 6.0f * t) / seconds,
                                 .tangent0 = 3.0f * t2 - 4.0f * t + 1.0f,
                                 .value1 = (-6.0f * t2 + 6.0f * t) / seconds,
                                 .tangent1 = 3.0f * t2 - 2.0f * t});
}

amb_camera amb_camera_look(v3 position, v3 target, v3 up, float vertical_fov, float near, float far, int width,
                           int height)
{
    float aspect = (float)width / (float)height;
    amb_camera c = {.position = position, .target = target, .vertical_fov = vertical_fov, .near = near, .far = far};
    c.world_to_view = m4_look_at(position, target, up);
    c.view_to_clip = m4_perspective(vertical_fov, aspect, near, far);
    c.world_to_clip = m4_mul(c.view_to_clip, c.world_to_view);

    v3 right = v4_xyz(c.world_to_view.row[0]), above = v4_xyz(c.world_to_view.row[1]);
    v3 forward = v3_neg(v4_xyz(c.world_to_view.row[2]));
    float half_height = f_tan(0.5f * vertical_fov), half_width = half_height * aspect;
    c.up = above;
    c.ray_dx = v3_scale(right, 2.0f * half_width / (float)width);
    c.ray_dy = v3_scale(above, -2.0f * half_height / (float)height);
    c.ray_origin = v3_add(forward, v3_add(v3_scale(right, -half_width), v3_scale(above, half_height)));
    return c;
}

/* One of the three splines at `time`; `member` is the offset of position, target or up in a key. */
static v3 camera_spline(const amb_camera_key *key, size_t count, size_t member, float time)
{
    /* A value depends on the keys of its segment and one neighbour on each side: a window of five holds them. */
    size_t first = 0;
    while (first + 4 < count && key[first + 2].time <= time)
        first++;
    amb_spline_key window[5];
    size_t n = 0;
    for (; n < 5 && first + n < count; n++) {
        window[n].time = key[first + n].time;
        memcpy(&window[n].value, (const char *)&key[first + n] + member, sizeof(v3));
    }
    return amb_spline_at(window, n, time);
}

amb_camera amb_camera_at(const amb_camera_key *key, size_t count, float time, float vertical_fov, float near, float far,
                         int width, int height)
{
    return amb_camera_look(camera_spline(key, count, offsetof(amb_camera_key, position), time),
                           camera_spline(key, count, offsetof(amb_camera_key, target), time),
                           camera_spline(key, count, offsetof(amb_camera_key, up), time), vertical_fov, near, far,
                           width, height);
}
