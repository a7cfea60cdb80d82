/* SPDX-License-Identifier: BSD-3-Clause
 * MPVO: meshed polyhedra visibility order (Williams 1992; Roettger et al. 2004, section 3), with gap arcs.
 *
 * Of the two cells at a face, the one on the eye's side of the face's plane lies in front. A cell is ready when all
 * cells behind it (across a face or a gap) are out. The queue of ready cells is the order itself. */
#include "mpvo.h"

#include <string.h>

/* Marks cells that gap arcs leave, and counts all arcs that lead to a cell as one more cell behind it. */
static void add_gap_states(cellist_sorter *sorter) {
  const sort_gaps *gaps = &sorter->gaps;
  for (size_t r = 0; r < gaps->boundary.row_count; r++) {
    uint8_t *state = &sorter->state[gaps->boundary.row_tets[r]];
    if (gaps->pending[r] > 0) *state = (uint8_t)(*state + SORT_PENDING);
    if (gaps->starts[r + 1] > gaps->starts[r]) *state |= SORT_HAS_GAP_ARCS;
  }
}

/* A cell that gap arcs leave is out. */
static size_t follow_gap_arcs(cellist_sorter *sorter, uint32_t tet, uint32_t *order, size_t count) {
  sort_gaps *gaps = &sorter->gaps;
  const uint32_t row = gaps->boundary.tet_rows[tet];
  for (size_t i = gaps->starts[row]; i < gaps->starts[row + 1]; i++) {
    const uint32_t target = gaps->targets[i];
    if (--gaps->pending[target] > 0) continue;
    const uint32_t next = gaps->boundary.row_tets[target];
    sorter->state[next] = (uint8_t)(sorter->state[next] - SORT_PENDING);
    if ((sorter->state[next] & SORT_PENDING_MASK) == 0) order[count++] = next;
  }
  return count;
}

/* Cells are taken from the queue in batches: while one batch is worked on, the neighbours of the batch after the next
 * are on their way from memory, and the states of the next one's neighbours. Only speed depends on it. */
enum { BATCH = 16 };

static void fetch_neighbours(const cellist_sorter *sorter, const uint32_t *order, size_t begin, size_t end) {
  for (size_t i = begin; i < end; i++) {
    __builtin_prefetch(&sorter->cells.neighbours[4 * (size_t)order[i]]);
    __builtin_prefetch(&sorter->state[order[i]], 1);
  }
}

static void fetch_states(const cellist_sorter *sorter, const uint32_t *order, size_t begin, size_t end) {
  const uint32_t none = (uint32_t)sorter->cells.count;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *neighbours = &sorter->cells.neighbours[4 * (size_t)order[i]];
    for (size_t k = 0; k < 4; k++) __builtin_prefetch(&sorter->state[neighbours[k] < none ? neighbours[k] : none], 1);
  }
}

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
  const size_t cell_count = sorter->cells.count;
  uint8_t *state = sorter->state;
  if (!sorter->convex) add_gap_states(sorter);
  size_t count = find_farthest(sorter, order), out = 0;
  /* Without branches that depend on signs (each would be wrong half of the time): every neighbour's state is written,
   * less nothing if it is not in front; where there is no neighbour, a spare state is. Each neighbour is written to
   * the queue's end, which moves only past ready ones, so this loop needs room for four cells. */
  size_t fetched_neighbours = 0, fetched_states = 0;
  while (out < count && count + 4 <= cell_count) {
    const size_t end = out + BATCH < count ? out + BATCH : count;
    const size_t next_end = end + BATCH < count ? end + BATCH : count;
    const size_t far_end = next_end + BATCH < count ? next_end + BATCH : count;
    fetch_neighbours(sorter, order, fetched_neighbours, far_end);
    fetch_states(sorter, order, fetched_states, next_end);
    fetched_neighbours = far_end;
    fetched_states = next_end;
    for (; out < end && count + 4 <= cell_count; out++) {
      const uint32_t tet = order[out];
      const uint32_t front = state[tet];
      for (size_t k = 0; k < 4; k++) {
        const uint32_t bit = front >> k & 1;
        const uint32_t spare = (uint32_t)(cell_count + k);
        const uint32_t other = neighbours[4 * (size_t)tet + k];
        const uint32_t next = other < spare ? other : spare;
        const uint8_t left = (uint8_t)(state[next] - bit * SORT_PENDING);
        state[next] = left;
        order[count] = next;
        count += bit & ((left & SORT_PENDING_MASK) == 0);
      }
      if (front & SORT_HAS_GAP_ARCS) count = follow_gap_arcs(sorter, tet, order, count);
    }
  }
  for (; out < count; out++) {
    const uint32_t tet = order[out];
    for (size_t k = 0; k < 4; k++) {
      if (!(state[tet] >> k & 1)) continue;
      const uint32_t next = neighbours[4 * (size_t)tet + k];
      state[next] = (uint8_t)(state[next] - SORT_PENDING);
      if ((state[next] & SORT_PENDING_MASK) == 0) order[count++] = next;
    }
    if (state[tet] & SORT_HAS_GAP_ARCS) count = follow_gap_arcs(sorter, tet, order, count);
  }
  return count;
}
