/* SPDX-License-Identifier: BSD-3-Clause
 * Whether a mesh fills its convex hull, so that its faces alone order its cells. Private to sort/. */
#ifndef CELLIST_SORT_CONVEXITY_H
#define CELLIST_SORT_CONVEXITY_H

#include <cellist/sort.h>

/* Decides exactly; *convex is also true of a mesh without cells.
 * Errors: OUT_OF_MEMORY. Cost: linear in the boundary's faces, after one pass over neighbours. */
cellist_result sort_is_convex(cellist_context *context, const cellist_sorter_desc *mesh, bool *convex);

#endif
