/* SPDX-License-Identifier: BSD-3-Clause
 * Sharp: see sharp.h. */
#include "sharp.h"

#include <string.h>

/* Scaled scalars. Cells that come no nearer to a narrow gap are drawn in single precision, which clamps scalars to the
 * cell's range. Below rounding (6e-8): pieces of a peak are lost; larger: more cells are drawn in double precision. */
static const double MARGIN = 1e-6;

/* Scalars lie in 0..1; knots beyond these are brought here, so that no width overflows. */
static const double LEAST = -1, MOST = 2;

/* The transfer function at one end of an interval. */
struct end {
  double at, extinction, colour[3];
};

static struct end end_at(const cellist_transfer *transfer, const cellist_transfer_knot *knot,
                         const fast_transfer *table) {
  struct end made = {.at = fast_scalar_exact(table, knot->value), .extinction = knot->extinction};
  memcpy(made.colour, knot->colour, sizeof made.colour);
  const double limit = made.at < LEAST ? LEAST : MOST;
  if (made.at >= LEAST && made.at <= MOST) return made;
  made.at = limit;
  made.extinction =
      cellist_transfer_evaluate(transfer, table->scalar_low + 2 * limit * table->scalar_half_range, made.colour);
  return made;
}

static fast_interval interval_of(const struct end *a, const struct end *b, double length_unit, bool has_colour) {
  const double low = fmin(a->extinction * length_unit, FAST_EXTINCTION_LIMIT);
  const double high = fmin(b->extinction * length_unit, FAST_EXTINCTION_LIMIT);
  fast_interval made = {.low = 0, .high = 1, .extinction = (float)low, .extinction_slope = (float)(high - low)};
  for (int k = 0; k < 3 && has_colour; k++) {
    made.colour[k] = (float)a->colour[k];
    made.colour_slope[k] = (float)(b->colour[k] - a->colour[k]);
  }
  return made;
}

static void find_zones(const cellist_transfer *transfer, double minimum, double maximum, const fast_transfer *table,
                       soft_sharp *sharp) {
  for (size_t i = 0; i + 1 < transfer->knot_count; i++) {
    const cellist_transfer_knot *knot = &transfer->knots[i];
    if (!cellist_transfer_is_narrow_gap(knot, minimum, maximum)) continue;
    const soft_zone zone = {fast_scalar_exact(table, knot[0].value) - MARGIN,
                            fast_scalar_exact(table, knot[1].value) + MARGIN};
    soft_zone *last = sharp->zone_count > 0 ? &sharp->zones[sharp->zone_count - 1] : NULL;
    if (last != NULL && zone.low <= last->high)
      last->high = zone.high;
    else
      sharp->zones[sharp->zone_count++] = zone;
  }
}

cellist_result soft_sharp_make(cellist_context *context, const cellist_transfer *transfer, double minimum,
                               double maximum, double length_unit, bool has_colour, fast_transfer *table,
                               soft_sharp *sharp) {
  *sharp = (soft_sharp){0};
  if (!cellist_transfer_is_narrow(transfer, minimum, maximum)) return CELLIST_SUCCESS;
  const size_t count = transfer->knot_count + 1, before = table->interval_count;
  fast_interval *intervals =
      cellist_reallocate(context, table->intervals, transfer->knot_count + 2, before + count, sizeof *intervals);
  if (intervals == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  table->intervals = intervals;
  table->is_small = false; /* look-ups reach the second table */
  soft_sharp made = {.interval_count = count, .first = table->interval_count};
  made.zones = cellist_allocate(context, transfer->knot_count, sizeof *made.zones);
  made.bounds = cellist_allocate(context, count + 1, sizeof *made.bounds);
  if (made.zones == NULL || made.bounds == NULL) {
    soft_sharp_release(context, &made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  struct end last = end_at(transfer, &transfer->knots[0], table);
  made.bounds[0] = -HUGE_VAL;
  intervals[before] = interval_of(&last, &last, length_unit, has_colour);
  for (size_t i = 0; i < transfer->knot_count; i++) {
    const size_t next = i + 1 < transfer->knot_count ? i + 1 : i;
    const struct end end = end_at(transfer, &transfer->knots[next], table);
    made.bounds[i + 1] = last.at;
    intervals[before + i + 1] = interval_of(&last, &end, length_unit, has_colour);
    last = end;
  }
  made.bounds[count] = HUGE_VAL;
  find_zones(transfer, minimum, maximum, table, &made);
  *sharp = made;
  return CELLIST_SUCCESS;
}

void soft_sharp_release(cellist_context *context, soft_sharp *sharp) {
  cellist_deallocate(context, sharp->zones);
  cellist_deallocate(context, sharp->bounds);
  *sharp = (soft_sharp){0};
}
