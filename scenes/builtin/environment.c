#include "core/dispatch.h"
#include "scenes/builtin/builtin.h"
#include "scenes/builtin/paint.h"

AMB_DECLARE_WIDE(v4x, amb_sky_radiance, (v3x direction, const void *user));
AMB_DECLARE_WIDE(v4x, amb_studio_radiance, (v3x direction, const void *user));

enum { ENVIRONMENT_SIZE = 512 };

amb_status amb_builtin_sky(const amb_context *context, amb_texture **out, amb_error *error)
{
    return amb_cube_paint(context, ENVIRONMENT_SIZE, 2, AMB_DISPATCH(amb_context_isa(context), amb_sky_radiance), NULL,
                          out, error);
}

amb_status amb_builtin_studio(const amb_context *context, amb_texture **out, amb_error *error)
{
    return amb_cube_paint(context, ENVIRONMENT_SIZE, 2, AMB_DISPATCH(amb_context_isa(context), amb_studio_radiance),
                          NULL, out, error);
}
