/* SPDX-License-Identifier: BSD-3-Clause
 * Tile: fills one tile, near cells first. Included once by each kernel.
 *
 * Rows of a cell's rectangle are tested eight pixels at a time; what is covered is packed into a list, and the list
 * shaded eight fragments at a time (shade.h). The order is walked backwards, so that transmittance is what is blended
 * and a tile that has become opaque is done. */
#ifndef CELLIST_SOFT_TILE_H
#define CELLIST_SOFT_TILE_H

#include <string.h>

#include "careful.h"
#include "light.h"
#include "shade.h"

/* Fragments that are gathered before they are shaded, at most a tile more: the list stays in the second-level cache. */
enum { SHADE_AT = 1024 };

/* Between which places eight rays are seen, relative to the record's plane; two: the last four are of the next row. */
static inline void cut_to_limits(const soft_worker *limits, const soft_record *record, f8 columns, f8 line,
                                 size_t pixel, size_t next_pixel, f8 *leaves, f8 *enters) {
  const f8 tilt = f8_fma(f8_all(record->place_x), columns, f8_mul(f8_all(record->place_y), line));
  const double place = record->place;
  const f8 near = f8_differences(limits->near_place + pixel, limits->near_place + next_pixel, place);
  const f8 far = f8_differences(limits->far_place + pixel, limits->far_place + next_pixel, place);
  *enters = f8_min(*enters, f8_sub(near, tilt));
  *leaves = f8_max(*leaves, f8_sub(far, tilt));
}

/* The planes that bound eight pixels' rays: count of them, of which exit_count exits come first; one more is 0 for all,
 * an exit or an entry. Inlined with constants, so that the loops unroll. */
static inline __attribute__((always_inline)) void pass_planes(const f8 across[4], const f8 per_y[4], int count,
                                                              int exit_count, bool exits_at_0, f8 line, f8 *leaves,
                                                              f8 *enters) {
  *leaves = *enters = f8_all(0);
  for (int k = 0; k < count; k++) {
    const f8 value = f8_fma(per_y[k], line, across[k]);
    if (k < exit_count)
      *leaves = k == 0 && !exits_at_0 ? value : f8_max(*leaves, value);
    else
      *enters = k == exit_count && exits_at_0 ? value : f8_min(value, *enters);
  }
}

/* Adds those of eight pixels that are covered to the list. Without asking whether there are any: nobody could predict
 * it, and in small cells that costs more than stores in vain. */
static inline __attribute__((always_inline)) void put_covered(f8 leaves, f8 enters, unsigned inside, i8 where,
                                                              int32_t index, soft_fragments *fragments) {
  const unsigned covered = m8_bits(f8_greater(enters, leaves)) & inside;
  const size_t at = fragments->count;
  const i8 packing = lanes_packing(covered);
  f8_store_packed(fragments->near_end + at, enters, packing);
  f8_store_packed(fragments->far_end + at, leaves, packing);
  i8_store_packed(fragments->where + at, where, packing);
  i8_store(fragments->cell + at, i8_all(index));
  fragments->count = at + (size_t)__builtin_popcount(covered);
}

static const float TILE_RAMP[8] = {0, 1, 2, 3, 4, 5, 6, 7}, TILE_RAMP_TWO[8] = {0, 1, 2, 3, 0, 1, 2, 3};
static const float TILE_LINE_TWO[8] = {0, 0, 0, 0, 1, 1, 1, 1};
/* What `where` gains from lane to lane: the pixel, x and y within the rectangle. */
enum { WHERE_RIGHT = 0x10001, WHERE_DOWN = (1 << 24) + SOFT_TILE };
#define TILE_ROW(down) (down), (down) + WHERE_RIGHT, (down) + 2 * WHERE_RIGHT, (down) + 3 * WHERE_RIGHT
static const int32_t TILE_WHERE[8] = {TILE_ROW(0), TILE_ROW(4 * WHERE_RIGHT)};
static const int32_t TILE_WHERE_TWO[8] = {TILE_ROW(0), TILE_ROW(WHERE_DOWN)};

