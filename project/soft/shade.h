/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: eight fragments at a time, from where the ray enters and leaves a cell to segments. Included by each kernel.
 *
 * Places are w = 1/t (parallel: -t), so that length = (w_near - w_far) t_near t_far |r|: no difference of large numbers
 * is taken. scene.h says what a record holds. */
#ifndef CELLIST_SOFT_SHADE_H
#define CELLIST_SOFT_SHADE_H

#include "pieces.h"
#include "surfaces.h"

static inline f8 scalar_at(const soft_scene *scene, f8 end, f8 t, f8 s, const f8 record[12]) {
  const f8 change = f8_sub(s, f8_mul(record[6], end));
  const f8 value = scene->parallel ? f8_add(record[7], change) : f8_fma(t, change, record[7]);
  return f8_min(f8_max(value, record[8]), record[9]);
}

/* A scalar within this share of the cell's range of its least or greatest one counts as that: where a whole region
 * holds an isosurface's value, so does the face at its rim, and rounding must not put the face on either side. Smaller
 * than rounding: holes there; larger: surfaces begin that much before they should. */
#define SHADE_SNAP 3e-5f

static inline f8 snap_scalar(f8 value, const f8 record[12]) {
  const f8 low = record[8], high = record[9], margin = f8_mul(f8_all(SHADE_SNAP), f8_sub(high, low));
  const f8 snapped = f8_select(f8_greater(margin, f8_sub(value, low)), low, value);
  return f8_select(f8_greater(margin, f8_sub(high, value)), high, snapped);
}

/* Gradients at an end of eight fragments. */
static inline void gradients_of(const soft_scene *scene, const soft_fragments *fragments, size_t first, f8 x, f8 y,
                                f8 end, f8 t, f8 gradient[3]) {
  const float *row[8];
  f8 record[16];
  for (size_t i = 0; i < 8; i++) row[i] = fragments->gradients[fragments->cell[first + i]].g;
  f8_transpose(row, record);
  for (size_t i = 0; i < 8; i++) row[i] += 8;
  f8_transpose(row, record + 8);
  for (int k = 0; k < 3; k++) {
    const f8 there = f8_fma(record[6 + k], y, f8_fma(record[3 + k], x, record[k]));
    const f8 change = f8_sub(there, f8_mul(record[9 + k], end));
    gradient[k] = scene->parallel ? f8_add(record[12 + k], change) : f8_fma(t, change, record[12 + k]);
  }
}

static inline segment8 segments_of(const soft_scene *scene, const soft_fragments *fragments, size_t first,
                                   uint32_t left, uint32_t top) {
  const float *row[8];
  f8 record[12];
  for (size_t i = 0; i < 8; i++) row[i] = &fragments->records[fragments->cell[first + i]].place;
  f8_transpose(row, record);
  for (size_t i = 0; i < 8; i++) row[i] += 8;
  f8_transpose_half(row, record + 8);
  const i8 where = i8_load(fragments->where + first);
  segment8 made;
  made.pixel = i8_and(where, i8_all(0xffff));
  const f8 x = i8_to_float(i8_and(i8_shift_right(where, 16), i8_all(0xff))), y = i8_to_float(i8_shift_right(where, 24));
  const f8 place = f8_fma(record[2], y, f8_fma(record[1], x, record[0]));
  const f8 s = f8_fma(record[5], y, f8_fma(record[4], x, record[3]));
  const f8 near_end = f8_load(fragments->near_end + first), far_end = f8_load(fragments->far_end + first);
  const f8 near_place = f8_add(place, near_end), far_place = f8_add(place, far_end);
  f8 near_t = f8_all(1), far_t = f8_all(1);
  made.length = f8_sub(near_end, far_end);
  if (scene->parallel) {
    made.near_depth = f8_sub(f8_all(0), near_place);
    made.far_depth = f8_sub(f8_all(0), far_place);
  } else {
    made.near_depth = near_t = f8_div(f8_all(1), near_place);
    made.far_depth = far_t = f8_div(f8_all(1), far_place);
    const f8 column = i8_to_float(i8_and(where, i8_all(SOFT_TILE - 1)));
    const f8 line = i8_to_float(i8_and(i8_shift_right(where, 5), i8_all(SOFT_TILE - 1)));
    const f8 u =
        f8_fma(f8_all((float)scene->across_step), column, f8_all((float)(scene->across + scene->across_step * left)));
    const f8 v =
        f8_fma(f8_all((float)scene->upward_step), line, f8_all((float)(scene->upward + scene->upward_step * top)));
    const f8 stretch = f8_sqrt(f8_fma(u, u, f8_fma(v, v, f8_all(1))));
    made.length = f8_mul(f8_mul(made.length, f8_mul(near_t, far_t)), stretch);
  }
  made.from = scalar_at(scene, near_end, near_t, s, record);
  made.to = scalar_at(scene, far_end, far_t, s, record);
  if (scene->model.model == CELLIST_MODEL_ISOSURFACES) {
    made.from = snap_scalar(made.from, record);
    made.to = snap_scalar(made.to, record);
  }
  if (scene->model.gradients == SOFT_CELL_GRADIENTS) {
    made.light[0] = record[10];
    made.light[1] = record[11];
  } else if (scene->model.gradients == SOFT_POINT_GRADIENTS) {
    gradients_of(scene, fragments, first, x, y, near_end, near_t, &made.light[0]);
    gradients_of(scene, fragments, first, x, y, far_end, far_t, &made.light[3]);
  }
  return made;
}

/* Where the scalars of eight fragments are kept in double precision; false if none is. */
static inline bool find_ends(const soft_fragments *fragments, size_t first, const double *ends[8]) {
  bool is_sharp = false;
  for (size_t i = 0; fragments->is_sharp && i < 8; i++) {
    ends[i] = fragments->ends[fragments->cell[first + i]];
    is_sharp = is_sharp || !isnan(ends[i][0]);
  }
  return is_sharp;
}

/* Shades what waits and empties the list. */
static void shade_fragments(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top) {
  soft_fragments *fragments = &worker->fragments;
  const size_t count = fragments->count;
  if (count == 0) return;
  worker->fragment_count += count;
  for (size_t i = count; i % 8 != 0; i++) { /* fill up the last eight; the room is reserved */
    fragments->near_end[i] = fragments->near_end[count - 1];
    fragments->far_end[i] = fragments->far_end[count - 1];
    fragments->where[i] = fragments->where[count - 1];
    fragments->cell[i] = fragments->cell[count - 1];
  }
  for (size_t first = 0; first < count; first += 8) {
    const segment8 segment = segments_of(scene, fragments, first, left, top);
    const unsigned lanes = count - first < 8 ? (1u << (count - first)) - 1 : 255;
    const double *ends[8];
    const bool is_sharp = find_ends(fragments, first, ends);
    if (scene->model.model == CELLIST_MODEL_MAXIMUM)
      add_maxima(worker, &segment, is_sharp ? ends : NULL, lanes);
    else if (scene->model.model == CELLIST_MODEL_ISOSURFACES)
      add_isosurfaces(scene, worker, &segment, lanes);
    else if (is_sharp)
      add_sharp_segments(scene, worker, &segment, ends, lanes);
    else
      add_segments(scene, worker, &segment, lanes);
  }
  shade_pieces(scene, worker, true);
  fragments->count = fragments->record_count = 0;
}

#endif
