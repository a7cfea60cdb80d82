/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh made convex, as the sorter uses it. Private to sort/.
 *
 * Where a tet's face or an imaginary cell with at most four neighbours meets exactly one cell, that cell stands in
 * sort_cells.neighbours like any other, and costs what a tet costs. All other contacts (faces that meet several cells,
 * and the facets of larger cells) are links. */
#ifndef CELLIST_SORT_COMPLEX_H
#define CELLIST_SORT_COMPLEX_H

#include "../cells.h"
#include "../gaps/boundary.h"

/* A link's plane: spanned by three points, or across an axis. */
typedef struct sort_link_plane {
  sort_face_plane quick;
  const double *points[3]; /* NULL: x[axis] = offset, positive above */
  uint32_t axis;
  double offset;
} sort_link_plane;

/* Facets between nodes. A node is a row (a cell with links: row r is cell row_cells[r]) or, from row_count on, an
 * imaginary cell with more than four neighbours. */
typedef struct sort_links {
  size_t row_count, large_count, facet_count, plane_count;
  uint32_t *row_cells; /* [row_count] */
  uint32_t *cell_rows; /* [cells.count] and back, or CELLIST_NONE */
  sort_link_plane *planes;
  uint32_t *facet_planes; /* [facet_count] */
  uint32_t *facet_nodes;  /* [2 facet_count] on the plane's positive side, then on its negative one */
  uint32_t *starts;       /* [row_count + large_count + 1] */
  uint32_t *links;        /* [2 facet_count] by node: 2 facet + 1 if the node is on the negative side */

  /* Of one view. */
  int8_t *plane_sides, *facet_sides; /* 1: the eye is on the positive side */
  uint32_t *pending;                 /* [nodes] facets behind the node's that are not out */
  uint32_t *ready, *farthest;        /* [large_count] a stack; large cells with nothing behind them */
} sort_links;

typedef struct sort_complex {
  size_t imaginary_count;
  uint32_t *neighbours, *planes; /* what sort_cells refers to */
  uint32_t *exposed; /* [4 tet_count] the mesh's neighbours less those that facets cut off; NULL: none are cut off */
  sort_links links;
} sort_complex;

/* Checks the arrays and fills a zeroed sort_complex and cells. cut: NULL, or as sort_subset: faces that need no facet.
 * Errors: INVALID_ARGUMENT (ids out of range, not this mesh's complex), OUT_OF_MEMORY; what is there can be released.
 */
cellist_result sort_complex_create(cellist_context *context, const cellist_sorter_desc *mesh, const uint8_t *cut,
                                   sort_complex *complex, sort_cells *cells);
void sort_complex_release(cellist_context *context, sort_complex *complex);

/* Makes the links' arrays from facets: planes of the complex and nodes, both sides each. Only links->facet_planes and
 * facet_nodes are there, the former with the complex's numbers. */
cellist_result sort_links_create(cellist_context *context, const cellist_sorter_complex *from, size_t cell_count,
                                 sort_links *links);
void sort_links_release(cellist_context *context, sort_links *links);

/* The eye's side of all links, and what each node waits for. */
void sort_links_find(sort_links *links, const sort_eye *eye);

/* Whether the link leads from its node to a nearer one, and which. */
static inline bool sort_link_target(const sort_links *links, uint32_t link, uint32_t *node) {
  *node = links->facet_nodes[link ^ 1];
  const int side = links->facet_sides[link >> 1];
  return (link & 1) ? side > 0 : side < 0;
}

#endif
