/* SPDX-License-Identifier: BSD-3-Clause
 * Sharp: peaks of the transfer function that are too narrow for scalars in single precision. Private.
 *
 * Cells whose scalars come near such a peak are worked out in double precision, as careful ones are, and so are the
 * scalars at both ends of their segments. A segment is cut at the knots in double precision; what a piece carries is
 * the place of its ends between two knots, 0..1, to which single precision does justice however near these lie. So
 * pieces of sharp segments have a table of their own, behind the other in the same array. */
#ifndef CELLIST_SOFT_SHARP_H
#define CELLIST_SOFT_SHARP_H

#include <optics/fast_optics.h>

/* Scaled scalars near a narrow gap, from low to high. */
typedef struct soft_zone {
  double low, high;
} soft_zone;

typedef struct soft_sharp {
  size_t zone_count; /* 0: the transfer function has no narrow gap, and the rest is unused */
  soft_zone *zones;  /* [zone_count] ascending, apart */
  size_t interval_count;
  double *bounds; /* [interval_count + 1] in scaled scalars, the outermost infinite */
  uint32_t first; /* of these intervals in the table, each over 0..1 between its bounds */
} soft_sharp;

/* length_unit and has_colour as fast_transfer_create's, which made the table; it is made longer. Errors: OUT_OF_MEMORY.
 */
cellist_result soft_sharp_make(cellist_context *context, const cellist_transfer *transfer, double minimum,
                               double maximum, double length_unit, bool has_colour, fast_transfer *table,
                               soft_sharp *sharp);
void soft_sharp_release(cellist_context *context, soft_sharp *sharp);

static inline bool soft_sharp_meets(const soft_sharp *sharp, double low, double high) {
  for (size_t i = 0; i < sharp->zone_count; i++)
    if (sharp->zones[i].low <= high && low <= sharp->zones[i].high) return true;
  return false;
}

/* Which interval holds a scalar, at a step the lower one. */
static inline size_t soft_sharp_find(const soft_sharp *sharp, double s) {
  size_t low = 0, high = sharp->interval_count - 1;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (s <= sharp->bounds[middle + 1])
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

#endif
