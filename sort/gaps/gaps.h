/* SPDX-License-Identifier: BSD-3-Clause
 * Gap arcs: which boundary cells lie in front of which across a gap. Private to sort/. */
#ifndef CELLIST_SORT_GAPS_H
#define CELLIST_SORT_GAPS_H

#include "../view.h"
#include "boundary.h"
#include "picture.h"

/* One worker's finds. */
typedef struct sort_gap_buffer {
  uint32_t *pairs; /* far row, near row */
  size_t count, capacity;
  size_t candidate_count;
  cellist_result result;
} sort_gap_buffer;

/* What one range of faces found: where in which worker's buffer. */
typedef struct sort_gap_chunk {
  unsigned worker;
  size_t begin, count;
} sort_gap_chunk;

/* An entering face in one cell of the grid: its box, and the cell of the box's lower corner. */
typedef struct sort_grid_entry {
  float low[2], high[2];
  uint16_t cell[2];
  uint32_t face;
} sort_grid_entry;

/* The arcs of the last view, by row of the farther cell, and the scratch to find them. */
typedef struct sort_gaps {
  sort_boundary boundary;
  size_t arc_count, candidate_count;
  size_t *starts; /* [row_count + 1] */
  uint32_t
      *targets; /* [arc_count] rows of nearer cells: row r's are targets[starts[r]] to targets[starts[r + 1] - 1] */
  size_t target_capacity;
  uint32_t *pending; /* [row_count] how many arcs lead to the row */

  uint32_t *pairs; /* the arcs as (far row, near row), in the order in which faces stand */
  size_t pair_capacity;
  double *picture;
  int8_t *sides;                /* [face_count] 1: the eye is outside of the face */
  sort_box *boxes;              /* [face_count] in the picture of the moment */
  uint32_t *leaving, *entering; /* [face_count] faces in the picture */
  size_t leaving_count, entering_count;
  uint32_t *cell_starts; /* the grid: entering faces by cell */
  sort_grid_entry *entries;
  size_t cell_start_capacity, entry_capacity;
  unsigned worker_count;
  sort_gap_buffer *buffers; /* [worker_count] */
  sort_gap_chunk *chunks;
  size_t chunk_capacity;
} sort_gaps;

/* Fills a zeroed sort_gaps. Errors: OUT_OF_MEMORY (what is there can be released). */
cellist_result sort_gaps_create(cellist_context *context, const cellist_sorter_desc *mesh, sort_gaps *gaps);
void sort_gaps_release(cellist_context *context, sort_gaps *gaps);

/* Finds all arcs of a view. Errors: OUT_OF_MEMORY. */
cellist_result sort_gaps_find(cellist_context *context, sort_gaps *gaps, const sort_eye *eye);

#endif
