/* SPDX-License-Identifier: BSD-3-Clause
 * Shift: see reference_shift.h. */
#include "reference_shift.h"

#include <math.h>
#include <string.h>

double shift_of(const cellist_scalar *scalar) {
  const double low = scalar->minimum, high = scalar->maximum, nearer = fabs(low) <= fabs(high) ? low : high;
  return low * high > 0 && high - low <= fabs(nearer) ? nearer : 0;
}

double *shift_values(cellist_context *context, const cellist_scalar *scalar, double shift) {
  double *values = cellist_allocate(context, scalar->count, sizeof *values);
  for (size_t i = 0; values != NULL && i < scalar->count; i++) values[i] = scalar->values[i] - shift;
  return values;
}

cellist_result shift_optics(cellist_context *context, double shift, cellist_transfer *transfer,
                            cellist_optics *optics) {
  cellist_transfer_knot *knots = cellist_allocate(context, transfer->knot_count, sizeof *knots);
  cellist_isosurface *isos = cellist_allocate(context, optics->iso_count, sizeof *isos);
  if (knots == NULL || isos == NULL) {
    cellist_deallocate(context, knots);
    cellist_deallocate(context, isos);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < transfer->knot_count; i++) {
    knots[i] = transfer->knots[i];
    knots[i].value -= shift;
  }
  for (size_t i = 0; i < optics->iso_count; i++)
    isos[i] = (cellist_isosurface){optics->isos[i].value - shift, optics->isos[i].opacity};
  transfer->knots = knots;
  optics->isos = isos;
  return CELLIST_SUCCESS;
}

void shift_release(cellist_context *context, cellist_transfer *transfer, cellist_optics *optics) {
  cellist_deallocate(context, transfer->knots);
  cellist_deallocate(context, (void *)optics->isos);
}
