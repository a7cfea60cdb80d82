/* SPDX-License-Identifier: BSD-3-Clause
 * Whether a PLY file is what it says. Private to project/surface/. */
#ifndef CELLIST_SURFACE_PLY_CHECK_H
#define CELLIST_SURFACE_PLY_CHECK_H

#include <cellist/context.h>

/* Fails with FORMAT, or UNSUPPORTED (triangle strips), naming file, place and reason. Cost: linear in the file. */
cellist_result surface_check_ply(cellist_context *context, const char *name, const char *bytes, size_t size);

#endif
