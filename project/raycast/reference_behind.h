/* SPDX-License-Identifier: BSD-3-Clause
 * Behind: the opaque surface of a picture, met by the reference caster's own means. Private to it. */
#ifndef CELLIST_RAYCAST_REFERENCE_BEHIND_H
#define CELLIST_RAYCAST_REFERENCE_BEHIND_H

#include "raycaster.h"
#include "reference_shade.h"

/* The surface of one picture; surface NULL: none. */
typedef struct behind_scene {
  const cellist_surface_arrays *surface;
  const face_hierarchy *hierarchy;
  double bounds[6];
  double light[3], halfway[3]; /* unit vectors */
  double ambient, diffuse, specular, shininess;
} behind_scene;

/* surface may be NULL. The scene refers to it and to the caster, which keeps the hierarchy for later pictures.
 * Errors: OUT_OF_MEMORY. */
cellist_result behind_begin(cellist_raycaster *caster, const cellist_surface *surface, const shade_scene *scene,
                            const cellist_frame *frame, behind_scene *behind);

/* Where the ray meets the surface. */
typedef struct behind_point {
  bool is_met;
  double t, t_error;
  double colour[3]; /* lit */
} behind_point;

/* The nearest point within the limits, whose far end it then becomes. */
behind_point behind_meet(const behind_scene *behind, const double origin[3], const double direction[3],
                         walk_limits *limits, uint64_t *retry_count);

/* Puts it behind what the ray has gathered before it. */
void behind_add(const behind_point *point, shade_pixel *pixel);

#endif
