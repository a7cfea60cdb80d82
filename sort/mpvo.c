/* SPDX-License-Identifier: BSD-3-Clause
 * MPVO: meshed polyhedra visibility order (Williams 1992; Roettger et al. 2004, section 3), with gap arcs.
 *
 * Of the two cells at a face, the one on the eye's side of the face's plane lies in front. A cell is ready when all
 * cells behind it (across a face, a facet or a gap) are out. The queue of ready cells is the order itself. */
#include "mpvo.h"

#include <string.h>

#include "arcs.h"
#include "follow.h"

/* Cells are taken from the queue in batches, each in two passes without branches that depend on signs (every second one
 * would be guessed wrong): first the arcs that leave the batch's cells are listed, then each arc takes one from its
 * target's pending count and writes the target to the queue's end, which moves only past ready cells. While a batch is
 * worked on, the neighbours of the next one are on their way from memory. 32 is slower, 128 no faster. */
enum { BATCH = 64 };

/* Cells with nothing behind them, eight states at a time. */
static size_t find_farthest(const cellist_sorter *sorter, uint32_t *order) {
  const uint8_t *state = sorter->state;
  const size_t cell_count = sorter->cells.count;
  size_t count = 0;
  for (size_t i = 0; i < cell_count; i += 8) {
    uint64_t pending = 0; /* bit 4 of each byte: something is behind that cell */
    memcpy(&pending, &state[i], sizeof pending);
    pending = (pending >> 4 | pending >> 5 | pending >> 6) & 0x0101010101010101u;
    if (pending == 0x0101010101010101u) continue;
    for (size_t j = i; j < i + 8 && j < cell_count; j++)
      if ((state[j] & SORT_PENDING_MASK) == 0) order[count++] = (uint32_t)j;
  }
  return count;
}

size_t sort_topologically(cellist_sorter *sorter, uint32_t *order) {
  const uint32_t *neighbours = sorter->cells.neighbours;
  uint8_t *state = sorter->state;
  const sort_arc_kernel list_arcs = sort_has_avx2() ? sort_list_arcs_avx2 : sort_list_arcs_portable;
  uint32_t arcs[4 * BATCH + 4];
  sort_follow_begin(sorter);
  size_t count = find_farthest(sorter, order), out = 0, fetched = 0;
  count = sort_follow_farthest(sorter, order, count);
  while (out < count) {
    const size_t size = count - out < BATCH ? count - out : BATCH;
    const size_t next_end = count - out < 2 * BATCH ? count : out + 2 * BATCH;
    for (; fetched < next_end; fetched++) __builtin_prefetch(&neighbours[4 * (size_t)order[fetched]]);
    uint32_t states = 0;
    const size_t arc_count = list_arcs(neighbours, state, &order[out], size, arcs, &states);
    /* An arc's target is not out yet, so the queue has room for it. */
    for (size_t i = 0; i < arc_count; i++) {
      const uint32_t target = arcs[i];
      const uint8_t left = (uint8_t)(state[target] - SORT_PENDING);
      state[target] = left;
      order[count] = target;
      count += (left & SORT_PENDING_MASK) == 0;
    }
    if (states & SORT_HAS_ARCS)
      for (size_t i = 0; i < size; i++)
        if (state[order[out + i]] & SORT_HAS_ARCS) count = sort_follow(sorter, order[out + i], order, count);
    out += size;
  }
  return count;
}
