/* One block of memory that a context keeps from one job to the next, so that a frame does not ask the system for the
 * same pages again. Any thread. */
#ifndef AMBIANCE_CORE_SPARE_H
#define AMBIANCE_CORE_SPARE_H

#include <ambiance/context.h>

/* What was kept last, now the caller's; NULL when there is nothing. */
void *amb_spare_take(const amb_context *context);
/* Keeps a block; what was kept before is released. Closing the context releases it. All blocks of a context have the
 * same `release`. */
void amb_spare_keep(const amb_context *context, void *block, void (*release)(void *block));

#endif
