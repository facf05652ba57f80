/* The registry of scenes: one line each, in listing order. NAME stands for `const amb_scene WIDE(amb_scene_NAME)`, the
 * descriptor that ends scenes/NAME_wide.c. */
#include <ambiance/scene.h>

#include <string.h>

/* clang-format off */
#define SCENES(X) \
    X(sun)        \
    X(solar)      \
    X(mercury)    \
    X(venus)      \
    X(earth)      \
    X(mars)       \
    X(jupiter)    \
    X(saturn)     \
    X(uranus)     \
    X(neptune)    \
    X(pluto)      \
    X(julia)      \
    X(lucy)       \
    X(elevated)   \
    X(hillscape)
/* clang-format on */

#if defined(__x86_64__)
#define DECLARE(name) extern const amb_scene amb_scene_##name##_x4, amb_scene_##name##_x8, amb_scene_##name##_x16;
#else
#define DECLARE(name) extern const amb_scene amb_scene_##name##_x4;
#endif
SCENES(DECLARE)

/* NULL-ended, one list for each instruction set of this build. */
#define LIST_X4(name) &amb_scene_##name##_x4,
static const amb_scene *const scenes_x4[] = {SCENES(LIST_X4) NULL};
#if defined(__x86_64__)
#define LIST_X8(name) &amb_scene_##name##_x8,
#define LIST_X16(name) &amb_scene_##name##_x16,
static const amb_scene *const scenes_x8[] = {SCENES(LIST_X8) NULL};
static const amb_scene *const scenes_x16[] = {SCENES(LIST_X16) NULL};
#endif

static const amb_scene *const *scenes_of(amb_isa isa)
{
#if defined(__x86_64__)
    if (isa == AMB_ISA_AUTO)
        isa = amb_isa_available(AMB_ISA_V4) ? AMB_ISA_V4 : amb_isa_available(AMB_ISA_V3) ? AMB_ISA_V3 : AMB_ISA_V2;
    if (isa == AMB_ISA_V4)
        return scenes_x16;
    if (isa == AMB_ISA_V3)
        return scenes_x8;
#endif
    return isa == AMB_ISA_V2 || isa == AMB_ISA_AUTO ? scenes_x4 : NULL;
}

int amb_scene_count(void) { return (int)(sizeof scenes_x4 / sizeof scenes_x4[0]) - 1; }

const amb_scene *amb_scene_by_index(amb_isa isa, int index)
{
    const amb_scene *const *scenes = scenes_of(isa);
    return scenes && index >= 0 && index < amb_scene_count() ? scenes[index] : NULL;
}

const amb_scene *amb_scene_by_name(amb_isa isa, const char *name)
{
    for (int i = 0; name && i < amb_scene_count(); i++) {
        const amb_scene *scene = amb_scene_by_index(isa, i);
        if (scene && strcmp(scene->name, name) == 0)
            return scene;
    }
    return NULL;
}
