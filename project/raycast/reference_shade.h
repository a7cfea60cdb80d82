/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: what a pixel gathers from the segments of its ray. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_REFERENCE_SHADE_H
#define CELLIST_RAYCAST_REFERENCE_SHADE_H

#include <cellist/optics.h>
#include <cellist/transfer.h>

#include "reference_walk.h"

typedef struct shade_pixel {
  double colour[3]; /* premultiplied */
  double transmittance, alpha;
  double z, z_back;
  uint32_t segment_count; /* pieces that were integrated */
} shade_pixel;

/* segments: in order; length_per_t: |direction|. */
shade_pixel shade_segments(const cellist_optics *optics, const cellist_transfer *transfer, const walk_segment *segments,
                           size_t count, double length_per_t);

#endif
