/* SPDX-License-Identifier: BSD-3-Clause
 * Arcs in plain C: each neighbour is written, and the list's end moves past it only if it lies in front. */
#include "arcs.h"

size_t sort_list_arcs_portable(const uint32_t *neighbours, const uint8_t *state, const uint32_t *tets, size_t count,
                               const uint32_t *ahead, uint32_t *arcs, uint32_t *states) {
  size_t arc_count = 0;
  uint32_t seen = 0;
  for (size_t i = 0; i < count; i++) {
    __builtin_prefetch(&neighbours[4 * (size_t)ahead[i]]);
    const uint32_t front = state[tets[i]];
    const uint32_t *next = &neighbours[4 * (size_t)tets[i]];
    seen |= front;
    for (unsigned k = 0; k < 4; k++) {
      arcs[arc_count] = next[k];
      arc_count += front >> k & 1;
    }
  }
  *states = seen;
  return arc_count;
}
