/* The registry of post passes: one line each, in listing order. NAME stands for
 * `const amb_post_pass WIDE(amb_post_NAME)`, the descriptor that ends post/NAME_wide.c. */
#include <ambiance/post.h>

#include <string.h>

#define PASSES(X) \
    X(mlaa)       \
    X(dispersion) \
    X(exposure)   \
    X(bloom)      \
    X(brightpass) \
    X(adjust)     \
    X(vignette)   \
    X(grain)      \
    X(display)

#if defined(__x86_64__)
#define DECLARE(name) extern const amb_post_pass amb_post_##name##_x4, amb_post_##name##_x8, amb_post_##name##_x16;
#else
#define DECLARE(name) extern const amb_post_pass amb_post_##name##_x4;
#endif
PASSES(DECLARE)

/* NULL-ended, one list for each instruction set of this build. */
#define LIST_X4(name) &amb_post_##name##_x4,
static const amb_post_pass *const passes_x4[] = {PASSES(LIST_X4) NULL};
#if defined(__x86_64__)
#define LIST_X8(name) &amb_post_##name##_x8,
#define LIST_X16(name) &amb_post_##name##_x16,
static const amb_post_pass *const passes_x8[] = {PASSES(LIST_X8) NULL};
static const amb_post_pass *const passes_x16[] = {PASSES(LIST_X16) NULL};
#endif

static const amb_post_pass *const *passes_of(amb_isa isa)
{
#if defined(__x86_64__)
    if (isa == AMB_ISA_AUTO)
        isa = amb_isa_available(AMB_ISA_V4) ? AMB_ISA_V4 : amb_isa_available(AMB_ISA_V3) ? AMB_ISA_V3 : AMB_ISA_V2;
    if (isa == AMB_ISA_V4)
        return passes_x16;
    if (isa == AMB_ISA_V3)
        return passes_x8;
#endif
    return isa == AMB_ISA_V2 || isa == AMB_ISA_AUTO ? passes_x4 : NULL;
}

int amb_post_count(void) { return (int)(sizeof passes_x4 / sizeof passes_x4[0]) - 1; }

const amb_post_pass *amb_post_by_index(amb_isa isa, int index)
{
    const amb_post_pass *const *passes = passes_of(isa);
    return passes && index >= 0 && index < amb_post_count() ? passes[index] : NULL;
}

const amb_post_pass *amb_post_by_name(amb_isa isa, const char *name)
{
    for (int i = 0; name && i < amb_post_count(); i++) {
        const amb_post_pass *pass = amb_post_by_index(isa, i);
        if (pass && strcmp(pass->name, name) == 0)
            return pass;
    }
    return NULL;
}