/* Rows of eight pixels, then pairs of rows of four. limits: whose near_place and far_place to keep to, or NULL. */
static inline __attribute__((always_inline)) void fill_rows(const tile_cell *cell, const int planes[4], int count,
                                                            int exit_count, bool exits_at_0, const soft_worker *limits,
                                                            soft_fragments *fragments) {
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane, width = cell->rect.x1 - cell->rect.x0 + 1, height = cell->rect.y1 - cell->rect.y0 + 1;
  const int32_t index = (int32_t)fragments->record_count;
  f8 at[4], per_x[4], per_y[4], across[4];
  for (int k = 0; k < count; k++) {
    const float(*plane)[4] = batch->plane[planes[k]];
    at[k] = f8_all(plane[0][lane]);
    per_x[k] = f8_all(plane[1][lane]);
    per_y[k] = f8_all(plane[2][lane]);
  }
  int x = 0;
  for (; x + 4 < width; x += 8) {
    const f8 columns = f8_add(f8_load(TILE_RAMP), f8_all((float)x));
    for (int k = 0; k < count; k++) across[k] = f8_fma(per_x[k], columns, at[k]);
    const unsigned inside = width - x >= 8 ? 255 : (1u << (width - x)) - 1;
    i8 where = i8_add(i8_load(TILE_WHERE), i8_all(cell->origin + x * WHERE_RIGHT));
    for (int y = 0; y < height; y++) {
      const f8 line = f8_all((float)y);
      f8 leaves, enters;
      pass_planes(across, per_y, count, exit_count, exits_at_0, line, &leaves, &enters);
      if (limits != NULL) {
        const size_t pixel = (size_t)(cell->origin + y * SOFT_TILE + x);
        cut_to_limits(limits, &batch->record[lane], columns, line, pixel, pixel + 4, &leaves, &enters);
      }
      put_covered(leaves, enters, inside, where, index, fragments);
      where = i8_add(where, i8_all(WHERE_DOWN));
    }
  }
  if (x >= width) return;
  const f8 columns = f8_add(f8_load(TILE_RAMP_TWO), f8_all((float)x));
  for (int k = 0; k < count; k++) across[k] = f8_fma(per_x[k], columns, at[k]);
  const unsigned row = (1u << (width - x)) - 1, two = row | row << 4;
  i8 where = i8_add(i8_load(TILE_WHERE_TWO), i8_all(cell->origin + x * WHERE_RIGHT));
  for (int y = 0; y < height; y += 2) {
    const f8 line = f8_add(f8_load(TILE_LINE_TWO), f8_all((float)y));
    f8 leaves, enters;
    pass_planes(across, per_y, count, exit_count, exits_at_0, line, &leaves, &enters);
    if (limits != NULL) {
      const size_t pixel = (size_t)(cell->origin + y * SOFT_TILE + x);
      cut_to_limits(limits, &batch->record[lane], columns, line, pixel, y + 1 < height ? pixel + SOFT_TILE : pixel,
                    &leaves, &enters);
    }
    put_covered(leaves, enters, y + 1 < height ? two : row, where, index, fragments);
    where = i8_add(where, i8_all(2 * WHERE_DOWN));
  }
}

static __attribute__((noinline)) void fill_limited(const tile_cell *cell, const int planes[4], int count,
                                                   int exit_count, bool exits_at_0, const soft_worker *limits,
                                                   soft_fragments *fragments) {
  fill_rows(cell, planes, count, exit_count, exits_at_0, limits, fragments);
}

