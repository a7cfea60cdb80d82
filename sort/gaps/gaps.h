/* SPDX-License-Identifier: BSD-3-Clause
 * Gap arcs: which boundary cells lie in front of which across a gap. Private to sort/. */
#ifndef CELLIST_SORT_GAPS_H
#define CELLIST_SORT_GAPS_H

#include "../view.h"
#include "boundary.h"
#include "pairs.h"
#include "picture.h"
#include "sheets.h"

/* What one worker finds, and its scratch. */
typedef struct sort_gap_worker {
  sort_pair_writer writer, saved;
  size_t candidate_count;
  sort_sheets sheets;
} sort_gap_worker;

/* An entering face in one cell of the grid: its box, and the cell of the box's lower corner. */
typedef struct sort_grid_entry {
  float low[2], high[2], nearest, farthest;
  uint16_t cell[2];
  uint32_t face;
} sort_grid_entry;

/* The arcs of the last view, and the scratch to find them. All that refers to rows is by place in the list of active
 * rows: all of the boundary's, or those that sort_gaps_find_among was given. */
typedef struct sort_gaps {
  sort_boundary boundary;
  size_t row_count;
  uint32_t *rows;    /* [row_count] active rows, ascending */
  uint32_t *places;  /* [boundary.row_count] each active row's place in rows */
  uint32_t *parts;   /* [row_count] arcs lead between rows of the same part only; NULL: all are one */
  size_t face_count; /* active faces, ascending, and their vertices */
  uint32_t *faces;
  size_t vertex_count;
  uint32_t *vertices;
  uint8_t *is_listed; /* [boundary.vertex_count] scratch, all 0 between calls */

  size_t arc_count, candidate_count;
  size_t *starts;    /* [row_count + 1] */
  uint32_t *targets; /* [arc_count] places of nearer rows: those of place i are targets[starts[i]] to
                        targets[starts[i + 1] - 1] */
  uint32_t *pending; /* [row_count] how many arcs lead to the row */

  uint32_t *part_list;
  sort_pairs pairs;        /* the arcs as (far, near); there is room for all of its pairs in targets */
  size_t range_count;      /* ranges of them, in the order of leaving faces */
  sort_pair_range *ranges; /* [range_count] */
  double *picture, *depths;
  int8_t *sides;                /* [face_count] 1: the eye is outside of the face */
  sort_box *boxes;              /* [face_count] in the picture of the moment */
  uint32_t *leaving, *entering; /* places of active faces in the picture; entering: as many again as scratch */
  size_t leaving_count, entering_count;
  uint64_t *keys;        /* [2 face_count] of the entering faces' depths */
  uint32_t *cell_starts; /* the grid: entering faces by cell */
  sort_grid_entry *entries;
  size_t entry_capacity;
  unsigned worker_count;
  sort_gap_worker *workers; /* [worker_count] */
} sort_gaps;

/* Fills a zeroed sort_gaps. Errors: OUT_OF_MEMORY (what is there can be released). */
cellist_result sort_gaps_create(cellist_context *context, const cellist_sorter_desc *mesh, sort_gaps *gaps);
void sort_gaps_release(cellist_context *context, sort_gaps *gaps);

/* Finds all arcs of a view. Errors: OUT_OF_MEMORY. */
cellist_result sort_gaps_find(cellist_context *context, sort_gaps *gaps, const sort_eye *eye);

/* Finds the arcs of a view between the faces of some cells, those of one part only with those of the same.
 * gaps->rows and part_list hold row_count rows, in any order, and the part of each. Errors: OUT_OF_MEMORY. */
cellist_result sort_gaps_find_among(cellist_context *context, sort_gaps *gaps, const sort_eye *eye);

#endif
