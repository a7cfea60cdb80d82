/* SPDX-License-Identifier: BSD-3-Clause
 * Follow: the arcs that the topological sort follows besides those across faces. Large imaginary cells never stand in
 * the queue: as soon as one is ready its own links are followed. */
#include "follow.h"

void sort_follow_begin(cellist_sorter *sorter) {
  const sort_gaps *gaps = &sorter->gaps;
  for (size_t i = 0; sorter->uses_gap_arcs && i < gaps->row_count; i++) {
    uint8_t *state = &sorter->state[gaps->boundary.row_tets[gaps->rows[i]]];
    if (gaps->pending[i] > 0) *state = (uint8_t)(*state + SORT_WAIT);
    if (gaps->starts[i + 1] > gaps->starts[i]) *state |= SORT_HAS_ARCS;
  }
  const sort_links *links = &sorter->complex.links;
  for (size_t r = 0; r < links->row_count; r++) {
    uint8_t *state = &sorter->state[links->row_cells[r]];
    if (links->pending[r] > 0) *state = (uint8_t)(*state + SORT_WAIT);
    *state |= SORT_HAS_ARCS;
  }
}

/* All arcs that are counted as one cell behind this one have come. */
static inline size_t release(cellist_sorter *sorter, uint32_t cell, uint32_t *queue, size_t count) {
  if (sort_let_go(&sorter->state[cell])) queue[count++] = cell;
  return count;
}

static size_t follow_gap_arcs(cellist_sorter *sorter, uint32_t tet, uint32_t *queue, size_t count) {
  sort_gaps *gaps = &sorter->gaps;
  const uint32_t place = gaps->places[gaps->boundary.tet_rows[tet]];
  for (size_t i = gaps->starts[place]; i < gaps->starts[place + 1]; i++) {
    const uint32_t target = gaps->targets[i];
    if (--gaps->pending[target] == 0)
      count = release(sorter, gaps->boundary.row_tets[gaps->rows[target]], queue, count);
  }
  return count;
}

/* Follows a node's links, and those of the large cells that become ready by it. */
static size_t follow_links(cellist_sorter *sorter, uint32_t node, uint32_t *queue, size_t count) {
  sort_links *links = &sorter->complex.links;
  size_t ready_count = 0;
  for (;;) {
    for (uint32_t i = links->starts[node]; i < links->starts[node + 1]; i++) {
      uint32_t target;
      if (!sort_link_target(links, links->links[i], &target) || --links->pending[target] > 0) continue;
      if (target >= links->row_count)
        links->ready[ready_count++] = target;
      else
        count = release(sorter, links->row_cells[target], queue, count);
    }
    if (ready_count == 0) return count;
    node = links->ready[--ready_count];
  }
}

size_t sort_follow_farthest(cellist_sorter *sorter, uint32_t *queue, size_t count) {
  sort_links *links = &sorter->complex.links;
  /* Found before any is followed, so that none is followed twice. */
  size_t farthest = 0;
  for (size_t i = 0; i < links->large_count; i++)
    if (links->pending[links->row_count + i] == 0) links->farthest[farthest++] = (uint32_t)(links->row_count + i);
  for (size_t i = 0; i < farthest; i++) count = follow_links(sorter, links->farthest[i], queue, count);
  return count;
}

size_t sort_follow(cellist_sorter *sorter, uint32_t cell, uint32_t *queue, size_t count) {
  if (sorter->uses_gap_arcs) return follow_gap_arcs(sorter, cell, queue, count);
  return follow_links(sorter, sorter->complex.links.cell_rows[cell], queue, count);
}
