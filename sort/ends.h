/* SPDX-License-Identifier: BSD-3-Clause
 * A topological sort from both ends at once. Private to sort/. */
#ifndef CELLIST_SORT_ENDS_H
#define CELLIST_SORT_ENDS_H

#include "cells.h"

/* The cells in blocks, of which a view gives the farther half to one end and the nearer half to the other one. */
typedef struct sort_ends {
  size_t block_count;
  float *centres;    /* [3 block_count] */
  float *depths;     /* [block_count] scratch of a view */
  uint8_t *is_near;  /* [block_count] the view's nearer half */
  uint8_t *mirrored; /* [cells.count] and some: states as seen from the nearer end; see signs.h */
  uint32_t *queue;   /* [half the cells] what came out at the nearer end, nearest first */
} sort_ends;

/* Cells in a block, a multiple of four: with fewer the cut between the halves is smoother and fewer cells wait for both
 * ends (2 % at 32, 3 % at 128, 5 % at 512), with more there are fewer blocks to look at. */
enum { SORT_BLOCK = 128 };

/* Meshes of fewer cells are sorted from one end: a second thread would gain less than it costs to wake it. */
enum { SORT_ENDS_MINIMUM = 1 << 16 };

/* Fills a zeroed sort_ends. Errors: OUT_OF_MEMORY (what is there can be released). Cost: linear. */
cellist_result sort_ends_create(cellist_context *context, const sort_cells *cells, sort_ends *ends);
void sort_ends_release(cellist_context *context, sort_ends *ends);

/* Parts the blocks for a view. Any parting is right; this one makes both halves as large as the other. */
void sort_ends_choose(sort_ends *ends, const sort_eye *eye);

#endif
