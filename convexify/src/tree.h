/* SPDX-License-Identifier: BSD-3-Clause
 * Tree: a hierarchy of boxes over a fixed set of items, in one array. Private to convexify. */
#ifndef CELLIST_CONVEXIFY_TREE_H
#define CELLIST_CONVEXIFY_TREE_H

#include "work.h"

/* Reorders ids so that tree_visit finds them: the node of ids[begin, end) splits at the middle down to TREE_LEAF.
 * boxes: 6 doubles per id (low x y z, high x y z), by id. */
enum { TREE_LEAF = 4 };
void tree_build(uint32_t *ids, size_t count, const double *boxes, double *node_boxes);

/* How many doubles node_boxes needs. */
size_t tree_box_count(size_t count);

/* Appends the ids whose box meets the given box, borders included. */
void tree_meeting(work *w, const uint32_t *ids, size_t count, const double *boxes, const double *node_boxes,
                  const double box[6], id_list *out);

#endif
