/* SPDX-License-Identifier: BSD-3-Clause
 * Cells as the signs and the topological sort see them: at most four faces each. Private to sort/. */
#ifndef CELLIST_SORT_CELLS_H
#define CELLIST_SORT_CELLS_H

#include <cellist/sort.h>

#include "view.h"

/* The mesh's tets, and after them those imaginary cells that have no more than four neighbours: what matters of a cell
 * is on which side of its faces the eye lies. */
typedef struct sort_cells {
  size_t tet_count, count;
  const double *points;
  const uint32_t *tets;       /* [4 tet_count] point ids */
  const uint32_t *planes;     /* [12 (count - tet_count)] of the others: for each face three points that span its plane,
                                 counter-clockwise seen from outside */
  const uint32_t *neighbours; /* [4 count] the cell across each face, or CELLIST_NONE */
} sort_cells;

/* Three points of a face's plane, counter-clockwise seen from outside. */
static inline void sort_cell_face(const sort_cells *cells, size_t cell, uint32_t k, const double *points[3]) {
  for (uint32_t c = 0; c < 3; c++) {
    const uint32_t point = cell < cells->tet_count ? cells->tets[4 * cell + SORT_TET_FACE[k][c]]
                                                   : cells->planes[12 * (cell - cells->tet_count) + 3 * k + c];
    points[c] = &cells->points[3 * (size_t)point];
  }
}

/* A mesh's tets alone. */
static inline sort_cells sort_cells_of_mesh(const cellist_sorter_desc *mesh) {
  return (sort_cells){.tet_count = mesh->tet_count,
                      .count = mesh->tet_count,
                      .points = mesh->points,
                      .tets = mesh->tets,
                      .neighbours = mesh->neighbours};
}

#endif
