/* SPDX-License-Identifier: BSD-3-Clause
 * Raycaster: what a caster holds, and the two renders behind the public one. Private. */
#ifndef CELLIST_RAYCASTER_PRIVATE_H
#define CELLIST_RAYCASTER_PRIVATE_H

#include <cellist/raycast.h>

#include "hierarchy.h"

struct cellist_raycaster {
  cellist_context *context;
  const cellist_mesh *mesh;
  const cellist_scalar *scalar;
  cellist_raycaster_desc desc;
  /* For `reference`, made at the first picture that needs them. */
  bool has_hierarchy;
  face_hierarchy hierarchy;
  bool has_surface_hierarchy;
  face_hierarchy surface_hierarchy; /* over the triangles of the surface with this checksum */
  uint64_t surface_checksum;
  double shift;             /* see reference_shift.h */
  double *shifted;          /* the scalar's values less the shift; NULL: it is 0 */
  float *slopes;            /* [tets] see slopes.h */
  double *point_gradients;  /* [3 points] */
  double *cell_gradients;   /* [3 tets] */
  struct fast_caster *fast; /* for `fast`, made at its first picture */
};

/* The arguments have been checked; stats is not NULL. */
cellist_result raycaster_render_reference(cellist_raycaster *caster, const cellist_frame *frame,
                                          const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                          const cellist_raycast_output *output, cellist_raycast_stats *stats);

/* Draws these pixels (y * width + x) only, by reference. */
cellist_result raycaster_recast_pixels(cellist_raycaster *caster, const cellist_frame *frame,
                                       const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                       const cellist_raycast_output *output, const uint32_t *pixels,
                                       size_t pixel_count);

#endif