/* Where rays are limited there is one version for all cells, not unrolled. */
static inline void fill_plain(const tile_cell *cell, const soft_worker *limits, soft_fragments *fragments) {
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane, reference = (int)batch->reference[lane];
  int planes[4], exits = 0, entries = 0;
  bool exits_at_0 = true;
  for (int k = 0; k < 4; k++) {
    const bool is_entry = (batch->is_entry[k] >> lane & 1) != 0;
    if (k == reference) exits_at_0 = !is_entry;
    if (k != reference && !is_entry) planes[exits++] = k;
  }
  for (int k = 0; k < 4; k++)
    if (k != reference && (batch->is_entry[k] >> lane & 1) != 0) planes[exits + entries++] = k;
  const bool clipped = (batch->clipped >> lane & 1) != 0;
  if (clipped) planes[exits + entries++] = NEAR_PLANE;
  const size_t before = fragments->count;
  const int kind = 2 * exits + exits_at_0 + (clipped ? 8 : 0);
  if (limits != NULL && kind > 0 && kind < 16 && kind != 7 && kind != 8)
    fill_limited(cell, planes, exits + entries, exits, exits_at_0, limits, fragments);
  else
    switch (kind) {
      case 1: fill_rows(cell, planes, 3, 0, true, NULL, fragments); break;
      case 2: fill_rows(cell, planes, 3, 1, false, NULL, fragments); break;
      case 3: fill_rows(cell, planes, 3, 1, true, NULL, fragments); break;
      case 4: fill_rows(cell, planes, 3, 2, false, NULL, fragments); break;
      case 5: fill_rows(cell, planes, 3, 2, true, NULL, fragments); break;
      case 6: fill_rows(cell, planes, 3, 3, false, NULL, fragments); break;
      case 9: fill_rows(cell, planes, 4, 0, true, NULL, fragments); break;
      case 10: fill_rows(cell, planes, 4, 1, false, NULL, fragments); break;
      case 11: fill_rows(cell, planes, 4, 1, true, NULL, fragments); break;
      case 12: fill_rows(cell, planes, 4, 2, false, NULL, fragments); break;
      case 13: fill_rows(cell, planes, 4, 2, true, NULL, fragments); break;
      case 14: fill_rows(cell, planes, 4, 3, false, NULL, fragments); break;
      case 15: fill_rows(cell, planes, 4, 3, true, NULL, fragments); break;
      default: return; /* not entered, or not left: rounding, of a cell thinner than it */
    }
  if (fragments->count == before) return;
  if (fragments->has_gradients) fragments->gradients[fragments->record_count] = batch->gradient_record[lane];
  if (fragments->is_sharp) fragments->ends[fragments->record_count][0] = NAN;
  fragments->records[fragments->record_count++] = batch->record[lane];
}

static bool is_opaque(const soft_scene *scene, const soft_worker *worker) {
  if (scene->is_thin) return false;
  const m8 none = m8_from_bits(0);
  m8 clear = none;
  const f8 limit = f8_all(scene->transfer->opaque);
  for (size_t i = 0; i < SOFT_TILE_PIXELS; i++)
    clear = m8_or(clear, f8_greater(f8_load(worker->pixels[i].light), limit));
  return (m8_bits(clear) & 1 << 3) == 0;
}

/* The part of a cell's rectangle that lies in the tile. */
static inline soft_rect cut_rect(soft_rect rect, uint32_t left, uint32_t top) {
  const uint32_t right = left + SOFT_TILE - 1, bottom = top + SOFT_TILE - 1;
  return (soft_rect){(uint16_t)(rect.x0 > left ? rect.x0 : left), (uint16_t)(rect.y0 > top ? rect.y0 : top),
                     (uint16_t)(rect.x1 < right ? rect.x1 : right), (uint16_t)(rect.y1 < bottom ? rect.y1 : bottom)};
}

/* Entries are not near each other in memory: tets and rectangles are fetched 16 ahead, their points 8. */
static inline void fetch_ahead(const soft_scene *scene, size_t first, size_t last) {
  if (last < first + 20) return;
  for (size_t i = 0; i < 4; i++) {
    const size_t far = scene->entries[last - 17 - i], near = scene->entries[last - 9 - i];
    __builtin_prefetch(&scene->tets[4 * far]);
    __builtin_prefetch(&scene->rects[far]);
    for (size_t k = 0; k < 4; k++) __builtin_prefetch(&scene->vertices[scene->tets[4 * near + k]]);
  }
}

