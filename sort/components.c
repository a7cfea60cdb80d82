/* SPDX-License-Identifier: BSD-3-Clause
 * Components: strongly connected components of the cells that are left, after Tarjan ("Depth-first search and linear
 * graph algorithms", 1972), without recursion. Arcs lead from far to near and a component is complete only after all
 * that it leads to, so components come out near to far, and the order fills from its end. */
#include "components.h"

#include <cellist/radix.h>
#include <string.h>

#include "memory.h"

/* One cell of the path that the search stands on, and the next arc to look at: 0-3 faces, then gap arcs. */
struct sort_step {
  uint32_t tet, arc;
};

/* The cell that arc number `arc` of tet leads to; CELLIST_NONE: no such face arc; returns false after the last one. */
static bool arc_target(const cellist_sorter *sorter, uint32_t tet, uint32_t arc, uint32_t *target) {
  if (arc < 4) {
    const bool in_front = sorter->state[tet] >> arc & 1;
    *target = in_front ? sorter->mesh.neighbours[4 * (size_t)tet + arc] : CELLIST_NONE;
    return true;
  }
  if (sorter->convex) return false;
  const sort_gaps *gaps = &sorter->gaps;
  const uint32_t row = gaps->boundary.tet_rows[tet];
  if (row == CELLIST_NONE || gaps->starts[row] + (arc - 4) >= gaps->starts[row + 1]) return false;
  *target = gaps->boundary.row_tets[gaps->targets[gaps->starts[row] + (arc - 4)]];
  return true;
}

/* An integer that orders like the distance of the cell's centre from the eye, but nearest first. */
static uint64_t nearness_key(const cellist_sorter_desc *mesh, const sort_eye *eye, uint32_t tet) {
  double squared = 0, along = 0;
  for (size_t k = 0; k < 3; k++) {
    double centre = 0;
    for (size_t c = 0; c < 4; c++) centre += 0.25 * mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + c] + k];
    squared += (centre - eye->at[k]) * (centre - eye->at[k]);
    along -= centre * eye->at[k];
  }
  const double distance = eye->parallel ? along : squared;
  uint64_t bits = 0;
  memcpy(&bits, &distance, sizeof bits);
  return bits >> 63 ? bits : ~bits & INT64_MAX;
}

struct search {
  cellist_sorter *sorter;
  uint32_t *order;
  size_t end; /* order[end] and following are filled */
  uint32_t *index, *low;
  uint32_t *stack;
  size_t stack_count;
  struct sort_step *path;
  uint32_t next_index;
};

/* index: 0 not seen, UINT32_MAX already in the order. */
static const uint32_t PLACED = UINT32_MAX;

/* Moves the component that ends with root from the stack to the order. */
static cellist_result place(struct search *search, const sort_eye *eye, uint32_t root) {
  cellist_sorter *sorter = search->sorter;
  size_t count = 0;
  do {
    const uint32_t tet = search->stack[search->stack_count - ++count];
    search->index[tet] = PLACED;
    if (tet == root) break;
  } while (true);
  search->stack_count -= count;
  search->end -= count;
  uint32_t *members = &search->order[search->end];
  memcpy(members, &search->stack[search->stack_count], count * sizeof *members);
  if (count == 1) return CELLIST_SUCCESS;
  cellist_context *context = sorter->context;
  cellist_result result = sort_reserve(context, &sorter->groups, &sorter->group_capacity, sorter->group_count,
                                       sorter->group_count + 1, sizeof *sorter->groups);
  if (result == CELLIST_SUCCESS)
    result = sort_reserve(context, &sorter->group_scratch, &sorter->group_scratch_capacity, 0, 3 * count,
                          sizeof *sorter->group_scratch);
  if (result != CELLIST_SUCCESS) return result;
  uint64_t *keys = sorter->group_scratch;
  uint32_t *scratch = (uint32_t *)&keys[2 * count];
  for (size_t i = 0; i < count; i++) keys[i] = nearness_key(&sorter->mesh, eye, members[i]);
  cellist_radix_sort(keys, members, count, &keys[count], scratch, 64);
  sorter->groups[sorter->group_count++] = (cellist_group){search->end, count};
  return CELLIST_SUCCESS;
}

/* All components that can be reached from tet. */
static cellist_result search_from(struct search *search, const sort_eye *eye, uint32_t tet) {
  size_t depth = 0;
  search->path[0] = (struct sort_step){tet, 0};
  search->index[tet] = search->low[tet] = ++search->next_index;
  search->stack[search->stack_count++] = tet;
  for (;;) {
    struct sort_step *step = &search->path[depth];
    uint32_t target;
    if (arc_target(search->sorter, step->tet, step->arc, &target)) {
      step->arc++;
      if (target == CELLIST_NONE || search->index[target] == PLACED) continue;
      if (search->index[target] == 0) {
        search->path[++depth] = (struct sort_step){target, 0};
        search->index[target] = search->low[target] = ++search->next_index;
        search->stack[search->stack_count++] = target;
      } else if (search->index[target] < search->low[step->tet]) {
        search->low[step->tet] = search->index[target];
      }
      continue;
    }
    if (search->low[step->tet] == search->index[step->tet]) {
      const cellist_result result = place(search, eye, step->tet);
      if (result != CELLIST_SUCCESS) return result;
    }
    if (depth == 0) return CELLIST_SUCCESS;
    struct sort_step *before = &search->path[--depth];
    if (search->low[step->tet] < search->low[before->tet]) search->low[before->tet] = search->low[step->tet];
  }
}

cellist_result sort_components(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, size_t done) {
  const size_t tet_count = sorter->mesh.tet_count;
  cellist_result result = sort_reserve(sorter->context, &sorter->search_scratch, &sorter->search_scratch_capacity, 0,
                                       5 * tet_count, sizeof *sorter->search_scratch);
  if (result != CELLIST_SUCCESS) return result;
  uint32_t *scratch = sorter->search_scratch;
  struct search search = {.sorter = sorter, .order = order, .end = tet_count};
  search.index = scratch;
  search.low = &scratch[tet_count];
  search.stack = &scratch[2 * tet_count];
  search.path = (struct sort_step *)&scratch[3 * tet_count];
  memset(search.index, 0, tet_count * sizeof *search.index);
  for (size_t i = 0; i < done; i++) search.index[order[i]] = PLACED;
  for (uint32_t i = 0; i < tet_count && result == CELLIST_SUCCESS; i++)
    if (search.index[i] == 0) result = search_from(&search, eye, i);
  /* Found near to far. */
  for (size_t i = 0, j = sorter->group_count; i + 1 < j; i++) {
    const cellist_group swap = sorter->groups[--j];
    sorter->groups[j] = sorter->groups[i];
    sorter->groups[i] = swap;
  }
  return result;
}
