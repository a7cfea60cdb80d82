/* SPDX-License-Identifier: BSD-3-Clause
 * What a sorter holds. Private to sort/. */
#ifndef CELLIST_SORT_SORTER_H
#define CELLIST_SORT_SORTER_H

#include <cellist/sort.h>

#include "view.h"

struct cellist_sorter {
  cellist_context *context;
  cellist_sorter_desc mesh;
  bool convex;    /* no gap anywhere: faces alone order the cells */
  uint8_t *state; /* [tet_count] bits 0-3: the neighbour there lies in front; bits 4-6: neighbours behind, not out */
  uint64_t *heap; /* [tet_count] distance of a cell as the key, far first */
  size_t group_count;
  cellist_group *groups;
};

#endif
