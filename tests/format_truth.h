/* What an attachment must hold after a write, from the formats' definitions, by search and in double precision: nothing
 * of the library's, no bit tricks. */
#ifndef AMBIANCE_TESTS_FORMAT_TRUTH_H
#define AMBIANCE_TESTS_FORMAT_TRUTH_H

#include <ambiance/texture.h>

/* The value that a channel of the format holds after `value` was written to it. */
float format_truth(amb_texel texel, int channel, float value);
int format_channels(amb_texel texel);
bool format_is_unorm(amb_texel texel); /* sources of blending are clamped to 0…1 */
/* The code of a unorm channel in exact arithmetic, and how far (in codes) the value is from where codes meet. */
int format_exact_code(amb_texel texel, int channel, double value, double *distance);

#endif
