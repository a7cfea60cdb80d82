/* SPDX-License-Identifier: BSD-3-Clause
 * Limits: the view's own interval of a ray, and how far its ends may be off. */
#include "reference_limits.h"

#include <math.h>

/* Two dot products of three terms, a difference and a quotient: cellist_frame_interval's own bound. */
static const double PLANE_ROUNDING = 8 * 0x1p-53;

walk_limits limits_of_ray(const cellist_frame *frame, const double origin[3], const double direction[3]) {
  walk_limits limits = {.t_error = {0, 0}};
  cellist_frame_interval(frame, origin, direction, limits.t);
  for (uint32_t i = 0; i < frame->clip_count; i++) {
    const cellist_clip_plane *plane = &frame->clips[i];
    double speed = 0, steepness = 0, size = fabs(plane->offset);
    for (int k = 0; k < 3; k++) {
      speed += plane->normal[k] * direction[k];
      steepness += fabs(plane->normal[k] * direction[k]);
      size += fabs(plane->normal[k] * origin[k]);
    }
    const int end = speed > 0 ? 1 : 0;
    if (speed == 0 || isinf(limits.t[end])) continue;
    /* A plane that might have cut there had it been rounded otherwise adds nothing that this one has not. */
    const double error = PLANE_ROUNDING * (size + fabs(limits.t[end]) * steepness) / fabs(speed);
    double at = plane->offset;
    for (int k = 0; k < 3; k++) at -= plane->normal[k] * origin[k];
    if (fabs(at / speed - limits.t[end]) <= error) limits.t_error[end] = fmax(limits.t_error[end], error);
  }
  return limits;
}
