/* SPDX-License-Identifier: BSD-3-Clause
 * Shift: scalars measured from their own range. Private to the reference caster.
 *
 * A scalar interpolated at 1e9 is rounded to 1e-7, which is 1e-4 of a range of 1e-3: as much as a picture shows. The
 * values themselves are given; what is subtracted from them, the end of the range that is nearer to 0, leaves their
 * differences exact (Sterbenz 1974) wherever the range is no larger than its distance from 0. Else nothing is done. */
#ifndef CELLIST_RAYCAST_REFERENCE_SHIFT_H
#define CELLIST_RAYCAST_REFERENCE_SHIFT_H

#include "raycaster.h"

/* What is to be subtracted; 0: nothing. */
double shift_of(const cellist_scalar *scalar);

/* Copies of the values, of the transfer function and of the isosurfaces with the shift subtracted, and copies' release.
 * Errors: NULL or OUT_OF_MEMORY. */
double *shift_values(cellist_context *context, const cellist_scalar *scalar, double shift);
cellist_result shift_optics(cellist_context *context, double shift, cellist_transfer *transfer, cellist_optics *optics);
void shift_release(cellist_context *context, cellist_transfer *transfer, cellist_optics *optics);

#endif
