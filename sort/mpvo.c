/* SPDX-License-Identifier: BSD-3-Clause
 * MPVO: meshed polyhedra visibility order (Williams 1992; Roettger et al. 2004, section 3), with gap arcs.
 *
 * Of the two cells at a face, the one on the eye's side of the face's plane lies in front. A cell is ready when all
 * cells behind it (across a face or a gap) are out. The queue of ready cells is the order itself. */
#include "mpvo.h"

static uint8_t state_of(const cellist_sorter_desc *mesh, const sort_eye *eye, uint32_t tet) {
  uint8_t state = 0;
  for (size_t k = 0; k < 4; k++) {
    if (mesh->neighbours[4 * (size_t)tet + k] == CELLIST_NONE) continue;
    const double *p[3];
    for (size_t c = 0; c < 3; c++) p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]]];
    const int side = sort_eye_side(eye, p[0], p[1], p[2]);
    state = (uint8_t)(state + (side > 0 ? 1 << k : side < 0 ? SORT_PENDING : 0));
  }
  return state;
}

void sort_find_states(cellist_sorter *sorter, const sort_eye *eye, cellist_sort_stats *stats) {
  (void)stats;
  for (uint32_t i = 0; i < sorter->mesh.tet_count; i++) sorter->state[i] = state_of(&sorter->mesh, eye, i);
}

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

size_t sort_topologically(cellist_sorter *sorter, uint32_t *order) {
  const uint32_t *neighbours = sorter->mesh.neighbours;
  uint8_t *state = sorter->state;
  size_t count = 0;
  if (!sorter->convex) add_gap_states(sorter);
  for (uint32_t i = 0; i < sorter->mesh.tet_count; i++)
    if ((state[i] & SORT_PENDING_MASK) == 0) order[count++] = i;
  for (size_t out = 0; out < count; out++) {
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
