/* SPDX-License-Identifier: BSD-3-Clause
 * Surface: what a surface holds. Private to project/surface/. */
#ifndef CELLIST_SURFACE_PRIVATE_H
#define CELLIST_SURFACE_PRIVATE_H

#include <cellist/surface.h>

#include "tree.h"

struct cellist_surface {
  cellist_context *context;
  cellist_surface_arrays arrays; /* the surface's own */
  double bounds[6];
  uint64_t checksum; /* of all arrays */
  surface_tree tree;
};

/* The triangles without those that coincide with one before: [3 *triangle_count] point ids, to be deallocated.
 * Errors: OUT_OF_MEMORY. Cost: linear. */
cellist_result surface_keep_first(cellist_context *context, const cellist_surface_arrays *arrays, uint32_t **triangles,
                                  size_t *triangle_count);

#endif
