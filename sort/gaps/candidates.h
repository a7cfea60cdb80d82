/* SPDX-License-Identifier: BSD-3-Clause
 * The search for one picture's gap arcs. Private to sort/gaps/. */
#ifndef CELLIST_SORT_CANDIDATES_H
#define CELLIST_SORT_CANDIDATES_H

#include "gaps.h"
#include "overlap.h"

/* Leaving faces that one range of pairs is of. */
enum { SORT_GAP_CHUNK = 256 };

/* At most this many cells a side in the grid; memory only. */
enum { SORT_GRID_LIMIT = 1024 };

/* Cells of the grid over a picture. */
typedef struct sort_grid {
  uint32_t size;
  double origin[2], scale[2];
} sort_grid;

/* One view's search. */
typedef struct sort_gap_search {
  cellist_context *context;
  sort_gaps *gaps;
  sort_scene scene;
  double depth_error; /* of the one picture */
  sort_grid grid;
  int cube_side; /* -1: the one picture */
} sort_gap_search;

/* Forgets the pairs of the view before. */
void sort_gap_search_begin(sort_gaps *gaps);

/* Adds one picture's arcs to gaps->pairs, with ranges in the order of the leaving faces, and counts them. gaps->sides
 * is filled. Errors: OUT_OF_MEMORY. */
cellist_result sort_gap_search_picture(sort_gap_search *search);

#endif