/* Fragments of the entries from last - 1 down to first, in this order. keep: they are not shaded in between. */
static bool fill_entries(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top, size_t first,
                         size_t last, bool keep) {
  soft_fragments *fragments = &worker->fragments;
  const soft_worker *limits = scene->frame != NULL ? worker : NULL;
  size_t since = 0;
  while (last > first) {
    const int count = last - first < 4 ? (int)(last - first) : 4;
    uint32_t cell[4];
    soft_rect rect[4];
    for (int i = 0; i < 4; i++) {
      cell[i] = scene->entries[last - 1 - (size_t)(i < count ? i : 0)];
      rect[i] = cut_rect(scene->rects[cell[i]], left, top);
    }
    fetch_ahead(scene, first, last);
    last -= (size_t)count;
    cell_batch batch;
    cells_set_up(scene, cell, rect, &batch);
    if (scene->model.gradients == SOFT_CELL_GRADIENTS) light_cells(&scene->model, &batch);
    for (int i = 0; i < count; i++) {
      if (!(batch.usable >> i & 1)) continue;
      const tile_cell one = {&batch, i, cell[i], rect[i],
                             (int32_t)((rect[i].y0 - top) * SOFT_TILE + (rect[i].x0 - left))};
      const size_t area = (size_t)(rect[i].x1 - rect[i].x0 + 1) * (size_t)(rect[i].y1 - rect[i].y0 + 1);
      if (!soft_fragments_reserve(scene->context, fragments, area)) return false;
      const bool is_sharp = soft_sharp_meets(&scene->sharp, batch.s_low[i], batch.s_high[i]);
      if ((batch.careful >> i & 1) || is_sharp) {
        worker->careful_count++;
        fill_careful(scene, limits, &one, is_sharp, fragments);
      } else {
        fill_plain(&one, limits, fragments);
      }
      if (keep || fragments->count < SHADE_AT) continue;
      since += fragments->count;
      shade_fragments(scene, worker, left, top);
      if (since < 4 * SOFT_TILE_PIXELS) continue;
      since = 0;
      if (is_opaque(scene, worker)) return true;
    }
  }
  return true;
}

