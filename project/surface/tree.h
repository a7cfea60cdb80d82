/* SPDX-License-Identifier: BSD-3-Clause
 * Tree: boxes over a surface's triangles, and the nearest triangle that a ray meets. Private to project/. */
#ifndef CELLIST_SURFACE_TREE_H
#define CELLIST_SURFACE_TREE_H

#include <cellist/surface.h>

/* A box over triangles first to first + count - 1 (count 0: over the two nodes that follow: the next one and the one
 * at `first`). */
typedef struct surface_node {
  double low[3], high[3];
  uint32_t first, count;
} surface_node;

typedef struct surface_tree {
  size_t node_count;
  surface_node *nodes; /* [node_count] a node before those below it */
} surface_tree;

/* The triangles must stand in an order in which neighbours are near. Errors: OUT_OF_MEMORY. Cost: linear. */
cellist_result surface_tree_build(cellist_context *context, const cellist_surface_arrays *arrays, surface_tree *tree);
void surface_tree_release(cellist_context *context, surface_tree *tree);

/* Where a ray meets the surface. */
typedef struct surface_hit {
  double t; /* the ray's parameter */
  uint32_t triangle;
  double weight[3]; /* of its corners, of sum 1, each at least 0 */
} surface_hit;

/* The nearest point with interval[0] <= t <= interval[1]. Returns false if there is none. A ray through an edge or
 * vertex that triangles share meets one of them. Threads: any. Cost: logarithmic, as a rule. */
bool surface_tree_nearest(const surface_tree *tree, const cellist_surface_arrays *arrays, const double origin[3],
                          const double direction[3], const double interval[2], surface_hit *hit);

#endif
