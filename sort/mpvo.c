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
 * would be guessed wrong): first the arcs that leave the batch's cells are listed, then each arc takes one from what
 * its target waits for and writes the target to the queue's end, which moves only past ready cells. Meanwhile the
 * neighbours of cells two batches on are on their way from memory. 32 is slower, 128 no faster. */
enum { BATCH = 64, AHEAD = 2 * BATCH };

/* In each byte's lowest bit: does the cell wait for something? */
static inline uint64_t eight_waiting(const uint8_t *state) {
  uint64_t states = 0;
  memcpy(&states, state, sizeof states);
  return ~(states >> 5 & states >> 6 & states >> 7) & 0x0101010101010101u;
}

/* Cells with nothing behind them, eight states at a time. */
static size_t find_farthest(const sort_cells *cells, const uint8_t *state, uint32_t *queue) {
  size_t count = 0;
  for (size_t i = 0; i < cells->count; i += 8) {
    if (eight_waiting(&state[i]) == 0x0101010101010101u) continue;
    for (size_t j = i; j < i + 8 && j < cells->count; j++)
      if (!sort_is_waiting(state[j])) queue[count++] = (uint32_t)j;
  }
  return count;
}

/* An arc's target is written to the queue's end, and stays there if it was the last one that the target waited for. */
static inline size_t take_arc(uint8_t *state, uint32_t target, uint32_t *queue, size_t count) {
  queue[count] = target;
  return count + sort_let_go(&state[target]);
}

/* Follows all arcs of queue[out] to queue[count - 1] and of what becomes ready; returns the new count. queue has room
 * for one cell more than ever become ready. follows: NULL, or whose other arcs to follow. */
static size_t advance(const sort_cells *cells, uint8_t *state, uint32_t *queue, size_t out, size_t count,
                      cellist_sorter *follows) {
  const uint32_t *neighbours = cells->neighbours;
  const sort_arc_kernel list_arcs = sort_has_avx2() ? sort_list_arcs_avx2 : sort_list_arcs_portable;
  uint32_t arcs[4 * BATCH + 4];
  size_t fetched = out;
  while (out < count) {
    const size_t left = count - out, size = left < BATCH ? left : BATCH, near_end = left < AHEAD ? count : out + AHEAD;
    for (; fetched < near_end; fetched++) __builtin_prefetch(&neighbours[4 * (size_t)queue[fetched]]);
    const bool is_long = left >= AHEAD + BATCH;
    const uint32_t *const ahead = &queue[is_long ? out + AHEAD : out];
    if (is_long) fetched = out + AHEAD + BATCH;
    uint32_t states = 0;
    const size_t arc_count = list_arcs(neighbours, state, &queue[out], size, ahead, arcs, &states);
    size_t i = 0;
    for (; i + 4 <= arc_count; i += 4) {
      count = take_arc(state, arcs[i], queue, count);
      count = take_arc(state, arcs[i + 1], queue, count);
      count = take_arc(state, arcs[i + 2], queue, count);
      count = take_arc(state, arcs[i + 3], queue, count);
    }
    for (; i < arc_count; i++) count = take_arc(state, arcs[i], queue, count);
    if (follows != NULL && (states & SORT_HAS_ARCS))
      for (size_t c = 0; c < size; c++)
        if (state[queue[out + c]] & SORT_HAS_ARCS) count = sort_follow(follows, queue[out + c], queue, count);
    out += size;
  }
  return count;
}

/* Lets go of the near half's cells that came out at the nearer end, or of those that did not. */
static size_t let_go(cellist_sorter *sorter, bool came_out, uint32_t *queue, size_t count) {
  const sort_ends *ends = &sorter->ends;
  for (size_t block = 0; block < ends->block_count; block++) {
    if (!ends->is_near[block]) continue;
    for (size_t i = SORT_BLOCK * block; i < SORT_BLOCK * (block + 1) && i < sorter->cells.count; i += 8) {
      uint64_t wanted = eight_waiting(&ends->mirrored[i]);
      if (came_out) wanted ^= 0x0101010101010101u;
      for (; wanted != 0; wanted &= wanted - 1) {
        const size_t cell = i + (size_t)__builtin_ctzll(wanted) / 8;
        if (cell >= sorter->cells.count) break;
        count = take_arc(sorter->state, (uint32_t)cell, queue, count);
      }
    }
  }
  return count;
}

struct job {
  cellist_sorter *sorter;
  uint32_t *order;
  size_t counts[2]; /* out at the farther end, at the nearer end */
};

static void sort_end(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  cellist_sorter *sorter = job->sorter;
  for (size_t nearer = begin; nearer < end; nearer++) {
    uint8_t *state = nearer ? sorter->ends.mirrored : sorter->state;
    uint32_t *queue = nearer ? sorter->ends.queue : job->order;
    const size_t count = find_farthest(&sorter->cells, state, queue);
    job->counts[nearer] = advance(&sorter->cells, state, queue, 0, count, NULL);
  }
}

/* The near half's cells wait in sorter->state for one cell more than lie behind them, so that none comes out at the
 * farther end; in the mirrored states the far half's cells wait for more cells than they have neighbours. */
static size_t sort_from_both_ends(cellist_sorter *sorter, uint32_t *order) {
  struct job job = {.sorter = sorter, .order = order};
  cellist_parallel_for(sorter->context, 2, 1, sort_end, &job);
  const size_t cell_count = sorter->cells.count, near = job.counts[1];
  size_t out = job.counts[0];
  size_t count = let_go(sorter, false, order, out);
  count = advance(&sorter->cells, sorter->state, order, out, count, NULL);
  if (count + near < cell_count) {
    /* Cycles: the farther end goes on as far as it gets, and what came out at the nearer end was for nothing. */
    out = count;
    count = let_go(sorter, true, order, count);
    return advance(&sorter->cells, sorter->state, order, out, count, NULL);
  }
  for (size_t i = 0; i < near; i++) order[cell_count - 1 - i] = sorter->ends.queue[i];
  return cell_count;
}

size_t sort_topologically(cellist_sorter *sorter, uint32_t *order) {
  if (sorter->uses_ends) return sort_from_both_ends(sorter, order);
  sort_follow_begin(sorter);
  size_t count = find_farthest(&sorter->cells, sorter->state, order);
  count = sort_follow_farthest(sorter, order, count);
  return advance(&sorter->cells, sorter->state, order, 0, count, sorter);
}
