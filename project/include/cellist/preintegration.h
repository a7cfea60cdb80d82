/* SPDX-License-Identifier: BSD-3-Clause
 * Pre-integration: tables of what a ray gathers on a segment, over the scalars at its two ends and its length, for a
 * piecewise linear transfer function; with light as in paper [C], section 8. */
#ifndef CELLIST_PREINTEGRATION_H
#define CELLIST_PREINTEGRATION_H

#include <cellist/optics.h>
#include <cellist/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* {0} with minimum < maximum is valid. */
typedef struct cellist_preintegration_desc {
  double minimum, maximum; /* the scalars of the first and the last node, finite */
  double length_unit;      /* l0, above 0: node k of n stands for the length -l0 log2(1 - k/(n-1)), the last one for an
                              infinite one. 0: 1 */
  uint32_t scalar_count;   /* nodes along each of the two scalar axes, 2 to 1024; 0: CELLIST_TABLE_SCALARS */
  uint32_t length_count;   /* nodes along the length, 3 to 1024; 0: CELLIST_TABLE_LENGTHS */
  bool lit;                /* also what light needs: three arrays instead of one */
} cellist_preintegration_desc;

/* The tables, for upload: entry k of the pair (front f, back b) is the four floats at
 * 4 ((b scalar_count + f) length_count + k). Colours are those that are seen, not premultiplied: with
 * opacity = 1 - exp(-density), density = density_per_unit * length / length_unit, a segment's premultiplied colour is
 * opacity * colour. So the opacity is exact in the length, and thin segments err relative to what they show. */
typedef struct cellist_preintegration_arrays {
  uint32_t scalar_count, length_count;
  double minimum, maximum, length_unit;
  const float *ambient; /* R G B of the colour, and density_per_unit: the mean extinction times length_unit */
  const float *front;   /* R G B weighted by 1-w, w = 0..1 from front to back; and the centre: the mean w of what is
                           seen, which picks the gradient of the highlight. NULL unless lit */
  const float *back;    /* R G B weighted by w: front + back = ambient; and the spread: the standard deviation of w. The
                           highlight is as strong as the opacity. NULL unless lit */
} cellist_preintegration_arrays;

typedef struct cellist_preintegration cellist_preintegration;

/* Makes the tables for a transfer function.
 * Arrays: desc and transfer are read during the call only. *made is the caller's, for cellist_preintegration_destroy.
 * Errors: INVALID_ARGUMENT (NULL, a size or a number out of range, a transfer function that cellist_transfer_check
 *   refuses), OUT_OF_MEMORY.
 * Threads: one call per context at a time; its workers share the work, results do not depend on their number.
 * Cost: linear in entries plus scalar_count * length_count * (scalar_count + knots); 16 bytes an entry and array. */
CELLIST_API cellist_result cellist_preintegration_create(cellist_context *context,
                                                         const cellist_preintegration_desc *desc,
                                                         const cellist_transfer *transfer,
                                                         cellist_preintegration **made);

/* The same for another transfer function, in place.
 * Arrays, errors, threads and cost: as cellist_preintegration_create; after an error the tables are as before. */
CELLIST_API cellist_result cellist_preintegration_update(cellist_preintegration *tables,
                                                         const cellist_transfer *transfer);

/* Frees the tables; NULL is legal. The context that made them must still exist. */
CELLIST_API void cellist_preintegration_destroy(cellist_preintegration *tables);

/* The tables' arrays, which belong to them. Threads: any. */
CELLIST_API cellist_preintegration_arrays cellist_preintegration_get_arrays(const cellist_preintegration *tables);

/* What the tables say of one segment, colours premultiplied. */
typedef struct cellist_preintegrated {
  double colour[3], opacity;
  double front[3], back[3]; /* with light: the colour weighted by 1-w and w */
  double centre, spread;    /* with light */
} cellist_preintegrated;

/* Looks up one segment by linear interpolation on all three axes, as a shader does.
 * Arrays: *found is filled; 0 for light where the tables have none. front and back are cut off at the tables' ends.
 * Errors: none. Threads: any. Cost: 8 entries of each array. */
CELLIST_API void cellist_preintegration_look_up(const cellist_preintegration *tables, double front, double back,
                                                double length, cellist_preintegrated *found);

#ifdef __cplusplus
}
#endif
#endif
