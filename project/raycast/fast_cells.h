/* SPDX-License-Identifier: BSD-3-Clause
 * Fast cells: what a walk needs to get from one cell to the next, in 32, 20 or 16 bytes a cell. Private.
 *
 * A walk knows the three vertices of the face through which it came, and the prior cell. The layouts differ in how they
 * name the fourth vertex (the apex) and the cell behind each face:
 * - Tet32 ([A] 3, fig. 2): three vertices, the xor of all four, four neighbours.
 * - Tet20 ([A] appendix A): the xor and four neighbours, in the order of the vertices' ids, so that the vertices need
 *   not be there: the neighbour across vertex v stands at v's rank among the four.
 * - Tet16 (likewise): the xor, and the neighbours' xors with the first one; the prior cell, which is one of the four,
 *   resolves them. A missing neighbour takes part as CELLIST_NONE.
 * - ranked (ours): at each rank a pair {next cell, its apex}. One load of 8 bytes gives both, where the others load the
 *   next cell's xor only when they know the cell: one dependent load less a step. */
#ifndef CELLIST_RAYCAST_FAST_CELLS_H
#define CELLIST_RAYCAST_FAST_CELLS_H

#include <cellist/mesh.h>

typedef enum fast_layout { FAST_RANKED, FAST_TET32, FAST_TET20, FAST_TET16, FAST_LAYOUT_COUNT } fast_layout;

/* Bytes of a cell. */
static const size_t FAST_CELL_SIZE[FAST_LAYOUT_COUNT] = {32, 32, 20, 16};

/* The cells of a mesh, in the mesh's (Hilbert) order. */
typedef struct fast_cells {
  fast_layout layout;
  size_t count;
  uint32_t *words; /* [count * size / 4] from the context's allocator */
} fast_cells;

/* Errors: OUT_OF_MEMORY. Threads: the context's workers share the work. Cost: linear. */
cellist_result fast_cells_create(cellist_context *context, const cellist_mesh_arrays *mesh, fast_layout layout,
                                 fast_cells *made);
void fast_cells_release(cellist_context *context, fast_cells *cells);

/* Where a walk stands: inside `cell`, between the face it came through and the apex. */
typedef struct fast_place {
  uint32_t cell, apex;
  uint32_t prior; /* the cell before, CELLIST_NONE at a boundary; only Tet16 reads it */
} fast_place;

/* Moves into the next cell, CELLIST_NONE beyond the boundary. face: the three vertices of the face left through, the
 * apex among them; leaving: the fourth vertex of the cell. layout is a constant where this is called. */
static inline fast_place fast_cells_next(const fast_cells *cells, fast_layout layout, fast_place at,
                                         const uint32_t face[3], uint32_t leaving) {
  const uint32_t rank = (uint32_t)(face[0] < leaving) + (uint32_t)(face[1] < leaving) + (uint32_t)(face[2] < leaving);
  const uint32_t *words = cells->words;
  if (layout == FAST_RANKED) {
    const uint32_t *pair = &words[8 * (size_t)at.cell + 2 * rank];
    return (fast_place){pair[0], pair[1], at.cell};
  }
  const size_t stride = FAST_CELL_SIZE[layout] / 4;
  const uint32_t *cell = &words[stride * at.cell];
  uint32_t next;
  if (layout == FAST_TET32) {
    next = cell[leaving == cell[0] ? 4 : leaving == cell[1] ? 5 : leaving == cell[2] ? 6 : 7];
  } else if (layout == FAST_TET20) {
    next = cell[1 + rank];
  } else {
    const uint32_t entry_rank = (uint32_t)(leaving < at.apex) + (uint32_t)(face[0] < at.apex) +
                                (uint32_t)(face[1] < at.apex) + (uint32_t)(face[2] < at.apex);
    next = at.prior ^ (entry_rank > 0 ? cell[entry_rank] : 0) ^ (rank > 0 ? cell[rank] : 0);
  }
  if (next == CELLIST_NONE) return (fast_place){CELLIST_NONE, 0, at.cell};
  const uint32_t all = words[stride * next + (layout == FAST_TET32 ? 3 : 0)];
  return (fast_place){next, all ^ face[0] ^ face[1] ^ face[2], at.cell};
}

#endif
