/* SPDX-License-Identifier: BSD-3-Clause
 * The eye's side of every shared face. Private to sort/. */
#ifndef CELLIST_SORT_SIGNS_H
#define CELLIST_SORT_SIGNS_H

#include "../cells.h"
#include "../ends.h"
#include "kernel.h"

/* All planes of a mesh in 16 bits a coordinate, in a frame of their own (centre at 0, the farthest point at 1). */
typedef struct sort_planes {
  size_t group_count; /* of four tets */
  int16_t *planes;    /* [64 group_count] */
  uint16_t *inner;    /* [group_count] bits as the kernel's */
  uint16_t
      *level[3]; /* [group_count] bits as inner: coordinate 0, 1, 2 of the face's normal is known to be exactly 0 */
  double centre[3], radius;
  sort_sign_kernel kernel;
} sort_planes;

/* Fills a zeroed sort_planes. Errors: OUT_OF_MEMORY (what is there can be released). Cost: linear. */
cellist_result sort_planes_create(cellist_context *context, const sort_cells *cells, sort_planes *planes);
void sort_planes_release(cellist_context *context, sort_planes *planes);

/* Writes all cells' states (bit k: the neighbour across face k lies in front; a wait for each neighbour behind).
 * states: [4 group_count], of which cells->count matter. Returns how many faces 16 bits could not decide.
 * ends: NULL, or for a sort from both ends: then states of its near half wait for one more, and its mirrored states say
 * of that half what lies behind (bits) and for how many in front to wait; of the other half SORT_HELD. */
size_t sort_planes_find_states(cellist_context *context, const sort_cells *cells, const sort_planes *planes,
                               const sort_eye *eye, uint8_t *states, const sort_ends *ends);

#endif
