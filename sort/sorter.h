/* SPDX-License-Identifier: BSD-3-Clause
 * What a sorter holds. Private to sort/. */
#ifndef CELLIST_SORT_SORTER_H
#define CELLIST_SORT_SORTER_H

#include <cellist/sort.h>

#include "cells.h"
#include "gaps/gaps.h"
#include "signs/signs.h"
#include "view.h"

/* A cell's state in one view: bits 0-3: the neighbour there lies in front; bits 4-6: how many neighbours behind it are
 * not out, and one more for gap arcs; bit 7: gap arcs lead from it to nearer cells. */
enum { SORT_PENDING = 16, SORT_PENDING_MASK = 0x70, SORT_HAS_GAP_ARCS = 0x80 };

struct cellist_sorter {
  cellist_context *context;
  cellist_sorter_desc mesh;
  sort_cells cells;
  bool convex; /* no gap anywhere: faces alone order the cells, and gaps is empty */
  sort_gaps gaps;
  sort_planes planes;
  uint8_t *state; /* [cells.count] and some, so that eight can be read at once */
  size_t group_count, group_capacity;
  cellist_group *groups;
  uint64_t *group_scratch;
  size_t group_scratch_capacity;
  uint32_t *search_scratch;
  size_t search_scratch_capacity;
};

#endif