/* The first of the entries from begin on whose place in the order is at least `place`. */
static size_t first_entry(const soft_scene *scene, size_t begin, size_t end, size_t place) {
  while (begin < end) {
    const size_t middle = begin + (end - begin) / 2;
    if (scene->entry_places[middle] < place)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin;
}

static bool fill_tile(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top, size_t begin,
                      size_t end) {
  for (size_t g = scene->group_count; g-- > 0;) {
    const cellist_soft_group *group = &scene->groups[g];
    const size_t from = first_entry(scene, begin, end, group->begin);
    const size_t to = first_entry(scene, from, end, group->begin + group->count);
    if (to == from) continue;
    if (!fill_entries(scene, worker, left, top, to, end, false)) return false;
    shade_fragments(scene, worker, left, top);
    if (!fill_entries(scene, worker, left, top, from, to, true) || !soft_sort_fragments(scene, worker)) return false;
    shade_fragments(scene, worker, left, top);
    end = from;
  }
  if (!fill_entries(scene, worker, left, top, begin, end, false)) return false;
  shade_fragments(scene, worker, left, top);
  return true;
}

/* The colour of the largest scalar, where there is one. */
static inline void colour_maximum(const soft_scene *scene, const float largest[2], float colour[3], float *alpha) {
  *alpha = largest[0] > -HUGE_VALF ? 1 : 0;
  for (int k = 0; k < 3; k++) colour[k] = 0;
  if (*alpha == 0) return;
  const double exact = (double)largest[0] + (double)largest[1];
  const fast_interval *in = &scene->transfer->intervals[fast_find_interval(scene->transfer, largest[0])];
  float above = largest[0] - in->low;
  if (soft_sharp_meets(&scene->sharp, exact, exact)) {
    const size_t k = soft_sharp_find(&scene->sharp, exact);
    const double low = scene->sharp.bounds[k], width = scene->sharp.bounds[k + 1] - low;
    in = &scene->transfer->intervals[scene->sharp.first + k];
    above = width < HUGE_VAL ? (float)((exact - low) / width) : 0;
  }
  for (int k = 0; k < 3; k++) colour[k] = in->colour[k] + in->colour_slope[k] * above;
}

/* A tile within the image, with nothing behind it: eight pixels at a time. */
static void store_whole_tile(const soft_scene *scene, const soft_worker *worker, uint32_t left, uint32_t top) {
  float *const plane[6] = {scene->colour[0], scene->colour[1], scene->colour[2], scene->alpha, scene->z, scene->z_back};
  const f8 unit = f8_all((float)scene->unit);
  for (uint32_t y = 0; y < SOFT_TILE; y++)
    for (uint32_t x = 0; x < SOFT_TILE; x += 8) {
      const float *row[8];
      f8 column[8];
      for (uint32_t i = 0; i < 8; i++) row[i] = worker->pixels[y * SOFT_TILE + x + i].light;
      f8_transpose(row, column);
      if (!scene->is_thin) column[3] = f8_sub(f8_all(1), column[3]);
      column[4] = f8_mul(f8_sub(f8_all(0), column[4]), unit);
      column[5] = f8_mul(column[5], unit);
      for (int k = 0; k < 6; k++)
        if (plane[k] != NULL) f8_store(plane[k] + (size_t)(top + y) * scene->width + left + x, column[k]);
    }
}

static void store_tile(const soft_scene *scene, const soft_worker *worker, uint32_t left, uint32_t top) {
  const bool is_whole = left + SOFT_TILE <= scene->width && top + SOFT_TILE <= scene->height;
  const bool is_extreme = !(scene->unit > 1e-30 && scene->unit < 1e30); /* floats do not hold it, or not its products */
  if (is_whole && scene->layer.depth == NULL && scene->model.model != CELLIST_MODEL_MAXIMUM && !is_extreme) {
    store_whole_tile(scene, worker, left, top);
    return;
  }
  for (uint32_t y = top; y < scene->height && y < top + SOFT_TILE; y++)
    for (uint32_t x = left; x < scene->width && x < left + SOFT_TILE; x++) {
      const size_t from = (size_t)(y - top) * SOFT_TILE + (x - left), to = (size_t)y * scene->width + x;
      const soft_pixel *pixel = &worker->pixels[from];
      float colour[3], alpha = scene->is_thin ? pixel->light[3] : 1 - pixel->light[3];
      float z = (float)(-pixel->minus_z * scene->unit), z_back = (float)(pixel->z_back * scene->unit);
      for (int k = 0; k < 3; k++) colour[k] = pixel->light[k];
      if (scene->model.model == CELLIST_MODEL_MAXIMUM) colour_maximum(scene, pixel->light, colour, &alpha);
      surface_layer_put_behind(&scene->layer, to, colour, &alpha, &z, &z_back);
      for (int k = 0; k < 3; k++)
        if (scene->colour[k] != NULL) scene->colour[k][to] = colour[k];
      if (scene->alpha != NULL) scene->alpha[to] = alpha;
      if (scene->z != NULL) scene->z[to] = z;
      if (scene->z_back != NULL) scene->z_back[to] = z_back;
    }
}

/* What is seen of each ray of the tile. */
static void set_limits(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top) {
  for (uint32_t y = 0; y < SOFT_TILE && top + y < scene->height; y++)
    for (uint32_t x = 0; x < SOFT_TILE && left + x < scene->width; x++) {
      double origin[3], direction[3], limits[2];
      cellist_frame_ray(scene->frame, left + x + 0.5, top + y + 0.5, origin, direction);
      cellist_frame_interval(scene->frame, origin, direction, limits);
      if (scene->layer.depth != NULL)
        limits[1] = fmin(limits[1], surface_layer_limit(&scene->layer, (size_t)(top + y) * scene->width + left + x));
      const size_t at = (size_t)y * SOFT_TILE + x;
      const bool sees = limits[0] < limits[1];
      if (scene->parallel) {
        worker->near_place[at] = -limits[0] / scene->unit;
        worker->far_place[at] = -limits[1] / scene->unit;
      } else {
        worker->near_place[at] = sees ? scene->unit / limits[0] : 0; /* at depth 0: infinity */
        worker->far_place[at] = sees ? scene->unit / limits[1] : HUGE_VAL;
      }
    }
}

static bool draw_tile(const soft_scene *scene, soft_worker *worker, size_t tile) {
  const uint32_t left = (uint32_t)(tile % scene->tiles_across) * SOFT_TILE;
  const uint32_t top = (uint32_t)(tile / scene->tiles_across) * SOFT_TILE;
  const float first = scene->model.model == CELLIST_MODEL_MAXIMUM ? -HUGE_VALF : 0;
  for (size_t i = 0; i < SOFT_TILE_PIXELS; i++) {
    worker->pixels[i] = (soft_pixel){.light = {first, 0, 0, scene->is_thin ? 0 : 1}, .minus_z = -HUGE_VALF};
    worker->last[i][0] = worker->last[i][1] = -HUGE_VALF;
  }
  worker->fragments.count = worker->fragments.record_count = 0;
  if (scene->frame != NULL) set_limits(scene, worker, left, top);
  if (!fill_tile(scene, worker, left, top, scene->tile_begin[tile], scene->tile_begin[tile + 1])) return false;
  store_tile(scene, worker, left, top);
  return true;
}

#endif
