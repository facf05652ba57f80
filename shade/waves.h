/* Water as a height field over (x, z): the coursework's sum of sines, and gradient noise in its place. Lengths in world
 * units, time in seconds. Lanes functions; pure; any thread. */
#ifndef AMBIANCE_SHADE_WAVES_H
#define AMBIANCE_SHADE_WAVES_H

#include <ambiance/math.h>
#include <ambiance/noise.h>

#define WAVES_SINES 8

typedef struct amb_waves {
    float height, frequency, speed; /* of the coursework's wave: units, radians a unit, radians a second */
    bool noise;                     /* noise instead of sines */
    int count;                      /* 1…WAVES_SINES sines, or octaves of noise */
    float turns[WAVES_SINES];       /* speed · time of each sine, in 0…2π: made by waves_at_time */
    float noise_time;
} amb_waves;

typedef struct amb_wave {
    f32x height;
    v2x slope;      /* ∂height/∂x, ∂height/∂z */
    f32x roughness; /* mean square slope of the waves that were left out as too small to be seen */
} amb_wave;

/* Wave i of the sum, relative to the coursework's: its direction (the first goes along z), frequency, amplitude.
 * Steeper and slower waves go at other angles, so that crests are short and never line up. Deep water: speed ∝
 * √frequency. */
typedef struct waves_sine {
    float x, z, frequency, amplitude, speed;
} waves_sine;
static const waves_sine waves_sines[WAVES_SINES] = {
    {0.0f, 1.0f, 1.0f, 1.0f, 1.0f},          {0.618f, 0.786f, 1.37f, 0.62f, 1.17f},
    {-0.5f, 0.866f, 1.93f, 0.41f, 1.39f},    {0.951f, 0.309f, 2.71f, 0.27f, 1.65f},
    {-0.847f, 0.532f, 3.83f, 0.18f, 1.96f},  {0.342f, 0.94f, 5.33f, 0.125f, 2.31f},
    {-0.174f, 0.985f, 7.61f, 0.085f, 2.76f}, {0.743f, -0.669f, 10.7f, 0.058f, 3.27f},
};

/* Any finite time: phases are kept in double and folded to one turn. */
static inline void waves_at_time(amb_waves *w, double time)
{
    const double turn = 6.283185307179586;
    for (int i = 0; i < WAVES_SINES; i++) {
        double phase = (double)w->speed * (double)waves_sines[i].speed * time / turn;
        double whole = phase > -9.0e15 && phase < 9.0e15 ? (double)(int64_t)phase : phase;
        w->turns[i] = (float)((phase - whole) * turn);
    }
    /* The noise's time repeats after 65536 / speed seconds, where its lattice does not: a jump once in a day. */
    double t = (double)w->speed * time * 0.5, period = 65536.0;
    double loops = t / period, whole = loops > -9.0e15 && loops < 9.0e15 ? (double)(int64_t)loops : loops;
    w->noise_time = (float)((loops - whole) * period);
}

/* How much of a wave is left when a pixel spans `footprint` units: 1 while it spans less than a quarter of the wave,
 * 0 from half of it on. */
AMB_INLINE f32x waves_kept_(f32x footprint, float frequency)
{
    float waves_a_unit = frequency * (0.5f * AMB_INV_PI);
    return 1.0f - f_smoothstep(f_set(0.25f), f_set(0.5f), footprint * waves_a_unit);
}

/* Σ height·aᵢ·sin(frequency·kᵢ·(dᵢ·p) + speed·sᵢ·time), the first as the coursework gives it: height·sin(frequency·z +
 * speed·time). footprint 0: all waves in full. */
AMB_INLINE amb_wave waves_sum_of_sines(const amb_waves *w, v2x p, f32x footprint)
{
    f32x zero = f_set(0.0f);
    amb_wave sum = {zero, {zero, zero}, zero};
    for (int i = 0; i < w->count; i++) {
        waves_sine s = waves_sines[i];
        float k = w->frequency * s.frequency, a = w->height * s.amplitude;
        f32x kept = waves_kept_(footprint, k), sine, cosine;
        f_sincos((p.x * s.x + p.y * s.z) * k + w->turns[i], &sine, &cosine);
        f32x slope = cosine * (kept * (a * k));
        sum.height += sine * (kept * a);
        sum.slope.x += slope * s.x;
        sum.slope.y += slope * s.z;
        sum.roughness += (1.0f - kept * kept) * (0.5f * a * a * k * k);
    }
    return sum;
}

/* The same look from gradient noise: octaves 1, 2, 4, … of frequency/2π, each drifting its own way while it changes. */
AMB_INLINE amb_wave waves_noise(const amb_waves *w, v2x p, f32x footprint)
{
    f32x zero = f_set(0.0f);
    amb_wave sum = {zero, {zero, zero}, zero};
    float frequency = w->frequency * (0.75f * AMB_INV_PI), amplitude = 1.6f * w->height, rate = 0.35f;
    for (int i = 0; i < w->count && i < 6; i++) {
        waves_sine s = waves_sines[i];
        f32x kept = waves_kept_(footprint, 2.0f * AMB_PI * frequency);
        v3x at = {p.x * frequency + s.x * (rate * w->noise_time), f_set(rate * w->noise_time),
                  p.y * frequency + s.z * (rate * w->noise_time)};
        noise3x n = noise_gradient3(at, (amb_lattice){.seed = 0x3a7e5u + (uint32_t)i});
        f32x scale = kept * amplitude;
        sum.height += n.value * scale;
        sum.slope.x += n.slope.x * (scale * frequency);
        sum.slope.y += n.slope.z * (scale * frequency);
        sum.roughness += (1.0f - kept * kept) * (0.15f * amplitude * amplitude * frequency * frequency);
        frequency *= 2.0f;
        amplitude *= 0.45f;
        rate *= 1.5f;
    }
    return sum;
}

AMB_INLINE amb_wave waves_at(const amb_waves *w, v2x p, f32x footprint)
{
    return w->noise ? waves_noise(w, p, footprint) : waves_sum_of_sines(w, p, footprint);
}

#endif
