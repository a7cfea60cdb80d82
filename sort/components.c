/* SPDX-License-Identifier: BSD-3-Clause
 * Components: strongly connected components of the cells that are left, after Tarjan ("Depth-first search and linear
 * graph algorithms", 1972), without recursion. Arcs lead from far to near and a component is complete only after all
 * that it leads to, so components come out near to far, and the order fills from its end.
 *
 * An imaginary cell puts all that lies behind it behind all that lies in front of it, though only cells on a common ray
 * order each other: with few, large imaginary cells most concave meshes are cyclic from everywhere, which Roettger et
 * al. (2004) do not mention. So in a component that holds imaginary cells these are dropped, and gap arcs order the
 * component's tets instead: each of them is a true constraint, and each step of a ray from a tet through a gap
 * into the next tet is one. No path between two members leaves the component, so what is still cyclic is a true cycle.
 */
#include "components.h"

#include <cellist/radix.h>
#include <string.h>

/* One node of the path that the search stands on, and the next arc to look at: 0-3 faces, then the others. */
struct sort_step {
  uint32_t node, arc;
};

/* Nodes are cells, and after them large imaginary cells. */
struct search {
  cellist_sorter *sorter;
  uint32_t *order;
  size_t end; /* order[end] and following are filled */
  uint32_t *index, *low;
  uint32_t *stack;
  size_t stack_count;
  struct sort_step *path;
  uint32_t next_index;
  size_t part_count;
};

/* index: 0 not seen, UINT32_MAX already in the order. */
static const uint32_t PLACED = UINT32_MAX;

/* A part that is to be taken apart, not a group yet. */
static const size_t OPEN = SIZE_MAX / 2 + 1;

/* The next node that an arc of the step's leads to; CELLIST_NONE after the last one. */
static inline uint32_t next_target(const cellist_sorter *sorter, struct sort_step *step) {
  const size_t cell_count = sorter->cells.count;
  if (step->node < cell_count) {
    for (; step->arc < 4; step->arc++)
      if (sorter->state[step->node] >> step->arc & 1)
        return sorter->cells.neighbours[4 * (size_t)step->node + step->arc++];
    if (!(sorter->state[step->node] & SORT_HAS_ARCS)) return CELLIST_NONE;
  } else if (step->arc < 4) {
    step->arc = 4;
  }
  if (sorter->uses_gap_arcs) {
    const sort_gaps *gaps = &sorter->gaps;
    const uint32_t place = gaps->places[gaps->boundary.tet_rows[step->node]];
    const size_t at = gaps->starts[place] + (step->arc - 4);
    if (at >= gaps->starts[place + 1]) return CELLIST_NONE;
    step->arc++;
    return gaps->boundary.row_tets[gaps->rows[gaps->targets[at]]];
  }
  const sort_links *links = &sorter->complex.links;
  const uint32_t own =
      step->node < cell_count ? links->cell_rows[step->node] : (uint32_t)(links->row_count + (step->node - cell_count));
  while (links->starts[own] + (step->arc - 4) < links->starts[own + 1]) {
    uint32_t target;
    const uint32_t link = links->links[links->starts[own] + (step->arc++ - 4)];
    if (!sort_link_target(links, link, &target)) continue;
    return target < links->row_count ? links->row_cells[target] : (uint32_t)(cell_count + (target - links->row_count));
  }
  return CELLIST_NONE;
}

/* Moves the component that ends with root from the stack to the order. */
static void place(struct search *search, uint32_t root) {
  cellist_sorter *sorter = search->sorter;
  const size_t tet_count = sorter->mesh.tet_count;
  size_t count = 0, tets = 0;
  uint32_t node;
  do {
    node = search->stack[search->stack_count - ++count];
    search->index[node] = PLACED;
    if (node < tet_count) search->order[search->end - ++tets] = node;
  } while (node != root);
  search->stack_count -= count;
  search->end -= tets;
  const bool is_open = tets < count && tets > 1;
  if (tets > 1) sorter->parts[search->part_count++] = (cellist_group){search->end, is_open ? tets | OPEN : tets};
  /* Which part a node belongs to, for taking it apart; 0: none. */
  const uint32_t part = is_open ? (uint32_t)search->part_count : 0;
  for (size_t i = 0; i < count; i++) search->low[search->stack[search->stack_count + i]] = part;
}

