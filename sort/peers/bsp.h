/* SPDX-License-Identifier: BSD-3-Clause
 * A binary space partition of a mesh's boundary faces. Private to sort/peers/. */
#ifndef CELLIST_SORT_PEER_BSP_H
#define CELLIST_SORT_PEER_BSP_H

#include "../gaps/boundary.h"
#include "../view.h"

/* One plane: that of a boundary face, or one across an axis; and the parts of faces that lie in it. */
typedef struct peer_bsp_node {
  uint32_t children[2]; /* behind (below) the plane, and before (above) it; CELLIST_NONE: nothing is there */
  uint32_t face;        /* whose plane it is; CELLIST_NONE: across `axis` at `offset` */
  uint32_t axis;
  double offset;
  uint32_t begin, count; /* parts[begin] and following lie in the plane */
} peer_bsp_node;

typedef struct peer_bsp {
  size_t node_count, node_capacity;
  peer_bsp_node *nodes; /* nodes[0] is the root, if there is one */
  size_t part_count, part_capacity;
  uint32_t *parts;       /* [part_count] whose part it is: a face */
  uint32_t *part_counts; /* [face_count] parts of each face */
  size_t depth;          /* nodes on the longest path */
} peer_bsp;

/* Fills a zeroed tree. Errors: OUT_OF_MEMORY (what is there can be released). Cost: some 5 us a face. */
cellist_result peer_bsp_create(cellist_context *context, const sort_boundary *boundary, peer_bsp *tree);
void peer_bsp_release(cellist_context *context, peer_bsp *tree);

#endif
