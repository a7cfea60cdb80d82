/* SPDX-License-Identifier: BSD-3-Clause
 * What a sorter holds. Private to sort/. */
#ifndef CELLIST_SORT_SORTER_H
#define CELLIST_SORT_SORTER_H

#include <cellist/sort.h>

#include "cells.h"
#include "complex/complex.h"
#include "ends.h"
#include "gaps/gaps.h"
#include "signs/signs.h"
#include "state.h"
#include "subset.h"
#include "view.h"

struct cellist_sorter {
  cellist_context *context;
  cellist_sorter_desc given; /* as the caller gave it */
  cellist_sorter_desc mesh;  /* what is sorted: all of it, or the subset's */
  sort_subset subset;
  sort_cells cells;
  bool convex; /* no gap anywhere: faces alone order the cells; gaps and complex are empty */
  bool has_complex;
  bool uses_gap_arcs; /* in the stage of the moment: the whole boundary's, or those inside components */
  sort_complex complex;
  sort_gaps gaps;
  sort_planes planes;
  bool uses_ends; /* the mesh is convex and large: sorted from both ends */
  sort_ends ends;
  uint8_t *state; /* [cells.count] and some, so that eight can be read at once */
  uint32_t
      *queue; /* [cells.count] where imaginary cells stand among the tets; NULL without a complex: the order is it */
  size_t group_count;
  cellist_group *groups; /* [tet_count / 2 + 1] */
  cellist_group *parts;  /* [tet_count / 2 + 1] scratch of components.c */
  uint32_t *scratch;     /* [SORT_SCRATCH * (cells.count + large cells)] of components.c */
  /* Of the last sort, if is_current. */
  bool is_current;
  cellist_viewpoint viewpoint;
};

enum { SORT_SCRATCH = 5 };

#endif
