/* SPDX-License-Identifier: BSD-3-Clause
 * Bins: which cells of an order may cover which tile. Private. */
#ifndef CELLIST_SOFT_BINS_H
#define CELLIST_SOFT_BINS_H

#include "scene.h"

/* A point of the mesh in the image: pixels x y -x -y, so that the largest values of a cell bound it; all infinite if it
 * lies behind the eye. */
typedef struct soft_place {
  float x, y, minus_x, minus_y;
} soft_place;

/* Memory kept from frame to frame. */
typedef struct soft_bins {
  soft_vertex *vertices; /* [points] */
  soft_place *places;    /* [points] */
  soft_rect *rects;      /* [tets] */
  size_t *counts;        /* [tiles][chunks], then where each chunk's entries of a tile begin */
  size_t count_capacity;
  size_t *tile_begin; /* [tile_capacity] */
  size_t tile_capacity;
  uint32_t *entries, *entry_places; /* [entry_capacity]; the second only where there are groups */
  size_t entry_capacity, place_capacity;
} soft_bins;

/* Everything about the mesh that binning needs. */
typedef struct soft_bins_input {
  cellist_context *context;
  const cellist_frame *frame;
  size_t point_count, tet_count;
  const double *positions;
  const double *point_scalars; /* [points]; NULL: on cells */
  soft_bounds_function bound;
  const uint8_t *is_drawn; /* [tets] */
  size_t order_count;
} soft_bins_input;

/* Works out vertices, rectangles and tiles' entries, and sets the scene's pointers to them. scene has its order, tets
 * and ray parameters. cell_count: cells that are in a tile. Errors: OUT_OF_MEMORY. */
cellist_result soft_bins_make(soft_bins *bins, const soft_bins_input *input, soft_scene *scene, size_t *cell_count);
void soft_bins_release(cellist_context *context, soft_bins *bins);

#endif
