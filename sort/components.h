/* SPDX-License-Identifier: BSD-3-Clause
 * What a topological sort leaves: cycles, and all that lies in front of them. Private to sort/. */
#ifndef CELLIST_SORT_COMPONENTS_H
#define CELLIST_SORT_COMPONENTS_H

#include "sorter.h"

/* Orders the tets that are not out yet (order[done] and following): strongly connected components, far to near. One of
 * several tets becomes a group, its tets in order of their centres' distance; but first, if imaginary cells are part of
 * it, they are dropped and the component is taken apart by gap arcs. Counts into stats what was looked at.
 * Errors: OUT_OF_MEMORY. Cost: linear in the cells left and their arcs; gap arcs where components hold imaginary cells.
 */
cellist_result sort_components(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, size_t done,
                               cellist_sort_stats *stats);

/* Makes the memory that sort_components needs for any view (16 bytes a tet and 20 a cell, which most views of most
 * meshes never touch). Errors: OUT_OF_MEMORY. */
cellist_result sort_components_prepare(cellist_sorter *sorter);

#endif
