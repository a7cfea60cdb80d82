/* SPDX-License-Identifier: BSD-3-Clause
 * What a topological sort leaves: cycles, and all that lies in front of them. Private to sort/. */
#ifndef CELLIST_SORT_COMPONENTS_H
#define CELLIST_SORT_COMPONENTS_H

#include "sorter.h"

/* Orders the cells that are not out yet (order[done] and following): strongly connected components, far to near; one
 * of several cells becomes a group, its cells in order of their centres' distance.
 * Errors: OUT_OF_MEMORY. Cost: linear in the cells left and their arcs. */
cellist_result sort_components(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, size_t done);

#endif
