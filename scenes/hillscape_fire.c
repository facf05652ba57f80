#include "scenes/hillscape_fire.h"

#include <ambiance/math.h>
#include <ambiance/random.h>

fire_particle fire_particle_at(int i, double time)
{
    static const float lives[3] = {1.1f, 2.4f, 9.0f};
    int kind = i < FIRE_FLAMES ? 0 : i < FIRE_FLAMES + FIRE_SPARKS ? 1 : 2;
    time = time > -1.0e12 ? time < 1.0e12 ? time : 1.0e12 : -1.0e12; /* NaN: the last */
    double lived = time / (double)lives[kind] + (double)amb_unit(amb_hash((uint32_t)i + 900u));
    int64_t life = (int64_t)lived;
    life -= lived < (double)life;
    float age = (float)(lived - (double)life), t = age * lives[kind];
    u4x h = u4x_hash((u4x){(uint32_t)i, (uint32_t)life, (uint32_t)(life >> 32), 7u});
    float turn = 6.2831853f * amb_unit(h.x), out = f_sqrt(amb_unit(h.y)), chance = amb_unit(h.z), seed = amb_unit(h.w);
    float s, c;
    f_sincos(turn, &s, &c);
    fire_particle p = {.age = age, .kind = (float)kind, .seed = seed};
    if (kind == 0) { /* drawn together as they rise */
        float radius = 0.42f * out * (1.0f - 0.75f * age);
        p.offset =
            (v3){c * radius + 0.06f * f_sin(seed * 30.0f + t * 7.0f), 0.05f + t * (0.9f + 0.5f * chance), s * radius};
        p.size = (0.30f - 0.22f * age) * (0.7f + 0.6f * chance);
    } else if (kind == 1) { /* thrown up, blown about */
        float speed = 1.2f + 2.2f * chance;
        p.offset = (v3){c * 0.25f + 0.5f * t * c * out + 0.15f * f_sin(seed * 50.0f + t * 5.0f) + 0.25f * t * t,
                        0.3f + speed * t - 0.22f * t * t,
                        s * 0.25f + 0.5f * t * s * out + 0.15f * f_sin(seed * 70.0f + t * 4.0f)};
        p.size = 0.022f * (1.0f - 0.6f * age);
    } else { /* slows and spreads with the wind */
        float rise = 6.0f * (1.0f - f_exp(-0.28f * t)) + 0.25f * t;
        p.offset = (v3){c * (0.2f + 0.10f * t) * out + 0.085f * t * t, 1.0f + rise,
                        s * (0.2f + 0.10f * t) * out - 0.02f * t * t};
        p.size = 0.35f + 0.30f * t;
    }
    return p;
}