/* All components that can be reached from a node. */
static void search_from(struct search *search, uint32_t node) {
  size_t depth = 0;
  uint32_t *index = search->index, *low = search->low;
  search->path[0] = (struct sort_step){node, 0};
  index[node] = low[node] = ++search->next_index;
  search->stack[search->stack_count++] = node;
  for (;;) {
    struct sort_step *step = &search->path[depth];
    const uint32_t target = next_target(search->sorter, step);
    if (target != CELLIST_NONE) {
      if (index[target] == 0) {
        search->path[++depth] = (struct sort_step){target, 0};
        index[target] = low[target] = ++search->next_index;
        search->stack[search->stack_count++] = target;
      } else if (index[target] < low[step->node]) { /* PLACED is larger than any */
        low[step->node] = index[target];
      }
      continue;
    }
    const uint32_t own = step->node, lowest = low[own];
    if (lowest == index[own]) place(search, own);
    if (depth == 0) return;
    const uint32_t before = search->path[--depth].node;
    if (lowest < low[before]) low[before] = lowest;
  }
}

cellist_result sort_components_prepare(cellist_sorter *sorter) {
  const size_t nodes = sorter->cells.count + sorter->complex.links.large_count;
  const size_t parts = sorter->mesh.tet_count / 2 + 1; /* of two tets at least */
  sorter->groups = cellist_allocate(sorter->context, parts, sizeof *sorter->groups);
  sorter->parts = cellist_allocate(sorter->context, parts, sizeof *sorter->parts);
  sorter->scratch = cellist_allocate(sorter->context, nodes, SORT_SCRATCH * sizeof *sorter->scratch);
  const bool ok = sorter->groups != NULL && sorter->parts != NULL && sorter->scratch != NULL;
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static struct search start(cellist_sorter *sorter, uint32_t *order) {
  const size_t nodes = sorter->cells.count + sorter->complex.links.large_count;
  uint32_t *scratch = sorter->scratch;
  return (struct search){.sorter = sorter,
                         .order = order,
                         .end = sorter->mesh.tet_count,
                         .index = scratch,
                         .low = &scratch[nodes],
                         .stack = &scratch[2 * nodes],
                         .path = (struct sort_step *)&scratch[3 * nodes]};
}

/* Stage 2: all that the topological sort left. */
static void search_all(struct search *search) {
  const cellist_sorter *sorter = search->sorter;
  const sort_links *links = &sorter->complex.links;
  const size_t cell_count = sorter->cells.count;
  for (size_t i = 0; i < cell_count; i++)
    if (sort_is_waiting(sorter->state[i])) search->index[i] = 0;
  for (size_t i = 0; i < links->large_count; i++)
    if (links->pending[links->row_count + i] > 0) search->index[cell_count + i] = 0;
  for (uint32_t i = 0; i < cell_count; i++)
    if (sort_is_waiting(sorter->state[i]) && search->index[i] == 0) search_from(search, i);
}

/* Stage 3: lists the rows of the open parts' tets, and leaves of their arcs across faces those that stay in the part.
 */
static void open_parts(struct search *search, cellist_sort_stats *stats) {
  cellist_sorter *sorter = search->sorter;
  sort_gaps *gaps = &sorter->gaps;
  gaps->row_count = 0;
  for (size_t p = 0; p < search->part_count; p++) {
    if (!(sorter->parts[p].count & OPEN)) continue;
    const size_t count = sorter->parts[p].count & ~OPEN;
    stats->component_cell_count += count;
    for (size_t i = sorter->parts[p].begin; i < sorter->parts[p].begin + count; i++) {
      const uint32_t tet = search->order[i];
      uint8_t state = sorter->state[tet] & 15;
      for (uint32_t k = 0; k < 4; k++) {
        if (!(state >> k & 1)) continue;
        const uint32_t other = sorter->cells.neighbours[4 * (size_t)tet + k];
        if (other >= sorter->mesh.tet_count || search->low[other] != p + 1) state = (uint8_t)(state & ~(1u << k));
      }
      const uint32_t row = gaps->boundary.tet_rows[tet];
      if (row != CELLIST_NONE) {
        state |= SORT_HAS_ARCS;
        gaps->part_list[gaps->row_count] = (uint32_t)p;
        gaps->rows[gaps->row_count++] = row;
      }
      sorter->state[tet] = state;
    }
  }
}

static void add_groups(cellist_sorter *sorter, const cellist_group *found, size_t count) {
  /* Found near to far. */
  for (size_t i = count; i-- > 0;) sorter->groups[sorter->group_count++] = found[i];
}

/* Takes the open parts apart, and makes groups of what does not come apart; far to near. */
static cellist_result take_apart(struct search *search, const sort_eye *eye, cellist_sort_stats *stats) {
  cellist_sorter *sorter = search->sorter;
  const size_t part_count = search->part_count;
  bool any = false;
  for (size_t p = 0; p < part_count; p++) any |= (sorter->parts[p].count & OPEN) != 0;
  if (any) {
    open_parts(search, stats);
    const cellist_result result = sort_gaps_find_among(sorter->context, &sorter->gaps, eye);
    if (result != CELLIST_SUCCESS) return result;
    stats->gap_arc_count = sorter->gaps.arc_count;
    stats->gap_candidate_count = sorter->gaps.candidate_count;
    sorter->uses_gap_arcs = true;
  }
  for (size_t p = part_count; p-- > 0;) {
    const cellist_group part = sorter->parts[p];
    if (!(part.count & OPEN)) {
      sorter->groups[sorter->group_count++] = part;
      continue;
    }
    const size_t count = part.count & ~OPEN;
    /* The members stand where the search puts its finds: it starts from a copy of them. Parts found go behind those
     * that are still to be taken apart. */
    uint32_t *members = sorter->queue;
    memcpy(members, &search->order[part.begin], count * sizeof *members);
    for (size_t i = 0; i < count; i++) search->index[members[i]] = 0;
    search->end = part.begin + count;
    search->next_index = 0;
    search->part_count = part_count;
    for (size_t i = 0; i < count; i++)
      if (search->index[members[i]] == 0) search_from(search, members[i]);
    add_groups(sorter, &sorter->parts[part_count], search->part_count - part_count);
  }
  return CELLIST_SUCCESS;
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

/* Orders a group's tets by distance, in the scratch of the search, which is over. */
static void sort_group(cellist_sorter *sorter, const sort_eye *eye, uint32_t *members, size_t count) {
  uint64_t *keys = (uint64_t *)(void *)sorter->scratch;
  for (size_t i = 0; i < count; i++) keys[i] = nearness_key(&sorter->mesh, eye, members[i]);
  cellist_radix_sort(keys, members, count, &keys[count], (uint32_t *)&keys[2 * count], 64);
}

cellist_result sort_components(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, size_t done,
                               cellist_sort_stats *stats) {
  struct search search = start(sorter, order);
  stats->left_cell_count = sorter->mesh.tet_count - done;
  search_all(&search);
  const cellist_result result = take_apart(&search, eye, stats);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t g = 0; g < sorter->group_count; g++)
    sort_group(sorter, eye, &order[sorter->groups[g].begin], sorter->groups[g].count);
  return CELLIST_SUCCESS;
}
