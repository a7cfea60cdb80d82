/* SPDX-License-Identifier: BSD-3-Clause
 * Topological sort of cells. Private to sort/. */
#ifndef CELLIST_SORT_MPVO_H
#define CELLIST_SORT_MPVO_H

#include "sorter.h"

/* Puts out cells far to near, as long as there is one with nothing left behind it; returns how many. The rest holds
 * cycles, and is still waiting. sorter->state is filled; with sorter->uses_ends, for both
 * ends. */
size_t sort_topologically(cellist_sorter *sorter, uint32_t *order);

#endif
