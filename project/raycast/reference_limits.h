/* SPDX-License-Identifier: BSD-3-Clause
 * Limits: which part of a ray is seen. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_REFERENCE_LIMITS_H
#define CELLIST_RAYCAST_REFERENCE_LIMITS_H

#include <cellist/view.h>

#include "reference_walk.h"

/* From the frame's near and clip planes, each end with the error of whichever plane cut it. */
walk_limits limits_of_ray(const cellist_frame *frame, const double origin[3], const double direction[3]);

#endif
